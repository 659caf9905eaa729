//! What mappers say of their work: cells updated, and memory.

use std::sync::Arc;

use grid::GridSpec;
use mapper::catalogue::MAPPERS;
use mapper::{ContinuousRay, ConventionalCut, LogOdds, Mapper, Model, SignedDistance};
use sensor::{InverseModel as _, Pose, Scan, Stereo};

/// Cells up to a range, m, from 0.01 m on.
fn ends_at(range_m: f64) -> u64 {
    40.min(1 + ((0.01 + range_m) / 0.05) as u64)
}

/// Cells of a signed distance up to the truncation, or the largest range.
fn behind(rule: &SignedDistance) -> u64 {
    let truncation_m = 0.05 * rule.truncation_cells;
    ends_at(if rule.max_range_m < 1.5 { (1.5 - truncation_m).min(rule.max_range_m) } else { 1.5 + truncation_m })
}

/// Cells whose centres lie at most so far, m, behind the reading.
fn centres(behind_m: f64) -> u64 {
    (0..40).filter(|k| 0.05 * (f64::from(*k) + 0.5) - 0.01 <= 1.5 + behind_m).count() as u64
}

/// Three rays along a row of 40 cells: two readings of 15 / 10 = 1.5 m, in cell 30, and none.
#[test]
fn every_mapper_that_counts_counts_rays_times_cells() {
    let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 40, height: 1 };
    let sensor = Arc::new(Stereo::default());
    let setup = Model::new(grid, sensor.clone());
    let pose = Pose { x_m: 0.01, y_m: 0.025, theta_rad: 0.0 };
    let readings = vec![Some(10.0), None, Some(10.0)];
    let scan = Scan { sensor: 0, time_s: 0.0, pose, bearings_rad: vec![0.0; 3], readings };
    for entry in MAPPERS {
        let mut mapper = (entry.build)(&setup);
        assert_eq!(mapper.work().cells, 0, "{}: nothing done", entry.name);
        mapper.integrate(&scan);
        assert!(mapper.work().bytes >= 40 * 8, "{}: {:?}", entry.name, mapper.work());
        let expected = match entry.name {
            "forward-em" | "gibbs" | "gibbs-unchecked" | "mrf" | "prior" => 0, // they do not count
            name if name.starts_with("log-odds") || name.starts_with("hit-count") => 2 * 31,
            "dynamic-grid" => 2 * 31,
            "octomap-cut" => match LogOdds::OCTOMAP_CUT.max_range_m {
                far_m if far_m >= 1.5 => 2 * 31,
                near_m => 2 * (ends_at(near_m) - 1), // the cell in which the ray is cut short is left alone
            },
            "conventional" | "conventional-tuned" => 2 * 32, // up to 15 / 9.5 = 1.57 m
            "conventional-cut" => {
                if ConventionalCut::TUNED.max_range_m < 1.5 {
                    0
                } else {
                    2 * 32
                }
            }
            "octomap-maximum" => 2 * 31,
            "miura-2002" => 2 * 32,
            // Up to one error behind the reading: two standard deviations.
            "sonar-moravec" => 2 * centres(2.0 * sensor.range_sigma(10.0, 0.0)),
            "tsdf" => 2 * behind(&SignedDistance::VOXBLOX),
            "tsdf-tuned" => 2 * behind(&SignedDistance::TUNED),
            name if name.starts_with("mrpt") => 2 * (30 + 1), // up to 1.45 m, and the cell of the reading
            "wavemap" => 2 * centres(6.0 * 0.025),
            "wavemap-tuned" => {
                let ContinuousRay { sigma_cells, sigma_bins, .. } = ContinuousRay::TUNED;
                let sigma_m = (0.05 * sigma_cells).max(sigma_bins * (1.5 - 15.0 / 10.5));
                2 * centres(6.0 * sigma_m)
            }
            _ => 2 * 40,
        };
        assert_eq!(mapper.work().cells, expected, "{}", entry.name);
        mapper.integrate(&scan);
        assert_eq!(mapper.work().cells, 2 * expected, "{}: since it was made", entry.name);
    }
}

#[test]
fn memory_grows_with_the_map() {
    let bytes = |width| {
        let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width, height: 10 };
        let sensor = Arc::new(Stereo::default());
        let setup = Model::new(grid, sensor);
        let shown = |mapper: &dyn Mapper| {
            mapper.occupancy();
            mapper.work().bytes
        };
        MAPPERS.iter().map(|entry| shown(&*(entry.build)(&setup))).collect::<Vec<_>>()
    };
    for (small, large) in bytes(1000).into_iter().zip(bytes(10_000)) {
        assert!(large > 9 * small && large < 11 * small, "{small} {large}");
    }
}

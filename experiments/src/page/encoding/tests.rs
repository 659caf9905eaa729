use grid::{GridSpec, Raster};
use proptest::prelude::*;
use sensor::Pose;

use super::*;
use crate::page::Moment;
use crate::worlds::run::Stage;

fn decoded(code: i16) -> f64 {
    1.0 / (1.0 + (-f64::from(code) * STEP).exp())
}

#[test]
fn codes_keep_to_their_side_of_every_threshold() {
    // The last probability below and the first above each, and the threshold itself.
    for threshold in [0.2f32, 0.5, 0.8] {
        let [below, above] = [threshold.next_down(), threshold.next_up()];
        let edge = f64::from(threshold);
        let limit = (edge * 10.0).round() / 10.0;
        if threshold < 0.5 {
            assert!(decoded(code(below)) < limit && decoded(code(threshold)) >= limit);
        } else {
            assert!(decoded(code(threshold)) <= limit && decoded(code(above)) > limit, "{threshold}");
        }
    }
    assert_eq!((code(0.0), code(1.0), code(0.5)), (-32_767, 32_767, 0));
}

proptest! {
    #[test]
    fn a_code_is_as_near_as_promised(odds in -9.3f64..9.3) {
        let p = (1.0 / (1.0 + (-odds).exp())) as f32;
        let back = decoded(code(p));
        prop_assert!((back - f64::from(p)).abs() <= 2.5e-4, "{p} {back}");
        prop_assert!(((back / (1.0 - back)).ln() - (f64::from(p) / (1.0 - f64::from(p))).ln()).abs() <= 1.001e-3);
    }

    #[test]
    fn a_block_gives_back_its_frames(frames in prop::collection::vec(prop::collection::vec(any::<u32>(), 5), 0..4)) {
        for bytes in [1, 2, 4] {
            let mask = u32::MAX >> (32 - 8 * bytes);
            let text = block(&frames, bytes);
            let mut raw = Vec::new();
            ZlibDecoder::new(&*BASE64_STANDARD.decode(&text).expect("base64")).read_to_end(&mut raw).expect("zlib");
            prop_assert_eq!(raw.len(), frames.len() * bytes * 5);
            if bytes == 4 {
                prop_assert_eq!(unblocked(&text, frames.len(), 5), Some(frames.clone()));
                prop_assert_eq!(unblocked(&text, frames.len() + 1, 5), None);
                prop_assert_eq!(unblocked(&text, frames.len(), 6), (frames.is_empty()).then(Vec::new));
                prop_assert_eq!(unblocked(&text[..text.len() / 2], frames.len().max(1), 5), None);
            }
            let mut former = [0u32; 5];
            for (frame, raw) in frames.iter().zip(raw.chunks(bytes * 5)) {
                for (cell, former) in former.iter_mut().enumerate() {
                    let change: u32 = (0..bytes).map(|plane| u32::from(raw[plane * 5 + cell]) << (8 * plane)).sum();
                    *former = former.wrapping_add(change) & mask;
                    prop_assert_eq!(*former, frame[cell] & mask);
                }
            }
        }
    }
}

/// A world of `width` x `height` cells whose maps move as real ones do: the cells in view of the robot
/// change by noise, the others stay.
fn world(name: &str, width: usize, height: usize, mappers: usize, moments: usize) -> ViewedWorld {
    let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width, height };
    let mut state = 1u32;
    let mut noise = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1u32 << 24) - 0.5
    };
    let in_view = |cell: usize, moment: usize| (cell % width + moment * 5) % width < width / 3;
    let moment = |k: usize| Moment {
        scans: 10 * (k + 1),
        time_s: k as f64,
        pose: Pose::default(),
        looks: Raster::new(
            grid,
            (0..grid.cells()).map(|cell| (0..=k).map(|m| 7 * u32::from(in_view(cell, m))).sum()).collect(),
        ),
        parts: Raster::filled(grid, Some(Region::Visible)),
    };
    let mut mapper = |number: usize| {
        let mut odds = vec![-2.2f64; grid.cells()];
        let mut frame = |k: usize| {
            for (cell, odds) in odds.iter_mut().enumerate().filter(|(cell, _)| in_view(*cell, k)) {
                *odds += 2.0 * noise() - if cell % 9 == 0 { -0.5 } else { 0.5 };
            }
            let occupancy = odds.iter().map(|l| (1.0 / (1.0 + (-l).exp())) as f32).collect();
            Frame { scans: 10 * (k + 1), occupancy: Raster::new(grid, occupancy) }
        };
        Mapped { name: format!("mapper-{number}"), frames: (0..moments).map(&mut frame).collect(), scores: Vec::new() }
    };
    ViewedWorld {
        name: name.to_owned(),
        seed: 1,
        grid,
        prior: 0.1,
        robot_radius_m: 0.2,
        truth: Raster::filled(grid, Some(false)),
        route_m: vec![[0.0; 2]; 10 * moments],
        moments: (0..moments).map(moment).collect(),
        stages: vec![Stage { name: "end".to_owned(), label: "at <last>".to_owned(), scans: 10 * moments }],
        regions: Vec::new(),
        metrics: Vec::new(),
        mappers: (0..mappers).map(&mut mapper).collect(),
    }
}

#[test]
fn a_whole_comparison_fits_the_budget() {
    let worlds = ["corridor", "hall", "clutter", "rooms"].map(|name| world(name, 150, 120, 12, 26)).to_vec();
    let text = json(&Viewer { worlds }, crate::page::VIEWER_BYTES).expect("fits, if with fewer moments");
    assert!(text.len() <= crate::page::VIEWER_BYTES, "{}", text.len());
    let value: Value = serde_json::from_str(&text).expect("JSON");
    for world in value["worlds"].as_array().expect("worlds") {
        let moments = world["moments"].as_array().expect("moments");
        assert!(moments.len() >= 4, "{} moments are no film", moments.len());
        assert_eq!(moments.last().expect("moments")["scans"], 260);
    }
}

#[test]
fn what_is_too_large_is_thinned_to_the_ends_of_stages_and_then_left_out() {
    let viewer = Viewer { worlds: vec![world("w", 40, 30, 1, 9)] };
    let count = |budget: usize| {
        let text = json(&viewer, budget)?;
        assert!(text.len() <= budget && !text.contains('<'));
        let value: Value = serde_json::from_str(&text).expect("JSON");
        let world = &value["worlds"][0];
        let moments: Vec<u64> = (0..9).filter_map(|i| world["moments"][i]["scans"].as_u64()).collect();
        assert_eq!(world["mappers"][0]["moments"].as_array().map(Vec::len), Some(moments.len()));
        assert_eq!(world["stages"][0]["moment"], moments.len() - 1);
        Some((value["thinned"].as_bool().expect("flag"), moments))
    };
    let all = json(&viewer, usize::MAX).expect("fits").len();
    assert_eq!(count(all), Some((false, (1..=9).map(|k| 10 * k).collect())));
    assert_eq!(count(all - 10), Some((true, vec![20, 40, 60, 80, 90])));
    let mut ends = viewer.clone();
    ends.worlds[0].moments.retain(|moment| moment.scans == 90);
    ends.worlds[0].mappers[0].frames.retain(|frame| frame.scans == 90);
    let least = json(&ends, usize::MAX).expect("fits").len();
    assert_eq!(count(least), Some((true, vec![90])));
    assert_eq!(count(least - 10), None);
}

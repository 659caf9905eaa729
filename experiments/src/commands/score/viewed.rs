//! The maps to look into on the page, beside the truth.

use grid::Raster;
use score::Region;

use super::regions::Regions;
use super::scored::{Scored, ScoredMap};
use super::truth::Truth;
use crate::page::{Mapped, Moment, ViewedWorld};
use crate::worlds::film::{Frame, PARTS, in_fine_steps, in_levels};
use crate::worlds::run::Stage;

/// The truth and all maps, as they are in its cells. `name` is that of the truth.
pub(super) fn world(name: &str, scored: &Scored, truth: &Truth, regions: &Regions, prior: f64) -> ViewedWorld {
    let by_rays = |region: &str| Region::ALL.iter().any(|known| known.name() == region);
    let first = scored.maps.first();
    let region = regions.masks.first().map(|(name, _)| name.as_str());
    let rows = first.iter().flat_map(|map| &map.rows).filter(|row| Some(row.region.as_str()) == region);
    let metrics: Vec<(String, String)> =
        rows.map(|row| (row.metric.name.to_owned(), row.metric.unit.to_owned())).collect();
    let stage = Stage { name: "map".to_owned(), label: "map".to_owned(), scans: 1 };
    ViewedWorld {
        name: name.to_owned(),
        seed: None,
        grid: truth.frame.spec,
        prior,
        robot_radius_m: 0.0,
        truth: Some(truth.cells.clone()),
        route_m: Vec::new(),
        scans: None,
        sensors: Vec::new(),
        moments: vec![Moment { scans: 1, parts: Some(parts(truth, regions)), scenery: None }],
        stages: vec![stage],
        regions: regions.masks.iter().filter(|(name, _)| !by_rays(name)).cloned().collect(),
        mappers: scored.maps.iter().map(|map| mapped(map, regions, &metrics)).collect(),
        metrics,
    }
}

fn mapped(map: &ScoredMap, regions: &Regions, metrics: &[(String, String)]) -> Mapped {
    let value = |region: &str, metric: &str| {
        map.rows.iter().find(|row| row.region == region && row.metric.name == metric)?.metric.value
    };
    let row = |(region, _): &(String, Raster<bool>)| {
        (region.clone(), metrics.iter().map(|(metric, _)| value(region, metric)).collect())
    };
    let frame = Frame {
        scans: 1,
        levels: in_levels(&map.map.occupancy, None),
        fine: Some(in_fine_steps(&map.map.occupancy)),
        exact: Vec::new(),
    };
    Mapped {
        name: map.name.clone(),
        frames: vec![frame],
        scores: vec![regions.masks.iter().map(row).collect()],
        known: Some(map.map.known.clone()),
    }
}

/// The part of every cell: by rays where there are scans; else what is free counts as seen, and every obstacle as one that
/// can be missed.
fn parts(truth: &Truth, regions: &Regions) -> Raster<Option<Region>> {
    let mask = |part: Region| regions.masks.iter().find(|(name, _)| name == part.name()).map(|(_, mask)| mask);
    let masks: Vec<(Region, &Raster<bool>)> = PARTS.iter().filter_map(|part| Some((*part, mask(*part)?))).collect();
    let part = |cell: usize| match (truth.cells[cell], masks.is_empty()) {
        (None, _) => None,
        (Some(occupied), true) => Some(if occupied { Region::Surface } else { Region::Visible }),
        (_, false) => masks.iter().find(|(_, mask)| mask[cell]).map(|(part, _)| *part),
    };
    let spec = *truth.cells.spec();
    Raster::new(spec, (0..spec.cells()).map(part).collect())
}

//! What `room` prints: the numbers that a person looks at first.

use std::fmt::Write as _;

use scene::Scene;
use score::Summary;
use score::navigation::Planning;

use crate::worlds::claims::{self, Claim};
use crate::worlds::drives;
use crate::worlds::ground::Ground;
use crate::worlds::ranked::{Head, SortOption, legend};
use crate::worlds::run::{Stage, Trial};

/// A column of a summary table: heading, metric, decimals.
type Column = (&'static str, &'static str, usize);

const OBSERVABLE: [Column; 7] = [
    ("log loss", "log_loss", 3),
    ("Brier", "brier", 4),
    ("AUC", "auc", 3),
    ("IoU", "iou", 2),
    ("retention", "retention", 3),
    ("phantom", "phantom_area", 2),
    ("missed", "missed_area", 2),
];

const REGION: [Column; 5] = [
    ("log loss", "log_loss", 3),
    ("Brier", "brier", 4),
    ("held free", "free_known", 3),
    ("held occupied", "free_lost", 3),
    ("retention", "retention", 3),
];

const DRIVES: [Column; 5] = [
    ("reached", "reached", 3),
    ("colliding", "colliding", 3),
    ("detour", "detour", 3),
    ("recall > 0.5", "recall_50", 3),
    ("recall > 0.65", "recall_65", 3),
];

const FOOTPRINTS: [Column; 3] =
    [("reached", "footprint_reached", 3), ("colliding", "footprint_colliding", 3), ("detour", "footprint_detour", 3)];

/// Each metric with the region that has it.
const MOVEMENT: [(Column, &str); 7] = [
    (("static", "static_accuracy", 3), "static"),
    (("dynamic", "dynamic_accuracy", 3), "swept"),
    (("harmonic", "harmonic_accuracy", 3), "swept"),
    (("trail", "trail_area", 2), "swept"),
    (("ghost", "ghost_area", 2), "changed"),
    (("lag", "lag_looks", 1), "changed"),
    (("cleared", "cleared_3", 2), "changed"),
];

/// How many rays each sensor has.
pub(super) fn rays(scene: &Scene) -> String {
    let camera = Some(format!("{} columns", scene.camera.columns)).filter(|_| scene.camera.columns > 0);
    let beside = scene.sensors.iter().map(|sensor| format!("{} rays of {}", sensor.bearings_rad.len(), sensor.name));
    camera.into_iter().chain(beside).collect::<Vec<_>>().join(", ")
}

/// The heads of a table.
fn heads_of<'a>(columns: impl IntoIterator<Item = &'a Column>) -> Vec<Head<'static>> {
    let heads = columns.into_iter().map(|(title, metric, _)| Head::metric(title, metric));
    std::iter::once(Head::plain("mapper")).chain(heads).collect()
}

/// The heads of all tables that are printed of a place.
pub(super) fn heads(ground: &Ground) -> Vec<Head<'static>> {
    let driven: &[&[Column]] = if ground.planning.pairs > 0 { &[&DRIVES, &FOOTPRINTS] } else { &[] };
    let regions: &[&[Column]] = if ground.scene.regions.is_empty() { &[] } else { &[&REGION] };
    let moved: &[(Column, &str)] = if ground.moves() { &MOVEMENT } else { &[] };
    let shown = std::iter::once(&OBSERVABLE[..]).chain(driven.iter().copied()).chain(regions.iter().copied());
    heads_of(moved.iter().map(|(column, _)| column)).into_iter().chain(shown.flat_map(heads_of)).collect()
}

/// Tables of the last stage over what was observable and in every named region, then the claims.
pub(super) fn text(
    ground: &Ground,
    trials: &[Trial],
    stages: &[Stage],
    claims: &[Claim],
    order: &SortOption,
) -> String {
    let mut text = String::new();
    let (Some(stage), Some(first)) = (stages.last(), trials.first()) else { return text };
    let last = stages.len() - 1;
    let spec = &ground.scene.grid;
    let _ = writeln!(
        text,
        "{}: {}, {} scans x {}, {} x {} cells of {} m\n",
        ground.scene.name,
        match trials.len() {
            1 => format!("seed {}", first.seed),
            n => format!("seeds {} to {} (mean ± sd)", first.seed, first.seed + n as u64 - 1),
        },
        ground.scans(),
        rays(&ground.scene),
        spec.width,
        spec.height,
        spec.cell_m
    );
    let mut table = |title: &str, columns: &[(Column, &str)]| {
        let _ = writeln!(text, "Stage {}, {}: {title}", stage.name, stage.label);
        let mut rows: Vec<Vec<String>> = Vec::new();
        for run in &first.runs {
            let cells = columns.iter().map(|((_, metric, decimals), region)| {
                let summary = over_seeds(trials, run.mapper, last, region, metric);
                (mean(summary, *decimals), deviation(summary, *decimals))
            });
            let (means, deviations): (Vec<String>, Vec<String>) = cells.unzip();
            rows.push([run.mapper.to_owned()].into_iter().chain(means).collect());
            if trials.len() > 1 {
                rows.push([String::new()].into_iter().chain(deviations).collect());
            }
        }
        let _ = writeln!(text, "{}", order.ranked(&heads_of(columns.iter().map(|(column, _)| column)), &rows));
    };
    if ground.moves() {
        table("what has moved (areas in m², lag in looks)", &MOVEMENT);
    }
    let mut section = |title: &str, region: &str, columns: &[Column]| {
        table(title, &columns.iter().map(|column| (*column, region)).collect::<Vec<_>>());
    };
    section("all that could be seen (areas in m²)", "observable", &OBSERVABLE);
    if ground.planning.pairs > 0 {
        section(&driven(&ground.planning), drives::REGION.name(), &DRIVES);
        section("the same, by the probability of an obstacle under it", drives::REGION.name(), &FOOTPRINTS);
    }
    for region in &ground.scene.regions {
        section(&format!("free cells of region {}", region.name), &region.name, &REGION);
    }
    let marks = match legend(&text) {
        "" => String::new(),
        marks => format!("{marks}\n"),
    };
    text + &marks + &claims::lines(claims)
}

/// What is driven, in words.
fn driven(planning: &Planning) -> String {
    let Planning { robot_radius_m, threshold, .. } = planning;
    format!("drives of a robot of radius {robot_radius_m} m where p is at most {threshold}")
}

/// A metric over those seeds in which it has a value.
pub(super) fn over_seeds(trials: &[Trial], mapper: &str, stage: usize, region: &str, metric: &str) -> Option<Summary> {
    let values = trials.iter().filter_map(|trial| trial.metric(mapper, stage, region, metric)?.value);
    Summary::of(&values.collect::<Vec<_>>())
}

/// A mean as text; a dash where there is none.
fn mean(summary: Option<Summary>, decimals: usize) -> String {
    summary.map_or_else(|| "-".to_owned(), |s| format!("{:.decimals$}", s.mean))
}

/// A standard deviation as text; nothing where there is none.
fn deviation(summary: Option<Summary>, decimals: usize) -> String {
    summary.and_then(|s| s.standard_deviation).map_or_else(String::new, |sd| format!("±{sd:.decimals$}"))
}

/// Mean and, of more than one seed, standard deviation as one text.
pub(super) fn spread(summary: Option<Summary>, decimals: usize) -> String {
    format!("{} {}", mean(summary, decimals), deviation(summary, decimals)).trim_end().to_owned()
}

//! `[camera]`, `[sensor]` and `[robot]`, and their defaults.

use sensor::{Camera, Clustering, Matcher, Mismatches, Stereo};

use strict::{Error, Limit, Table};

use crate::Robot;

use super::findings::Findings;
use super::limits::{
    COLUMNS, FIELD_OF_VIEW, FOCAL_BASELINE, INTERVAL, JITTER, JITTER_ANGLE, PATIENCE, PROBABILITY, RADIUS, REACH,
    SEARCH, SIGMA, SPEED, STEP, TURN_RATE,
};
use super::sensors;

/// Keys of the camera's noise, in `[sensor]` or, where that is no table, in `[camera]`.
pub const NOISE: [&str; 11] = [
    "focal_baseline",
    "disparity_sigma",
    "correct_match",
    "max_disparity",
    "detection_rate",
    "quantisation",
    "persistence",
    "copies",
    "near_misses",
    "copy_reach",
    "mismatches",
];

/// `[camera]`: 140 columns over 80 degrees where the file is silent. A file that lists sensors has a camera if it has this table.
pub(super) fn camera(root: &Table, found: &mut Findings) -> Camera {
    let mut camera = Camera { columns: 140, field_of_view_rad: 80f64.to_radians() };
    let Some(table) = found.take(root.section("camera")).flatten() else {
        let none = sensors::listed(root) && root.get("camera").is_none();
        return if none { Camera { columns: 0, ..camera } } else { camera };
    };
    found.only(&table, &[&["columns", "field_of_view_deg"], &NOISE[..]].concat());
    if let Some((key, value)) = NOISE.iter().find_map(|key| Some((key, table.get(key)?)))
        && !noise_is_in_camera(root)
    {
        let bound = "in [sensor], where that table says more of the noise";
        found.add(table.refuse(key, value, bound, "write all of the noise in one of the two tables"));
    }
    if let Some(columns) = found.take(table.optional_whole("columns", &COLUMNS)).flatten() {
        camera.columns = columns as usize;
    }
    if let Some(degrees) = found.take(table.optional_number("field_of_view_deg", &FIELD_OF_VIEW)).flatten() {
        camera.field_of_view_rad = degrees.to_radians();
    }
    camera
}

/// Keys of `[sensor]` that say how mismatches cluster.
pub const CLUSTERING: [&str; 4] = ["persistence", "copies", "near_misses", "copy_reach"];

/// `[sensor]` of a camera that need not be simulated: the paper's where the file is silent.
///
/// # Errors
/// An unknown key, or a value outside its range.
pub fn stereo(root: &Table) -> Result<Stereo, Error> {
    let mut stereo = Stereo::default();
    let Some(table) = root.section("sensor")? else { return Ok(stereo) };
    let fields = optics(&mut stereo);
    table.only(&fields.each_ref().map(|(key, ..)| *key))?;
    for (key, limit, field) in fields {
        *field = table.optional_number(key, limit)?.unwrap_or(*field);
    }
    Ok(stereo)
}

/// The keys of what a mapper knows of the camera.
fn optics(stereo: &mut Stereo) -> [(&'static str, &'static Limit, &mut f64); 4] {
    let Stereo { focal_baseline, disparity_sigma, correct_match, max_disparity } = stereo;
    [
        ("focal_baseline", &FOCAL_BASELINE, focal_baseline),
        ("disparity_sigma", &SIGMA, disparity_sigma),
        ("correct_match", &PROBABILITY, correct_match),
        ("max_disparity", &SEARCH, max_disparity),
    ]
}

/// Whether the camera's noise stands beside its columns: there is no table `[sensor]`, or it is a list of other sensors.
fn noise_is_in_camera(root: &Table) -> bool {
    root.get("sensor").is_none() || sensors::listed(root)
}

/// The camera's noise: the paper's camera, an edge in 60 % of the columns, no quantisation.
pub(super) fn matcher(root: &Table, found: &mut Findings) -> Matcher {
    let matcher = Matcher::default();
    if noise_is_in_camera(root) {
        // What is wrong with the table itself is said where its columns are read.
        return root.section("camera").ok().flatten().map_or(matcher, |table| noise(&table, matcher, found));
    }
    let Some(table) = found.take(root.section("sensor")).flatten() else { return matcher };
    found.only(&table, &NOISE);
    noise(&table, matcher, found)
}

/// What a table says of a stereo camera's noise.
pub(super) fn noise(table: &Table, mut matcher: Matcher, found: &mut Findings) -> Matcher {
    let before = found.count();
    let mut clustering = Clustering::default();
    let mut reach = f64::from(clustering.copy_reach);
    let [focal_baseline, sigma, correct_match, search] = optics(&mut matcher.stereo);
    let fields = [
        focal_baseline,
        sigma,
        correct_match,
        search,
        ("detection_rate", &PROBABILITY, &mut matcher.detection_rate),
        ("quantisation", &STEP, &mut matcher.quantisation),
        ("persistence", &PROBABILITY, &mut clustering.persistence),
        ("copies", &PROBABILITY, &mut clustering.copies),
        ("near_misses", &PROBABILITY, &mut clustering.near_misses),
        ("copy_reach", &REACH, &mut reach),
    ];
    take(table, fields, found);
    if found.take(clustered(table)) != Some(true) {
        return matcher;
    }
    found.take(table.optional_whole("copy_reach", &REACH));
    clustering.copy_reach = reach as u32;
    if found.count() == before {
        found.take(possible(table, &clustering, matcher.stereo.correct_match));
    }
    matcher.mismatches = Mismatches::Clustered(clustering);
    matcher
}

/// Whether mismatches are clustered; refuses what is said of clusters where they are not.
fn clustered(table: &Table) -> Result<bool, Error> {
    let kind = table.get("mismatches").map(|value| (value, value.get_ref().as_str()));
    match kind {
        Some((_, Some("clustered"))) => return Ok(true),
        None | Some((_, Some("independent"))) => {}
        Some((value, _)) => {
            let remedy = "independent mismatches are the paper's, clustered ones come in runs";
            return Err(table.refuse("mismatches", value, "\"independent\" or \"clustered\"", remedy));
        }
    }
    match CLUSTERING.iter().find_map(|key| Some((key, table.get(key)?))) {
        Some((key, value)) => {
            let bound = "left out where mismatches are independent";
            Err(table.refuse(key, value, bound, "write mismatches = \"clustered\" beside it, or take it out"))
        }
        None => Ok(false),
    }
}

/// Refuses shares of more than everything, and runs too short for the share of mismatches.
fn possible(table: &Table, clustering: &Clustering, correct_match: f64) -> Result<(), Error> {
    const ROUNDING: f64 = 1e-9;
    // One of them is in the file: the defaults are possible.
    let given = |keys: [&'static str; 2]| keys.into_iter().find_map(|key| Some((key, table.get(key)?)));
    if clustering.copies + clustering.near_misses > 1.0 + ROUNDING
        && let Some((key, value)) = given(["near_misses", "copies"])
    {
        let (copies, near_misses) = (clustering.copies, clustering.near_misses);
        let bound = format!("such that copies = {copies} and near_misses = {near_misses} add up to at most 1");
        return Err(table.refuse(key, value, &bound, "the rest of the mismatches is uniform; lower one of them"));
    }
    let least = Clustering::least_persistence(correct_match);
    if clustering.persistence < least - ROUNDING
        && let Some((key, value)) = given(["persistence", "correct_match"])
    {
        let bound = format!("such that persistence = {} is at least {least:.4}", clustering.persistence);
        let remedy = format!("shorter runs cannot make all but {correct_match} of the matches fail; raise it");
        return Err(table.refuse(key, value, &bound, &remedy));
    }
    Ok(())
}

/// `[robot]`: 0.2 m, 0.5 m/s, 30 degrees per second, five scans per second.
pub(super) fn robot(root: &Table, found: &mut Findings) -> Robot {
    let (mut radius_m, mut speed_m_s, mut turn_rate_deg_s, mut scan_interval_s) = (0.2, 0.5, 30.0, 0.2);
    let (mut patience_s, mut jitter_m, mut jitter_deg) = (60.0, 0.0, 0.0);
    if let Some(table) = found.take(root.section("robot")).flatten() {
        let fields = [
            ("radius", &RADIUS, &mut radius_m),
            ("speed", &SPEED, &mut speed_m_s),
            ("turn_rate_deg", &TURN_RATE, &mut turn_rate_deg_s),
            ("scan_interval", &INTERVAL, &mut scan_interval_s),
            ("patience_s", &PATIENCE, &mut patience_s),
            ("jitter_m", &JITTER, &mut jitter_m),
            ("jitter_deg", &JITTER_ANGLE, &mut jitter_deg),
        ];
        found.only(&table, &fields.each_ref().map(|(key, ..)| *key));
        take(&table, fields, found);
    }
    Robot {
        radius_m,
        speed_m_s,
        turn_rate_rad_s: turn_rate_deg_s.to_radians(),
        scan_interval_s,
        patience_s,
        jitter_m,
        jitter_rad: jitter_deg.to_radians(),
    }
}

/// Takes the numbers that the table gives.
pub(super) fn take<const N: usize>(table: &Table, fields: [(&str, &Limit, &mut f64); N], found: &mut Findings) {
    for (key, limit, field) in fields {
        if let Some(value) = found.take(table.optional_number(key, limit)).flatten() {
            *field = value;
        }
    }
}

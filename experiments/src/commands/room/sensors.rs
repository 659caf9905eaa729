//! The sensors of a robot with several, each by itself: where it stands, and how its readings lie to what is true.

use sensor::{Pose, Scan, SensorModel};

use crate::page::scans::Scans;
use crate::page::{Part, Section, Sheet, ViewedWorld};
use crate::worlds::ground::Ground;

const LEAD: &str = "Maps are made from the readings of all sensors, what was read at one time as one scan. Here each stands by itself: how many of its rays \
    have a reading that is a range, and how far that lies from the first thing on the ray, or in the cone, without noise (glass and thin legs count \
    as things). The viewer draws every sensor, and can leave each out.";

/// A reading that is farther off than this is false, or of something else, m.
const FALSE_M: f64 = 0.25;

/// The table of the sensors; nothing of a robot with one.
pub(super) fn section(ground: &Ground, world: &ViewedWorld) -> Option<Section> {
    if world.sensors.is_empty() {
        return None;
    }
    let camera = world.scans.iter().filter(|_| ground.scene.camera.columns > 0);
    let camera = camera.map(|scans| row("camera", "stereo", Pose::default(), scans, &ground.scene.matcher.stereo));
    let beside = world.sensors.iter().zip(&ground.scene.sensors).map(|(read, sensor)| {
        row(&sensor.name, sensor.device.kind().name(), sensor.mount, &read.scans, &*sensor.device.model())
    });
    let heads = [
        "sensor",
        "kind",
        "x, m",
        "y, m",
        "turned, °",
        "scans",
        "rays",
        "with a range",
        "median error, m",
        "off by 0.25 m",
    ];
    let sheet = Sheet {
        caption: "Readings of each sensor".to_owned(),
        heads: heads.map(str::to_owned).to_vec(),
        rows: camera.chain(beside).map(|row| row.into_iter().map(Into::into).collect()).collect(),
        ..Sheet::default()
    };
    Some(Section { heading: "Sensors".to_owned(), lead: LEAD.to_owned(), parts: vec![Part::Sheet(sheet)] })
}

fn row(name: &str, kind: &str, mount: Pose, read: &Scans, model: &dyn SensorModel) -> Vec<String> {
    let rays: usize = read.scans.iter().map(|scan| scan.bearings_rad.len()).sum();
    let mut errors_m: Vec<f64> = Vec::new();
    let mut ranges = 0usize;
    for (scan, truth) in read.scans.iter().zip(read.truth.iter().flatten()) {
        for (range_m, truth) in ranges_m(scan, model).zip(truth) {
            ranges += usize::from(range_m.is_some());
            errors_m.extend(range_m.zip(truth.range_m).map(|(range_m, truth_m)| (range_m - truth_m).abs()));
        }
    }
    errors_m.sort_by(f64::total_cmp);
    let median = errors_m.get(errors_m.len() / 2).map_or_else(|| "–".to_owned(), |error| format!("{error:.3}"));
    let off = errors_m.iter().filter(|error| **error > FALSE_M).count();
    let share = |of: usize, all: usize| {
        if all == 0 { "–".to_owned() } else { format!("{:.1} %", 100.0 * of as f64 / all as f64) }
    };
    vec![
        name.to_owned(),
        kind.to_owned(),
        format!("{:.2}", mount.x_m),
        format!("{:.2}", mount.y_m),
        format!("{:.0}", mount.theta_rad.to_degrees()),
        read.scans.len().to_string(),
        rays.to_string(),
        share(ranges, rays),
        median,
        share(off, errors_m.len()),
    ]
}

/// The range of every reading of a scan, m.
fn ranges_m<'a>(scan: &'a Scan, model: &'a dyn SensorModel) -> impl Iterator<Item = Option<f64>> + 'a {
    let rays = scan.readings.iter().zip(&scan.bearings_rad);
    rays.map(|(reading, bearing)| model.range_of((*reading)?, *bearing))
}

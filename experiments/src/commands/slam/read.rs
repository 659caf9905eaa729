//! A log read to its end: what the sensors read at each time, and where they stand on the robot.

use std::collections::BTreeMap;

use logs::{Event, Report, Sensor};
use sensor::{Pose, Scan};

use super::mounts::{self, Placed};
use super::options::SlamOptions;
use super::source::{Carrier, Taken};
use crate::failure::Failure;
use crate::output::note;
use crate::worlds::carried::Carried;
use crate::worlds::kernels;
use crate::worlds::source::{Source, refused};

/// What a log holds.
pub(super) struct Read {
    /// At least one; their times rise.
    pub(super) scans: Vec<Taken>,
    /// By rising numbers.
    pub(super) sensors: Vec<Carrier>,
    pub(super) report: Report,
    /// What took the first scan.
    pub(super) first: Sensor,
}

/// Reads all scans that are in use.
///
/// # Errors
/// A log that is refused, a scan without odometry, no scan at all, a sensor of which nobody knows where it stands.
pub(super) fn read(options: &SlamOptions, source: &Source, place: &str) -> Result<Read, Failure> {
    let mut log = source.log(&options.reading())?;
    let first = log.sensor();
    let (mut events, mut back, mut adrift): (Vec<(Event, Pose)>, usize, usize) = (Vec::new(), 0, 0);
    let mut last_s: BTreeMap<usize, f64> = BTreeMap::new();
    while let Some(event) = log.next_event() {
        let event = event.map_err(refused)?;
        // The file of --pose is the odometry of a bag.
        let odometry = if source.is_along() { Some(event.scan.pose) } else { event.odometry };
        // Lines of sonars have none of their own; where ODOM does not tell either, the lasers go on alone.
        if odometry.is_none() && matches!(event.kind, Sensor::Sonar { .. }) {
            adrift += 1;
            continue;
        }
        let Some(odometry) = odometry else {
            return Err(Failure::BadInput(format!(
                "{place}, line {}: the scan has no pose by odometry, which slam needs of every scan; give a CARMEN log, or a table with \
                 odom_x_m, odom_y_m and odom_theta_rad, or map the poses that it has with `replay`",
                event.line
            )));
        };
        if last_s.get(&event.sensor).is_some_and(|last_s| event.scan.time_s <= *last_s) {
            back += 1;
            continue;
        }
        last_s.insert(event.sensor, event.scan.time_s);
        events.push((event, odometry));
    }
    let report = log.report().clone();
    if events.is_empty() {
        let what = format!("{place}: none of its {} scans is in use; give another --window", report.scans);
        return Err(Failure::BadInput(what));
    }
    if adrift > 0 {
        note(format_args!(
            "warning: {place}: {adrift} scans of sonars have no pose by odometry and are left out; ODOM lines around them would place them"
        ));
    }
    if back > 0 {
        note(format_args!(
            "warning: {place}: {back} scans are not later than the one before them and are left out: the clock jumps"
        ));
    }
    // What sensors read at one time stands together; of two sensors a log may have written the later scan first.
    events.sort_by(|(a, _), (b, _)| a.scan.time_s.total_cmp(&b.scan.time_s).then(a.sensor.cmp(&b.sensor)));
    let sensors = carriers(place, source, &events)?;
    let scans = together(source, &sensors, events, report.start_s);
    Ok(Read { scans, sensors, report, first })
}

/// The sensors of a log, and where they stand.
fn carriers(place: &str, source: &Source, events: &[(Event, Pose)]) -> Result<Vec<Carrier>, Failure> {
    let mut kinds: BTreeMap<usize, Sensor> = BTreeMap::new();
    for (event, _) in events {
        kinds.entry(event.sensor).or_insert(event.kind);
    }
    let carrier = |(number, kind): (&usize, &Sensor), mount: Pose| Carrier {
        number: *number,
        called: kernels::called(*kind).to_owned(),
        kind: Some(*kind),
        mount,
    };
    if kinds.len() == 1 {
        // The poses of a bag are those of its sensor.
        let mount = events[0].0.mount.filter(|_| !source.is_bag()).unwrap_or_default();
        return Ok(kinds.iter().map(|known| Carrier { number: 0, ..carrier(known, mount) }).collect());
    }
    let placed = |(event, odometry): &(Event, Pose)| Placed {
        sensor: event.sensor,
        time_s: event.scan.time_s,
        pose: event.scan.pose,
        odometry: *odometry,
        mount: event.mount,
    };
    let mounts = mounts::mounts(place, &events.iter().map(placed).collect::<Vec<_>>())?;
    Ok(kinds.iter().map(|known| carrier(known, mounts.get(known.0).copied().unwrap_or_default())).collect())
}

/// The scans by their times. Of a bag, each has the pose of its sensor by odometry.
fn together(source: &Source, sensors: &[Carrier], events: Vec<(Event, Pose)>, start_s: f64) -> Vec<Taken> {
    let one = sensors.len() == 1;
    let mut scans: Vec<Taken> = Vec::new();
    for (event, odometry) in events {
        let number = if one { 0 } else { event.sensor };
        let mount =
            sensors.iter().find(|sensor| sensor.number == number).map(|sensor| sensor.mount).unwrap_or_default();
        let odometry = if source.is_bag() { mounts::body(odometry, mount) } else { odometry };
        let scan = Scan { sensor: number, ..event.scan };
        let time_s = scan.time_s;
        let carried = Carried { scan, mount };
        match scans.last_mut().filter(|last| last.time_s().total_cmp(&time_s).is_eq()) {
            Some(last) => last.scans.push(carried),
            None => {
                let (features, clock_s) = (Vec::new(), start_s + time_s);
                scans.push(Taken { scans: vec![carried], odometry, features, clock_s });
            }
        }
    }
    scans
}

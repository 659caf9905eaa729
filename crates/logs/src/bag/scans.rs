//! The second reading of a bag: its scans, one by one.

use std::collections::BTreeSet;
use std::sync::Arc;

use bags::messages::{DisparityImage, Header, Image, LaserScan};
use bags::{Loss, Record, Records};
use sensor::{Pose, Scan};

use super::beams::{Beams, Columns};
use super::drive::Drive;
use super::finding::BagFinding;
use super::frames::Known;
use super::plan::SensorPlan;
use super::seat::Seat;
use super::survey::ScanKind;
use super::{beams, plan};
use crate::finding::Finding;
use crate::options::Options;
use crate::ranges::{check_scale, check_unit};
use crate::record::{Recorded, Sensor};
use crate::report::{Gap, Report};

/// Scans of a drive, in the order of the bag.
pub(crate) struct Scans {
    drive: Arc<Drive>,
    records: Records,
    options: Options,
    /// Number of the message, from 1.
    number: u64,
    /// Topics of which it was said that their angles do not fit.
    uneven: BTreeSet<usize>,
}

/// A scan, or what is wrong with its message; with the number of the message.
pub(crate) type Item = (u64, Result<Recorded, String>);

/// Where a scan was taken, or why that is not known.
enum Place {
    Known(Seat),
    Gap(Gap),
    Unknown,
}

impl Scans {
    pub(crate) fn new(drive: &Arc<Drive>, options: &Options) -> Self {
        let topics: BTreeSet<String> = drive.plan.sensors.iter().map(|sensor| sensor.topic.clone()).collect();
        let records = drive.bag.records(move |topic| topics.contains(&topic.name));
        Self { drive: Arc::clone(drive), records, options: options.clone(), number: 0, uneven: BTreeSet::new() }
    }

    /// What is to be known of the bag before its scans are read.
    pub(crate) fn begin(&self, report: &mut Report) {
        report.noted.extend(self.drive.findings.iter().cloned().map(Finding::Bag));
        report.unit = crate::report::Unit::Message;
        report.poses = Some(self.drive.plan.poses.clone());
        for (number, sensor) in self.drive.plan.sensors.iter().enumerate() {
            report.sensors.entry(number).or_default().name.clone_from(&sensor.topic);
        }
    }

    /// The next scan; messages of other topics are counted.
    pub(crate) fn next(&mut self, report: &mut Report) -> Option<Item> {
        loop {
            let record = match self.records.next()? {
                Ok(record) => record,
                Err(damage) if damage.loss == Loss::Message => {
                    self.number += 1;
                    report.lines += 1;
                    return Some((self.number, Err(damage.to_string())));
                }
                Err(_) => continue, // was said in the first reading
            };
            self.number += 1;
            report.lines += 1;
            let drive = Arc::clone(&self.drive);
            let chosen = drive.plan.sensors.iter().position(|sensor| sensor.topic == record.topic.name);
            let Some(index) = chosen else {
                report.skip(&record.topic.name);
                continue;
            };
            let scan = self.scan(&drive.plan, index, &record, report);
            let named = |reason: String| format!("{}: {reason}", record.topic.name);
            return Some((self.number, scan.map_err(named)));
        }
    }

    fn scan(
        &mut self,
        plan: &plan::Plan,
        index: usize,
        record: &Record,
        report: &mut Report,
    ) -> Result<Recorded, String> {
        let sensor = &plan.sensors[index];
        let (encoding, bytes) = (record.topic.encoding, &record.bytes[..]);
        let header = Header::read(encoding, bytes)?;
        let (time_s, _) = self.drive.clock.time_s(header.stamp_ns, record.time_ns);
        let options = &self.options;
        let columns = Columns { focal_px: sensor.focal_px, centre_px: sensor.centre_px, rows: self.drive.rows };
        let (beams, kind) = match sensor.kind {
            ScanKind::Laser => {
                let scan = LaserScan::read(encoding, bytes)?;
                let (beams, max_range_m) = beams::laser(&scan, options, report)?;
                let kind = Sensor::Laser { max_range_m, beams: beams.readings.len() };
                self.fits(index, &sensor.topic, &scan, report);
                (beams, kind)
            }
            ScanKind::Disparities { .. } => {
                let image = DisparityImage::read(encoding, bytes)?;
                (columns.disparities(&image, options, report)?, Sensor::Stereo)
            }
            ScanKind::Depths => {
                let image = Image::read(encoding, bytes)?;
                (columns.depths(&image, self.drive.focal_baseline, options, report)?, Sensor::Stereo)
            }
        };
        let place = self.place(plan, sensor, time_s)?;
        if plan.are_odometry {
            report.sensors.entry(index).or_default().odometry_poses += 1;
        }
        Ok(self.recorded(plan, index, time_s, beams, kind, &place))
    }

    /// Notes once for a topic that the last beam does not go where the message claims.
    fn fits(&mut self, index: usize, topic: &str, scan: &LaserScan, report: &mut Report) {
        let beams = scan.ranges_m.len();
        let last_rad = scan.first_rad + (beams - 1) as f64 * scan.step_rad;
        let fits = (last_rad - scan.last_rad).abs() <= 1.5 * scan.step_rad.abs() + 1e-3;
        if !fits && self.uneven.insert(index) {
            let topic = topic.to_owned();
            let finding = BagFinding::Angles { topic, beams, last_rad, claimed_rad: scan.last_rad };
            report.noted.push(Finding::Bag(finding));
        }
    }

    fn place(&self, plan: &plan::Plan, sensor: &SensorPlan, time_s: f64) -> Result<Place, String> {
        let Some(way) = &sensor.way else {
            return Ok(Place::Known(Seat { pose: Pose::default(), ..sensor.mount }));
        };
        match plan.frames.at(way, time_s, self.options.max_gap_s) {
            Known::Here(motion) => Seat::of(&motion, sensor.axes).map(Place::Known),
            Known::Gap(gap) => Ok(Place::Gap(gap)),
            Known::Outside => Ok(Place::Unknown),
        }
    }

    fn recorded(
        &self,
        plan: &plan::Plan,
        index: usize,
        time_s: f64,
        beams: Beams,
        kind: Sensor,
        place: &Place,
    ) -> Recorded {
        let sensor = &plan.sensors[index];
        let Beams { mut bearings_rad, readings, mut raw } = beams;
        let (pose, is_mirrored, gap) = match place {
            Place::Known(seat) => (Some(seat.pose), seat.is_mirrored, None),
            Place::Gap(gap) => (None, false, Some(*gap)),
            Place::Unknown => (None, false, None),
        };
        if is_mirrored {
            bearings_rad.iter_mut().for_each(|bearing| *bearing = -*bearing);
        }
        let unit = match kind {
            Sensor::Laser { .. } => check_unit(&mut raw),
            Sensor::Stereo | Sensor::Sonar { .. } => check_scale(&mut raw, self.options.max_disparity_px),
        };
        Recorded {
            scan: Scan { sensor: index, time_s, pose: pose.unwrap_or_default(), bearings_rad, readings },
            mount: Some(sensor.mount.pose),
            odometry: pose.filter(|_| sensor.way.is_some()),
            placed: pose.is_some() && sensor.way.is_some(),
            gap,
            unit: unit.map_err(|reason| format!("{}: {reason}", sensor.topic)),
            ..Recorded::of(index, kind, self.number)
        }
    }
}

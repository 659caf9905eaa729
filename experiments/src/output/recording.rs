//! `--mcap FILE`: what happened, as Foxglove, Rerun and rosbag2 play it.
//!
//! An MCAP file of ROS 2 messages with their definitions beside them: the transform of the sensor, scans, poses, the truth and the maps of every
//! stage. The clock of simulated drives begins at [`START_S`], since a time of 0 means "now" to tf2.

mod cdr;
mod file;
mod messages;

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use clap::Args;
use grid::{GridSpec, Raster};
use sensor::{Pose, Scan, SensorModel};

use self::file::{MAGIC, McapFile};
use self::messages::{Kind, Stamp};
use super::single::{self, Existing, Whole};
use crate::failure::Failure;

/// Where the clock of a simulated drive begins, s.
pub const START_S: f64 = 1.0;

/// The frame that maps and poses are in.
const MAP: &str = "map";

/// Where a recording goes.
#[derive(Debug, Clone, Default, Args)]
pub struct RecordingOption {
    /// Also record scans, poses, truth and maps as ROS 2 messages, for Foxglove, Rerun and rosbag2: an MCAP file, which replaces a recording of that name
    #[arg(long, value_name = "FILE")]
    pub mcap: Option<PathBuf>,
}

impl RecordingOption {
    /// Refuses, before any work, a file that is read, is a folder, or is no recording.
    ///
    /// # Errors
    /// The file, and what to do.
    pub fn check(&self, reads: &[&Path]) -> Result<(), Failure> {
        let Some(path) = &self.mcap else { return Ok(()) };
        single::refuse_taken(path, reads, existing(path))
    }

    /// Writes what `record` records, whole or not at all, where a recording is wanted.
    ///
    /// # Errors
    /// A file that cannot be written, or that is no recording; whatever `record` says.
    pub fn save(
        &self,
        reads: &[&Path],
        record: impl FnOnce(&mut Recorder) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let Some(path) = &self.mcap else { return Ok(()) };
        let mut recorder = Recorder::new();
        record(&mut recorder)?;
        single::put(&[Whole { path: path.clone(), bytes: recorder.file.finish() }], reads, existing(path))
    }
}

/// A recording may be recorded anew; of another file nobody knows whose it is.
fn existing(path: &Path) -> Existing {
    let mut start = [0; MAGIC.len()];
    let is_recording = File::open(path).and_then(|mut file| file.read_exact(&mut start)).is_ok() && start == MAGIC;
    Existing::forced(is_recording)
}

/// An MCAP file that grows.
pub struct Recorder {
    file: McapFile,
    schemas: BTreeMap<&'static str, u16>,
    /// Channels by topic.
    channels: BTreeMap<String, u16>,
}

impl Recorder {
    fn new() -> Self {
        Self { file: McapFile::new("ros2", "sightgrid"), schemas: BTreeMap::new(), channels: BTreeMap::new() }
    }

    /// A scan, and where its sensor is. Beams at even angles are a `LaserScan` on `/scan`, others a `PointCloud2` on `/points`; topics and frames of
    /// further sensors end in their number.
    pub fn scan(&mut self, time_s: f64, scan: &Scan, sensor: &dyn SensorModel) {
        let number = if scan.sensor == 0 { String::new() } else { format!("_{}", scan.sensor) };
        let frame = format!("sensor{number}");
        self.put("/tf", Kind::Transforms, time_s, &messages::transform(Stamp::of(time_s), MAP, &frame, scan.pose));
        let range = |(reading, bearing): (&Option<f64>, &f64)| match *reading {
            Some(reading) if reading == f64::INFINITY => f64::INFINITY,
            reading => reading.and_then(|reading| sensor.range_of(reading, *bearing)).unwrap_or(f64::NAN),
        };
        let ranges: Vec<f64> = scan.readings.iter().zip(&scan.bearings_rad).map(range).collect();
        match messages::even(&scan.bearings_rad) {
            Some(step) => {
                let message = messages::laser_scan(Stamp::of(time_s), &frame, scan.bearings_rad[0], step, &ranges);
                self.put(&format!("/scan{number}"), Kind::LaserScan, time_s, &message);
            }
            None => {
                let message = messages::points(Stamp::of(time_s), &frame, &scan.bearings_rad, &ranges);
                self.put(&format!("/points{number}"), Kind::PointCloud2, time_s, &message);
            }
        }
    }

    /// A pose on a topic.
    pub fn pose(&mut self, topic: &str, time_s: f64, pose: Pose) {
        self.put(topic, Kind::PoseStamped, time_s, &messages::pose(Stamp::of(time_s), MAP, pose));
    }

    /// A map on a topic: percent, and -1 for cells that `known` does not hold.
    pub fn map(&mut self, topic: &str, time_s: f64, map: &Raster<f64>, known: &Raster<bool>) {
        let percent = |cell: usize| if known[cell] { (100.0 * map[cell]).round() as i8 } else { -1 };
        self.cells(topic, time_s, map.spec(), percent);
    }

    /// A truth on a topic: 100, 0, and -1 for what is not known.
    pub fn truth(&mut self, topic: &str, time_s: f64, truth: &Raster<Option<bool>>) {
        self.cells(topic, time_s, truth.spec(), |cell| {
            truth[cell].map_or(-1, |occupied| if occupied { 100 } else { 0 })
        })
    }

    fn cells(&mut self, topic: &str, time_s: f64, spec: &GridSpec, percent: impl Fn(usize) -> i8) {
        let cells: Vec<i8> = (0..spec.cells()).map(percent).collect();
        self.put(topic, Kind::OccupancyGrid, time_s, &messages::occupancy_grid(Stamp::of(time_s), MAP, spec, &cells));
    }

    fn put(&mut self, topic: &str, kind: Kind, time_s: f64, message: &[u8]) {
        let Self { file, schemas, channels } = self;
        if !channels.contains_key(topic) {
            let schema =
                *schemas.entry(kind.name()).or_insert_with(|| file.schema(kind.name(), "ros2msg", &kind.definition()));
            channels.insert(topic.to_owned(), file.channel(schema, topic, "cdr"));
        }
        file.message(channels[topic], Stamp::of(time_s).nanoseconds(), message);
    }
}

/// A name as a part of a topic: ROS knows letters, digits and underscores.
pub fn topic(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use sensor::Laser;

    fn scan() -> Scan {
        Scan {
            pose: Pose { x_m: 1.0, y_m: -2.0, theta_rad: 0.5 },
            bearings_rad: vec![-0.1, 0.0, 0.1],
            readings: vec![Some(2.0), None, Some(f64::INFINITY)],
            ..Scan::default()
        }
    }

    #[test]
    fn a_recording_is_read_back_by_topic_and_type() {
        let mut recorder = Recorder::new();
        let spec = GridSpec { cell_m: 0.1, origin_m: [0.0, 1.0], width: 3, height: 2 };
        let uneven = Scan { bearings_rad: vec![-0.1, 0.0, 0.3], sensor: 1, ..scan() };
        recorder.scan(START_S, &scan(), &Laser::default());
        recorder.scan(START_S, &uneven, &Laser::default());
        recorder.pose("/truth/pose", START_S, scan().pose);
        recorder.map("/map/a", 2.5, &Raster::filled(spec, 0.25), &Raster::filled(spec, true));
        recorder.truth("/truth", 2.5, &Raster::filled(spec, None));
        let read = file::tests::read(&recorder.file.finish());
        let found: Vec<(&str, &str, u64)> =
            read.iter().map(|(topic, name, time)| (topic.as_str(), name.as_str(), *time)).collect();
        assert_eq!(
            found,
            [
                ("/tf", "tf2_msgs/msg/TFMessage", 1_000_000_000),
                ("/scan", "sensor_msgs/msg/LaserScan", 1_000_000_000),
                ("/tf", "tf2_msgs/msg/TFMessage", 1_000_000_000),
                ("/points_1", "sensor_msgs/msg/PointCloud2", 1_000_000_000),
                ("/truth/pose", "geometry_msgs/msg/PoseStamped", 1_000_000_000),
                ("/map/a", "nav_msgs/msg/OccupancyGrid", 2_500_000_000),
                ("/truth", "nav_msgs/msg/OccupancyGrid", 2_500_000_000),
            ]
        );
    }

    #[test]
    fn recordings_are_replaced_and_other_files_are_not() {
        let folder = tempfile::tempdir().expect("a folder");
        let option = |name: &str| RecordingOption { mcap: Some(folder.path().join(name)) };
        option("a.mcap").save(&[], |_| Ok(())).expect("written");
        option("a.mcap")
            .save(&[], |recorder| {
                recorder.pose("/pose", 1.0, Pose::default());
                Ok(())
            })
            .expect("replaced");
        std::fs::write(folder.path().join("notes"), "mine").expect("writable");
        let error = option("notes").check(&[]).expect_err("not ours").to_string();
        assert!(error.contains("is there already"), "{error}");
        assert!(option("notes").save(&[], |_| Ok(())).is_err());
        assert_eq!(std::fs::read(folder.path().join("notes")).expect("there"), b"mine");
    }

    #[test]
    fn names_become_topics() {
        assert_eq!(topic("log-odds-octomap"), "log_odds_octomap");
    }
}

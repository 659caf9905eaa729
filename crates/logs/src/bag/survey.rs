//! The first reading of a bag: all but the readings.

use std::collections::BTreeMap;

use bags::messages::{CameraInfo, DisparityImage, Header, Image, LaserScan, Odometry, PoseStamped, Rigid, Transforms};
use bags::{Bag, Loss, Record};

use super::clock::{Clock, Stamp};
use super::finding::BagFinding;
use super::frames::{Edge, Frames};
use super::turn::Motion;

/// More poses and transforms are taken for a mistake: these need 400 MB.
const MOST_POSES: usize = 5_000_000;

/// Stamps of a topic by which clocks are compared.
const SAMPLES: usize = 1000;

/// What is known of a topic.
pub(super) struct Seen {
    pub(super) kind: String,
    pub(super) encoding: bags::Encoding,
    pub(super) messages: u64,
    /// When the first and the last message were recorded, ns.
    pub(super) recorded_ns: [u64; 2],
    /// Stamp and time of recording of all messages with a header.
    stamps: Vec<(i64, u64)>,
    /// Frame of the first message.
    pub(super) frame: Option<String>,
    /// What the scans are, if they are.
    pub(super) scans: Option<ScanKind>,
    /// Why the first message that cannot be read cannot, and how many there are.
    undecodable: Option<(String, u64)>,
}

/// What takes the scans of a topic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum ScanKind {
    Laser,
    /// Focal length times baseline, px·m, and the largest disparity, px, of the first message; width of its image.
    Disparities {
        focal_px: f64,
        focal_baseline: f64,
        max_px: f64,
    },
    Depths,
}

/// Poses of a topic.
pub(super) struct PoseTopic {
    /// The frame in which they are.
    pub(super) parent: String,
    /// Whose they are, if the messages say so.
    pub(super) child: Option<String>,
    pub(super) stamps: Vec<(f64, Motion)>,
}

/// What a bag holds but for the readings.
pub(super) struct Survey {
    pub(super) topics: BTreeMap<String, Seen>,
    pub(super) frames: Frames,
    pub(super) poses: BTreeMap<String, PoseTopic>,
    pub(super) cameras: BTreeMap<String, CameraInfo>,
    pub(super) clock: Clock,
    pub(super) start_ns: u64,
    pub(super) findings: Vec<BagFinding>,
    /// Messages that cannot be read at all.
    pub(super) is_empty: bool,
}

/// A pose as it was recorded.
type Raw = (i64, u64, Motion);

#[derive(Default)]
struct Gathered {
    topics: BTreeMap<String, Seen>,
    /// By parent, child, and whether they are static.
    edges: BTreeMap<(String, String, bool), (String, Vec<Raw>)>,
    poses: BTreeMap<String, (String, Option<String>, Vec<Raw>)>,
    cameras: BTreeMap<String, CameraInfo>,
    count: usize,
}

impl Survey {
    /// Reads a bag; says what makes it too large.
    pub(super) fn of(bag: &Bag) -> Result<Self, String> {
        let wanted = |topic: &bags::Topic| is_read(&topic.kind);
        let mut all = Gathered::default();
        let mut damaged: Option<(String, u64)> = None;
        let mut findings = Vec::new();
        for item in bag.records(wanted) {
            match item {
                Ok(record) => all.take(&record)?,
                Err(damage) => match damage.loss {
                    Loss::Message => {} // is said by whoever misses it
                    Loss::Index => findings.push(BagFinding::Unfinished { what: damage.to_string() }),
                    Loss::Chunk | Loss::Rest => damaged.get_or_insert_with(|| (damage.to_string(), 0)).1 += 1,
                },
            }
        }
        findings.extend(damaged.map(|(first, count)| BagFinding::Damaged { count, first }));
        Ok(all.finish(findings))
    }
}

/// Whether anything of such messages is used.
fn is_read(kind: &str) -> bool {
    [LaserScan::KIND, Image::KIND, CameraInfo::KIND, DisparityImage::KIND, Odometry::KIND].contains(&kind)
        || PoseStamped::KINDS.contains(&kind)
        || Transforms::KINDS.contains(&kind)
}

impl Gathered {
    fn take(&mut self, record: &Record) -> Result<(), String> {
        let topic = &record.topic;
        let seen = self.topics.entry(topic.name.clone()).or_insert_with(|| Seen {
            kind: topic.kind.clone(),
            encoding: topic.encoding,
            messages: 0,
            recorded_ns: [record.time_ns; 2],
            stamps: Vec::new(),
            frame: None,
            scans: None,
            undecodable: None,
        });
        seen.messages += 1;
        let [first, last] = seen.recorded_ns;
        seen.recorded_ns = [first.min(record.time_ns), last.max(record.time_ns)];
        if is_read(&topic.kind)
            && topic.encoding != bags::Encoding::Other
            && let Err(reason) = self.decode(record)
            && let Some(seen) = self.topics.get_mut(&topic.name)
        {
            seen.undecodable.get_or_insert((reason, 0)).1 += 1;
        }
        if self.count > MOST_POSES {
            return Err(format!(
                "has more than {MOST_POSES} poses and transforms; cut it into parts, such as with `ros2 bag convert`"
            ));
        }
        Ok(())
    }

    fn decode(&mut self, record: &Record) -> Result<(), String> {
        let (name, encoding, bytes) = (&record.topic.name, record.topic.encoding, &record.bytes[..]);
        let kind = record.topic.kind.as_str();
        if Transforms::KINDS.contains(&kind) {
            return self.transforms(record);
        }
        let header = Header::read(encoding, bytes)?;
        let time = (header.stamp_ns, record.time_ns);
        if let Some(seen) = self.topics.get_mut(name) {
            let is_first = seen.frame.is_none();
            seen.frame.get_or_insert_with(|| header.frame.clone());
            seen.stamps.push(time);
            match kind {
                LaserScan::KIND => seen.scans = Some(ScanKind::Laser),
                Image::KIND if is_first && Image::read(encoding, bytes)?.is_of_depths() => {
                    seen.scans = Some(ScanKind::Depths)
                }
                DisparityImage::KIND if seen.scans.is_none() => {
                    let image = DisparityImage::read(encoding, bytes)?;
                    let focal_baseline = image.focal_px * image.baseline_m.abs();
                    seen.scans =
                        Some(ScanKind::Disparities { focal_px: image.focal_px, focal_baseline, max_px: image.max_px });
                }
                _ => {}
            }
        }
        match kind {
            CameraInfo::KIND if !self.cameras.contains_key(name) => {
                self.cameras.insert(name.clone(), CameraInfo::read(encoding, bytes)?);
            }
            Odometry::KIND => {
                let message = Odometry::read(encoding, bytes)?;
                let child = Some(message.child).filter(|child| !child.is_empty());
                self.pose(name, header.frame, child, time, &message.pose)?;
            }
            _ if PoseStamped::KINDS.contains(&kind) => {
                let message = PoseStamped::read(encoding, bytes)?;
                self.pose(name, header.frame, None, time, &message.pose)?;
            }
            _ => {}
        }
        Ok(())
    }

    fn pose(
        &mut self,
        name: &str,
        parent: String,
        child: Option<String>,
        time: (i64, u64),
        pose: &Rigid,
    ) -> Result<(), String> {
        let motion = Motion::of(pose)?;
        self.count += 1;
        let poses = self.poses.entry(name.to_owned()).or_insert_with(|| (parent, child, Vec::new()));
        poses.2.push((time.0, time.1, motion));
        Ok(())
    }

    fn transforms(&mut self, record: &Record) -> Result<(), String> {
        let name = &record.topic.name;
        let is_static = name.ends_with("tf_static");
        let mut wrong = Ok(());
        for transform in Transforms::read(record.topic.encoding, &record.bytes)?.0 {
            let named = format!("{} > {}", transform.header.frame, transform.child);
            match Motion::of(&transform.pose) {
                Ok(motion) => {
                    self.count += 1;
                    let key = (transform.header.frame, transform.child, is_static);
                    let edge = self.edges.entry(key).or_insert_with(|| (name.clone(), Vec::new()));
                    edge.1.push((transform.header.stamp_ns, record.time_ns, motion));
                    if !is_static && let Some(seen) = self.topics.get_mut(name) {
                        seen.stamps.push((transform.header.stamp_ns, record.time_ns));
                    }
                }
                Err(reason) => wrong = Err(format!("the transform {named}: {reason}")),
            }
        }
        wrong
    }

    fn finish(self, mut findings: Vec<BagFinding>) -> Survey {
        let start_ns = self.topics.values().map(|seen| seen.recorded_ns[0]).min().unwrap_or(0);
        let samples = self.topics.values().flat_map(|seen| {
            let every = seen.stamps.len().div_ceil(SAMPLES).max(1);
            seen.stamps.iter().copied().step_by(every).filter(|(stamp, _)| *stamp != 0)
        });
        let clock = Clock::of(&samples.collect::<Vec<_>>(), start_ns);
        let timed = |raw: Vec<Raw>| -> Vec<(f64, Motion)> {
            raw.into_iter().map(|(stamp, recorded, motion)| (clock.time_s(stamp, recorded).0, motion)).collect()
        };
        for (name, seen) in &self.topics {
            let judged: Vec<Stamp> =
                seen.stamps.iter().map(|(stamp, recorded)| clock.time_s(*stamp, *recorded).1).collect();
            let count = |wanted: Stamp| judged.iter().filter(|stamp| **stamp == wanted).count() as u64;
            let (topic, messages, zero, off) =
                (name.clone(), judged.len() as u64, count(Stamp::Zero), count(Stamp::Off));
            // Of images and cameras that nothing is read of, nothing need be known.
            let is_used = seen.scans.is_some()
                || self.poses.contains_key(name)
                || Transforms::KINDS.contains(&seen.kind.as_str());
            if is_used && zero + off > 0 {
                findings.push(BagFinding::Stamps { topic, messages, zero, off });
            }
            if let Some((first, count)) = seen.undecodable.clone().filter(|_| seen.scans.is_none()) {
                findings.push(BagFinding::Undecodable { topic: name.clone(), count, first });
            }
        }
        let edges = self.edges.into_iter();
        let edges = edges
            .filter_map(|((parent, child, is_static), (_, raw))| Edge::new(&parent, &child, is_static, timed(raw)));
        let poses = self.poses.into_iter();
        let poses = poses.map(|(name, (parent, child, raw))| (name, PoseTopic { parent, child, stamps: timed(raw) }));
        Survey {
            frames: Frames::new(edges.collect()),
            poses: poses.collect(),
            is_empty: self.topics.is_empty(),
            topics: self.topics,
            cameras: self.cameras,
            clock,
            start_ns,
            findings,
        }
    }
}

impl Seen {
    /// First and last time of the messages, s by their stamps; none without headers.
    pub(super) fn span_s(&self, clock: &Clock) -> Option<[f64; 2]> {
        let times = self.stamps.iter().map(|(stamp, recorded)| clock.time_s(*stamp, *recorded).0);
        times.fold(None, |span, time| {
            let [first, last] = span.unwrap_or([time; 2]);
            Some([first.min(time), last.max(time)])
        })
    }
}

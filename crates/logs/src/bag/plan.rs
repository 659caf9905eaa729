//! Which topics are scans, and where each of their sensors stands: what was asked for, or what there is only one of.

use super::contents::{Contents, PoseCandidate, TopicSummary};
use super::finding::BagFinding;
use super::frames::{Edge, Frames, Step};
use super::options::{BagOptions, PoseSource};
use super::seat::{Axes, Seat};
use super::survey::{ScanKind, Survey};
use super::turn::Motion;
use crate::bag::frames::Known;
use crate::trajectory::Body;

/// The frame in which poses of a topic are: no frame of a bag has this name.
const ROOT: &str = "\0poses";

/// A source of poses must cover so much of the time of the scans.
const COVERED: f64 = 0.5;

/// What is tilted by more is said to be so, rad.
const TILTED_RAD: f64 = 5.0 / 180.0 * std::f64::consts::PI;

/// How a bag is read.
pub(super) struct Plan {
    pub(super) sensors: Vec<SensorPlan>,
    /// All frames, with that in which the poses of a topic are.
    pub(super) frames: Frames,
    /// Where poses come from, in words.
    pub(super) poses: String,
    /// Whether they are those of the odometry.
    pub(super) are_odometry: bool,
    /// The topics from which they and the mounts are.
    pose_topics: Vec<String>,
    pub(super) findings: Vec<BagFinding>,
}

impl Plan {
    /// Whether a finding is of something that is used.
    pub(super) fn concerns(&self, finding: &BagFinding) -> bool {
        let is_scan = |topic: &String| self.sensors.iter().any(|sensor| sensor.topic == *topic);
        match finding {
            BagFinding::Stamps { topic, .. } | BagFinding::Undecodable { topic, .. } => {
                is_scan(topic) || self.pose_topics.contains(topic)
            }
            _ => true,
        }
    }
}

/// A topic of scans.
pub(super) struct SensorPlan {
    pub(super) topic: String,
    pub(super) kind: ScanKind,
    pub(super) axes: Axes,
    /// From the map to the sensor; none where poses come from elsewhere.
    pub(super) way: Option<Vec<Step>>,
    /// Where it stands on the robot.
    pub(super) mount: Seat,
    /// Of a camera, focal length, px, and column and row of its axis; the middle of the image where that is not known.
    pub(super) focal_px: f64,
    pub(super) centre_px: Option<[f64; 2]>,
}

/// Why there is no plan.
pub(super) struct Refusal {
    pub(super) reason: String,
    /// Whether it lacks a choice, rather than that it cannot be.
    pub(super) is_open: bool,
}

fn refuse<T>(reason: String) -> Result<T, Refusal> {
    Err(Refusal { reason, is_open: false })
}

fn open<T>(reason: String) -> Result<T, Refusal> {
    Err(Refusal { reason, is_open: true })
}

/// What a bag holds, of a survey.
pub(super) fn contents(survey: &Survey) -> Contents {
    let since = |ns: u64| ns.saturating_sub(survey.start_ns) as f64 / 1e9;
    let topics: Vec<TopicSummary> = survey
        .topics
        .iter()
        .map(|(name, seen)| TopicSummary {
            name: name.clone(),
            kind: seen.kind.clone(),
            encoding: seen.encoding,
            messages: seen.messages,
            span_s: seen.recorded_ns.map(since),
        })
        .collect();
    let scans: Vec<String> =
        survey.topics.iter().filter(|(_, seen)| seen.scans.is_some()).map(|(name, _)| name.clone()).collect();
    let long_s = topics.iter().map(|topic| topic.span_s[1]).fold(0.0, f64::max);
    Contents { poses: candidates(survey, &scans), topics, scans, long_s }
}

/// Sources of poses that cover the time of the scans.
fn candidates(survey: &Survey, scans: &[String]) -> Vec<PoseCandidate> {
    let spans: Vec<[f64; 2]> = scans.iter().filter_map(|name| survey.topics[name].span_s(&survey.clock)).collect();
    let covers = |[from, to]: [f64; 2]| {
        spans.iter().any(|[first, last]| to.min(*last) - from.max(*first) >= COVERED * (last - first))
            || spans.is_empty()
    };
    let mut all = Vec::new();
    let odometries = survey.poses.iter().filter(|(name, _)| is_odometry(survey, name)).count();
    let mut named: Vec<&str> = Vec::new();
    for (name, poses) in &survey.poses {
        let edge = Edge::new("", "", false, poses.stamps.clone());
        if edge.is_some_and(|edge| edge.len() > 1 && covers(edge.span_s())) {
            let is_odometry = is_odometry(survey, name);
            if is_odometry {
                named.push(&poses.parent);
            }
            let option = if is_odometry && odometries == 1 { "odom".to_owned() } else { name.clone() };
            let kind = &survey.topics[name].kind;
            all.push(PoseCandidate { option, about: format!("{name}, {kind}, in the frame {}", poses.parent) });
        }
    }
    let mut frames: Vec<String> = Vec::new();
    for name in scans {
        let frame = survey.topics[name].frame.clone().unwrap_or_default();
        let base = survey.frames.base(&frame);
        for edge in survey.frames.above(&base) {
            let is_new = !frames.contains(&edge.parent) && !named.contains(&edge.parent.as_str());
            let is_known = !edge.is_static && (edge.moves() || ["odom", "map"].contains(&edge.parent.as_str()));
            // A correction that is said once, or that never changes, holds at all times.
            if is_new && is_known && (!edge.moves() || covers(edge.span_s())) {
                frames.push(edge.parent.clone());
            }
        }
    }
    let of_frame = |frame: String| PoseCandidate {
        about: format!("transforms from {frame} to the sensor"),
        option: format!("tf:{frame}"),
    };
    all.extend(frames.into_iter().map(of_frame));
    all
}

fn is_odometry(survey: &Survey, topic: &str) -> bool {
    survey.topics.get(topic).is_some_and(|seen| seen.kind == bags::messages::Odometry::KIND)
}

/// The plan by the options.
pub(super) fn plan(survey: &Survey, contents: &Contents, options: &BagOptions) -> Result<Plan, Refusal> {
    let scans = scans(survey, contents, options)?;
    let source = source(survey, contents, options)?;
    let mut findings = Vec::new();
    let poses = match &source {
        Source::Topic(name) => name.clone(),
        Source::Frame(frame) => format!("transforms below the frame {frame}"),
        Source::Elsewhere(_) => "the trajectory".to_owned(),
    };
    if options.scans.is_empty() || options.pose == PoseSource::Only {
        findings.push(BagFinding::Taken { scans: scans.clone(), poses: poses.clone() });
    }
    let are_odometry = match &source {
        Source::Topic(name) => is_odometry(survey, name),
        Source::Frame(frame) => frame.contains("odom"),
        Source::Elsewhere(_) => false,
    };
    let transforms =
        survey.topics.iter().filter(|(_, seen)| bags::messages::Transforms::KINDS.contains(&seen.kind.as_str()));
    let mut pose_topics: Vec<String> = transforms.map(|(name, _)| name.clone()).collect();
    if let Source::Topic(name) = &source {
        pose_topics.push(name.clone());
    }
    let mut edges = survey.frames.edges().to_vec();
    let first = survey.topics[&scans[0]].frame.clone().unwrap_or_default();
    let root = match &source {
        Source::Topic(name) => {
            let poses = &survey.poses[name];
            let child = poses.child.clone().unwrap_or_else(|| survey.frames.base(&first));
            edges.extend(Edge::new(ROOT, &child, false, poses.stamps.clone()));
            ROOT.to_owned()
        }
        Source::Frame(frame) => frame.clone(),
        Source::Elsewhere(_) => survey.frames.base(&first),
    };
    let mut mounting = Mounting { survey, options, source: &source, root: &root, findings: &mut findings };
    let mut mounted = Vec::new();
    for topic in &scans {
        mounted.push(mounting.sensor(topic, &mut edges)?);
    }
    let frames = Frames::new(edges);
    let sensors = mounted.into_iter().map(|sensor| mounting.seated(sensor, &frames)).collect::<Result<Vec<_>, _>>()?;
    Ok(Plan { sensors, frames, poses, are_odometry, pose_topics, findings })
}

/// Some names of a list, for messages.
fn some<'a>(names: impl ExactSizeIterator<Item = &'a str>) -> String {
    const SOME: usize = 6;
    let count = names.len();
    let mut all: Vec<String> = names.take(SOME).map(str::to_owned).collect();
    if count > SOME {
        all.push(format!("{} more", count - SOME));
    }
    all.join(", ")
}

/// Topics of scans: those that were asked for, or the only one.
fn scans(survey: &Survey, contents: &Contents, options: &BagOptions) -> Result<Vec<String>, Refusal> {
    let there = || if contents.scans.is_empty() { "no topic of scans".to_owned() } else { contents.scans.join(", ") };
    let mut found: Vec<String> = Vec::new();
    for asked in &options.scans {
        let name = [asked.clone(), format!("/{asked}")].into_iter().find(|name| survey.topics.contains_key(name));
        let Some(name) = name else {
            return refuse(format!("--scan {asked}: the bag has no such topic; it has {}", there()));
        };
        if !contents.scans.contains(&name) {
            let seen = &survey.topics[&name];
            let kind =
                if seen.kind == bags::messages::Image::KIND { "sensor_msgs/Image without depths" } else { &seen.kind };
            return refuse(format!(
                "--scan {asked}: is of type {kind}, and scans are LaserScan, DisparityImage, or Image of depths (16UC1, 32FC1); the bag has {}",
                there()
            ));
        }
        if found.contains(&name) {
            return refuse(format!("--scan {asked}: is given twice; name every topic once"));
        }
        found.push(name);
    }
    match (&found[..], &contents.scans[..]) {
        ([], [only]) => Ok(vec![only.clone()]),
        ([], []) => refuse(format!(
            "has no topic of scans (LaserScan, DisparityImage, or Image of depths) among its {} topics; record the scans, or give another bag",
            contents.topics.len()
        )),
        ([], all) => open(format!(
            "has {} topics of scans, {}: name those to be read by --scan",
            all.len(),
            some(all.iter().map(String::as_str))
        )),
        _ => Ok(found),
    }
}

/// A source of poses that is there.
enum Source {
    Topic(String),
    Frame(String),
    Elsewhere(Body),
}

fn source(survey: &Survey, contents: &Contents, options: &BagOptions) -> Result<Source, Refusal> {
    let there = || {
        let names = contents.poses.iter().map(|pose| pose.option.as_str());
        if contents.poses.is_empty() { "no source of poses".to_owned() } else { some(names) }
    };
    let odometries: Vec<&String> = survey.poses.keys().filter(|name| is_odometry(survey, name)).collect();
    match &options.pose {
        PoseSource::Elsewhere(body) => Ok(Source::Elsewhere(*body)),
        PoseSource::Topic(asked) => {
            let name = [asked.clone(), format!("/{asked}")].into_iter().find(|name| survey.topics.contains_key(name));
            match name {
                Some(name) if survey.poses.contains_key(&name) => Ok(Source::Topic(name)),
                Some(name) => refuse(format!(
                    "--pose {asked}: is of type {}, and poses are Odometry, PoseStamped or PoseWithCovarianceStamped; the bag has {}",
                    survey.topics[&name].kind,
                    there()
                )),
                None => refuse(format!("--pose {asked}: the bag has no such topic, and there is no such file; the bag has {}", there())),
            }
        }
        PoseSource::Frame(frame) if survey.frames.has(frame) => Ok(Source::Frame(frame.clone())),
        PoseSource::Frame(frame) if survey.frames.is_empty() => {
            refuse(format!("--pose tf:{frame}: the bag has no transforms (/tf); it has {}", there()))
        }
        PoseSource::Frame(frame) => {
            refuse(format!("--pose tf:{frame}: no transform has the frame {frame}; there are {}", survey.frames.described()))
        }
        PoseSource::Odometry => match odometries[..] {
            [only] => Ok(Source::Topic(only.clone())),
            [] if survey.frames.has("odom") => Ok(Source::Frame("odom".to_owned())),
            [] => refuse(format!("--pose odom: the bag has neither a topic of nav_msgs/Odometry nor a frame odom; it has {}", there())),
            ref all => {
                let names = some(all.iter().map(|name| name.as_str()));
                open(format!("--pose odom: {names} are of type nav_msgs/Odometry: name one of them by --pose"))
            }
        },
        PoseSource::Only => match &contents.poses[..] {
            [only] => match only.option.strip_prefix("tf:") {
                Some(frame) => Ok(Source::Frame(frame.to_owned())),
                None if only.option == "odom" => Ok(Source::Topic(odometries[0].clone())),
                None => Ok(Source::Topic(only.option.clone())),
            },
            [] => open(
                "has no source of poses that covers the time of the scans (Odometry, PoseStamped, or transforms above the sensor's frame): \
                 give poses by --pose FILE"
                    .to_owned(),
            ),
            all => open(format!("has {} sources of poses, {}: choose one by --pose", all.len(), there())),
        },
    }
}

/// A sensor before its way is known.
struct Unseated {
    topic: String,
    kind: ScanKind,
    frame: String,
    /// Whether its frame is taken for the robot's.
    is_unmounted: bool,
}

/// Puts sensors where they stand.
struct Mounting<'a> {
    survey: &'a Survey,
    options: &'a BagOptions,
    source: &'a Source,
    /// The frame from which ways begin.
    root: &'a str,
    findings: &'a mut Vec<BagFinding>,
}

impl Mounting<'_> {
    /// A sensor; where no transform connects it, one is added, or it is refused.
    fn sensor(&mut self, topic: &str, edges: &mut Vec<Edge>) -> Result<Unseated, Refusal> {
        let seen = &self.survey.topics[topic];
        let Some(kind) = seen.scans else { return refuse(format!("{topic} has no scans")) };
        let frame = seen.frame.clone().unwrap_or_default();
        let mut sensor = Unseated { topic: topic.to_owned(), kind, frame, is_unmounted: false };
        let is_connected = Frames::new(edges.clone()).way(self.root, &sensor.frame).is_some();
        if is_connected {
            return Ok(sensor);
        }
        let base = self.robot(&sensor.frame);
        let mount = match self.options.mount {
            Some(pose) => Motion::flat(pose),
            None if self.survey.frames.is_empty() || matches!(self.source, Source::Elsewhere(_)) => {
                if !matches!(self.source, Source::Elsewhere(Body::Sensor)) {
                    let frame = sensor.frame.clone();
                    self.findings.push(BagFinding::Unmounted { topic: topic.to_owned(), frame });
                }
                Motion::NONE
            }
            None => {
                return refuse(format!(
                    "the frame {:?} of {topic} is not connected to {base:?}; the transforms are {}: record /tf_static with the bag, or say where \
                     the sensor stands on the robot by --mount X,Y,DEGREES",
                    sensor.frame,
                    self.survey.frames.described()
                ));
            }
        };
        edges.extend(Edge::new(&base, &sensor.frame, true, vec![(0.0, mount)]));
        sensor.is_unmounted = true;
        Ok(sensor)
    }

    /// The frame of the robot below the source of poses.
    fn robot(&self, sensor: &str) -> String {
        match self.source {
            Source::Topic(name) => {
                self.survey.poses[name].child.clone().unwrap_or_else(|| self.survey.frames.base(sensor))
            }
            Source::Elsewhere(_) => self.root.to_owned(),
            Source::Frame(frame) => {
                let usual = ["base_link", "base_footprint"];
                let below = |name: &&str| self.survey.frames.has(name) && self.survey.frames.way(frame, name).is_some();
                let moved = self.survey.frames.edges().iter().rev().find(|edge| edge.moves());
                let found = usual.iter().copied().find(below).map(str::to_owned);
                found.or_else(|| moved.map(|edge| edge.child.clone())).unwrap_or_else(|| frame.clone())
            }
        }
    }

    fn seated(&mut self, sensor: Unseated, frames: &Frames) -> Result<SensorPlan, Refusal> {
        let Unseated { topic, kind, frame, is_unmounted } = sensor;
        let way = frames.way(self.root, &frame);
        let is_elsewhere = matches!(self.source, Source::Elsewhere(_));
        let base = if is_elsewhere || is_unmounted { self.robot(&frame) } else { frames.base(&frame) };
        let time_s =
            self.survey.topics[&topic].span_s(&self.survey.clock).map_or(0.0, |[first, last]| 0.5 * (first + last));
        let mount = frames.way(&base, &frame).map(|way| frames.at(&way, time_s, f64::INFINITY));
        let mount = match mount {
            Some(Known::Here(motion)) => motion,
            _ => Motion::NONE,
        };
        let (axes, mount) = self.axes(&topic, &frame, kind, &mount, is_unmounted)?;
        if mount.tilt_rad > TILTED_RAD {
            self.findings.push(BagFinding::Tilted { topic: topic.clone(), by_rad: mount.tilt_rad });
        }
        let (focal_px, centre_px) = self.camera(&topic, kind)?;
        Ok(SensorPlan { way: way.filter(|_| !is_elsewhere), topic, kind, axes, mount, focal_px, centre_px })
    }

    /// What the axes of a sensor are: those of its kind, unless a camera's frame can only be that of a body.
    fn axes(
        &mut self,
        topic: &str,
        frame: &str,
        kind: ScanKind,
        mount: &Motion,
        is_unmounted: bool,
    ) -> Result<(Axes, Seat), Refusal> {
        let is_optical = kind != ScanKind::Laser && !is_unmounted;
        let usual = if is_optical { Axes::Optical } else { Axes::Body };
        match Seat::of(mount, usual) {
            Ok(seat) => Ok((usual, seat)),
            Err(reason) if is_optical => match Seat::of(mount, Axes::Body) {
                Ok(seat) => {
                    self.findings.push(BagFinding::BodyAxes { topic: topic.to_owned(), frame: frame.to_owned() });
                    Ok((Axes::Body, seat))
                }
                Err(_) => refuse(format!("{topic}: {reason}; a map of the floor needs a sensor that looks along it")),
            },
            Err(reason) => refuse(format!("{topic}: {reason}; a map of the floor needs a sensor that looks along it")),
        }
    }

    /// Focal length and axis of a camera, by the messages of the camera beside its images.
    fn camera(&mut self, topic: &str, kind: ScanKind) -> Result<(f64, Option<[f64; 2]>), Refusal> {
        let cameras = &self.survey.cameras;
        let folder = topic.rsplit_once('/').map_or("", |(folder, _)| folder);
        let frame = self.survey.topics[topic].frame.as_deref().unwrap_or_default();
        let beside = [format!("{folder}/camera_info"), format!("{folder}/left/camera_info")];
        let found = beside.iter().find_map(|name| cameras.get(name));
        let found = found.or_else(|| cameras.values().find(|camera| camera.header.frame == frame));
        let found = found.or_else(|| cameras.values().next().filter(|_| cameras.len() == 1));
        let found = found.filter(|camera| {
            let [u, v] = camera.centre_px;
            camera.focal_px > 0.0 && [camera.focal_px, u, v].into_iter().all(f64::is_finite)
        });
        match (kind, found) {
            (ScanKind::Laser, _) => Ok((0.0, None)),
            (ScanKind::Disparities { focal_px, focal_baseline, .. }, found) => {
                if !(focal_baseline > 0.0 && focal_baseline.is_finite()) {
                    return refuse(format!(
                        "{topic}: its focal length times baseline is {focal_baseline} px·m, which must be above 0"
                    ));
                }
                if found.is_none() {
                    self.findings.push(BagFinding::NoCentre { topic: topic.to_owned() });
                }
                Ok((focal_px, found.map(|camera| camera.centre_px)))
            }
            (ScanKind::Depths, Some(camera)) => Ok((camera.focal_px, Some(camera.centre_px))),
            (ScanKind::Depths, None) => refuse(format!(
                "{topic}: no CameraInfo with a focal length belongs to it, so that nothing says where its columns look; record the camera_info \
                 beside it"
            )),
        }
    }
}

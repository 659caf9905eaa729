//! A log or a bag on disk, opened once and read as often as it is needed.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;
use logs::bag::{BagOptions, Contents, Drive, PoseSource};
use logs::{Body, Log, LogError, Trajectory};
use sensor::Pose;
use serde_json::{Value, json};

use crate::failure::Failure;
use crate::output::args::{Given, count};
use crate::output::{note, table};

/// What of a bag is read.
#[derive(Debug, Clone, Args)]
pub struct BagArgs {
    /// Topic of scans: LaserScan, DisparityImage or Image of depths; may be given several times, a sensor each [default: the only one]
    #[arg(long, help_heading = "Bags of ROS", value_name = "TOPIC")]
    pub scan: Vec<String>,
    /// Where the robot's poses come from: the odometry, a topic, the transforms between a frame and the sensor, or a file in the TUM format [default: the only source]
    #[arg(long, help_heading = "Bags of ROS", value_name = "odom|TOPIC|tf:FRAME|FILE")]
    pub pose: Option<String>,
    /// Where sensors stand on the robot that no transform tells of, m and degrees
    #[arg(long, help_heading = "Bags of ROS", value_name = "X,Y,DEG", allow_hyphen_values = true, value_parser = mount)]
    pub mount: Option<Pose>,
    /// Of images, read the nearest of so many rows about the axis of the camera
    #[arg(long, help_heading = "Bags of ROS", value_name = "N", default_value_t = 1, allow_negative_numbers = true, value_parser = count(10_000))]
    pub rows: u32,
    /// List what is in the bag, and read nothing
    #[arg(long, help_heading = "Bags of ROS")]
    pub topics: bool,
}

/// Options that are of bags alone.
const OF_BAGS: [&str; 5] = ["scan", "pose", "mount", "rows", "topics"];

fn mount(text: &str) -> Result<Pose, String> {
    let parts: Option<Vec<f64>> =
        text.split(',').map(|part| part.trim().parse().ok().filter(|value: &f64| value.abs() <= 1000.0)).collect();
    match parts.as_deref() {
        Some([x_m, y_m, degrees]) => Ok(Pose { x_m: *x_m, y_m: *y_m, theta_rad: degrees.to_radians() }),
        _ => Err("must be x and y in m and an angle in degrees, such as 0.2,0,180".to_owned()),
    }
}

impl BagArgs {
    /// What a record keeps of them; none where nothing was given.
    pub fn record(&self) -> Option<Value> {
        let Self { scan, pose, mount, rows, topics: _ } = self;
        let mount = mount.map(|mount| [mount.x_m, mount.y_m, mount.theta_rad.to_degrees()]);
        let is_given = !scan.is_empty() || pose.is_some() || mount.is_some() || *rows > 1;
        is_given.then(|| json!({"scan": scan, "pose": pose, "mount": mount, "rows": rows}))
    }

    /// The options that a command needs to read the same bag so again.
    pub fn words(&self) -> Vec<String> {
        let mut words: Vec<String> = self.scan.iter().flat_map(|topic| ["--scan".to_owned(), topic.clone()]).collect();
        words.extend(self.pose.iter().flat_map(|pose| ["--pose".to_owned(), pose.clone()]));
        if let Some(Pose { x_m, y_m, theta_rad }) = self.mount {
            words.push(format!("--mount={x_m},{y_m},{}", theta_rad.to_degrees()));
        }
        if self.rows > 1 {
            words.extend(["--rows".to_owned(), self.rows.to_string()]);
        }
        words
    }
}

/// A log that can be read from its beginning again and again.
pub struct Source {
    path: PathBuf,
    drive: Option<Arc<Drive>>,
    trajectory: Option<(Trajectory, Body)>,
}

/// What a command says of its log.
pub struct Asked<'a> {
    /// The name of the command, for the line to type.
    pub command: &'static str,
    /// The log.
    pub path: &'a Path,
    /// What of it is read, if it is a bag.
    pub bag: &'a BagArgs,
    /// A trajectory that is to give the poses.
    pub trajectory: Option<&'a Path>,
    /// What a trajectory is of.
    pub body: Body,
    /// Focal length times baseline of a camera of depths, px·m.
    pub focal_baseline: f64,
    /// Which options were given.
    pub given: &'a Given,
}

impl Source {
    /// Opens a log; of a bag, everything but the readings is read. None where topics were to be listed, which is then done.
    ///
    /// # Errors
    /// A log, bag or trajectory that is refused, a choice that a bag leaves open.
    pub fn open(asked: &Asked) -> Result<Option<Self>, Failure> {
        let path = asked.path.to_owned();
        let opened = |file: &Path| Trajectory::open(file).map_err(refused);
        if !Drive::is_at(&path) {
            asked.given.warn(&OF_BAGS, &path.display().to_string(), "a log that is no bag");
            let trajectory = asked.trajectory.map(opened).transpose()?.map(|trajectory| (trajectory, asked.body));
            return Ok(Some(Self { path, drive: None, trajectory }));
        }
        if asked.bag.topics {
            let contents = Drive::contents_of(&path).map_err(refused)?;
            let typed = line(asked, &contents).map(|line| format!("\nsuch as: {line}")).unwrap_or_default();
            table::print(&format!("{contents}{typed}\n"))?;
            return Ok(None);
        }
        let (pose, file) = pose(asked)?;
        let trajectory = match (file, &pose) {
            (Some(file), PoseSource::Elsewhere(body)) => Some((opened(file)?, *body)),
            _ => None,
        };
        let options = BagOptions {
            scans: asked.bag.scan.clone(),
            pose,
            rows: asked.bag.rows as usize,
            focal_baseline: asked.focal_baseline,
            mount: asked.bag.mount,
        };
        let drive = Drive::open(&path, &options).map_err(|error| match error {
            LogError::Undecided { contents, place, reason } => {
                let typed = line(asked, &contents).map(|line| format!(", such as: {line}")).unwrap_or_default();
                match table::print(&format!("{contents}\n")) {
                    Ok(()) => Failure::BadInput(format!("{place}: {reason}{typed}")),
                    Err(failure) => failure,
                }
            }
            error => refused(error),
        })?;
        Ok(Some(Self { path, drive: Some(drive), trajectory }))
    }

    /// The log from its beginning.
    ///
    /// # Errors
    /// A log that is refused.
    pub fn log(&self, options: &logs::Options) -> Result<Log<'static>, Failure> {
        let log = match &self.drive {
            Some(drive) => Log::of_drive(drive, options),
            None => Log::open(&self.path, options),
        };
        let log = log.map_err(refused)?;
        match &self.trajectory {
            Some((trajectory, body)) => log.along(trajectory.clone(), *body).map_err(refused),
            None => Ok(log),
        }
    }

    /// How messages call it.
    pub fn place(&self) -> String {
        self.path.display().to_string()
    }

    /// Whether it is a bag.
    pub fn is_bag(&self) -> bool {
        self.drive.is_some()
    }

    /// Whether a trajectory gives the poses.
    pub fn is_along(&self) -> bool {
        self.trajectory.is_some()
    }

    /// Takes the camera that the messages of a bag tell of, where options do not give another.
    pub fn adapt(&self, given: &Given, focal_baseline: &mut f64, max_disparity: &mut f64) {
        let Some(camera) = self.drive.as_ref().and_then(|drive| drive.camera()) else { return };
        if !given.has("focal_baseline") {
            *focal_baseline = camera.focal_baseline;
        } else if (*focal_baseline / camera.focal_baseline - 1.0).abs() > 0.01 {
            note(format_args!(
                "warning: {}: its messages say that focal length times baseline is {} px·m, and --focal-baseline {focal_baseline}: leave the \
                 option out",
                self.place(),
                camera.focal_baseline
            ));
        }
        if let Some(most) = camera.max_disparity_px.filter(|_| !given.has("max_disparity")) {
            *max_disparity = most;
        }
    }
}

/// The source of poses that options name, and the file if it is one.
fn pose<'a>(asked: &Asked<'a>) -> Result<(PoseSource, Option<&'a Path>), Failure> {
    let Some(text) = asked.bag.pose.as_deref() else {
        let elsewhere = asked.trajectory.map(|_| PoseSource::Elsewhere(asked.body));
        return Ok((elsewhere.unwrap_or_default(), asked.trajectory));
    };
    if asked.trajectory.is_some() {
        let what = format!("--pose {text}: --trajectory gives the poses too; leave one of them out");
        return Err(Failure::BadInput(what));
    }
    let file = Path::new(text);
    Ok(match PoseSource::named(text) {
        // The poses of a bag are the robot's, and so are those of a file in their place.
        PoseSource::Topic(_) if file.is_file() => {
            let body = if asked.given.has("body") { asked.body } else { Body::Robot };
            (PoseSource::Elsewhere(body), Some(file))
        }
        named => (named, None),
    })
}

/// The command that reads a bag, with what must be chosen; none where there is nothing to choose from.
fn line(asked: &Asked, contents: &Contents) -> Option<String> {
    let scan = asked.bag.scan.first().or(contents.scans.first())?;
    let pose = asked.bag.pose.as_ref().or(contents.poses.first().map(|pose| &pose.option));
    let pose = pose.map_or("FILE", String::as_str);
    let path = asked.path.display().to_string();
    let path = shlex::try_quote(&path).ok()?;
    Some(format!("{} {path} --scan {scan} --pose {pose}", asked.command))
}

/// A log is input: what is wrong with it, the user can correct.
pub fn refused(error: LogError) -> Failure {
    Failure::BadInput(error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mount_is_two_lengths_and_an_angle() {
        let found = mount("0.2, -0.1,180").expect("a mount");
        assert!((found.x_m - 0.2).abs() < 1e-12 && (found.theta_rad - std::f64::consts::PI).abs() < 1e-12);
        assert!(["1,2", "1,2,3,4", "a,b,c", "1,2,inf", ""].iter().all(|text| mount(text).is_err()));
    }
}

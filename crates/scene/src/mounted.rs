//! Sensors that the robot carries beside the camera, and which of them sees what.

use sensor::{Device, Pose, SensorKind};

/// A sensor on the robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Mounted {
    /// Its name, another one than those of the others and than `camera`.
    pub name: String,
    /// What it is.
    pub device: Device,
    /// Where it stands and looks, in the frame of the robot.
    pub mount: Pose,
    /// Angle of every ray, or axis of a cone, to the axis of the sensor, rad, rising.
    pub bearings_rad: Vec<f64>,
    /// It reads at every so manyth scan of the drive, from the first on.
    pub every: usize,
    /// A surface that makes a smaller angle with the ray gives no reading, rad; 0 of all but depth cameras.
    pub grazing_rad: f64,
}

impl Mounted {
    /// Where the sensor stands when the robot stands at `robot`.
    pub fn pose(&self, robot: Pose) -> Pose {
        robot.compose(self.mount)
    }

    /// Whether it reads at a scan of the drive, counted from 0.
    pub fn reads_at(&self, scan: usize) -> bool {
        scan.is_multiple_of(self.every)
    }
}

/// The share of the readings of every kind of sensor that end on an obstacle; the others pass through to what is behind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeenBy([f64; SensorKind::ALL.len()]);

impl SeenBy {
    /// Every reading ends on it.
    pub const ALL: Self = Self([1.0; SensorKind::ALL.len()]);

    /// The share of a kind of sensor, 0 to 1.
    pub fn share(&self, kind: SensorKind) -> f64 {
        self.0[kind as usize]
    }

    /// The same, with another share for a kind.
    pub fn with(mut self, kind: SensorKind, share: f64) -> Self {
        self.0[kind as usize] = share;
        self
    }
}

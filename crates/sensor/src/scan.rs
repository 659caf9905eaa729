//! What a sensor saw from one place.

/// Where a sensor stands: position in metres, heading in radians counter-clockwise from x.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pose {
    /// Position along x, m.
    pub x_m: f64,
    /// Position along y, m.
    pub y_m: f64,
    /// Heading of the optical axis, rad.
    pub theta_rad: f64,
}

/// One scan: a pose and one reading, or none, per bearing.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scan {
    /// Number of the sensor that took it, from 0; 0 where there is one.
    pub sensor: usize,
    /// Time since the start of the run, s.
    pub time_s: f64,
    /// Where the sensor stood.
    pub pose: Pose,
    /// Angle of every ray to the optical axis, rad, counter-clockwise.
    pub bearings_rad: Vec<f64>,
    /// The reading of every ray in the sensor's unit (px for disparity, m for range); `None` where it gave none and
    /// nothing is to be learnt from that, `f64::INFINITY` where nothing came back and that is what was measured.
    pub readings: Vec<Option<f64>>,
}

/// One viewing ray of a scan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where the ray starts, m.
    pub origin_m: [f64; 2],
    /// Unit vector along the ray, in the frame of the map.
    pub direction: [f64; 2],
    /// Angle to the optical axis, rad.
    pub bearing_rad: f64,
    /// The reading, if there is one; infinite where nothing came back.
    pub reading: Option<f64>,
}

impl Pose {
    /// Position, m.
    pub fn position_m(&self) -> [f64; 2] {
        [self.x_m, self.y_m]
    }

    /// Unit vector of the ray at `bearing` (rad) to the optical axis.
    pub fn direction(&self, bearing: f64) -> [f64; 2] {
        let (sin, cos) = libm::sincos(self.theta_rad + bearing);
        [cos, sin]
    }

    /// The pose of what is mounted so on a body of this pose; the heading is not wrapped.
    pub fn compose(self, mount: Self) -> Self {
        let (sin, cos) = libm::sincos(self.theta_rad);
        Self {
            x_m: self.x_m + cos * mount.x_m - sin * mount.y_m,
            y_m: self.y_m + sin * mount.x_m + cos * mount.y_m,
            theta_rad: self.theta_rad + mount.theta_rad,
        }
    }

    /// This pose in the frame of another, which undoes [`compose`](Self::compose); the heading is not wrapped.
    pub fn seen_from(self, from: Self) -> Self {
        let (sin, cos) = libm::sincos(from.theta_rad);
        let [x, y] = [self.x_m - from.x_m, self.y_m - from.y_m];
        Self { x_m: cos * x + sin * y, y_m: cos * y - sin * x, theta_rad: self.theta_rad - from.theta_rad }
    }
}

impl Scan {
    /// Whether another sensor, of a higher number, took the next scan at the same time.
    pub fn is_with(&self, next: &Scan) -> bool {
        self.time_s.to_bits() == next.time_s.to_bits() && self.sensor < next.sensor
    }

    /// The rays of the scan in order of their bearings.
    pub fn rays(&self) -> impl ExactSizeIterator<Item = Ray> {
        debug_assert_eq!(self.bearings_rad.len(), self.readings.len(), "one reading per bearing");
        self.bearings_rad.iter().zip(&self.readings).map(|(&bearing_rad, &reading)| Ray {
            origin_m: self.pose.position_m(),
            direction: self.pose.direction(bearing_rad),
            bearing_rad,
            reading,
        })
    }
}

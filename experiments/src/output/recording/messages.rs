//! The messages of ROS 2 that a recording has, and their definitions (common_interfaces and geometry2, of Humble and later).

use grid::GridSpec;
use sensor::Pose;

use super::cdr::Cdr;

/// A time of ROS.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Stamp {
    seconds: i32,
    nanoseconds: u32,
}

impl Stamp {
    /// Of seconds, 0 or more: to the nanosecond.
    pub(super) fn of(time_s: f64) -> Self {
        let time_s = time_s.max(0.0);
        let mut seconds = time_s.floor();
        let mut nanoseconds = ((time_s - seconds) * 1e9).round();
        if nanoseconds >= 1e9 {
            (seconds, nanoseconds) = (seconds + 1.0, 0.0);
        }
        Self { seconds: seconds as i32, nanoseconds: nanoseconds as u32 }
    }

    pub(super) fn nanoseconds(self) -> u64 {
        u64::from(self.seconds.unsigned_abs()) * 1_000_000_000 + u64::from(self.nanoseconds)
    }
}

/// Types of messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Transforms,
    LaserScan,
    PointCloud2,
    PoseStamped,
    OccupancyGrid,
}

impl Kind {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Transforms => "tf2_msgs/msg/TFMessage",
            Self::LaserScan => "sensor_msgs/msg/LaserScan",
            Self::PointCloud2 => "sensor_msgs/msg/PointCloud2",
            Self::PoseStamped => "geometry_msgs/msg/PoseStamped",
            Self::OccupancyGrid => "nav_msgs/msg/OccupancyGrid",
        }
    }

    /// Its definition, with those of all that it consists of.
    pub(super) fn definition(self) -> String {
        let (own, parts): (&str, &[(&str, &str)]) = match self {
            Self::Transforms => (
                "geometry_msgs/TransformStamped[] transforms\n",
                &[
                    (
                        "geometry_msgs/TransformStamped",
                        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n",
                    ),
                    (
                        "geometry_msgs/Transform",
                        "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n",
                    ),
                    ("geometry_msgs/Vector3", XYZ),
                    ("geometry_msgs/Quaternion", XYZW),
                    HEADER,
                    TIME,
                ],
            ),
            Self::LaserScan => (
                "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\nfloat32 time_increment\n\
                 float32 scan_time\nfloat32 range_min\nfloat32 range_max\nfloat32[] ranges\nfloat32[] intensities\n",
                &[HEADER, TIME],
            ),
            Self::PointCloud2 => (
                "std_msgs/Header header\nuint32 height\nuint32 width\nsensor_msgs/PointField[] fields\nbool is_bigendian\n\
                 uint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n",
                &[
                    (
                        "sensor_msgs/PointField",
                        "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\nuint8 INT32=5\nuint8 UINT32=6\nuint8 FLOAT32=7\n\
                         uint8 FLOAT64=8\nstring name\nuint32 offset\nuint8 datatype\nuint32 count\n",
                    ),
                    HEADER,
                    TIME,
                ],
            ),
            Self::PoseStamped => {
                ("std_msgs/Header header\ngeometry_msgs/Pose pose\n", &[POSE, POINT, QUATERNION, HEADER, TIME])
            }
            Self::OccupancyGrid => (
                "std_msgs/Header header\nnav_msgs/MapMetaData info\nint8[] data\n",
                &[
                    (
                        "nav_msgs/MapMetaData",
                        "builtin_interfaces/Time map_load_time\nfloat32 resolution\nuint32 width\nuint32 height\ngeometry_msgs/Pose origin\n",
                    ),
                    POSE,
                    POINT,
                    QUATERNION,
                    HEADER,
                    TIME,
                ],
            ),
        };
        let line = "=".repeat(80);
        parts.iter().fold(own.to_owned(), |text, (name, part)| format!("{text}{line}\nMSG: {name}\n{part}"))
    }
}

const XYZ: &str = "float64 x\nfloat64 y\nfloat64 z\n";
const XYZW: &str = "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n";
const TIME: (&str, &str) = ("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n");
const HEADER: (&str, &str) = ("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n");
const POSE: (&str, &str) =
    ("geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n");
const POINT: (&str, &str) = ("geometry_msgs/Point", XYZ);
const QUATERNION: (&str, &str) = ("geometry_msgs/Quaternion", XYZW);

fn begun(stamp: Stamp, frame: &str) -> Cdr {
    let mut cdr = Cdr::new();
    header(&mut cdr, stamp, frame);
    cdr
}

fn header(cdr: &mut Cdr, stamp: Stamp, frame: &str) {
    cdr.i32(stamp.seconds);
    cdr.u32(stamp.nanoseconds);
    cdr.text(frame);
}

/// Place and quaternion.
fn placed(cdr: &mut Cdr, pose: Pose) {
    let (sin, cos) = libm::sincos(0.5 * pose.theta_rad);
    [pose.x_m, pose.y_m, 0.0, 0.0, 0.0, sin, cos].into_iter().for_each(|value| cdr.f64(value));
}

pub(super) fn transform(stamp: Stamp, parent: &str, child: &str, pose: Pose) -> Vec<u8> {
    let mut cdr = Cdr::new();
    cdr.u32(1);
    header(&mut cdr, stamp, parent);
    cdr.text(child);
    placed(&mut cdr, pose);
    cdr.finish()
}

pub(super) fn pose(stamp: Stamp, frame: &str, pose: Pose) -> Vec<u8> {
    let mut cdr = begun(stamp, frame);
    placed(&mut cdr, pose);
    cdr.finish()
}

/// The angle from beam to beam, rad, if it is the same for all.
pub(super) fn even(bearings_rad: &[f64]) -> Option<f64> {
    let (first, last) = (bearings_rad.first()?, bearings_rad.last()?);
    let step = if bearings_rad.len() > 1 { (last - first) / (bearings_rad.len() - 1) as f64 } else { 0.0 };
    let at_step = |(k, bearing): (usize, &f64)| (first + k as f64 * step - bearing).abs() < 1e-4;
    bearings_rad.iter().enumerate().all(at_step).then_some(step)
}

/// Ranges in m: NaN where there is none, infinite where nothing came back (REP 117).
pub(super) fn laser_scan(stamp: Stamp, frame: &str, first_rad: f64, step_rad: f64, ranges: &[f64]) -> Vec<u8> {
    let mut cdr = begun(stamp, frame);
    let last = first_rad + step_rad * ranges.len().saturating_sub(1) as f64;
    let farthest = ranges.iter().copied().filter(|range| range.is_finite()).fold(0.0, f64::max);
    [first_rad, last, step_rad, 0.0, 0.0, 0.0, farthest].into_iter().for_each(|value| cdr.f32(value as f32));
    cdr.f32s(ranges.iter().map(|range| *range as f32));
    cdr.f32s(std::iter::empty());
    cdr.finish()
}

/// The ends of rays, in the sensor's frame; rays without an end are left out.
pub(super) fn points(stamp: Stamp, frame: &str, bearings_rad: &[f64], ranges: &[f64]) -> Vec<u8> {
    const STEP: u32 = 12;
    const FLOAT32: u8 = 7;
    let ends: Vec<[f32; 3]> = bearings_rad
        .iter()
        .zip(ranges)
        .filter(|(_, range)| range.is_finite())
        .map(|(bearing, range)| {
            let (sin, cos) = libm::sincos(*bearing);
            [(range * cos) as f32, (range * sin) as f32, 0.0]
        })
        .collect();
    let mut cdr = begun(stamp, frame);
    cdr.u32(1);
    cdr.u32(ends.len() as u32);
    cdr.u32(3);
    for (k, name) in ["x", "y", "z"].into_iter().enumerate() {
        cdr.text(name);
        cdr.u32(4 * k as u32);
        cdr.u8(FLOAT32);
        cdr.u32(1);
    }
    cdr.bool(false);
    cdr.u32(STEP);
    cdr.u32(STEP * ends.len() as u32);
    let data: Vec<u8> = ends.iter().flatten().flat_map(|value| value.to_le_bytes()).collect();
    cdr.bytes(data.into_iter());
    cdr.bool(true);
    cdr.finish()
}

pub(super) fn occupancy_grid(stamp: Stamp, frame: &str, spec: &GridSpec, percent: &[i8]) -> Vec<u8> {
    let mut cdr = begun(stamp, frame);
    cdr.i32(stamp.seconds);
    cdr.u32(stamp.nanoseconds);
    cdr.f32(spec.cell_m as f32);
    cdr.u32(spec.width as u32);
    cdr.u32(spec.height as u32);
    placed(&mut cdr, Pose { x_m: spec.origin_m[0], y_m: spec.origin_m[1], theta_rad: 0.0 });
    cdr.bytes(percent.iter().map(|percent| percent.cast_unsigned()));
    cdr.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stamps_carry_over() {
        assert_eq!(Stamp::of(1.5), Stamp { seconds: 1, nanoseconds: 500_000_000 });
        assert_eq!(Stamp::of(1.999_999_999_9), Stamp { seconds: 2, nanoseconds: 0 });
        assert_eq!(Stamp::of(-3.0).nanoseconds(), 0);
    }

    #[test]
    fn even_beams_are_told_from_columns_of_an_image() {
        let degrees: Vec<f64> = (0..181).map(|k| (f64::from(k) - 90.0).to_radians()).collect();
        assert!(even(&degrees).is_some_and(|step| (step - 1f64.to_radians()).abs() < 1e-12));
        let columns: Vec<f64> = (0..40).map(|k| ((f64::from(k) - 19.5) / 30.0).atan()).collect();
        assert!(even(&columns).is_none() && even(&[]).is_none());
        assert!(even(&[0.3]).is_some());
    }
}

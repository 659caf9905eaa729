"""Bags of one drive, written by the independent package rosbags in all containers and compressions."""

import math
from pathlib import Path

import numpy as np

BEAMS = 180
STEP = np.float32(math.radians(2.0))
FIRST = np.float32(-math.pi)
RANGE_MAX = np.float32(12.0)
ROOM = (-3.0, -2.0, 5.0, 4.0)
NS = 1_000_000_000
START = 1_700_000_000


def wall(x, y, angle):
    """Range to the walls of a room, m."""
    c, s = math.cos(angle), math.sin(angle)
    ts = []
    if abs(c) > 1e-12:
        ts += [((ROOM[2] if c > 0 else ROOM[0]) - x) / c]
    if abs(s) > 1e-12:
        ts += [((ROOM[3] if s > 0 else ROOM[1]) - y) / s]
    return min(ts)


def compose(a, b):
    """Pose b in the frame of pose a."""
    c, s = math.cos(a[2]), math.sin(a[2])
    return (a[0] + c * b[0] - s * b[1], a[1] + s * b[0] + c * b[1], a[2] + b[2])


class Drive:
    """Poses of a robot, and scans of its laser: some beams have no echo, some say nothing."""

    def __init__(self, scans=60, mount=(0.2, 0.1, 0.3), mirrored=False):
        self.mount, self.mirrored = mount, mirrored
        self.stamps = [START * NS + k * NS // 5 for k in range(scans)]
        self.robot = [(1.2 * math.sin(0.1 * k), 0.8 * math.cos(0.07 * k), 0.05 * k - 1.0) for k in range(scans)]
        noise = np.random.default_rng(7)
        self.ranges = []
        for pose in self.robot:
            x, y, heading = compose(pose, mount)
            turn = -1.0 if mirrored else 1.0
            angles = heading + turn * (float(FIRST) + np.arange(BEAMS) * float(STEP))
            ranges = np.array([wall(x, y, angle) for angle in angles]) + noise.normal(0, 0.01, BEAMS)
            ranges[::17] = np.inf
            ranges[5::31] = np.nan
            ranges[3::37] = 65.0  # beyond range_max: says nothing
            self.ranges.append(ranges.astype(np.float32))

    def table(self, path):
        """The same drive as a table of scans."""
        turn = -1.0 if self.mirrored else 1.0
        with open(path, "w") as file:
            file.write("scan,time_s,x_m,y_m,theta_rad,bearing_rad,range_m\n")
            for k, (pose, ranges) in enumerate(zip(self.robot, self.ranges)):
                x, y, theta = compose(pose, self.mount)
                for j, read in enumerate(ranges):
                    text = "" if not read <= RANGE_MAX and not math.isinf(read) else repr(float(read))
                    bearing = turn * (float(FIRST) + j * float(STEP))
                    file.write(f"{k},{(self.stamps[k] - START * NS) / NS!r},{x!r},{y!r},{theta!r},{bearing!r},{text}\n")


class Types:
    """Messages of either ROS."""

    def __init__(self, ros):
        from rosbags.typesys import Stores, get_typestore

        self.ros = ros
        self.store = get_typestore(Stores.ROS1_NOETIC if ros == 1 else Stores.ROS2_HUMBLE)
        if ros == 1:
            from rosbags.typesys import get_types_from_msg

            text = "geometry_msgs/TransformStamped[] transforms"
            self.store.register(get_types_from_msg(text, "tf2_msgs/msg/TFMessage"))
        self.types = self.store.types

    def __getattr__(self, name):
        for package in ("sensor_msgs", "nav_msgs", "geometry_msgs", "tf2_msgs", "stereo_msgs", "std_msgs"):
            found = self.types.get(f"{package}/msg/{name}")
            if found:
                return found
        raise AttributeError(name)

    def header(self, stamp, frame):
        time = self.types["builtin_interfaces/msg/Time"](sec=stamp // NS, nanosec=stamp % NS)
        return self.Header(seq=0, stamp=time, frame_id=frame) if self.ros == 1 else self.Header(stamp=time, frame_id=frame)

    def turn(self, theta, roll=0.0):
        """A turn about the vertical axis, after a roll."""
        cy, sy, cr, sr = math.cos(theta / 2), math.sin(theta / 2), math.cos(roll / 2), math.sin(roll / 2)
        return self.Quaternion(x=cy * sr, y=sy * sr, z=sy * cr, w=cy * cr)

    def transform(self, stamp, parent, child, pose, roll=0.0):
        at = self.Transform(translation=self.Vector3(x=pose[0], y=pose[1], z=0.2), rotation=self.turn(pose[2], roll))
        return self.TransformStamped(header=self.header(stamp, parent), child_frame_id=child, transform=at)

    def pose(self, pose):
        return self.Pose(position=self.Point(x=pose[0], y=pose[1], z=0.0), orientation=self.turn(pose[2]))

    def odometry(self, stamp, pose):
        still = self.Vector3(x=0.0, y=0.0, z=0.0)
        twist = self.TwistWithCovariance(twist=self.Twist(linear=still, angular=still), covariance=np.zeros(36))
        posed = self.PoseWithCovariance(pose=self.pose(pose), covariance=np.zeros(36))
        return self.Odometry(header=self.header(stamp, "odom"), child_frame_id="base_link", pose=posed, twist=twist)

    def scan(self, stamp, ranges):
        last = FIRST + STEP * np.float32(BEAMS - 1)
        return self.LaserScan(
            header=self.header(stamp, "laser"), angle_min=FIRST, angle_max=last, angle_increment=STEP, time_increment=0.0,
            scan_time=0.2, range_min=0.1, range_max=RANGE_MAX, ranges=ranges, intensities=np.zeros(0, np.float32),
        )


def messages(drive, ros, poses="odom"):
    """Topic, type name, time and message of a drive; poses by odometry, by transforms, or as poses."""
    types = Types(ros)
    roll = math.pi if drive.mirrored else 0.0
    static = types.TFMessage(transforms=[types.transform(0, "base_link", "laser", drive.mount, roll)])
    yield "/tf_static", "tf2_msgs/msg/TFMessage", drive.stamps[0], static
    for stamp, pose, ranges in zip(drive.stamps, drive.robot, drive.ranges):
        if poses == "odom":
            yield "/odom", "nav_msgs/msg/Odometry", stamp, types.odometry(stamp, pose)
        elif poses == "tf":
            tf = types.TFMessage(transforms=[types.transform(stamp, "odom", "base_link", pose)])
            yield "/tf", "tf2_msgs/msg/TFMessage", stamp, tf
        else:
            posed = types.PoseStamped(header=types.header(stamp, "map"), pose=types.pose(pose))
            yield "/pose", "geometry_msgs/msg/PoseStamped", stamp, posed
        yield "/scan", "sensor_msgs/msg/LaserScan", stamp + 20_000_000, types.scan(stamp, ranges)


def write(path: Path, found, container, compression="none"):
    """Writes messages as a bag; gives the path."""
    if container == "bag":
        from rosbags.rosbag1 import Writer

        path = path.with_suffix(".bag")
        writer = Writer(path)
        if compression != "none":
            writer.set_compression(Writer.CompressionFormat[compression.upper()])
        types, serialize = Types(1), "serialize_ros1"
    else:
        from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

        writer = Writer(path, version=9, storage_plugin=StoragePlugin.MCAP if container == "mcap" else StoragePlugin.SQLITE3)
        if compression != "none":
            writer.set_compression(CompressionMode[compression.upper()], CompressionFormat.ZSTD)
        types, serialize = Types(2), "serialize_cdr"
    with writer:
        connections = {}
        for topic, kind, time, message in found:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=types.store)
            raw = getattr(types.store, serialize)(message, kind)
            writer.write(connections[topic], time, raw)
    return path

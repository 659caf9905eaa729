"""Bags that the independent package rosbags writes, read by the command line: each is the same drive as a table of scans."""

import math
import os
import shutil
import subprocess

import numpy as np
import pytest

PROGRAM = os.environ.get("SIGHTGRID") or shutil.which("sightgrid")

pytest.importorskip("rosbags")
bag_writer = pytest.importorskip("bag_writer")

pytestmark = pytest.mark.skipif(not PROGRAM, reason="no program: set SIGHTGRID to it")

CONTAINERS = [
    ("bag", "none"), ("bag", "bz2"), ("bag", "lz4"),
    ("mcap", "none"), ("mcap", "storage"), ("mcap", "file"), ("mcap", "message"),
    ("sqlite", "none"), ("sqlite", "file"), ("sqlite", "message"),
]  # fmt: skip


def run(folder, *args):
    """The program with some words; what it says stands in lines that are not wrapped."""
    unwrapped = {**os.environ, "COLUMNS": "10000"}
    words = [PROGRAM, *map(str, args)]
    return subprocess.run(words, cwd=folder, capture_output=True, text=True, timeout=600, env=unwrapped)


def predictions(folder, log, *options):
    """The table of predictions of a log, and what was said of it."""
    common = ["--mappers", "log-odds-octomap", "--grid", "0.2", "--hold-out", "5", "--format", "csv", "--out", "out"]
    ended = run(folder, "replay", log, *common, *options)
    assert ended.returncode == 0, ended.stderr
    return ended.stdout, ended.stderr


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("bags")


@pytest.fixture(scope="module")
def drive():
    return bag_writer.Drive()


@pytest.fixture(scope="module")
def expected(folder, drive):
    drive.table(folder / "drive.csv")
    return predictions(folder, "drive.csv", "--max-range", "12")[0]


@pytest.mark.parametrize("container,compression", CONTAINERS)
def test_every_container_predicts_as_the_table_does(folder, drive, expected, container, compression):
    ros = 1 if container == "bag" else 2
    found = bag_writer.messages(drive, ros)
    path = bag_writer.write(folder / f"{container}-{compression}", found, container, compression)
    printed, said = predictions(folder, path)
    assert printed == expected
    assert "scans are those of /scan, poses come from /odom" in said and "warning" not in said, said
    if container == "sqlite" and compression == "none":
        assert predictions(folder, next(path.glob("*.db3")))[0] == expected


@pytest.mark.parametrize("poses,option", [("tf", "tf:odom"), ("pose", "/pose")])
def test_poses_come_from_wherever_they_are(folder, drive, expected, poses, option):
    path = bag_writer.write(folder / f"by-{poses}", bag_writer.messages(drive, 2, poses), "mcap")
    assert predictions(folder, path, "--pose", option, "--scan", "/scan")[0] == expected


def test_poses_of_a_file_are_the_robots(folder, drive, expected):
    with open(folder / "way.txt", "w") as file:
        for stamp, (x, y, theta) in zip(drive.stamps, drive.robot):
            turn = f"{math.sin(theta / 2)!r} {math.cos(theta / 2)!r}"
            file.write(f"{stamp / bag_writer.NS!r} {x!r} {y!r} 0 0 0 {turn}\n")
    path = bag_writer.write(folder / "by-file", bag_writer.messages(drive, 2), "sqlite")
    printed = predictions(folder, path, "--pose", "way.txt")[0]
    found, known = ([float(x) for x in text.splitlines()[1].split(",")[1:]] for text in (printed, expected))
    assert np.allclose(found, known, rtol=1e-3)


def test_a_laser_upside_down_is_the_same_room(folder):
    drive = bag_writer.Drive(mirrored=True)
    drive.table(folder / "mirrored.csv")
    path = bag_writer.write(folder / "mirrored", bag_writer.messages(drive, 1), "bag", "lz4")
    assert predictions(folder, path)[0] == predictions(folder, "mirrored.csv", "--max-range", "12")[0]


def test_topics_are_listed_and_a_choice_is_asked_for(folder, drive):
    both = [m for pose in ("odom", "pose") for m in bag_writer.messages(drive, 2, pose) if pose == "odom" or m[0] == "/pose"]
    path = bag_writer.write(folder / "both", sorted(both, key=lambda message: message[2]), "mcap")
    ended = run(folder, "replay", path)
    assert ended.returncode == 2 and "has 2 sources of poses, odom, /pose: choose one by --pose" in ended.stderr
    assert f"such as: replay {path} --scan /scan --pose odom" in ended.stderr
    listed = run(folder, "replay", path, "--topics")
    assert listed.returncode == 0 and listed.stdout.startswith(ended.stdout.rstrip("\n"))
    row = next(line.split() for line in listed.stdout.splitlines() if line.startswith("/scan"))
    assert row[:3] == ["/scan", "sensor_msgs/LaserScan", "60"]


def test_damage_is_named_with_its_place(folder, drive):
    path = bag_writer.write(folder / "whole", bag_writer.messages(drive, 2), "mcap", "storage")
    whole = next(path.glob("*.mcap")).read_bytes()
    (folder / "cut.mcap").write_bytes(whole[: len(whole) // 3])
    ended = run(folder, "replay", "cut.mcap")
    assert ended.returncode == 2 and "cut.mcap, byte " in ended.stderr and "ends within a chunk" in ended.stderr, ended.stderr
    whole = bag_writer.write(folder / "whole", bag_writer.messages(drive, 1), "bag", "bz2").read_bytes()
    at = whole.index(b"BZh") + 3000
    (folder / "flipped.bag").write_bytes(whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1 :])
    ended = run(folder, "replay", "flipped.bag")
    assert ended.returncode == 2 and "flipped.bag, byte 4109: the chunk " in ended.stderr, ended.stderr


def test_slam_and_calibrate_take_bags(folder, drive):
    path = bag_writer.write(folder / "slam", bag_writer.messages(drive, 1), "bag", "bz2")
    ended = run(folder, "slam", path, "--particles", "1", "--mapper", "log-odds-octomap", "--out", "way")
    assert ended.returncode == 0, ended.stderr
    way = np.loadtxt(folder / "way/trajectory.txt")
    x, y, _ = bag_writer.compose(drive.robot[-1], drive.mount)
    first = bag_writer.compose(drive.robot[0], drive.mount)
    assert len(way) == len(drive.robot)
    assert math.hypot(way[-1][1] - way[0][1] - (x - first[0]), way[-1][2] - way[0][2] - (y - first[1])) < 0.2
    ended = run(folder, "calibrate", path, "--scans", "30", "--beams", "30", "--grid", "0.2")
    assert ended.returncode == 0 and "30 scans of a laser up to 12 m in slam.bag" in ended.stdout, ended.stdout + ended.stderr


def test_depths_are_disparities_of_the_camera(folder):
    types = bag_writer.Types(2)
    width, height, focal = 64, 5, 60.0
    start = bag_writer.START * bag_writer.NS
    info = types.CameraInfo(
        header=types.header(start, "optical"), height=height, width=width, distortion_model="plumb_bob", d=np.zeros(5),
        k=np.array([focal, 0, 31.5, 0, focal, 2, 0, 0, 1]), r=np.eye(3).ravel(),
        p=np.array([focal, 0, 31.5, 0, 0, focal, 2, 0, 0, 0, 1, 0]), binning_x=0, binning_y=0,
        roi=types.RegionOfInterest(x_offset=0, y_offset=0, height=0, width=0, do_rectify=False),
    )  # fmt: skip
    optical = types.transform(0, "base_link", "optical", (0.0, 0.0, 0.0))
    optical.transform.rotation = types.Quaternion(x=-0.5, y=0.5, z=-0.5, w=0.5)
    found = [
        ("/tf_static", "tf2_msgs/msg/TFMessage", start, types.TFMessage(transforms=[optical])),
        ("/depth/camera_info", "sensor_msgs/msg/CameraInfo", start, info),
    ]
    rows = ["scan,time_s,x_m,y_m,theta_rad,bearing_rad,disparity_px"]
    for k in range(20):
        stamp = start + k * bag_writer.NS // 10
        x = 0.05 * k
        depth = 5000 - int(50 * k)
        pixels = np.full((height, width), 1000, dtype="<u2")
        pixels[2] = depth
        pixels[2, ::7] = 0
        image = types.Image(
            header=types.header(stamp, "optical"), height=height, width=width, encoding="16UC1", is_bigendian=0,
            step=2 * width, data=pixels.view(np.uint8).ravel(),
        )  # fmt: skip
        found.append(("/odom", "nav_msgs/msg/Odometry", stamp, types.odometry(stamp, (x, 0.0, 0.0))))
        found.append(("/depth/image", "sensor_msgs/msg/Image", stamp, image))
        for column in range(width):
            read = "" if column % 7 == 0 else repr(15.0 / (depth / 1000))
            rows.append(f"{k},{k / 10!r},{x!r},0,0,{math.atan2(31.5 - column, focal)!r},{read}")
    (folder / "depth.csv").write_text("\n".join(rows) + "\n")
    path = bag_writer.write(folder / "depth", found, "mcap")
    printed, said = predictions(folder, path, "--max-disparity", "60")
    found, expected = ([float(x or "nan") for x in text.splitlines()[1].split(",")[1:]]
                       for text in (printed, predictions(folder, "depth.csv", "--max-disparity", "60")[0]))
    # The optical frame is turned by quaternions, which round.
    assert np.allclose(found, expected, rtol=1e-3), said

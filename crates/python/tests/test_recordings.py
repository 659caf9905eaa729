"""Recordings of the command line, read back by programs that are not ours."""

import math
import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[3]
PROGRAM = os.environ.get("SIGHTGRID") or shutil.which("sightgrid")

pytestmark = pytest.mark.skipif(not PROGRAM, reason="no program: set SIGHTGRID to it")


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    folder = tmp_path_factory.mktemp("recorded")

    def run(*args):
        ended = subprocess.run([PROGRAM, *args], cwd=folder, capture_output=True, text=True, timeout=600)
        assert ended.returncode == 0, ended.stderr

    run("room", "--scene", "closets", "--mappers", "visibility,log-odds-octomap", "--out", "room", "--mcap", "room.mcap")
    log = "scenes/logs/aces.clf.bz2"
    run("replay", log, "--every", "20", "--mappers", "visibility", "--out", "replay", "--mcap", "replay.mcap")
    run("slam", log, "--every", "10", "--particles", "2", "--out", "slam", "--mcap", "slam.mcap")
    return folder


def messages(path):
    """Topic, type, time and message of every record, by rosbags."""
    pytest.importorskip("rosbags")
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
        return [(c.topic, c.msgtype, time, reader.deserialize(raw, c.msgtype)) for c, time, raw in reader.messages()]


@pytest.mark.parametrize("name", ["room", "replay", "slam"])
def test_players_find_their_way_by_the_indexes(recorded, name):
    reader = pytest.importorskip("mcap.reader")
    with open(recorded / f"{name}.mcap", "rb") as file:
        found = reader.make_reader(file)
        summary = found.get_summary()
        counted = sum(1 for _ in found.iter_messages())
    assert counted == summary.statistics.message_count > 20
    assert summary.chunk_indexes and {schema.encoding for schema in summary.schemas.values()} == {"ros2msg"}
    topics = {channel.topic for channel in summary.channels.values()}
    assert {"/tf", "/pose", "/map/visibility"} <= topics, topics


def test_a_drive_says_what_its_files_say(recorded):
    found = messages(recorded / "room.mcap")
    rows = np.genfromtxt(recorded / "room/scans.csv", delimiter=",", names=True)
    scans = {int(row["scan"]): row for row in rows[::-1]}
    poses = [(time, message) for topic, _, time, message in found if topic == "/pose"]
    assert len(poses) == len(scans)
    for (time, message), row in zip(poses, (scans[number] for number in sorted(scans))):
        # Tables have six significant digits.
        assert abs(time / 1e9 - 1.0 - row["time_s"]) < 1e-4
        assert abs(message.pose.position.x - row["x_m"]) < 1e-4
        turned = 2 * math.atan2(message.pose.orientation.z, message.pose.orientation.w)
        assert abs(math.remainder(turned - row["theta_rad"], 2 * math.pi)) < 1e-5
        assert message.header.frame_id == "map"
    kinds = {topic: kind for topic, kind, _, _ in found}
    assert kinds["/tf"] == "tf2_msgs/msg/TFMessage" and kinds["/truth"] == "nav_msgs/msg/OccupancyGrid"
    for mapper in ["visibility", "log-odds-octomap"]:
        maps = [message for topic, _, _, message in found if topic == f"/map/{mapper.replace('-', '_')}"]
        files = sorted((recorded / "room").glob(f"{mapper}-*.npy"))
        files = [file for file in files if file.stem.removeprefix(f"{mapper}-").isalnum()]
        assert len(maps) == len(files) >= 1
        kept = np.load(files[-1])
        grid = maps[-1]
        assert (grid.info.height, grid.info.width) == kept.shape
        data = grid.data.reshape(kept.shape)
        assert np.array_equal(data == -1, np.isnan(kept))
        known = ~np.isnan(kept)
        assert np.all(np.abs(data[known] - 100 * kept[known]) <= 0.5001)
    ends = [message for topic, _, _, message in found if topic in ("/points", "/scan")]
    assert len(ends) == len(scans)


def test_beams_of_a_laser_are_a_laser_scan(recorded):
    for name in ["replay", "slam"]:
        found = messages(recorded / f"{name}.mcap")
        scans = [message for topic, _, _, message in found if topic == "/scan"]
        assert len(scans) == (50 if name == "replay" else 100)
        for scan in scans:
            assert len(scan.ranges) == 180 and abs(scan.angle_increment - math.radians(1)) < 1e-5
            assert abs(scan.angle_min + scan.angle_increment * 179 - scan.angle_max) < 1e-4
        transforms = [message.transforms[0] for topic, _, _, message in found if topic == "/tf"]
        assert {transform.child_frame_id for transform in transforms} == {"sensor"}
        assert len(transforms) == len(scans)
    way = np.loadtxt(recorded / "slam/trajectory.txt")
    poses = [message for topic, _, _, message in found if topic == "/pose"]
    assert np.allclose([[p.pose.position.x, p.pose.position.y] for p in poses], way[:, 1:3], atol=1e-5)

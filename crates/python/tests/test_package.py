"""The package as it is installed."""

import math
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import sightgrid as sg

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture(scope="module")
def room():
    return sg.simulate("room", seed=1)


def mapped(name, world, **more):
    mapper = sg.Mapper(name, world.grid, world.sensor, **more)
    for scan in world.scans:
        mapper.integrate(scan)
    return mapper


def test_a_drive_is_the_same_for_the_same_seed(room):
    again, other = sg.simulate("room", seed=1), sg.simulate("room", seed=2)
    assert len(room.scans) == len(again.scans) > 50
    assert all(np.array_equal(a.readings, b.readings, equal_nan=True) for a, b in zip(room.scans, again.scans))
    assert not all(np.array_equal(a.readings, b.readings, equal_nan=True) for a, b in zip(room.scans, other.scans))
    assert room.truth.shape == room.grid.shape and set(np.unique(room.truth[~np.isnan(room.truth)])) == {0.0, 1.0}
    assert room.poses.shape == (len(room.scans), 3)
    assert room.region("visible").dtype == bool and "observable" in room.regions


def test_numbers_are_those_of_the_command_line(room):
    # The last stage of the committed results of `sightgrid room`.
    lines = (ROOT / "results/room/metrics.csv").read_text().splitlines()
    heads = lines[0].split(",")
    rows = [dict(zip(heads, line.split(","))) for line in lines[1:]]
    last = rows[-1]["stage"]
    for name in ["visibility", "conventional"]:
        found = sg.score(mapped(name, room).occupancy(unseen=None), room, region="observable")
        kept = {row["metric"]: row["value"] for row in rows
                if (row["mapper"], row["stage"], row["region"]) == (name, last, "observable")}
        compared = 0
        for metric, value in found.items():
            if metric in kept and kept[metric]:
                # Files have six significant digits.
                assert float(f"{value:.5e}") == float(kept[metric]), (name, metric)
                compared += 1
        assert compared >= 8


def test_scans_may_be_given_by_their_parts_and_several_at_once(room):
    whole, parts = (sg.Mapper("visibility", room.grid, room.sensor) for _ in range(2))
    for scan in room.scans[:5]:
        whole.integrate(scan)
        parts.integrate(pose=scan.pose, bearings=scan.bearings, readings=scan.readings, time_s=scan.time_s)
    assert np.array_equal(whole.occupancy(), parts.occupancy(), equal_nan=True)
    scan = room.scans[5]
    halves = [sg.Scan(scan.pose, scan.bearings[k::2], scan.readings[k::2], scan.time_s, k) for k in range(2)]
    two = sg.Mapper("visibility", room.grid, [room.sensor, room.sensor])
    one = sg.Mapper("visibility", room.grid, room.sensor)
    one.integrate(scan)
    two.integrate_together(halves)
    assert np.allclose(one.occupancy(unseen=None), two.occupancy(unseen=None), atol=1e-9)


def test_unseen_cells_are_nan_and_pairs_hold_together(room):
    mapper = mapped("visibility", room)
    p, filled = mapper.occupancy(), mapper.occupancy(unseen=None)
    assert np.isnan(p).any() and not np.isnan(filled).any()
    assert np.array_equal(p[~np.isnan(p)], filled[~np.isnan(p)])
    assert np.all(mapper.occupancy(unseen=0.5)[np.isnan(p)] == 0.5)
    beside, above = mapper.pairwise()
    height, width = room.grid.shape
    assert beside.shape == (height, width - 1) and above.shape == (height - 1, width)
    assert np.all(beside <= np.minimum(filled[:, 1:], filled[:, :-1]) + 1e-12)
    assert np.all(above >= np.maximum(0, filled[1:] + filled[:-1] - 1) - 1e-12)
    assert mapped("conventional", room).pairwise() is None


def test_evidence_prefers_the_map_that_has_seen_the_place(room):
    mapper, fresh = mapped("visibility", room), sg.Mapper("visibility", room.grid, room.sensor)
    scan = sg.simulate("room", seed=7).scans[20]
    assert mapper.evidence(scan) > fresh.evidence(scan)
    copy = fresh.copy()
    copy.integrate(scan)
    assert np.isnan(fresh.occupancy()).all() and not np.isnan(copy.occupancy()).all()


def test_kernels_are_densities():
    stereo, laser = sg.Stereo(), sg.Laser(max_range_m=20.0)
    edges = np.linspace(0.5, 10.0, 40)
    likelihood = stereo.likelihood(stereo.focal_baseline / 4.0, edges)
    assert likelihood.shape == (39,) and abs(edges[np.argmax(likelihood)] - 4.0) < 0.5
    # Over all readings a kernel integrates to one.
    readings = np.linspace(1e-3, 19.999, 20001)
    density = np.array([laser.likelihood(reading, np.array([5.0, 5.1]))[0] for reading in readings])
    nothing = laser.likelihood(math.inf, np.array([5.0, 5.1]))[0]
    integral = float(np.sum(0.5 * (density[1:] + density[:-1]) * np.diff(readings)))
    assert abs(integral + nothing - 1.0) < 1e-3
    assert abs(laser.range_of(3.0) - 3.0) < 1e-12


def test_arrays_are_scored_like_worlds(room):
    p = mapped("visibility", room).occupancy(unseen=None)
    of_world = sg.score(p, room, region="visible")
    of_array = sg.score(p, room.truth, grid=room.grid, mask=room.region("visible"))
    assert of_world["log_loss"] == of_array["log_loss"]
    perfect = np.where(room.truth == 1, 1.0, 0.0)
    assert sg.score(perfect, room.truth, grid=room.grid)["iou"] == 1.0
    assert sg.score(perfect, room.truth == 1, grid=room.grid)["iou"] == 1.0


def test_scenes_with_several_sensors_are_mapped_together():
    world = sg.simulate("sonar-ring")
    assert len(world.sensors) > 1 and any(isinstance(sensor, sg.Sonar) for sensor in world.sensors)
    assert len(world.scans) > len(world.moments) > 10 or not len(world.moments[0]) > 1
    mapper = sg.Mapper("visibility", world.grid, world.sensors)
    for scans in world.moments:
        mapper.integrate_together(scans)
    prior = sg.score(np.full(world.grid.shape, 0.1), world)["log_loss"]
    assert sg.score(mapper.occupancy(unseen=None), world)["log_loss"] < prior


class Counting:
    """Hits over looks, a mapper of one's own."""

    def __init__(self, grid, sensor):
        self.grid, self.sensor = grid, sensor
        self.hits, self.looks = np.zeros(grid.shape), np.zeros(grid.shape)

    def integrate(self, scan):
        x, y, theta = scan.pose
        for bearing, reading in zip(scan.bearings, scan.readings):
            range_m = self.sensor.range_of(reading, bearing) if np.isfinite(reading) else None
            if range_m is None:
                continue
            cells = []
            for step in np.arange(0.0, range_m, 0.5 * self.grid.cell_m):
                cell = self.grid.cell_at(x + step * math.cos(theta + bearing), y + step * math.sin(theta + bearing))
                if cell and (not cells or cell != cells[-1]):
                    cells.append(cell)
            for cell in cells:
                self.looks[cell] += 1
            if cells:
                self.hits[cells[-1]] += 1

    def occupancy(self):
        return (self.hits + 0.1) / (self.looks + 1.0)


def test_mappers_of_ones_own_are_compared_with_ours():
    seen = []
    found = sg.compare({"visibility": "visibility", "mine": Counting}, sg.worlds("closets", range(1, 4)), watch=seen.append)
    assert len(found.rows) == len(seen) == 6 and found.mappers() == ["visibility", "mine"]
    assert found.mean("visibility") < found.mean("mine")
    assert "mine" in str(found) and len({row.seed for row in found.rows}) == 3
    with pytest.raises(ValueError, match="no metric"):
        found.mean("mine", "nonsense")


def test_paired_differences_have_intervals():
    rng = np.random.default_rng(1)
    theirs = rng.normal(size=30)
    found = sg.paired(list(theirs + 1.0 + 0.1 * rng.normal(size=30)), list(theirs))
    assert found["low"] < 1.0 < found["high"] and found["pairs"] == 30 and found["p"] < 0.01


def test_maps_come_back_from_files(tmp_path, room):
    p = mapped("visibility", room).occupancy()
    sg.save_map(tmp_path / "map.yaml", p, room.grid)
    back, grid = sg.load_map(tmp_path / "map.yaml")
    assert grid == room.grid and sorted(file.name for file in tmp_path.iterdir()) == ["map.pgm", "map.yaml"]
    known = ~np.isnan(back)
    assert np.array_equal(back[known], (p[known] > 0.5).astype(float))
    assert np.isnan(back[np.isnan(p)]).all()


def test_logs_are_read_and_mapped():
    log = sg.read_log(ROOT / "scenes/logs/aces.clf.bz2", every=20)
    assert isinstance(log.sensor, sg.Laser)
    mapper = sg.Mapper("visibility", sg.Grid(600, 600, 0.1, (-30.0, -30.0)), log.sensor)
    scans = 0
    for event in log:
        assert len(event.odometry) == 3 and event.line > 0
        mapper.integrate(event.scan)
        scans += 1
    assert scans == 50 and (mapper.occupancy() > 0.5).sum() > 100
    assert any("beams" in finding for finding in log.findings)


@pytest.mark.parametrize(
    ("call", "kind", "said"),
    [
        (lambda w: sg.Mapper("visibilty", w.grid, w.sensor), ValueError, "nearest is \"visibility\""),
        (lambda w: sg.Mapper("visibility", w.grid, []), ValueError, "one sensor at least"),
        (lambda w: sg.Mapper("visibility", w.grid, "camera"), TypeError, "camera|Sensor"),
        (lambda w: sg.Grid(0, 5, 0.1), ValueError, "0 x 5 cells"),
        (lambda w: sg.Grid(5, 5, -0.1), ValueError, "cell_m is -0.1"),
        (lambda w: sg.Prior(occupancy=1.0), ValueError, "below 1"),
        (lambda w: sg.Stereo(correct_match=1.5), ValueError, "correct_match is 1.5"),
        (lambda w: sg.Laser(max_range_m=-1.0), ValueError, "max_range"),
        (lambda w: sg.Sonar(width_rad=4.0), ValueError, "width_rad is 4"),
        (lambda w: sg.Scan((0, 0, 0), np.zeros(3), np.ones(2)), ValueError, "3 bearings and 2 readings"),
        (lambda w: sg.Scan((0, np.nan, 0), np.zeros(2), np.ones(2)), ValueError, "finite"),
        (lambda w: sg.Scan((0, 0, 0), np.zeros(2), np.array([1.0, 0.0])), ValueError, "readings[1] is 0"),
        (lambda w: sg.Mapper("visibility", w.grid, w.sensor).integrate(), ValueError, "give a scan"),
        (lambda w: sg.Mapper("visibility", w.grid, w.sensor).integrate(sg.Scan((0, 0, 0), np.zeros(1), np.ones(1), 0.0, 3)), ValueError, "sensor 3"),
        (lambda w: sg.simulate("no-such-scene"), ValueError, "no-such-scene"),
        (lambda w: sg.simulate("room", cell_m=-1.0), ValueError, "-1"),
        (lambda w: sg.score(np.zeros((3, 3)), w), ValueError, "the shape (3, 3)"),
        (lambda w: sg.score(np.full(w.grid.shape, 1.5), w), ValueError, "1.5"),
        (lambda w: sg.score(np.zeros(w.grid.shape), w, region="nowhere"), ValueError, "there are: "),
        (lambda w: sg.score(np.zeros((2, 2)), np.full((2, 2), 0.5), grid=sg.Grid(2, 2, 1.0)), ValueError, "truth[0, 0] is 0.5"),
        (lambda w: sg.score(np.zeros((2, 2)), np.zeros((2, 2))), ValueError, "give the grid"),
        (lambda w: sg.load_map("absent.yaml"), OSError, "absent.yaml"),
        (lambda w: sg.save_map("map.png", np.zeros(w.grid.shape), w.grid), ValueError, ".yaml"),
        (lambda w: sg.read_log("absent.log"), ValueError, "absent.log"),
        (lambda w: sg.compare([], [w]), ValueError, "empty"),
        (lambda w: sg.compare(["visibility"], [w], baseline="other"), ValueError, "not among"),
    ],
)
def test_bad_input_is_one_clear_error(room, call, kind, said):
    with pytest.raises(kind) as error:
        call(room)
    assert any(part in str(error.value) for part in said.split("|")), str(error.value)


def test_other_threads_run_while_a_map_is_made(room):
    turns = 0
    done = threading.Event()

    def count():
        nonlocal turns
        while not done.is_set():
            turns += 1
            time.sleep(0)

    other = threading.Thread(target=count)
    other.start()
    started = time.perf_counter()
    for _ in range(3):
        mapped("visibility", room)
    spent = time.perf_counter() - started
    done.set()
    other.join()
    # Had nobody let go, the other would have had a turn per call at most.
    assert turns > 3 * len(room.scans), (turns, spent)


def test_threads_may_share_a_mapper(room):
    mapper = sg.Mapper("log-odds-octomap", room.grid, room.sensor)
    threads = [threading.Thread(target=lambda k=k: [mapper.integrate(scan) for scan in room.scans[k::4]]) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert np.isfinite(mapper.occupancy(unseen=None)).all()


def test_everything_has_a_type_and_a_docstring():
    stubs = (Path(sg.__file__).parent / "_sightgrid.pyi").read_text()
    for name in sg.__all__:
        thing = getattr(sg, name)
        assert name == "__version__" or (thing.__doc__ or "").strip(), name
        if getattr(thing, "__module__", "") in ("sightgrid", "sightgrid._sightgrid", "builtins") and name[0] != "_":
            assert f"class {name}" in stubs or f"def {name}" in stubs, name
            if isinstance(thing, type):
                for method in vars(thing):
                    assert method.startswith("__") or f"def {method}(" in stubs, f"{name}.{method}"


def test_stubs_say_what_is_there(tmp_path):
    pytest.importorskip("mypy")
    known = tmp_path / "known"
    # A base class of Rust cannot be said to be one in a stub without another package.
    known.write_text("sightgrid._sightgrid.__all__\nsightgrid._sightgrid.Sensor\n")
    command = [sys.executable, "-m", "mypy.stubtest", "sightgrid._sightgrid", "--allowlist", str(known), "--ignore-unused-allowlist"]
    found = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=600)
    assert found.returncode == 0, found.stdout + found.stderr


@pytest.mark.parametrize("example", sorted((Path(__file__).parents[1] / "examples").glob("*.py")), ids=lambda path: path.stem)
def test_the_gallery_runs(example, tmp_path):
    ran = subprocess.run([sys.executable, str(example)], cwd=tmp_path, capture_output=True, text=True, timeout=600)
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout.strip()

"""Compares the scores of `examples/trajectories` with evo's on random walks: `trajectories.py PROGRAM FOLDER`."""

import copy
import csv
import math
import random
import subprocess
import sys
from pathlib import Path

from evo.core import metrics, sync
from evo.tools import file_interface

TOLERANCE = 1e-9
STATISTICS = {"rmse": "rmse", "mean": "mean", "deviation": "std", "median": "median", "max": "max"}
RELATIONS = {
    "translation-m": metrics.PoseRelation.translation_part,
    "rotation-rad": metrics.PoseRelation.rotation_angle_rad,
}


def walk(seed, folder):
    """A walk and what a poor robot makes of it: another frame, drift, noise, a jittering clock, missing poses."""
    chance = random.Random(seed)
    count = chance.randrange(60, 400)
    x, y, theta, time = 0.0, 0.0, chance.uniform(-3, 3), 1.7e9 * (seed % 2)
    frame = chance.uniform(-3, 3)
    bias = chance.gauss(0, 0.002)
    truth, estimate = [], []
    for k in range(count):
        truth.append((time, x, y, theta))
        along = [
            40 * (seed % 3) + math.cos(frame) * x - math.sin(frame) * y + chance.gauss(0, 0.03),
            math.sin(frame) * x + math.cos(frame) * y + chance.gauss(0, 0.03),
            theta + frame + bias * k + chance.gauss(0, 0.02),
        ]
        if chance.random() < 0.9:
            estimate.append((time + chance.uniform(-0.004, 0.004), *along))
        step, turn = chance.uniform(0, 0.4), chance.gauss(0, 0.3)
        x, y, theta, time = x + step * math.cos(theta), y + step * math.sin(theta), theta + turn, time + 0.2
    paths = [folder / f"{name}-{seed}.tum" for name in ("estimate", "reference")]
    for path, poses in zip(paths, (estimate, truth)):
        lines = [f"{t!r} {x!r} {y!r} 0 0 0 {math.sin(a / 2)!r} {math.cos(a / 2)!r}\n" for t, x, y, a in poses]
        path.write_text("".join(lines))
    return paths


def expected(estimate, reference):
    """evo's statistics by the names of ours; steps of a second, which it does not have, are left out."""
    truth, guess = (file_interface.read_tum_trajectory_file(path) for path in (reference, estimate))
    truth, guess = sync.associate_trajectories(truth, guess, max_diff=0.01)
    aligned = copy.deepcopy(guess)
    aligned.align(truth)
    step = dict(pairs_from_reference=True)
    for part, relation in RELATIONS.items():
        for name, metric, pair in [
            ("ate", metrics.APE(relation), (truth, guess)),
            ("ate-aligned", metrics.APE(relation), (truth, aligned)),
            ("rpe-1-pose", metrics.RPE(relation, 1, metrics.Unit.frames, **step), (truth, guess)),
            ("rpe-10-poses", metrics.RPE(relation, 10, metrics.Unit.frames, **step), (truth, guess)),
            ("rpe-1-m", metrics.RPE(relation, 1.0, metrics.Unit.meters, **step), (truth, guess)),
        ]:
            metric.process_data(pair)
            yield f"{name}-{part}", len(metric.error), metric.get_all_statistics()


def main(program, folder):
    compared, worst = 0, 0.0
    for seed in range(40):
        files = walk(seed, Path(folder))
        found = subprocess.run([program, *files], check=True, capture_output=True, text=True).stdout
        rows = {row["metric"]: row for row in csv.DictReader(found.splitlines())}
        for name, count, statistics in expected(*files):
            if int(rows[name]["count"]) != count:
                sys.exit(f"walk {seed}, {name}: {rows[name]['count']} errors; evo has {count}")
            for ours, theirs in STATISTICS.items():
                off = abs(float(rows[name][ours]) - statistics[theirs])
                worst, compared = max(worst, off), compared + 1
                if not off <= TOLERANCE:
                    sys.exit(f"walk {seed}, {name}, {ours}: {rows[name][ours]}; evo has {statistics[theirs]!r}")
    print(f"{compared} statistics of 40 walks are evo's, to {worst:.1e}")


main(*sys.argv[1:])

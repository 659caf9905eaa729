"""A mapper of your own in Python, without numpy: the share of looks at a cell that hit it."""
import csv, json, math, os, struct, sys

folder = sys.argv[-1]
grid = json.load(open(os.path.join(folder, "grid.json")))
sensors = json.load(open(os.path.join(folder, "sensors.json")))
cell, (x0, y0), width, height = grid["cell_m"], grid["origin_m"], grid["width"], grid["height"]
passed, hits = [0] * (width * height), [0] * (width * height)
for row in csv.DictReader(open(os.path.join(folder, "scans.csv"))):
    if not row["disparity_px"]:
        continue
    x, y, theta, bearing = (float(row[key]) for key in ("x_m", "y_m", "theta_rad", "bearing_rad"))
    noise = sensors[int(row["sensor"])]["noise"]
    range_m = noise["focal_baseline"] / (max(float(row["disparity_px"]), 0.1) * math.cos(bearing))
    steps = int(min(range_m, 30.0) / (0.5 * cell))
    for step in range(steps + 1):
        r = range_m if step == steps else 0.5 * cell * step
        i, j = (math.floor(v / cell) for v in (x + r * math.cos(theta + bearing) - x0, y + r * math.sin(theta + bearing) - y0))
        if 0 <= i < width and 0 <= j < height:
            (hits if step == steps else passed)[j * width + i] += 1
prior = sensors[0]["prior"]["occupancy"]
values = [(h + prior) / (h + 0.5 * p + 1) if h + p else math.nan for h, p in zip(hits, passed)]
with open(os.path.join(folder, "occupancy.npy"), "wb") as out:
    head = "{'descr': '<f4', 'fortran_order': False, 'shape': (%d, %d), }" % (height, width)
    out.write(b"\x93NUMPY\x01\x00" + struct.pack("<H", 118) + (head.ljust(117) + "\n").encode())
    out.write(struct.pack("<%df" % len(values), *values))

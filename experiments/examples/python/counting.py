"""A mapper of your own in Python, without numpy: the share of looks at a cell that hit it."""
import csv, json, math, struct, sys

folder = sys.argv[-1]
grid, sensors = (json.load(open(f"{folder}/{name}.json")) for name in ("grid", "sensors"))
cell, (x0, y0), width, height = grid["cell_m"], grid["origin_m"], grid["width"], grid["height"]
passed, hits, prior = [0] * (width * height), [0] * (width * height), sensors[0]["prior"]["occupancy"]
for row in csv.DictReader(open(f"{folder}/scans.csv")):
    if row["disparity_px"]:  # empty: no reading
        x, y, theta, bearing, disparity = (float(row[key]) for key in ("x_m", "y_m", "theta_rad", "bearing_rad", "disparity_px"))
        range_m = sensors[int(row["sensor"])]["noise"]["focal_baseline"] / (max(disparity, 0.1) * math.cos(bearing))
        for r in [0.5 * cell * step for step in range(int(min(range_m, 30.0) / (0.5 * cell)))] + [range_m]:
            i = math.floor((x + r * math.cos(theta + bearing) - x0) / cell)
            j = math.floor((y + r * math.sin(theta + bearing) - y0) / cell)
            if 0 <= i < width and 0 <= j < height:
                (hits if r == range_m else passed)[j * width + i] += 1
values = [(h + prior) / (h + 0.5 * p + 1) if h + p else math.nan for h, p in zip(hits, passed)]
head = "{'descr': '<f4', 'fortran_order': False, 'shape': (%d, %d), }" % (height, width)
with open(f"{folder}/occupancy.npy", "wb") as out:
    out.write(b"\x93NUMPY\x01\x00\x76\x00" + (head.ljust(117) + "\n").encode() + struct.pack(f"<{len(values)}f", *values))

"""The same kind of mapper, given scans one by one: `--mapper counting='online: python3 online.py'`."""
import json, math, struct, sys

for line in sys.stdin:
    message = json.loads(line)
    if message["type"] == "start":
        grid, sensors = message["grid"], message["sensors"]
        cell, (x0, y0), width, height = grid["cell_m"], grid["origin_m"], grid["width"], grid["height"]
        passed, hits = [0] * (width * height), [0] * (width * height)
    elif message["type"] == "scan":
        noise = sensors[message["sensor"]]["noise"]
        for bearing, disparity in zip(message["bearing_rad"], message["disparity_px"]):
            if disparity is None:
                continue
            range_m = noise["focal_baseline"] / (max(disparity, 0.1) * math.cos(bearing))
            dx, dy = math.cos(message["theta_rad"] + bearing), math.sin(message["theta_rad"] + bearing)
            steps = int(min(range_m, 30.0) / (0.5 * cell))
            for step in range(steps + 1):
                r = range_m if step == steps else 0.5 * cell * step
                i, j = (math.floor(v / cell) for v in (message["x_m"] + r * dx - x0, message["y_m"] + r * dy - y0))
                if 0 <= i < width and 0 <= j < height:
                    (hits if step == steps else passed)[j * width + i] += 1
    elif message["type"] == "map":
        prior = sensors[0]["prior"]["occupancy"]
        values = [(h + prior) / (h + 0.5 * p + 1) if h + p else math.nan for h, p in zip(hits, passed)]
        header = {"schema_version": 1, "height": height, "width": width, "dtype": "<f4"}
        sys.stdout.buffer.write((json.dumps(header) + "\n").encode() + struct.pack("<%df" % len(values), *values))
        sys.stdout.buffer.flush()

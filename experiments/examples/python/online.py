"""The same mapper, given scans one by one: `--mapper counting='online: python3 online.py'`."""
import json, math, struct, sys

for message in map(json.loads, sys.stdin):
    if message["type"] == "start":
        grid, sensors, prior = message["grid"], message["sensors"], message["sensors"][0]["prior"]["occupancy"]
        cell, (x0, y0), width, height = grid["cell_m"], grid["origin_m"], grid["width"], grid["height"]
        passed, hits = [0] * (width * height), [0] * (width * height)
    elif message["type"] == "scan":
        for angle, disparity in ((b, d) for b, d in zip(message["bearing_rad"], message["disparity_px"]) if d is not None):
            range_m = sensors[message["sensor"]]["noise"]["focal_baseline"] / (max(disparity, 0.1) * math.cos(angle))
            for r in [0.5 * cell * step for step in range(int(min(range_m, 30.0) / (0.5 * cell)))] + [range_m]:
                i = math.floor((message["x_m"] + r * math.cos(message["theta_rad"] + angle) - x0) / cell)
                j = math.floor((message["y_m"] + r * math.sin(message["theta_rad"] + angle) - y0) / cell)
                if 0 <= i < width and 0 <= j < height:
                    (hits if r == range_m else passed)[j * width + i] += 1
    elif message["type"] == "map":
        values = [(h + prior) / (h + 0.5 * p + 1) if h + p else math.nan for h, p in zip(hits, passed)]
        print(json.dumps({"schema_version": 1, "height": height, "width": width, "dtype": "<f4"}), flush=True)
        sys.stdout.buffer.write(struct.pack(f"<{len(values)}f", *values))
        sys.stdout.buffer.flush()

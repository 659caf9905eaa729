"""Scores a map from a file against a simulated world's truth."""

import sightgrid as sg

world = sg.simulate("room", seed=1)

# A map as any program of a robot may have left it.
mapper = sg.Mapper("log-odds-octomap", world.grid, world.sensor)
for scan in world.scans:
    mapper.integrate(scan)
sg.save_map("map.yaml", mapper.occupancy(), world.grid)

p, grid = sg.load_map("map.yaml")
for metric, value in sg.score(p, world, region="observable").items():
    print(f"{metric:<24}{value if value is None else round(value, 4)}")

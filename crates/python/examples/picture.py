"""A map beside the truth, drawn by matplotlib."""

import numpy as np

import sightgrid as sg

world = sg.simulate("halls", seed=3, layout=3)
mapper = sg.Mapper("visibility", world.grid, world.sensor)
for scan in world.scans:
    mapper.integrate(scan)
p = mapper.occupancy()

try:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
except ImportError:
    print(f"matplotlib is not installed; {np.isfinite(p).mean():.0%} of the cells were seen")
else:
    figure, axes = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
    for ax, cells, title in zip(axes, [world.truth, p], ["truth", "visibility"]):
        ax.imshow(cells, origin="lower", extent=world.grid.extent, cmap="gray_r", vmin=0, vmax=1)
        ax.plot(world.poses[:, 0], world.poses[:, 1], color="tab:blue", linewidth=1)
        ax.set(title=title, xlabel="x, m", ylabel="y, m", facecolor="lightsteelblue")
    figure.savefig("map.png", dpi=150)
    print("map.png")

"""A mapper of one's own against ours, on simulated drives with ground truth."""

import numpy as np

import sightgrid as sg


class HitsOverLooks:
    """The share of rays through a cell that end in it."""

    def __init__(self, grid: sg.Grid, sensor: sg.Sensor):
        self.grid, self.sensor = grid, sensor
        self.hits, self.looks = np.zeros(grid.shape), np.zeros(grid.shape)

    def integrate(self, scan: sg.Scan):
        x, y, theta = scan.pose
        for bearing, reading in zip(scan.bearings, scan.readings):
            range_m = self.sensor.range_of(reading, bearing) if np.isfinite(reading) else None
            if range_m is None:
                continue
            along = np.arange(0.0, min(range_m, 20.0), 0.5 * self.grid.cell_m)
            places = zip(x + along * np.cos(theta + bearing), y + along * np.sin(theta + bearing))
            cells = list(dict.fromkeys(cell for place in places if (cell := self.grid.cell_at(*place))))
            for cell in cells:
                self.looks[cell] += 1
            if cells:
                self.hits[cells[-1]] += 1

    def occupancy(self) -> np.ndarray:
        return (self.hits + 0.1) / (self.looks + 1.0)


found = sg.compare(
    {"visibility": "visibility", "conventional": "conventional", "mine": HitsOverLooks},
    sg.worlds("closets", seeds=range(1, 6)),
)
print(found)

"""Simulate drives of a robot, map their scans, and score the maps.

Everything here is computed by the same code as by the command line ``sightgrid``, so that numbers are equal to the last bit.

Arrays of a map have the shape ``(height, width)`` with the lowest row first, so that matplotlib shows them with ``origin="lower"``.
Metres, radians and nats are the units; NaN stands for what is not known.
"""

from ._sightgrid import (
    Event,
    Grid,
    Laser,
    Log,
    Mapper,
    Prior,
    Scan,
    Sensor,
    Simulation,
    Sonar,
    Stereo,
    __version__,
    load_map,
    mappers,
    paired,
    read_log,
    save_map,
    score,
    simulate,
)
from ._compare import Comparison, Row, compare, worlds

__all__ = [
    "Comparison",
    "Event",
    "Grid",
    "Laser",
    "Log",
    "Mapper",
    "Prior",
    "Row",
    "Scan",
    "Sensor",
    "Simulation",
    "Sonar",
    "Stereo",
    "__version__",
    "compare",
    "load_map",
    "mappers",
    "paired",
    "read_log",
    "save_map",
    "score",
    "simulate",
    "worlds",
]

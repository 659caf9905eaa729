"""Mappers compared on the same worlds."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from ._sightgrid import Grid, Mapper, Prior, Scan, Sensor, Simulation, paired, score, simulate


class MapsScans(Protocol):
    """A mapper of your own."""

    def integrate(self, scan: Scan) -> None:
        """Updates the map with a scan."""

    def occupancy(self) -> np.ndarray:
        """Probability that each cell is occupied, ``(height, width)``; NaN counts as the prior."""


#: Makes a mapper for a world: it is given its cells and the sensor.
Factory = Callable[[Grid, Sensor], MapsScans]


@dataclass(frozen=True)
class Row:
    """How a mapper did in one world: values of all metrics by name."""

    mapper: str
    world: str
    seed: int
    region: str
    metrics: Mapping[str, float | None]


@dataclass(frozen=True)
class Comparison:
    """What ``compare`` found."""

    rows: Sequence[Row]
    baseline: str

    def mappers(self) -> list[str]:
        """Names in the order in which they were given."""
        return list(dict.fromkeys(row.mapper for row in self.rows))

    def values(self, mapper: str, metric: str = "log_loss") -> list[float | None]:
        """A metric of a mapper, world by world."""
        found = [row.metrics for row in self.rows if row.mapper == mapper]
        if not found:
            raise ValueError(f"there is no mapper {mapper!r}; there are: {', '.join(self.mappers())}")
        if metric not in found[0]:
            raise ValueError(f"there is no metric {metric!r}; there are: {', '.join(found[0])}")
        return [metrics[metric] for metrics in found]

    def mean(self, mapper: str, metric: str = "log_loss") -> float:
        """Mean of a metric over the worlds in which it is defined; NaN where it is defined in none."""
        values = [value for value in self.values(mapper, metric) if value is not None]
        return float(np.mean(values)) if values else float("nan")

    def difference(self, mapper: str, metric: str = "log_loss", baseline: str | None = None) -> dict[str, float]:
        """Mean of the paired differences from the baseline with its 95 % interval: see ``paired``."""
        return paired(self.values(mapper, metric), self.values(baseline or self.baseline, metric))

    def table(self, metric: str = "log_loss") -> str:
        """A line per mapper: mean, and difference from the baseline with its 95 % interval."""
        width = max(len(name) for name in [*self.mappers(), "mapper"])
        lines = [f"{'mapper':<{width}}  {metric:>10}  {'minus ' + self.baseline:>20}  95 % interval"]
        for name in self.mappers():
            line = f"{name:<{width}}  {self.mean(name, metric):>10.4f}"
            if name != self.baseline:
                try:
                    found = self.difference(name, metric)
                    line += f"  {found['mean']:>+20.4f}  {found['low']:+.4f} to {found['high']:+.4f}"
                except ValueError as error:
                    line += f"  {error}"
            lines.append(line)
        return "\n".join(lines)

    def __str__(self) -> str:
        return self.table()


def worlds(scene: str, seeds: Iterable[int], *, cell_m: float | None = None) -> Iterator[Simulation]:
    """Simulated drives, one for every seed: of a family of scenes the layout of that number, of a scene other readings.

    Seeds from 1 on are the worlds of ``sightgrid compare``, from 10,001 on those on which parameters are chosen.
    """
    for seed in seeds:
        try:
            yield simulate(scene, seed, layout=seed, cell_m=cell_m)
        except ValueError as error:
            if "layout" not in str(error):
                raise
            yield simulate(scene, seed, cell_m=cell_m)


def compare(
    mappers: Sequence[str] | Mapping[str, str | Factory],
    worlds: Iterable[Simulation],
    *,
    region: str = "observable",
    prior: Prior | None = None,
    baseline: str | None = None,
    watch: Callable[[Row], Any] | None = None,
) -> Comparison:
    """Maps every world by every mapper from the same readings, and scores the maps.

    :param mappers: names of mappers; or a name for each, with the name of a mapper or a function that makes one of your own out of
        a ``Grid`` and a ``Sensor``
    :param worlds: simulated drives, at least two, such as ``worlds("halls", range(1, 11))``
    :param region: in which maps are scored
    :param prior: what the mappers of this package assume
    :param baseline: the mapper that others are compared with; default the first
    :param watch: told of every row
    """
    asked: dict[str, str | Factory] = dict(mappers) if isinstance(mappers, Mapping) else {name: name for name in mappers}
    if not asked:
        raise ValueError("mappers is empty; name one at least")
    baseline = baseline or next(iter(asked))
    if baseline not in asked:
        raise ValueError(f"the baseline {baseline!r} is not among the mappers: {', '.join(asked)}")
    rows: list[Row] = []
    for world in worlds:
        for name, made in asked.items():
            mapper = Mapper(made, world.grid, world.sensors, prior) if isinstance(made, str) else made(world.grid, world.sensor)
            if isinstance(mapper, Mapper) and mapper.kind == "noise-free":
                raise ValueError(f"{name} is to be given readings without noise, and is no rival")
            for scans in world.moments:
                if len(scans) > 1 and isinstance(mapper, Mapper):
                    mapper.integrate_together(scans)
                else:
                    for scan in scans:
                        mapper.integrate(scan)
            p = mapper.occupancy(unseen=None) if isinstance(mapper, Mapper) else np.asarray(mapper.occupancy(), dtype=float)
            row = Row(name, world.name, world.seed, region, score(p, world, region=region))
            rows.append(row)
            if watch:
                watch(row)
    return Comparison(rows, baseline)

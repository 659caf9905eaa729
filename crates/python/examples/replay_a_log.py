"""Maps the log of a robot, and asks which map foresees scans that it has not seen."""

import sightgrid as sg

LOG = "scenes/logs/aces.clf.bz2"  # comes with the package; any CARMEN log or table of scans

log = sg.read_log(LOG, every=5)
grid = sg.Grid(width=800, height=900, cell_m=0.05, origin_m=(-20.0, -35.0))
maps = {name: sg.Mapper(name, grid, log.sensor) for name in ["visibility", "independent"]}
loss, readings = dict.fromkeys(maps, 0.0), 0
for number, event in enumerate(log):
    if number % 10 == 9:  # kept back
        readings += len(event.scan)
        for name, mapper in maps.items():
            loss[name] -= mapper.evidence(event.scan) or 0.0
    else:
        for mapper in maps.values():
            mapper.integrate(event.scan)
for name in maps:
    print(f"{name:<14}{loss[name] / readings:.3f} nats per reading")

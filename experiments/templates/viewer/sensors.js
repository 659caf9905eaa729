// Worlds with several sensors: the readings of each, and what each has looked at. The robot's own scan (world.scans) has the camera's rays, if
// it has a camera, and the pose of the robot at every moment.

/**
 * @typedef {{name: string, width: number, all_round: boolean, after: number[], scans: PackedScans, most: number|null}} PackedSensor
 * @typedef {{name: string, width: number, all_round: boolean, unit: string, focal_baseline: number|null, most: number|null, ink: Colour,
 *   at: Map<number, Scan>}} Sensor most: range beyond which cones hear nothing, m; at: its scans by the number of the world's scan
 */

/** Colours of sensors in their order, beside each other and on any map: the first is that of a camera alone. @type {Colour[]} */
const SENSOR_INKS = [INK.route, [204, 102, 0], [100, 60, 180], [0, 110, 180], [150, 20, 80], [90, 90, 20]];

/** Names of the sensors that are switched off. @type {Set<string>} */
const switchedOff = new Set();

/** The sensors of a world; none where it has one. @param {World} world @returns {Sensor[]} */
const sensorsOf = (world) => once(world.sensors ?? world, () => {
  if (!world.sensors) return [];
  const [own, ground] = [world.scans, groundOf(world)];
  const camera = { name: "camera", width: 0, all_round: false, after: ground.scans.map((_, k) => k + 1), scans: own, most: null };
  const hasCamera = own.fans.some((fan) => fan.length > 0);
  return [...(hasCamera ? [camera] : []), ...world.sensors].map((packed, k) => {
    const { name, width, all_round, most, after, scans } = packed;
    const all = packed === camera ? ground.scans : scansOf(scans);
    return { name, width, all_round, most, unit: scans.unit, focal_baseline: scans.focal_baseline, ink: SENSOR_INKS[k % SENSOR_INKS.length],
      at: new Map(after.map((number, i) => [number, all[i]])) };
  });
});

/** The chosen world's sensors that are switched on and have read at the chosen moment, with what they read. */
function sensorsNow() {
  const number = shown.world.moments[chosen.moment];
  const all = sensorsOf(shown.world).filter(({ name, at }) => !switchedOff.has(name) && at.has(number));
  return all.map((sensor) => ({ sensor, scan: sensor.at.get(number) }));
}

const [rangeOfOne, readingOfOne] = [rangeOf, readingOf];

/** As of a camera with an image plane; the disparities of one that looks all round are of ranges. */
rangeOf = (world, reading, bearing) => rangeOfOne(world, reading, world.scans.all_round ? 0 : bearing);
readingOf = (world, range, bearing) => readingOfOne(world, range, world.scans.all_round ? 0 : bearing);

/** Adds to the count of every cell that cones of a scan looked into: once for each cone, up to what is nearest in it, or as far as it hears.
 * @param {World} world @param {Sensor} sensor @param {Scan} scan @param {Int32Array} looks @param {1|-1} sign */
function lookInto(world, sensor, scan, looks, sign) {
  const [x, y, theta] = scan.pose;
  scan.bearings.forEach((axis, k) => {
    const far = Math.min(scan.ranges[k] ?? Infinity, sensor.most ?? Infinity);
    const rays = Math.max(Math.ceil((1.5 * sensor.width * Math.min(far, world.cell_m * Math.hypot(world.width, world.height))) / world.cell_m), 2);
    const cells = new Set();
    for (let ray = 0; ray <= rays; ray++) {
      trace(world, [x, y], theta + axis + sensor.width * (ray / rays - 0.5), (cell, enter, exit) => {
        if (Math.min(exit, far) - enter > NUDGE_M) cells.add(cell);
        return exit < far;
      });
    }
    for (const cell of cells) looks[cell] += sign;
  });
}

/** Everything that any sensor looked at with a scan of the world, with sign. */
function lookOfAll(world, number, looks, sign) {
  for (const sensor of sensorsOf(world)) {
    const scan = sensor.at.get(number);
    if (!scan?.reach) continue;
    if (sensor.width > 0) lookInto(world, sensor, scan, looks, sign);
    else look(world, scan, looks, sign);
  }
}

const looksOfOne = looksAfter;

/** As before, of all sensors, whether they are switched on or not: a map is made from all. */
looksAfter = function (world, ground, scans) {
  if (!world.sensors) return looksOfOne(world, ground, scans);
  if (!world.scans.truth) return null;
  const kept = once(ground, () => {
    const looks = new Int32Array(world.width * world.height);
    for (let number = 1; number <= ground.scans.length; number++) lookOfAll(world, number, looks, 1);
    return { looks, scans: ground.scans.length, most: looks.reduce((a, b) => Math.max(a, b), 1) };
  });
  while (kept.scans < scans) lookOfAll(world, ++kept.scans, kept.looks, 1);
  while (kept.scans > scans) lookOfAll(world, kept.scans--, kept.looks, -1);
  return kept;
};

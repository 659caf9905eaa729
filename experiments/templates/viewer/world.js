// The worlds of the page, unpacked when they are asked for.

/**
 * @typedef {{name: string, label: string, moment: number}} Stage
 * @typedef {{name: string, moments: number[], levels: string, fine_moments: number[], fine: string, exact: string|null,
 *   scores: Object<string, (number|null)[]>[], known: string|null}} Mapper
 * @typedef {{unit: string, focal_baseline: number|null, step: number, range_step: number, fans: number[][], fan: number[],
 *   poses: number[][], times: number[], readings: string, truth: {ranges: string, reach: string}|null}} PackedScans
 * @typedef {{name: string, seed: number|null, cell_m: number, origin_m: number[], width: number, height: number, prior: number,
 *   radius_m: number, route: number[][], scans: PackedScans|null, moments: number[], stages: Stage[],
 *   regions: {name: string, cells: string}[], region_names: string[], truth: string|null, truths?: string, moving?: string, things?: (0|number[])[][], parts: string,
 *   metrics: string[][], mappers: Mapper[]}} World
 * @typedef {{bearings: number[], pose: number[], time_s: number, readings: (number|null)[], ranges: (number|null)[]|null,
 *   reach: number[]|null}} Scan
 * @typedef {{truth: Uint8Array|null, truths: Uint8Array[]|null, moving: Uint8Array[]|null, things: number[][][], parts: Uint8Array[], regions: Map<string, Uint8Array>, scans: Scan[]}} Ground
 * @typedef {{levels: Uint8Array[], fine: Map<number, Int16Array>, exact: Map<string, (number|null)[]>, known: Uint8Array|null}} Maps
 */

/** @type {{scale: {levels: number[], fine: number, exact: string[], exact_step: number}, thinned: boolean, worlds: World[]}} */
const DATA = JSON.parse(document.getElementById("viewer-data")?.textContent ?? '{"worlds":[]}');

/** Truth of a cell. */
const FREE = 0, OCCUPIED = 1, UNKNOWN = 2;

/** Names of the parts of a map, as coded: 0 is no part. */
const PARTS = ["", "visible", "surface", "shell", "hidden"];
const VISIBLE = 1, SURFACE = 2;

/** Names of the regions of a world that moves: bit k for the k-th. */
const MOVING = ["static", "swept", "occupied-now", "changed"];

/** Keeps what was unpacked, so that every block is unpacked once. @template T @param {object} key @param {() => T} unpack @returns {T} */
function once(key, unpack) {
  if (!once.unpacked.has(key)) once.unpacked.set(key, unpack());
  return once.unpacked.get(key);
}
once.unpacked = new Map();

/** @param {World} world @param {number} values @param {number} start */
const shapeOf = (world, values, start = 0) => ({ width: world.width, cells: world.width * world.height, values, start });

/** @param {World} world @param {string} text @returns {Uint8Array} */
const maskOf = (world, text) => film(text, 1, shapeOf(world, 2))[0];

/** @param {World} world @returns {Ground} */
const groundOf = (world) => once(world, () => ({
  truth: world.truth === null ? null : film(world.truth, 1, shapeOf(world, 3))[0],
  truths: world.truths ? film(world.truths, world.moments.length, shapeOf(world, 3)) : null,
  moving: world.moving ? film(world.moving, world.moments.length, shapeOf(world, 1 << MOVING.length)) : null,
  things: thingsOf(world.things ?? []),
  parts: film(world.parts, world.truth === null ? 0 : world.moments.length, shapeOf(world, PARTS.length)),
  regions: new Map(world.regions.map(({ name, cells }) => [name, maskOf(world, cells)])),
  scans: world.scans ? scansOf(world.scans) : [],
}));

/** What everything that moves covers at each moment, m; what has not moved since the moment before is coded as 0.
 * @param {(0|number[])[][]} moments mm @returns {number[][][]} */
function thingsOf(moments) {
  let former = [];
  return moments.map((now) => (former = now.map((thing, k) => (thing === 0 ? former[k] : thing.map((mm) => mm / 1e3)))));
}

/** @param {PackedScans} packed @returns {Scan[]} */
function scansOf(packed) {
  const fans = packed.fan.map((fan) => packed.fans[fan]);
  const rays = fans.reduce((sum, fan) => sum + fan.length, 0);
  const readings = series(packed.readings, rays, packed.step);
  const ranges = packed.truth && series(packed.truth.ranges, rays, packed.range_step);
  const reach = packed.truth && series(packed.truth.reach, rays, 1);
  let from = 0;
  return fans.map((bearings, k) => {
    const of = (all) => all && all.slice(from, from + bearings.length);
    const scan = { bearings, pose: packed.poses[k], time_s: packed.times[k], readings: of(readings), ranges: of(ranges), reach: of(reach) };
    from += bearings.length;
    return scan;
  });
}

/** @param {World} world @param {Mapper} mapper @returns {Maps} */
const mapsOf = (world, mapper) => once(mapper, () => {
  const { levels, fine } = DATA.scale;
  const start = nearest(levels, logOdds(world.prior));
  const maps = film(mapper.levels, mapper.moments.length, shapeOf(world, levels.length, start));
  const [decoder, numbers] = [new Decoder(mapper.fine), new Numbers()];
  const coarse = levels.map((l) => roundHalfAway(l / fine));
  const fines = new Map(mapper.fine_moments.map((moment) => {
    const of = maps[mapper.moments.indexOf(moment)];
    return [moment, Int16Array.from(of, (level) => coarse[level] + numbers.next(decoder))];
  }));
  return { levels: maps, fine: fines, exact: exactOf(world, mapper), known: mapper.known === null ? null : maskOf(world, mapper.known) };
});

/** The metrics that frames hold in numbers, by region and name, at the moments of the mapper. @param {World} world @param {Mapper} mapper */
function exactOf(world, mapper) {
  const { exact, exact_step } = DATA.scale;
  const rows = new Map();
  if (mapper.exact === null) return rows;
  const decoder = new Decoder(mapper.exact);
  for (const region of world.region_names) {
    for (const metric of exact) {
      const one = new Series();
      const steps = mapper.moments.map(() => one.next(decoder));
      rows.set(`${region} ${metric}`, steps.map((value) => (value === null ? null : value * exact_step)));
    }
  }
  return rows;
}

/** @param {number} x @returns {number} as Rust rounds */
const roundHalfAway = (x) => Math.sign(x) * Math.round(Math.abs(x));

/** @param {number} p @returns {number} */
const logOdds = (p) => Math.log(p / (1 - p));

/** @param {number} odds @returns {number} */
const probability = (odds) => 1 / (1 + Math.exp(-odds));

/** @param {number[]} sorted @param {number} value @returns {number} index */
const nearest = (sorted, value) => sorted.reduce((best, at, k) => (Math.abs(at - value) < Math.abs(sorted[best] - value) ? k : best), 0);

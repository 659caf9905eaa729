// What the rays of a scan cross, and where its readings lie.

/** As crates/score/src/sight.rs has it: a ray that runs through a cell for no more has not crossed it, m. */
const NUDGE_M = 1e-6;

/**
 * The cells that a ray crosses, nearest first, with the ranges at which it enters and leaves them (crates/grid/src/line.rs).
 * @param {World} world @param {number[]} origin m @param {number} angle rad @param {(cell: number, enter: number, exit: number) => boolean} visit
 *   until it returns false
 */
function trace(world, [x, y], angle, visit) {
  const { cell_m, origin_m, width, height } = world;
  const axis = (position, direction, from, size) => {
    const at = Math.floor((position - from) / cell_m);
    return { at, size, position, from, forward: direction > 0, inverse: direction === 0 ? Infinity : 1 / direction, next: Infinity };
  };
  const ahead = (a) => {
    if (Number.isFinite(a.inverse)) a.next = (a.from + (a.at + (a.forward ? 1 : 0)) * cell_m - a.position) * a.inverse;
  };
  const step = (a) => {
    a.at += a.forward ? 1 : -1;
    ahead(a);
    return a.at >= 0 && a.at < a.size;
  };
  const [across, up] = [axis(x, Math.cos(angle), origin_m[0], width), axis(y, Math.sin(angle), origin_m[1], height)];
  if (across.at < 0 || up.at < 0 || across.at >= width || up.at >= height) return;
  [across, up].forEach(ahead);
  for (let enter = 0; ;) {
    const cell = up.at * width + across.at;
    const moved = across.next <= up.next ? across : up;
    const exit = Math.max(moved.next, enter);
    if (!visit(cell, enter, exit)) return;
    enter = exit;
    if (!step(moved)) return;
  }
}

/** Adds to the count of every cell that rays of a scan looked at. @param {World} world @param {Scan} scan @param {Int32Array} looks @param {1|-1} sign */
function look(world, scan, looks, sign) {
  const [x, y, theta] = scan.pose;
  scan.bearings.forEach((bearing, k) => {
    let left = scan.reach[k];
    if (left === 0) return;
    trace(world, [x, y], theta + bearing, (cell, enter, exit) => {
      left--;
      if (left === 0 || exit - enter > NUDGE_M) looks[cell] += sign;
      return left > 0;
    });
  });
}

/** How many rays looked at each cell in the first scans, and at most at the end; null where that is not known.
 * @param {World} world @param {Ground} ground @param {number} scans @returns {{looks: Int32Array, most: number}|null} */
function looksAfter(world, ground, scans) {
  if (!ground.scans[0]?.reach) return null;
  const kept = once(ground, () => {
    const looks = new Int32Array(world.width * world.height);
    ground.scans.forEach((scan) => look(world, scan, looks, 1));
    return { looks, scans: ground.scans.length, most: looks.reduce((a, b) => Math.max(a, b), 1) };
  });
  for (; kept.scans < scans; kept.scans++) look(world, ground.scans[kept.scans], kept.looks, 1);
  for (; kept.scans > scans; kept.scans--) look(world, ground.scans[kept.scans - 1], kept.looks, -1);
  return kept;
}

/** Range at which a reading lies, m; null where it lies nowhere. @param {World} world @param {number|null} reading @param {number} bearing */
function rangeOf(world, reading, bearing) {
  if (reading === null) return null;
  const { focal_baseline } = world.scans;
  const range = focal_baseline === null ? reading : focal_baseline / (reading * Math.cos(bearing));
  return range >= 0 && Number.isFinite(range) ? range : null;
}

/** Reading that a camera would give of a range without noise. @param {World} world @param {number|null} range @param {number} bearing */
function readingOf(world, range, bearing) {
  if (range === null) return null;
  const { focal_baseline } = world.scans;
  return focal_baseline === null ? range : focal_baseline / (range * Math.cos(bearing));
}

/** Range at which a ray enters the first cell that a map holds occupied (p > 0.5), m; null where it meets none.
 * @param {World} world @param {Scan} scan @param {number} k ray @param {(cell: number) => number} p */
function expected(world, scan, k, p) {
  const [x, y, theta] = scan.pose;
  let range = null;
  trace(world, [x, y], theta + scan.bearings[k], (cell, enter, exit) => {
    if (p(cell) > HELD_OCCUPIED) range = 0.5 * (enter + exit);
    return range === null;
  });
  return range;
}

/** What the readings of a scan differ by from where a map has its first occupied cell, m. @param {World} world @param {Scan} scan
 * @param {(cell: number) => number} p @returns {{expected: (number|null)[], off: number[], unmatched: number}} */
function residuals(world, scan, p) {
  const ranges = scan.bearings.map((_, k) => expected(world, scan, k, p));
  const measured = scan.readings.map((reading, k) => rangeOf(world, reading, scan.bearings[k]));
  const off = measured.flatMap((range, k) => (range === null || ranges[k] === null ? [] : [range - ranges[k]]));
  return { expected: ranges, off, unmatched: measured.filter((range) => range !== null).length - off.length };
}

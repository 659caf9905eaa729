// The metrics of crates/score, from the cells on the screen.

/** As crates/score/src/threshold.rs has them. */
const CLIP = 1e-4, HELD_FREE = 0.2, HELD_OCCUPIED = 0.5, DECIDED_OCCUPIED = 0.8;

/** @param {number} code log odds in steps @param {number} step nats @returns {number} occupancy */
const probability = (code, step) => 1 / (1 + Math.exp(-code * step));

/** Log loss of one cell, nats. @param {number} p @param {boolean} occupied */
function cellLoss(p, occupied) {
  const clipped = Math.min(Math.max(p, CLIP), 1 - CLIP);
  return -Math.log(occupied ? clipped : 1 - clipped);
}

/** @param {number} part @param {number} of @returns {number|null} */
const share = (part, of) => (of > 0 ? part / of : null);

/**
 * Scores a map over the cells of a region whose truth is known; a metric without a cell to judge is null.
 * @param {Int16Array} codes @param {number} step @param {Uint8Array} truth
 * @param {(cell: number) => boolean} inside @param {(cell: number) => boolean} surface @param {number} area_m2 of a cell
 * @returns {Object<string, number|null>}
 */
function scores(codes, step, truth, inside, surface, area_m2) {
  const t = { loss: 0, squares: 0, free: 0, occupied: 0, surface: 0, heldFree: 0, decided: 0, decidedRight: 0,
    heldRight: 0, known: 0, lost: 0, missed: 0 };
  for (let cell = 0; cell < codes.length; cell++) {
    if (truth[cell] === UNKNOWN || !inside(cell)) continue;
    const p = probability(codes[cell], step);
    const occupied = truth[cell] === OCCUPIED;
    t.loss += cellLoss(p, occupied);
    t.squares += (p - truth[cell]) ** 2;
    t.heldFree += p < HELD_FREE;
    t.decided += p > DECIDED_OCCUPIED;
    if (occupied) {
      t.occupied++;
      t.heldRight += p > HELD_OCCUPIED;
      t.decidedRight += p > DECIDED_OCCUPIED;
      t.surface += surface(cell);
      t.missed += surface(cell) && p < HELD_FREE;
    } else {
      t.free++;
      t.known += p < HELD_FREE;
      t.lost += p > HELD_OCCUPIED;
    }
  }
  const cells = t.free + t.occupied;
  return {
    log_loss: share(t.loss, cells),
    brier: share(t.squares, cells),
    iou: share(t.heldRight, t.occupied + t.lost),
    decided: share(t.heldFree + t.decided, cells),
    free_agreement: share(t.known, t.heldFree),
    occupied_agreement: share(t.decidedRight, t.decided),
    phantom_area: t.free > 0 ? t.lost * area_m2 : null,
    missed_area: t.surface > 0 ? t.missed * area_m2 : null,
    free_known: share(t.known, t.free),
    free_lost: share(t.lost, t.free),
  };
}

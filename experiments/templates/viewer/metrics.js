// The metrics of crates/score that can be told from the cells on the screen.

/** As crates/score/src/threshold.rs has them. */
const CLIP = 1e-4, HELD_FREE = 0.2, HELD_OCCUPIED = 0.5, SAVED_OCCUPIED = 0.65, DECIDED_OCCUPIED = 0.8;

/** Log loss of one cell, nats. @param {number} p @param {boolean} occupied */
function cellLoss(p, occupied) {
  const clipped = Math.min(Math.max(p, CLIP), 1 - CLIP);
  return -Math.log(occupied ? clipped : 1 - clipped);
}

/** @param {number} part @param {number} of @returns {number|null} */
const share = (part, of) => (of > 0 ? part / of : null);

/**
 * Counts a map over the cells of a region whose truth is known: exact, since no level is on another side of a threshold than
 * the map. A metric without a cell to judge is null; one that counts do not give is missing.
 * @param {(cell: number) => number} p @param {Uint8Array} truth @param {(cell: number) => boolean} inside
 * @param {(cell: number) => boolean} surface @param {number} area_m2 of a cell @returns {Object<string, number|null>}
 */
function counts(p, truth, inside, surface, area_m2) {
  const t = { free: 0, occupied: 0, surface: 0, heldFree: 0, decided: 0, decidedRight: 0, heldRight: 0, known: 0, lost: 0,
    missed: 0, found: 0, saved: 0 };
  for (let cell = 0; cell < truth.length; cell++) {
    if (truth[cell] === UNKNOWN || !inside(cell)) continue;
    const at = p(cell);
    t.heldFree += at < HELD_FREE;
    t.decided += at > DECIDED_OCCUPIED;
    if (truth[cell] === OCCUPIED) {
      t.occupied++;
      t.heldRight += at > HELD_OCCUPIED;
      t.decidedRight += at > DECIDED_OCCUPIED;
      if (!surface(cell)) continue;
      t.surface++;
      t.missed += at < HELD_FREE;
      t.found += at > HELD_OCCUPIED;
      t.saved += at > SAVED_OCCUPIED;
    } else {
      t.free++;
      t.known += at < HELD_FREE;
      t.lost += at > HELD_OCCUPIED;
    }
  }
  const cells = t.free + t.occupied;
  return {
    iou: share(t.heldRight, t.occupied + t.lost),
    decided: share(t.heldFree + t.decided, cells),
    free_agreement: share(t.known, t.heldFree),
    occupied_agreement: share(t.decidedRight, t.decided),
    phantom_area: t.free > 0 ? t.lost * area_m2 : null,
    missed_area: t.surface > 0 ? t.missed * area_m2 : null,
    free_known: share(t.known, t.free),
    free_lost: share(t.lost, t.free),
    recall_50: share(t.found, t.surface),
    recall_65: share(t.saved, t.surface),
  };
}

// Which part of the maps is on the screen: all of them show the same.

/** Most that cells are enlarged. */
const MOST_ZOOM = 40;

/** How many times larger cells are drawn by the button. */
const ZOOM = 4;

/** The part on the screen. @param {World} world @returns {Box} */
function boxOf(world) {
  const { zoom, x, y } = chosen.part;
  return { x, y, columns: world.width / zoom, rows: world.height / zoom };
}

/** Shows another part, kept inside the map. @param {World} world @param {number} zoom @param {number} x @param {number} y lower left corner, cells */
function showPart(world, zoom, x, y) {
  const enlarged = Math.min(Math.max(zoom, 1), MOST_ZOOM);
  const within = (at, size) => Math.min(Math.max(at, 0), size - size / enlarged);
  chosen.part = { zoom: enlarged, x: within(x, world.width), y: within(y, world.height) };
  show();
}

/** Enlarges about a point that stays where it is. @param {World} world @param {number} by @param {[number, number]} about in cells */
function zoomAbout(world, by, [column, row]) {
  const { zoom, x, y } = chosen.part;
  const enlarged = Math.min(Math.max(zoom * by, 1), MOST_ZOOM);
  const share = zoom / enlarged;
  showPart(world, enlarged, column - (column - x) * share, row - (row - y) * share);
}

/** Puts a cell into the middle. @param {World} world @param {number} zoom @param {number} cell */
function centre(world, zoom, cell) {
  const [column, row] = [(cell % world.width) + 0.5, Math.floor(cell / world.width) + 0.5];
  showPart(world, zoom, column - world.width / zoom / 2, row - world.height / zoom / 2);
}

/** Enlarges the cell under the cursor, or else the region chosen, or the robot; or shows everything again. */
function zoom() {
  if (!shown) return;
  const { world, ground } = shown;
  if (chosen.part.zoom > 1) return showPart(world, 1, 0, 0);
  const isSmall = ground.regions.has(chosen.region) || (ground.moving !== null && MOVING.includes(chosen.region));
  const inside = isSmall ? [...Array(world.width * world.height).keys()].filter(insideRegion()) : [];
  const pose = ground.scans[world.moments[chosen.moment] - 1]?.pose ?? [0, 0];
  const [column, row] = [0, 1].map((axis) => Math.floor((pose[axis] - world.origin_m[axis]) / world.cell_m));
  centre(world, ZOOM, chosen.cursor ?? inside[Math.floor(inside.length / 2)] ?? row * world.width + column);
}

/** Place of the pointer, in cells. @param {PointerEvent|WheelEvent} event @param {HTMLElement} canvas @returns {[number, number]} */
function placeUnder(event, canvas) {
  const box = boxOf(shown.world);
  const frame = canvas.getBoundingClientRect();
  return [box.x + ((event.clientX - frame.left) / frame.width) * box.columns,
    box.y + (1 - (event.clientY - frame.top) / frame.height) * box.rows];
}

/** The cell at a place; null outside the map. @param {[number, number]} place */
function cellAt([column, row]) {
  const { width, height } = shown.world;
  if (column < 0 || row < 0 || column >= width || row >= height) return null;
  return Math.floor(row) * width + Math.floor(column);
}

/** Wheel, drag and pinch on a map. @param {HTMLCanvasElement} canvas */
function listenToPointers(canvas) {
  /** Where every finger was last. @type {Map<number, {x: number, y: number}>} */
  const fingers = new Map();
  const middle = () => {
    const all = [...fingers.values()];
    return { x: all.reduce((sum, f) => sum + f.x, 0) / all.length, y: all.reduce((sum, f) => sum + f.y, 0) / all.length };
  };
  const spread = () => {
    const [a, b] = [...fingers.values()];
    return b ? Math.hypot(a.x - b.x, a.y - b.y) : 0;
  };
  canvas.addEventListener("wheel", (event) => {
    // At the whole map, a turn outwards scrolls the page.
    if (!shown || (chosen.part.zoom === 1 && event.deltaY > 0)) return;
    event.preventDefault();
    zoomAbout(shown.world, Math.exp(-event.deltaY * (event.deltaMode === 1 ? 0.05 : 0.002)), placeUnder(event, canvas));
  }, { passive: false });
  canvas.addEventListener("pointerdown", (event) => {
    if (!shown) return;
    fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    canvas.setPointerCapture(event.pointerId);
    point(cellAt(placeUnder(event, canvas)));
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!shown) return;
    if (!fingers.has(event.pointerId)) return point(cellAt(placeUnder(event, canvas)));
    const [from, apart] = [middle(), spread()];
    fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    const [to, now] = [middle(), spread()];
    const box = boxOf(shown.world), width = canvas.getBoundingClientRect().width;
    const cells = box.columns / width;
    const { zoom, x, y } = chosen.part;
    if (zoom > 1) showPart(shown.world, zoom, x - (to.x - from.x) * cells, y + (to.y - from.y) * cells);
    if (apart > 0 && now > 0) zoomAbout(shown.world, now / apart, placeUnder({ clientX: to.x, clientY: to.y }, canvas));
  });
  for (const kind of ["pointerup", "pointercancel"]) canvas.addEventListener(kind, (event) => fingers.delete(event.pointerId));
}

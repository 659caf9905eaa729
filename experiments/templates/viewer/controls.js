// Time, cursor, keys and pointer; at the end, the start.

/** @param {number} moment */
function go(moment) {
  const last = DATA.worlds[chosen.world].moments.length - 1;
  chosen.moment = Math.min(Math.max(moment, 0), last);
  show();
}

/** @param {Box} box @param {number} cell */
function within(box, cell) {
  const [column, row] = [(cell % shown.world.width) - box.column, Math.floor(cell / shown.world.width) - box.row];
  return column >= 0 && row >= 0 && column < box.columns && row < box.rows;
}

/** @param {number|null} cell @param {boolean} aloud */
function point(cell, aloud = false) {
  if (!shown || cell === chosen.cursor) return;
  chosen.cursor = cell;
  if (cell !== null && chosen.zoom && !within(boxOf(shown.world), cell)) chosen.zoom = boxAround(cell);
  show();
  if (aloud) showReadout(true);
}

/** The cell under the pointer. @param {PointerEvent} event @returns {number|null} */
function cellUnder(event) {
  const box = boxOf(shown.world);
  const frame = event.currentTarget.getBoundingClientRect();
  const column = Math.floor(((event.clientX - frame.left) / frame.width) * box.columns);
  const row = box.rows - 1 - Math.floor(((event.clientY - frame.top) / frame.height) * box.rows);
  if (column < 0 || row < 0 || column >= box.columns || row >= box.rows) return null;
  return (box.row + row) * shown.world.width + box.column + column;
}

/** Time of one moment while playing, ms. */
const PACE_MS = 350;
let playing = 0;

/** @param {boolean} on */
function play(on) {
  clearInterval(playing);
  playing = 0;
  const last = DATA.worlds[chosen.world].moments.length - 1;
  if (on) {
    if (chosen.moment === last) go(0);
    playing = setInterval(() => (chosen.moment < last ? go(chosen.moment + 1) : play(false)), PACE_MS);
  }
  const button = element("viewer-play");
  button.textContent = on ? "❚❚ Pause" : "▶ Play";
  button.setAttribute("aria-pressed", `${on}`);
}

/** Moves the cursor by keyboard. @param {KeyboardEvent} event */
function steer(event) {
  const moves = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  const move = moves[event.key];
  if (!move || !shown) return;
  event.preventDefault();
  event.stopPropagation();
  const { world } = shown;
  const from = chosen.cursor ?? Math.floor(world.height / 2) * world.width + Math.floor(world.width / 2);
  const reach = chosen.cursor === null ? 0 : event.shiftKey ? 10 : 1;
  const clamp = (value, size) => Math.min(Math.max(value, 0), size - 1);
  const column = clamp((from % world.width) + move[0] * reach, world.width);
  const row = clamp(Math.floor(from / world.width) + move[1] * reach, world.height);
  point(row * world.width + column, true);
}

/** Keys that work anywhere in the viewer. @param {KeyboardEvent} event */
function shortcut(event) {
  if (event.ctrlKey || event.metaKey || event.altKey || event.target.matches("select, summary")) return;
  const views = [...document.querySelectorAll("input[name=viewer-view]")];
  const world = DATA.worlds[chosen.world];
  const ends = world.stages.map((stage) => stage.moment);
  const keys = {
    " ": () => event.target.matches("button, input[type=radio]") || (event.preventDefault(), play(!playing)),
    ",": () => go(chosen.moment - 1),
    ".": () => go(chosen.moment + 1),
    "[": () => go(ends.findLast((m) => m < chosen.moment) ?? 0),
    "]": () => go(ends.find((m) => m > chosen.moment) ?? world.moments.length - 1),
    z: zoom,
    Escape: () => point(null),
  };
  if (keys[event.key]) keys[event.key]();
  else if (views[Number(event.key) - 1]) views[Number(event.key) - 1].click();
}

/** Writes the choices into the address, so that a view can be kept and passed on. */
function remember() {
  const { world, mapper, beside, region, view, moment, cursor } = chosen;
  const at = { scene: DATA.worlds[world].name, mapper, beside, region, view, moment, ...(cursor === null ? {} : { cell: cursor }) };
  try {
    history.replaceState(null, "", `#${new URLSearchParams(Object.entries(at).map(([k, v]) => [k, `${v}`]))}`);
  } catch { /* an address that may not change is no loss */ }
}

/** Takes the choices from the address, where it has any. */
function recall() {
  const at = new URLSearchParams(location.hash.slice(1));
  const world = DATA.worlds.findIndex((w) => w.name === at.get("scene"));
  chosen.world = Math.max(world, 0);
  const { moments, width, height } = DATA.worlds[chosen.world];
  for (const key of ["mapper", "beside", "region"]) chosen[key] = at.get(key) ?? chosen[key];
  const number = (key, below) => (/^\d+$/.test(at.get(key) ?? "") && Number(at.get(key)) < below ? Number(at.get(key)) : null);
  chosen.moment = number("moment", moments.length) ?? moments.length - 1;
  chosen.cursor = number("cell", width * height);
  const view = [...document.querySelectorAll("input[name=viewer-view]")].find((v) => v.value === at.get("view"));
  if (view) [view.checked, chosen.view] = [true, view.value];
}

/** Connects the controls. */
function listen() {
  element("viewer-scene").addEventListener("change", (event) => {
    play(false);
    Object.assign(chosen, { world: event.target.selectedIndex, cursor: null, zoom: null, moment: Infinity });
    offer();
    choose();
  });
  for (const key of ["mapper", "beside", "region"]) element(`viewer-${key}`).addEventListener("change", choose);
  for (const input of document.querySelectorAll("input[name=viewer-view]")) {
    input.addEventListener("change", () => { chosen.view = input.value; show(); });
  }
  element("viewer-time").addEventListener("input", (event) => go(Number(event.target.value)));
  element("viewer-play").addEventListener("click", () => play(!playing));
  element("viewer-zoom").addEventListener("click", zoom);
  element("viewer").addEventListener("keydown", shortcut);
  for (const id of ["viewer-left", "viewer-right"]) {
    const canvas = element(id);
    canvas.addEventListener("keydown", steer);
    for (const kind of ["pointermove", "pointerdown"]) canvas.addEventListener(kind, (event) => shown && point(cellUnder(event)));
  }
  new ResizeObserver(() => show()).observe(element("viewer-maps"));
  // A printed page cannot be opened further.
  window.addEventListener("beforeprint", () => document.querySelectorAll("details").forEach((d) => (d.open = true)));
}

function start() {
  if (!DATA.worlds.length) return;
  element("viewer").hidden = false;
  recall();
  fill(element("viewer-scene"), DATA.worlds.map((world) => [world.name, world.name]), DATA.worlds[chosen.world].name);
  element("viewer-scene").closest("label").hidden = DATA.worlds.length === 1;
  offer();
  if (DATA.thinned) element("viewer-note").textContent = "Some moments between the ends of stages are left out, to keep this page small.";
  listen();
  choose();
}

start();

// Time, cursor and keys; at the end, the start.

/** @param {number} moment */
function go(moment) {
  const last = DATA.worlds[chosen.world].moments.length - 1;
  chosen.moment = Math.min(Math.max(moment, 0), last);
  show();
}

/** @param {number|null} cell @param {boolean} aloud */
function point(cell, aloud = false) {
  if (!shown || cell === chosen.cursor) return;
  chosen.cursor = cell;
  const { world } = shown;
  const box = boxOf(world);
  const [column, row] = cell === null ? [box.x, box.y] : [cell % world.width, Math.floor(cell / world.width)];
  const within = column + 1 > box.x && row + 1 > box.y && column < box.x + box.columns && row < box.y + box.rows;
  if (within) show();
  else centre(world, chosen.part.zoom, cell);
  if (aloud) showReadout(true);
}

/** Time that a whole drive takes to play, and least of one moment, ms. */
const DRIVE_MS = 20_000, PACE_MS = 60;
let playing = 0;

/** @param {boolean} on */
function play(on) {
  clearInterval(playing);
  playing = 0;
  const last = DATA.worlds[chosen.world].moments.length - 1;
  if (on && last > 0) {
    if (chosen.moment === last) go(0);
    const pace = Math.min(Math.max(DRIVE_MS / last, PACE_MS), 350);
    playing = setInterval(() => (chosen.moment < last ? go(chosen.moment + 1) : play(false)), pace);
  }
  const button = element("viewer-play");
  button.textContent = playing ? "❚❚ Pause" : "▶ Play";
  button.setAttribute("aria-pressed", `${Boolean(playing)}`);
  if (!playing && shown) remember();
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

/** Whether the viewer is on the screen: elsewhere on the page its keys are the browser's. */
function onScreen() {
  const { top, bottom } = element("viewer").getBoundingClientRect();
  return top < window.innerHeight && bottom > 0;
}

/** Enlarges about the middle of what is on the screen. @param {number} by */
function zoomMiddle(by) {
  const { x, y, columns, rows } = boxOf(shown.world);
  zoomAbout(shown.world, by, [x + columns / 2, y + rows / 2]);
}

/** What the keys do. @param {KeyboardEvent} event @returns {Object<string, () => void>} */
function keysOf(event) {
  const world = DATA.worlds[chosen.world];
  const ends = world.stages.map((stage) => stage.moment);
  // The slider and the choices have arrows of their own.
  const arrows = event.target.matches("input, canvas, [tabindex]") ? {} :
    { ArrowLeft: () => go(chosen.moment - 1), ArrowRight: () => go(chosen.moment + 1) };
  return {
    ...arrows,
    " ": () => play(!playing),
    ",": () => go(chosen.moment - 1),
    ".": () => go(chosen.moment + 1),
    "[": () => go(ends.findLast((m) => m < chosen.moment) ?? 0),
    "]": () => go(ends.find((m) => m > chosen.moment) ?? world.moments.length - 1),
    z: zoom,
    "+": () => zoomMiddle(1.5),
    "-": () => zoomMiddle(1 / 1.5),
    0: () => showPart(world, 1, 0, 0),
    s: () => element("viewer-scan").click(),
    Escape: () => point(null),
  };
}

/** Keys that work from the start, wherever the focus is. @param {KeyboardEvent} event */
function shortcut(event) {
  if (!shown || event.ctrlKey || event.metaKey || event.altKey || event.target.matches("select") || !onScreen()) return;
  if (event.key === " " && event.target.matches("button, a, summary, input:not([type=range])")) return;
  const views = [...document.querySelectorAll("input[name=viewer-view]")];
  const view = views[Number(event.key) - 1];
  const action = keysOf(event)[event.key] ?? (view && !view.closest("label").hidden ? () => view.click() : null);
  if (!action) return;
  event.preventDefault();
  action();
}

/** Writes the choices into the address, so that a view can be kept and passed on. */
function remember() {
  const { world, mapper, beside, region, view, moment, cursor, part, scan } = chosen;
  const zoomed = part.zoom > 1 ? { part: [part.zoom, part.x, part.y].map((n) => n.toFixed(2)).join() } : {};
  const at = { scene: DATA.worlds[world].name, mapper, beside, region, view, moment, ...zoomed,
    ...(scan ? {} : { scan: "off" }), ...(cursor === null ? {} : { cell: cursor }) };
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
  chosen.scan = at.get("scan") !== "off";
  element("viewer-scan").checked = chosen.scan;
  const [zoom, x, y] = (at.get("part") ?? "1,0,0").split(",").map(Number);
  const sound = zoom >= 1 && zoom <= MOST_ZOOM && x >= 0 && y >= 0 && x + width / zoom <= width + 0.01 && y + height / zoom <= height + 0.01;
  chosen.part = sound ? { zoom, x, y } : { zoom: 1, x: 0, y: 0 };
  const view = input(at.get("view") ?? "");
  if (view) [view.checked, chosen.view] = [true, view.value];
}

/** Takes up another address: a link of this page into the viewer. */
function follow() {
  if (!new URLSearchParams(location.hash.slice(1)).has("scene")) return;
  play(false);
  recall();
  element("viewer-scene").selectedIndex = chosen.world;
  offer();
  choose();
}

/** Connects the controls. */
function listen() {
  element("viewer-scene").addEventListener("change", (event) => {
    play(false);
    Object.assign(chosen, { world: event.target.selectedIndex, cursor: null, part: { zoom: 1, x: 0, y: 0 }, moment: Infinity });
    offer();
    choose();
  });
  for (const key of ["mapper", "beside", "region"]) element(`viewer-${key}`).addEventListener("change", choose);
  for (const one of document.querySelectorAll("input[name=viewer-view]")) {
    one.addEventListener("change", () => { chosen.view = one.value; show(); });
  }
  element("viewer-scan").addEventListener("change", (event) => { chosen.scan = event.target.checked; show(); });
  element("viewer-time").addEventListener("input", (event) => go(Number(event.target.value)));
  element("viewer-play").addEventListener("click", () => play(!playing));
  element("viewer-back").addEventListener("click", () => go(chosen.moment - 1));
  element("viewer-on").addEventListener("click", () => go(chosen.moment + 1));
  element("viewer-zoom").addEventListener("click", zoom);
  document.addEventListener("keydown", shortcut);
  for (const id of ["viewer-first", "viewer-left", "viewer-right"]) {
    element(id).addEventListener("keydown", steer);
    listenToPointers(element(id));
  }
  for (const svg of document.querySelectorAll("#viewer .curve")) {
    const follow = (event) => shown && event.buttons && go(momentUnder(event, svg));
    for (const kind of ["pointerdown", "pointermove"]) svg.addEventListener(kind, follow);
  }
  window.addEventListener("hashchange", follow);
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

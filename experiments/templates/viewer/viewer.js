// The viewer: what is chosen, and what follows from it.

/** @type {{step: number, thinned: boolean, worlds: World[]}} */
const DATA = JSON.parse(document.getElementById("viewer-data")?.textContent ?? '{"worlds":[]}');

/** @param {string} id @returns {any} */
const element = (id) => document.getElementById(id);

/** What is chosen. `mapper` and `beside` are names; `beside` may be "truth" or "none". */
const chosen = { world: 0, mapper: "", beside: "", region: "observable", view: "occupancy", moment: 0,
  /** @type {number|null} */ cursor: null, /** @type {Box|null} */ zoom: null };

/** Of what is chosen, unpacked. @type {{world: World, ground: Ground, panels: Panel[]}|null} */
let shown = null;

/** @typedef {{name: string, canvas: HTMLCanvasElement, mapper: Mapper|null, maps: Int16Array[]}} Panel */

const REGIONS = [["observable", "what could be seen so far"], ["visible", "free cells seen so far"],
  ["surface", "obstacles seen so far"], ["shell", "just behind what was seen"], ["hidden", "the rest"],
  ["all", "every cell whose truth is known"]];

/** @param {number|null|undefined} value @returns {string} */
const digits = (value) => (value === null || value === undefined ? "–" : value.toFixed(4));

/** @param {HTMLSelectElement} select @param {[string, string][]} options value and text @param {string} value */
function fill(select, options, value) {
  select.replaceChildren(...options.map(([key, text]) => new Option(text, key)));
  select.value = options.some(([key]) => key === value) ? value : options[0][0];
}

/** @param {string} tag @param {string} text @param {Object<string, string>} attributes */
function make(tag, text = "", attributes = {}) {
  const made = document.createElement(tag);
  made.textContent = text;
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  return made;
}

/** Fills the lists with what the chosen world has, keeping choices that it has too. */
function offer() {
  const world = DATA.worlds[chosen.world];
  const names = world.mappers.map((mapper) => [mapper.name, mapper.name]);
  fill(element("viewer-mapper"), names, chosen.mapper);
  const last = names.length > 1 ? names.at(-1)[0] : "truth";
  fill(element("viewer-beside"), [["truth", "the truth"], ...names, ["none", "nothing"]], chosen.beside || last);
  const named = world.regions.map((region) => [region.name, `${region.name}: a region of the scene`]);
  const by_rays = REGIONS.map(([name, what]) => [name, `${name}: ${what}`]);
  fill(element("viewer-region"), [by_rays[0], ...named, ...by_rays.slice(1)], chosen.region);
  element("viewer-stages").replaceChildren(...world.stages.map((stage) => {
    const button = make("button", `${stage.name}: ${stage.label}`, { type: "button", "data-moment": `${stage.moment}` });
    button.addEventListener("click", () => go(stage.moment));
    return button;
  }));
  element("viewer-time").max = `${world.moments.length - 1}`;
  element("viewer-ticks").replaceChildren(...world.stages.map((s) => make("option", "", { value: `${s.moment}`, label: s.name })));
  chosen.moment = Math.min(chosen.moment, world.moments.length - 1);
}

/** Counts choices: what was asked for first may be unpacked last. */
let choices = 0;

/** Reads the lists, unpacks what they ask for, and shows it. */
async function choose() {
  const section = element("viewer");
  const choice = ++choices;
  section.setAttribute("aria-busy", "true");
  for (const key of ["mapper", "beside", "region"]) chosen[key] = element(`viewer-${key}`).value;
  const world = DATA.worlds[chosen.world];
  const wanted = [["viewer-left", chosen.mapper], ["viewer-right", chosen.beside]].filter(([, name]) => name !== "none");
  try {
    const ground = await groundOf(world);
    const panels = await Promise.all(wanted.map(async ([id, name]) => {
      const mapper = world.mappers.find((m) => m.name === name) ?? null;
      return { name, canvas: element(id), mapper, maps: mapper ? await mapsOf(world, mapper) : [] };
    }));
    if (choice !== choices) return;
    shown = { world, ground, panels };
    show();
  } catch (error) {
    element("viewer-note").textContent = `This browser cannot unpack the maps (${error}); tables and pictures are below.`;
  }
  section.setAttribute("aria-busy", "false");
}

/** Number of the map that a panel has at a moment: the latest so far; -1 before the first. @param {Panel} panel */
const frameAt = (panel, moment) => panel.mapper.moments.findLastIndex((m) => m <= moment);

/** Log odds that a panel shows; null for the truth. @param {Panel} panel @returns {Int16Array|null} */
function codesOf(panel) {
  if (!panel.mapper) return null;
  const { world } = shown;
  const prior = Math.round(logOdds(world.prior) / DATA.step);
  return panel.maps[frameAt(panel, chosen.moment)] ?? new Int16Array(world.width * world.height).fill(prior);
}

/** Whether a cell belongs to the chosen region at the chosen moment. @returns {(cell: number) => boolean} */
function insideRegion() {
  const { truth, regions, parts } = shown.ground;
  const part = parts[chosen.moment];
  const named = regions.get(chosen.region);
  if (named) return (cell) => named[cell] === 1 && truth[cell] !== UNKNOWN;
  if (chosen.region === "all") return (cell) => part[cell] !== 0;
  if (chosen.region === "observable") return (cell) => part[cell] === 1 || part[cell] === 2;
  const code = PARTS.indexOf(chosen.region);
  return (cell) => part[cell] === code;
}

/** The cells on the screen. @param {World} world @returns {Box} */
const boxOf = (world) => chosen.zoom ?? { column: 0, row: 0, columns: world.width, rows: world.height };

/** How many times larger cells are drawn when zoomed. */
const ZOOM = 4;

/** The part of the map around a cell, whole cells inside the map. @param {number} cell @returns {Box} */
function boxAround(cell) {
  const { width, height } = shown.world;
  const [columns, rows] = [Math.ceil(width / ZOOM), Math.ceil(height / ZOOM)];
  const from = (at, size, whole) => Math.min(Math.max(at - Math.floor(size / 2), 0), whole - size);
  return { column: from(cell % width, columns, width), row: from(Math.floor(cell / width), rows, height), columns, rows };
}

/** Zooms to the cell under the cursor, or else to the region chosen, or to the robot; or out again. */
function zoom() {
  if (!shown) return;
  const { world, ground } = shown;
  const inside = [...(ground.regions.get(chosen.region) ?? []).keys()].filter((cell) => ground.regions.get(chosen.region)[cell]);
  const [column, row] = [0, 1].map((axis) =>
    Math.floor((world.moments[chosen.moment].pose[axis] - world.origin_m[axis]) / world.cell_m));
  const robot = row * world.width + column;
  chosen.zoom = chosen.zoom ? null : boxAround(chosen.cursor ?? inside[Math.floor(inside.length / 2)] ?? robot);
  show();
}

/** Draws everything anew. */
function show() {
  if (!shown) return;
  const { world, ground, panels } = shown;
  const most = ground.looks.at(-1).reduce((a, b) => Math.max(a, b), 1);
  const scene = { world, ground, moment: chosen.moment, view: chosen.view, step: DATA.step, most,
    inside: insideRegion(), cursor: chosen.cursor, box: boxOf(world) };
  // Where rays have looked is the same for every mapper.
  const drawn = chosen.view === "looks" ? panels.slice(0, 1) : panels;
  element("viewer-maps").classList.toggle("one", drawn.length === 1);
  element("viewer-right").closest("figure").hidden = drawn.length === 1;
  for (const panel of drawn) {
    paint(panel.canvas, scene, codesOf(panel));
    panel.canvas.closest("figure").querySelector("figcaption").textContent = titleOf(panel);
  }
  showTime(world);
  showLegend(world, most);
  showMetrics(scene);
  showReadout();
  remember();
}

/** @param {Panel} panel */
function titleOf(panel) {
  if (chosen.view === "looks") return "rays that have looked so far";
  if (!panel.mapper) return "truth";
  const every = panel.mapper.moments.length === shown.world.moments.length;
  const frame = frameAt(panel, chosen.moment);
  if (every) return panel.name;
  return frame < 0
    ? `${panel.name}: solved at the ends of stages, none yet`
    : `${panel.name}: as solved after scan ${shown.world.moments[panel.mapper.moments[frame]].scans}`;
}

/** @param {World} world */
function showTime(world) {
  const { scans, time_s } = world.moments[chosen.moment];
  const slider = element("viewer-time");
  slider.value = `${chosen.moment}`;
  const text = `scan ${scans} of ${world.scans}, ${time_s.toFixed(1)} s`;
  slider.setAttribute("aria-valuetext", text);
  element("viewer-moment").textContent = text;
  element("viewer-zoom").setAttribute("aria-pressed", `${chosen.zoom !== null}`);
  for (const button of element("viewer-stages").children) {
    button.setAttribute("aria-pressed", `${Number(button.dataset.moment) === chosen.moment}`);
  }
}

/** @param {World} world @param {number} most */
function showLegend(world, most) {
  const { scale, labels, patches } = legendOf(chosen.view, logOdds(Math.min(Math.max(world.prior, 1e-3), 1 - 1e-3)), most);
  const legend = element("viewer-legend");
  legend.replaceChildren();
  if (scale) {
    const bar = make("span", "", { class: "scale" });
    const strip = make("span", "", { class: "strip", style: `background: linear-gradient(to right, ${scale.join(", ")})` });
    const words = make("span", "", { class: "ends" });
    words.append(...labels.map((label) => make("span", label)));
    bar.append(strip, words);
    legend.append(bar);
  }
  for (const [text, colour] of [...(patches ?? []), ["outside the region", css(INK.outside)]]) {
    const patch = make("span", "", { class: "patch" });
    patch.append(make("i", "", { style: `background: ${colour}` }), text);
    legend.append(patch);
  }
}

/** The stage that ends at the chosen moment, if one does. @param {World} world @returns {number} -1 if none */
const stageNow = (world) => world.stages.findLastIndex((stage) => stage.moment === chosen.moment);

/** Metrics of every map on the screen over the chosen region. @param {Scene} scene */
function showMetrics({ world, ground, inside }) {
  const panels = shown.panels.filter((panel) => panel.mapper);
  const stage = stageNow(world);
  const part = ground.parts[chosen.moment];
  const surface = (cell) => part[cell] === 2;
  const columns = panels.map((panel) => {
    const cells = scores(codesOf(panel), DATA.step, ground.truth, inside, surface, world.cell_m ** 2);
    const table = stage < 0 ? null : (panel.mapper.scores[stage]?.[chosen.region] ?? null);
    return { cells, table };
  });
  const head = make("tr");
  head.append(make("th", "metric", { scope: "col" }), ...panels.map((panel) => make("th", panel.name, { scope: "col" })));
  const rows = world.metrics.map(([name, unit], number) => {
    const row = make("tr", "", { "data-metric": name });
    row.append(make("th", name.replaceAll("_", " ") + (unit === "1" ? "" : `, ${unit}`), { scope: "row" }));
    row.append(...columns.map(({ cells, table }) =>
      make("td", digits(table ? table[number] : cells[name]), { "data-cells": `${cells[name] ?? ""}` })));
    return row;
  });
  element("viewer-metrics").tHead.replaceChildren(head);
  element("viewer-metrics").tBodies[0].replaceChildren(...rows);
  let count = 0;
  for (let cell = 0; cell < ground.truth.length; cell++) count += inside(cell);
  element("viewer-count").textContent = `${chosen.region}: ${count} cells. ` + (stage < 0
    ? "Computed from the cells on the screen; a dash is not defined here or known at the ends of stages only."
    : `End of stage ${world.stages[stage].name}: the numbers of the tables (seed ${world.seed}).`);
}

/** Position of a cell's centre, m. @param {World} world @param {number} cell */
function placeOf(world, cell) {
  const [column, row] = [cell % world.width, Math.floor(cell / world.width)];
  const centre = [column, row].map((index, axis) => world.origin_m[axis] + (index + 0.5) * world.cell_m);
  return { column, row, x_m: centre[0], y_m: centre[1] };
}

/** What is known of the cell under the cursor. @param {boolean} aloud whether to tell a screen reader */
function showReadout(aloud = false) {
  const { world, ground, panels } = shown;
  const cell = chosen.cursor;
  element("viewer-hint").hidden = cell !== null;
  element("viewer-cell").hidden = cell === null;
  if (cell === null) return;
  const { column, row, x_m, y_m } = placeOf(world, cell);
  const truth = ["free", "occupied", "not known"][ground.truth[cell]];
  const part = PARTS[ground.parts[chosen.moment][cell]] || "no region";
  const looks = ground.looks[chosen.moment][cell];
  const facts = { cell: `${column}, ${row}`, x: `${x_m.toFixed(3)} m`, y: `${y_m.toFixed(3)} m`, truth, part, rays: `${looks}` };
  for (const [name, text] of Object.entries(facts)) element(`viewer-${name === "cell" ? "index" : name}`).textContent = text;
  const maps = panels.filter((panel) => panel.mapper).map((panel) => {
    const p = probability(codesOf(panel)[cell], DATA.step);
    const loss = truth === "not known" ? null : cellLoss(p, truth === "occupied");
    return { name: panel.name, p, loss };
  });
  element("viewer-values").replaceChildren(...maps.map(({ name, p, loss }) => {
    const line = make("tr", "", { "data-mapper": name });
    line.append(make("th", name, { scope: "row" }), make("td", p.toFixed(4)), make("td", digits(loss)));
    return line;
  }));
  if (!aloud) return;
  const said = maps.map(({ name, p }) => `${name} ${p.toFixed(4)}`).join(", ");
  element("viewer-said").textContent = `Column ${column}, row ${row}: ${said}; truth ${truth}; ${looks} rays`;
}

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

// Everything on the screen that follows from the choices.

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

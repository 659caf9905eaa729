// Everything on the screen that follows from the choices.

/** Sets what every panel shows at the chosen moment: its latest map so far, or nothing before the first. */
function advance() {
  const { world, ground, panels } = shown;
  const { levels, fine } = DATA.scale;
  if (ground.truths) ground.truth = ground.truths[chosen.moment];
  shown.scan = ground.scans[world.moments[chosen.moment] - 1] ?? null;
  for (const panel of panels) {
    panel.frame = panel.mapper.moments.findLastIndex((moment) => moment <= chosen.moment);
    const [map, steps] = [panel.maps.levels[panel.frame], panel.maps.fine.get(panel.mapper.moments[panel.frame])];
    panel.fine = Boolean(steps);
    panel.odds = map ? (cell) => levels[map[cell]] : () => logOdds(world.prior);
    panel.p = steps ? (cell) => probability(steps[cell] * fine) : (cell) => probability(panel.odds(cell));
  }
}

/** Whether the map of a panel is of the chosen moment. @param {Panel} panel */
const isOfNow = (panel) => panel.mapper.moments[panel.frame] === chosen.moment;

/** Whether a cell belongs to the chosen region at the chosen moment. @returns {(cell: number) => boolean} */
function insideRegion() {
  const { truth, regions, parts, moving } = shown.ground;
  if (!truth) return () => true;
  const part = parts[chosen.moment];
  const named = regions.get(chosen.region);
  if (named) return (cell) => named[cell] === 1 && truth[cell] !== UNKNOWN;
  if (chosen.region === "all") return (cell) => part[cell] !== 0;
  if (chosen.region === "observable") return (cell) => part[cell] === VISIBLE || part[cell] === SURFACE;
  const bit = MOVING.indexOf(chosen.region);
  if (moving && bit >= 0) return (cell) => ((moving[chosen.moment][cell] >> bit) & 1) === 1;
  const code = PARTS.indexOf(chosen.region);
  return (cell) => part[cell] === code;
}

/** Log odds of a cell that nothing is known of, kept from certainty. @param {World} world */
const fromOdds = (world) => logOdds(Math.min(Math.max(world.prior, 1e-3), 1 - 1e-3));

/** Colours of the first panel: the truth, or how many rays have looked. @param {Scene} scene @returns {Colouring} */
function groundColours({ ground, looks }) {
  if (chosen.view === "looks" && looks) return (cell) => looksColour(looks.looks[cell], looks.most);
  if (ground.truth) return (cell) => truthColour(ground.truth[cell]);
  const { known } = shown.panels[0].maps;
  return (cell) => (known && !known[cell] ? INK.unknown : [255, 255, 255]);
}

/** Colours of a map. @param {Scene} scene @param {Panel} panel @returns {Colouring} */
function mapColours({ world, ground, looks }, panel) {
  const from = fromOdds(world);
  const { known } = panel.maps;
  // Nobody knows anything of a cell that no ray has reached, whatever the mapper expects of it.
  const unseen = (cell) => (known ? !known[cell] : looks !== null && looks.looks[cell] === 0);
  const grey = (cell) => (unseen(cell) ? INK.unknown : occupancyColour(panel.odds(cell), from));
  if (chosen.view === "truth") return (cell) => overlayColour(grey(cell), ground.truth[cell]);
  if (chosen.view !== "error") return grey;
  return (cell) => (ground.truth[cell] === UNKNOWN ? INK.unknown : errorColour(panel.p(cell) - ground.truth[cell]));
}

/** Draws everything anew. */
function show() {
  if (!shown) return;
  advance();
  const { world, ground, panels, scan } = shown;
  const looks = looksAfter(world, ground, world.moments[chosen.moment]);
  const scene = { world, ground, moment: chosen.moment, scan, drawScan: chosen.scan, drawRays: false, looks,
    inside: insideRegion(), cursor: chosen.cursor, box: boxOf(world) };
  element("viewer-maps").style.setProperty("--panels", `${1 + panels.length}`);
  element("viewer-right").closest("figure").hidden = panels.length === 1;
  paint(element("viewer-first"), { ...scene, drawRays: true }, groundColours(scene));
  title(element("viewer-first"), chosen.view === "looks" ? "rays that have looked so far" : ground.truth ? "truth" : "what was seen, and the scan");
  for (const panel of panels) {
    paint(panel.canvas, scene, mapColours(scene, panel));
    title(panel.canvas, titleOf(panel));
  }
  showTime(world);
  showLegend(scene);
  showCurve("log_loss", 3);
  showCurve("retention", 3);
  showStrip();
  if (ground.truth) showMetrics(scene);
  showReadout();
  if (!playing) remember();
}

/** @param {HTMLCanvasElement} canvas @param {string} text */
function title(canvas, text) {
  canvas.closest("figure").querySelector("figcaption").textContent = text;
}

/** @param {Panel} panel */
function titleOf(panel) {
  const { world } = shown;
  if (world.truth === null || panel.mapper.moments.length === world.moments.length) return panel.name;
  if (panel.frame < 0) return `${panel.name}: solved at the ends of stages, none yet`;
  return `${panel.name}: as solved after scan ${shown.world.moments[panel.mapper.moments[panel.frame]]}`;
}

/** @param {World} world */
function showTime(world) {
  const scans = world.moments[chosen.moment];
  const slider = element("viewer-time");
  slider.value = `${chosen.moment}`;
  const text = `scan ${scans} of ${world.moments.at(-1)}${world.truth === null ? " shown of those kept back" : ""}` + (shown.scan ? `, ${shown.scan.time_s.toFixed(1)} s` : "");
  slider.setAttribute("aria-valuetext", text);
  element("viewer-moment").textContent = text;
  element("viewer-zoom").setAttribute("aria-pressed", `${chosen.part.zoom > 1}`);
  element("viewer-maps").classList.toggle("zoomed", chosen.part.zoom > 1);
  for (const button of element("viewer-stages").children) {
    button.setAttribute("aria-pressed", `${Number(button.dataset.moment) === chosen.moment}`);
  }
}

/** Everything that has a colour on the screen. @param {Scene} scene */
function showLegend({ world, ground, looks, scan }) {
  const { scales, patches } = legendOf(chosen.view, fromOdds(world), looks?.most ?? 1, ground.truth !== null);
  const lines = [
    ...(ground.truth ? [["outside the region", "hatched", ""]] : []),
    ...(world.regions.length ? [[`region ${world.regions.map((region) => region.name).join(", ")}`, "line", css(INK.region)]] : []),
    ...(ground.things.length ? [["what moves, where it is now", "line", css(INK.thing)]] : []),
    ...(scan || world.route.length ? [["the way so far, and the robot", "line", css(INK.route)]] : []),
    ...(scan && chosen.scan ? [["rays", "line", css(INK.route, 0.35)], ["field of view", "dashed", css(INK.route)], ["readings", "dot", css(INK.reading)]] : []),
    ["the cell pointed at", "frame", css(INK.cursor)],
  ];
  const patch = ([text, colour]) => entry(text, "", `background: ${colour}`);
  element("viewer-legend").replaceChildren(...scales.map(scaleOf), ...patches.map(patch),
    ...lines.map(([text, kind, colour]) => entry(text, kind, `--ink: ${colour}`)));
}

/** @param {string} text @param {string} kind @param {string} style */
function entry(text, kind, style) {
  const made = make("span", "", { class: "patch" });
  made.append(make("i", "", { class: kind, style }), text);
  return made;
}

/** @param {{stops: string[], labels: string[]}} scale */
function scaleOf({ stops, labels }) {
  const bar = make("span", "", { class: "scale" });
  const words = make("span", "", { class: "ends" });
  words.append(...labels.map((label) => make("span", label)));
  bar.append(make("span", "", { class: "strip", style: `background: linear-gradient(to right, ${stops.join(", ")})` }), words);
  return bar;
}

/** The stage that ends at the chosen moment, if one does. @param {World} world @returns {number} -1 if none */
const stageNow = (world) => world.stages.findLastIndex((stage) => stage.moment === chosen.moment);

/** A metric of a map over the chosen region: of the tables at the end of a stage; else one that is exact; else null. */
function metricsOf(panel, scene) {
  const { world, ground, inside } = scene;
  const surface = (cell) => ground.parts[chosen.moment][cell] === SURFACE;
  // A map of an earlier moment is not judged by what was seen since.
  if (!isOfNow(panel)) return { own: {}, table: null };
  const own = counts(panel.p, ground.truth, inside, surface, world.cell_m ** 2);
  for (const metric of DATA.scale.exact) own[metric] = panel.maps.exact.get(`${chosen.region} ${metric}`)?.[panel.frame] ?? null;
  const stage = stageNow(world);
  return { own, table: stage < 0 ? null : (panel.mapper.scores[stage]?.[chosen.region] ?? null) };
}

/** Whether the chosen region has a metric: every region has those of the shortest row, and some that follows from movement more.
 * @param {World} world @param {number} number */
function hasMetric(world, number) {
  const stages = world.mappers.flatMap((mapper) => mapper.scores);
  const common = Math.min(...stages.flatMap((stage) => Object.values(stage).map((values) => values.length)));
  return number < common || stages.some((stage) => (stage[chosen.region]?.[number] ?? null) !== null);
}

/** Metrics of both maps over the chosen region. @param {Scene} scene */
function showMetrics(scene) {
  const { world, ground, inside } = scene;
  const columns = shown.panels.map((panel) => metricsOf(panel, scene));
  const head = make("tr");
  head.append(make("th", "metric", { scope: "col" }), ...shown.panels.map(({ name }) => make("th", name, { scope: "col" })));
  const rows = world.metrics.map(([name, unit], number) => {
    if (!hasMetric(world, number)) return null;
    const row = make("tr", "", { "data-metric": name });
    const heading = make("th", name.replaceAll("_", " ") + (unit === "1" ? "" : `, ${unit}`), { scope: "row" });
    row.append(heading, ...columns.map(({ own, table }) =>
      make("td", round(table ? table[number] : own[name]), { "data-own": `${own[name] ?? ""}` })));
    return row;
  });
  element("viewer-metrics").tHead.replaceChildren(head);
  element("viewer-metrics").tBodies[0].replaceChildren(...rows.filter((row) => row !== null));
  let count = 0;
  for (let cell = 0; cell < ground.truth.length; cell++) count += inside(cell);
  const stage = stageNow(world);
  element("viewer-count").textContent = `${chosen.region}: ${count} cells. ` + (stage < 0
    ? "Between stages: exact; a dash is not defined here, or known at the ends of stages only."
    : `${world.moments.length === 1 ? "The" : `End of stage ${world.stages[stage].name}: the`} numbers of the tables${world.seed === null ? "" : ` (seed ${world.seed})`}.`);
}

/** Position of a cell's centre, m. @param {World} world @param {number} cell */
function placeOf(world, cell) {
  const [column, row] = [cell % world.width, Math.floor(cell / world.width)];
  const at = [column, row].map((index, axis) => world.origin_m[axis] + (index + 0.5) * world.cell_m);
  return { column, row, x_m: at[0], y_m: at[1] };
}

/** What is known of the cell under the cursor. @param {boolean} aloud whether to tell a screen reader */
function showReadout(aloud = false) {
  const { world, ground, panels } = shown;
  const cell = chosen.cursor;
  const dash = { index: "–", truth: "–", x: "–", part: "–", y: "–", rays: "–" };
  const facts = cell === null ? dash : factsOf(world, ground, cell);
  for (const [name, text] of Object.entries(facts)) element(`viewer-${name}`).textContent = text;
  const maps = panels.map(({ name, p, fine }) => {
    if (cell === null) return { name, p: "–", loss: "–" };
    // Levels are within 0.0125 of the map; at the ends of stages there is more.
    const [digits, about] = fine ? [4, ""] : [2, "≈ "];
    const loss = ground.truth && ground.truth[cell] !== UNKNOWN ? about + cellLoss(p(cell), ground.truth[cell] === OCCUPIED).toFixed(digits) : "–";
    return { name, p: about + p(cell).toFixed(digits), loss };
  });
  element("viewer-values").replaceChildren(...maps.map(({ name, p, loss }) => {
    const line = make("tr", "", { "data-mapper": name });
    line.append(make("th", name, { scope: "row" }), make("td", p), make("td", loss));
    return line;
  }));
  if (!aloud || cell === null) return;
  const said = maps.map(({ name, p }) => `${name} ${p}`).join(", ");
  const { column, row } = placeOf(world, cell);
  element("viewer-said").textContent = `Column ${column}, row ${row}: ${said}; truth ${facts.truth}; ${facts.rays} rays`;
}

/** @param {World} world @param {Ground} ground @param {number} cell */
function factsOf(world, ground, cell) {
  const { column, row, x_m, y_m } = placeOf(world, cell);
  const looks = looksAfter(world, ground, world.moments[chosen.moment]);
  return {
    index: `${column}, ${row}`,
    truth: ground.truth ? ["free", "occupied", "not known"][ground.truth[cell]] : "not known",
    x: `${x_m.toFixed(3)} m`,
    part: [PARTS[ground.parts[chosen.moment]?.[cell] ?? 0], ...MOVING.filter((_, k) => (ground.moving?.[chosen.moment][cell] >> k) & 1)]
      .filter(Boolean).join(", ") || "no region",
    y: `${y_m.toFixed(3)} m`,
    rays: looks ? `${looks.looks[cell]}` : "–",
  };
}

// Curves under the slider, and the strip of the scan: drawings that follow the moment.

/** @param {string} tag @param {Object<string, string|number>} attributes @param {string} text */
function draw(tag, attributes, text = "") {
  const drawn = document.createElementNS(element("viewer-strip").namespaceURI, tag);
  for (const [name, value] of Object.entries(attributes)) drawn.setAttribute(name, `${value}`);
  drawn.textContent = text;
  return drawn;
}

/** A line through points; a gap where there is no value. @param {([number, number]|null)[]} points */
const path = (points) => points.map((at, k) => (at ? `${k && points[k - 1] ? "L" : "M"}${at[0].toFixed(1)} ${at[1].toFixed(1)}` : "")).join("");

/** Dots as one path. @param {([number, number]|null)[]} points */
const dots = (points) => points.map((at) => (at ? `M${at[0].toFixed(1)} ${at[1].toFixed(1)}h0` : "")).join("");

/** Room for the numbers at the left of a drawing, and above it, px. */
const MARGIN = 46, HEAD = 6;

/**
 * An empty drawing with an axis upwards. @param {SVGElement} svg @param {number} low @param {number} high @param {number} digits
 * @returns {{width: number, height: number, y: (value: number) => number}}
 */
function axis(svg, low, high, digits) {
  const [width, height] = [svg.clientWidth || 300, svg.clientHeight || 80];
  svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
  const y = (value) => HEAD + (1 - (value - low) / Math.max(high - low, 1e-9)) * (height - 2 * HEAD);
  svg.replaceChildren(...[low, high].flatMap((value) => [
    draw("path", { class: "axis", d: `M${MARGIN} ${y(value)}H${width}` }),
    draw("text", { x: MARGIN - 5, y: y(value) + (value === low ? 0 : 8), "text-anchor": "end" }, value.toFixed(digits)),
  ]));
  return { width, height, y };
}

/** @param {World} world @param {number} width @returns {(moment: number) => number} px */
const across = (world, width) => (moment) => MARGIN + 8 + (moment / Math.max(world.moments.length - 1, 1)) * (width - MARGIN - 16);

/** Exact values of a metric at every moment of the world; null where a mapper has none. @param {Panel} panel @param {string} metric */
function valuesOf({ mapper, maps }, metric) {
  const values = maps.exact.get(`${chosen.region} ${metric}`) ?? [];
  const at = new Map(mapper.moments.map((moment, k) => [moment, values[k] ?? null]));
  return shown.world.moments.map((_, moment) => at.get(moment) ?? null);
}

/** Draws a metric of both maps over all moments. @param {string} metric @param {number} digits */
function showCurve(metric, digits) {
  const { world, panels } = shown;
  const svg = element(`viewer-curve-${metric}`);
  const series = panels.map((panel) => valuesOf(panel, metric));
  const all = series.flat().filter((value) => value !== null);
  svg.closest("figure").hidden = all.length === 0;
  if (!all.length) return;
  const [low, high] = metric === "retention" ? [Math.min(...all, 0.99), 1] : [0, Math.max(...all, 1e-3)];
  const { width, height, y } = axis(svg, low, high, digits);
  const x = across(world, width);
  for (const stage of world.stages) svg.append(draw("path", { class: "stage", d: `M${x(stage.moment)} ${HEAD}V${height - HEAD}` }));
  series.forEach((values, k) => {
    const points = values.map((value, moment) => (value === null ? null : [x(moment), y(value)]));
    const alone = values.filter((value) => value !== null).length <= world.stages.length;
    svg.append(draw("path", { class: `line ${SIDES[k]}${alone ? " alone" : ""}`, d: alone ? dots(points) : path(points) }));
  });
  svg.append(draw("path", { class: "now", d: `M${x(chosen.moment)} 0V${height}` }));
  const said = panels.map(({ name }, k) => `${name} ${round(series[k][chosen.moment], digits)}`).join(", ");
  svg.setAttribute("aria-label", `${metric.replaceAll("_", " ")} over the scans; now ${said}`);
}

/** Names of the two maps in styles. */
const SIDES = ["left", "right"];

/** The moment under the pointer. @param {PointerEvent} event @param {SVGElement} svg */
function momentUnder(event, svg) {
  const frame = svg.getBoundingClientRect();
  const share = (event.clientX - frame.left - MARGIN - 8) / Math.max(frame.width - MARGIN - 16, 1);
  return Math.round(share * (shown.world.moments.length - 1));
}

/** The readings of the scan by bearing, as the sensor sees them from left to right, beside what is true or expected. */
function showStrip() {
  const { world, panels, scan } = shown;
  const figure = element("viewer-strip").closest("figure");
  figure.hidden = !scan;
  if (!scan) return;
  const { unit } = world.scans;
  const foreseen = scan.ranges ?? residuals(world, scan, panels[0].p).expected;
  const readings = scan.bearings.map((bearing, k) => [scan.readings[k], readingOf(world, foreseen[k], bearing)]);
  const most = once(world.scans, () => mostOf(world, shown.ground));
  const svg = element("viewer-strip");
  const { width, height, y } = axis(svg, 0, most, unit === "px" ? 0 : 1);
  const [first, last] = [scan.bearings[0], scan.bearings.at(-1)];
  const x = (bearing) => MARGIN + 8 + ((last - bearing) / Math.max(last - first, 1e-9)) * (width - MARGIN - 16);
  const at = (value, k) => (value === null ? null : [x(scan.bearings[k]), y(Math.min(value, most))]);
  svg.append(draw("path", { class: "true", d: path(readings.map(([, truth], k) => at(truth, k))) }));
  svg.append(draw("path", { class: "reading", d: dots(readings.map(([reading], k) => at(reading, k))) }));
  svg.append(draw("text", { x: MARGIN + 8, y: height - 1 }, `${degrees(last)}°`));
  svg.append(draw("text", { x: width - 8, y: height - 1, "text-anchor": "end" }, `${degrees(first)}°`));
  const what = unit === "px" ? "disparity, px" : "range, m";
  element("viewer-strip-title").textContent = `Readings of the scan: ${what}, by bearing`;
  element("viewer-strip-line").textContent = scan.ranges ? "without noise" : `first cell of ${panels[0].name} with p > 0.5`;
  const read = scan.readings.filter((reading) => reading !== null).length;
  element("viewer-strip-said").textContent = `${read} of ${scan.bearings.length} rays have a reading. ${agreement()}`;
}

/** How far the readings lie from the surfaces of the maps. @returns {string} */
function agreement() {
  const { world, panels, scan } = shown;
  return panels.map(({ name, p }) => {
    const { off, unmatched } = residuals(world, scan, p);
    const sizes = off.map(Math.abs).sort((a, b) => a - b);
    const median = sizes.length ? `${sizes[Math.floor(sizes.length / 2)].toFixed(3)} m` : "–";
    return `${name}: median residual ${median}, ${unmatched} without a surface.`;
  }).join(" ");
}

/** Top of the strip: above what nearly all rays read without noise, or else nearly all readings. @param {World} world @param {Ground} ground */
function mostOf(world, ground) {
  const noiseFree = (scan) => scan.ranges?.map((range, k) => readingOf(world, range, scan.bearings[k])) ?? scan.readings;
  const all = ground.scans.flatMap((scan) => noiseFree(scan).filter((reading) => reading !== null)).sort((a, b) => a - b);
  return Math.ceil(1.4 * (all[Math.floor(0.98 * (all.length - 1))] ?? 1));
}

/** @param {number} angle rad */
const degrees = (angle) => Math.round((angle * 180) / Math.PI);

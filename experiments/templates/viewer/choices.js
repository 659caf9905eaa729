// What is chosen, and the maps that it asks for.

/** @param {string} id @returns {any} */
const element = (id) => document.getElementById(id);

/** What is chosen. `mapper` and `beside` are names; `part` is the part of the map on the screen, see view.js. */
const chosen = { world: 0, mapper: "", beside: "", region: "observable", view: "occupancy", moment: 0, scan: true,
  /** @type {number|null} */ cursor: null, part: { zoom: 1, x: 0, y: 0 } };

/** @typedef {{name: string, canvas: HTMLCanvasElement, mapper: Mapper, maps: Maps, frame: number, p: (cell: number) => number}} Panel */

/** Of what is chosen, unpacked. @type {{world: World, ground: Ground, panels: Panel[], scan: Scan|null}|null} */
let shown = null;

const REGIONS = [["observable", "what could be seen so far"], ["visible", "free cells seen so far"],
  ["surface", "obstacles seen so far"], ["shell", "just behind what was seen"], ["hidden", "the rest"],
  ["all", "every cell whose truth is known"]];

/** What the regions of a world that moves are, in the order of MOVING. */
const OF_MOVEMENT = ["what nothing that moves has covered", "where something has been and is no more",
  "where something that moves stands now", "what looks have found changed"];

/** @param {number|null|undefined} value @param {number} digits @returns {string} */
const round = (value, digits = 4) => (value === null || value === undefined ? "–" : value.toFixed(digits));

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
  const rival = names.find(([name]) => name === "conventional") ?? names.find(([name]) => name !== element("viewer-mapper").value);
  fill(element("viewer-beside"), names, chosen.beside || (rival ?? names[0])[0]);
  element("viewer-beside").closest("label").hidden = names.length === 1;
  const named = world.regions.map((region) => [region.name, `${region.name}: a region of the scene`]);
  const scored = world.mappers.flatMap((mapper) => Object.keys(mapper.scores[0] ?? {}));
  const by_rays = REGIONS.map(([name, what]) => [name, `${name}: ${what}`]).filter(([name]) => !scored.length || scored.includes(name));
  const by_movement = world.moving ? MOVING.map((name, k) => [name, `${name}: ${OF_MOVEMENT[k]}`]) : [];
  fill(element("viewer-region"), [by_rays[0], ...named, ...by_rays.slice(1), ...by_movement], chosen.region);
  // Without a truth nothing is judged by it.
  for (const name of ["truth", "error"]) input(name).closest("label").hidden = world.truth === null;
  input("looks").closest("label").hidden = !world.scans?.truth;
  element("viewer-scan").closest("label").hidden = !world.scans;
  if (input(chosen.view).closest("label").hidden) input("occupancy").click();
  for (const id of ["viewer-region-choice", "viewer-judged"]) element(id).hidden = world.truth === null;
  offerMoments(world);
}

/** @param {string} view @returns {HTMLInputElement} */
const input = (view) => [...document.querySelectorAll("input[name=viewer-view]")].find((one) => one.value === view);

/** @param {World} world */
function offerMoments(world) {
  element("viewer-stages").replaceChildren(...world.stages.map((stage) => {
    const text = stage.label === stage.name ? stage.name : `${stage.name}: ${stage.label}`;
    const button = make("button", text, { type: "button", "data-moment": `${stage.moment}` });
    button.addEventListener("click", () => go(stage.moment));
    return button;
  }));
  const last = world.moments.length - 1;
  for (const one of document.querySelectorAll("#viewer .moments")) one.hidden = last === 0;
  element("viewer-stages").closest(".controls").hidden = last === 0 || world.stages.length === 0;
  element("viewer-time").max = `${last}`;
  element("viewer-ticks").replaceChildren(...world.stages.map((s) => make("option", "", { value: `${s.moment}`, label: s.name })));
  chosen.moment = Math.min(chosen.moment, last);
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
  const wanted = [["viewer-left", chosen.mapper], ["viewer-right", chosen.beside]].slice(0, world.mappers.length);
  // Lets the browser draw before the work.
  await new Promise((resolve) => setTimeout(resolve));
  const ground = groundOf(world);
  const panels = wanted.map(([id, name]) => {
    const mapper = world.mappers.find((m) => m.name === name);
    return { name, canvas: element(id), mapper, maps: mapsOf(world, mapper), frame: -1, p: () => world.prior };
  });
  if (choice !== choices) return;
  shown = { world, ground, panels, scan: null };
  show();
  section.setAttribute("aria-busy", "false");
}

// What is chosen, and the maps that it asks for.

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
  const rival = names.find(([name]) => name === "conventional") ?? names.at(-1);
  const other = names.length > 1 ? rival[0] : "truth";
  fill(element("viewer-beside"), [["truth", "the truth"], ...names, ["none", "nothing"]], chosen.beside || other);
  const named = world.regions.map((region) => [region.name, `${region.name}: a region of the scene`]);
  const by_rays = REGIONS.map(([name, what]) => [name, `${name}: ${what}`]);
  fill(element("viewer-region"), [by_rays[0], ...named, ...by_rays.slice(1)], chosen.region);
  element("viewer-stages").replaceChildren(...world.stages.map((stage) => {
    const text = stage.label === stage.name ? stage.name : `${stage.name}: ${stage.label}`;
    const button = make("button", text, { type: "button", "data-moment": `${stage.moment}` });
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

// Switches of several sensors, their part of the legend, and the strip of the one that is chosen.

/** Name of the sensor whose readings the strip shows. */
let stripOf = "";

/** Switches a sensor. @param {string} name @param {boolean} on */
function switchSensor(name, on) {
  if (on) switchedOff.delete(name);
  else switchedOff.add(name);
  show();
}

/** Puts the switches beside that of the scan, once. */
function addSwitches() {
  if (document.getElementById("viewer-sensors")) return;
  const group = make("fieldset", "", { id: "viewer-sensors" });
  group.append(make("legend", "Sensors"), make("div", "", { class: "views" }));
  element("viewer-scan").closest("label").before(group);
  const choice = make("label", "Readings of ", { id: "viewer-strip-choice" });
  choice.append(make("select", "", { id: "viewer-strip-sensor" }));
  group.after(choice);
  choice.querySelector("select").addEventListener("change", (event) => { stripOf = event.target.value; show(); });
  const keys = make("li");
  keys.append(make("kbd", "Shift"), " with ", make("kbd", "1"), " to ", make("kbd", "9"), " switches a sensor; ", make("kbd", "r"), " the readings of the next");
  document.querySelector("#viewer .keys ul").append(keys);
  document.addEventListener("keydown", sensorKeys, true);
}

/** @param {KeyboardEvent} event */
function sensorKeys(event) {
  if (!shown?.world.sensors || event.ctrlKey || event.metaKey || event.altKey || event.target.matches("select") || !onScreen()) return;
  const digit = event.shiftKey ? /^Digit([1-9])$/.exec(event.code)?.[1] : undefined;
  const box = digit && element("viewer-sensors").querySelectorAll("input")[Number(digit) - 1];
  const select = element("viewer-strip-sensor");
  if (box) box.click();
  else if (event.key === "r") {
    select.selectedIndex = (select.selectedIndex + 1) % select.options.length;
    stripOf = select.value;
    show();
  } else return;
  // With some keyboards a digit with Shift is a digit, which has another meaning.
  event.stopImmediatePropagation();
  event.preventDefault();
}

const offerOfOne = offer;

offer = function () {
  offerOfOne();
  addSwitches();
  const world = DATA.worlds[chosen.world];
  const sensors = world.sensors ? sensorsOf(world) : [];
  for (const id of ["viewer-sensors", "viewer-strip-choice"]) element(id).hidden = !sensors.length;
  if (!sensors.length) return;
  element("viewer-sensors").querySelector("div").replaceChildren(...sensors.map(({ name, ink }) => {
    const box = make("input", "", { type: "checkbox", value: name });
    box.checked = !switchedOff.has(name);
    box.addEventListener("change", () => switchSensor(name, box.checked));
    const label = make("label");
    label.append(box, make("i", "", { "aria-hidden": "true", style: swatch(ink) }), name);
    return label;
  }));
  fill(element("viewer-strip-sensor"), sensors.map(({ name }) => [name, name]), stripOf);
  stripOf = element("viewer-strip-sensor").value;
};

/** A dot of a colour before a name. @param {Colour} ink */
const swatch = (ink) => `display: inline-block; width: .7rem; height: .7rem; margin-right: .4rem; border: 1.5px solid #fff; border-radius: 50%; background: ${css(ink)}; forced-color-adjust: none`;

const legendOfOne = showLegend;

showLegend = function (scene) {
  if (!scene.world.sensors) return legendOfOne(scene);
  const [drawn, legend] = [chosen.scan, element("viewer-legend")];
  chosen.scan = false;
  legendOfOne(scene);
  chosen.scan = drawn;
  if (!drawn) return;
  const lines = sensorsOf(scene.world).filter(({ name }) => !switchedOff.has(name)).map(({ name, width, ink }) =>
    entry(width > 0 ? `${name}: cones, and the arc of the reading` : `${name}: rays, dashed field of view, and readings`, "line", `--ink: ${css(ink)}`));
  legend.lastElementChild.before(...lines);
};

const stripOfOne = showStrip;

/** The strip shows the readings of the sensor that is chosen: the drawing of one sensor is given its scan and its unit. */
showStrip = function () {
  const { world, ground } = shown;
  if (!world.sensors) return stripOfOne();
  const sensor = sensorsOf(world).find(({ name }) => name === stripOf);
  const now = sensor?.at.get(world.moments[chosen.moment]) ?? null;
  const figure = element("viewer-strip").closest("figure");
  if (!now || !now.bearings.length) {
    figure.hidden = false;
    element("viewer-strip").replaceChildren();
    element("viewer-strip-title").textContent = `${stripOf}: no reading at this moment`;
    element("viewer-strip-line").textContent = now?.ranges ? "without noise" : "";
    element("viewer-strip-said").textContent = "";
    return;
  }
  const kept = shown;
  const alone = once(sensor.at, () => ({ ...world, scans: sensor, ground: { ...ground, scans: [...sensor.at.values()] } }));
  shown = { ...kept, world: alone, scan: now, ground: alone.ground };
  stripOfOne();
  shown = kept;
  element("viewer-strip-title").textContent = element("viewer-strip-title").textContent.replace("of the scan", `of ${sensor.name}`);
};

const rememberOfOne = remember;

/** Writes into the address too which sensors are off, and whose readings are shown. */
remember = function () {
  rememberOfOne();
  if (!shown?.world.sensors) return;
  const at = new URLSearchParams(location.hash.slice(1));
  if (switchedOff.size) at.set("off", [...switchedOff].join(","));
  if (stripOf) at.set("readings", stripOf);
  try {
    history.replaceState(null, "", `#${at}`);
  } catch { /* an address that may not change is no loss */ }
};

const recallOfOne = recall;

recall = function () {
  recallOfOne();
  const at = new URLSearchParams(location.hash.slice(1));
  switchedOff.clear();
  (at.get("off") ?? "").split(",").filter(Boolean).forEach((name) => switchedOff.add(name));
  stripOf = at.get("readings") ?? stripOf;
};

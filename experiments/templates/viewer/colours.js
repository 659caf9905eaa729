// Colours of cells and lines. The same in light and dark: a map is a picture of the world, not of the page.

/** @typedef {[number, number, number]} Colour red, green, blue, 0 to 255 */

/** After Okabe and Ito (2008): told apart by colour-blind readers. No line has a colour of the error view. @type {Object<string, Colour>} */
const INK = {
  unknown: [214, 222, 230],
  phantom: [213, 94, 0],
  missed: [0, 90, 178],
  right: [247, 247, 247],
  outside: [70, 80, 96],
  region: [170, 30, 140],
  route: [0, 130, 90],
  thing: [120, 60, 200],
  reading: [240, 215, 40],
  cursor: [255, 214, 0],
};

/** @param {Colour} a @param {Colour} b @param {number} share of b, 0 to 1 @returns {Colour} */
const mix = (a, b, share) => [0, 1, 2].map((i) => Math.round(a[i] + (b[i] - a[i]) * share));

/**
 * White for free, black for occupied, light grey for the prior; linear in log odds between
 * (experiments/src/figures/ink.rs).
 * @param {number} odds log odds, nats @param {number} from log odds of the prior @returns {Colour}
 */
function occupancyColour(odds, from) {
  const certain = 4.6, atPrior = 200;
  const level = odds <= from
    ? atPrior + Math.min((from - odds) / Math.max(certain + from, 1), 1) * (255 - atPrior)
    : atPrior * (1 - Math.min((odds - from) / (certain - from), 1));
  return [level, level, level].map(Math.round);
}

/** @param {number} truth @returns {Colour} */
const truthColour = (truth) => (truth === UNKNOWN ? INK.unknown : truth === OCCUPIED ? [0, 0, 0] : [255, 255, 255]);

/** The map's grey, with what is truly occupied in blue. @param {Colour} grey @param {number} truth @returns {Colour} */
function overlayColour(grey, truth) {
  if (truth === UNKNOWN) return INK.unknown;
  return truth === OCCUPIED ? mix(grey, [30, 120, 255], 0.62) : grey;
}

/** @param {number} error p minus truth, -1 to 1 @returns {Colour} */
const errorColour = (error) => mix(INK.right, error > 0 ? INK.phantom : INK.missed, Math.abs(error));

/** Stops of a scale that grows darker all the way (after viridis). @type {Colour[]} */
const SEQUENCE = [[245, 245, 225], [187, 222, 130], [82, 185, 120], [33, 140, 141], [50, 95, 140], [62, 40, 105]];

/** @param {number} looks @param {number} most @returns {Colour} */
function looksColour(looks, most) {
  if (looks === 0) return INK.unknown;
  const at = (Math.log1p(looks) / Math.log1p(Math.max(most, 1))) * (SEQUENCE.length - 1);
  const low = Math.min(Math.floor(at), SEQUENCE.length - 2);
  return mix(SEQUENCE[low], SEQUENCE[low + 1], Math.min(at - low, 1));
}

/** @param {Colour} colour @param {number} opacity @returns {string} */
const css = (colour, opacity = 1) => `rgb(${colour.join(" ")} / ${opacity})`;

/**
 * What the colours of cells in a view mean: scales with labels, then patches.
 * @param {string} view @param {number} from log odds of the prior @param {number} most looks @param {boolean} truth whether it is known
 * @returns {{scales: {stops: string[], labels: string[]}[], patches: [string, string][]}}
 */
function legendOf(view, from, most, truth) {
  const steps = [...Array(33).keys()].map((k) => k / 32);
  const grey = (odds) => occupancyColour(odds, from);
  const occupancy = { stops: steps.map((s) => css(grey(9.2 * s - 4.6))), labels: ["p 0.01: free", "0.5", "0.99: occupied"] };
  const unseen = [truth ? "never seen, or truth not known" : "never seen", css(INK.unknown)];
  const ends = [["truly free", "rgb(255 255 255)"], ["truly occupied", "rgb(0 0 0)"]];
  if (view === "error") {
    return { scales: [{ stops: steps.map((s) => css(errorColour(2 * s - 1))), labels: ["−1: missed", "0: right", "+1: phantom"] }],
      patches: [...ends, ["truth not known", css(INK.unknown)]] };
  }
  if (view === "looks") {
    return { scales: [occupancy, { stops: steps.slice(1).map((s) => css(looksColour(Math.expm1(s * Math.log1p(most)), most))),
      labels: ["1 ray", `${Math.round(Math.sqrt(most))}`, `${most} rays`] }], patches: [unseen] };
  }
  if (view === "truth") {
    return { scales: [], patches: [["free, held free", css(grey(-9))], ["free, held occupied: phantom", css(grey(9))],
      ["occupied, held occupied", css(overlayColour(grey(9), OCCUPIED))],
      ["occupied, held free: missed", css(overlayColour(grey(-9), OCCUPIED))], ["truly occupied", "rgb(0 0 0)"], unseen] };
  }
  return { scales: [occupancy], patches: [unseen] };
}

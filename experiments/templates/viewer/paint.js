// Draws one map: cells pixel by pixel, then regions, route, robot and cursor as lines.

/**
 * @typedef {{column: number, row: number, columns: number, rows: number}} Box cells that are drawn, from the lower left one
 * @typedef {{world: World, ground: Ground, moment: number, view: string, step: number, most: number,
 *   inside: (cell: number) => boolean, cursor: number|null, box: Box}} Scene
 */

/** @param {number} p @returns {number} */
const logOdds = (p) => Math.log(p / (1 - p));

/**
 * Colour of a cell in the given view; a panel without codes shows the truth.
 * @param {Scene} scene @param {Int16Array|null} codes @returns {(cell: number) => Colour}
 */
function colouring(scene, codes) {
  const { ground, view, step } = scene;
  const from = logOdds(Math.min(Math.max(scene.world.prior, 1e-3), 1 - 1e-3));
  const looks = ground.looks[scene.moment];
  if (view === "looks") return (cell) => looksColour(looks[cell], scene.most);
  if (!codes) return (cell) => truthColour(ground.truth[cell]);
  // Nobody knows anything of a cell that no ray has reached, whatever the mapper expects of it.
  const grey = (cell) => (looks[cell] === 0 ? INK.unknown : occupancyColour(codes[cell] * step, from));
  if (view === "truth") return (cell) => overlayColour(grey(cell), ground.truth[cell]);
  if (view !== "error") return grey;
  return (cell) => ground.truth[cell] === UNKNOWN
    ? INK.unknown
    : errorColour(probability(codes[cell], step) - ground.truth[cell]);
}

/** One pixel per cell, row 0 at the bottom. @param {Scene} scene @param {Int16Array|null} codes */
function cellImage(scene, codes) {
  const { width, height } = scene.world;
  const image = new ImageData(width, height);
  const colour = colouring(scene, codes);
  for (let cell = 0; cell < width * height; cell++) {
    const row = height - 1 - Math.floor(cell / width);
    const shown = scene.inside(cell) ? colour(cell) : mix(colour(cell), INK.outside, 0.6);
    image.data.set(shown, 4 * (row * width + (cell % width)));
    image.data[4 * (row * width + (cell % width)) + 3] = 255;
  }
  return image;
}

/** Fits the canvas to its width on the page, one backing pixel per device pixel. @param {HTMLCanvasElement} canvas */
function fit(canvas, box) {
  const width = Math.max(Math.round(canvas.clientWidth * (window.devicePixelRatio || 1)), 1);
  const height = Math.max(Math.round((width * box.rows) / box.columns), 1);
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
}

/** @param {HTMLCanvasElement} canvas @param {Scene} scene @param {Int16Array|null} codes */
function paint(canvas, scene, codes) {
  const { world, box } = scene;
  fit(canvas, box);
  const cells = new OffscreenCanvas(world.width, world.height);
  cells.getContext("2d").putImageData(cellImage(scene, codes), 0, 0);
  const pen = canvas.getContext("2d");
  pen.imageSmoothingEnabled = false;
  const top = world.height - box.row - box.rows;
  pen.drawImage(cells, box.column, top, box.columns, box.rows, 0, 0, canvas.width, canvas.height);
  const scale = canvas.width / box.columns;
  const at = (x_m, y_m) => [((x_m - world.origin_m[0]) / world.cell_m) * scale,
    canvas.height - ((y_m - world.origin_m[1]) / world.cell_m) * scale];
  pen.save();
  pen.translate(-box.column * scale, box.row * scale);
  for (const mask of scene.ground.regions.values()) outline(pen, world, mask, scale, canvas.height);
  route(pen, scene, at);
  robot(pen, scene, at, scale);
  if (scene.cursor !== null) cursor(pen, world, scene.cursor, scale, canvas.height);
  pen.restore();
}

/** Lines between the cells of a region and the others. */
function outline(pen, world, mask, scale, bottom) {
  const { width, height } = world;
  const has = (column, row) => column >= 0 && row >= 0 && column < width && row < height && mask[row * width + column] === 1;
  pen.beginPath();
  for (let row = 0; row <= height; row++) {
    for (let column = 0; column <= width; column++) {
      const [x, y] = [column * scale, bottom - row * scale];
      if (has(column, row) !== has(column, row - 1)) { pen.moveTo(x, y); pen.lineTo(x + scale, y); }
      if (has(column, row) !== has(column - 1, row)) { pen.moveTo(x, y); pen.lineTo(x, y - scale); }
    }
  }
  Object.assign(pen, { strokeStyle: css(INK.region), lineWidth: Math.max(scale / 3, 1.5) });
  pen.stroke();
}

/** The way so far. */
function route(pen, scene, at) {
  const way = scene.world.route.slice(0, scene.world.moments[scene.moment].scans);
  pen.beginPath();
  way.forEach(([x, y], i) => (i ? pen.lineTo(...at(x, y)) : pen.moveTo(...at(x, y))));
  for (const [colour, width] of [["rgb(255 255 255 / 50%)", 3], ["rgb(0 114 178 / 65%)", 1.5]]) {
    Object.assign(pen, { strokeStyle: colour, lineWidth: width });
    pen.stroke();
  }
}

/** A disc with a line where the camera looks. */
function robot(pen, scene, at, scale) {
  const { world } = scene;
  const [x_m, y_m, theta] = world.moments[scene.moment].pose;
  const [x, y] = at(x_m, y_m);
  const radius = Math.max((world.radius_m / world.cell_m) * scale, 4);
  Object.assign(pen, { fillStyle: css(INK.route), strokeStyle: "white", lineWidth: 1.5 });
  pen.beginPath();
  pen.arc(x, y, radius, 0, 2 * Math.PI);
  pen.fill();
  pen.stroke();
  pen.beginPath();
  pen.moveTo(x, y);
  pen.lineTo(x + 2.2 * radius * Math.cos(theta), y - 2.2 * radius * Math.sin(theta));
  Object.assign(pen, { strokeStyle: css(INK.route), lineWidth: Math.max(radius / 3, 2) });
  pen.stroke();
}

/** A frame around the cell, seen on any colour. */
function cursor(pen, world, cell, scale, bottom) {
  const size = Math.max(scale, 7);
  const x = ((cell % world.width) + 0.5) * scale, y = bottom - (Math.floor(cell / world.width) + 0.5) * scale;
  for (const [colour, width] of [["black", 4], ["rgb(255 214 0)", 2]]) {
    Object.assign(pen, { strokeStyle: colour, lineWidth: width });
    pen.strokeRect(x - size / 2 - 2, y - size / 2 - 2, size + 4, size + 4);
  }
}

// Draws one map: cells pixel by pixel, then what is outside the region, regions, scan, route, robot and cursor.

/**
 * @typedef {{x: number, y: number, columns: number, rows: number}} Box part of the map that is drawn, in cells from the lower left corner
 * @typedef {{world: World, ground: Ground, moment: number, scan: Scan|null, drawScan: boolean, drawRays: boolean, looks: {looks: Int32Array, most: number}|null,
 *   inside: (cell: number) => boolean, cursor: number|null, box: Box}} Scene
 * @typedef {(cell: number) => Colour} Colouring
 */

/** One pixel per cell, row 0 at the bottom. @param {World} world @param {(cell: number) => number[]} pixel red, green, blue, opacity */
function cellImage({ width, height }, pixel) {
  const image = new ImageData(width, height);
  for (let cell = 0; cell < width * height; cell++) {
    const row = height - 1 - Math.floor(cell / width);
    image.data.set(pixel(cell), 4 * (row * width + (cell % width)));
  }
  const cells = new OffscreenCanvas(width, height);
  cells.getContext("2d").putImageData(image, 0, 0);
  return cells;
}

/** Gives the canvas one pixel per pixel of the screen. @param {HTMLCanvasElement} canvas @param {World} world */
function fit(canvas, world) {
  const width = Math.max(Math.round(canvas.clientWidth * (window.devicePixelRatio || 1)), 1);
  const height = Math.max(Math.round((width * world.height) / world.width), 1);
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
}

/** @param {HTMLCanvasElement} canvas @param {Scene} scene @param {Colouring} colour */
function paint(canvas, scene, colour) {
  const { world, box } = scene;
  fit(canvas, world);
  const pen = canvas.getContext("2d");
  const scale = canvas.width / box.columns;
  const draw = (cells, on) => {
    on.imageSmoothingEnabled = false;
    on.drawImage(cells, box.x, world.height - box.y - box.rows, box.columns, box.rows, 0, 0, canvas.width, canvas.height);
  };
  draw(cellImage(world, (cell) => [...colour(cell), 255]), pen);
  const veil = new OffscreenCanvas(canvas.width, canvas.height), hatching = veil.getContext("2d");
  draw(cellImage(world, (cell) => [0, 0, 0, scene.inside(cell) ? 0 : 255]), hatching);
  hatch(hatching, veil);
  pen.drawImage(veil, 0, 0);
  const view = {
    scale,
    corner: (column, row) => [(column - box.x) * scale, canvas.height - (row - box.y) * scale],
    at: (x_m, y_m) => view.corner((x_m - world.origin_m[0]) / world.cell_m, (y_m - world.origin_m[1]) / world.cell_m),
  };
  for (const mask of scene.ground.regions.values()) outline(pen, world, mask, view);
  if (scene.drawScan && scene.scan) drawScan(pen, scene, view);
  things(pen, scene, view);
  route(pen, scene, view);
  if (scene.scan) robot(pen, scene, view);
  if (scene.cursor !== null) cursor(pen, world, scene.cursor, view);
  scaleBar(pen, canvas, world, view);
}

/** Leaves lines of what is drawn: what is outside the region can still be read between them. */
function hatch(pen, { width, height }) {
  const gap = 7 * (window.devicePixelRatio || 1);
  pen.globalCompositeOperation = "source-in";
  const lines = new OffscreenCanvas(width, height), line = lines.getContext("2d");
  line.beginPath();
  for (let x = -height; x < width; x += gap) {
    line.moveTo(x, height);
    line.lineTo(x + height, 0);
  }
  Object.assign(line, { strokeStyle: css(INK.outside, 0.55), lineWidth: gap / 7 });
  line.stroke();
  pen.drawImage(lines, 0, 0);
}

/** Lines between the cells of a region and the others. */
function outline(pen, world, mask, { scale, corner }) {
  const { width, height } = world;
  const has = (column, row) => column >= 0 && row >= 0 && column < width && row < height && mask[row * width + column] === 1;
  pen.beginPath();
  for (let row = 0; row <= height; row++) {
    for (let column = 0; column <= width; column++) {
      const here = has(column, row);
      if (here !== has(column, row - 1)) { pen.moveTo(...corner(column, row)); pen.lineTo(...corner(column + 1, row)); }
      if (here !== has(column - 1, row)) { pen.moveTo(...corner(column, row)); pen.lineTo(...corner(column, row + 1)); }
    }
  }
  stroke(pen, [[css([255, 255, 255], 0.8), Math.max(scale / 2, 3.5)], [css(INK.region), Math.max(scale / 4, 1.8)]]);
}

/** @param {[string, number][]} strokes colour and width, the lowest first */
function stroke(pen, strokes) {
  for (const [strokeStyle, lineWidth] of strokes) {
    Object.assign(pen, { strokeStyle, lineWidth });
    pen.stroke();
  }
}

/** The field of view, the rays as far as they truly went or were measured (on the first panel alone: they would hide a map),
 * and where the readings lie. */
function drawScan(pen, { world, scan, drawRays }, { at }) {
  const [x, y, theta] = scan.pose;
  const end = (bearing, range) => at(x + range * Math.cos(theta + bearing), y + range * Math.sin(theta + bearing));
  const measured = scan.readings.map((reading, k) => rangeOf(world, reading, scan.bearings[k]));
  const border = world.cell_m * Math.hypot(world.width, world.height);
  const far = scan.ranges?.map((range) => range ?? border) ?? measured;
  const ray = (k, range) => { pen.moveTo(...at(x, y)); pen.lineTo(...end(scan.bearings[k], range)); };
  if (drawRays) {
    pen.beginPath();
    far.forEach((range, k) => range !== null && ray(k, range));
    stroke(pen, [[css(INK.route, 0.13), 1]]);
  }
  const reach = Math.max(...far.filter((range) => range !== null && range < border), 1);
  pen.beginPath();
  const [first, last] = [0, scan.bearings.length - 1];
  ray(first, reach);
  scan.bearings.forEach((bearing) => pen.lineTo(...end(bearing, reach)));
  ray(last, reach);
  pen.setLineDash([6, 4]);
  stroke(pen, [[css(INK.route, 0.9), 1.2]]);
  pen.setLineDash([]);
  const size = 1.6 * (window.devicePixelRatio || 1);
  measured.forEach((range, k) => {
    if (range === null || range > border) return;
    pen.beginPath();
    pen.arc(...end(scan.bearings[k], range), size, 0, 2 * Math.PI);
    Object.assign(pen, { fillStyle: css(INK.reading), strokeStyle: "rgb(40 40 40)", lineWidth: size / 2 });
    pen.stroke();
    pen.fill();
  });
}

/** Outlines of what moves: a disc has three numbers, anything else its corners, m. */
function things(pen, { ground, moment }, { at, scale }) {
  for (const [x, y, ...rest] of ground.things[moment] ?? []) {
    pen.beginPath();
    const [column, row] = at(x, y);
    if (rest.length === 1) {
      const [right] = at(x + rest[0], y);
      pen.arc(column, row, right - column, 0, 2 * Math.PI);
    } else {
      pen.moveTo(column, row);
      for (let k = 0; k < rest.length; k += 2) pen.lineTo(...at(rest[k], rest[k + 1]));
      pen.closePath();
    }
    stroke(pen, [[css([255, 255, 255], 0.8), Math.max(scale / 2, 4)], [css(INK.thing), Math.max(scale / 4, 2)]]);
  }
}

/** The way so far. */
function route(pen, { world, ground, moment }, { at }) {
  const scans = world.moments[moment];
  const way = world.route.length ? world.route : ground.scans.slice(0, scans).map((scan) => scan.pose);
  pen.beginPath();
  way.forEach(([x, y], i) => (i ? pen.lineTo(...at(x, y)) : pen.moveTo(...at(x, y))));
  stroke(pen, [[css([255, 255, 255], 0.7), 3.5], [css(INK.route), 1.7]]);
}

/** A disc with a line where the sensor looks. */
function robot(pen, { world, scan }, { at, scale }) {
  const [x_m, y_m, theta] = scan.pose;
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
  stroke(pen, [[css(INK.route), Math.max(radius / 3, 2)]]);
}

/** A frame around the cell, seen on any colour. */
function cursor(pen, world, cell, { scale, corner }) {
  const size = Math.max(scale, 7) + 4;
  const [x, y] = corner((cell % world.width) + 0.5, Math.floor(cell / world.width) + 0.5);
  pen.beginPath();
  pen.rect(x - size / 2, y - size / 2, size, size);
  stroke(pen, [["black", 4], [css(INK.cursor), 2]]);
}

/** A length of 1, 2 or 5 times a power of ten, at most a third of the width, m. @param {number} width of what is drawn, m */
function roundLength(width) {
  const most = width / 3;
  const power = 10 ** Math.floor(Math.log10(most));
  return [5, 2, 1].find((digit) => digit * power <= most) * power;
}

/** A bar of a round length in the corner. */
function scaleBar(pen, canvas, world, { scale }) {
  const density = window.devicePixelRatio || 1;
  const length_m = roundLength((canvas.width / scale) * world.cell_m);
  const [length, gap, thick] = [(length_m / world.cell_m) * scale, 8 * density, 4 * density];
  const text = `${Number(length_m.toPrecision(1))} m`;
  pen.font = `${12 * density}px system-ui, sans-serif`;
  pen.fillStyle = "rgb(255 255 255 / 85%)";
  pen.fillRect(gap / 2, canvas.height - gap - 20 * density, Math.max(length, pen.measureText(text).width) + gap, 20 * density + gap / 2);
  pen.fillStyle = "rgb(20 20 20)";
  pen.fillRect(gap, canvas.height - gap - thick / 2, length, thick / 2);
  for (const x of [gap, gap + length - density]) pen.fillRect(x, canvas.height - gap - thick, density, thick);
  pen.fillText(text, gap, canvas.height - gap - thick - 2 * density);
}

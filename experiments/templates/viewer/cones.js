// Draws what several sensors read: rays, and cones as wedges.

const drawScanOfOne = drawScan;

drawScan = function (pen, scene, view) {
  if (!scene.world.sensors) return drawScanOfOne(pen, scene, view);
  const all = sensorsNow();
  // The widest first, so that thin rays stay on top.
  all.sort((a, b) => b.sensor.width - a.sensor.width);
  for (const { sensor, scan } of all) {
    if (sensor.width > 0) drawCones(pen, scene, view, sensor, scan);
    else drawFan(pen, scene, view, sensor, scan);
  }
};

/** Where a ray ends, on the screen. */
const endFrom = ([x, y, theta], { at }) => (bearing, range) => at(x + range * Math.cos(theta + bearing), y + range * Math.sin(theta + bearing));

/** As far as every ray or cone truly went, or was measured, m; null where neither is known. */
function farOf(world, scan, measured) {
  const border = world.cell_m * Math.hypot(world.width, world.height);
  return { border, far: scan.ranges?.map((range) => range ?? border) ?? measured };
}

/** The field of view; on the first panel the rays; and where the readings lie. */
function drawFan(pen, { world, drawRays }, view, sensor, scan) {
  if (!scan.bearings.length) return;
  const end = endFrom(scan.pose, view);
  const start = view.at(...scan.pose);
  const measured = scan.readings.map((reading, k) => rangeOf({ scans: sensor }, reading, scan.bearings[k]));
  const { border, far } = farOf(world, scan, measured);
  if (drawRays) {
    pen.beginPath();
    far.forEach((range, k) => {
      if (range === null) return;
      pen.moveTo(...start);
      pen.lineTo(...end(scan.bearings[k], range));
    });
    stroke(pen, [[css(sensor.ink, 0.16), 1]]);
  }
  // A ray that went astray makes the field of view no larger.
  const known = far.filter((range) => range !== null && range < border).sort((a, b) => a - b);
  const reach = Math.max(known[Math.floor(0.95 * (known.length - 1))] ?? 1, 1);
  const [first, last] = [scan.bearings[0], scan.bearings.at(-1)];
  const allRound = Math.abs(last - first) > 1.9 * Math.PI;
  pen.beginPath();
  if (!allRound) pen.moveTo(...start);
  scan.bearings.forEach((bearing, k) => (allRound && k === 0 ? pen.moveTo(...end(bearing, reach)) : pen.lineTo(...end(bearing, reach))));
  pen.closePath();
  pen.setLineDash([6, 4]);
  stroke(pen, [[css(sensor.ink, 0.9), 1.2]]);
  pen.setLineDash([]);
  const size = 1.6 * (window.devicePixelRatio || 1);
  measured.forEach((range, k) => {
    if (range === null || range > border) return;
    pen.beginPath();
    pen.arc(...end(scan.bearings[k], range), size, 0, 2 * Math.PI);
    Object.assign(pen, { fillStyle: css(mix(sensor.ink, [255, 255, 255], 0.45)), strokeStyle: css(mix(sensor.ink, [0, 0, 0], 0.5)), lineWidth: size / 2 });
    pen.stroke();
    pen.fill();
  });
}

/** Every cone as a wedge: on the first panel filled as far as it truly reached; and an arc where its reading lies, somewhere along it. */
function drawCones(pen, { world, drawRays }, view, sensor, scan) {
  const end = endFrom(scan.pose, view);
  const start = view.at(...scan.pose);
  const measured = scan.readings.map((reading, k) => rangeOf({ scans: sensor }, reading, scan.bearings[k]));
  const { border, far } = farOf(world, scan, measured);
  const steps = [...Array(9).keys()].map((k) => sensor.width * (k / 8 - 0.5));
  const arc = (axis, range) => steps.map((offset) => end(axis + offset, range));
  const along = (points, begin) => points.forEach((point, k) => (k || begin ? pen.lineTo(...point) : pen.moveTo(...point)));
  scan.bearings.forEach((axis, k) => {
    const reach = Math.min(far[k] ?? Infinity, sensor.most ?? Infinity);
    if (reach < border) {
      pen.beginPath();
      pen.moveTo(...start);
      along(arc(axis, reach), true);
      pen.closePath();
      if (drawRays) {
        pen.fillStyle = css(sensor.ink, 0.1);
        pen.fill();
      }
      stroke(pen, [[css(sensor.ink, drawRays ? 0.5 : 0.25), 1]]);
    }
    if (measured[k] !== null && measured[k] <= border) {
      pen.beginPath();
      along(arc(axis, measured[k]), false);
      stroke(pen, [[css([255, 255, 255], 0.8), 4.5], [css(sensor.ink), 2.5]]);
    }
  });
}

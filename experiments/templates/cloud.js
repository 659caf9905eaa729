// Follows the particles of a filter along the way of a robot. Stands alone: a page has this or the viewer of maps.
(() => {
  const at = (id) => document.getElementById(`cloud-${id}`);
  const data = JSON.parse(at("data").textContent);
  const [[west, south], [east, north]] = data.corners;
  const { moments } = data;
  const COLOURS = { slam: "rgb(0 114 178)", odometry: "rgb(120 125 130)", truth: "rgb(190 95 150)" };
  const PARTICLE = "rgb(213 94 0)", ELLIPSE = "rgb(0 130 90)";
  let now = moments.length - 1;
  let timer = 0;

  /** A way up to a share of its length. @param {[number, number][]} points @param {number} share 0 to 1 */
  const until = (points, share) => points.slice(0, Math.max(1, Math.round(share * points.length)));

  /**
   * Draws map, ways and particles. @param {HTMLCanvasElement} canvas @param {[number, number, number, number]} view x, y, width, height, m
   * @param {boolean} near whether particles are large enough to have a direction
   */
  function paint(canvas, [x0, y0, width, height], near) {
    const ratio = window.devicePixelRatio || 1;
    const scale = (canvas.clientWidth * ratio) / width;
    canvas.width = Math.round(width * scale);
    canvas.height = Math.round(height * scale);
    const pen = canvas.getContext("2d");
    const x = (metres) => (metres - x0) * scale, y = (metres) => canvas.height - (metres - y0) * scale;
    pen.imageSmoothingEnabled = false;
    pen.fillStyle = "rgb(200 200 200)";
    pen.fillRect(0, 0, canvas.width, canvas.height);
    pen.drawImage(picture, x(west), y(north), (east - west) * scale, (north - south) * scale);
    const share = moments.length > 1 ? now / (moments.length - 1) : 1;
    for (const { name, points } of data.ways) {
      pen.beginPath();
      until(points, near ? 1 : share).forEach((point, k) => (k ? pen.lineTo(x(point[0]), y(point[1])) : pen.moveTo(x(point[0]), y(point[1]))));
      pen.strokeStyle = COLOURS[name];
      pen.lineWidth = (name === "slam" ? 2 : 1.5) * ratio;
      pen.stroke();
    }
    const { particles, ellipse: [cx, cy, long, short, angle] } = moments[now];
    for (let k = 0; k < particles.length; k += 4) {
      const [px, py, turned, weight] = [particles[k] / 1000, particles[k + 1] / 1000, particles[k + 2] / 1000, particles[k + 3] / 1000];
      pen.globalAlpha = 0.35 + 0.65 * weight;
      pen.fillStyle = pen.strokeStyle = PARTICLE;
      pen.beginPath();
      pen.arc(x(px), y(py), (near ? 3.5 : 4) * ratio, 0, 7);
      pen.fill();
      if (near) {
        const length = 0.06 * width;
        pen.beginPath();
        pen.moveTo(x(px), y(py));
        pen.lineTo(x(px + length * Math.cos(turned)), y(py + length * Math.sin(turned)));
        pen.lineWidth = 1.2 * ratio;
        pen.stroke();
      }
    }
    pen.globalAlpha = 1;
    if (near && long > 0) {
      pen.beginPath();
      pen.ellipse(x(cx / 1000), y(cy / 1000), (long / 1000) * scale, (Math.max(short, 0) / 1000) * scale, -angle / 1000, 0, 7);
      pen.strokeStyle = ELLIPSE;
      pen.lineWidth = 2 * ratio;
      pen.stroke();
    }
  }

  const number = (value, digits) => value.toFixed(digits).replace("-", "−");

  function show() {
    const moment = moments[now];
    const [cx, cy, long, short] = moment.ellipse.map((value) => value / 1000);
    at("time").value = now;
    const count = moment.particles.length / 4;
    at("moment").textContent = `${number(moment.t, 1)} s`;
    const facts = [`${count} ${count === 1 ? "particle" : "particles"}, N_eff ${number(moment.effective, 1)}`,
      `95 % within ${number(long, 3)} m by ${number(short, 3)} m`, `at (${number(cx, 2)}, ${number(cy, 2)}) m`];
    if (moment.resampled) facts.push("drawn anew");
    if (moment.returned) facts.push("back where it had been");
    at("said").textContent = facts.join("; ");
    at("time").setAttribute("aria-valuetext", `${at("moment").textContent}: ${at("said").textContent}`);
    paint(at("whole"), [west, south, east - west, north - south], false);
    const side = Math.max(1, 6 * long);
    const high = (side * (north - south)) / (east - west);
    paint(at("near"), [cx - side / 2, cy - high / 2, side, high], true);
    const size = side >= 10 ? number(side, 0) : number(side, 1);
    at("near").parentElement.lastElementChild.textContent = `Round the particles: ${size} m across`;
  }

  /** @param {number} moment */
  function go(moment) {
    now = Math.min(Math.max(moment, 0), moments.length - 1);
    show();
  }

  function play(on) {
    clearInterval(timer);
    timer = 0;
    if (on) {
      if (now === moments.length - 1) now = 0;
      timer = setInterval(() => (now < moments.length - 1 ? go(now + 1) : play(false)), 60);
    }
    at("play").setAttribute("aria-pressed", `${on}`);
    at("play").textContent = on ? "❚❚ Pause" : "▶ Play";
  }

  const picture = new Image();
  picture.onload = () => {
    document.getElementById("cloud").hidden = false;
    at("time").max = `${moments.length - 1}`;
    at("time").oninput = () => go(Number(at("time").value));
    at("back").onclick = () => go(now - 1);
    at("on").onclick = () => go(now + 1);
    at("play").onclick = () => play(!timer);
    moments.forEach((moment, k) => {
      if (!moment.returned) return;
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = `${number(moment.t, 0)} s`;
      button.onclick = () => go(k);
      at("returns").append(button);
    });
    at("returns").closest(".controls").hidden = !at("returns").childElementCount;
    for (const { name } of data.ways) {
      const label = document.createElement("b");
      label.textContent = name;
      label.style.setProperty("--line", COLOURS[name]);
      at("legend").append(label, " ");
    }
    window.addEventListener("resize", show);
    show();
  };
  picture.src = data.map;
})();

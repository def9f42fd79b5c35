// Motion player: the student's rotating box next to the exact one. Play, scrub, turn the view by dragging or with the arrow keys.

import { angleBetween, attitude, column, product, rotationToZ, scaled, times, transposed } from "./rotation.js";

const CORNERS = [[1, 1], [1, -1], [-1, -1], [-1, 1]];
const COLOURS = ["face1", "face2", "face3", "edge", "axis", "trail", "momentum", "words", "rule"];
const LIGHT = [0.35, 0.55, 0.76]; // right, up, towards the viewer
const SIZE = 0.78, TIP = 1.15; // lengths of the box's half diagonal and of an arrow, relative to this.reach
const SHORTEST = 8, LONGEST = 20; // playing time in seconds
const reducedMotion = matchMedia("(prefers-reduced-motion: reduce)");
const dark = matchMedia("(prefers-color-scheme: dark)");

/** Start a player on a canvas whose data-motion is the URL of a motion. The canvas stays hidden if the request fails. */
export async function play(canvas) {
  const answer = await fetch(canvas.dataset.motion).catch(() => null);
  if (answer?.ok && canvas.isConnected) new Player(canvas, await answer.json());
}

const make = (name, properties) => Object.assign(document.createElement(name), properties);

class Player {
  constructor(canvas, motion) {
    Object.assign(this, { canvas, motion, fresh: true, yaw: -0.6, pitch: 0.35, playing: false, pen: canvas.getContext("2d") });
    this.end = motion.t.at(-1);
    this.at = this.farthest();
    this.rate = this.end / Math.min(Math.max(this.end / 1000, SHORTEST), LONGEST); // ms of motion per second of playing time
    this.upright = rotationToZ(motion.L); // draw L vertically
    this.half = scaled(motion.half, SIZE / Math.hypot(...motion.half));
    this.addControls(canvas.closest("figure"));
    this.listen();
    new ResizeObserver(() => this.resize()).observe(canvas);
    dark.addEventListener("change", () => this.updateColours());
    this.updateColours();
    const seen = new IntersectionObserver(entries => {
      if (!entries.some(entry => entry.isIntersecting)) return;
      seen.disconnect();
      if (!reducedMotion.matches) this.toggle(true); // play once
    }, { threshold: 0.6 });
    seen.observe(canvas);
  }

  addControls(figure) {
    const bar = make("div", { className: "controls" });
    this.button = make("button", { type: "button" });
    this.slider = make("input", { type: "range", min: 0, max: this.end, step: 1, value: 0 });
    this.slider.setAttribute("aria-label", "Time");
    this.status = make("span", { className: "at" });
    bar.append(this.button, this.slider, this.status);
    this.canvas.after(bar);
    this.canvas.title = "Drag or use the arrow keys to turn the view";
    figure.querySelector("figcaption").append(`. ${this.motion.notes.join(" ")}`);
    figure.hidden = false;
    this.toggle(false);
  }

  listen() {
    const { canvas } = this;
    this.button.addEventListener("click", () => this.toggle(!this.playing));
    this.slider.addEventListener("input", () => { this.toggle(false); this.fresh = false; this.at = Number(this.slider.value); this.draw(); });
    canvas.addEventListener("pointerdown", event => canvas.setPointerCapture(event.pointerId));
    canvas.addEventListener("pointermove", event => {
      if (canvas.hasPointerCapture(event.pointerId)) this.turn(0.01 * event.movementX, 0.01 * event.movementY);
    });
    canvas.addEventListener("keydown", event => {
      const by = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] }[event.key];
      if (!by) return;
      event.preventDefault();
      this.turn(...by);
    });
  }

  turn(yaw, pitch) {
    this.yaw += yaw;
    this.pitch = Math.min(Math.max(this.pitch + pitch, -1.5), 1.5);
    this.draw();
  }

  toggle(on) {
    this.playing = on;
    this.button.textContent = on ? "❚❚ Pause" : "▶ Play";
    if (!on) return;
    if (this.fresh || this.at >= this.end) this.at = 0;
    this.fresh = false;
    let last;
    const tick = now => {
      if (!this.playing || !this.canvas.isConnected) return;
      this.at = Math.min(this.at + Math.min(now - (last ?? now), 100) / 1000 * this.rate, this.end);
      last = now;
      this.draw();
      if (this.at < this.end) requestAnimationFrame(tick);
      else this.toggle(false);
    };
    requestAnimationFrame(tick);
  }

  updateColours() {
    const style = getComputedStyle(this.canvas);
    this.colours = Object.fromEntries(COLOURS.map(name => [name, style.getPropertyValue(`--motion-${name}`).trim()]));
    this.resize();
  }

  resize() {
    const dense = devicePixelRatio || 1, { clientWidth: wide, clientHeight: high } = this.canvas;
    Object.assign(this.canvas, { width: Math.round(wide * dense), height: Math.round(high * dense) });
    Object.assign(this, { wide, high, dense });
    this.draw();
  }

  attitude(which, time) {
    return attitude(this.motion.t, this.motion[which], time);
  }

  /** The time at which the student's attitude differs most from the exact one: what is shown before it plays. */
  farthest() {
    const apart = this.motion.t.map(time => {
      const yours = this.attitude("yours", time);
      return yours ? angleBetween(yours, this.attitude("exact", time)) : -1;
    });
    return this.motion.t[apart.indexOf(Math.max(...apart))];
  }

  draw() {
    if (!this.wide) return;
    const { pen, wide, high, dense } = this;
    const [c, s, cp, sp] = [Math.cos(this.yaw), Math.sin(this.yaw), Math.cos(this.pitch), Math.sin(this.pitch)];
    this.view = product([[c, s, 0], [-s * sp, c * sp, cp], [s * cp, -c * cp, sp]], this.upright); // right, up, towards the viewer
    pen.setTransform(dense, 0, 0, dense, 0, 0);
    pen.clearRect(0, 0, wide, high);
    pen.textAlign = "center";
    pen.font = "13px system-ui, sans-serif";
    this.reach = (Math.min(wide / 2, high - 24) / 2 - 24) / TIP;
    const yours = this.attitude("yours", this.at), exact = this.attitude("exact", this.at);
    this.body("yours", yours, wide / 4);
    this.body("exact", exact, 3 * wide / 4);
    this.line([[wide / 2, 8], [wide / 2, high - 8]], this.colours.rule, 1);
    const difference = yours ? `${angleBetween(yours, exact).toFixed(1)}° apart` : "your R is not a rotation";
    this.status.textContent = `${(this.at / 1000).toFixed(2)} s, ${difference}`;
    this.slider.value = this.at;
    this.slider.setAttribute("aria-valuetext", this.status.textContent);
  }

  body(which, R, x) {
    const { pen, half } = this, { axis, L } = this.motion, y = (this.high - 24) / 2;
    this.project = v => [x + this.reach * v[0], y - this.reach * v[1]];
    pen.fillStyle = this.colours.words;
    pen.fillText(R ? which : `${which}: not a rotation`, x, this.high - 8);
    if (!R) return;
    const turned = product(this.view, R), along = column(turned, axis), seenL = times(this.view, L), inBody = times(transposed(R), L);
    const ways = half.map((h, k) => h / Math.max(Math.abs(inBody[k]), 1e-9)), way = Math.min(...ways), out = ways.indexOf(way);
    const arrows = [ // from the point where they leave the box; drawn over it if that face is visible
      { from: scaled(along, half[axis]), to: along, colour: this.colours.axis, name: "ê" + "₁₂₃"[axis], over: along[2] > 0 },
      { from: scaled(seenL, way), to: seenL, colour: this.colours.momentum, name: "L", over: turned[2][out] * inBody[out] > 0 },
    ];
    const [first, second] = arrows.map(arrow => this.label(arrow)); // where their names stand
    if (Math.hypot(first[0] - second[0], first[1] - second[1]) < 18) second[0] += first[0] < second[0] ? 18 : -18;
    [arrows[0].at, arrows[1].at] = [first, second];
    this.trail(which, -1);
    for (const arrow of arrows) if (!arrow.over) this.arrow(arrow);
    for (const k of [0, 1, 2]) this.face(turned, k, turned[2][k] > 0 ? 1 : -1);
    for (const arrow of arrows) if (arrow.over) this.arrow(arrow);
    this.trail(which, 1);
  }

  face(turned, k, side) {
    const { pen, half } = this, [p, q] = [0, 1, 2].filter(other => other !== k);
    const lit = side * LIGHT.reduce((sum, l, i) => sum + l * turned[i][k], 0), path = new Path2D();
    for (const [a, b] of CORNERS) path.lineTo(...this.project(turned.map(row => side * half[k] * row[k] + a * half[p] * row[p] + b * half[q] * row[q])));
    path.closePath();
    const shade = `rgb(0 0 0 / ${(0.45 * (1 - Math.max(0, lit))).toFixed(3)})`;
    for (const colour of [this.colours[`face${k + 1}`], side < 0 ? "rgb(255 255 255 / 0.35)" : "transparent", shade]) { // the face at an axis' negative end is paler
      pen.fillStyle = colour;
      pen.fill(path);
    }
    Object.assign(pen, { strokeStyle: this.colours.edge, lineWidth: 1, lineJoin: "round" });
    pen.stroke(path);
  }

  /** Return the place of an arrow's name: beyond its tip. */
  label({ from, to }) {
    const [x0, y0] = this.project(from), [x, y] = this.project(scaled(to, TIP)), length = Math.hypot(x - x0, y - y0);
    return length > 1 ? [x + 13 * (x - x0) / length, y + 13 * (y - y0) / length + 4] : [x, y - 9];
  }

  arrow({ from, to, colour, name, at }) {
    const { pen } = this, [x0, y0] = this.project(from), [x, y] = this.project(scaled(to, TIP)), length = Math.hypot(x - x0, y - y0);
    const [u, v] = length > 1 ? [(x - x0) / length, (y - y0) / length] : [0, -1];
    this.line([[x0, y0], [x, y]], colour, 2.5);
    pen.fillStyle = colour;
    pen.beginPath();
    for (const [f, g] of [[4, 0], [-6, 4], [-6, -4]]) pen.lineTo(x + f * u - g * v, y + f * v + g * u);
    pen.fill();
    pen.fillText(name, ...at);
  }

  /** Draw the path of the axis' tip so far on a sphere around the box: the half towards the viewer (1) or away from it (-1). */
  trail(which, side) {
    const { t, axis } = this.motion, moments = [...t.flatMap((one, k) => (k ? [(one + t[k - 1]) / 2, one] : [one])).filter(one => one < this.at), this.at];
    let points = [];
    this.pen.globalAlpha = side > 0 ? 0.8 : 0.35;
    for (const time of [...moments, null]) {
      const R = time === null ? null : this.attitude(which, time), v = R && times(this.view, column(R, axis));
      if (v) points.push(this.project(scaled(v, TIP)));
      if (v && v[2] * side >= 0) continue;
      if (points.length > 1) this.line(points, this.colours.trail, 1.2);
      points = points.slice(-1);
    }
    this.pen.globalAlpha = 1;
  }

  line(points, colour, wide) {
    const { pen } = this;
    Object.assign(pen, { strokeStyle: colour, lineWidth: wide });
    pen.beginPath();
    for (const [x, y] of points) pen.lineTo(x, y);
    pen.stroke();
  }
}

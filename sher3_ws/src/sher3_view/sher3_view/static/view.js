// The page: data into frames, the camera, and the controls.
const data = JSON.parse(document.getElementById("data").textContent);
const byId = (name) => document.getElementById(name);
const { seconds } = data, LAST = seconds.length - 1;

// ---- frames: points of all moving parts, moved between the recorded ones
function unpacked(text) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  return new Int16Array(bytes.buffer);
}
const robot = unpacked(data.points), ghosts = data.ghosts.map((ghost) => unpacked(ghost.points));
const WIDTH = 3 * data.moving.reduce((sum, part) => sum + part.count, 0);

function partsAt(numbers, row, share) {
  const value = (k, axis) => {
    const here = numbers[row * WIDTH + k], next = numbers[Math.min(row + 1, LAST) * WIDTH + k];
    return here === data.absent || next === data.absent ? NaN : data.origin[axis] + data.step * (here + share * (next - here));
  };
  let k = 0;
  return data.moving.map((part) => {
    const points = [];
    for (let i = 0; i < part.count; i++, k += 3) points.push([value(k, 0), value(k + 1, 1), value(k + 2, 2)]);
    return { ...part, points };
  });
}

// ---- camera
const canvas = byId("scene"), overlay = new Overlay(byId("overlay"));
const plate = data.fixed.find((part) => part.name === "base"), edge = data.fixed.find((part) => part.kind === "path");
const stage = new Stage(canvas, plate.points[0][2] - 0.001);
if (!stage.gl) byId("hint").textContent = "This browser has no WebGL; the plots below work without it.";
const FIELD = 0.5, VIEWS = {
  robot: { turn: -0.85, rise: 0.32, distance: 0.68, target: [0.065, 0, 0.052] },
  tip: { turn: -0.85, rise: 0.35, distance: 0.045, target: null },
  top: { turn: -1.5708, rise: 1.5, distance: 0.68, target: [0.085, 0, 0.05] },
};
let camera = { ...VIEWS.robot }, chosen = "robot";

function viewNow(tip) {
  const box = canvas.getBoundingClientRect(), dense = window.devicePixelRatio || 1;
  const [width, height] = [Math.round(box.width * dense), Math.round(box.height * dense)];
  if (canvas.width !== width || canvas.height !== height) { canvas.width = width; canvas.height = height; }
  const aspect = width / height, { turn, rise } = camera, target = camera.target || tip;
  // A narrow window shows the same width of the robot from farther away.
  const distance = camera.distance * Math.max(1, 1.25 / aspect);
  const eye = add(target, times([Math.cos(rise) * Math.cos(turn), Math.cos(rise) * Math.sin(turn), Math.sin(rise)], distance));
  const matrix = product(perspective(FIELD, aspect, distance / 40, distance * 12), lookAt(eye, target, [0, 0, 1]));
  return { matrix, eye, distance, field: FIELD };
}

function choose(name) {
  chosen = name; camera = { ...VIEWS[name] };
  document.querySelectorAll("[data-camera]").forEach((b) => b.setAttribute("aria-pressed", String(b.dataset.camera === name)));
  changed = true;
}
document.querySelectorAll("[data-camera]").forEach((b) => b.addEventListener("click", () => choose(b.dataset.camera)));
const fingers = new Map();
canvas.addEventListener("pointerdown", (event) => { canvas.setPointerCapture(event.pointerId); fingers.set(event.pointerId, event); });
["pointerup", "pointercancel"].forEach((name) => canvas.addEventListener(name, (event) => fingers.delete(event.pointerId)));
canvas.addEventListener("pointermove", (event) => {
  const before = fingers.get(event.pointerId);
  if (!before) return;
  const other = [...fingers.values()].find((finger) => finger.pointerId !== event.pointerId);
  if (other) {
    const apart = (e) => Math.hypot(e.clientX - other.clientX, e.clientY - other.clientY) || 1;
    zoom(apart(before) / apart(event));
  } else {
    camera.turn -= (event.clientX - before.clientX) * 0.008;
    camera.rise = Math.max(-0.3, Math.min(1.55, camera.rise + (event.clientY - before.clientY) * 0.008));
  }
  fingers.set(event.pointerId, event); changed = true;
});
const zoom = (factor) => { camera.distance = Math.max(0.004, Math.min(2.5, camera.distance * factor)); changed = true; };
canvas.addEventListener("wheel", (event) => { event.preventDefault(); zoom(Math.exp(event.deltaY * 0.0012)); }, { passive: false });
canvas.addEventListener("dblclick", () => choose(chosen));

// ---- time
let time = seconds[0], playing = false, changed = true, rate = 1;
const slider = byId("slider");
slider.step = "any"; slider.min = seconds[0]; slider.max = seconds[LAST];
const seek = (t) => { time = Math.max(seconds[0], Math.min(seconds[LAST], t)); changed = true; };
const play = (on) => { if (on && time >= seconds[LAST]) time = seconds[0]; playing = on; byId("play").textContent = on ? "❚❚" : "▶"; };
slider.addEventListener("input", () => seek(Number(slider.value)));
byId("play").addEventListener("click", () => play(!playing));
byId("rate").addEventListener("change", (event) => { rate = Number(event.target.value); });
addEventListener("keydown", (event) => {
  if (event.target.tagName === "SELECT") return;
  if (event.key === " " && event.target.tagName !== "BUTTON") { event.preventDefault(); play(!playing); }
  if (event.key === "ArrowRight" && event.target !== slider) seek(time + 0.1);
  if (event.key === "ArrowLeft" && event.target !== slider) seek(time - 0.1);
});
addEventListener("resize", () => { changed = true; });

function rowAt(t) {
  let low = 0, high = LAST;
  while (high - low > 1) { const middle = (low + high) >> 1; if (seconds[middle] <= t) low = middle; else high = middle; }
  return t >= seconds[LAST] ? LAST : low;
}

// ---- plots and figures
const column = (rows, k, factor = 1) => rows.map((row) => (row[k] === null ? null : row[k] * factor));
const BLUES = ["#2b6cb0", "#e8890c", "#2f9e44", "#868e96", "#c2255c"];
const capped = data.cap.some((cap) => cap !== null);
const plots = [
  new Plot(byId("plot_force"), seconds, ["x", "y", "z"].map((name, k) => ({ name, colour: BLUES[k], values: column(data.force, k) })), seek),
  new Plot(byId("plot_speed"), seconds, [{ name: "speed", colour: BLUES[0], values: data.speed.map((v) => v * 1e3) },
    ...(capped ? [{ name: "cap", colour: "#e03131", dash: [4, 3], values: data.cap.map((v) => (v === null ? null : v * 1e3)) }] : [])], seek),
  new Plot(byId("plot_tracking"), seconds, data.limits.map(([name, unit], k) => ({ name, unit, k }))
    .filter((axis) => axis.unit === "m").map(({ name, k }) => ({ name: name.replace("delta_", "δ"), colour: BLUES[k], values: column(data.tracking, k, 1e6) })), seek),
];
byId("gap").hidden = !data.ghosts.length;
if (data.ghosts.length) plots.push(new Plot(byId("plot_gap"), seconds, data.ghosts.map((ghost, k) =>
  ({ name: ghost.name, colour: GHOST_INKS[k % GHOST_INKS.length], values: ghost.distance.map((v) => v * 1e6) })), seek));
byId("axes").innerHTML = data.limits.map(() => `<div class="axis"><span></span><div class="bar"><i></i></div><span></span></div>`).join("");
const bars = [...document.querySelectorAll(".axis")];
data.limits.forEach(([name], k) => { bars[k].firstChild.textContent = name.replace("delta_", "delta "); });

const signed = (v, digits) => `${v < 0 ? "−" : ""}${Math.abs(v).toFixed(digits)}`;
const spanAt = (spans, t) => spans.filter(([start]) => start <= t).pop();

function figures(row) {
  const state = spanAt(data.states, time), motion = spanAt(data.motion, time), cap = data.cap[row];
  byId("state").style.borderColor = (state && STATES[state[2]]) || "";
  byId("state").firstChild.textContent = state ? state[2] : "state not recorded";
  byId("state").lastChild.textContent = motion ? motion[3] : state ? state[3] : "";
  byId("speed").innerHTML = `${(data.speed[row] * 1e3).toFixed(2)} mm/s <small>${cap === null ? "no cap" : `of ${(cap * 1e3).toFixed(1)}`}</small>`;
  byId("force").textContent = `${size(data.force[row]).toFixed(2)} N`;
  byId("pedal").textContent = `${Math.round(100 * data.pedal[row])} %`;
  byId("edge").textContent = `${signed(data.edge[row] * 1e3, 1)} mm`;
  data.limits.forEach(([, unit, lower, upper], k) => {
    const q = data.position[row][k];
    bars[k].querySelector("i").style.left = `${(100 * (q - lower)) / (upper - lower)}%`;
    bars[k].lastChild.textContent = unit === "rad" ? `${signed((q * 180) / Math.PI, 3)}°` : `${signed(q * 1e3, 3)} mm`;
  });
}

// ---- drawing
const fixed = data.fixed.filter((part) => part.kind !== "path");
function draw() {
  const row = rowAt(time), next = Math.min(row + 1, LAST);
  const share = next > row ? Math.min(1, (time - seconds[row]) / (seconds[next] - seconds[row])) : 0;
  const tip = add(data.tip[row], times(minus(data.tip[next], data.tip[row]), share));
  const view = viewNow(tip), moving = partsAt(robot, row, share), labels = [];
  for (const part of moving) {
    if (part.kind !== "arrow") continue;
    // From near, the arrow keeps its length on the screen; its number says what it is.
    const shrink = Math.min(1, view.distance / VIEWS.robot.distance), newton = size(data.force[row]);
    part.points[1] = add(part.points[0], times(minus(part.points[1], part.points[0]), shrink));
    part.size = part.size.map((s) => s * shrink);
    if (newton > 0.15) labels.push({ at: part.points[1], text: `${newton.toFixed(2)} N`, colour: "#c2410c" });
  }
  for (const part of moving) if (part.name === "remote_centre" && !Number.isNaN(part.points[0][0])) labels.push({ at: part.points[0], text: "remote centre", colour: "#c2410c" });
  stage.draw(view, [...fixed, ...moving], ghosts.map((ghost) => partsAt(ghost, row, share)));
  overlay.draw(view, data.tip, row, chosen === "tip" ? null : edge.points, labels);
  plots.forEach((plot) => plot.draw(time));
  drawRibbon(byId("ribbon"), data.states, seconds, data.pedal);
  figures(row);
  slider.value = time;
  byId("clock").textContent = `${time.toFixed(1)} / ${seconds[LAST].toFixed(1)} s`;
}

let before = 0;
function tick(now) {
  if (playing) { time += Math.min(0.1, (now - before) * 1e-3) * rate; changed = true; if (time >= seconds[LAST]) { time = seconds[LAST]; play(false); } }
  before = now;
  if (changed) { changed = false; draw(); }
  requestAnimationFrame(tick);
}
byId("tracked").innerHTML = data.tracked === "position" ? "Wanted minus measured position <i>µm</i>" : "Demanded minus measured velocity <i>µm/s</i>";
byId("facts").textContent = `${(seconds[LAST] - seconds[0]).toFixed(1)} s · ${data.dropped ? `${data.dropped} samples missing` : "no samples missing"} · force arrow ${data.metresPerNewton * 1e3} mm per N`;
data.ghosts.forEach((ghost, k) => {
  const line = document.createElement("span");
  line.style.color = GHOST_INKS[k % GHOST_INKS.length];
  line.textContent = `${ghost.name}: difference drawn ${ghost.exaggeration} times`;
  byId("ghost").append(line);
});
// An address that ends in #t=8,tip opens at 8 s from near.
for (const word of location.hash.slice(1).split(",")) { if (word.startsWith("t=")) time = Math.max(seconds[0], Math.min(seconds[LAST], Number(word.slice(2)) || 0)); else if (VIEWS[word]) choose(word); }
requestAnimationFrame(tick);

// Plots over time with a cursor, and the ribbon of states.
const STATES = { ENABLED: "#2f9e44", DISABLED: "#adb5bd", PAUSED: "#f08c00", FAULT: "#e03131" };

// A round step that divides a span into about `count` parts.
function roundStep(span, count) {
  const raw = span / count, ten = 10 ** Math.floor(Math.log10(raw));
  return [1, 2, 5, 10].map((k) => k * ten).find((step) => step >= raw);
}

class Plot {
  // lines: [{ values, colour, name, dash }], null where there is no value; seek(seconds) is called on click and drag.
  constructor(canvas, seconds, lines, seek) {
    Object.assign(this, { canvas, seconds, lines });
    const values = lines.flatMap((line) => line.values.filter((v) => v !== null));
    this.low = Math.min(0, ...extent(values)); this.high = Math.max(0, ...extent(values));
    if (this.high - this.low < 1e-9) this.high = this.low + 1;
    this.step = roundStep(this.high - this.low, 3);
    const pad = 0.06 * (this.high - this.low);
    this.low -= this.low < 0 ? pad : 0; this.high += pad;
    const go = (event) => {
      const box = canvas.getBoundingClientRect();
      seek(this.from + ((event.clientX - box.left - this.left) / (box.width - this.left - 4)) * (this.to - this.from));
    };
    canvas.addEventListener("pointerdown", (event) => { canvas.setPointerCapture(event.pointerId); go(event); });
    canvas.addEventListener("pointermove", (event) => event.buttons && go(event));
  }

  get from() { return this.seconds[0]; }
  get to() { return this.seconds[this.seconds.length - 1]; }
  get left() { return 40; }

  draw(now) {
    const { pen, width, height } = sheet(this.canvas), bottom = height - 18, top = 18;
    const x = (t) => this.left + ((t - this.from) / (this.to - this.from)) * (width - this.left - 4);
    const y = (v) => bottom - ((v - this.low) / (this.high - this.low)) * (bottom - top);
    pen.font = '11px system-ui, "DejaVu Sans", sans-serif'; pen.textAlign = "right";
    for (let v = Math.ceil(this.low / this.step) * this.step; v <= this.high; v += this.step) {
      pen.strokeStyle = Math.abs(v) < 1e-9 * this.step ? "#c3cbd3" : "#edf0f3"; pen.lineWidth = 1;
      pen.beginPath(); pen.moveTo(this.left, y(v)); pen.lineTo(width - 4, y(v)); pen.stroke();
      pen.fillStyle = "#66727f"; pen.fillText(String(+v.toPrecision(6)).replace("-", "−"), this.left - 6, y(v) + 4);
    }
    pen.textAlign = "center";
    const tick = roundStep(this.to - this.from, 5);
    for (let t = Math.ceil(this.from / tick) * tick; t <= this.to; t += tick)
      if (x(t) < width - 14 && x(t) > this.left + 6) pen.fillText(`${+t.toPrecision(6)} s`, x(t), height - 4);
    let at = this.left; pen.textAlign = "left";
    for (const { values, colour, name, dash } of this.lines) {
      pen.strokeStyle = colour; pen.lineWidth = dash ? 1 : 1.4; pen.setLineDash(dash || []); pen.beginPath();
      values.forEach((v, k) => v !== null && pen.lineTo(x(this.seconds[k]), y(v)));
      pen.stroke(); pen.setLineDash([]);
      pen.fillStyle = colour; pen.fillText(name, at, 10); at += pen.measureText(name).width + 12;
    }
    pen.strokeStyle = "#1d2733"; pen.lineWidth = 1; pen.beginPath(); pen.moveTo(x(now), top - 2); pen.lineTo(x(now), bottom); pen.stroke();
  }
}

function extent(values) {
  let low = Infinity, high = -Infinity;
  for (const v of values) { if (v < low) low = v; if (v > high) high = v; }
  return values.length ? [low, high] : [0, 1];
}

// States as coloured spans, the pedal's travel as a line of light upon them.
function drawRibbon(canvas, states, seconds, pedal) {
  const { pen, width, height } = sheet(canvas), from = seconds[0], to = seconds[seconds.length - 1];
  const x = (t) => 8 + Math.max(0, Math.min(1, (t - from) / (to - from))) * (width - 16);
  pen.fillStyle = "#e6eaee"; pen.fillRect(8, 0, width - 16, height);
  for (const [start, end, state] of states) {
    pen.fillStyle = STATES[state] || "#868e96"; pen.fillRect(x(start), 0, Math.max(1, x(end) - x(start)), height);
  }
  pen.fillStyle = "#ffffff3c"; pen.beginPath(); pen.moveTo(x(from), height);
  seconds.forEach((t, k) => pen.lineTo(x(t), height - pedal[k] * (height - 4)));
  pen.lineTo(x(to), height); pen.fill();
  pen.fillStyle = "#fff"; pen.font = '600 11px system-ui, "DejaVu Sans", sans-serif';
  for (const [start, end, state] of states)
    if (x(end) - x(start) > pen.measureText(state).width + 12) pen.fillText(state, x(start) + 6, height / 2 + 4);
}

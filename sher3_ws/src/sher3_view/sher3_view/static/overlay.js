// The overlay draws what must never be hidden by the robot: the tip's path, the workspace edge, labels, a scale.

// Fit a canvas to its box on the screen; return its drawing context in CSS pixels, cleared, with width and height.
function sheet(canvas) {
  const dense = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
  if (canvas.width !== Math.round(width * dense) || canvas.height !== Math.round(height * dense)) {
    canvas.width = Math.round(width * dense); canvas.height = Math.round(height * dense);
  }
  const pen = canvas.getContext("2d");
  pen.setTransform(dense, 0, 0, dense, 0, 0); pen.clearRect(0, 0, width, height);
  pen.font = '12px system-ui, "DejaVu Sans", sans-serif';
  return { pen, width, height };
}

class Overlay {
  constructor(canvas) { this.canvas = canvas; }

  draw(view, tips, now, edge, labels) {
    const { pen, width, height } = sheet(this.canvas);
    const place = (p) => {
      const m = view.matrix, w = m[3] * p[0] + m[7] * p[1] + m[11] * p[2] + m[15];
      const x = (m[0] * p[0] + m[4] * p[1] + m[8] * p[2] + m[12]) / w, y = (m[1] * p[0] + m[5] * p[1] + m[9] * p[2] + m[13]) / w;
      return w > 0 ? [(0.5 + 0.5 * x) * width, (0.5 - 0.5 * y) * height] : null;
    };
    const line = (points, colour, weight, dash = []) => {
      pen.strokeStyle = colour; pen.lineWidth = weight; pen.setLineDash(dash); pen.lineJoin = "round"; pen.beginPath();
      points.map(place).forEach((p) => p && pen.lineTo(p[0], p[1])); pen.stroke(); pen.setLineDash([]);
    };
    if (edge) line([...edge, edge[0]], "#8a97a5", 1, [3, 4]);
    line(tips, "#2b6cb033", 1.5);
    const recent = tips.slice(0, now + 1);
    line(recent, "#2b6cb0", 2);
    for (const { at, text, colour } of labels) {
      const p = place(at);
      if (!p) continue;
      const wide = pen.measureText(text).width, x = Math.max(6, Math.min(p[0] + 8, width - wide - 6));
      pen.lineWidth = 4; pen.strokeStyle = "#ffffffd0"; pen.strokeText(text, x, p[1] - 6);
      pen.fillStyle = colour; pen.fillText(text, x, p[1] - 6);
    }
    this.scale(pen, width, height, (view.distance * 2 * Math.tan(view.field / 2)) / height);
  }

  // A bar of a round length at the distance of what the camera looks at.
  scale(pen, width, height, metresPerPixel) {
    const round = [1e-5, 2e-5, 5e-5, 1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 0.01, 0.02, 0.05, 0.1].filter((l) => l / metresPerPixel < 110).pop();
    if (!round) return;
    const long = round / metresPerPixel, x = width - 16 - long, y = height - 16;
    pen.strokeStyle = "#66727f"; pen.lineWidth = 1.5; pen.beginPath();
    pen.moveTo(x, y - 4); pen.lineTo(x, y); pen.lineTo(x + long, y); pen.lineTo(x + long, y - 4); pen.stroke();
    pen.fillStyle = "#66727f"; pen.textAlign = "center";
    pen.fillText(round < 1e-3 ? `${Math.round(round * 1e6)} µm` : `${Math.round(round * 1e3)} mm`, x + long / 2, y - 7);
    pen.textAlign = "left";
  }
}

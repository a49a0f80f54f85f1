// The stage draws rods, bars, balls and arrows with shading and a shadow on the floor (WebGL 1, no library).
const COLOURS = {
  frame: [0.80, 0.83, 0.86], rail: [0.62, 0.66, 0.70], slider: [0.17, 0.42, 0.69], leg: [0.86, 0.88, 0.90],
  joint: [0.30, 0.34, 0.39], platform: [0.20, 0.25, 0.31], arm: [0.33, 0.38, 0.44], linkage: [0.70, 0.73, 0.76],
  tool: [0.88, 0.90, 0.92], needle: [0.42, 0.45, 0.49], force: [0.90, 0.32, 0.06],
};
const GHOSTS = [[0.44, 0.28, 0.91], [0.18, 0.62, 0.27], [0.80, 0.55, 0.05]], GHOST_INKS = ["#7048e8", "#2b8a3e", "#b7791f"];

const VERTEX = `
attribute vec3 place, normal; uniform vec3 origin, ax, ay, az, scale, light; uniform mat4 camera; uniform float floorAt, shadow;
varying vec3 n, p;
void main() {
  vec3 s = place * scale, m = normal / scale;
  p = origin + ax * s.x + ay * s.y + az * s.z;
  n = normalize(ax * m.x + ay * m.y + az * m.z);
  if (shadow > 0.5) { p -= light * ((p.z - floorAt) / light.z); p.z = floorAt + 0.0003; }
  gl_Position = camera * vec4(p, 1.0);
}`;
const FRAGMENT = `
precision highp float; varying vec3 n, p; uniform vec3 colour, light, eye; uniform float alpha, shadow, ground;
void main() {
  if (shadow > 0.5) { gl_FragColor = vec4(colour, 1.0); return; }
  if (ground > 0.5) { gl_FragColor = vec4(mix(colour, vec3(1.0), smoothstep(0.10, 0.42, length(p.xy - vec2(0.06, 0.0)))), 1.0); return; }
  vec3 m = normalize(n), v = normalize(eye - p), h = normalize(light + v);
  float sky = 0.5 + 0.5 * m.z, sun = max(dot(m, light), 0.0), shine = pow(max(dot(m, h), 0.0), 40.0);
  float rim = pow(1.0 - max(dot(m, v), 0.0), 3.0);
  gl_FragColor = vec4(colour * (0.42 + 0.22 * sky + 0.48 * sun) + 0.22 * shine + 0.10 * rim, alpha);
}`;

const LIGHT = unit([0.35, -0.55, 1.0]);
const AROUND = 36;

// Meshes of unit size as flat lists of place and normal, three corners a triangle.
function meshes() {
  const ring = (k) => [Math.cos((2 * Math.PI * k) / AROUND), Math.sin((2 * Math.PI * k) / AROUND)];
  const rod = [], ball = [], cone = [], bar = [];
  const face = (mesh, corners, normals) => [0, 1, 2, 0, 2, 3].slice(0, corners.length === 4 ? 6 : 3)
    .forEach((i) => mesh.push(...corners[i], ...normals[i]));
  for (let k = 0; k < AROUND; k++) {
    const a = ring(k), b = ring(k + 1), up = [0, 0, 1], down = [0, 0, -1];
    face(rod, [[...a, 0], [...b, 0], [...b, 1], [...a, 1]], [[...a, 0], [...b, 0], [...b, 0], [...a, 0]]);
    face(rod, [[0, 0, 1], [...a, 1], [...b, 1]], [up, up, up]);
    face(rod, [[0, 0, 0], [...b, 0], [...a, 0]], [down, down, down]);
    face(cone, [[...a, 0], [...b, 0], [0, 0, 1]], [[...a, 0.6], [...b, 0.6], [...a, 0.6]]);
    face(cone, [[0, 0, 0], [...b, 0], [...a, 0]], [down, down, down]);
    for (let j = 0; j < AROUND / 2; j++) {
      const at = (r, i) => { const t = (Math.PI * i) / (AROUND / 2); return [r[0] * Math.sin(t), r[1] * Math.sin(t), Math.cos(t)]; };
      const corners = [at(a, j), at(a, j + 1), at(b, j + 1), at(b, j)];
      face(ball, corners, corners);
    }
  }
  for (let axis = 0; axis < 3; axis++) for (const side of [-1, 1]) {
    const corner = (u, v) => { const c = [0, 0, 0]; c[axis] = side * 0.5; c[(axis + 1) % 3] = u * 0.5; c[(axis + 2) % 3] = v * 0.5; return add(c, [0, 0, 0.5]); };
    const normal = [0, 0, 0]; normal[axis] = side;
    face(bar, [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)], [normal, normal, normal, normal]);
  }
  return { rod, ball, cone, bar };
}

class Stage {
  constructor(canvas, floorAt) {
    this.canvas = canvas; this.floorAt = floorAt;
    const gl = this.gl = canvas.getContext("webgl", { antialias: true, preserveDrawingBuffer: true });
    if (!gl) return;
    const program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text); gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    gl.useProgram(program);
    this.at = new Proxy({}, { get: (found, name) => found[name] ?? (found[name] = gl.getUniformLocation(program, name)) });
    this.places = ["place", "normal"].map((name) => gl.getAttribLocation(program, name));
    this.meshes = Object.fromEntries(Object.entries(meshes()).map(([name, list]) => {
      const buffer = gl.createBuffer();
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer); gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(list), gl.STATIC_DRAW);
      return [name, { buffer, count: list.length / 6 }];
    }));
    gl.enable(gl.DEPTH_TEST); gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
  }

  // Draw parts, each with kind, role, size and its points; the ghosts' parts transparent and without shadow.
  draw(view, parts, ghosts) {
    const gl = this.gl;
    if (!gl) return;
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.clearColor(1, 1, 1, 1); gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.uniformMatrix4fv(this.at.camera, false, view.matrix);
    gl.uniform3fv(this.at.light, LIGHT); gl.uniform3fv(this.at.eye, view.eye);
    gl.uniform1f(this.at.floorAt, this.floorAt); gl.uniform1f(this.at.alpha, 1); gl.uniform1f(this.at.shadow, 0);
    gl.uniform1f(this.at.ground, 1);
    this.mesh("rod", [0.06, 0, this.floorAt - 0.001], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0.45, 0.45, 0.001], [0.93, 0.945, 0.96]);
    gl.uniform1f(this.at.ground, 0); gl.uniform1f(this.at.shadow, 1);
    for (const part of parts) if (part.role !== "force" && part.kind !== "path") this.part(part, [0.85, 0.87, 0.895]);
    gl.uniform1f(this.at.shadow, 0);
    for (const part of parts) this.part(part, COLOURS[part.role]);
    // First the depth alone, then the colour: only the nearest face of a ghost is seen, not all that lie behind it.
    ghosts.forEach((ghost, k) => {
      for (const colour of [false, true]) {
        gl.colorMask(colour, colour, colour, colour);
        if (colour) { gl.enable(gl.BLEND); gl.depthFunc(gl.LEQUAL); gl.uniform1f(this.at.alpha, 0.42); }
        for (const part of ghost) if (part.role !== "force") this.part(part, GHOSTS[k % GHOSTS.length]);
      }
      gl.disable(gl.BLEND); gl.depthFunc(gl.LESS);
    });
  }

  part({ kind, points, size: [width, height] }, colour) {
    const [start, end, side] = points;
    if (kind === "path" || !start || Number.isNaN(start[0])) return;
    if (kind === "ball") return this.mesh("ball", start, [1, 0, 0], [0, 1, 0], [0, 0, 1], [width, width, width], colour);
    const along = minus(end, start), length = size(along);
    if (length < 1e-6) return;
    const z = times(along, 1 / length);
    if (kind === "bar") {
      const x = unit(minus(side, start));
      return this.mesh("bar", start, x, cross(z, x), z, [width, height, length], colour);
    }
    const [x, y] = across(z);
    if (kind === "rod") return this.mesh("rod", start, x, y, z, [width, width, length], colour);
    if (length < 3e-4) return;
    const head = Math.min(5 * width, 0.6 * length);
    this.mesh("rod", start, x, y, z, [width, width, length - head], colour);
    this.mesh("cone", add(start, times(z, length - head)), x, y, z, [2.4 * width, 2.4 * width, head], colour);
  }

  mesh(name, origin, ax, ay, az, scale, colour) {
    const gl = this.gl, { buffer, count } = this.meshes[name];
    for (const [key, value] of Object.entries({ origin, ax, ay, az, scale, colour })) gl.uniform3fv(this.at[key], value);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    this.places.forEach((place, k) => { gl.enableVertexAttribArray(place); gl.vertexAttribPointer(place, 3, gl.FLOAT, false, 24, 12 * k); });
    gl.drawArrays(gl.TRIANGLES, 0, count);
  }
}

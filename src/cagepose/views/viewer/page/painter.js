// Draws meshes and lines with WebGL: lit, seen from far away (parallel lines stay parallel, lengths can be compared).

const VERTEX = `
attribute vec3 position; attribute vec3 normal; uniform mat4 model, view; uniform mat3 turn; varying vec3 facing;
void main() { facing = turn * normal; gl_Position = view * (model * vec4(position, 1.0)); }`;
const FRAGMENT = `
precision mediump float; varying vec3 facing; uniform vec4 color; uniform vec3 light; uniform float shading;
void main() {
  float lit = 0.62 + 0.38 * abs(dot(normalize(facing), light));
  gl_FragColor = vec4(color.rgb * mix(1.0, lit, shading), color.a);
}`;

class Painter {
  constructor(canvas) {
    this.canvas = canvas;
    this.gl = canvas.getContext("webgl", { antialias: true, alpha: false, preserveDrawingBuffer: true });
    if (!this.gl) throw new Error("this browser draws no WebGL; switch on hardware acceleration or use another browser");
    const gl = this.gl;
    this.program = gl.createProgram();
    for (const [kind, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(this.program, shader);
    }
    gl.linkProgram(this.program);
    gl.useProgram(this.program);
    this.at = {};
    for (const name of ["model", "view", "turn", "color", "light", "shading"]) this.at[name] = gl.getUniformLocation(this.program, name);
    this.position = gl.getAttribLocation(this.program, "position");
    this.normal = gl.getAttribLocation(this.program, "normal");
    this.meshes = { box: this.mesh(boxFaces()), ball: this.mesh(ball(8, 12)), rod: this.mesh(turned([[1, 0], [1, 1]])), cone: this.mesh(turned([[1, 0], [0, 1]])), edges: this.mesh(boxEdges()) };
    gl.enable(gl.DEPTH_TEST);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    this.lines = gl.createBuffer();
  }

  mesh(vertices) {
    const buffer = this.gl.createBuffer();
    this.gl.bindBuffer(this.gl.ARRAY_BUFFER, buffer);
    this.gl.bufferData(this.gl.ARRAY_BUFFER, new Float32Array(vertices.flat()), this.gl.STATIC_DRAW);
    return { buffer, count: vertices.length / 2 };
  }

  // Takes the solids of a run; those of the one before are forgotten.
  takeSolids(solids) {
    for (const { buffer } of this.solids ?? []) this.gl.deleteBuffer(buffer);
    this.solids = solids.map((solid) => ({ ...this.mesh(solid.corners), solid }));
  }

  begin(view, toViewer) {
    const gl = this.gl;
    this.toViewer = toViewer;
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.disable(gl.BLEND);
    gl.depthMask(true); // before the clearing, which leaves depths alone as long as they are masked
    gl.clearColor(0.965, 0.969, 0.976, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.uniformMatrix4fv(this.at.view, false, view);
    gl.uniform3fv(this.at.light, toViewer);
  }

  // From here on, things are seen through: draw what is opaque first.
  seeThrough() {
    this.gl.enable(this.gl.BLEND);
    this.gl.depthMask(false);
  }

  // The side of a solid that faces the viewer.
  drawSolid(index, pose, color) {
    this.gl.enable(this.gl.CULL_FACE);
    this.drawMesh(this.solids[index], placed(pose, [1, 1, 1]), color, this.gl.TRIANGLES);
    this.gl.disable(this.gl.CULL_FACE);
  }

  drawOutline(index, pose, color) {
    const gl = this.gl;
    const lines = this.solids[index].solid.outline(rotated(conjugate(pose.q), this.toViewer));
    gl.bindBuffer(gl.ARRAY_BUFFER, this.lines);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(lines.flat()), gl.DYNAMIC_DRAW);
    this.drawMesh({ buffer: this.lines, count: lines.length / 2 }, placed(pose, [1, 1, 1]), color, gl.LINES);
  }

  draw(name, model, color) {
    this.drawMesh(this.meshes[name], model, color, name === "edges" ? this.gl.LINES : this.gl.TRIANGLES);
  }

  drawMesh(mesh, model, color, kind) {
    const gl = this.gl;
    // Normals turn with the inverse transpose: for columns at right angles, each divided by its squared length.
    const columns = [0, 4, 8].map((i) => model.slice(i, i + 3)).map((column) => times(1 / (dot(column, column) || 1), column));
    this.bind(mesh.buffer);
    gl.uniformMatrix4fv(this.at.model, false, model);
    gl.uniformMatrix3fv(this.at.turn, false, columns.flat());
    gl.uniform4fv(this.at.color, color);
    gl.uniform1f(this.at.shading, kind === gl.LINES ? 0 : 1);
    gl.drawArrays(kind, 0, mesh.count);
  }

  polyline(points, color) {
    if (points.length < 2) return;
    const gl = this.gl;
    this.bind(this.lines);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(points.flatMap((point) => [...point, 0, 0, 1])), gl.DYNAMIC_DRAW);
    gl.uniformMatrix4fv(this.at.model, false, [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
    gl.uniformMatrix3fv(this.at.turn, false, [1, 0, 0, 0, 1, 0, 0, 0, 1]);
    gl.uniform4fv(this.at.color, color);
    gl.uniform1f(this.at.shading, 0);
    gl.drawArrays(gl.LINE_STRIP, 0, points.length);
  }

  arrow(tail, tip, width, color) {
    const length = norm(sub(tip, tail));
    if (length === 0) return;
    const direction = times(1 / length, sub(tip, tail));
    const head = Math.min(5 * width, 0.6 * length);
    this.draw("rod", along(tail, direction, length - head, width), color);
    this.draw("cone", along(add(tail, times(length - head, direction)), direction, head, 2.6 * width), color);
  }

  bind(buffer) {
    const gl = this.gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.enableVertexAttribArray(this.position);
    gl.enableVertexAttribArray(this.normal);
    gl.vertexAttribPointer(this.position, 3, gl.FLOAT, false, 24, 0);
    gl.vertexAttribPointer(this.normal, 3, gl.FLOAT, false, 24, 12);
  }
}

// Meshes: lists of position, normal, position, normal, ...; a box of edge 1, all else of radius and length 1 along z.

function boxFaces() {
  const vertices = [];
  for (let axis = 0; axis < 3; axis++) for (const side of [-1, 1]) {
    const corner = (a, b) => { const v = []; v[axis] = side / 2; v[(axis + 1) % 3] = a / 2; v[(axis + 2) % 3] = b / 2; return v; };
    const normal = [0, 0, 0];
    normal[axis] = side;
    for (const [a, b] of [[-1, -1], [1, -1], [1, 1], [-1, -1], [1, 1], [-1, 1]]) vertices.push(corner(a, b), normal);
  }
  return vertices;
}

function boxEdges() {
  const vertices = [];
  for (let axis = 0; axis < 3; axis++) for (const a of [-0.5, 0.5]) for (const b of [-0.5, 0.5]) for (const end of [-0.5, 0.5]) {
    const v = [];
    v[axis] = end; v[(axis + 1) % 3] = a; v[(axis + 2) % 3] = b;
    vertices.push(v, [0, 0, 1]);
  }
  return vertices;
}

// The surface that a profile of [radius, height] sweeps about z.
function turned(profile, n = 12) {
  const vertices = [];
  for (let i = 0; i + 1 < profile.length; i++) for (let j = 0; j < n; j++) {
    const [[r0, z0], [r1, z1]] = [profile[i], profile[i + 1]];
    const at = (r, z, k) => [r * Math.cos(2 * Math.PI * k / n), r * Math.sin(2 * Math.PI * k / n), z];
    const quad = [at(r0, z0, j), at(r0, z0, j + 1), at(r1, z1, j + 1), at(r0, z0, j), at(r1, z1, j + 1), at(r1, z1, j)];
    const normal = unit([...times(z1 - z0, at(1, 0, j + 0.5)).slice(0, 2), r0 - r1]);
    for (const v of quad) vertices.push(v, normal);
  }
  return vertices;
}

function ball(rings, n) {
  const profile = Array.from({ length: rings + 1 }, (_, i) => [Math.sin(Math.PI * i / rings), -Math.cos(Math.PI * i / rings)]);
  return turned(profile, n);
}

// Draws the stage at one time: the object, the cage, what touches and presses, what pushes, what it turns about.

const COLORS = {
  box: [0.337, 0.706, 0.914, 0.3], edge: [0, 0.447, 0.698, 1], ghost: [0.6, 0.6, 0.6, 1], free: [0.45, 0.45, 0.45, 1],
  touching: [0.902, 0.624, 0, 1], reached: [0.835, 0.369, 0, 1], force: [0.835, 0.369, 0, 1], normal: [0.3, 0.3, 0.3, 1],
  body: [0.72, 0.66, 0.55, 0.45], bodyEdge: [0.36, 0.3, 0.2, 1], load: [0.05, 0.05, 0.05, 1], axis: [0.8, 0.475, 0.655, 1], trace: [0, 0.447, 0.698, 1], center: [0, 0.447, 0.698, 1],
};
const BALL = 0.01, ROD = 0.0045, LONGEST_ARROW = 0.22, NORMAL = 0.07;
const SECOND_HEAD = 0.8; // of a moment's arrow, where its other head is
const LONGEST_SPRING = 1.0, COIL = 0.012, COILS = 7, COIL_POINTS = 8, STRAIGHT_ENDS = 0.15; // of a spring
const FEW_NAMES = 14; // of more contacts than these, only those are named that press or were just reached
const LEAST_FORCE = 1e-9; // parts of the greatest; what is less is rounding

// Where a load's arrow starts and ends: that of a force ends where it acts, that of a moment starts at the centre of
// gravity; a spring leads to where it is held, or part of the way.
function loadEnds(load, pose) {
  const at = carried(pose, load.at);
  if (load.kind === "spring") {
    const way = sub(load.to, at);
    return [at, add(at, times(Math.min(1, LONGEST_SPRING / (norm(way) || 1)), way))];
  }
  const arrow = times(LONGEST_ARROW, load.follows ? rotated(pose.q, load.direction) : load.direction);
  return load.kind === "moment" ? [at, add(at, arrow)] : [sub(at, arrow), at];
}

// A spring between two points, as a line that winds.
function coil(start, end) {
  const way = sub(end, start);
  if (norm(way) === 0) return [start, end];
  const helper = Math.abs(way[2]) < 0.9 * norm(way) ? [0, 0, 1] : [1, 0, 0];
  const aside = unit(cross(way, helper));
  const up = unit(cross(way, aside));
  const on = (share) => add(start, times(share, way));
  const wound = Array.from({ length: COILS * COIL_POINTS + 1 }, (_, k) => {
    const turn = 2 * Math.PI * k / COIL_POINTS;
    const axis = on(STRAIGHT_ENDS + (1 - 2 * STRAIGHT_ENDS) * k / (COILS * COIL_POINTS));
    return add(axis, add(times(COIL * Math.cos(turn), aside), times(COIL * Math.sin(turn), up)));
  });
  return [start, on(STRAIGHT_ENDS), ...wound, on(1 - STRAIGHT_ENDS), end];
}

class Drawing {
  constructor(stage, canvas, overlay, changed) {
    this.canvas = canvas;
    this.overlay = overlay;
    this.painter = new Painter(canvas);
    this.take(stage);
    this.exaggeration = stage.data.exaggeration;
    this.camera = new Camera(canvas, stage.data.radius, () => this.content(), changed);
    this.allNames = stage.data.names.length <= FEW_NAMES;
  }

  // Shows another run from now on.
  take(stage) {
    this.stage = stage;
    this.solids = stage.data.meshes.map((mesh) => new Solid(mesh));
    this.painter.takeSolids(this.solids);
  }

  draw(time) {
    const scale = window.devicePixelRatio;
    for (const canvas of [this.canvas, this.overlay]) {
      const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((pixels) => Math.max(1, Math.round(pixels * scale)));
      if (canvas.width !== width) canvas.width = width; // setting it anew, even to the same, costs a frame
      if (canvas.height !== height) canvas.height = height;
    }
    const { stage, painter, exaggeration: k } = this;
    const shot = stage.shot(time);
    const pose = stage.shownPose(stage.truePose(time), k);
    const labels = [];
    painter.begin(this.camera.matrix(), this.camera.axes()[2]);
    this.drawPoints(shot, k, labels);
    this.drawTouches(shot, pose, k);
    this.drawLoads(shot, pose, labels);
    this.drawMotion(shot, pose, k);
    this.drawTrace(time, k);
    this.drawObject(pose, k);
    this.write(labels, scale);
  }

  // Shows motions so many times as large, all in view.
  exaggerate(k) {
    this.exaggeration = k;
    this.camera.fit();
  }

  // All that a view is fitted to: corners at the start and each event's end, cage points, loads, forces at the end, and
  // what lies near them of the cage's bodies.
  content() {
    const { stage, exaggeration: k } = this;
    const ends = [0, ...stage.data.rows.map((row) => row.last)].map((shot) => stage.shownPose(stage.shots[shot].pose, k));
    const end = ends.at(-1);
    const signs = [-0.5, 0.5].flatMap((x) => [-0.5, 0.5].flatMap((y) => [-0.5, 0.5].map((z) => [x, y, z])));
    const corners = ends.flatMap((pose) => stage.data.boxes.flatMap((box) => signs.map((sign) =>
      carried(composed(pose, { p: box.position, q: box.quaternion }), sign.map((value, axis) => value * box.size[axis])))));
    const tails = stage.data.phases.flatMap((phase) => phase.loads).flatMap((load) => loadEnds(load, end));
    const pressing = stage.shots.at(-1).touches.filter((touch) => touch.force).map((touch) =>
      sub(stage.place(touch, k), times(LONGEST_ARROW / stage.data.greatestForce, rotated(end.q, touch.force))));
    const rounded = ends.flatMap((pose) => this.placedSolids(pose).flatMap((solid) => this.vertices(solid)));
    const needed = [...corners, ...rounded, ...tails, ...pressing, ...stage.data.points.map((_, index) => stage.point(index, k))];
    const [low, high] = [Math.min, Math.max].map((pick) => [0, 1, 2].map((axis) => needed.reduce((best, place) => pick(best, place[axis]), needed[0][axis])));
    this.cutOff = (place) => place.map((value, axis) => Math.max(low[axis] - stage.data.reach, Math.min(high[axis] + stage.data.reach, value)));
    return [...needed, ...this.cageHoles().flatMap((hole) => this.vertices(hole)), ...this.bodies(k).flatMap((body) => this.vertices(body).map(this.cutOff))];
  }

  // The shapes of the object at a pose, or its holes; those of the cage; and its holes, which stay where they are.
  placedSolids(pose, solids = this.stage.data.shapes) {
    return solids.map(({ mesh, position, quaternion }) => ({ mesh, pose: composed(pose, { p: position, q: quaternion }) }));
  }

  cageHoles() {
    return this.stage.data.cageHoles.map(({ mesh, position, quaternion }) => ({ mesh, pose: { p: position, q: quaternion } }));
  }

  bodies(k) {
    return this.stage.data.bodies.map(({ mesh }, index) => ({ mesh, pose: this.stage.bodyPose(index, k) }));
  }

  vertices({ mesh, pose }) {
    return this.solids[mesh].vertices.map((vertex) => carried(pose, vertex));
  }

  // The middle of what is shown of a shape of the cage.
  middle(body) {
    const places = this.vertices(body).map(this.cutOff);
    return times(1 / places.length, places.reduce(add));
  }

  // Where a shape or a hole of the cage that touches nothing has its name.
  namedPlace(index, bodies) {
    return index < bodies.length ? this.middle(bodies[index]) : this.stage.data.cageHoles[index - bodies.length].position;
  }

  boxes(pose, name, color) {
    for (const box of this.stage.data.boxes) this.painter.draw(name, placed(composed(pose, { p: box.position, q: box.quaternion }), box.size), color);
  }

  // Edges and outlines, and, seen through, the object and the bodies of the cage, far ones first.
  drawObject(pose, k) {
    const start = this.stage.shots[0].pose;
    const [shapes, bodies] = [this.placedSolids(pose), this.bodies(k)];
    this.boxes(start, "edges", COLORS.ghost);
    this.boxes(pose, "edges", COLORS.edge);
    for (const { mesh, pose: placed } of this.placedSolids(start)) this.painter.drawOutline(mesh, placed, COLORS.ghost);
    for (const { mesh, pose: placed } of [...shapes, ...this.placedSolids(pose, this.stage.data.holes)]) this.painter.drawOutline(mesh, placed, COLORS.edge);
    for (const { mesh, pose: placed } of [...bodies, ...this.cageHoles()]) this.painter.drawOutline(mesh, placed, COLORS.bodyEdge);
    this.ball(carried(pose, this.stage.data.center), BALL, COLORS.center);
    this.painter.seeThrough();
    const depth = (place) => dot(place, this.painter.toViewer);
    const object = { depth: depth(carried(pose, this.stage.data.center)), draw: () => {
      this.boxes(pose, "box", COLORS.box);
      for (const { mesh, pose: placed } of shapes) this.painter.drawSolid(mesh, placed, COLORS.box);
    } };
    const others = bodies.map((body) => ({ depth: depth(this.middle(body)), draw: () => this.painter.drawSolid(body.mesh, body.pose, COLORS.body) }));
    for (const { draw } of [object, ...others].sort((one, other) => one.depth - other.depth)) draw();
  }

  ball(place, radius, color) {
    this.painter.draw("ball", placed({ p: place, q: [1, 0, 0, 0] }, [radius, radius, radius]), color);
  }

  drawPoints(shot, k, labels) {
    const touching = new Set(shot.touches.map((touch) => touch.point));
    const row = this.stage.data.rows[shot.row];
    const isEnd = row && this.stage.shots[row.last] === shot;
    const pressing = new Set(shot.touches.filter((touch) => touch.force && norm(touch.force) > LEAST_FORCE * this.stage.data.greatestForce).map((touch) => touch.point));
    const bodies = this.bodies(k);
    this.stage.data.names.forEach((name, index) => {
      const look = isEnd && row.hit.includes(name) ? "reached" : touching.has(index) ? "touching" : "free";
      const isPoint = index < this.stage.data.points.length;
      const marks = isPoint ? [this.stage.point(index, k)] : shot.touches.filter((touch) => touch.point === index).map((touch) => this.stage.place(touch, k));
      for (const mark of marks) this.ball(mark, look === "free" ? 0.7 * BALL : BALL, COLORS[look]);
      const counts = look === "reached" || (look === "touching" && (touching.size <= FEW_NAMES || pressing.has(index)));
      if (!counts && !this.allNames) return;
      labels.push([marks[0] ?? this.namedPlace(index - this.stage.data.points.length, bodies), name, look === "free" ? "#777" : "#000"]);
    });
  }

  drawTouches(shot, pose, k) {
    for (const touch of shot.touches) {
      const place = this.stage.place(touch, k);
      const normal = rotated(pose.q, touch.normal);
      this.painter.draw("rod", along(place, normal, NORMAL, 0.3 * ROD), COLORS.normal);
      if (!touch.force) continue;
      const force = times(LONGEST_ARROW / this.stage.data.greatestForce, rotated(pose.q, touch.force));
      if (norm(force) > 0.01) this.painter.arrow(sub(place, force), place, ROD, COLORS.force);
    }
  }

  drawLoads(shot, pose, labels) {
    for (const load of this.stage.data.phases[shot.phase].loads) {
      const [start, end] = loadEnds(load, pose);
      if (load.kind === "spring") this.painter.polyline(coil(start, end), COLORS.load);
      else this.painter.arrow(start, end, 1.3 * ROD, COLORS.load);
      // A moment's arrow has two heads.
      if (load.kind === "moment") this.painter.arrow(start, add(start, times(SECOND_HEAD, sub(end, start))), 1.3 * ROD, COLORS.load);
      labels.push([load.kind === "spring" ? end : start, load.name, "#000"]);
    }
  }

  drawMotion(shot, pose, k) {
    const axis = this.stage.axis(shot.row, k);
    if (!axis) return;
    const { through, direction } = axis;
    if (!axis.turns) {
      const center = carried(pose, this.stage.data.center);
      this.painter.arrow(center, add(center, times(0.25, direction)), 0.8 * ROD, COLORS.axis);
      return;
    }
    const middle = add(through, times(-dot(through, direction), direction));
    const half = Math.sqrt(Math.max(0.04, this.stage.data.radius ** 2 - dot(middle, middle)));
    this.painter.draw("rod", along(add(middle, times(-half, direction)), direction, 2 * half, 0.5 * ROD), COLORS.axis);
    this.painter.arrow(add(middle, times(half, direction)), add(middle, times(half + 0.1, direction)), 0.6 * ROD, COLORS.axis);
  }

  drawTrace(time, k) {
    const { stage } = this;
    const way = stage.shots.slice(0, Math.floor(time) + 1).map((shot) => shot.pose).concat([stage.truePose(time)]);
    this.painter.polyline(way.map((pose) => carried(stage.shownPose(pose, k), stage.data.center)), COLORS.trace);
  }

  write(labels, scale) {
    const pen = this.overlay.getContext("2d");
    const height = 12 * scale;
    pen.font = `${height}px system-ui, sans-serif`;
    pen.clearRect(0, 0, this.overlay.width, this.overlay.height);
    labels.sort((one, other) => (one[2] !== "#000") - (other[2] !== "#000")); // of names that collide, contacts
    const corners = laidOut(labels.map(([place, text]) => ({ place: this.camera.project(place), size: [pen.measureText(text).width, height] })), scale);
    this.written = [];
    labels.forEach(([, text, color], which) => {
      if (!corners[which]) return;
      this.text(pen, text, corners[which][0], corners[which][1] + 0.85 * height, color, scale);
      this.written.push({ text, corner: corners[which], size: [pen.measureText(text).width, height] });
    });
    this.drawAxes(pen, scale);
    this.drawScale(pen, scale);
  }

  text(pen, text, x, y, color, scale) {
    pen.lineWidth = 3 * scale;
    pen.strokeStyle = "#f6f7f9";
    pen.strokeText(text, x, y);
    pen.fillStyle = color;
    pen.fillText(text, x, y);
  }

  drawAxes(pen, scale) {
    const [right, up] = this.camera.axes();
    const corner = [50 * scale, this.overlay.height - 50 * scale];
    [["x", "#d55e00"], ["y", "#009e73"], ["z", "#0072b2"]].forEach(([name, color], axis) => {
      const tip = [corner[0] + 30 * scale * right[axis], corner[1] - 30 * scale * up[axis]];
      pen.strokeStyle = color;
      pen.lineWidth = 2 * scale;
      pen.beginPath();
      pen.moveTo(...corner);
      pen.lineTo(...tip);
      pen.stroke();
      this.text(pen, name, tip[0] + 3 * scale, tip[1] - 2 * scale, color, scale);
    });
  }

  // Lengths of the object are true at every exaggeration; only its motion and the gaps are not.
  drawScale(pen, scale) {
    const { unitsPerDrawing, unit } = this.stage.data;
    const rough = 100 * scale / this.camera.perUnit() * unitsPerDrawing;
    const power = 10 ** Math.floor(Math.log10(rough));
    const length = power * [5, 2, 1].find((step) => step * power <= rough);
    const pixels = length / unitsPerDrawing * this.camera.perUnit();
    const [x, y] = [this.overlay.width - 20 * scale - pixels, this.overlay.height - 20 * scale];
    pen.strokeStyle = "#333";
    pen.lineWidth = 2 * scale;
    pen.strokeRect(x, y, pixels, 0);
    this.text(pen, `${+length.toPrecision(2)} ${unit}`, x, y - 6 * scale, "#333", scale);
  }
}

// Draws the stage at one time: the object, the cage, what touches and presses, what pushes, what it turns about.

import { BufferAttribute, BufferGeometry, Line, LineBasicMaterial, LineSegments } from "three";
import { add, carried, composed, cross, dot, inverse, norm, rotated, samePose, sub, times, turnedTo, unit } from "./geometry.js";
import { Camera } from "./camera.js";
import { contentOf, loadsOutside, wholeOf } from "./content.js";
import { Inset } from "./inset.js";
import { Cap, WallCuts } from "./caps.js";
import { color, Marks } from "./marks.js";
import { Overlay } from "./overlay.js";
import { elementAt, hitAt, PICKED } from "./picking.js";
import { Section } from "./section.js";
import { Body, Holes, Shape, Walls } from "./solids.js";
import { World } from "./world.js";

const RING = 16; // pixels about a contact that is looked at closely
const RANK = { hand: 7, gap: 6, load: 5, force: 3, touch: 2, free: 0 }; // which names choose their places first; among forces, great ones
const COILS = 7, COIL_POINTS = 8, STRAIGHT_ENDS = 0.15; // of a spring
const CLOSE_UP = 0.008, TILT = 0.25; // half the height of a picture of one contact, and how far from along its plane

export class Drawing {
  constructor(stage, exaggerations, gaps, canvas, overlay, { covered, changed, clicked, grabbed, turned }) {
    this.canvas = canvas;
    this.gaps = gaps;
    this.sizes = stage.data.look; // sizes, in pixels unless look.py says otherwise
    this.paint = Object.fromEntries(Object.entries(this.sizes.paint).map(([name, hex]) => [name, color(hex)]));
    this.world = new World(canvas, stage.data);
    this.marks = new Marks(this.sizes, this.world.isSoftware);
    this.trace = new Line(new BufferGeometry(), new LineBasicMaterial({ color: this.paint.trace }));
    this.ghost = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ color: this.paint.ghost }));
    for (const line of [this.trace, this.ghost]) line.frustumCulled = false;
    this.world.scene.add(this.marks.group, this.trace, this.ghost);
    this.overlay = new Overlay(overlay);
    this.section = new Section(this.paint.section);
    this.time = stage.shots.length - 1;
    this.pointLook = "pin";
    this.isGlass = false;
    this.take(stage, exaggerations);
    this.allNames = stage.data.names.length <= this.sizes.few_names;
    this.camera = new Camera(canvas, stage.data, { content: () => contentOf(this), leastDistance: () => (this.frame ? this.sizes.distance_of_eye * this.stage.data.radius : 0),
      under: (x, y) => this.under(x, y), covered, cutAway: () => this.section.normal, changed, clicked: (x, y) => clicked(this.touchAt(x, y), () => elementAt(this, x, y)),
      grabbed: (x, y) => {
        const handle = this.section.grab(x, y, this.camera, () => turned(this.section)), place = handle ? null : this.placeOnObject(x, y);
        return handle ?? (place && grabbed(place));
      } });
    this.inset = new Inset(stage.data, this.camera);
    this.camera.fit(); // with loads and forces, whose arrows have a camera by now
  }

  // Shows another run from now on, with the longest arrow of each phase for so much force.
  take(stage, exaggerations, greatestForces = stage.data.phases.map((phase) => phase.greatestForce)) {
    this.exaggerations = exaggerations; // of each phase; its owner changes them
    this.greatestForces = greatestForces;
    const { data } = stage;
    if (this.stage) { // where the origin of drawing coordinates was, and their unit
      const [before, size] = [this.stage.middle(), this.stage.data.unitsPerDrawing];
      this.camera.rebase((place) => times(1 / data.unitsPerDrawing, sub(add(before, times(size, place)), stage.middle())), size / data.unitsPerDrawing);
    }
    this.stage = stage;
    this.world.data = data;
    const { forms, parts, holes, bodies, cageHoles } = data;
    const made = JSON.stringify([forms, parts, ...[holes, bodies, cageHoles].map((list) => list.map(({ form, open }) => [form, open]))]);
    if (made !== this.made) this.build(data); // most sliders leave all shapes as they are
    this.made = made;
    this.out = stage.data.points.map((_, index) => {
      const gap = data.gaps[data.phases[0].reference][index];
      return norm(gap) > 1e-9 ? unit(gap) : null;
    });
    const middle = times(1 / (data.points.length || 1), data.points.reduce(add, [0, 0, 0]));
    this.pin = Math.min(this.sizes.pin, this.sizes.pin_of_cage * Math.max(0, ...data.points.map((point) => norm(sub(point, middle)))) || this.sizes.pin);
    this.layGround();
  }

  build(data) {
    const { paint, world: { isSoftware } } = this;
    this.built = (this.built ?? 0) + 1;
    this.world.scene.remove(...(this.things ?? []).map((thing) => thing.group));
    this.holes = new Holes(data.holes, data.forms);
    this.cageHoles = new Holes(data.cageHoles, data.forms);
    this.object = new Body(new Shape(data.parts, data.forms), this.holes, { face: paint.object, edge: paint.objectEdge }, isSoftware);
    const shapes = new Map([...new Set(data.bodies.map(({ form }) => form))].map((form) => [form, new Shape([{ form, position: [0, 0, 0], quaternion: [1, 0, 0, 0] }], data.forms)]));
    this.bodies = data.bodies.map(({ form }) => new Body(shapes.get(form), this.cageHoles, { face: paint.cage, edge: paint.cageEdge }, isSoftware));
    this.walls = new Walls(data.holes, data.forms, { face: paint.objectWall, edge: paint.objectEdge });
    this.cageWalls = new Walls(data.cageHoles, data.forms, { face: paint.cageWall, edge: paint.cageEdge });
    this.caps = [this.object, ...this.bodies].map((body, which) => (which
      ? new Cap(body, this.cageHoles, { face: paint.cage, edge: paint.cageEdge }, 0, which % 2 ? -1 : 1)
      : new Cap(body, this.holes, { face: paint.object, edge: paint.objectEdge }, 1, 1)));
    this.wallCuts = [new WallCuts(this.walls, paint.objectEdge), new WallCuts(this.cageWalls, paint.cageEdge)];
    this.solids = [this.object, ...this.bodies, this.walls, this.cageWalls];
    this.things = [...this.solids, ...this.caps, ...this.wallCuts];
    this.world.scene.add(...this.things.map((thing) => thing.group));
    this.glaze(this.isGlass);
  }

  // Whether the object is seen through; bodies of the cage that would hide it always are, unless they are cut open.
  glaze(isGlass) {
    this.isGlass = isGlass;
    this.object.seeThrough(isGlass ? this.sizes.seen_through : 1);
    const reach = this.object.reach, isCut = Boolean(this.section.plane);
    for (const body of this.bodies) body.seeInto(!isCut && body.reach > this.sizes.large * reach ? this.sizes.glass : 1);
    const planes = isCut ? this.section.three : null;
    for (const solid of this.solids) solid.clip(planes);
    this.marks.clip(planes);
  }

  // Cuts across an axis, through the middle of the object; null: nothing is cut.
  cut(axis) {
    this.section.choose(axis, carried(this.shown(this.time).pose, this.stage.data.center), this.stage.data.radius, this.camera.axes()[2]);
    this.glaze(this.isGlass);
  }

  layGround() {
    const { stage } = this;
    const heights = (body, pose) => body.outer.map((corner) => carried(pose, corner)[2]);
    const corners = [0, stage.shots.length - 1].flatMap((time) => heights(this.object, this.shown(time).pose));
    const look = this.shown(stage.shots.length - 1).look;
    const bodies = this.everyBody().flatMap(([body, at]) => heights(body, at));
    const points = stage.data.points.map((_, index) => stage.point(index, look)[2] - (this.pointLook === "pin" ? this.pin : 0));
    const low = [...corners, ...bodies, ...points].reduce((least, height) => Math.min(least, height), 0);
    this.world.layGround(low - this.sizes.below);
  }

  // The bodies of the cage with the poses at which they are shown at the end; those that are driven, wherever they were.
  everyBody() {
    const { stage } = this;
    const looks = [...new Set([...stage.cageTimes(), stage.shots.length - 1])].map((time) => this.shown(time).look);
    return this.bodies.flatMap((body, index) => {
      const isDriven = stage.data.elementBodies[stage.data.points.length + index] > 0;
      return (isDriven ? looks : looks.slice(-1)).map((look) => [body, stage.bodyPose(index, look)]);
    });
  }

  // The look of a time, and the pose of the object then.
  shown(time) {
    const look = this.stage.look(time, this.exaggerations);
    return { look, pose: this.stage.pose(this.stage.truePose(time), look) };
  }

  draw(time) {
    this.time = time;
    const { stage, camera } = this;
    const shot = stage.shot(time);
    const { look, pose } = this.shown(time);
    this.labels = [];
    this.marks.begin(camera);
    this.object.show(pose, camera);
    this.bodies.forEach((body, index) => body.show(stage.bodyPose(index, look), camera));
    this.showHoles(look, pose);
    this.section.update(camera);
    for (const cut of [...this.caps, ...this.wallCuts]) cut.show(this.section.plane, camera);
    this.drawPoints(shot, look, pose);
    this.drawTouches(shot, look, pose);
    this.drawLoads(shot, look, pose);
    this.drawMotion(shot, pose);
    this.drawTrace(time);
    this.section.draw(this.marks, camera, this.sizes);
    if (!camera.isClose()) this.marks.ball(carried(pose, stage.data.center), this.sizes.ball - 1, this.paint.trace);
    this.marks.end();
    const scale = window.devicePixelRatio;
    this.inset.update(wholeOf(this));
    this.world.draw(camera, scale, this.inset);
    const pull = this.pulling(pose);
    if (pull) this.labels.push({ place: pull.tip, text: this.hand.text, rank: RANK.hand });
    const dimensions = this.gaps.dimensions(time, look, pose).filter(({ ends }) => !ends.every((end) => this.section.isCutAway(end)));
    for (const { ends, text } of dimensions) this.labels.push({ place: times(0.5, add(...ends)), text, rank: RANK.gap, color: this.sizes.paint.gap });
    this.overlay.write(this.labels, dimensions, camera, stage.data, scale, this.inset.box);
    if (this.inset.isShown) this.inset.draw(this.overlay, loadsOutside(this, shot, look, pose));
    if (pull) this.overlay.arrow(camera.project(pull.at), camera.project(pull.tip), this.sizes.paint.hand);
  }

  get written() {
    return this.overlay.written;
  }

  showHoles(look, pose) {
    const { holes, cageHoles, bodies } = this.stage.data;
    const wider = ({ play }) => (look.factor - 1) * play;
    const poses = holes.map(({ position, quaternion }) => composed(pose, { p: position, q: quaternion }));
    const cagePoses = cageHoles.map((_, index) => this.stage.bodyPose(bodies.length + index, look));
    for (const [cuts, walls, at, list] of [[this.holes, this.walls, poses, holes], [this.cageHoles, this.cageWalls, cagePoses, cageHoles]]) {
      cuts.place(at, list.map(wider), this.camera.target);
      walls.show(at, list.map(wider), this.camera);
    }
  }

  // Brings what moves and touches into view, as it is exaggerated now, or all.
  fit(isWhole = false) {
    this.isWhole = isWhole;
    this.layGround();
    this.camera.fit();
  }

  // A view by its name, of what moves and touches.
  home(name) {
    this.isWhole = false;
    this.camera.home(name);
  }

  // Where a load's arrow starts and ends: that of a force ends where it acts, that of a moment starts at the centre of
  // gravity; a spring leads to where it is held, or part of the way.
  loadEnds(load, { cage, truth }, pose) {
    const at = carried(pose, load.atWorld ? carried(inverse(truth), load.atWorld) : load.at);
    if (load.kind === "spring") {
      const way = sub(carried(cage[load.body], load.to), at);
      return [at, add(at, times(Math.min(1, this.sizes.longest_spring / (norm(way) || 1)), way))];
    }
    const arrow = times(this.sizes.load * this.camera.pixel(at), load.follows ? rotated(pose.q, load.direction) : load.direction);
    return load.kind === "moment" ? [at, add(at, arrow)] : [sub(at, arrow), at];
  }

  // The longest arrow is that of the greatest force of the phase, and none is too short to be seen. Close by, an arrow ends
  // where the ring about the contact begins.
  forceArrow(touch, phase, pose, look) {
    const place = this.stage.place(touch, look);
    const pixel = this.camera.pixel(place);
    const length = this.arrowPixels(touch, phase);
    const force = times(length && length * pixel / norm(touch.force), rotated(pose.q, touch.force));
    const tip = this.camera.isClose() && norm(force) ? sub(place, times(RING * pixel / norm(force), force)) : place;
    return [sub(tip, force), tip];
  }

  // Of the greatest force of a phase.
  share(touch, phase) {
    return touch.force ? norm(touch.force) / this.greatestForces[phase] : 0;
  }

  // How long its arrow is, in pixels if it is seen from the side.
  arrowPixels(touch, phase) {
    const share = this.share(touch, phase);
    return share > this.sizes.least_force ? Math.max(this.sizes.force * share, this.sizes.shortest_force) : 0;
  }

  drawPoints(shot, look, pose) {
    const { stage, marks } = this;
    const { data } = stage;
    const touching = new Set(shot.touches.map((touch) => touch.point));
    const row = data.rows[shot.row];
    const isEnd = row && stage.shots[row.last] === shot;
    const pressing = new Set(shot.touches.filter((touch) => this.share(touch, shot.phase) > this.sizes.least_force).map((touch) => touch.point));
    data.names.forEach((name, index) => {
      const kind = isEnd && row.hit.includes(name) ? "reached" : touching.has(index) ? "touching" : "free";
      const isPoint = index < data.points.length;
      const point = isPoint && stage.point(index, look);
      const places = isPoint ? [point] : shot.touches.filter((touch) => touch.point === index).map((touch) => stage.place(touch, look));
      if (isPoint && this.pointLook === "pin") this.drawPin(point, this.outOf(index, shot, pose));
      if (kind !== "free" || this.pointLook === "ball") places.forEach((place) => this.mark(place, kind));
      if (pressing.has(index)) return; // it is named at its arrows
      const counts = kind === "reached" || (kind === "touching" && touching.size <= this.sizes.few_names);
      const named = places[0] ?? this.namedPlace(index - data.points.length, look);
      if (counts || (this.allNames && !this.section.isCutAway(named))) this.labels.push({ place: named, text: name, rank: kind === "free" ? RANK.free : RANK.touch });
    });
  }

  // Away from the object: along the gap, or along the normal where it touches.
  outOf(index, shot, pose) {
    this.out[index] ??= (() => {
      const touch = shot.touches.find(({ point }) => point === index);
      return touch ? rotated(pose.q, touch.normal) : null;
    })();
    return this.out[index] ?? [0, 0, -1];
  }

  drawPin(place, out) {
    this.marks.put("pin", place, turnedTo(out), [this.sizes.pin_slope * this.pin, this.pin], this.paint.pin);
  }

  mark(place, kind) {
    if (this.camera.isClose()) this.marks.ring(place, RING, this.paint[kind]);
    else this.marks.ball(place, kind === "free" ? this.sizes.free_ball : this.sizes.ball, this.paint[kind]);
  }

  // Where a shape or a hole of the cage that touches nothing has its name: in the middle of what is shown of it.
  namedPlace(index, look) {
    const { bodies } = this.stage.data;
    const pose = this.stage.bodyPose(index, look);
    if (index >= bodies.length) return pose.p;
    const places = this.bodies[index].ends.map((corner) => (this.cutOff ?? ((place) => place))(carried(pose, corner)));
    return times(1 / places.length, places.reduce(add));
  }

  drawTouches(shot, look, pose) {
    for (const touch of shot.touches) {
      const place = this.stage.place(touch, look);
      const normal = times(this.sizes.normal * this.camera.pixel(place), rotated(pose.q, touch.normal));
      if (!this.camera.isClose()) this.marks.rod(place, add(place, normal), this.sizes.thin, this.paint.normal);
      const share = this.share(touch, shot.phase), { names, phases } = this.stage.data;
      if (share <= this.sizes.least_force) continue;
      const [tail, tip] = this.forceArrow(touch, shot.phase, pose, look);
      this.marks.arrow(tail, tip, this.sizes.rod, this.paint.force);
      const force = touch.words.replace(/ friction$/, "") + (phases[shot.phase].forceUnit === "N" ? " N" : "");
      this.labels.push({ place: tail, text: names[touch.point], force, rank: RANK.force + share });
    }
  }

  drawLoads(shot, look, pose) {
    for (const load of this.stage.data.phases[shot.phase].loads) {
      const [start, end] = this.loadEnds(load, look, pose);
      if (load.kind === "spring") this.drawCoil(start, end);
      else this.marks.arrow(start, end, 1.3 * this.sizes.rod, this.paint.load);
      // A moment's arrow has two heads.
      if (load.kind === "moment") this.marks.arrow(start, add(start, times(this.sizes.second_head, sub(end, start))), 1.3 * this.sizes.rod, this.paint.load);
      this.labels.push({ place: load.kind === "spring" ? end : start, text: load.name, rank: RANK.load });
    }
  }

  // Where a hand holds the object, and where it pulls to; null: it does not. It is as far off as that, so that the arrow is as
  // long as the way of the pointer.
  pulling(pose) {
    if (!this.hand) return null;
    const at = carried(pose, this.hand.at);
    return { at, tip: add(at, times(this.camera.pixel(at), this.hand.pull)) };
  }

  // A spring, as a line that winds.
  drawCoil(start, end) {
    const way = sub(end, start);
    if (norm(way) === 0) return;
    const aside = unit(cross(way, Math.abs(way[2]) < 0.9 * norm(way) ? [0, 0, 1] : [1, 0, 0]));
    const up = unit(cross(way, aside));
    const radius = this.sizes.coil * this.camera.pixel(start);
    const on = (share) => add(start, times(share, way));
    const wound = Array.from({ length: COILS * COIL_POINTS + 1 }, (_, k) => {
      const turn = 2 * Math.PI * k / COIL_POINTS;
      const axis = on(STRAIGHT_ENDS + (1 - 2 * STRAIGHT_ENDS) * k / (COILS * COIL_POINTS));
      return add(axis, add(times(radius * Math.cos(turn), aside), times(radius * Math.sin(turn), up)));
    });
    const line = [start, on(STRAIGHT_ENDS), ...wound, on(1 - STRAIGHT_ENDS), end];
    line.slice(1).forEach((place, index) => this.marks.rod(line[index], place, this.sizes.thin, this.paint.load));
  }

  drawMotion(shot, pose) {
    const axis = this.stage.axis(shot.row, this.exaggerations);
    if (!axis || this.camera.isClose()) return;
    const { through, direction } = axis;
    if (!axis.turns) {
      const center = carried(pose, this.stage.data.center);
      this.marks.arrow(center, add(center, times(this.sizes.travel * this.camera.pixel(center), direction)), this.sizes.rod, this.paint.axis);
      return;
    }
    const middle = add(through, times(-dot(through, direction), direction));
    const half = Math.sqrt(Math.max(0.04, this.stage.data.radius ** 2 - dot(middle, middle)));
    this.marks.arrow(add(middle, times(-half, direction)), add(middle, times(half, direction)), 0.6 * this.sizes.rod, this.paint.axis);
  }

  // The way of the centre of gravity, and where the object and bodies of the cage that have been driven started.
  drawTrace(time) {
    const { stage, camera, trace, ghost } = this;
    const center = (moment) => carried(this.shown(moment).pose, stage.data.center);
    const told = [stage, ...this.exaggerations];
    if (told.some((value, i) => value !== this.way?.told[i])) this.way = { told, places: stage.shots.map((_, index) => center(index)) };
    fill(trace, [...this.way.places.slice(0, Math.floor(time) + 1), center(time)]);
    trace.position.set(...sub([0, 0, 0], camera.target));
    const { pose: start, look } = this.shown(0);
    const back = inverse(start), outlined = (body, pose) => body.outline(carried(inverse(pose), camera.eye())).map((place) => carried(composed(back, pose), place));
    const { cage } = this.shown(time).look;
    const driven = this.bodies.filter((_, index) => {
      const body = stage.data.elementBodies[stage.data.points.length + index];
      return body > 0 && !samePose(cage[body], look.cage[body]);
    });
    fill(ghost, [...this.object.outline(carried(back, camera.eye())), ...driven.flatMap((body) => outlined(body, stage.bodyPose(this.bodies.indexOf(body), look)))]);
    ghost.position.set(...sub(start.p, camera.target));
    ghost.quaternion.set(start.q[1], start.q[2], start.q[3], start.q[0]);
    trace.visible = ghost.visible = !camera.isClose();
  }

  // What is clicked: the contact whose mark is nearest to a pixel, or null.
  touchAt(x, y) {
    const { look } = this.shown(this.time);
    const near = this.stage.shot(this.time).touches.map((touch) => {
      const [across, down] = this.camera.project(this.stage.place(touch, look));
      return { touch, apart: Math.hypot(across - x, down - y) };
    }).sort((one, other) => one.apart - other.apart);
    return near.length && near[0].apart < PICKED ? near[0].touch : null;
  }

  // The place of the object that is seen at a pixel, be it through a body of glass; null: it is not seen there.
  placeOnObject(x, y) {
    if (this.section.plane) {
      const { which, nearest, from, direction } = hitAt(this, x, y);
      return which === -1 ? add(this.camera.target, add(from, times(nearest, direction))) : null;
    }
    const [from, direction] = this.camera.ray(x, y);
    const nearest = this.object.hit(from, direction);
    const isHidden = this.bodies.some((body) => !body.isGlass && body.hit(from, direction) < nearest);
    return Number.isFinite(nearest) && !isHidden ? add(this.camera.target, add(from, times(nearest, direction))) : null;
  }

  // A place of the object that is shown, in its own frame.
  inObject(place) {
    return carried(inverse(this.shown(this.time).pose), place);
  }

  // What is seen at a pixel: a mark's place, or that of a body.
  under(x, y) {
    const touch = this.touchAt(x, y);
    if (touch) return this.stage.place(touch, this.shown(this.time).look);
    const { nearest, from, direction } = hitAt(this, x, y);
    return Number.isFinite(nearest) ? add(this.camera.target, add(from, times(nearest, direction))) : null;
  }

  // Goes to a contact, and looks along its plane, from where the object and what it touches can both be seen.
  zoomTo(touch) {
    const { look, pose } = this.shown(this.time);
    const place = this.stage.place(touch, look);
    const normal = rotated(pose.q, touch.normal);
    const flat = (way) => sub(way, times(dot(way, normal), normal));
    const ways = [sub(place, carried(pose, this.stage.data.center)), this.camera.axes()[2], [0.3, -1, 0.2], [1, 0.3, 0]].map(flat);
    const along = unit(ways.find((way) => norm(way) > 1e-3));
    const isPoint = touch.point < this.stage.data.points.length;
    this.camera.lookAt(place, unit(add(along, times(isPoint ? TILT : -TILT, normal))), CLOSE_UP);
  }
}

// Tells a line its places. It keeps its buffer while that is long enough.
function fill({ geometry }, places) {
  if (!(geometry.attributes.position?.count >= places.length)) {
    geometry.dispose();
    geometry.setAttribute("position", new BufferAttribute(new Float32Array(6 * places.length), 3));
  }
  const { position } = geometry.attributes;
  places.forEach(([x, y, z], index) => position.setXYZ(index, x, y, z));
  position.needsUpdate = true;
  geometry.setDrawRange(0, places.length);
}

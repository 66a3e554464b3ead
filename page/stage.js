// What is shown of the data at a time, each phase exaggerated by a number of its own. The same formulas as in stage.py.

import { digits } from "./words.js";
import { add, between, carried, composed, conjugate, dot, fromTurnVector, inverse, norm, product, rotated, sub, times, turnVector } from "./geometry.js";

const LEAST_SEEN = 1e-6; // drawing units, radians: less is not seen

export class Stage {
  constructor(data) {
    this.data = data;
    const cages = data.cages.map((cage) => cage.map(({ position, quaternion }) => ({ p: position, q: quaternion })));
    const touches = data.touches.map(({ points, boxes, normals, forces, words, places, friction }) =>
      points.map((point, i) => ({ point, box: boxes[i], normal: normals[i], force: forces && forces[i], words: words && words[i],
        friction: friction && friction[i], place: places ? places[i] : data.points[point] })));
    const moves = cages.length > 1;
    this.shots = data.shots.map((s) => ({ row: s.row, phase: s.phase, pose: { p: s.position, q: s.quaternion }, cage: cages[s.cage],
      touches: moves ? touches[s.touches].map((touch) => ({ ...touch, cage: cages[s.cage] })) : touches[s.touches] }));
  }

  // The origin of drawing coordinates, in the scene's own.
  middle() {
    const { origin, position } = this.data.shots[0];
    return sub(origin, times(this.data.unitsPerDrawing, position));
  }

  // The true pose at a time that may lie between two shots.
  truePose(time) {
    const before = Math.floor(time);
    const after = Math.min(before + 1, this.shots.length - 1);
    return between(this.shots[before].pose, this.shots[after].pose, time - before);
  }

  // How what stands still and each body of the cage is displaced at a time from its start.
  cage(time) {
    const before = this.shots[Math.floor(time)].cage, after = this.shots[Math.ceil(time)].cage;
    return before === after ? before : before.map((pose, body) => between(pose, after[body], time - Math.floor(time)));
  }

  // How much of its phase's drive is done at a time, and the force along it; null: it has not begun.
  drive(time) {
    const before = this.data.shots[Math.floor(time)], after = this.data.shots[Math.ceil(time)];
    if (after.along === null) return null;
    const mixed = (key) => (before.phase === after.phase && before[key] !== null ? before[key] + (time - Math.floor(time)) * (after[key] - before[key]) : after[key]);
    return { share: mixed("share"), along: mixed("along") };
  }

  // The first shot and the ends of events at which bodies of the cage are elsewhere than before.
  cageTimes() {
    const ends = [0, ...this.data.rows.map((row) => row.last)];
    return ends.filter((time, index) => index === 0 || this.shots[time].cage !== this.shots[ends[index - 1]].cage);
  }

  // Between two shots, what goes on is what the later one tells.
  shot(time) {
    return this.shots[Math.ceil(time)];
  }

  phaseAt(time) {
    return this.data.phases.findIndex((phase) => time <= phase.last);
  }

  // How a moment is shown: exaggerated by `factor`, from the pose of the shot `reference`, with bodies where they are then.
  look(time, exaggerations) {
    return { ...this.exaggerated(time, exaggerations), cage: this.cage(time), truth: this.truePose(time) };
  }

  exaggerated(time, exaggerations) {
    const { phases, ease } = this.data;
    const index = this.phaseAt(time);
    const phase = phases[index], ended = phases[index - 1];
    const passing = (factor, other, first, last) => {
      const room = Math.min(Math.max(1, ease), last - first);
      return factor + (other - factor) * (room ? Math.min(1, (time - first) / room) : 1);
    };
    let before = { reference: 0, factor: phase.start === 0 ? exaggerations[0] : 1 };
    if (ended) before = { reference: ended.reference, factor: ended.start < ended.last ? exaggerations[index - 1] : 1 };
    if (phase.start > phase.first) { // a long motion
      if (time <= phase.start) return { reference: before.reference, factor: passing(before.factor, 1, phase.first, phase.start) };
      before.factor = 1;
    }
    return { reference: phase.reference, factor: passing(before.factor, exaggerations[index], phase.start, phase.last) };
  }

  // Whether anything of a look is larger than it is: where nothing has moved and all touches, nothing is.
  isMagnified(time, look) {
    if (look.factor === 1) return false;
    const { data } = this, pose = this.pose(look.truth, look);
    const ways = [sub(carried(pose, data.center), carried(look.truth, data.center)), turnVector(look.truth.q, pose.q), ...data.elementBodies.map((_, element) => this.shift(element, look))];
    const plays = [...data.holes, ...data.cageHoles].map(({ play }) => (look.factor - 1) * play);
    return ways.some((way) => norm(way) > LEAST_SEEN) || plays.some((play) => play > LEAST_SEEN);
  }

  pose(pose, { reference, factor }) {
    if (factor === 1) return pose;
    const start = this.shots[reference].pose;
    const center = this.data.center;
    const before = carried(start, center);
    const q = product(fromTurnVector(times(factor, turnVector(start.q, pose.q))), start.q);
    const middle = add(before, times(factor, sub(carried(pose, center), before)));
    return { p: sub(middle, rotated(q, center)), q };
  }

  // How far a point, a shape or a hole of the cage is moved from its place, so that its gap to the object shows k times.
  shift(element, { reference, factor }) {
    if (factor === 1) return [0, 0, 0];
    const gap = this.data.gaps[reference][element];
    const room = this.data.elementBodies[element] > 0 ? Math.max(this.data.mostWay - norm(gap), 0) : this.data.mostAdded;
    const most = norm(gap) === 0 ? 0 : room / norm(gap);
    return times(Math.min(factor - 1, most), gap);
  }

  // How an element of the cage is displaced from its start.
  displaced(element, { cage }) {
    return cage[this.data.elementBodies[element]];
  }

  point(index, look) {
    return add(carried(this.displaced(index, look), this.data.points[index]), this.shift(index, look));
  }

  // Where a touch is shown: along with the body that it is on; on the wall of a hole of the cage, as far out as that is.
  place(touch, look) {
    const displaced = this.displaced(touch.point, look);
    const at = touch.cage ? carried(composed(displaced, inverse(this.displaced(touch.point, touch))), touch.place) : touch.place;
    const place = add(at, this.shift(touch.point, look));
    const start = this.data.cageHoles[touch.point - this.data.points.length - this.data.bodies.length];
    if (!start) return place;
    const { p: position, q: quaternion } = composed(displaced, { p: start.position, q: start.quaternion });
    const hole = { position, quaternion, play: start.play };
    const [x, y] = rotated(conjugate(hole.quaternion), sub(at, hole.position));
    const out = (look.factor - 1) * hole.play / (Math.hypot(x, y) || 1);
    return add(place, rotated(hole.quaternion, [out * x, out * y, 0]));
  }

  // The poses at which the shapes of the cage are shown, and its holes behind them.
  bodyPose(index, look) {
    const { bodies, cageHoles, points } = this.data;
    const { position, quaternion } = bodies[index] ?? cageHoles[index - bodies.length];
    const at = composed(this.displaced(points.length + index, look), { p: position, q: quaternion });
    return { p: add(at.p, this.shift(points.length + index, look)), q: at.q };
  }

  // The line a motion turns about, carried by the object as it is shown when the motion begins.
  axis(row, exaggerations) {
    const motion = this.data.rows[row]?.line;
    if (!motion) return null;
    const before = this.data.rows[row].first - 1;
    const pose = this.pose(this.shots[before].pose, this.look(before, exaggerations));
    return { through: carried(pose, motion.through), direction: rotated(pose.q, motion.direction), turns: motion.turns };
  }

  // A contact by its names, and by its place if another one of some has the same.
  naming(touch, touches) {
    const { names, unitsPerDrawing } = this.data, name = `${names[touch.point]} on ${touch.box}`;
    if (touches.filter(({ point, box }) => point === touch.point && box === touch.box).length < 2) return name;
    const place = add(this.middle(), times(unitsPerDrawing, touch.place));
    return `${name} at (${place.map((value) => digits(+value.toPrecision(4), 1e-9 * unitsPerDrawing)).join(", ")})`;
  }

  // Along the normal and across it, of the force of a touch.
  parts({ force, normal }) {
    const along = -dot(force, normal);
    return { normal: along, across: norm(add(force, times(along, normal))) };
  }
}

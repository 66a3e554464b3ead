// What is shown of the data at a time, each phase exaggerated by a number of its own. The same formulas as in stage.py.

import { add, between, carried, conjugate, dot, fromTurnVector, norm, product, rotated, sub, times, turnVector } from "./geometry.js";

export class Stage {
  constructor(data) {
    this.data = data;
    const touches = data.touches.map(({ points, boxes, normals, forces, places, gaps, friction }) =>
      points.map((point, i) => ({ point, box: boxes[i], normal: normals[i], force: forces && forces[i], gap: gaps && gaps[i],
        friction: friction && friction[i], place: places ? places[i] : data.points[point] })));
    this.shots = data.shots.map((s) => ({ row: s.row, phase: s.phase, pose: { p: s.position, q: s.quaternion }, touches: touches[s.touches] }));
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

  // Between two shots, what goes on is what the later one tells.
  shot(time) {
    return this.shots[Math.ceil(time)];
  }

  phaseAt(time) {
    return this.data.phases.findIndex((phase) => time <= phase.last);
  }

  // How a moment is shown: exaggerated by `factor`, from the pose of the shot `reference`.
  look(time, exaggerations) {
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
    const most = norm(gap) === 0 ? 0 : this.data.mostAdded / norm(gap);
    return times(Math.min(factor - 1, most), gap);
  }

  point(index, look) {
    return add(this.data.points[index], this.shift(index, look));
  }

  // Where a touch is shown; on the wall of a hole of the cage, as far out as that is.
  place(touch, look) {
    const place = add(touch.place, this.shift(touch.point, look));
    const hole = this.data.cageHoles[touch.point - this.data.points.length - this.data.bodies.length];
    if (!hole) return place;
    const [x, y] = rotated(conjugate(hole.quaternion), sub(touch.place, hole.position));
    const out = (look.factor - 1) * hole.play / (Math.hypot(x, y) || 1);
    return add(place, rotated(hole.quaternion, [out * x, out * y, 0]));
  }

  // The poses at which the shapes of the cage are shown, and its holes behind them.
  bodyPose(index, look) {
    const { bodies, cageHoles, points } = this.data;
    const { position, quaternion } = bodies[index] ?? cageHoles[index - bodies.length];
    return { p: add(position, this.shift(points.length + index, look)), q: quaternion };
  }

  // The line a motion turns about, carried by the object as it is shown when the motion begins.
  axis(row, exaggerations) {
    const motion = this.data.rows[row]?.line;
    if (!motion) return null;
    const before = this.data.rows[row].first - 1;
    const pose = this.pose(this.shots[before].pose, this.look(before, exaggerations));
    return { through: carried(pose, motion.through), direction: rotated(pose.q, motion.direction), turns: motion.turns };
  }

  // Along the normal and across it, of the force of a touch.
  parts({ force, normal }) {
    const along = -dot(force, normal);
    return { normal: along, across: norm(add(force, times(along, normal))) };
  }
}

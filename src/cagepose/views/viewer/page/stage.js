// What is shown of the data at a time and an exaggeration. The same formulas as in stage.py.

class Stage {
  constructor(data) {
    this.data = data;
    const touches = data.touches.map(({ points, boxes, normals, forces, places }) =>
      points.map((point, i) => ({ point, box: boxes[i], normal: normals[i], force: forces && forces[i], place: places ? places[i] : data.points[point] })));
    this.shots = data.shots.map((s) => ({ row: s.row, phase: s.phase, pose: { p: s.position, q: s.quaternion }, touches: touches[s.touches] }));
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

  shownPose(pose, k) {
    if (k === 1) return pose;
    const start = this.shots[0].pose;
    const center = this.data.center;
    const before = carried(start, center);
    const q = product(fromTurnVector(times(k, turnVector(start.q, pose.q))), start.q);
    const middle = add(before, times(k, sub(carried(pose, center), before)));
    return { p: sub(middle, rotated(q, center)), q };
  }

  // How far a point or a shape of the cage is moved from its place, so that its gap to the object shows k times.
  shift(element, k) {
    const gap = this.data.gaps[element];
    const most = norm(gap) === 0 ? 0 : this.data.mostAdded / norm(gap);
    return times(Math.min(k - 1, most), gap);
  }

  point(index, k) {
    return add(this.data.points[index], this.shift(index, k));
  }

  // Where a touch is shown.
  place(touch, k) {
    return add(touch.place, this.shift(touch.point, k));
  }

  // The poses at which the shapes of the cage are shown.
  bodyPose(index, k) {
    const { position, quaternion } = this.data.bodies[index];
    return { p: add(position, this.shift(this.data.points.length + index, k)), q: quaternion };
  }

  // The line a motion turns about, carried by the object as it is shown when the motion begins.
  axis(row, k) {
    const motion = this.data.rows[row]?.line;
    if (!motion) return null;
    const pose = this.shownPose(this.shots[this.data.rows[row].first - 1].pose, k);
    return { through: carried(pose, motion.through), direction: rotated(pose.q, motion.direction), turns: motion.turns };
  }
}

// What is shown of the data at a time and an exaggeration. The same formulas as in stage.py.

class Stage {
  constructor(data) {
    this.data = data;
    const touches = data.touches.map(({ points, boxes, normals, forces }) =>
      points.map((point, i) => ({ point, box: boxes[i], normal: normals[i], force: forces && forces[i] })));
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

  point(index, k) {
    const gap = sub(this.data.points[index], this.data.feet[index]);
    const most = norm(gap) === 0 ? 0 : this.data.mostAdded / norm(gap);
    return add(this.data.points[index], times(Math.min(k - 1, most), gap));
  }

  // The line a motion turns about, carried by the object as it is shown when the motion begins.
  axis(row, k) {
    const motion = this.data.rows[row]?.line;
    if (!motion) return null;
    const pose = this.shownPose(this.shots[this.data.rows[row].first - 1].pose, k);
    return { through: carried(pose, motion.through), direction: rotated(pose.q, motion.direction), turns: motion.turns };
  }
}

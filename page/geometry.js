// Vectors are arrays of 3, quaternions [w, x, y, z] of unit length, poses {p, q}. All in double precision: a picture may
// show a millionth of the scene.

export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const times = (k, a) => [k * a[0], k * a[1], k * a[2]];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const norm = (a) => Math.hypot(...a);
export const unit = (a) => times(1 / norm(a), a);

export const product = (a, b) => [
  a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
  a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
  a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
  a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
];
export const conjugate = (q) => [q[0], -q[1], -q[2], -q[3]];
export const rotated = (q, v) => product(product(q, [0, ...v]), conjugate(q)).slice(1);
export const carried = (pose, v) => add(rotated(pose.q, v), pose.p);
export const inverse = (pose) => ({ p: times(-1, rotated(conjugate(pose.q), pose.p)), q: conjugate(pose.q) });
export const samePose = (a, b) => a === b || [0, 1, 2].every((i) => a.p[i] === b.p[i]) && a.q.every((value, i) => value === b.q[i]);
export const composed = (outer, inner) => ({ p: carried(outer, inner.p), q: product(outer.q, inner.q) });

// Axis times angle of the turn from one orientation to another, at most half a turn.
export function turnVector(from, to) {
  let q = product(to, conjugate(from));
  if (q[0] < 0) q = q.map((value) => -value);
  const sine = Math.hypot(q[1], q[2], q[3]);
  return sine === 0 ? [0, 0, 0] : times(2 * Math.atan2(sine, q[0]) / sine, q.slice(1));
}

export function fromTurnVector(v) {
  const angle = norm(v);
  return angle === 0 ? [1, 0, 0, 0] : [Math.cos(angle / 2), ...times(Math.sin(angle / 2) / angle, v)];
}

// Poses of neighbouring shots differ little, so the straight way between quaternions will do.
export function between(a, b, fraction) {
  const sign = a.q.reduce((sum, value, i) => sum + value * b.q[i], 0) < 0 ? -1 : 1;
  const q = a.q.map((value, i) => (1 - fraction) * value + fraction * sign * b.q[i]);
  const length = Math.hypot(...q);
  return { p: add(times(1 - fraction, a.p), times(fraction, b.p)), q: q.map((value) => value / length) };
}

// The orientation of a thing that lies along z, laid along a direction.
export function turnedTo(direction) {
  const [x, y, z] = direction;
  if (z < -1 + 1e-12) return [0, 1, 0, 0];
  const q = [1 + z, -y, x, 0];
  const length = Math.hypot(...q);
  return q.map((value) => value / length);
}

// Two unit vectors in a plane, so that the normal is the third.
export function across(normal) {
  const one = unit(cross(Math.abs(normal[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0], normal));
  return [one, cross(normal, one)];
}

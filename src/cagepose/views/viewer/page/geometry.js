// Vectors are arrays of 3, quaternions [w, x, y, z] of unit length, poses {p, q}, matrices 16 numbers by columns.

const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const times = (k, a) => [k * a[0], k * a[1], k * a[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const norm = (a) => Math.hypot(...a);
const unit = (a) => times(1 / norm(a), a);

const product = (a, b) => [
  a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
  a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
  a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
  a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
];
const conjugate = (q) => [q[0], -q[1], -q[2], -q[3]];
const rotated = (q, v) => product(product(q, [0, ...v]), conjugate(q)).slice(1);
const carried = (pose, v) => add(rotated(pose.q, v), pose.p);
const composed = (outer, inner) => ({ p: carried(outer, inner.p), q: product(outer.q, inner.q) });

// Axis times angle of the turn from one orientation to another, at most half a turn.
function turnVector(from, to) {
  let q = product(to, conjugate(from));
  if (q[0] < 0) q = q.map((value) => -value);
  const sine = Math.hypot(q[1], q[2], q[3]);
  return sine === 0 ? [0, 0, 0] : times(2 * Math.atan2(sine, q[0]) / sine, q.slice(1));
}

function fromTurnVector(v) {
  const angle = norm(v);
  return angle === 0 ? [1, 0, 0, 0] : [Math.cos(angle / 2), ...times(Math.sin(angle / 2) / angle, v)];
}

// Poses of neighbouring shots differ little, so the straight way between quaternions will do.
function between(a, b, fraction) {
  const sign = a.q.reduce((sum, value, i) => sum + value * b.q[i], 0) < 0 ? -1 : 1;
  const q = a.q.map((value, i) => (1 - fraction) * value + fraction * sign * b.q[i]);
  const length = Math.hypot(...q);
  return { p: add(times(1 - fraction, a.p), times(fraction, b.p)), q: q.map((value) => value / length) };
}

// The matrix that scales by `size`, turns and moves.
function placed(pose, size) {
  const columns = [[size[0], 0, 0], [0, size[1], 0], [0, 0, size[2]]].map((column) => [...rotated(pose.q, column), 0]);
  return [...columns.flat(), ...pose.p, 1];
}

// The matrix of a thing that lies along z, `length` long and `width` thick, set from `start` along `direction`.
function along(start, direction, length, width) {
  const helper = Math.abs(direction[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0];
  const x = unit(cross(helper, direction));
  const y = cross(direction, x);
  return [...times(width, x), 0, ...times(width, y), 0, ...times(length, direction), 0, ...start, 1];
}

// Forms as surfaces: corners of triangles with their normals, and the lines of sharp edges, all in double precision. What
// is turned about an axis is divided as finely as asked for about a place, so that it is round at any zoom.

import { add, cross, dot, norm, sub, times, unit } from "./geometry.js";

const SEGMENTS = 48; // of a full circle, divisible by 4
const GROWTH = 1.3; // from one division to the next, away from a place that is looked at closely
const CREASE = Math.cos(25 * Math.PI / 180); // triangles with normals farther apart meet at a sharp edge

// A surface has `corners`, `normals` (three for each triangle) and `lines` (two ends each): arrays of vectors.
const empty = () => ({ corners: [], normals: [], lines: [] });

// `near`, if given, is the place in the form's frame that is looked at, and `finest` the length that must look straight.
export function surfaceOf(form, near = null, finest = 0, segments = SEGMENTS) {
  if (!widestOf(form)) return hullSurface(form.size ? boxMesh(form.size) : form);
  return revolved(form.rims ? turnedProfile(form.rims) : roundProfile(form, near, finest, segments), around(form, near, finest, segments));
}

// The radius of the widest circle of what is turned about an axis; else 0.
export const widestOf = ({ radius, rims }) => radius ?? Math.max(0, ...(rims ?? []).map((rim) => rim[1]));

// The wall of a hole, wider by `wider` than it is, with a bottom unless it is open there.
export function wallOf(hole, { rims }, wider, near = null, finest = 0) {
  const profile = turnedProfile(rims.map(([height, radius]) => [height, radius + wider])).slice(hole.open ? 1 : 0, -1);
  return revolved(profile, around({ rims }, near, finest, SEGMENTS));
}

// Corners that were one stay one.
export function placed(surface, pose, carried, rotated, into = empty()) {
  const [places, normals] = [new Map(), new Map()];
  const once = (known, vector, moved) => known.get(vector) ?? known.set(vector, moved(vector)).get(vector);
  const place = (corner) => once(places, corner, (vector) => carried(pose, vector));
  for (const corner of surface.corners) into.corners.push(place(corner));
  for (const normal of surface.normals) into.normals.push(once(normals, normal, (vector) => rotated(pose.q, vector)));
  for (const end of surface.lines) into.lines.push(place(end));
  return into;
}

// Which corners of a surface differ in place or normal, and for each corner the number of that which is like it: those of
// what is round are six triangles' each, and are worked out once then.
export function distinct({ corners, normals }) {
  const chosen = [], known = new Map();
  const numbers = corners.map((corner, which) => {
    const at = known.get(corner) ?? [];
    known.set(corner, at);
    let number = at.find((other) => normals[chosen[other]] === normals[which]);
    if (number === undefined) {
      number = chosen.push(which) - 1;
      at.push(number);
    }
    return number;
  });
  return { chosen, numbers };
}

// Divisions of a range, finest about a middle.
function graded(middle, finest, coarsest) {
  const steps = [0];
  for (let step = Math.max(finest, 1e-13), at = 0; at < Math.PI; step = Math.min(coarsest, (GROWTH - 1) * at + finest)) steps.push(at += step);
  return [...steps.slice(1).map((step) => middle - step).reverse(), ...steps.map((step) => middle + step)];
}

function around(form, near, finest, segments) {
  const coarsest = 2 * Math.PI / segments;
  if (!near) return Array.from({ length: segments + 1 }, (_, k) => k * coarsest);
  const middle = Math.atan2(near[1], near[0]);
  const angles = graded(middle, finest / widestOf(form), coarsest).filter((angle) => Math.abs(angle - middle) < Math.PI);
  return [middle - Math.PI, ...angles, middle + Math.PI];
}

// A profile is a list of pieces: from [height, radius] to [height, radius], with the normals at both ends; `sharp` says
// that a line is seen where it begins.
function turnedProfile(rims) {
  const [low, high] = [rims[0], rims.at(-1)];
  const pieces = [{ from: [low[0], 0], to: low, normals: [[-1, 0], [-1, 0]], sharp: false }];
  rims.slice(1).forEach((to, i) => {
    const from = rims[i];
    const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
    const normal = [(from[1] - to[1]) / length, (to[0] - from[0]) / length];
    pieces.push({ from, to, normals: [normal, normal], sharp: true });
  });
  pieces.push({ from: high, to: [high[0], 0], normals: [[1, 0], [1, 0]], sharp: true });
  return pieces;
}

function roundProfile({ radius, length }, near, finest, segments) {
  const half = length / 2, quarter = Math.PI / 2;
  const uniform = Array.from({ length: segments / 4 + 1 }, (_, k) => k * 4 * quarter / segments);
  const arc = (sign) => {
    if (!near) return uniform;
    const middle = Math.atan2(sign * near[2] - half, Math.hypot(near[0], near[1]));
    return [0, ...graded(middle, finest / radius, uniform[1]).filter((angle) => angle > 0 && angle < quarter), quarter];
  };
  const ring = (sign, angle) => ({ at: [sign * (half + radius * Math.sin(angle)), radius * Math.cos(angle)], normal: [sign * Math.sin(angle), Math.cos(angle)] });
  const rings = [...arc(-1).map((angle) => ring(-1, angle)).reverse(), ...arc(1).map((angle) => ring(1, angle))];
  return rings.slice(1).map((to, i) => ({ from: rings[i].at, to: to.at, normals: [rings[i].normal, to.normal], sharp: false }))
    .filter(({ from, to }) => from[0] !== to[0] || from[1] !== to[1]);
}

function revolved(profile, angles) {
  const made = empty();
  const turns = angles.map((angle) => [Math.cos(angle), Math.sin(angle)]);
  const rings = new Map(); // those that two pieces share are one
  const ring = (at) => {
    if (!rings.has(at)) rings.set(at, turns.map(([c, s]) => [at[1] * c, at[1] * s, at[0]]));
    return rings.get(at);
  };
  for (const { from, to, normals, sharp } of profile) {
    const [low, high, first, last] = [from, to, ...normals].map(ring);
    for (let i = 1, k = 0; i < turns.length; k = i++) {
      if (from[1] > 0) push(made, [low[k], low[i], high[i]], [first[k], first[i], last[i]]);
      if (to[1] > 0) push(made, [low[k], high[i], high[k]], [first[k], last[i], last[k]]);
      if (sharp) made.lines.push(low[k], low[i]);
    }
  }
  return made;
}

function push(surface, corners, normals) {
  surface.corners.push(...corners);
  surface.normals.push(...normals);
}

function boxMesh(size) {
  const signs = [-0.5, 0.5].flatMap((x) => [-0.5, 0.5].flatMap((y) => [-0.5, 0.5].map((z) => [x, y, z])));
  const faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
  return { vertices: signs.map((sign) => sign.map((value, axis) => value * size[axis])), triangles: faces.flatMap(([a, b, c, d]) => [[a, b, c], [a, c, d]]) };
}

function hullSurface({ vertices, triangles }) {
  const made = empty();
  const areas = triangles.map(([a, b, c]) => cross(sub(vertices[b], vertices[a]), sub(vertices[c], vertices[a])));
  const normals = areas.map(unit);
  const at = vertices.map(() => []), owner = new Map();
  const side = (start, end) => start * vertices.length + end;
  triangles.forEach((corners, triangle) => corners.forEach((corner, i) => {
    at[corner].push(triangle);
    owner.set(side(corner, corners[(i + 1) % 3]), triangle);
  }));
  triangles.forEach((corners, triangle) => {
    push(made, corners.map((corner) => vertices[corner]), corners.map((corner) =>
      unit(at[corner].filter((beside) => dot(normals[beside], normals[triangle]) >= CREASE).map((beside) => areas[beside]).reduce(add))));
    corners.forEach((start, i) => {
      const end = corners[(i + 1) % 3];
      if (start < end && dot(normals[triangle], normals[owner.get(side(end, start))]) < CREASE) made.lines.push(vertices[start], vertices[end]);
    });
  });
  return made;
}

// Edges between triangles, as both ends and both normals.
export function foldsOf({ corners }) {
  const keys = new Map([...new Set(corners)].map((corner) => [corner, corner.map((value) => value.toFixed(7)).join()]));
  const sides = new Map(), folds = [];
  for (let i = 0; i < corners.length; i += 3) {
    const triangle = corners.slice(i, i + 3);
    const area = cross(sub(triangle[1], triangle[0]), sub(triangle[2], triangle[0]));
    if (norm(area) === 0) continue;
    const normal = unit(area), [a, b, c] = triangle.map((corner) => keys.get(corner));
    [[a, b], [b, c], [c, a]].forEach(([start, end], k) => {
      const beside = sides.get(`${end} ${start}`);
      if (beside) folds.push([triangle[k], triangle[(k + 1) % 3], normal, beside]);
      else sides.set(`${start} ${end}`, normal);
    });
  }
  return folds;
}

// What lies within `reach` of the origin along each axis, of a surface, with the rest cut off.
export function within(surface, reach) {
  const made = empty();
  const limits = [0, 1, 2].flatMap((axis) => [[axis, 1], [axis, -1]]);
  const inside = (place, [axis, sign]) => reach - sign * place[axis];
  for (let i = 0; i < surface.corners.length; i += 3) {
    let polygon = [0, 1, 2].map((k) => ({ place: surface.corners[i + k], normal: surface.normals[i + k] }));
    for (const limit of limits) {
      polygon = polygon.flatMap((from, k) => {
        const to = polygon[(k + 1) % polygon.length];
        const [a, b] = [inside(from.place, limit), inside(to.place, limit)];
        const kept = a >= 0 ? [from] : [];
        if ((a >= 0) === (b >= 0)) return kept;
        const mix = (one, other) => add(one, times(a / (a - b), sub(other, one)));
        return [...kept, { place: mix(from.place, to.place), normal: mix(from.normal, to.normal) }];
      });
      if (!polygon.length) break;
    }
    for (let k = 2; k < polygon.length; k++) push(made, [polygon[0], polygon[k - 1], polygon[k]].map(({ place }) => place), [polygon[0], polygon[k - 1], polygon[k]].map(({ normal }) => normal));
  }
  for (let i = 0; i < surface.lines.length; i += 2) {
    const [from, to] = [surface.lines[i], surface.lines[i + 1]];
    let [low, high] = [0, 1];
    for (const limit of limits) {
      const [a, b] = [inside(from, limit), inside(to, limit)];
      if (a < 0 && b < 0) high = -1;
      else if (a < 0) low = Math.max(low, a / (a - b));
      else if (b < 0) high = Math.min(high, a / (a - b));
    }
    if (low < high) made.lines.push(...[low, high].map((share) => add(from, times(share, sub(to, from)))));
  }
  return made;
}

// How far along a ray the first triangle is that it meets; Infinity: none.
export function hit({ corners }, from, direction) {
  let nearest = Infinity;
  for (let i = 0; i < corners.length; i += 3) {
    const [one, other] = [sub(corners[i + 1], corners[i]), sub(corners[i + 2], corners[i])];
    const across = cross(direction, other);
    const size = dot(one, across);
    if (Math.abs(size) < 1e-12 * norm(one) * norm(other)) continue;
    const out = sub(from, corners[i]);
    const u = dot(out, across) / size;
    const along = cross(out, one);
    const v = dot(direction, along) / size;
    const distance = dot(other, along) / size;
    if (u >= 0 && v >= 0 && u + v <= 1 && distance > 0) nearest = Math.min(nearest, distance);
  }
  return nearest;
}

// Where a plane cuts parts of a body: triangles of the cut, and the lines around it. A plane is `{ normal, height }`:
// what is seen from the origin along the unit normal at that height.

import { ShapeUtils, Vector2 } from "three";
import { across, add, cross, dot, sub, times } from "./geometry.js";

const SAME = 1e-9; // of the size of a cut: places that are nearer are one

// `pieces` are surfaces with `isConvex`. Returns a surface: see surfaces.js. Lines between pieces that lie against each other
// or in each other are left out: together they are one body.
export function cutOf(pieces, plane) {
  const { normal, height } = plane;
  const [one, other] = across(normal);
  const flat = (place) => [dot(place, one), dot(place, other)];
  const raised = ([x, y]) => add(times(height, normal), add(times(x, one), times(y, other)));
  const made = { corners: [], normals: [], lines: [] };
  const areas = pieces.map(({ surface, isConvex }) => {
    const sides = sidesOf(surface, plane).map((ends) => ends.map(flat));
    if (isConvex) return convexArea(sides);
    return { ...facetedArea(sides), isConvex };
  }).filter(({ triangles }) => triangles.length);
  areas.forEach(({ triangles, sides }, which) => {
    for (const triangle of triangles) {
      made.corners.push(...triangle.map(raised));
      made.normals.push(normal, normal, normal);
    }
    for (const side of sides) for (const [from, to] of leftOf(side, areas, which)) made.lines.push(raised(from), raised(to));
  });
  return made;
}

// How large a cut is.
export function areaOf({ corners }) {
  let area = 0;
  for (let i = 0; i < corners.length; i += 3) area += Math.hypot(...cross(sub(corners[i + 1], corners[i]), sub(corners[i + 2], corners[i]))) / 2;
  return area;
}

// The lines in which triangles are cut. A corner in the plane counts as above it, so that each cut closes up.
export function sidesOf({ corners }, { normal, height }) {
  const above = corners.map((corner) => dot(normal, corner) - height);
  const met = (i, j) => {
    const [a, b] = above[i] < above[j] ? [i, j] : [j, i]; // the same for both triangles beside an edge
    return add(corners[a], times(above[a] / (above[a] - above[b]), sub(corners[b], corners[a])));
  };
  const sides = [];
  for (let i = 0; i < corners.length; i += 3) {
    const isAbove = [0, 1, 2].map((k) => above[i + k] >= 0);
    const alone = isAbove.findIndex((side, k) => side !== isAbove[(k + 1) % 3] && side !== isAbove[(k + 2) % 3]);
    if (alone < 0) continue;
    const [a, b] = [met(i + alone, i + (alone + 1) % 3), met(i + alone, i + (alone + 2) % 3)];
    sides.push(isAbove[alone] ? [a, b] : [b, a]); // what is cut lies to its left
  }
  return sides;
}

// The area within the sides of a convex cut, which may come in any order.
function convexArea(sides) {
  const places = sides.flat();
  if (!places.length) return { triangles: [], sides: [], polygon: [], isConvex: true };
  const farthest = (value) => places.reduce((best, place) => (value(place) > value(best) ? place : best));
  const ends = [farthest(([x]) => x), farthest(([x]) => -x), farthest(([, y]) => y), farthest(([, y]) => -y)];
  const middle = [0, 1].map((k) => ends.reduce((sum, place) => sum + place[k], 0) / 4);
  const size = Math.max(ends[0][0] - ends[1][0], ends[2][1] - ends[3][1]);
  const around = places.map((place) => ({ place, angle: Math.atan2(place[1] - middle[1], place[0] - middle[0]) })).sort((a, b) => a.angle - b.angle).map(({ place }) => place);
  const polygon = around.filter((place, k) => {
    const before = around[(k + around.length - 1) % around.length];
    return Math.hypot(place[0] - before[0], place[1] - before[1]) > SAME * SAME * size;
  });
  const triangles = polygon.slice(2).map((place, k) => [polygon[0], polygon[k + 1], place]);
  return { triangles, sides: polygon.map((place, k) => [place, polygon[(k + 1) % polygon.length]]), polygon, size, isConvex: true };
}

// The area within the sides of any cut: they make closed lines, some of which may be around what is open within others.
function facetedArea(sides) {
  if (!sides.length) return { triangles: [], sides: [] };
  const size = sides.flat().reduce((most, [x, y]) => Math.max(most, Math.abs(x), Math.abs(y)), 0);
  const key = (place) => place.map((value) => Math.round(value / (SAME * size))).join();
  const from = new Map();
  for (const [start, end] of sides) {
    if (key(start) === key(end)) continue;
    from.set(key(start), [...(from.get(key(start)) ?? []), end]);
  }
  const loops = [];
  for (const first of from.keys()) {
    while (from.get(first)?.length) {
      const loop = [];
      for (let at = first; from.get(at)?.length;) {
        loop.push(from.get(at).pop());
        at = key(loop.at(-1));
      }
      if (loop.length > 2) loops.push(loop);
    }
  }
  const area = (loop) => loop.reduce((sum, [x, y], k) => sum + x * loop[(k + 1) % loop.length][1] - loop[(k + 1) % loop.length][0] * y, 0) / 2;
  const within = ([x, y], loop) => loop.reduce((inside, [x1, y1], k) => {
    const [x2, y2] = loop[(k + 1) % loop.length];
    return (y1 > y) !== (y2 > y) && x < x1 + (y - y1) / (y2 - y1) * (x2 - x1) ? !inside : inside;
  }, false);
  const [outer, open] = [loops.filter((loop) => area(loop) > 0), loops.filter((loop) => area(loop) < 0)];
  const triangles = outer.flatMap((loop) => {
    const around = open.filter((hole) => within(hole[0], loop) && !outer.some((other) => other !== loop && Math.abs(area(other)) < area(loop) && within(hole[0], other)));
    const places = [loop, ...around].flat();
    const vectors = (list) => list.map(([x, y]) => new Vector2(x, y));
    return ShapeUtils.triangulateShape(vectors(loop), around.map(vectors)).map((triangle) => triangle.map((corner) => places[corner]));
  });
  return { triangles, sides };
}

// What of a side of an area does not lie in the others. Sides that lie on each other count once if their areas are on the
// same side of them, and not at all if they are on both.
function leftOf(side, areas, which) {
  let left = [[0, 1]];
  const [start, end] = side;
  const way = [end[0] - start[0], end[1] - start[1]];
  areas.forEach(({ polygon, size, isConvex }, other) => {
    if (other === which || !isConvex || polygon.length < 3) return;
    let [low, high] = [0, 1];
    for (let k = 0; k < polygon.length && low < high; k++) {
      const [a, b] = [polygon[k], polygon[(k + 1) % polygon.length]];
      const [x, y] = [b[0] - a[0], b[1] - a[1]];
      const length = Math.hypot(x, y) || 1;
      const inside = ([px, py]) => (x * (py - a[1]) - y * (px - a[0])) / length;
      const [from, to] = [inside(start), inside(end)];
      if (Math.max(Math.abs(from), Math.abs(to)) <= SAME * size) {
        if (x * way[0] + y * way[1] > 0 && which < other) high = low; // it is told here, and not there
        continue;
      }
      if (from <= 0 && to <= 0) high = low;
      else if (from < 0) low = Math.max(low, from / (from - to));
      else if (to < 0) high = Math.min(high, from / (from - to));
    }
    if (low < high) left = left.flatMap(([from, to]) => [[from, Math.min(to, low)], [Math.max(from, high), to]].filter(([begin, stop]) => stop - begin > SAME));
  });
  const at = (share) => [start[0] + share * way[0], start[1] + share * way[1]];
  return left.map(([from, to]) => [at(from), at(to)]);
}

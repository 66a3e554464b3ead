// What a pixel of a drawing shows.

import { add, dot, times } from "./geometry.js";

export const PICKED = 14; // pixels from a mark that is clicked

// Which body a pixel shows, -1 the object, and how far along the ray through it; what is cut away is not seen. The mouth of
// a hole shows what is behind it, if that is anything else.
export function hitAt({ camera, section, caps, object, bodies, holes, cageHoles }, x, y) {
  let [from, direction] = camera.ray(x, y);
  const { plane } = section;
  if (plane) {
    const height = dot(plane.normal, add(camera.target, from)) - plane.height, slope = dot(plane.normal, direction);
    if (height > 0 && slope >= 0) return { which: null, nearest: Infinity, from, direction };
    if (height > 0) {
      from = add(from, times(height / -slope, direction));
      const cut = caps.findIndex((cap) => cap.holds(from));
      if (cut >= 0) return { which: cut - 1, nearest: 0, from, direction };
    }
  }
  const hits = [object, ...bodies].map((body, index) => {
    const nearest = body.hit(from, direction), isOne = Number.isFinite(nearest);
    const isOpen = isOne && (index ? cageHoles : holes).open(add(from, times(nearest, direction))) >= 0;
    return { which: isOne ? index - 1 : null, nearest, isOpen };
  }).sort((one, other) => one.isOpen - other.isOpen || one.nearest - other.nearest);
  return { ...(hits.find(({ nearest }) => Number.isFinite(nearest)) ?? hits[0]), from, direction };
}

// Which element of the cage is clicked: one of its points, its shapes or, where it is seen, its holes; null: none.
export function elementAt(drawing, x, y) {
  const { stage, camera, cageHoles } = drawing, { points, bodies } = stage.data;
  const { look } = drawing.shown(drawing.time);
  const near = points.map((_, index) => {
    const [across, down] = camera.project(stage.point(index, look));
    return { index, apart: Math.hypot(across - x, down - y) };
  }).sort((one, other) => one.apart - other.apart)[0];
  if (near?.apart < PICKED) return near.index;
  const { which, nearest, from, direction } = hitAt(drawing, x, y);
  if (which === null || which < 0) return null;
  const hole = cageHoles.open(add(from, times(nearest, direction)));
  return points.length + (hole < 0 ? which : bodies.length + hole);
}

// What a view of a drawing is fitted to, and what of the scene it does not show.

import { boundsOf, cornersOf, frameOf, within } from "./framing.js";
import { carried, sub, unit } from "./geometry.js";

// All places that a view is fitted to: corners at the start and each event's end, cage points, loads, forces at the end, and
// what lies near them of the cage's bodies; as far as the frame goes. Tells the drawing its frame.
export function contentOf(drawing) {
  const { stage, camera } = drawing, { data } = stage;
  const ends = [0, ...data.rows.map((row) => row.last)].map((shot) => drawing.shown(shot));
  const { pose, look } = ends.at(-1);
  const corners = ends.flatMap((end) => drawing.object.outer.map((corner) => carried(end.pose, corner)));
  const needed = [...corners, ...data.points.map((_, index) => stage.point(index, look))];
  const room = boundsOf(needed).map((bound, side) => bound.map((value) => value + (side ? data.reach : -data.reach)));
  drawing.cutOff = (place) => within(place, room);
  const told = [stage, ...drawing.exaggerations];
  if (told.some((value, i) => value !== drawing.framed?.[i])) Object.assign(drawing, { framed: told, frame: frameAt(drawing, ends) }); // not in each round of a fit
  if (!camera) return needed;
  if (drawing.isWhole) return wholeOf(drawing);
  const tails = data.phases.flatMap((phase) => phase.loads).flatMap((load) => drawing.loadEnds(load, look, pose));
  const last = stage.shots.at(-1);
  const pressing = last.touches.filter((touch) => touch.force).map((touch) => drawing.forceArrow(touch, last.phase, pose, look)[0]);
  const all = [...needed, ...tails, ...pressing, ...cornersAsShown(drawing, drawing.everyBody())];
  return drawing.frame ? all.map((place) => within(place, drawing.frame)) : all;
}

// What must be seen, of the looks and poses at the start and at each event's end; null: all.
function frameAt(drawing, ends) {
  const { stage, object, bodies } = drawing, { data } = stage;
  const touching = [0, ...data.rows.map((row) => row.last)].flatMap((time, which) => stage.shots[time].touches.map((touch) => stage.place(touch, ends[which].look)));
  touching.push(...data.points.map((_, index) => stage.point(index, ends.at(-1).look)));
  if (!touching.length) return null;
  touching.push(...ends.map(({ pose }) => carried(pose, data.center)));
  const held = ends.map(({ pose }) => object.outer.map((corner) => carried(pose, corner)));
  const every = drawing.everyBody(), isDriven = ([body]) => data.elementBodies[data.points.length + bodies.indexOf(body)] > 0;
  return frameOf(touching, held, cornersAsShown(drawing, every.filter(isDriven)), cornersAsShown(drawing, every));
}

const cornersAsShown = (drawing, every) => every.flatMap(([body, at]) => body.outer.map((corner) => drawing.cutOff(carried(at, corner))));

// The corners of a box around all that there is: the object at the start and at the end, and the cage to its ends.
export function wholeOf(drawing) {
  const { stage } = drawing, told = [stage, ...drawing.exaggerations];
  if (told.some((value, i) => value !== drawing.ends?.told[i])) {
    const times = [0, stage.shots.length - 1], { look } = drawing.shown(times[1]);
    const corners = times.flatMap((time) => drawing.object.outer.map((corner) => carried(drawing.shown(time).pose, corner)));
    const bodies = drawing.everyBody().flatMap(([body, at]) => body.outer.map((corner) => carried(at, corner)));
    const points = stage.data.points.map((_, index) => stage.point(index, look));
    drawing.ends = { told, places: cornersOf(boundsOf([...corners, ...bodies, ...points])) };
  }
  return drawing.ends.places;
}

// Loads that act where the picture does not show it: where, along which directions, and their names.
export function loadsOutside(drawing, shot, look, pose) {
  const { camera } = drawing, size = camera.size();
  return drawing.stage.data.phases[shot.phase].loads.filter(({ kind }) => kind !== "spring").map((load) => {
    const [start, end] = drawing.loadEnds(load, look, pose);
    return { at: load.kind === "moment" ? start : end, direction: unit(sub(end, start)), name: load.name };
  }).filter(({ at }) => camera.project(at).some((value, axis) => value < 0 || value > size[axis]));
}

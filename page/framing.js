// What a picture begins with: what moves and touches. The same choice as in framing.py, which says why.

const MOVED = 0.25, MUCH_OBJECT = 4, MUCH_CAGE = 1.8, ROOM = 0.2, LEAST_ROOM = 0.06;

// The least and the greatest coordinates of what must be seen; null: all of it must. All are places: `touching` what touches
// or may, and the centre of gravity, `held` those of the object, a list for each moment, `driven` and `rest` of the cage.
export function frameOf(touching, held, driven, rest) {
  const all = held.flat();
  const isSeen = movedMost(held) > MOVED * extent(boundsOf(all)) || extent(boundsOf([...touching, ...all])) <= MUCH_OBJECT * extent(boundsOf(touching));
  const inner = boundsOf([...(isSeen ? [...touching, ...all] : near(boundsOf(touching))), ...driven]);
  const whole = boundsOf([...inner, ...rest]);
  if (extent(whole) > MUCH_CAGE * extent(inner)) return near(inner);
  return isSeen ? null : whole;
}

// Places as they are, or moved to where they are nearest within bounds.
export const within = (place, [low, high]) => place.map((value, axis) => Math.max(low[axis], Math.min(high[axis], value)));

export function boundsOf(places) {
  return [Math.min, Math.max].map((pick) => [0, 1, 2].map((axis) => places.reduce((best, place) => pick(best, place[axis]), places[0][axis])));
}

// The eight corners of a box.
export const cornersOf = ([low, high]) => Array.from({ length: 8 }, (_, which) => low.map((value, axis) => (which >> axis & 1 ? high[axis] : value)));

const extent = ([low, high]) => Math.max(...high.map((value, axis) => value - low[axis]));

function near(bounds) {
  const room = Math.max(ROOM * extent(bounds), LEAST_ROOM);
  return [bounds[0].map((value) => value - room), bounds[1].map((value) => value + room)];
}

// How far any place of the object goes at most, along an axis.
function movedMost(held) {
  return Math.max(...held[0].map((_, index) => extent(boundsOf(held.map((places) => places[index])))));
}

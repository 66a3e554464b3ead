// Where names are written, so that none covers another. The same choice as in labels.py.

const BESIDE = 7; // pixels from a place to its name
const EDGE = 4; // and from the edge of the picture
const MOVED_BY = [22, 40, 62, 90], WAYS = 12; // a name that has no room beside its place is moved so far, in so many directions
const LEAST_LEADER = 14; // pixels from a place to its name, beyond which a line leads there

// Returns, for each `{ place: [x, y], size: [width, height], moves }`, the name's upper left corner; null where there is no
// room. Earlier ones choose first. A name keeps off places of others where it can, off other names and `taken` boxes
// always, and within the picture, which is `across` pixels wide and `down` high. One that `moves` goes away from its place
// where there is no room beside it.
export function laidOut(labels, [across, down], taken = []) {
  const written = [...taken];
  const meets = ([left, top], [width, height], [x, y, w, h]) => left < x + w && x < left + width && top < y + h && y < top + height;
  const marks = labels.map(({ place: [x, y] }) => [x - BESIDE / 2, y - BESIDE / 2, BESIDE, BESIDE]);
  const inside = ([x, y], size) => [Math.max(EDGE, Math.min(across - size[0] - EDGE, x)), Math.max(EDGE, Math.min(down - size[1] - EDGE, y))];
  return labels.map(({ place, size, moves }, which) => {
    const isFree = (corner) => !written.some((other) => meets(corner, size, other));
    const isClear = (corner) => !marks.some((mark, other) => other !== which && meets(corner, size, mark));
    const free = beside(place, size).map((corner) => inside(corner, size)).filter(isFree);
    const moved = free.some(isClear) || !moves ? [] : away(place, size).filter((corner) => inside(corner, size).every((value, i) => value === corner[i]) && isFree(corner));
    const chosen = [...free, ...moved].find(isClear) ?? free[0] ?? moved[0] ?? null;
    if (chosen) written.push([...chosen, ...size]);
    return chosen;
  });
}

// Where a line from a place to its name ends; null: the name is so near that it needs none.
export function leader([x, y], [left, top], [width, height]) {
  const end = [Math.min(Math.max(x, left), left + width), Math.min(Math.max(y, top), top + height)];
  return Math.hypot(end[0] - x, end[1] - y) > LEAST_LEADER ? end : null;
}

function beside([x, y], [width, height]) {
  const [right, left, above, below] = [x + BESIDE, x - BESIDE - width, y - BESIDE / 2 - height, y + BESIDE / 2];
  const middle = y - height / 2;
  return [[right, above], [left, above], [right, below], [left, below], [right, middle], [left, middle]];
}

// The corners of a name that is moved away, near ones first.
function away([x, y], [width, height]) {
  return MOVED_BY.flatMap((distance) => Array.from({ length: WAYS }, (_, way) => {
    const angle = 2 * Math.PI * (way + 0.5) / WAYS, across = Math.cos(angle), down = -Math.sin(angle);
    return [x + distance * across - width * (1 - across) / 2, y + distance * down - height * (1 - down) / 2];
  }));
}

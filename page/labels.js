// Where names are written, so that none covers another. The same choice as in labels.py.

const BESIDE = 7; // pixels from a place to its name
const EDGE = 4; // and from the edge of the picture

// Returns, for each `{ place: [x, y], size: [width, height] }`, the name's upper left corner; null where there is no room.
// Earlier ones choose first. A name keeps off places of others where it can, off other names always, and within the
// picture, which is `across` pixels wide and `down` high.
export function laidOut(labels, [across, down]) {
  const beside = BESIDE;
  const written = [];
  const meets = ([left, top], [width, height], [x, y, w, h]) => left < x + w && x < left + width && top < y + h && y < top + height;
  const marks = labels.map(({ place: [x, y] }) => [x - beside / 2, y - beside / 2, beside, beside]);
  return labels.map(({ place: [x, y], size }, which) => {
    const [right, left, above, below] = [x + beside, x - beside - size[0], y - beside / 2 - size[1], y + beside / 2];
    const middle = y - size[1] / 2;
    const inside = ([x, y]) => [Math.max(EDGE, Math.min(across - size[0] - EDGE, x)), Math.max(EDGE, Math.min(down - size[1] - EDGE, y))];
    const free = [[right, above], [left, above], [right, below], [left, below], [right, middle], [left, middle]].map(inside)
      .filter((corner) => !written.some((other) => meets(corner, size, other)));
    const chosen = free.find((corner) => !marks.some((mark, other) => other !== which && meets(corner, size, mark))) ?? free[0] ?? null;
    if (chosen) written.push([...chosen, ...size]);
    return chosen;
  });
}

// Shapes as they are drawn: their meshes with normals that shade them, and the lines that bound them for an eye. The same
// choices as in solids.py.

const CREASE = Math.cos(25 * Math.PI / 180); // triangles with normals farther apart meet at a sharp edge

class Solid {
  constructor({ vertices, triangles }) {
    this.vertices = vertices;
    this.triangles = triangles;
    const areas = triangles.map(([a, b, c]) => cross(sub(vertices[b], vertices[a]), sub(vertices[c], vertices[a])));
    this.normals = areas.map(unit);
    const around = vertices.map(() => []);
    const owner = new Map();
    const side = (start, end) => start * vertices.length + end;
    triangles.forEach((corners, triangle) => corners.forEach((corner, i) => {
      around[corner].push(triangle);
      owner.set(side(corner, corners[(i + 1) % 3]), triangle);
    }));
    this.edges = [];
    triangles.forEach((corners, triangle) => corners.forEach((start, i) => {
      const end = corners[(i + 1) % 3];
      if (start > end) return;
      const other = owner.get(side(end, start));
      this.edges.push({ start, end, triangle, other, isSharp: dot(this.normals[triangle], this.normals[other]) < CREASE });
    }));
    // Position, normal, position, normal, ... of all corners, for the painter.
    this.corners = triangles.flatMap((corners, triangle) => corners.flatMap((corner) => {
      const smooth = around[corner].filter((beside) => dot(this.normals[beside], this.normals[triangle]) >= CREASE);
      return [vertices[corner], unit(smooth.map((beside) => areas[beside]).reduce(add))];
    }));
  }

  // Position, normal, ... of the lines that are seen from a direction, in the shape's frame.
  outline(toViewer) {
    const isFront = this.normals.map((normal) => dot(normal, toViewer) > 0);
    return this.edges
      .filter(({ triangle, other, isSharp }) => isFront[triangle] !== isFront[other] || (isSharp && isFront[triangle]))
      .flatMap(({ start, end }) => [this.vertices[start], [0, 0, 1], this.vertices[end], [0, 0, 1]]);
  }
}

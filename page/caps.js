// The cuts of bodies, as engineers draw them: in the body's colour, hatched, with a line around. Worked out like bodies in
// double precision; close by, only what lies near the target is drawn.

import { BufferGeometry, Group, LineBasicMaterial, LineSegments, Mesh } from "three";
import { add, carried, conjugate, dot, rotated, sub, times } from "./geometry.js";
import { areaOf, cutOf, sidesOf } from "./cut.js";
import { capMaterial, lineMaterial } from "./materials.js";
import { geometryOf, surfacesNear } from "./solids.js";
import { hit, placed, within } from "./surfaces.js";

// A plane as a body at a pose has it.
function seenFrom(pose, { normal, height }) {
  return { normal: rotated(conjugate(pose.q), normal), height: height - dot(normal, pose.p) };
}

export class Cap {
  // `rank`: which is drawn where two lie on each other, the higher one. Hatches of two bodies differ.
  constructor(body, holes, { face, edge }, rank, slant) {
    Object.assign(this, { body, holes, corners: [] });
    this.material = capMaterial({ face, edge, slant }, rank, holes);
    this.mesh = new Mesh(new BufferGeometry(), this.material);
    this.lines = new LineSegments(new BufferGeometry(), lineMaterial(edge, holes));
    this.group = new Group();
    this.group.add(this.mesh, this.lines);
    for (const thing of [this.mesh, this.lines]) thing.frustumCulled = false;
    this.area = 0;
  }

  show(plane, camera) {
    this.group.visible = Boolean(plane);
    this.plane = plane;
    if (!plane) return;
    const { body } = this;
    const isClose = camera.isClose(), pieces = isClose ? null : body.shape.pieces(camera.pixel(body.pose.p));
    const told = [pieces, plane.height, ...plane.normal, ...body.pose.p, ...body.pose.q];
    this.material.hatch(plane, camera);
    if (!isClose && this.told && told.every((value, i) => value === this.told[i])) { // only the view has changed
      this.place(sub([0, 0, 0], camera.target));
      return;
    }
    this.told = isClose ? null : told;
    if (isClose) {
      const near = { normal: plane.normal, height: plane.height - dot(plane.normal, camera.target) };
      this.fill(within(cutOf(surfacesNear(body, camera), near), camera.reach()));
      this.place([0, 0, 0]);
    } else {
      const cut = cutOf(pieces, seenFrom(body.pose, plane));
      this.area = areaOf(cut);
      this.fill(placed(cut, body.pose, carried, rotated));
      this.place(sub([0, 0, 0], camera.target));
    }
  }

  // Whether a place of the plane, seen from the target, is in the cut.
  holds(place) {
    const { normal } = this.plane, [x, y, z] = sub(place, this.group.position.toArray());
    return hit({ corners: this.corners }, add([x, y, z], normal), times(-1, normal)) < Infinity && this.holes.open(place) < 0;
  }

  fill(cut) {
    this.corners = cut.corners;
    for (const thing of [this.mesh, this.lines]) thing.geometry.dispose();
    this.mesh.geometry = geometryOf(cut.corners);
    this.lines.geometry = geometryOf(cut.lines);
  }

  place(at) {
    this.group.position.set(...at);
  }
}

// The lines in which the walls of holes are cut.
export class WallCuts {
  constructor(walls, edge) {
    this.walls = walls;
    this.lines = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ color: edge }));
    this.lines.frustumCulled = false;
    this.group = this.lines;
  }

  show(plane, camera) {
    this.lines.visible = Boolean(plane);
    if (!plane) return;
    const near = { normal: plane.normal, height: plane.height - dot(plane.normal, camera.target) };
    this.lines.geometry.dispose();
    this.lines.geometry = geometryOf(this.walls.made.flatMap(({ surface }) => sidesOf(surface, near).flat()));
  }
}

// Bodies as three.js draws them: faces, edges, holes cut out. From afar a body keeps its mesh and is moved; close by, only
// what lies near the target is drawn, worked out in double precision: numbers of a graphics card end at 1e-7 of the size.

import { BackSide, BufferAttribute, BufferGeometry, FrontSide, Group, LineBasicMaterial, LineSegments, Mesh, MeshLambertMaterial,
  Quaternion, Vector3, Vector4, Matrix3 } from "three";
import { carried, composed, conjugate, dot, inverse, norm, rotated, sub } from "./geometry.js";
import { faceMaterial } from "./materials.js";
import { distinct, foldsOf, hit, placed, surfaceOf, wallOf, widestOf, within } from "./surfaces.js";

const FINEST = 0.02; // times half the height of a picture: what looks straight
const FINENESS = [12, 24, 48, 96], STRAIGHT = 0.25; // segments of a full circle; pixels that they may be off by
const SLACK = 1e-4; // of a hole's depth, by which its mouth is cut beyond the face that it is in

const geometryOf = (places, normals = null) => {
  const made = new BufferGeometry();
  made.setAttribute("position", new BufferAttribute(new Float32Array(places.flat()), 3));
  if (normals) made.setAttribute("normal", new BufferAttribute(new Float32Array(normals.flat()), 3));
  return made;
};

// The holes of a body, as its faces are cut out.
export class Holes {
  constructor(holes, forms) {
    this.holes = holes;
    this.forms = forms;
    this.count = holes.length;
    this.uniforms = {
      holeTurns: { value: holes.map(() => new Matrix3()) },
      holeAxes: { value: holes.map(() => new Vector4()) },
      holeSizes: { value: holes.map(() => new Vector4()) },
    };
  }

  // Where each hole is shown, and how much wider than it is.
  place(poses, widers, target) {
    this.holes.forEach((hole, i) => {
      const { rims } = this.forms[hole.form];
      const depth = -rims[0][0], radius = rims[0][1] + widers[i];
      const q = conjugate(poses[i].q);
      const columns = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((axis) => rotated(q, axis));
      this.uniforms.holeTurns.value[i].fromArray(columns.flat());
      const [x, y, z] = rotated(q, sub(target, poses[i].p));
      this.uniforms.holeAxes.value[i].set(x * x + y * y - radius * radius, 2 * x, 2 * y, z);
      const chamfer = rims.length > 2 ? -rims[1][0] : 0;
      const widest = rims.at(-1)[1] + widers[i];
      const slope = chamfer ? (widest * widest - radius * radius) / chamfer : 0;
      this.uniforms.holeSizes.value[i].set(-depth * (hole.open ? 1 + SLACK : 1 - SLACK), SLACK * depth, chamfer, slope);
    });
  }
}

// The shape of parts that move as one: bodies that are alike share it.
export class Shape {
  constructor(parts, forms) {
    this.parts = parts.map(({ form, position, quaternion }) => {
      const surface = surfaceOf(forms[form]);
      return { form: forms[form], pose: { p: position, q: quaternion }, surface, reach: Math.max(...surface.corners.map(norm)) };
    });
    this.whole = this.placed(({ surface }) => surface);
    this.reach = Math.max(0, ...this.whole.corners.map(norm));
    this.outer = [...new Map([...new Set(this.whole.corners)].map((corner) => [corner.map((value) => value.toFixed(6)).join(), corner])).values()]; // each corner once
    const [low, high] = [Math.min, Math.max].map((pick) => [0, 1, 2].map((axis) => this.outer.map((corner) => corner[axis]).reduce((one, other) => pick(one, other))));
    this.ends = [low[0], high[0]].flatMap((x) => [low[1], high[1]].flatMap((y) => [low[2], high[2]].map((z) => [x, y, z]))); // of the box around it
    this.widest = Math.max(...this.parts.map(({ form }) => widestOf(form)));
    this.meshes = new Map(); // by segments of a full circle
  }

  placed(surface) {
    return this.parts.reduce((whole, part) => placed(surface(part), part.pose, carried, rotated, whole), { corners: [], normals: [], lines: [] });
  }

  // Faces and edges, as fine as it needs where a pixel is so long: small balls of thousands of triangles are slow in software.
  mesh(pixel) {
    const segments = FINENESS.find((segments) => this.widest * (1 - Math.cos(Math.PI / segments)) < STRAIGHT * pixel) ?? FINENESS.at(-1);
    if (!this.meshes.has(segments)) this.meshes.set(segments, this.meshOf(segments));
    return this.meshes.get(segments);
  }

  meshOf(segments) {
    const made = this.placed(({ form }) => surfaceOf(form, null, 0, segments));
    const { chosen, numbers } = distinct(made);
    return [geometryOf(...[made.corners, made.normals].map((list) => chosen.map((which) => list[which]))).setIndex(numbers), geometryOf(made.lines)];
  }

  // Edges where it may turn away from an eye.
  get folds() {
    this.found ??= foldsOf(this.whole);
    return this.found;
  }
}

// A body of a shape. `look` has the colours of faces and edges, and how much of the faces is seen through.
export class Body {
  constructor(shape, holes, { face, edge }, isSoftware) {
    Object.assign(this, { shape, outer: shape.outer, ends: shape.ends, reach: shape.reach });
    this.group = new Group();
    this.front = new Mesh(undefined, faceMaterial({ color: face, side: FrontSide }, holes, isSoftware));
    this.back = new Mesh(undefined, faceMaterial({ color: face, side: BackSide }, holes, isSoftware));
    this.lines = new LineSegments(undefined, new LineBasicMaterial({ color: edge }));
    this.front.castShadow = this.front.receiveShadow = true;
    this.group.add(this.front, this.back, this.lines);
    for (const thing of [this.group, ...this.group.children]) thing.matrixAutoUpdate = thing.frustumCulled = false;
    this.seeThrough(1);
  }

  seeThrough(opacity) {
    Object.assign(this.front.material, { opacity, transparent: opacity < 1, depthWrite: opacity === 1 });
    this.front.renderOrder = opacity < 1 ? 2 : 0;
    this.isGlass = this.back.visible = opacity < 1; // of a closed surface that hides its inside nothing is seen from there
    this.front.material.needsUpdate = true;
  }

  show(pose, camera) {
    this.pose = pose;
    this.target = camera.target;
    this.close = camera.isClose() ? this.near(pose, camera) : null;
    this.closeGeometries?.forEach((geometry) => geometry.dispose());
    this.closeGeometries = this.close && [geometryOf(this.close.corners, this.close.normals), geometryOf(this.close.lines)];
    const [faces, lines] = this.closeGeometries ?? this.shape.mesh(camera.pixel(pose.p));
    this.front.geometry = this.back.geometry = faces;
    this.lines.geometry = lines;
    const [p, q] = this.close ? [[0, 0, 0], [1, 0, 0, 0]] : [sub(pose.p, camera.target), pose.q];
    this.group.matrix.compose(new Vector3(...p), new Quaternion(q[1], q[2], q[3], q[0]), new Vector3(1, 1, 1));
    this.group.matrixWorldNeedsUpdate = true;
  }

  near(pose, camera) {
    const found = { corners: [], normals: [], lines: [] };
    for (const part of this.shape.parts) {
      const at = composed(pose, part.pose);
      const about = { p: sub(at.p, camera.target), q: at.q };
      const target = carried(inverse(about), [0, 0, 0]);
      if (norm(target) - part.reach > 2 * camera.reach()) continue;
      const surface = part.form.vertices || part.form.size ? part.surface : surfaceOf(part.form, target, FINEST * camera.half);
      const cut = within(placed(surface, about, carried, rotated), camera.reach());
      for (const key of Object.keys(found)) found[key].push(...cut[key]);
    }
    return found;
  }

  // The lines that bound it for an eye at a place in its frame: its edges, and where it turns away.
  outline(eye) {
    const { whole, folds } = this.shape;
    const faces = (normal, place) => dot(normal, sub(eye, place)) > 0;
    return [...whole.lines, ...folds.filter(([from, , one, other]) => faces(one, from) !== faces(other, from)).flatMap(([from, to]) => [from, to])];
  }

  // How far along a ray from about the target it is met.
  hit(from, direction) {
    if (this.close) return hit(this.close, from, direction);
    const back = inverse({ p: sub(this.pose.p, this.target), q: this.pose.q });
    return hit(this.shape.whole, carried(back, from), rotated(back.q, direction));
  }
}

// The walls of the holes of a body.
export class Walls {
  constructor(holes, forms, { face, edge }) {
    this.holes = holes;
    this.forms = forms;
    this.group = new Group();
    this.made = holes.map(() => {
      const wall = new Mesh(new BufferGeometry(), new MeshLambertMaterial({ color: face, side: BackSide }));
      const lines = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ color: edge }));
      wall.frustumCulled = lines.frustumCulled = false;
      this.group.add(wall, lines);
      return { wall, lines };
    });
  }

  show(poses, widers, camera) {
    this.made.forEach(({ wall, lines }, i) => {
      const about = { p: sub(poses[i].p, camera.target), q: poses[i].q };
      const form = this.forms[this.holes[i].form];
      const near = camera.isClose() ? carried(inverse(about), [0, 0, 0]) : null;
      const whole = placed(wallOf(this.holes[i], form, widers[i], near, FINEST * camera.half), about, carried, rotated);
      const surface = near ? within(whole, camera.reach()) : whole;
      wall.geometry.dispose();
      lines.geometry.dispose();
      wall.geometry = geometryOf(surface.corners, surface.normals);
      lines.geometry = geometryOf(surface.lines);
    });
  }
}

// Balls, rods and tips with a size in pixels: contacts, forces, loads, axes. What is behind a body shows through, faint.

import { BufferAttribute, BufferGeometry, CylinderGeometry, ConeGeometry, Color, DynamicDrawUsage, GreaterDepth, Group, LessEqualDepth, Mesh,
  SphereGeometry, SRGBColorSpace, TorusGeometry } from "three";
import { add, norm, rotated, sub, times, turnedTo, unit } from "./geometry.js";
import { markMaterial } from "./materials.js";

const standing = (geometry) => geometry.rotateX(Math.PI / 2); // along z instead of y
const SHAPES = {
  ball: standing(new SphereGeometry(1, 8, 2, 0, 2 * Math.PI, 0, Math.PI / 2)), // the half that is seen
  rod: standing(new CylinderGeometry(1, 1, 1, 6, 1, true).translate(0, 0.5, 0)),
  tip: standing(new ConeGeometry(1, 1, 10).translate(0, 0.5, 0)),
  pin: standing(new ConeGeometry(1, 1, 8).rotateX(Math.PI).translate(0, 0.5, 0)), // its tip at the origin
  ring: new TorusGeometry(1, 0.12, 8, 32),
};

export class Marks {
  constructor({ faint, head }, isSoftware) {
    this.head = head; // of an arrow: radius and length, pixels
    this.group = new Group();
    const [seen, behind] = [{ depthFunc: LessEqualDepth }, { depthFunc: GreaterDepth, transparent: true, opacity: faint, depthWrite: false }].map((look) => markMaterial(look, isSoftware));
    this.pins = new Heap([markMaterial({ depthFunc: LessEqualDepth, clipShadows: true }, isSoftware)]); // bodies of the cage: they throw shadows, and are hidden
    this.others = new Heap([seen, behind]);
    this.pins.meshes[0].castShadow = true;
    this.group.add(...this.pins.meshes, ...this.others.meshes);
  }

  // Leaves what of the cage's points is behind planes; null: all of them.
  clip(planes) {
    this.pins.meshes[0].material.clippingPlanes = planes;
  }

  begin(camera) {
    this.camera = camera;
    this.towardsViewer = turnedTo(camera.axes()[2]);
    this.pins.clear();
    this.others.clear();
  }

  // `size` is across and along; the place is where a thing stands, not its middle.
  put(name, place, q, size, color) {
    (name === "pin" ? this.pins : this.others).put(SHAPES[name], sub(place, this.camera.target), q, size, color);
  }

  ball(place, pixels, color) {
    const radius = pixels * this.camera.pixel(place);
    this.put("ball", place, this.towardsViewer, [radius, radius], color);
  }

  ring(place, pixels, color) {
    const radius = pixels * this.camera.pixel(place);
    this.put("ring", place, this.towardsViewer, [radius, radius], color);
  }

  rod(start, end, pixels, color) {
    const way = sub(end, start);
    if (norm(way) === 0) return;
    this.put("rod", start, turnedTo(unit(way)), [pixels * this.camera.pixel(start), norm(way)], color);
  }

  arrow(tail, tip, pixels, color) {
    const way = sub(tip, tail);
    const length = norm(way), pixel = this.camera.pixel(tip);
    if (length < pixel) return;
    const head = Math.min(this.head[1] * pixel, 0.7 * length);
    const neck = add(tip, times(-head / length, way));
    this.rod(tail, neck, pixels, color);
    this.put("tip", neck, turnedTo(unit(way)), [Math.max(this.head[0], 2.3 * pixels) * pixel, head], color);
  }

  end() {
    this.pins.finish();
    this.others.finish();
  }
}

// Copies of shapes as one mesh for each material. They are no instances: software draws each of those by itself, which took
// longer than all that is drawn.
class Heap {
  constructor(materials) {
    this.geometry = new BufferGeometry();
    this.meshes = materials.map((material) => {
      const mesh = new Mesh(this.geometry, material);
      mesh.frustumCulled = false;
      mesh.renderOrder = material.transparent ? 3 : 1;
      return mesh;
    });
    this.clear();
    this.makeRoom(1, 1);
  }

  clear() {
    this.copies = [];
    this.corners = this.turns = 0;
  }

  put(shape, place, q, size, color) {
    this.copies.push([shape, place, q, size, color]);
    this.corners += shape.attributes.position.count;
    this.turns += shape.index.count;
  }

  makeRoom(corners, turns) {
    this.geometry.dispose();
    for (const name of ["position", "normal", "color"]) this.geometry.setAttribute(name, new BufferAttribute(new Float32Array(3 * corners), 3).setUsage(DynamicDrawUsage));
    this.geometry.setIndex(new BufferAttribute(new Uint32Array(turns), 1).setUsage(DynamicDrawUsage));
  }

  finish() {
    const { geometry } = this;
    if (this.corners > geometry.attributes.position.count || this.turns > geometry.index.count) this.makeRoom(2 * this.corners, 2 * this.turns);
    let corner = 0, turn = 0;
    for (const [shape, place, q, size, color] of this.copies) {
      this.copy(shape, corner, place, q, size, color);
      for (const index of shape.index.array) geometry.index.array[turn++] = corner + index;
      corner += shape.attributes.position.count;
    }
    for (const [list, used] of [...Object.values(geometry.attributes).map((attribute) => [attribute, 3 * corner]), [geometry.index, turn]]) {
      list.clearUpdateRanges();
      list.addUpdateRange(0, used);
      list.needsUpdate = true;
    }
    geometry.setDrawRange(0, turn);
  }

  copy(shape, first, [x, y, z], q, [across, along], color) {
    const { position: { array: from, count }, normal: { array: facing } } = shape.attributes;
    const { position: { array: position }, normal: { array: normal }, color: { array: paint } } = this.geometry.attributes;
    const [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((axis) => rotated(q, axis));
    for (let i = 0, at = 3 * first; i < 3 * count; i += 3, at += 3) {
      const a = across * from[i], b = across * from[i + 1], c = along * from[i + 2];
      position[at] = x + a * ax + b * bx + c * cx;
      position[at + 1] = y + a * ay + b * by + c * cy;
      position[at + 2] = z + a * az + b * bz + c * cz;
      const u = facing[i], v = facing[i + 1], w = facing[i + 2] * across / along; // of no particular length
      normal[at] = u * ax + v * bx + w * cx;
      normal[at + 1] = u * ay + v * by + w * cy;
      normal[at + 2] = u * az + v * bz + w * cz;
      paint[at] = color.r;
      paint[at + 1] = color.g;
      paint[at + 2] = color.b;
    }
  }
}

export const color = (hex) => new Color().setStyle(hex, SRGBColorSpace);

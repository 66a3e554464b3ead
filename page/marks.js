// Balls, rods and tips with a size in pixels: contacts, forces, loads, axes. What is behind a body shows through, faint.

import { CylinderGeometry, ConeGeometry, Color, DynamicDrawUsage, GreaterDepth, Group, InstancedMesh, LessEqualDepth, Matrix4, MeshLambertMaterial,
  Quaternion, SphereGeometry, SRGBColorSpace, TorusGeometry, Vector3 } from "three";
import { add, norm, sub, times, turnedTo, unit } from "./geometry.js";

const standing = (geometry) => geometry.rotateX(Math.PI / 2); // along z instead of y
const SHAPES = {
  ball: new SphereGeometry(1, 8, 5),
  rod: standing(new CylinderGeometry(1, 1, 1, 6, 1, true).translate(0, 0.5, 0)),
  tip: standing(new ConeGeometry(1, 1, 10).translate(0, 0.5, 0)),
  pin: standing(new ConeGeometry(1, 1, 8).rotateX(Math.PI).translate(0, 0.5, 0)), // its tip at the origin
  ring: new TorusGeometry(1, 0.12, 8, 32),
};

export class Marks {
  constructor({ faint, head }) {
    this.head = head; // of an arrow: radius and length, pixels
    this.group = new Group();
    this.lists = Object.fromEntries(Object.keys(SHAPES).map((name) => [name, { places: [], colors: [], meshes: [], room: 0 }]));
    const looks = { emissiveIntensity: 0.35 };
    this.materials = [new MeshLambertMaterial({ ...looks, depthFunc: LessEqualDepth }),
      new MeshLambertMaterial({ ...looks, depthFunc: GreaterDepth, transparent: true, opacity: faint, depthWrite: false })];
    this.solid = this.materials[0];
  }

  begin(camera) {
    this.camera = camera;
    for (const list of Object.values(this.lists)) list.places.length = list.colors.length = 0;
  }

  // `size` is across and along; the place is where a thing stands, not its middle.
  put(name, place, q, size, color) {
    const matrix = new Matrix4().compose(new Vector3(...sub(place, this.camera.target)), new Quaternion(q[1], q[2], q[3], q[0]), new Vector3(size[0], size[0], size[1]));
    this.lists[name].places.push(matrix);
    this.lists[name].colors.push(color);
  }

  ball(place, pixels, color) {
    const radius = pixels * this.camera.pixel(place);
    this.put("ball", place, [1, 0, 0, 0], [radius, radius], color);
  }

  ring(place, pixels, color) {
    const radius = pixels * this.camera.pixel(place);
    this.put("ring", place, turnedTo(this.camera.axes()[2]), [radius, radius], color);
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
    for (const [name, list] of Object.entries(this.lists)) {
      if (list.places.length > list.room) this.grow(name, list);
      for (const mesh of list.meshes) {
        mesh.count = list.places.length;
        list.places.forEach((matrix, index) => { mesh.setMatrixAt(index, matrix); mesh.setColorAt(index, list.colors[index]); });
        mesh.instanceMatrix.needsUpdate = true;
        if (mesh.instanceColor) mesh.instanceColor.needsUpdate = true;
      }
    }
  }

  grow(name, list) {
    this.group.remove(...list.meshes);
    list.meshes.forEach((mesh) => mesh.dispose());
    list.room = 2 * list.places.length;
    const materials = name === "pin" ? [this.solid] : this.materials; // a pin is a body of the cage
    list.meshes = materials.map((material) => {
      const mesh = new InstancedMesh(SHAPES[name], material, list.room);
      mesh.instanceMatrix.setUsage(DynamicDrawUsage);
      mesh.frustumCulled = false;
      mesh.castShadow = name === "pin";
      mesh.renderOrder = material.transparent ? 3 : 1;
      return mesh;
    });
    this.group.add(...list.meshes);
  }
}

export const color = (hex) => new Color().setStyle(hex, SRGBColorSpace);

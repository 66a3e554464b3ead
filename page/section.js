// The plane that cuts the scene: what of bodies is on its far side is left. It is moved by its arrow, turned by its ring.

import { Plane } from "three";
import { across, add, cross, dot, fromTurnVector, norm, rotated, sub, times, unit } from "./geometry.js";

const AXES = { x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1] };
const RING_SIDES = 48;
const ARROW = 58, RING = 40, NEAR = 11; // pixels: the arrow's length, the ring's radius, and how near to them one grabs
const FLATTEST = 0.15; // of its length: an arrow that is seen as shorter is moved as if it were as long

export class Section {
  constructor(paint) {
    this.paint = paint;
    this.normal = null; // toward what is cut away; null: nothing is
    this.three = [new Plane()]; // as materials take it
  }

  // Cuts across an axis, through a place; what is on the side of the viewer goes. Null: cuts nothing.
  choose(axis, middle, radius, back) {
    this.axis = axis;
    this.normal = axis && times(dot(AXES[axis], back) < 0 ? -1 : 1, AXES[axis]);
    Object.assign(this, { point: middle, middle, radius });
  }

  get plane() {
    return this.normal && { normal: this.normal, height: dot(this.normal, this.point) };
  }

  isCutAway(place) {
    return this.normal !== null && dot(this.normal, sub(place, this.point)) > 0;
  }

  // How far the plane is from the middle, in radii; and where its normal leads, degrees about z and above the ground.
  get told() {
    const [x, y, z] = this.normal, degrees = 180 / Math.PI;
    return { place: dot(this.normal, sub(this.point, this.middle)) / this.radius, turn: Math.atan2(y, x) * degrees, tilt: Math.asin(Math.max(-1, Math.min(1, z))) * degrees };
  }

  move(place) {
    this.point = add(this.point, times((place - this.told.place) * this.radius, this.normal));
  }

  face(turn, tilt) {
    const [a, e] = [turn, tilt].map((degrees) => degrees * Math.PI / 180);
    this.normal = [Math.cos(a) * Math.cos(e), Math.sin(a) * Math.cos(e), Math.sin(e)];
  }

  // As seen from the target of a camera.
  update(camera) {
    if (!this.normal) return;
    this.three[0].normal.set(...times(-1, this.normal));
    this.three[0].constant = dot(this.normal, sub(this.point, camera.target));
  }

  // Where the handles are: in the middle of the plane, as far as it is within the scene.
  handle(camera) {
    const aside = sub(this.middle, this.point);
    const at = add(this.point, sub(aside, times(dot(aside, this.normal), this.normal)));
    const size = RING * camera.pixel(at), [one, other] = across(this.normal);
    const ring = Array.from({ length: RING_SIDES }, (_, k) => {
      const angle = 2 * Math.PI * k / RING_SIDES;
      return add(at, add(times(size * Math.cos(angle), one), times(size * Math.sin(angle), other)));
    });
    return { at, ring, tip: add(at, times(ARROW * camera.pixel(at), this.normal)) };
  }

  draw(marks, camera, sizes) {
    if (!this.normal || camera.isClose()) return;
    const { at, ring, tip } = this.handle(camera);
    ring.forEach((place, k) => marks.rod(place, ring[(k + 1) % ring.length], 1.6 * sizes.thin, this.paint));
    marks.arrow(at, tip, 1.3 * sizes.rod, this.paint);
  }

  // What takes the way of a pointer that is pressed at a pixel, if that is on a handle; else null.
  grab(x, y, camera, changed) {
    if (!this.normal || camera.isClose()) return null;
    const { at, ring, tip } = this.handle(camera);
    const apart = (from, to) => {
      const [[x1, y1], [x2, y2]] = [from, to].map((place) => camera.project(place));
      const [across, down] = [x2 - x1, y2 - y1];
      const share = Math.max(0, Math.min(1, ((x - x1) * across + (y - y1) * down) / (across ** 2 + down ** 2 || 1)));
      return Math.hypot(x - x1 - share * across, y - y1 - share * down);
    };
    const follow = (act) => (way) => { if (way) { act(way); changed(); } };
    if (apart(at, tip) < NEAR) return follow((way) => this.carry(way, camera));
    return ring.some((place, k) => apart(place, ring[(k + 1) % ring.length]) < NEAR) ? follow((way) => this.roll(way, camera)) : null;
  }

  carry(way, camera) {
    const back = camera.axes()[2];
    const seen = sub(this.normal, times(dot(this.normal, back), back));
    const length = Math.max(FLATTEST, norm(seen));
    this.point = add(this.point, times(dot(way, seen) / length ** 2, this.normal));
  }

  // As a ball of the ring's size rolls under the pointer.
  roll(way, camera) {
    const { at } = this.handle(camera);
    this.normal = unit(rotated(fromTurnVector(times(1 / (RING * camera.pixel(at)), cross(camera.axes()[2], way))), this.normal));
    this.point = at;
  }
}


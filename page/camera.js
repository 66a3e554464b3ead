// Where the viewer stands, in double precision: z is up. Drag turns, shift or the right button moves, and the wheel or two
// fingers zoom to what is under them.

import { OrthographicCamera, PerspectiveCamera, Matrix4 } from "three";
import { add, cross, dot, sub, times } from "./geometry.js";

const VIEWS = { corner: [-56, 24], x: [180, 0], y: [-90, 0], z: [-90, 90] };
const LEAST_HALF = 2e-9, MOST_HALF = 20; // half the height of a picture, in drawing units
const CLOSE = 0.02; // with less than this, only what is near is drawn, and marks are rings
const REACH = 400; // times half the height: what is near
const CLICK = 4; // pixels: the most that a click moves

export class Camera {
  // `content()` returns the places that a view is fitted to, `under(x, y)` the place that is seen at a pixel or null, and
  // `covered()` the height in pixels that something else covers from above. `grabbed(x, y)` returns what takes the way of
  // a pointer that is pressed there, in drawing units, and null when it is let go; null: the pointer turns the view.
  constructor(canvas, { radius, look }, { content, under, covered, changed, clicked, grabbed }) {
    Object.assign(this, { canvas, radius, look, content, under, covered, changed, clicked, grabbed, carry: null, perspective: true, pointers: new Map(), travelled: 0 });
    this.cameras = [new OrthographicCamera(), new PerspectiveCamera()];
    this.home("corner");
    canvas.addEventListener("pointerdown", (event) => this.press(event));
    canvas.addEventListener("pointermove", (event) => this.drag(event));
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => this.release(event));
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoomAt(event.offsetX, event.offsetY, Math.exp(0.0015 * event.deltaY));
    }, { passive: false });
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  }

  press(event) {
    this.canvas.setPointerCapture(event.pointerId);
    if (!this.pointers.size) {
      this.travelled = 0;
      this.carry = event.button === 0 && !event.shiftKey ? this.grabbed(event.offsetX, event.offsetY) : null;
    }
    this.pointers.set(event.pointerId, [event.offsetX, event.offsetY]);
  }

  drag(event) {
    const before = this.pointers.get(event.pointerId);
    if (!before) return;
    const now = [event.offsetX, event.offsetY];
    const [x, y] = [now[0] - before[0], now[1] - before[1]];
    this.travelled += Math.hypot(x, y);
    const other = [...this.pointers].find(([id]) => id !== event.pointerId)?.[1];
    this.pointers.set(event.pointerId, now);
    if (other) {
      const apart = (place) => Math.max(1, Math.hypot(place[0] - other[0], place[1] - other[1]));
      this.pan(x / 2, y / 2);
      this.zoomAt((now[0] + other[0]) / 2, (now[1] + other[1]) / 2, apart(before) / apart(now));
    } else if (this.carry) this.carry(this.across(x, y));
    else if (event.shiftKey || event.buttons === 2) this.pan(x, y);
    else {
      this.azimuth -= 0.4 * x;
      this.elevation = Math.max(-90, Math.min(90, this.elevation + 0.4 * y));
    }
    this.changed();
  }

  release(event) {
    const isClick = event.type === "pointerup" && this.pointers.size === 1 && this.travelled < CLICK && event.button === 0;
    this.pointers.delete(event.pointerId);
    if (this.carry) this.carry(null);
    this.carry = null;
    if (isClick) this.clicked(event.offsetX, event.offsetY);
  }

  pan(x, y) {
    this.target = sub(this.target, this.across(x, y));
  }

  // The way of so many pixels to the right and down, at the depth that one looks at.
  across(x, y) {
    const [right, up] = this.axes();
    return add(times(x * this.pixel(), right), times(-y * this.pixel(), up));
  }

  // What was at a place and of a size in other drawing coordinates is seen as before.
  rebase(place, scale) {
    this.target = place(this.target);
    this.half *= scale;
  }

  home(name) {
    [this.azimuth, this.elevation] = VIEWS[name];
    this.fit();
  }

  // Looks at a place from a direction, at so many drawing units of height.
  lookAt(place, back, half) {
    this.target = place;
    this.azimuth = Math.atan2(back[1], back[0]) * 180 / Math.PI;
    this.elevation = Math.asin(Math.max(-1, Math.min(1, back[2]))) * 180 / Math.PI;
    this.half = half;
    this.changed();
  }

  // The place under the pixel stays there.
  zoomAt(x, y, factor) {
    const half = Math.max(LEAST_HALF, Math.min(MOST_HALF, this.half * factor));
    const place = this.under(x, y) ?? this.onTarget(x, y);
    this.target = add(place, times(half / this.half, sub(this.target, place)));
    this.half = half;
    this.changed();
  }

  // Brings everything into view, from the same side. Marks have their size in pixels, so that a fit changes what is fitted.
  fit() {
    this.target ??= [0, 0, 0];
    this.half ??= this.radius;
    const [width, whole] = this.size();
    const covered = Math.min(this.covered(), whole / 3), height = whole - covered;
    const axes = this.axes();
    for (let round = 0; round < 6; round++) {
      const seen = this.content().map((place) => this.project(place));
      const [low, high] = [Math.min, Math.max].map((pick) => [0, 1].map((i) => seen.reduce((best, place) => pick(best, place[i]), seen[0][i])));
      const middle = [0, 1].map((i) => (low[i] + high[i]) / 2 - [width / 2, covered + height / 2][i]);
      this.target = add(this.target, add(times(middle[0] * this.pixel(), axes[0]), times(-middle[1] * this.pixel(), axes[1])));
      this.half = Math.max(0.02 * this.radius, this.half * Math.max((high[0] - low[0]) / width, (high[1] - low[1]) / height) / this.look.margin);
    }
    this.changed();
  }

  size() {
    return [Math.max(1, this.canvas.clientWidth), Math.max(1, this.canvas.clientHeight)];
  }

  // Right, up and towards the viewer.
  axes() {
    const [a, e] = [this.azimuth, this.elevation].map((degrees) => degrees * Math.PI / 180);
    const right = [-Math.sin(a), Math.cos(a), 0];
    const back = [Math.cos(a) * Math.cos(e), Math.sin(a) * Math.cos(e), Math.sin(e)];
    return [right, cross(back, right), back];
  }

  distance() {
    return this.half / Math.tan(this.look.field_deg / 2 * Math.PI / 180);
  }

  // Where the eye is; of parallel lines very far off.
  eye() {
    return add(this.target, times(this.perspective ? this.distance() : 1e6, this.axes()[2]));
  }

  isClose() {
    return this.half < CLOSE;
  }

  // How far from the target things are drawn, where it is close.
  reach() {
    return REACH * this.half;
  }

  // Drawing units to one pixel, at a place or at the target.
  pixel(place = null) {
    const pixel = 2 * this.half / this.size()[1];
    return place && this.perspective ? pixel * Math.max(0.05, 1 - dot(this.axes()[2], sub(place, this.target)) / this.distance()) : pixel;
  }

  // Where a place is drawn, in pixels from the upper left corner.
  project(place) {
    const [right, up] = this.axes();
    const from = sub(place, this.target);
    const [width, height] = this.size();
    return [width / 2 + dot(right, from) / this.pixel(place), height / 2 - dot(up, from) / this.pixel(place)];
  }

  isAhead(place) {
    return !this.perspective || dot(this.axes()[2], sub(place, this.target)) < 0.95 * this.distance();
  }

  onTarget(x, y) {
    const [right, up] = this.axes();
    const [width, height] = this.size();
    return add(this.target, add(times((x - width / 2) * this.pixel(), right), times((height / 2 - y) * this.pixel(), up)));
  }

  // From the eye through a pixel, relative to the target: where it starts, and its direction, of no particular length.
  ray(x, y) {
    const back = times(this.distance(), this.axes()[2]);
    const through = sub(this.onTarget(x, y), this.target);
    return this.perspective ? [back, sub(through, back)] : [add(through, times(10, back)), times(-1, back)];
  }

  // The camera of three.js, about the target: all that it draws is told relative to that.
  three() {
    const [right, up, back] = this.axes();
    const camera = this.cameras[Number(this.perspective)];
    const [width, height] = this.size();
    const distance = this.distance();
    const reach = this.isClose() ? this.reach() : 6 * this.radius + distance;
    camera.near = Math.max(0.04 * distance, distance - reach);
    camera.far = distance + reach;
    if (this.perspective) Object.assign(camera, { fov: this.look.field_deg, aspect: width / height });
    else Object.assign(camera, { top: this.half, bottom: -this.half, right: this.half * width / height, left: -this.half * width / height, near: distance - reach });
    const turn = new Matrix4().set(right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0, 0, 0, 0, 1);
    camera.quaternion.setFromRotationMatrix(turn);
    camera.position.set(...times(distance, back));
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld(true);
    return camera;
  }
}

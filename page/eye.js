// Where a picture is seen from, in double precision: z is up. The same formulas as in eye.py.

import { OrthographicCamera, PerspectiveCamera, Matrix4 } from "three";
import { add, cross, dot, sub, times } from "./geometry.js";

const CLOSE = 0.02; // with less than this, half the height of a picture, only what is near is drawn, and marks are rings
const REACH = 400; // times half the height: what is near
const ROUNDS_OF_FIT = 6;

export class Eye {
  // `size()` is that of the picture in pixels, `covered()` the height that something else covers of it from above.
  constructor(radius, look, size, covered = () => 0) {
    Object.assign(this, { radius, look, size, covered, perspective: true, azimuth: 0, elevation: 0, target: [0, 0, 0], half: radius });
    this.cameras = [new OrthographicCamera(), new PerspectiveCamera()];
    this.depth = this.natural = 1 / Math.tan(look.field_deg / 2 * Math.PI / 180); // how far off the eye is, in halves of a picture
  }

  // Brings places into view, from the same side, and from so far off at least. Marks have their size in pixels, so that a
  // fit changes what `content()` returns.
  fitTo(content, leastDistance) {
    const [width, whole] = this.size();
    const covered = Math.min(this.covered(), whole / 3), height = whole - covered;
    const axes = this.axes();
    for (let round = 0; round < ROUNDS_OF_FIT; round++) {
      this.depth = Math.max(this.natural, leastDistance / this.half);
      const seen = content().map((place) => this.project(place));
      const [low, high] = [Math.min, Math.max].map((pick) => [0, 1].map((i) => seen.reduce((best, place) => pick(best, place[i]), seen[0][i])));
      const middle = [0, 1].map((i) => (low[i] + high[i]) / 2 - [width / 2, covered + height / 2][i]);
      this.target = add(this.target, add(times(middle[0] * this.pixel(), axes[0]), times(-middle[1] * this.pixel(), axes[1])));
      this.half = Math.max(0.02 * this.radius, this.half * Math.max((high[0] - low[0]) / width, (high[1] - low[1]) / height) / this.look.margin);
    }
    this.depth = Math.max(this.natural, leastDistance / this.half);
  }

  // Right, up and towards the viewer.
  axes() {
    const [a, e] = [this.azimuth, this.elevation].map((degrees) => degrees * Math.PI / 180);
    const right = [-Math.sin(a), Math.cos(a), 0];
    const back = [Math.cos(a) * Math.cos(e), Math.sin(a) * Math.cos(e), Math.sin(e)];
    return [right, cross(back, right), back];
  }

  distance() {
    return this.half * this.depth;
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

  // The camera of three.js, relative to a place as all that it draws is.
  three(origin = this.target) {
    const [right, up, back] = this.axes();
    const camera = this.cameras[Number(this.perspective)];
    const [width, height] = this.size();
    const distance = this.distance();
    const reach = this.isClose() ? this.reach() : 6 * this.radius + distance;
    camera.near = Math.max(0.04 * distance, distance - reach);
    camera.far = distance + reach;
    if (this.perspective) Object.assign(camera, { fov: 2 * Math.atan(1 / this.depth) * 180 / Math.PI, aspect: width / height });
    else Object.assign(camera, { top: this.half, bottom: -this.half, right: this.half * width / height, left: -this.half * width / height, near: distance - reach });
    const turn = new Matrix4().set(right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0, 0, 0, 0, 1);
    camera.quaternion.setFromRotationMatrix(turn);
    camera.position.set(...sub(add(this.target, times(distance, back)), origin));
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld(true);
    return camera;
  }
}

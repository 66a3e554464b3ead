// Where the viewer stands, in double precision: z is up. Drag turns, shift or the right button moves, and the wheel or two
// fingers zoom to what is under them.

import { Eye } from "./eye.js";
import { add, dot, sub, times } from "./geometry.js";

const VIEWS = { corner: [-56, 24], x: [180, 0], y: [-90, 0], z: [-90, 90] };
const LEAST_HALF = 2e-9, MOST_HALF = 20; // half the height of a picture, in drawing units
const CLICK = 4; // pixels: the most that a click moves

export class Camera extends Eye {
  // `content()` returns the places that a view is fitted to, `leastDistance()` from how far off at least, `under(x, y)` the
  // place that is seen at a pixel or null, and `covered()` the height in pixels that something else covers from above.
  // `cutAway()` is the normal toward what is cut away, or null. `grabbed(x, y)` returns what takes the way of a pointer that
  // is pressed there, in drawing units, and null when it is let go; null: the pointer turns the view.
  constructor(canvas, { radius, look }, { content, leastDistance, under, covered, cutAway, changed, clicked, grabbed }) {
    super(radius, look, () => [Math.max(1, canvas.clientWidth), Math.max(1, canvas.clientHeight)], covered);
    Object.assign(this, { canvas, content, leastDistance, under, cutAway, changed, clicked, grabbed, carry: null, pointers: new Map(), travelled: 0 });
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

  // A view by its name: of what is cut, from the side that was cut away.
  home(name) {
    const [azimuth, elevation] = VIEWS[name], normal = this.cutAway();
    for (const [turn, side] of normal ? [[0, 1], [180, 1], [0, -1], [180, -1]] : [[0, 1]]) {
      [this.azimuth, this.elevation] = [azimuth + turn, side * elevation];
      if (!normal || dot(normal, this.axes()[2]) > -1e-9) break;
    }
    this.fit();
  }

  fit() {
    this.fitTo(this.content, this.leastDistance());
    this.changed();
  }

  // Looks at a place from a direction and so far off, at so many drawing units of height.
  lookAt(place, back, half, distance = this.natural * half) {
    this.depth = distance / half;
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
}

// A small picture of the whole in the corner of a picture of a part, seen from the same side, with the part framed.

import { Eye } from "./eye.js";
import { sub, times } from "./geometry.js";
import { $ } from "./words.js";

const BORDER = "#b8bcc2", FRAME = "#1a1a1a", LETTERS = 11;
const ARROW = 20, HEAD = 6; // pixels: of a load that is not in the picture itself
const LEAST_PART = 0.85; // of the height of the whole: a picture of more needs no inset

export class Inset {
  constructor({ radius, look }, camera) {
    Object.assign(this, { camera, look });
    this.eye = new Eye(radius, look, () => this.size);
  }

  // Where the picture shows a part of the whole alone, of which these are the corners, the inset shows that; else, and close
  // by, there is none.
  update(corners) {
    const { eye, camera } = this, [wide] = camera.size();
    this.size = this.look.inset.map((share) => Math.round(share * wide));
    const { azimuth, elevation, perspective } = camera;
    Object.assign(eye, { azimuth, elevation, perspective });
    eye.fitTo(() => corners, this.look.distance_of_eye * eye.radius);
    this.isShown = !camera.isClose() && this.part < LEAST_PART;
    const told = [this.isShown, ...this.corner, ...this.size].join();
    if (told !== this.told) this.layButton(); // laying out the page anew for each picture would cost more than the picture
    this.told = told;
  }

  layButton() {
    const [left, top] = this.corner, [width, height] = this.size;
    Object.assign($("whole").style, { left: `${left}px`, top: `${top}px`, width: `${width}px`, height: `${height}px` });
    $("whole").hidden = !this.isShown;
  }

  // How much of the height of the inset the picture shows.
  get part() {
    return this.camera.half / this.eye.half;
  }

  get corner() {
    const [width, height] = this.camera.size(), [across, down] = this.eye.size(), [right, below] = this.look.inset_from_edge;
    return [width - across - right, height - down - below];
  }

  get box() {
    return this.isShown ? [[...this.corner, ...this.eye.size()]] : [];
  }

  // `loads` are those that are not in the picture: where they act, their directions and names.
  draw(overlay, loads) {
    const { eye, camera } = this, { pen } = overlay, [left, top] = this.corner, [across, down] = eye.size();
    const on = (place) => eye.project(place).map((value, axis) => value + this.corner[axis]);
    pen.save();
    pen.beginPath();
    pen.rect(left, top, across, down);
    pen.clip();
    const [x, y] = on(camera.target), pixel = eye.pixel(camera.target);
    const [halfAcross, halfDown] = camera.size().map((size) => size / 2 * camera.pixel() / pixel);
    pen.lineWidth = 1;
    pen.strokeStyle = FRAME;
    pen.strokeRect(x - halfAcross, y - halfDown, 2 * halfAcross, 2 * halfDown);
    pen.font = `${LETTERS}px system-ui, sans-serif`;
    for (const { at, direction, name } of loads) {
      const [tip, tail] = [at, sub(at, times(ARROW * eye.pixel(at), direction))].map(on);
      overlay.line(tail, tip, FRAME, 2);
      const angle = Math.atan2(tip[1] - tail[1], tip[0] - tail[0]);
      for (const side of [-2.6, 2.6]) overlay.line(tip, [tip[0] + HEAD * Math.cos(angle + side), tip[1] + HEAD * Math.sin(angle + side)], FRAME, 2);
      const width = pen.measureText(name).width;
      overlay.text(name, Math.max(left + 3, Math.min(left + across - width - 3, tail[0] - width / 2)), Math.max(top + LETTERS + 2, tail[1] - 5), FRAME);
    }
    pen.restore();
    pen.lineWidth = 1;
    pen.strokeStyle = BORDER;
    pen.strokeRect(left + 0.5, top + 0.5, across - 1, down - 1);
  }
}

// The force of a drive over its way, with a mark at the present time.

import { blankChart } from "./chart.js";
import { digits } from "./words.js";

const COLOR = "#d55e00", LEFT = 56, RIGHT = 8, ABOVE = 8, BELOW = 18; // pixels around the curve
export const NOISE = 1e-9; // of the greatest force of a contact: less than this is none

export class ForceCurve {
  constructor(canvas, seek) {
    this.canvas = canvas;
    const move = (event) => this.drive && seek(this.timeAt((event.offsetX - LEFT) / (canvas.clientWidth - LEFT - RIGHT)));
    canvas.addEventListener("pointerdown", move);
    canvas.addEventListener("pointermove", (event) => event.buttons && move(event));
  }

  // The time at which so much of the drive of the phase on screen is done: where it snaps, when it begins to.
  timeAt(share) {
    const { shots, phases } = this.data;
    const { last } = phases[this.phase];
    const first = this.phase ? phases[this.phase - 1].last + 1 : 0;
    const next = shots.findIndex((shot, time) => time >= first && time <= last && shot.share >= share);
    if (next < 0) return last;
    const before = next > first ? shots[next - 1].share : 0;
    return next > first && shots[next].share > before ? next - 1 + Math.max(0, share - before) / (shots[next].share - before) : next;
  }

  // `now`: how much of the drive is done, and its force; null: it has not begun.
  draw(data, phase, now) {
    Object.assign(this, { data, phase, drive: data.phases[phase].drive });
    const { drive } = this;
    if (!drive) return;
    const { pen, width, height } = blankChart(this.canvas);
    const { greatestForce } = data.phases[phase], noise = NOISE * greatestForce;
    const curve = drive.curve.map(([share, along]) => [share, Math.abs(along) < noise ? 0 : along]);
    const forces = [0, ...curve.map(([, along]) => along)];
    const [least, most] = [Math.min(...forces), Math.max(...forces)];
    const range = most > least ? most - least : greatestForce;
    const [low, high] = [least - 0.05 * range, least + 1.08 * range];
    const x = (share) => LEFT + (width - LEFT - RIGHT) * share;
    const y = (along) => ABOVE + (height - ABOVE - BELOW) * (high - along) / (high - low);
    pen.fillStyle = "#5c5c5c";
    pen.textAlign = "right";
    const power = 10 ** Math.floor(Math.log10(range));
    const step = power * (range / power > 4 ? 2 : range / power > 2 ? 1 : 0.5);
    for (let tick = Math.ceil(low / step) * step; tick <= high; tick += step) {
      pen.fillText(`${digits(tick, 1e-3 * step)}`, LEFT - 4, y(tick) + 4);
      this.stroke(pen, [[LEFT, y(tick)], [width - RIGHT, y(tick)]], Math.abs(tick) < 1e-3 * step ? "#bbb" : "#eee");
    }
    pen.textAlign = "center";
    for (const share of [0, 0.25, 0.5, 0.75, 1]) pen.fillText(`${100 * share} %`, Math.min(x(share), width - 20), height - 4);
    if (drive.reached < 1) { // what was left undone
      pen.fillStyle = "#f0f0f0";
      pen.fillRect(x(drive.reached), ABOVE, x(1) - x(drive.reached), height - ABOVE - BELOW);
    }
    this.stroke(pen, curve.map(([share, along]) => [x(share), y(along)]), COLOR, 1.8);
    if (!now) return;
    this.stroke(pen, [[x(now.share), ABOVE], [x(now.share), height - BELOW]], "#000");
    pen.fillStyle = COLOR;
    pen.beginPath();
    pen.arc(x(now.share), y(now.along), 4, 0, 2 * Math.PI);
    pen.fill();
  }

  stroke(pen, points, color, width = 1) {
    pen.strokeStyle = color;
    pen.lineWidth = width;
    pen.beginPath();
    points.forEach((point) => pen.lineTo(...point));
    pen.stroke();
  }
}

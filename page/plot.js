// Yaw, pitch and roll along the film, with a line at each event's end and one at the present time.

import { blankChart } from "./chart.js";
import { digits } from "./words.js";

const CURVES = [["yaw", "#0072b2", []], ["pitch", "#d55e00", [6, 3]], ["roll", "#009e73", [2, 2]]];

const LEAST_RANGE = 1e-6; // degrees; what turns less than this stands still
const LEFT = 56, RIGHT = 6; // pixels beside the curves

export class Plot {
  constructor(canvas, seek) {
    this.canvas = canvas;
    const move = (event) => seek(this.timeAt(event.offsetX));
    canvas.addEventListener("pointerdown", move);
    canvas.addEventListener("pointermove", (event) => event.buttons && move(event));
  }

  fit(data) {
    this.data = data;
    const angles = data.shots.flatMap((shot) => shot.angles);
    const [low, high] = [Math.min(...angles), Math.max(...angles)];
    const room = high - low > LEAST_RANGE ? 0.08 * (high - low) : 1;
    [this.low, this.high] = [low - room, high + room];
  }

  timeAt(x) {
    const width = this.canvas.clientWidth - LEFT - RIGHT;
    return Math.max(0, Math.min(1, (x - LEFT) / width)) * (this.data.shots.length - 1);
  }

  draw(time) {
    const { pen, width, height } = blankChart(this.canvas);
    const n = Math.max(1, this.data.shots.length - 1);
    const x = (shot) => LEFT + (width - LEFT - RIGHT) * shot / n;
    const y = (angle) => 16 + (height - 22) * (this.high - angle) / (this.high - this.low);
    for (const row of this.data.rows) this.stroke(pen, [[x(row.last), 16], [x(row.last), height - 6]], row.verdict ? "#d55e00" : "#e3e3e3", row.verdict ? [5, 3] : []);
    pen.fillStyle = "#5c5c5c";
    pen.textAlign = "right";
    const range = this.high - this.low;
    const power = 10 ** Math.floor(Math.log10(range));
    const step = power * (range / power > 4 ? 2 : 0.5);
    for (let tick = Math.ceil(this.low / step) * step; tick <= this.high; tick += step) {
      pen.fillText(`${digits(tick, 1e-3 * step)}`, LEFT - 4, y(tick) + 4);
      this.stroke(pen, [[LEFT, y(tick)], [width - RIGHT, y(tick)]], "#eee", []);
    }
    pen.textAlign = "left";
    CURVES.forEach(([name, color, dashes], which) => {
      this.stroke(pen, this.data.shots.map((shot, i) => [x(i), y(shot.angles[which])]), color, dashes, 1.8);
      pen.fillStyle = color;
      pen.fillText(name, LEFT + 4 + 44 * which, 11);
    });
    this.stroke(pen, [[x(time), 12], [x(time), height]], "#000", []);
  }

  stroke(pen, points, color, dashes, width = 1) {
    pen.strokeStyle = color;
    pen.lineWidth = width;
    pen.setLineDash(dashes);
    pen.beginPath();
    points.forEach((point) => pen.lineTo(...point));
    pen.stroke();
    pen.setLineDash([]);
  }
}

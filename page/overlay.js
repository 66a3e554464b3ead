// What is written over the picture: names, axes and a scale.

import { laidOut } from "./labels.js";

const PAPER = "#f6f7f9", HEIGHT = 13, HEAD = 14;

export class Overlay {
  constructor(canvas) {
    this.canvas = canvas;
    this.written = [];
  }

  // `labels` are places, names, and whether they matter: those that do choose their places first.
  write(labels, camera, data, scale) {
    const [width, height] = camera.size();
    if (this.canvas.width !== Math.round(width * scale)) this.canvas.width = Math.round(width * scale); // setting it anew, even to the same, costs a frame
    if (this.canvas.height !== Math.round(height * scale)) this.canvas.height = Math.round(height * scale);
    const pen = this.pen = this.canvas.getContext("2d");
    pen.setTransform(scale, 0, 0, scale, 0, 0);
    pen.font = `${HEIGHT}px system-ui, sans-serif`;
    pen.clearRect(0, 0, width, height);
    const seen = labels.filter(([place]) => camera.isAhead(place)).map(([place, text, isLoud]) => ({ place: camera.project(place), text, isLoud, size: [pen.measureText(text).width, HEIGHT] }))
      .filter(({ place: [x, y] }) => x > -20 && y > -20 && x < width + 20 && y < height + 20).sort((one, other) => other.isLoud - one.isLoud);
    const corners = laidOut(seen, [width, height]);
    this.written = [];
    seen.forEach(({ text, isLoud, size }, which) => {
      if (!corners[which]) return;
      this.text(text, corners[which][0], corners[which][1] + 0.85 * HEIGHT, isLoud ? "#000" : "#666");
      this.written.push({ text, corner: corners[which], size });
    });
    this.drawAxes(camera, height);
    this.drawScale(camera, data, width, height);
  }

  text(text, x, y, color) {
    this.pen.lineWidth = 3;
    this.pen.strokeStyle = PAPER;
    this.pen.lineJoin = "round";
    this.pen.strokeText(text, x, y);
    this.pen.fillStyle = color;
    this.pen.fillText(text, x, y);
  }

  line(from, to, color) {
    this.pen.strokeStyle = color;
    this.pen.lineWidth = 2;
    this.pen.beginPath();
    this.pen.moveTo(...from);
    this.pen.lineTo(...to);
    this.pen.stroke();
  }

  // From a ball to a tip, over all else.
  arrow([x, y], tip, color) {
    const { pen } = this, way = [tip[0] - x, tip[1] - y], length = Math.hypot(...way) || 1;
    const [along, head] = [way.map((part) => part / length), Math.min(HEAD, 0.7 * length)];
    const place = (back, aside) => [tip[0] - back * along[0] - aside * along[1], tip[1] - back * along[1] + aside * along[0]];
    for (const [width, paint] of [[7, PAPER], [4, color]]) {
      pen.lineJoin = "round";
      pen.lineWidth = width;
      pen.strokeStyle = pen.fillStyle = paint;
      pen.beginPath();
      pen.moveTo(x, y);
      pen.lineTo(...place(head, 0));
      pen.stroke();
      pen.beginPath();
      pen.arc(x, y, width, 0, 2 * Math.PI);
      pen.fill();
      pen.beginPath();
      for (const corner of [tip, place(head, 0.5 * head), place(head, -0.5 * head)]) pen.lineTo(...corner);
      pen.closePath();
      if (paint === PAPER) pen.stroke();
      pen.fill();
    }
  }

  drawAxes(camera, height) {
    const [right, up] = camera.axes();
    const corner = [44, height - 44];
    [["x", "#d55e00"], ["y", "#009e73"], ["z", "#0072b2"]].forEach(([name, color], axis) => {
      const tip = [corner[0] + 28 * right[axis], corner[1] - 28 * up[axis]];
      this.line(corner, tip, color);
      this.text(name, tip[0] + 3, tip[1] - 2, color);
    });
  }

  // Lengths of the object are true at every exaggeration; only its motion and the gaps are not. In perspective the scale
  // is that of the depth one looks at.
  drawScale(camera, { unitsPerDrawing, unit }, width, height) {
    const rough = 100 * camera.pixel() * unitsPerDrawing;
    const power = 10 ** Math.floor(Math.log10(rough));
    const length = power * [5, 2, 1].find((step) => step * power <= rough);
    const pixels = length / unitsPerDrawing / camera.pixel();
    const [x, y] = [width - 20 - pixels, height - 20];
    this.line([x, y], [x + pixels, y], "#333");
    for (const end of [x, x + pixels]) this.line([end, y - 4], [end, y + 4], "#333");
    this.text(lengthWords(length, unit), x, y - 8, "#333");
  }
}

// In micrometres or nanometres where millimetres would be mostly zeros.
function lengthWords(length, unit) {
  const metres = { mm: 1e-3, m: 1 }[unit];
  for (const [name, size] of metres ? [["\u00b5m", 1e-6], ["nm", 1e-9]] : []) {
    if (length * metres < 1000 * size && length * metres >= 0.9 * size && length < 0.01) return `${+(length * metres / size).toPrecision(2)} ${name}`;
  }
  return `${+length.toPrecision(2)} ${unit}`;
}

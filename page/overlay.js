// What is written over the picture: names, axes and a scale.

import { add, times } from "./geometry.js";
import { laidOut, leader } from "./labels.js";

const PAPER = "#f6f7f9", LEADER = "#8a8a8a", GAP = "#7b2d8e", HEIGHT = 13, HEAD = 14;
const TIP = [8, 3]; // of a dimension's arrow: length, and half its width
const ROOM = 24, OUTSIDE = 16; // pixels: a shorter dimension has its arrows outside, so long

export class Overlay {
  constructor(canvas) {
    this.canvas = canvas;
    this.written = [];
  }

  // `labels` are places, names and ranks, those of higher rank choose their places first; a force is written behind its
  // name; one of rank 0 is not moved away to where there is room. `dimensions` have two ends, and the normal that leads from
  // the one to the other. `taken` are boxes that no name may cover.
  write(labels, dimensions, camera, data, scale, taken) {
    const [width, height] = camera.size();
    if (this.canvas.width !== Math.round(width * scale)) this.canvas.width = Math.round(width * scale); // setting it anew, even to the same, costs a frame
    if (this.canvas.height !== Math.round(height * scale)) this.canvas.height = Math.round(height * scale);
    const pen = this.pen = this.canvas.getContext("2d");
    pen.setTransform(scale, 0, 0, scale, 0, 0);
    pen.font = `${HEIGHT}px system-ui, sans-serif`;
    pen.clearRect(0, 0, width, height);
    for (const { ends: [from, to], normal } of dimensions) {
      if (camera.isAhead(from) && camera.isAhead(to)) this.dimension(...[from, to, add(to, times(camera.pixel(to), normal))].map((place) => camera.project(place)));
    }
    const seen = labels.filter(({ place }) => camera.isAhead(place)).map((label) => {
      const words = [label.text, label.force].filter(Boolean).join("  ");
      return { ...label, words, place: camera.project(label.place), moves: label.rank > 0, size: [pen.measureText(words).width, HEIGHT] };
    }).filter(({ place: [x, y] }) => x > 0 && y > 0 && x < width && y < height).sort((one, other) => other.rank - one.rank);
    const corners = laidOut(seen, [width, height], taken);
    this.written = [];
    seen.forEach(({ text, force, words, place, rank, size, color }, which) => {
      const corner = corners[which];
      if (!corner) return;
      const end = leader(place, corner, size);
      if (end) this.line(place, end, LEADER, 1);
      this.text(words, corner[0], corner[1] + 0.85 * HEIGHT, color ?? (rank ? "#000" : "#666"));
      this.written.push({ text, force, place, corner, size, leads: Boolean(end) });
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

  // A line between two ends, toward a third place, with arrows at both; they point at each other where there is no room
  // between.
  dimension(from, to, beyond) {
    const length = Math.hypot(to[0] - from[0], to[1] - from[1]), toward = [beyond[0] - to[0], beyond[1] - to[1]];
    const size = Math.hypot(...toward) || 1, way = toward.map((part) => part / size);
    const on = ([x, y], along, aside = 0) => [x + along * way[0] - aside * way[1], y + along * way[1] + aside * way[0]];
    const isNarrow = length < ROOM;
    for (const [color, width] of [[PAPER, 4.5], [GAP, 1.8]]) {
      this.line(...(isNarrow ? [on(from, -OUTSIDE), on(to, OUTSIDE)] : [from, to]), color, width);
      [[from, isNarrow ? -1 : 1], [to, isNarrow ? 1 : -1]].forEach(([end, side]) => {
        for (const aside of [TIP[1], -TIP[1]]) this.line(end, on(end, side * TIP[0], aside), color, width);
      });
    }
  }

  line(from, to, color, width = 2) {
    this.pen.strokeStyle = color;
    this.pen.lineWidth = width;
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

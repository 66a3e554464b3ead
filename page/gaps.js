// Gaps with numbers: the list beside the picture, and dimensions in it. They are known where motions end.

import { add, carried, conjugate, dot, rotated, sub, times } from "./geometry.js";
import { $, element, gapWords } from "./words.js";

const MOST = 6; // gaps that are told, unless something is picked
const OTHER_WAY = -0.5; // cosine: of two parts, a second gap is told if it leads the other way, as in a slot

const NUMBERS = 9; // of each gap: its foot, its place and its normal

function numbersIn(base64) {
  const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0)), view = new DataView(bytes.buffer);
  return Float64Array.from({ length: bytes.length / 4 }, (_, i) => view.getFloat32(4 * i, true));
}

const triples = (numbers, first) => Array.from({ length: numbers.length / NUMBERS }, (_, i) => [...numbers.subarray(NUMBERS * i + first, NUMBERS * i + first + 3)]);

export class Gaps {
  constructor(changed) {
    this.element = null; // of the cage, whose gaps are told; null: the narrowest ones of all
    this.isWhole = false; // whether all of them are
    this.isShown = false; // in the picture
    this.changed = changed;
    $("gapsall").addEventListener("click", () => {
      this.isWhole = this.element === null && !this.isWhole;
      this.pick(null);
      changed();
    });
    $("dimensions").addEventListener("change", () => { this.isShown = $("dimensions").checked; changed(); });
  }

  take(data, stage) {
    Object.assign(this, { data, stage });
    this.moments = new Map(data.clearances.map(({ shot, elements, parts, gaps, where }) => {
      const numbers = numbersIn(where), [feet, places, normals] = [0, 3, 6].map((first) => triples(numbers, first));
      return [shot, gaps.map((gap, i) => ({ point: elements[i], part: parts[i], gap, foot: feet[i], place: places[i], normal: normals[i], cage: stage.shots[shot].cage }))];
    }));
    if (this.element >= data.names.length) this.element = null;
  }

  pick(element) {
    this.element = element;
  }

  // What is told at a time; null: it is not known.
  at(time) {
    const known = this.moments.get(time);
    if (!known) return null;
    if (this.element !== null) return known.filter(({ point }) => point === this.element);
    if (this.isWhole) return known;
    const told = [];
    for (const one of known) {
      const isOther = told.every(({ point, part, normal }) => point !== one.point || part !== one.part || dot(normal, one.normal) < OTHER_WAY);
      if (one.gap > 0 && isOther) told.push(one);
    }
    return told.slice(0, MOST);
  }

  // Both ends of each dimension, as they are shown, and its words. Where one slid past the other, which is exaggerated, too,
  // it is between: a dimension leads along the normal.
  dimensions(time, look, pose) {
    if (!this.isShown && this.element === null) return [];
    return (this.at(time) ?? []).filter(({ gap }) => gap > 0).map((told) => {
      const [from, to] = [this.foot(told, look, pose), this.stage.place(told, look)];
      const half = times(Math.max(0, dot(sub(to, from), told.normal)) / 2, told.normal), middle = times(0.5, add(from, to));
      return { ends: [sub(middle, half), add(middle, half)], normal: told.normal, text: gapWords(told.gap, this.data.unit) };
    });
  }

  // Where the end on the object is shown: that on the wall of a hole is as far out as the hole is wider.
  foot({ part, foot }, look, pose) {
    const { parts, holes } = this.data;
    const hole = holes[part - parts.length];
    if (!hole) return carried(pose, foot);
    const at = { p: hole.position, q: hole.quaternion };
    const [x, y] = rotated(conjugate(at.q), sub(foot, at.p));
    const out = (look.factor - 1) * hole.play / (Math.hypot(x, y) || 1);
    return carried(pose, add(foot, rotated(at.q, [out * x, out * y, 0])));
  }

  show(time) {
    const { data } = this, told = this.at(time);
    $("gapsof").textContent = this.element !== null ? `of ${data.names[this.element]}` : this.isWhole ? "" : "the narrowest";
    $("gapsall").textContent = this.element === null && !this.isWhole ? "show all" : "show the narrowest";
    $("gaplist").tBodies[0].replaceChildren(...(told ?? []).map(({ point, part, gap }) => {
      const line = element("tr", ""), name = element("td", ""), button = element("button", data.names[point], "link");
      button.addEventListener("click", () => { this.pick(point); this.changed(); });
      name.append(button, ` to ${data.partNames[part]}`);
      line.append(name, element("td", gap > 0 ? gapWords(gap, data.unit) : "touches"));
      return line;
    }));
    const touching = this.moments.get(time)?.filter(({ gap }) => gap === 0).length;
    $("gapnote").textContent = told === null ? "Gaps are known at the end of each motion: go there with the arrows below." : told.length ? ""
      : this.element !== null ? "No gap: it is too far away, or something is in between." : touching ? "Everything nearby touches." : "No gap was found.";
  }
}

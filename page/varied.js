// What comes of other values of one number: its study is run bit by bit beside everything else, and drawn as it grows.

import { LOST, post } from "./asking.js";
import { blankChart } from "./chart.js";
import { norm, sub } from "./geometry.js";
import { element } from "./words.js";

const RUNS = [32, 64, 128, 512];
const USUAL_RUNS = 64;
const FIRST_SHARE = 0.01; // of the value, as its tolerance to begin with
const BIT_MS = 250, MOST_OF_A_BIT = 64; // a bit of the study takes about so long
const GOLDEN = 0.618;
const EDGE = 12, ABOVE = 20, BELOW = 20; // pixels around the dots
const CANNOT = "cannot begin";
const COLORS = { same: "#00664a", moved: "#e69f00", other: "#a33b00" };

const short = (value) => String(Number(value.toPrecision(4)));

export class Varied {
  // `text()` is the scene's text now, `around(path)` what stands in it before and behind a number; `seen(path, value)` puts a
  // value there.
  constructor(room, { text, around, seen }) {
    Object.assign(this, { room, text, around, seen, study: null });
    room.hidden = true;
  }

  // Says of a study that it is one of another text, where more than its own number differs.
  tellStale() {
    if (!this.study) return;
    const [now, then] = [this.around(this.study.path), this.study.around];
    this.stale.hidden = now !== null && now[0] === then[0] && now[1] === then[1];
  }

  close() {
    this.study = null; // what is on its way is dropped
    this.room.hidden = true;
    this.room.replaceChildren();
  }

  // Asks how far a number varies.
  ask(key, { path, value }) {
    this.study = null;
    const usual = Number((FIRST_SHARE * Math.abs(value)).toPrecision(1)) || 0.1;
    const by = Object.assign(document.createElement("input"), { type: "number", step: "any", min: 0, value: usual });
    by.setAttribute("aria-label", `tolerance of ${key}`);
    const runs = document.createElement("select");
    runs.setAttribute("aria-label", "how many runs");
    for (const count of RUNS) runs.append(Object.assign(element("option", `${count} runs`), { value: count, selected: count === USUAL_RUNS }));
    const form = element("form", "");
    const close = element("button", "\u2715");
    Object.assign(close, { type: "button", title: "close" });
    close.addEventListener("click", () => this.close());
    this.unit = element("small", "");
    form.append(element("code", key), ` = ${value} \u00B1 `, by, this.unit, runs, element("button", "run"), close);
    this.stale = element("p", "The text has been edited since; run again for what it is now.", "open");
    this.stale.hidden = true;
    this.told = element("div", "");
    this.told.setAttribute("role", "status");
    this.canvas = document.createElement("canvas");
    this.canvas.setAttribute("aria-label", `How runs end, over ${key}; click one to see it`);
    this.canvas.hidden = true;
    this.canvas.addEventListener("click", (event) => this.see(event.offsetX));
    this.room.replaceChildren(form, this.stale, this.told, this.canvas);
    this.room.hidden = false;
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      if (by.valueAsNumber > 0) this.begin({ key, path, value, by: by.valueAsNumber, count: Number(runs.value) });
      else by.focus();
    });
    by.select();
  }

  // Values lie evenly within the tolerance, each in the middle of its share of it: the share of the runs that end well is
  // that of parts whose number is anywhere in it with the same chance. They are run in an order in which few are spread, too.
  async begin({ key, path, value, by, count }) {
    const stride = 2 * Math.round(GOLDEN * count / 2) + 1; // odd, and the counts are powers of two
    const values = Array.from({ length: count }, (_, i) => Number((value - by + 2 * by * ((i * stride) % count + 0.5) / count).toPrecision(12)));
    const study = { key, path, value, by, values, text: this.text(), around: this.around(path), ends: [], isOver: false };
    this.study = study;
    this.canvas.hidden = this.stale.hidden = true;
    this.told.replaceChildren("running \u2026");
    try {
      let size = 1;
      for (let numbers = [value]; numbers.length; numbers = study.isOver ? [] : values.slice(study.ends.length, study.ends.length + size)) {
        const began = performance.now();
        const found = await (await post("vary", { text: study.text, key, numbers })).json();
        if (this.study !== study) return; // closed, or another one has begun
        const problem = found.problems?.join(" ") ?? (study.nominal ? null : found.runs[0].problem);
        if (problem) return this.fail(problem);
        if (study.nominal) study.ends.push(...found.runs);
        else Object.assign(study, { nominal: found.runs[0], unit: found.unit, lengthUnit: found.lengthUnit, noise: found.noise });
        size = Math.max(1, Math.min(MOST_OF_A_BIT, Math.round(size * Math.min(4, BIT_MS / (performance.now() - began)))));
        this.show();
      }
    } catch (error) {
      if (!(error instanceof TypeError)) throw error; // what a lost connection is told by
      this.fail(LOST);
    }
  }

  fail(problem) {
    this.study = null;
    this.told.replaceChildren(element("p", problem, "failure"));
    this.canvas.hidden = true;
  }

  // The runs so far: the value of each, how it ended beside the run of the text as it is, and how far from that.
  get rows() {
    const { values, ends, nominal } = this.study;
    return ends.map((end, i) => ({ value: values[i], end, kind: kindOf(end, nominal), away: away(end, this.study) }));
  }

  show() {
    const { study, rows } = this;
    if (rows.length === study.values.length) study.isOver = true;
    const numberOf = (kind) => rows.filter((row) => row.kind === kind).length;
    const well = numberOf("same") + numberOf("moved");
    const others = new Map();
    for (const { kind, end } of rows) if (kind === "other") others.set(end.verdict ?? CANNOT, (others.get(end.verdict ?? CANNOT) ?? 0) + 1);
    const lines = rows.length ? [["same", `${+(100 * well / rows.length).toFixed(1)} % end as now (${study.nominal.verdict}): ${well} of ${rows.length} runs`]] : [];
    if (numberOf("moved")) lines.push(["moved", `${numberOf("moved")} of these at other contacts`]);
    for (const [verdict, number] of others) lines.push(["other", `${number} ${verdict}`]);
    this.told.replaceChildren(...lines.flatMap(([kind, words], i) => [i ? "; " : "", coloured(kind), i ? words : element("strong", words)]), " ");
    const cancel = element("button", "cancel");
    cancel.type = "button";
    cancel.addEventListener("click", () => { study.isOver = true; this.show(); });
    if (!study.isOver) this.told.append(element("small", `${study.values.length} are to be run `), cancel);
    else if (rows.length < study.values.length) this.told.append(element("small", `cancelled; ${study.values.length} were to be run`));
    this.unit.textContent = study.unit;
    this.canvas.hidden = !rows.length;
    this.draw();
  }

  // A dot for each run: across, the value; up, how far from the nominal end the part's centre of gravity is at its end. Runs
  // that end otherwise are in a row above.
  draw() {
    if (this.canvas.hidden) return;
    const { study: { value, by, lengthUnit }, rows } = this;
    const { pen, width, height } = blankChart(this.canvas);
    const most = Math.max(0, ...rows.map(({ kind, away }) => (kind === "other" ? 0 : away ?? 0)));
    const across = (number) => EDGE + (width - 2 * EDGE) * (number - value + by) / (2 * by);
    const up = (away) => height - BELOW - (height - BELOW - ABOVE - 8) * (most ? away / most : 0);
    pen.fillStyle = "#5c5c5c";
    pen.fillText(most ? `end moved by up to ${short(most)} ${lengthUnit}` : "the end does not move", EDGE, 11);
    [[value - by, "left"], [value, "center"], [value + by, "right"]].forEach(([number, align]) => {
      pen.textAlign = align;
      pen.fillText(short(number), across(number), height - 4);
    });
    pen.textAlign = "left";
    pen.fillStyle = "#d9d9d9";
    pen.fillRect(across(value), ABOVE, 1, height - BELOW - ABOVE);
    for (const { value: number, away, kind } of rows) {
      pen.fillStyle = COLORS[kind];
      pen.beginPath();
      if (kind === "other") pen.rect(across(number) - 2.5, ABOVE - 2.5, 5, 5);
      else pen.arc(across(number), up(away), 2.5, 0, 2 * Math.PI);
      pen.fill();
    }
  }

  // Puts the value of the run that is nearest to a click into the text.
  see(x) {
    const { study: { value, by, path }, rows } = this;
    const wanted = value - by + 2 * by * (x - EDGE) / (this.canvas.clientWidth - 2 * EDGE);
    const nearest = rows.reduce((best, row) => (Math.abs(row.value - wanted) < Math.abs(best.value - wanted) ? row : best));
    this.seen(path, nearest.value);
  }
}

// How far from the nominal end a run ended; null: nowhere.
function away({ center }, { nominal, noise }) {
  const far = center && nominal.center && norm(sub(center, nominal.center));
  return far !== null && far < noise ? 0 : far;
}

function coloured(kind) {
  const made = element("span", kind === "other" ? "\u25A0 " : "\u25CF ");
  made.style.color = COLORS[kind];
  return made;
}

// How a run ended beside the nominal one: the same, on other contacts, or otherwise.
function kindOf(end, nominal) {
  if (end.problem || end.verdicts.join() !== nominal.verdicts.join()) return "other";
  return end.touching.join() === nominal.touching.join() ? "same" : "moved";
}

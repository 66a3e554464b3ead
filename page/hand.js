// Pulling at the part: a force at the place that was pressed, along the way of the pointer and as long as that. Each
// answer goes on from the rest that the one before has led to.

import { add, norm, times } from "./geometry.js";
import { $ } from "./words.js";

const FULL = 100; // pixels of way pull as hard as the greatest force that acts besides
const LEAST = 4; // pixels: less is a click

export class Hand {
  // `values()` are those of the sliders; `show(answer, phase)` shows a run that was led on from the end of a phase, and
  // `restart()` that which the sliders ask for; `refuse(why)` says why nobody can pull.
  constructor(asker, grips, { values, show, restart, refuse }) {
    Object.assign(this, { asker, values, show, refuse });
    $("handback").addEventListener("click", restart);
    this.start(grips);
  }

  // The part is where the sliders have it.
  start(grips) {
    this.grips = grips;
    this.led = this.at = null; // where it was led to; what is held
    this.pull = [0, 0, 0]; // pixels, along the axes of the world
    this.tell("");
  }

  // Takes hold of a place in the part's frame, in a phase that is on screen; returns what takes the way of the pointer, in
  // pixels, and null when it is let go. Null: nobody can pull there.
  take(at, phase) {
    const isLed = this.led && phase > this.led.phase;
    const from = isLed ? this.led.phase : phase;
    const { refused } = this.grips[from];
    if (refused) {
      this.refuse(refused);
      return null;
    }
    if (!isLed) this.led = { phase: from, way: [], says: "" };
    Object.assign(this, { at, pull: [0, 0, 0], asked: false });
    return (way) => this.carry(way);
  }

  carry(way) {
    if (!this.at) return; // the sliders have taken it away
    if (way) this.pull = add(this.pull, way);
    if (way ? !this.asked && norm(this.pull) < LEAST : !this.asked) return;
    if (!way) this.pull = [0, 0, 0];
    this.asked = true;
    this.ask();
    if (!way) this.at = null;
    this.tell(this.led.says);
  }

  get grip() {
    return this.grips[this.led.phase];
  }

  get force() {
    return times(this.grip.greatest / FULL, this.pull);
  }

  ask() {
    const at = this.at;
    let force;
    this.asker.ask("pull", () => {
      force = this.force;
      return { values: this.values(), pull: { phase: this.led.phase, way: this.led.way, at, force } };
    }, (answer) => {
      Object.assign(this, { led: answer.led, shownForce: force });
      this.show(answer, answer.led.phase);
      this.tell(answer.led.says);
    });
  }

  // What the picture shows of it.
  get arrow() {
    return this.at && norm(this.pull) >= LEAST ? { at: this.at, pull: this.pull, text: this.words } : null;
  }

  get words() {
    const { unit, of } = this.grip, size = norm(this.force);
    const parts = of && `${+(size / of[1]).toPrecision(2)} \u00D7 ${of[0]}`;
    return unit === "N" ? [`${+size.toPrecision(3)} N`, parts].filter(Boolean).join(" = ") : parts;
  }

  tell(says) {
    $("hand").hidden = !(this.led && (says || this.at));
    $("handsays").textContent = this.at ? [this.words, says].filter(Boolean).join(": ") : says;
  }
}

// Pulling at the part: a force at the place that was pressed, along the way of the pointer and as long as that. Each
// answer goes on from the rest that the one before has led to.

import { add, norm, times } from "./geometry.js";
import { $ } from "./words.js";

const FULL = 100; // pixels of way pull as hard as the greatest force that acts besides
const LEAST = 4; // pixels: less is a click

export class Hand {
  // `scene()` is what the sliders and the text say; `show(answer, phase)` shows a run that was led on from the end of a phase, and
  // `restart()` that which the sliders ask for; `refuse(why)` says why nobody can pull.
  constructor(asker, grips, { scene, show, restart, refuse }) {
    Object.assign(this, { asker, scene, show, refuse });
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
    const begun = isLed ? this.led : { phase: from, way: [] };
    let isPulled = false; // else it is a click
    Object.assign(this, { at, pull: [0, 0, 0] });
    return (way) => {
      if (!this.at) return; // the sliders have taken it away
      this.pull = way ? add(this.pull, way) : [0, 0, 0];
      if (!isPulled && norm(this.pull) >= LEAST) [isPulled, this.led, this.says] = [true, begun, ""];
      if (isPulled) this.ask();
      if (!way) this.at = null;
      if (isPulled) this.tell(this.says);
    };
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
      return { ...this.scene(), pull: { phase: this.led.phase, way: this.led.way, at, force } };
    }, (answer) => {
      Object.assign(this, { led: answer.led, says: answer.led.says, shownForce: force });
      this.show(answer, answer.led.phase);
      this.tell(this.says);
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

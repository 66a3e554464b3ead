// What is told of one contact: names, gap, force, normal, friction.

import { norm, rotated } from "./geometry.js";
import { $, digits, element } from "./words.js";

const DIRECTION_NOISE = 1e-9;

export class Card {
  constructor(zoom, changed) {
    this.touch = null;
    $("zoom").addEventListener("click", () => { if (this.touch) zoom(this.touch); });
    $("close").addEventListener("click", () => { this.pick(null); changed(); });
  }

  pick(touch) {
    this.touch = touch;
  }

  // A contact goes on being told while it lasts: in another shot, one of the same two.
  show(data, stage, time) {
    const shot = stage.shot(time);
    const touch = shot.touches.includes(this.touch) ? this.touch : this.touch && shot.touches.find(({ point, box }) => point === this.touch.point && box === this.touch.box);
    $("card").hidden = !touch;
    if (!touch) return;
    const normal = rotated(shot.pose.q, touch.normal).map((value) => digits(value, DIRECTION_NOISE));
    const lines = [["gap", "none: they touch"],
      ["normal", `(${normal.map((value) => +value.toPrecision(4)).join(", ")})`]];
    if (touch.force) {
      const { normal: along, across } = stage.parts(touch);
      const { greatestForce, forceUnit } = data.phases[shot.phase], noise = 1e-9 * greatestForce;
      const used = touch.friction > 0 && along > noise ? `${Math.round(100 * across / (touch.friction * along))} % of ${+touch.friction.toPrecision(3)}` : "none";
      const unit = forceUnit === "N" ? "N" : "of the load";
      lines.push(["force", `${along > noise ? touch.words : 0} ${unit}`], ["both together", `${digits(norm(touch.force), noise).toPrecision(4)} ${unit}`],
        ["friction used", used]);
    } else lines.push(["force", "computed at the end of a phase"]);
    $("cardname").textContent = stage.naming(touch, shot.touches);
    $("cardlines").replaceChildren(...lines.flatMap(([name, told]) => [element("dt", name), element("dd", told)]));
  }
}

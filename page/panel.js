// The controls of a live page: what they say is sent to the server, and what it answers is shown.

import { post } from "./asking.js";
import { $, element } from "./words.js";

export class Panel {
  // `answered(data)` shows a new run.
  constructor(controls, fileName, asker, answered) {
    Object.assign(this, { controls, fileName, asker, answered });
    this.values = controls.map((control) => control.value);
    this.start = [0, 0, 0]; // how far the start was dragged
    this.inputs = [];
    this.build();
    $("undo").addEventListener("click", () => this.undo());
    $("save").addEventListener("click", () => this.save());
    $("panel").hidden = false;
  }

  build() {
    let group = null;
    this.controls.forEach((control, which) => {
      if (!group || group.dataset.name !== control.group) {
        group = element("fieldset", "");
        group.dataset.name = control.group;
        group.append(element("legend", control.group === "cage" ? "cage (the start moves with it)" : control.group));
        $("controls").append(group);
      }
      const row = element("label", "");
      row.append(element("span", control.label));
      this.inputs.push(control.choices.length ? this.choice(control, which, row) : this.slider(control, which, row));
      group.append(row);
    });
  }

  choice(control, which, row) {
    const select = element("select", "");
    control.choices.forEach((word) => select.append(element("option", word)));
    select.value = control.value;
    select.addEventListener("input", () => this.change(which, select.value));
    row.append(select);
    return [select];
  }

  slider(control, which, row) {
    const [range, number] = ["range", "number"].map((type) => Object.assign(document.createElement("input"), {
      type, min: control.low, max: control.high, step: type === "number" ? "any" : control.step, value: control.value }));
    if (range.valueAsNumber !== control.value) range.step = "any"; // the file's own value lies between two steps
    range.value = control.value;
    number.removeAttribute("min");
    number.removeAttribute("max");
    [range, number].forEach((input) => input.setAttribute("aria-label", `${control.group}: ${control.label}`));
    range.addEventListener("input", () => { number.value = +range.valueAsNumber.toPrecision(6); this.change(which, +number.value); });
    number.addEventListener("input", () => { range.value = number.value; this.change(which, number.value === "" ? null : +number.value); });
    row.append(range, number, element("small", control.unit));
    return [range, number];
  }

  change(which, value) {
    this.values[which] = value;
    this.ask();
  }

  moveStart(way) {
    this.start = way;
    this.ask();
  }

  undo() {
    this.start = [0, 0, 0];
    this.controls.forEach((control, which) => {
      this.values[which] = control.value;
      this.inputs[which].forEach((input) => { input.value = control.value; });
    });
    this.ask();
  }

  // Only what differs from the file; of a vector all components.
  changed() {
    const keys = new Set(this.controls.filter((control, which) => this.values[which] !== control.value).map((control) => control.key));
    const values = this.start.some((value) => value) ? { start: this.start } : {};
    this.controls.forEach((control, which) => {
      if (!keys.has(control.key)) return;
      if (control.index === null) values[control.key] = this.values[which];
      else (values[control.key] ??= [])[control.index] = this.values[which];
    });
    return values;
  }

  ask() {
    this.asker.ask("run", () => this.changed(), this.answered);
  }

  async save() {
    try {
      const response = await post("scene", this.changed());
      if (!response.ok) return this.asker.complain((await response.json()).problems, "scene that could be run");
      const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(await response.blob()), download: this.fileName });
      link.click();
      URL.revokeObjectURL(link.href);
    } catch {
      this.asker.complain(["The viewer's server does not answer; start cagepose view again."], "answer");
    }
  }
}

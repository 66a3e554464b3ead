// The controls of a live page: what they say is sent to the server, and what it answers is shown.
//
// A control changes a value of a text, the base. Once somebody edits the text, it is the base, with what controls have said
// in it as far as that is answered.

import { sub } from "./geometry.js";
import { $, element } from "./words.js";

// Where a control's value stands: two controls may be of one.
const place = ({ key, index }) => (index === null ? key : `${key}[${index}]`);

export class Panel {
  // `answered(data)` shows a new run. `text` is that of the scene; `base` of it null: the one that the server began with.
  constructor(controls, fileName, text, asker, answered) {
    Object.assign(this, { controls, fileName, text, asker, answered, base: null, editor: null });
    this.start = [0, 0, 0]; // how far the start was dragged
    this.said = null; // values and start, as they stand in the text
    this.build();
    $("undo").addEventListener("click", () => this.undo());
    $("save").addEventListener("click", () => this.save());
    $("panel").hidden = false;
  }

  build() {
    const scrolled = $("controls").scrollTop;
    this.values = this.controls.map((control) => control.value);
    this.forget();
    this.inputs = [];
    $("controls").replaceChildren();
    let group = null;
    this.controls.forEach((control, which) => {
      if (!group || group.dataset.name !== control.group) {
        group = element("fieldset", "");
        group.dataset.name = control.group;
        group.append(element("legend", control.group === "cage" ? "cage (the start moves with it)" : control.group));
        $("controls").append(group);
      }
      const row = element("label", "", control.remove ? "mine" : "");
      row.append(element("span", control.label));
      this.inputs.push(control.choices.length ? this.choice(control, which, row) : this.slider(control, which, row));
      if (control.remove) row.append(this.remover(control));
      group.append(row);
    });
    $("controls").scrollTop = scrolled;
  }

  remover(control) {
    const button = element("button", "\u2715");
    button.setAttribute("aria-label", `remove the slider of ${control.label}`);
    button.addEventListener("click", (event) => { event.preventDefault(); control.remove(); });
    return button;
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
    const at = place(this.controls[which]);
    this.controls.forEach((control, other) => {
      if (place(control) !== at) return;
      this.values[other] = value;
      if (other !== which) this.inputs[other].forEach((input) => { input.value = value; });
    });
    this.ask();
  }

  moveStart(way) {
    this.start = way;
    this.ask();
  }

  undo() {
    if (this.editor) return this.editor.undoAll();
    this.start = [0, 0, 0];
    this.controls.forEach((control, which) => {
      this.values[which] = control.value;
      this.inputs[which].forEach((input) => { input.value = control.value; });
    });
    this.ask();
  }

  // The text is another one now. What controls say and the last answer had not is said of this one.
  edit(text) {
    const { values, start } = this.said;
    this.base = this.text = text;
    this.start = sub(this.start, start);
    this.controls.forEach((control, which) => { control.value = values[which]; });
    this.said = { values, start: [0, 0, 0] };
  }

  // What controls say and no answer has is not said any more.
  forget() {
    this.said = { values: [...this.values], start: this.start };
  }

  // Shows sliders for numbers of the text before all others.
  addMine(controls) {
    this.controls = [...controls, ...this.controls.filter((control) => !control.remove)];
    this.build();
  }

  // Goes to the slider that changes a place of the text; whether there is one.
  goTo(at) {
    const which = this.controls.findIndex((control) => [place(control), control.key === "friction" ? "friction.coefficient" : null].includes(at));
    if (which >= 0) {
      this.inputs[which][0].scrollIntoView({ block: "nearest" });
      this.inputs[which][0].focus();
    }
    return which >= 0;
  }

  // Only what differs from the base; of a vector all components.
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

  question() {
    return { text: this.base, values: this.changed() };
  }

  ask() {
    let asked, said;
    this.asker.ask("run", () => {
      said = { values: [...this.values], start: this.start };
      return (asked = this.question());
    }, (answer) => {
      if (asked.text === this.base) { // else the text has been edited meanwhile
        this.said = said;
        this.take(answer, asked);
      }
      this.answered(answer);
    }, (refusal) => this.editor?.refused(refusal, asked) ?? refusal.problems);
  }

  take(answer, asked) {
    this.text = answer.text;
    this.editor?.answered(answer);
    if (asked.text === null || Object.keys(asked.values).length || Object.keys(this.changed()).length) return;
    const mine = this.editor?.controls() ?? [];
    const controls = [...mine, ...answer.controls];
    if (JSON.stringify(controls) === JSON.stringify(this.controls)) return;
    this.controls = controls;
    this.build();
  }

  async save() {
    await this.asker.settled();
    download(this.text, this.fileName);
  }
}

export function download(text, name) {
  const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(new Blob([text], { type: "application/yaml" })), download: name });
  link.click();
  URL.revokeObjectURL(link.href);
}

// The scene's text beside the picture: it is run when somebody has stopped typing, saved when somebody says so, and taken
// anew when another program has written the file. It is in a live page alone.

import { OnDisk } from "./on_disk.js";
import { Varied } from "./varied.js";
import { $, button, element } from "./words.js";
import { Writing } from "./writing.js";

const TYPED_MS = 600; // after the last key
const PER_CENT = 20; // a slider of a number reaches so far from it
const NOTHING = { deg: 5, other: 1 }; // and so far from 0

const keyPath = (path) => path.reduce((text, key) => (typeof key === "number" ? `${text}[${key}]` : text ? `${text}.${key}` : key), "");

class Sheet {
  // `changedSize()` is called when the picture has more room, or less.
  constructor({ name, schema, version, saved, beside }, panel, changedSize) {
    Object.assign(this, { name, beside, panel, changedSize, chosen: [], begun: panel.text });
    this.onDisk = new OnDisk(this, name, version, saved);
    this.build();
    this.writing = new Writing(this.room, panel.text, schema, { typed: (isNow) => this.typed(isNow), moved: () => this.tellNumber(), altClicked: () => this.addSlider() });
    this.varied = new Varied(this.study, { text: () => this.text, around: (path) => this.around(path), seen: (path, value) => this.write(path, value) });
    panel.editor = this;
    this.tellState();
    this.tellNumber();
    this.onDisk.look();
    window.addEventListener("beforeunload", (event) => { if (this.isTyped && this.isUnsaved) event.preventDefault(); });
  }

  build() {
    this.section = element("section", "");
    Object.assign(this.section, { id: "text", hidden: true });
    this.section.setAttribute("aria-label", "The scene's text");
    const head = element("div", "", "head");
    this.state = element("small", "");
    this.state.setAttribute("role", "status");
    this.saveButton = button("save", "write this text into the file", () => this.onDisk.save());
    head.append(element("strong", this.name), this.state, this.saveButton,
      button("save as \u2026", "a new file beside this one, or a download", () => this.onDisk.askName()),
      button("\u2715", "close the text", () => this.toggle(false)));
    this.room = element("div", "", "writing");
    this.mistakes = element("div", "", "mistakes");
    this.study = element("div", "", "varied");
    this.foot = element("div", "", "foot");
    this.section.append(head, this.onDisk.news, this.room, this.mistakes, this.study, this.foot);
    $("view").before(this.section);
    this.opener = button("edit text", "the scene's text, beside the picture", () => this.toggle(this.section.hidden));
    this.opener.id = "edittext";
    $("views").prepend(this.opener);
  }

  toggle(isOpen) {
    if (isOpen !== this.section.hidden) return; // it is so already, and the view stays
    this.section.hidden = !isOpen;
    this.opener.setAttribute("aria-pressed", String(isOpen));
    document.body.classList.toggle("editing", isOpen);
    this.changedSize();
    if (isOpen) this.writing.view.focus();
  }

  get text() {
    return this.writing.text;
  }

  get isUnsaved() {
    return this.text !== this.onDisk.text;
  }

  // The text was edited by hand: it is run when nothing is typed any more, or now.
  typed(isNow) {
    clearTimeout(this.timer);
    this.isTyped = true;
    this.panel.edit(this.text);
    this.tellState();
    this.timer = setTimeout(() => this.run(), isNow ? 0 : TYPED_MS);
  }

  run() {
    clearTimeout(this.timer);
    this.panel.ask();
  }

  // Takes another text in the place of this one and of what sliders say, and runs it.
  replace(text) {
    this.panel.forget();
    this.put(text);
  }

  put(text) {
    this.writing.isolate();
    this.writing.take(text);
    this.panel.edit(text);
    this.tellState();
    this.run();
  }

  // A run of this text, or of what sliders have made of it.
  answered({ text, beside }) {
    this.beside = beside;
    this.writing.take(text);
    this.tellMistakes([]);
    this.tellState();
    this.tellNumber();
  }

  // Returns what to tell over the picture; undefined: all that is wrong, as it is not told here.
  refused({ problems, mistakes = [] }, asked) {
    if (asked.text !== null && asked.text !== this.text) return undefined;
    this.tellMistakes(mistakes);
    if (mistakes.length < problems.length) return undefined;
    if (this.section.hidden) return mistakes.map(({ line, words }) => `line ${line}: ${words}`);
    return [`The text has ${mistakes.length === 1 ? "a mistake" : `${mistakes.length} mistakes`}, told below it.`];
  }

  undoAll() {
    this.replace(this.begun);
  }

  tellMistakes(mistakes) {
    this.writing.mark(mistakes);
    this.mistakes.replaceChildren(...mistakes.map(({ line, words }) => {
      const made = button(`line ${line}`, "go there", () => this.writing.go(line));
      const row = element("p", "");
      row.append(made, ` ${words}`);
      return row;
    }));
    this.writing.reveal();
  }

  tellState() {
    this.varied?.tellStale();
    this.state.textContent = this.isUnsaved ? "edited, not saved" : "as in the file";
    this.saveButton.disabled = !this.isUnsaved;
  }

  // What can be done with the number under the cursor.
  tellNumber() {
    const number = this.writing?.numberHere();
    if (!number) {
      this.foot.replaceChildren(element("small", "Ctrl+Enter runs the text. With the cursor on a number, it can have a slider, or vary."));
      return;
    }
    const key = keyPath(number.path);
    this.foot.replaceChildren(element("code", `${key} = ${number.value}`),
      button("slider", "a slider for this number (Alt+click)", () => this.addSlider()),
      button("vary this", "many runs with values around this one", () => this.varied.ask(key, number)));
  }

  // What stands in the text before and behind a number; null: it is not there any more.
  around(path) {
    const number = this.writing.numberOf(path);
    return number && [this.text.slice(0, number.from), this.text.slice(number.to)];
  }

  // Writes a number in the place of another one, as if somebody had typed it.
  write(path, value) {
    const around = this.around(path);
    if (around) this.put(around.join(value));
  }

  async addSlider() {
    const number = this.writing.numberHere();
    const key = number && keyPath(number.path);
    if (!number || this.panel.goTo(key)) return;
    this.chosen = [...this.chosen.filter((one) => one.key !== key), this.control(key, number.path, number.value)];
    await this.showSliders();
    this.panel.goTo(key);
  }

  // What other sliders have said stands in the text once it is answered.
  async showSliders() {
    await this.panel.asker.settled();
    this.panel.edit(this.text);
    this.panel.addMine(this.controls());
  }

  control(key, path, value) {
    const reach = PER_CENT / 100 * Math.abs(value) || (/_deg/.test(key) ? NOTHING.deg : NOTHING.other);
    const step = 10 ** Math.floor(Math.log10(reach / 200));
    const round = (end) => Number((Math.round(end / step) * step).toPrecision(12));
    const control = { group: "of the text", label: key, unit: "", key, index: null, value, low: round(value - reach), high: round(value + reach), step, choices: [], path };
    return { ...control, remove: () => {
      this.chosen = this.chosen.filter((one) => one.key !== key);
      this.showSliders();
    } };
  }

  // The sliders of numbers, as far as these are there still.
  controls() {
    this.chosen = this.chosen.flatMap((control) => {
      const number = this.writing.numberOf(control.path);
      if (!number) return [];
      const isOutside = number.value < control.low || number.value > control.high;
      return [isOutside ? this.control(control.key, control.path, number.value) : { ...control, value: number.value }];
    });
    return [...this.chosen];
  }
}

window.cageposeEditor = (edit, panel, changedSize) => {
  const sheet = new Sheet(edit, panel, changedSize);
  Object.assign(window.cagepose, { text: () => sheet.text, putCursor: (at) => sheet.writing.put(at) }); // for other scripts and for tests
};

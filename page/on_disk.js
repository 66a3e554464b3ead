// The scene's file: it is written when somebody says so, and looked at again and again, as other programs may write it.

import { LOST, post } from "./asking.js";
import { download } from "./panel.js";
import { button, element } from "./words.js";

const LOOK_MS = 1000; // between two looks at the file

export class OnDisk {
  // `version` is that of the file with `text`, which this page goes on from. `offered` is that of another text of it, while
  // somebody is asked which one to keep.
  constructor(sheet, name, version, text) {
    Object.assign(this, { sheet, name, version, text, offered: null });
    this.news = element("div", "", "news");
    this.news.setAttribute("role", "alert");
    this.news.hidden = true;
  }

  // Tells something about the file, with what can be done about it.
  tell(words, ...buttons) {
    this.news.replaceChildren(...(words ? [element("span", words), ...buttons] : []));
    this.news.hidden = !words;
  }

  // Looks whether another program has written the file, again and again.
  async look() {
    try {
      if (!document.hidden) await this.compare();
    } catch (error) {
      if (!(error instanceof TypeError)) throw error; // a lost connection is told where something is asked for
    }
    setTimeout(() => this.look(), LOOK_MS);
  }

  async compare() {
    if (this.isSaving) return;
    const { version: known, sheet: { beside } } = this;
    const found = await (await post("file", { version: known, beside: beside.names })).json();
    if (this.version !== known || this.isSaving) return; // saved meanwhile
    if (this.sheet.beside === beside && found.stamp !== beside.stamp) { // of points or of a mesh
      this.sheet.beside = { ...beside, stamp: found.stamp };
      this.sheet.panel.ask();
    }
    if (found.problem) {
      if (!this.isGone) this.tell(`${found.problem}. This text is here still: save it as another file.`);
      this.isGone = true;
      return;
    }
    if (this.isGone) this.tell("");
    this.isGone = false;
    if (found.text === undefined) this.withdraw();
    else if (found.text === this.sheet.text) this.goOnFrom(found);
    else if (!this.sheet.isUnsaved) this.take(found);
    else if (found.version !== this.offered) this.askWhich(found);
  }

  // The text of the file is this one now, whatever stands here.
  goOnFrom({ version, text }) {
    Object.assign(this, { version, text, offered: null });
    this.tell("");
    this.sheet.tellState();
  }

  take(found) {
    this.goOnFrom(found);
    this.sheet.begun = found.text;
    this.sheet.replace(found.text);
  }

  // Until somebody has chosen, this page goes on from the text that it knew, so that nothing can be saved over the other one.
  askWhich(found) {
    this.offered = found.version;
    this.sheet.toggle(true);
    this.tell(`${this.name} was changed on disk, and you have edits here that are not saved.`,
      button("take the file's text", "yours can be had back by undo", () => this.take(found)),
      button("keep mine", "the file stays as it is until you save", () => this.goOnFrom(found)));
  }

  // The file is again as this page knows it.
  withdraw() {
    if (this.offered) this.tell("");
    this.offered = null;
  }

  async save() {
    if (this.isSaving) return; // a second click
    this.isSaving = true;
    const text = this.sheet.text;
    try {
      const response = await post("save", { text, version: this.version });
      const answer = await response.json();
      if (response.ok) {
        this.goOnFrom({ version: answer.version, text });
        this.sheet.begun = text;
      } else {
        this.offered = null; // what to do about it is asked again
        this.tell(answer.problems.join(" "));
      }
    } catch {
      this.tell(LOST);
    } finally {
      this.isSaving = false;
    }
  }

  askName() {
    const name = Object.assign(document.createElement("input"), { value: this.sheet.panel.fileName, size: 24 });
    name.setAttribute("aria-label", "name of the new file");
    const save = () => this.saveAs(name.value);
    name.addEventListener("keydown", (event) => { if (event.key === "Enter") save(); });
    this.tell("Beside the file, as", name, button("save", "a new file in the same folder", save),
      button("download", "from the browser", () => { download(this.sheet.text, name.value); this.tell(""); }),
      button("\u2715", "no file", () => this.tell("")));
    name.focus();
  }

  async saveAs(name) {
    try {
      const response = await post("save-as", { text: this.sheet.text, name });
      const answer = await response.json();
      this.tell(response.ok ? `Saved as ${answer.name}; this page goes on with ${this.name}.` : answer.problems.join(" "),
        ...(response.ok ? [] : [button("another name", "", () => this.askName())]), button("\u2715", "close", () => this.tell("")));
    } catch {
      this.tell(LOST);
    }
  }
}

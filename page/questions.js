// Questions about the run as it is shown, each answered by the server in the words of the command, with its certainty.

import { $, button, element } from "./words.js";

export class Questions {
  // `questions`: by name, what a button says. `scene()` is the text and the values that a run is of, `phase()` that on screen.
  constructor(questions, asker, { scene, phase }) {
    Object.assign(this, { asker, scene, phase });
    $("askable").replaceChildren(...Object.entries(questions).map(([name, words]) => button(words, "of the phase on screen", () => this.ask(name))));
    $("questions").hidden = false;
  }

  // What waits to be run comes first: the question is about what is shown then.
  async ask(question) {
    this.tell([["", "asking \u2026"]], []);
    await this.asker.settled();
    const asked = { ...this.scene(), question, phase: this.phase() };
    await this.asker.ask("ask", () => asked, ({ lines, table }) => this.tell(lines, table), ({ problems }) => {
      this.tell([["no answer", problems.join(" ")]], []);
      return [];
    });
    if ($("answer").textContent.startsWith("asking")) this.forget(); // the server is lost
  }

  // Another run is shown, which the answer is not about.
  forget() {
    this.tell([], []);
  }

  tell(lines, [head, ...rows]) {
    $("answer").replaceChildren(...lines.flatMap(([name, told]) => [element("dt", name), element("dd", told)]));
    $("answertable").tHead.replaceChildren(...(head ? [row("th", head)] : []));
    $("answertable").tBodies[0].replaceChildren(...rows.map((cells) => row("td", cells)));
  }
}

function row(kind, cells) {
  const made = element("tr", "");
  made.append(...cells.map((cell) => element(kind, cell)));
  return made;
}

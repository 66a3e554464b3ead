// Questions to the viewer's server, one at a time: an answer cannot come before that to an earlier question. What is asked
// meanwhile waits, the last of it alone.

import { $, element } from "./words.js";

const SETTLING_MS = 20;
const NOT_FOUND = 404;
export const LOST = "The viewer's server does not answer; start cagepose view again, and open the address that it prints.";

export class Asker {
  constructor() {
    this.now = this.next = this.tookMs = null;
  }

  get isBusy() {
    return this.now !== null;
  }

  // `body()` is what to send, as it is then; `answered(answer)` shows what comes back. Where something else is to be run
  // meanwhile, the answer to a pull is dropped. `refused(answer)` takes one that says why there is none,
  // and returns what to tell of it over the picture.
  async ask(path, body, answered, refused = ({ problems }) => problems) {
    this.next = { path, body, answered, refused };
    if (this.isBusy) return;
    try {
      while (this.next) {
        [this.now, this.next] = [this.next, null];
        $("busy").hidden = false;
        const { path, body, answered, refused } = this.now;
        const asked = performance.now();
        const response = await post(path, body());
        const answer = await response.json();
        if (path === "pull" && this.next && this.next.path !== path) continue;
        const problems = response.ok ? (answered(answer), []) : refused(answer);
        this.tookMs = performance.now() - asked; // the picture included
        this.complain(problems, path === "pull" ? "answer" : "scene that could be run");
      }
    } catch (error) {
      if (!(error instanceof TypeError)) throw error; // what a lost connection is told by
      this.complain([LOST], "answer");
    } finally {
      this.now = null;
      $("busy").hidden = true;
    }
  }

  // Resolves once nothing is asked any more.
  async settled() {
    while (this.isBusy) await new Promise((resolve) => { setTimeout(resolve, SETTLING_MS); });
  }

  complain(problems, shown) {
    const told = problems.length > 3 ? [...problems.slice(0, 2), `and ${problems.length - 2} more`] : problems;
    $("problems").replaceChildren(...told.map((problem) => element("p", problem)));
    if (problems.length) $("problems").append(element("p", `The picture shows the last ${shown}.`));
    $("problems").hidden = !problems.length;
  }
}

// Where a viewer has ended and another one listens at its port, that does not know this page: it is lost like the first.
export async function post(path, content) {
  const response = await fetch(path, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(content) });
  if (response.status === NOT_FOUND) throw new TypeError(LOST);
  return response;
}

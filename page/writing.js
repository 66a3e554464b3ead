// The scene's text in CodeMirror: colours, completion and meanings from the schema, mistakes at their lines.

import { acceptCompletion, autocompletion, closeBrackets, completionKeymap, startCompletion } from "@codemirror/autocomplete";
import { defaultKeymap, history, historyKeymap, isolateHistory } from "@codemirror/commands";
import { yaml } from "@codemirror/lang-yaml";
import { bracketMatching, defaultHighlightStyle, ensureSyntaxTree, indentUnit, syntaxHighlighting, syntaxTree } from "@codemirror/language";
import { lintGutter, lintKeymap, setDiagnostics } from "@codemirror/lint";
import { Annotation, EditorState, Transaction } from "@codemirror/state";
import { drawSelection, EditorView, highlightActiveLine, hoverTooltip, keymap, lineNumbers } from "@codemirror/view";
import { keysOf, toldOf, valuesOf } from "./schema.js";
import { begun, keyAt, numberAt, numberOf } from "./yaml_place.js";
import { element } from "./words.js";

const PARSE_MS = 200;
const notTyped = Annotation.define(); // of a change that sliders or the file have made

const LOOK = EditorView.theme({
  "&": { height: "100%", fontSize: "12.5px", backgroundColor: "#fff" },
  "&.cm-focused": { outline: "none" },
  ".cm-scroller": { fontFamily: "ui-monospace, 'DejaVu Sans Mono', Menlo, Consolas, monospace", lineHeight: "1.45" },
  ".cm-gutters": { backgroundColor: "#fafafa", color: "#767676", borderRight: "1px solid #ececec" },
  ".cm-activeLine, .cm-activeLineGutter": { backgroundColor: "#f1f6fa" },
  ".cm-tooltip": { maxWidth: "26em", font: "13px/1.4 system-ui, sans-serif", borderColor: "#d9d9d9", backgroundColor: "#fff", boxShadow: "0 2px 8px #0002" },
  ".cm-tooltip .told, .cm-completionInfo": { padding: ".3em .6em" },
  ".cm-tooltip code": { color: "#5c5c5c" },
});

export class Writing {
  // `typed(isNow)` is called when somebody has changed the text, or asks for it to be run now; `moved()` when the cursor is elsewhere;
  // `altClicked()` after a click with Alt.
  constructor(parent, text, schema, { typed, moved, altClicked }) {
    this.schema = schema;
    this.view = new EditorView({
      parent,
      state: EditorState.create({
        doc: text,
        extensions: [
          lineNumbers(), history(), drawSelection(), highlightActiveLine(), bracketMatching(), closeBrackets(), lintGutter(), EditorView.lineWrapping,
          yaml(), syntaxHighlighting(defaultHighlightStyle), indentUnit.of("  "), LOOK,
          autocompletion({ override: [(context) => this.completions(context)] }),
          hoverTooltip((view, position) => this.meaning(position)),
          EditorView.contentAttributes.of({ "aria-label": "The scene's text" }),
          keymap.of([
            { key: "Mod-Enter", run: () => { typed(true); return true; } }, { key: "Tab", run: acceptCompletion },
            ...completionKeymap, ...lintKeymap, ...historyKeymap, ...defaultKeymap]),
          EditorView.updateListener.of((update) => {
            if (update.docChanged && !update.transactions.some((one) => one.annotation(notTyped))) typed(false);
            if (update.docChanged || update.selectionSet) moved();
          }),
          EditorView.domEventHandlers({ click: (event) => { if (event.altKey) altClicked(); } }),
        ],
      }),
    });
  }

  get text() {
    return this.view.state.doc.toString();
  }

  // Takes another text, as one step that can be undone; what is alike before and behind stays, with the cursor in it.
  take(text) {
    const now = this.text;
    if (text === now) return;
    let from = 0, to = now.length, end = text.length;
    while (from < to && from < end && now[from] === text[from]) from += 1;
    while (to > from && end > from && now[to - 1] === text[end - 1]) [to, end] = [to - 1, end - 1];
    this.view.dispatch({ changes: { from, to, insert: text.slice(from, end) }, annotations: [notTyped.of(true), Transaction.userEvent.of("input.slider")] });
  }

  // What comes next is a step of its own for undo.
  isolate() {
    this.view.dispatch({ annotations: isolateHistory.of("full") });
  }

  get tree() {
    const { state } = this.view;
    return ensureSyntaxTree(state, state.doc.length, PARSE_MS) ?? syntaxTree(state);
  }

  // The number under the cursor, and that which a path leads to.
  numberHere() {
    return numberAt(this.tree, this.text, this.view.state.selection.main.head);
  }

  numberOf(path) {
    return numberOf(this.tree, this.text, path);
  }

  // `mistakes`: line and column from 1, and words.
  mark(mistakes) {
    const { doc } = this.view.state;
    const diagnostics = mistakes.map(({ line, column, words }) => {
      const { from, to, text } = doc.line(Math.min(line, doc.lines));
      const start = Math.min(from + column - 1, to);
      const word = /^[^\s,\]}:#]+/.exec(text.slice(start - from));
      return { from: word ? start : from, to: word ? start + word[0].length : to, severity: "error", message: words };
    });
    this.view.dispatch(setDiagnostics(this.view.state, diagnostics));
  }

  // What is around the text may have got larger: the cursor stays in sight.
  reveal() {
    const { view } = this;
    if (view.hasFocus) requestAnimationFrame(() => view.dispatch({ effects: EditorView.scrollIntoView(view.state.selection.main.head) }));
  }

  go(line) {
    const { doc } = this.view.state;
    this.put(doc.line(Math.min(line, doc.lines)).from);
  }

  // Puts the cursor at a position.
  put(at) {
    this.view.dispatch({ selection: { anchor: at }, scrollIntoView: true });
    this.view.focus();
  }

  completions(context) {
    const place = begun(this.text, context.pos);
    if (!place || (place.from === context.pos && !context.explicit && !this.isAfterKey(context.pos))) return null;
    if (!place.isKey) {
      const options = valuesOf(this.schema, place.path).map((label) => ({ label, type: "enum" }));
      return options.length ? { from: place.from, options, validFor: /^\w*$/ } : null;
    }
    const written = /^\s*:/.test(this.text.slice(context.pos).replace(/^\w*/, ""));
    const indent = " ".repeat(place.from - (this.text.lastIndexOf("\n", place.from - 1) + 1) + 2);
    const isFlow = /[{,]\s*$/.test(this.text.slice(0, place.from).split("\n").at(-1));
    const options = keysOf(this.schema, place.path).filter(({ name }) => !place.siblings.includes(name)).map(({ name, description, example, opens, isNeeded }) => ({
      label: name, type: "property", boost: isNeeded ? 1 : 0, detail: isNeeded ? "needed" : "",
      apply: written ? name : opens !== null ? (isFlow ? `${name}: ` : `${name}:\n${indent}${opens}`) : (view, completion, from, to) => {
        view.dispatch({ changes: { from, to, insert: `${name}: ` }, selection: { anchor: from + name.length + 2 }, userEvent: "input.complete" });
        startCompletion(view);
      },
      info: () => this.told(description, example),
    }));
    return options.length ? { from: place.from, options, validFor: /^\w*$/ } : null;
  }

  isAfterKey(position) {
    return /:\s$/.test(this.text.slice(Math.max(0, position - 2), position));
  }

  meaning(position) {
    const key = keyAt(this.tree, this.text, position);
    const told = key && toldOf(this.schema, key.path);
    if (!told) return null;
    const example = told.words.length ? told.words.join(", ") : told.example;
    return { pos: key.from, end: key.to, above: true, create: () => ({ dom: this.told(told.description, example, "told") }) };
  }

  told(description, example, className) {
    const made = element("div", "", className);
    made.append(element("div", description));
    if (example) made.append(element("code", `such as ${example}`));
    return made;
  }
}

// Places in a YAML text: which key a position is in, and where what a key holds stands. They are read from CodeMirror's
// tree, which is there while a line is half written.

import { yamlLanguage } from "@codemirror/lang-yaml";

const NUMBER = /^[-+]?(\.\d+|\d+(\.\d*)?)([eE][-+]?\d+)?$/;
const DUMMY = "x__";

const words = (text) => (/^(".*"|'.*')$/s.test(text) ? text.slice(1, -1) : text);
const items = (node) => node.getChildren("Item");
const isList = (node) => node.name === "BlockSequence" || node.name === "FlowSequence";
const isMapping = (node) => node.name === "BlockMapping" || node.name === "FlowMapping";

// The keys and indices from the root to a node.
function pathTo(node, text) {
  const path = [];
  for (let at = node; at.parent; at = at.parent) {
    if (at.name === "Item") path.unshift(items(at.parent).findIndex((item) => item.from === at.from));
    else if (at.name === "Pair") path.unshift(words(text.slice(at.getChild("Key")?.from ?? at.from, at.getChild("Key")?.to ?? at.from)));
  }
  return path;
}

// What a pair or an item holds.
const held = (node) => [...children(node)].reverse().find(({ name }) => !["Key", ":", "-", "Comment", "\u26A0"].includes(name)) ?? null;

function* children(node) {
  for (let child = node.firstChild; child; child = child.nextSibling) yield child;
}

// The key at a position: its path and where it stands; null: none is there.
export function keyAt(tree, text, position) {
  for (let node = tree.resolveInner(position, 1); node.parent; node = node.parent) {
    if (node.name === "Key") return { path: pathTo(node, text), from: node.from, to: node.to };
  }
  return null;
}

// The number at a position: its path, its value, and where it stands; null: none is there.
export function numberAt(tree, text, position) {
  for (const side of [1, -1]) {
    const node = tree.resolveInner(position, side);
    const word = text.slice(node.from, node.to);
    if (node.name === "Literal" && node.parent.name !== "Key" && NUMBER.test(word)) return { path: pathTo(node, text), value: Number(word), from: node.from, to: node.to };
  }
  return null;
}

// The number that a path leads to; null: there is none.
export function numberOf(tree, text, path) {
  const document = tree.topNode.getChild("Document");
  let node = document && [...children(document)].find((child) => isMapping(child) || isList(child)); // behind --- and comments
  for (const key of path) {
    if (!node) return null;
    if (isList(node)) node = items(node)[key];
    else if (isMapping(node)) node = node.getChildren("Pair").find((pair) => { const of = pair.getChild("Key"); return of && words(text.slice(of.from, of.to)) === String(key); });
    else return null;
    node = node && held(node);
  }
  return node ? numberAt(tree, text, node.from) : null;
}

// What may be written at a position: `path` is that of the mapping whose key is begun (`isKey`), or of the value.
export function begun(text, position) {
  const line = text.slice(text.lastIndexOf("\n", position - 1) + 1, position);
  if (/(^|\s)#/.test(line)) return null;
  const word = /[\w.]*$/.exec(line)[0];
  const before = text.slice(0, position - word.length);
  const after = text.slice(position).replace(/^[\w.]*/, "");
  const isFlowEnd = /^\s*[,}\]]/.test(after) || /^\s*(\n|$)/.test(after);
  if (!isFlowEnd && !/^\s*:/.test(after)) return null;
  const parsed = (dummy) => {
    const whole = before + dummy + after;
    return { whole, node: yamlLanguage.parser.parse(whole).resolveInner(before.length + 1, 1) };
  };
  const isValue = /:\s+$/.test(line.slice(0, line.length - word.length));
  if (!isValue) {
    const { whole, node } = parsed(/^\s*:/.test(after) ? DUMMY : `${DUMMY}: 0`);
    const key = node.parent;
    if (key?.name === "Key" && !key.parent.getChild("\u26A0")) return { path: pathTo(key, whole).slice(0, -1), isKey: true, from: before.length, siblings: siblings(key.parent, whole) };
  }
  const { whole, node } = parsed(DUMMY);
  return node.name === "Literal" && node.parent.name !== "Key" ? { path: pathTo(node, whole), isKey: false, from: before.length } : null;
}

const siblings = (pair, text) => pair.parent.getChildren("Pair").filter((other) => other.from !== pair.from).map((other) => { const key = other.getChild("Key"); return key ? words(text.slice(key.from, key.to)) : ""; });

// Bundles the page: `node build.mjs [FOLDER]`. The first line of each bundle tells which sources it was made of.
// page.js is in every page, editor.js in that of a live viewer alone.

import { createHash } from "node:crypto";
import { readdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { build } from "esbuild";

const HERE = new URL(".", import.meta.url);
const OUT = process.argv[2] ?? new URL("../src/cagepose/views/viewer/page", HERE).pathname;
const BUNDLES = { "page.js": "player.js", "editor.js": "sheet.js" };
const read = (name) => readFileSync(new URL(name, HERE), "utf8");

const sources = createHash("sha256");
for (const name of readdirSync(HERE).filter((name) => /\.m?js$|^package.*json$/.test(name)).sort()) sources.update(`${name}\n${read(name)}`);
const digest = sources.digest("hex");

// The licences of the packages that a bundle contains parts of; of packages with the same one, it stands there once.
function licences(inputs) {
  const packages = [...new Set(Object.keys(inputs).flatMap((file) => file.match(/node_modules\/((?:@[^/]+\/)?[^/]+)/)?.[1] ?? []))].sort();
  const named = new Map();
  for (const name of packages) {
    const licence = read(`node_modules/${name}/LICENSE`).trim();
    named.set(licence, [...(named.get(licence) ?? []), name]);
  }
  return [...named].map(([licence, names]) => `/*! Contains parts of ${names.join(", ")}:\n${licence}\n*/\n`).join("");
}

for (const [bundle, entry] of Object.entries(BUNDLES)) {
  const made = await build({
    entryPoints: [new URL(entry, HERE).pathname], absWorkingDir: HERE.pathname, metafile: true,
    bundle: true, minify: true, format: "iife", target: "es2022", charset: "utf8", legalComments: "none", write: false,
  });
  writeFileSync(join(OUT, bundle), `// Built by \`make page\` from page/ (sources ${digest}).\n${licences(made.metafile.inputs)}${made.outputFiles[0].text}`);
}

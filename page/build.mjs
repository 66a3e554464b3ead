// Bundles the page: `node build.mjs [FILE]`. The first line of the bundle tells which sources it was made of.

import { createHash } from "node:crypto";
import { readdirSync, readFileSync, writeFileSync } from "node:fs";
import { build } from "esbuild";

const HERE = new URL(".", import.meta.url);
const OUT = new URL("../src/cagepose/views/viewer/page/page.js", HERE);
const read = (name) => readFileSync(new URL(name, HERE), "utf8");

const sources = createHash("sha256");
for (const name of readdirSync(HERE).filter((name) => /\.m?js$|^package.*json$/.test(name)).sort()) sources.update(`${name}\n${read(name)}`);
const licence = read("node_modules/three/LICENSE").trim();
const made = await build({
  entryPoints: [new URL("player.js", HERE).pathname],
  bundle: true, minify: true, format: "iife", target: "es2022", charset: "utf8", legalComments: "none", write: false,
});
const head = `// Built by \`make page\` from page/ (sources ${sources.digest("hex")}).\n/*! Contains parts of three.js:\n${licence}\n*/\n`;
writeFileSync(process.argv[2] ?? OUT, head + made.outputFiles[0].text);

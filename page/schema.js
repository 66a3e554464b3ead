// What the scene file's schema says of a path: keys, words to choose from, and what they mean.

// The parts of the schema that speak of a path, references followed and choices spread out.
export function nodesOf(schema, path) {
  let nodes = spread(schema, schema);
  for (const key of path) {
    nodes = nodes.flatMap((node) => {
      const child = typeof key === "number" ? node.items : node.properties?.[key] ?? (typeof node.additionalProperties === "object" ? node.additionalProperties : null);
      return child ? spread(schema, child) : [];
    });
  }
  return nodes;
}

function spread(schema, node) {
  const whole = node.$ref ? { ...schema.$defs[node.$ref.split("/").at(-1)], ...node, $ref: undefined } : node;
  return [whole, ...[...(whole.anyOf ?? []), ...(whole.oneOf ?? [])].flatMap((choice) => spread(schema, choice))];
}

const plain = (value) => JSON.stringify(value).replaceAll('"', "").replaceAll(",", ", ").replaceAll(":", ": ");
const isFlat = (value) => typeof value !== "object" || (Array.isArray(value) && value.every((item) => typeof item !== "object"));

// What one key of a mapping is for: { description, example }, of the mapping's nodes.
function meaning(schema, node) {
  const parts = spread(schema, node);
  const described = parts.find((part) => part.description);
  const example = parts.find((part) => part.examples)?.examples[0];
  return { description: described?.description ?? "", example: example === undefined ? "" : plain(example) };
}

// The keys that a mapping may have: name, what it is for, and with what a line below it begins; null: it holds no mappings.
export function keysOf(schema, path) {
  const found = new Map();
  for (const node of nodesOf(schema, path)) {
    for (const [name, child] of Object.entries(node.properties ?? {})) {
      if (found.has(name)) continue;
      const parts = spread(schema, child);
      const isOfMappings = parts.some((part) => part.items && spread(schema, part.items).some((item) => item.properties));
      const opens = isOfMappings ? "- " : parts.some((part) => part.properties || part.additionalProperties) ? "" : null;
      found.set(name, { name, ...meaning(schema, child), opens, isNeeded: Boolean(node.required?.includes(name)) });
    }
  }
  return [...found.values()];
}

// The words and examples that may stand at a path.
export function valuesOf(schema, path) {
  const nodes = nodesOf(schema, path);
  const words = nodes.flatMap((node) => node.enum ?? (node.const !== undefined ? [node.const] : node.type === "boolean" ? [true, false] : []));
  const examples = words.length ? [] : nodes.flatMap((node) => node.examples ?? []).filter(isFlat);
  return [...new Set([...words, ...examples].map(plain))];
}

// What is told of the key at a path.
export function toldOf(schema, path) {
  const nodes = nodesOf(schema, path);
  const description = nodes.find((node) => node.description)?.description;
  const example = nodes.find((node) => node.examples)?.examples[0];
  const words = nodes.flatMap((node) => node.enum ?? []);
  return description ? { description, example: example === undefined ? "" : plain(example), words } : null;
}

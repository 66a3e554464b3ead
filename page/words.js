// Numbers and elements of the page.

export const $ = (id) => document.getElementById(id);

export const digits = (value, noise) => (Math.abs(value) < noise ? 0 : +value.toPrecision(6));

export function element(tag, text, className) {
  const made = document.createElement(tag);
  made.textContent = text;
  if (className) made.className = className;
  return made;
}

export function button(text, title, act) {
  const made = element("button", text);
  made.title = title;
  made.addEventListener("click", act);
  return made;
}

// A length to four digits, in the scene's unit; what is small, in micrometres or nanometres.
export function gapWords(length, unit) {
  const metres = { mm: 1e-3, m: 1 }[unit];
  const units = [["mm", 1e-3, 1e-4], ["\u00b5m", 1e-6, 1e-7], ["nm", 1e-9, 0]];
  const [name, size] = metres && length * metres < 1 ? units.find(([, , least]) => length * metres >= least) : [unit, metres];
  return `${+(metres ? length * metres / size : length).toPrecision(4)} ${name}`;
}

// Numbers and elements of the page.

export const $ = (id) => document.getElementById(id);

export const digits = (value, noise) => (Math.abs(value) < noise ? 0 : +value.toPrecision(6));

export function element(tag, text, className) {
  const made = document.createElement(tag);
  made.textContent = text;
  if (className) made.className = className;
  return made;
}

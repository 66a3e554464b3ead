// The address says which run is open, so that links to it can be sent, and the browser's own way back closes it.
const dialog = document.getElementById("played");
const asked = () => decodeURIComponent(location.hash.slice(1));

function open() {
  dialog.querySelector("iframe")?.remove();
  if (!Object.hasOwn(packed.runs, asked())) return dialog.close();
  dialog.querySelector("b").textContent = asked().replaceAll("-", " ");
  dialog.append(playing(asked()));
  if (!dialog.open) dialog.showModal();
}

dialog.addEventListener("close", () => {
  dialog.querySelector("iframe")?.remove();
  if (Object.hasOwn(packed.runs, asked())) history.replaceState(null, "", "#");
});
addEventListener("hashchange", open);
open();

// Unpacks pages that play runs: one text that they share, and the data of each, gzipped, as base64.
const packed = JSON.parse(document.getElementById("packed").textContent);

async function unpacked(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).text();
}

function playing(name) {
  const frame = document.createElement("iframe");
  frame.title = `The run ${name}, to be played`;
  Promise.all([packed.page, packed.runs[name]].map(unpacked)).then(([page, data]) => {
    frame.srcdoc = page.replace("@DATA@", () => data);
  }).catch((error) => {
    frame.srcdoc = `This browser cannot unpack the page of the run (${error}). Browsers can since May 2023.`;
  });
  return frame;
}

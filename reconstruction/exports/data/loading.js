// Gaussians of the page, chunk by chunk, as the browser reads them.
function bytesOf(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  return Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
}

const pause = (ms) => new Promise((go) => setTimeout(go, ms));

// A block of the page, once all of it is there; null where the page ended before it.
async function block(id) {
  for (;;) {
    const isDone = document.readyState !== "loading";
    const found = byId(id);
    if (found && (found.nextElementSibling || isDone)) return found;
    if (isDone) return null;
    await pause(30);
  }
}

async function load() {
  let nDrawn = 0;
  for (let first = 0, number_ = 0; first < model.n; first += model.at_once, number_++) {
    const held = await block(`g${number_}`);
    const n = Math.min(model.at_once, model.n - first);
    const nRest = [0, 9, 24, 45][model.degree];
    if (picture === null) return undefined;
    const bytes = held ? bytesOf(held.textContent) : new Uint8Array(0);
    if (bytes.length !== n * (32 + nRest)) return tell("damaged");
    held.remove();
    const words = new Uint32Array(bytes.buffer, 0, 8 * n);
    picture.add(words, bytes.subarray(32 * n));
    const places = new Float32Array(words.buffer, 0, 8 * n);
    const means = new Float32Array(3 * n);
    for (let i = 0; i < n; i++) means.set(places.subarray(8 * i, 8 * i + 3), 3 * i);
    sorter.add(means);
    const isLast = first + n >= model.n;
    byId("loading").firstElementChild.style.width = `${(100 * (first + n)) / model.n}%`;
    byId("loading").setAttribute("aria-valuenow", String(Math.round((100 * (first + n)) / model.n)));
    if (isLast || first + n >= 2 * nDrawn) {
      nDrawn = first + n;
      sorter.renew(camera); // and then it is drawn
    }
    await pause(0);
  }
  state.isLoaded = true;
  byId("loading").hidden = true;
  ask();
}


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

// Bytes that zlib compressed, as only browsers with WebGPU are asked to; an Error where they are damaged.
async function inflated(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Rows of 8 bytes of which all first bytes came first, then all second ones, and so on.
function inRows(bytes) {
  const n = bytes.length / 8;
  const found = new Uint8Array(bytes.length);
  for (let j = 0; j < 8; j++) for (let i = 0; i < n; i++) found[8 * i + j] = bytes[j * n + i];
  return found;
}

// Text that is kept where panes mirror, so that the page can go on without WebGPU when the device is lost.
const MOST_KEPT = 2 ** 26;

// Bytes of a block, which is taken out of the page unless it may be asked for again; none where it is not there.
async function bytesOfBlock(id) {
  const held = await block(id);
  if (held === null) return new Uint8Array(0);
  const bytes = bytesOf(held.textContent);
  if (!state.isKeeping) held.remove();
  return bytes;
}

// Blocks that are not asked for take memory, too.
async function drop(...ids) {
  for (const id of state.isKeeping ? [] : ids.filter((each) => model.mirrors || each.startsWith("g"))) (await block(id))?.remove();
}

// Into the picture that is shown now; false where the page was cut off, undefined where another picture took its place.
async function load() {
  const shown = picture;
  const { at_once, degree, mirrors } = model;
  const n = Math.min(model.n, shown.most);
  const nRest = [0, 9, 24, 45][degree];
  const isWhole = (bytes, rows, fixed) => bytes.length === rows * (fixed + nRest);
  state.isKeeping = shown.isMirroring && (4 / 3) * model.n * (40 + 2 * nRest) < MOST_KEPT;
  let nDrawn = 0;
  for (let first = 0, number_ = 0; first < n; first += at_once, number_++) {
    const rows = Math.min(at_once, n - first);
    const bytes = await bytesOfBlock(`g${number_}`);
    const own = shown.isMirroring ? await bytesOfBlock(`m${number_}`) : null;
    if (!own) await drop(`m${number_}`);
    if (picture !== shown) return undefined;
    if (!isWhole(bytes, rows, 32)) return false;
    const words = new Uint32Array(bytes.buffer, 0, 8 * rows);
    if (own && !isWhole(own, countOnPanes(words), 8)) return false;
    shown.add(words, bytes.subarray(32 * rows), own);
    const places = new Float32Array(words.buffer, 0, 8 * rows);
    const means = new Float32Array(3 * rows);
    for (let i = 0; i < rows; i++) means.set(places.subarray(8 * i, 8 * i + 3), 3 * i);
    sorter.add(means, model.beside ? new Uint16Array((await bytesOfBlock(`b${number_}`)).buffer) : null);
    if (picture !== shown) return undefined;
    const isLast = first + rows >= n;
    byId("loading").firstElementChild.style.width = `${(100 * (first + rows)) / n}%`;
    byId("loading").setAttribute("aria-valuenow", String(Math.round((100 * (first + rows)) / n)));
    if (isLast || first + rows >= 2 * nDrawn) {
      nDrawn = first + rows;
      sorter.renew(camera); // and then it is drawn
    }
    await pause(0);
    if (own && first === 0) {
      const [cells, skips, far] = [await bytesOfBlock("l0"), await bytesOfBlock("l1"), await bytesOfBlock("l2")];
      const network = mirrors.network ? await inflated(await bytesOfBlock("l3")) : new Uint8Array(0);
      const light = [inRows(await inflated(cells)), await inflated(skips), inRows(await inflated(far)), network];
      if (picture !== shown) return undefined;
      if (!isLight(mirrors, light)) return false;
      shown.addLight(...light);
      ask();
    } else if (first === 0) {
      await drop("l0", "l1", "l2", ...(mirrors?.network ? ["l3"] : []));
    }
  }
  state.isLoaded = true;
  byId("loading").hidden = true;
  ask();
  for (let number_ = Math.ceil(n / at_once); number_ * at_once < model.n; number_++) await drop(`g${number_}`, `m${number_}`);
  return true;
}

function countOnPanes(words) {
  let found = 0;
  for (let i = 6; i < words.length; i += 8) if (words[i] >>> 16) found++;
  return found;
}

function isLight({ counts: [x, y, z], far: [width, height], far_levels, network }, [cells, skips, far, weights]) {
  if (weights.length !== 4 * (network?.n_words ?? 0)) return false;
  const ofLevels = Array.from({ length: far_levels }, (_, level) => 8 * (width >> level) * (height >> level));
  return cells.length === 8 * x * y * z && skips.length === (x - 1) * (y - 1) * (z - 1) && far.length === ofLevels.reduce((a, b) => a + b);
}

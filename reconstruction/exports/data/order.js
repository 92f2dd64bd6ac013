// Order of Gaussians from far to near, by a counting sort of 16-bit keys in a worker.

// Runs in the worker as text of its own: it uses nothing of the page.
function sortWorker(scope) {
  const capacity = 65537;
  let means = new Float32Array(0);
  let added = 0;
  let partOf = null; // of the Gaussians that were added: the part, + 1, that takes the place of each
  let isThere = new Uint8Array(0); // by part + 1
  let ranges = []; // of parts that are there: first one and number
  let depths = new Float32Array(0);
  let keys = new Uint16Array(0);
  const counts = new Uint32Array(capacity);

  function makeRoom(n) {
    if (3 * n <= means.length) return;
    const grown = new Float32Array(Math.max(2 * means.length, 3 * n));
    grown.set(means);
    means = grown;
    depths = new Float32Array(grown.length / 3 + 1);
    keys = new Uint16Array(depths.length);
  }

  function add(part, parts) {
    makeRoom(added + part.length / 3);
    means.set(part, 3 * added);
    if (parts) {
      const longer = new Uint16Array(added + parts.length);
      if (partOf) longer.set(partOf);
      longer.set(parts, added);
      partOf = longer;
    }
    added += part.length / 3;
  }

  // Parts that are there, with the places of one of them.
  function show({ part, at, parts, numbers }) {
    makeRoom(at + part.length / 3);
    means.set(part, 3 * at);
    ranges = parts;
    isThere = new Uint8Array(65537);
    for (const number of numbers) isThere[number + 1] = 1;
  }

  // Keys are the upper bits of positive floats, which grow as the floats do: finer the nearer, over any range.
  // Of the first `most`, which are the most visible ones.
  function order([fx, fy, fz], offset, near, most) {
    const all = ranges.reduce((sum, [, count]) => sum + count, added);
    const share = Math.min(1, most / Math.max(all, 1));
    const runs = [[0, added], ...ranges].map(([first, count]) => [first, first + Math.ceil(share * count)]);
    const bits = new Uint32Array(depths.buffer);
    let low = 0xffffffff;
    let high = 0;
    for (const [first, end] of runs) {
      for (let i = first, j = 3 * first; i < end; i++, j += 3) {
        const depth = fx * means[j] + fy * means[j + 1] + fz * means[j + 2] - offset;
        depths[i] = depth > near ? depth : 0;
        if (partOf && i < added && isThere[partOf[i]]) depths[i] = 0;
        const key = bits[i];
        if (key !== 0) {
          if (key < low) low = key;
          if (key > high) high = key;
        }
      }
    }
    if (high === 0) return new Uint32Array(0);
    const shift = Math.max(0, 32 - Math.clz32(high - low) - 16);
    counts.fill(0);
    for (const [first, end] of runs) {
      for (let i = first; i < end; i++) if (bits[i] !== 0) counts[(keys[i] = (bits[i] - low) >>> shift)]++;
    }
    let total = 0;
    for (let key = 65535; key >= 0; key--) {
      const count = counts[key];
      counts[key] = total;
      total += count;
    }
    const found = new Uint32Array(total);
    for (const [first, end] of runs) {
      for (let i = first; i < end; i++) if (bits[i] !== 0) found[counts[keys[i]]++] = i;
    }
    return found;
  }

  scope.onmessage = ({ data }) => {
    if (data.means) return add(data.means, data.parts);
    if (data.part) return show(data);
    const found = order(data.forward, data.offset, data.near, data.most);
    return scope.postMessage(found, [found.buffer]);
  };
}

const NEAR = 0.2;

// A policy can be made once in a page.
let policy = null;
function scriptAddress(address) {
  policy ??= window.trustedTypes?.createPolicy("reflight", { createScriptURL: (given) => given });
  return policy ? policy.createScriptURL(address) : address;
}

class Sorter {
  // found: called with each order, an Uint32Array.
  constructor(found) {
    this.found = found;
    this.parts = []; // until the worker has answered once
    this.isBusy = false;
    this.wanted = null;
    this.done = "";
    const text = `(${sortWorker})(self)`;
    try {
      this.worker = new Worker(scriptAddress(URL.createObjectURL(new Blob([text], { type: "text/javascript" }))));
    } catch {
      this.worker = this.here();
    }
    this.worker.onmessage = ({ data }) => this.receive(data);
    this.worker.onerror = () => this.fallBack();
  }

  // Some browsers refuse a worker only after it was made.
  fallBack() {
    if (this.parts === null) return;
    this.worker = this.here();
    this.worker.onmessage = ({ data }) => this.receive(data);
    for (const message of this.parts) this.worker.postMessage(message);
    Object.assign(this, { isBusy: false, done: "" });
    this.next();
  }

  // Where a browser allows a page from the disk no workers.
  here() {
    const side = {};
    const scope = { postMessage: (data) => setTimeout(() => side.onmessage({ data })) };
    sortWorker(scope);
    side.postMessage = (data) => scope.onmessage({ data });
    return side;
  }

  // parts: which part, + 1, takes the place of each; null where there are none.
  add(means, parts = null) {
    this.post({ means, parts });
  }

  // Places of a part from `at` on; ranges and numbers of all parts that are there.
  show(part, at, parts, numbers) {
    this.post({ part, at, parts, numbers });
  }

  post(message) {
    this.parts?.push(message);
    this.worker.postMessage(message);
  }

  // Sort anew, as there are more.
  renew(camera) {
    this.done = "";
    this.want(camera);
  }

  // Of the `most` most visible ones. Asked for as often as one likes; while one is being made, only the last is
  // remembered.
  want(camera, most = 1e9) {
    const forward = camera.axes()[2];
    this.wanted = { forward, offset: dot(forward, camera.eye), near: NEAR, most };
    this.next();
  }

  next() {
    if (this.isBusy || this.wanted === null) return;
    const asked = JSON.stringify(this.wanted);
    if (asked === this.done) return;
    this.done = asked;
    this.isBusy = true;
    this.worker.postMessage(this.wanted);
  }

  receive(order) {
    this.parts = null;
    this.isBusy = false;
    this.found(order);
    this.next();
  }

  end() {
    this.found = () => {};
    this.worker.terminate?.();
  }

  get isSettled() {
    return !this.isBusy && JSON.stringify(this.wanted) === this.done;
  }
}

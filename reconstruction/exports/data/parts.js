// Parts of a large model: scripts beside the page, which it may load from the disk, too. A part takes the place of those
// Gaussians of the coarse model that stand for it. Parts that are seen largest come first, and those that are seen least
// make room: never more are there than `room` says.
const FINE_PX = 1.0; // cubes that are smaller need no part

class Parts {
  constructor(picture, sorter, told) {
    Object.assign(this, { picture, sorter, told, asked: null, isBusy: false, isLost: false, resident: new Map(), waiting: new Map() });
    const { size, each } = model.beside;
    this.first = ROW * Math.ceil(model.n / ROW);
    this.free = Array.from({ length: Math.min(each.length, Math.floor((picture.most - this.first) / size)) }, (_, slot) => slot);
    window.reflightPart = (number, ...texts) => {
      this.waiting.get(number)?.(texts);
      this.waiting.delete(number);
    };
  }

  get isSettled() {
    return !this.isBusy;
  }

  // How large a part is seen, in pixels of the page; 0 where the coarse model does.
  weight(number, { eye, focal, forward }) {
    const [, , x, y, z, radius] = model.beside.each[number];
    const towards = minus([x, y, z], eye);
    const distance = Math.max(Math.hypot(...towards) - radius, 0.1);
    if ((model.beside.side * focal) / distance < FINE_PX) return 0;
    const isBehind = dot(towards, forward) < -radius;
    return ((radius * focal) / distance) * (isBehind ? 0.01 : 1);
  }

  want(camera) {
    const key = `${camera.eye} ${camera.axes()[2]} ${camera.focal()}`;
    if (key === this.shown || this.isLost) return;
    this.shown = key;
    this.asked = { eye: camera.eye, focal: camera.focal(), forward: camera.axes()[2] };
    if (!this.isBusy) this.work();
  }

  // One part after the other, for where the camera is by then.
  async work() {
    this.isBusy = true;
    try {
      for (;;) {
        const next = this.next();
        if (next === null || this.picture !== picture) break;
        await this.show(...next);
      }
    } catch (error) {
      console.info(`no parts: ${error.message}`);
      this.isLost = true;
      this.told();
    }
    this.isBusy = false;
  }

  // A part and the slot for it; null where all is there that there is room for.
  next() {
    const weights = model.beside.each.map((_, number) => this.weight(number, this.asked));
    let best = -1;
    for (let i = 0; i < weights.length; i++) if (!this.resident.has(i) && weights[i] > (weights[best] ?? 0)) best = i;
    if (best < 0) return null;
    if (this.free.length) return [best, this.free.pop()];
    let least = -1;
    for (const i of this.resident.keys()) if (least < 0 || weights[i] < weights[least]) least = i;
    // Not for a little more, or they would take turns.
    if (least < 0 || weights[best] < 1.2 * weights[least]) return null;
    const slot = this.resident.get(least);
    this.resident.delete(least);
    return [best, slot];
  }

  async show(number, slot) {
    const bytes = (await this.loaded(number)).map(bytesOf);
    const [n, nGlass] = model.beside.each[number];
    const each = [0, 9, 24, 45][model.degree];
    if (bytes[0].length !== n * (32 + each) || (bytes[1] && bytes[1].length !== nGlass * (8 + each))) throw new Error(`part ${number} is damaged`);
    const words = new Uint32Array(bytes[0].buffer, 0, 8 * n);
    const start = this.first + slot * model.beside.size;
    this.picture.put(start, slot, words, bytes[0].subarray(32 * n), bytes[1] ?? null);
    const means = new Float32Array(3 * n);
    const places = new Float32Array(words.buffer, 0, 8 * n);
    for (let i = 0; i < n; i++) means.set(places.subarray(8 * i, 8 * i + 3), 3 * i);
    this.resident.set(number, slot);
    const ranges = [...this.resident].map(([part, at]) => [this.first + at * model.beside.size, model.beside.each[part][0]]);
    this.sorter.show(means, start, ranges, [...this.resident.keys()]);
    this.sorter.renew(camera);
    ask();
  }

  loaded(number) {
    return new Promise((resolve, reject) => {
      const script = document.createElement("script");
      this.waiting.set(number, resolve);
      script.onerror = () => reject(new Error(`part ${number} is missing`));
      script.onload = () => {
        script.remove();
        if (this.waiting.delete(number)) reject(new Error(`part ${number} is damaged`));
      };
      script.src = scriptAddress(`${model.beside.folder}/${number}.js`);
      document.head.append(script);
    });
  }
}

// Moving through the model by mouse, fingers and keys.
const TURN = 0.005; // radians per pixel
const KEYS = { w: [0, 1, 0], s: [0, -1, 0], a: [-1, 0, 0], d: [1, 0, 0], e: [0, 0, 1], q: [0, 0, -1] };
const ARROWS = { arrowup: [0, 1], arrowdown: [0, -1], arrowleft: [-1, 0], arrowright: [1, 0] };
const TAP = 6; // pixels that a click may move

class Motion {
  // scene: { camera, panes, home(), changed(), clicked(x, y), visited(x, y), hovered(x, y), escaped() }
  constructor(canvas, scene) {
    Object.assign(this, { canvas, scene, isFlying: false, pointers: new Map(), held: new Map(), last: 0 });
    const on = (name, act, options) => canvas.addEventListener(name, act, options);
    on("pointerdown", (event) => this.down(event));
    on("pointermove", (event) => this.move(event));
    for (const name of ["pointerup", "pointercancel"]) on(name, (event) => this.up(event));
    on("contextmenu", (event) => event.preventDefault());
    on("wheel", (event) => this.wheel(event), { passive: false });
    on("dblclick", (event) => scene.visited(event.offsetX, event.offsetY));
    on("pointerleave", () => scene.hovered(null));
    on("keydown", (event) => this.key(event));
    window.addEventListener("keyup", (event) => this.held.delete(event.key.toLowerCase()));
    for (const lost of ["blur", "pagehide"]) window.addEventListener(lost, () => this.held.clear());
  }

  // What lies under a pixel, else a place as far away as what is turned around.
  under(x, y) {
    const { camera, panes } = this.scene;
    const ray = camera.ray(x, y);
    return panes.hit(camera.eye, ray)?.place ?? along(camera.eye, ray, camera.distance);
  }

  down(event) {
    this.canvas.focus({ preventScroll: true });
    this.canvas.setPointerCapture(event.pointerId);
    const { offsetX: x, offsetY: y } = event;
    this.pointers.set(event.pointerId, [x, y]);
    this.pivot = this.under(x, y);
    this.moved = this.pointers.size > 1 ? Infinity : 0;
    this.isPanning = event.button === 2 || event.button === 1 || event.shiftKey;
  }

  move(event) {
    const { scene, pointers } = this;
    const { camera } = scene;
    const { offsetX: x, offsetY: y } = event;
    const before = pointers.get(event.pointerId);
    if (!before) {
      if (event.pointerType === "mouse") scene.hovered([x, y]);
      return;
    }
    const [dx, dy] = [x - before[0], y - before[1]];
    this.moved += Math.hypot(dx, dy);
    if (this.moved <= TAP) return;
    if (pointers.size === 2) this.pinch(event.pointerId, [x, y]);
    else if (this.isPanning) camera.pan(dx, dy, this.depth());
    else if (this.isFlying) camera.turn(-TURN * dx * 0.6, TURN * dy * 0.6);
    else camera.turnAround(this.pivot, TURN * dx, -TURN * dy);
    pointers.set(event.pointerId, [x, y]);
    scene.changed();
  }

  depth() {
    const { camera } = this.scene;
    return Math.max(dot(minus(this.pivot, camera.eye), camera.axes()[2]), 0.1);
  }

  pinch(id, now) {
    const { camera } = this.scene;
    const other = [...this.pointers].find(([each]) => each !== id)[1];
    const before = this.pointers.get(id);
    const gap = (a) => Math.max(Math.hypot(a[0] - other[0], a[1] - other[1]), 10);
    const middle = [(now[0] + other[0]) / 2, (now[1] + other[1]) / 2];
    camera.pan((now[0] - before[0]) / 2, (now[1] - before[1]) / 2, this.depth());
    camera.approach(along(camera.eye, camera.ray(...middle), this.depth()), gap(before) / gap(now));
  }

  up(event) {
    const isClick = this.pointers.delete(event.pointerId) && this.moved <= TAP && event.type === "pointerup" && event.button === 0;
    if (isClick) this.scene.clicked(event.offsetX, event.offsetY);
    if (this.pointers.size) this.moved = Infinity;
  }

  wheel(event) {
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 16 : event.deltaMode === 2 ? 400 : 1;
    const factor = Math.exp(clamped(event.deltaY * lines, -300, 300) * 0.0015);
    this.scene.camera.approach(this.under(event.offsetX, event.offsetY), factor);
    this.scene.changed();
  }

  key(event) {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const key = event.key.toLowerCase();
    const { scene } = this;
    if (key in KEYS || key in ARROWS) {
      event.preventDefault();
      this.held.set(key, event.shiftKey ? 3 : 1);
      this.step(0.03);
      this.run();
    } else if (key === "+" || key === "=") this.zoom(0.8);
    else if (key === "-") this.zoom(1.25);
    else if (key === "0" || key === "home") scene.home();
    else if (key === "f") scene.flew(!this.isFlying);
    else if (key === "?") scene.helped();
    else if (key === "escape") scene.escaped();
  }

  zoom(factor) {
    const { camera } = this.scene;
    camera.approach(camera.target(), factor);
    this.scene.changed();
  }

  // Metres per second: a little of how far away things are.
  speed() {
    return clamped(this.scene.camera.distance * 0.5, 1, 60);
  }

  step(seconds) {
    const { camera } = this.scene;
    for (const [key, fast] of this.held) {
      const metres = seconds * this.speed() * fast;
      if (key in ARROWS && !this.isFlying) {
        const [across, up] = ARROWS[key];
        camera.turnAround(camera.target(), across * seconds * 1.2, -up * seconds * 1.2);
      } else {
        const [right, forward, up] = KEYS[key] ?? [ARROWS[key][0], ARROWS[key][1], 0];
        camera.walk(right * metres, forward * metres, up * metres);
      }
    }
    if (this.held.size) this.scene.changed();
  }

  // While keys are held.
  run() {
    if (this.isRunning) return;
    this.isRunning = true;
    let last = performance.now();
    const go = (now) => {
      if (!this.held.size) {
        this.isRunning = false;
        return;
      }
      this.step(clamped((now - last) / 1000, 0, 0.1));
      last = now;
      requestAnimationFrame(go);
    };
    requestAnimationFrame(go);
  }
}

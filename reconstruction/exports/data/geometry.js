// Places in metres, ENU less the model's origin. Cameras: x right, y down, z forward. Angles in radians; heading is
// clockwise from north, pitch 0 at the horizon.
const FIELD_OF_VIEW = 0.9;
const STEEPEST = 1.55;

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const along = (a, b, t) => [a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const clamped = (value, low, high) => Math.min(Math.max(value, low), high);

class Camera {
  constructor() {
    Object.assign(this, { eye: [0, 0, 0], heading: 0, pitch: 0, distance: 10, width: 1, height: 1, fixedFocal: null });
  }

  // Rows: right, down, forward.
  axes() {
    const [sh, ch, sp, cp] = [Math.sin(this.heading), Math.cos(this.heading), Math.sin(this.pitch), Math.cos(this.pitch)];
    return [[ch, -sh, 0], [sp * sh, sp * ch, -cp], [cp * sh, cp * ch, sp]];
  }

  // Pixels (of the page) per unit of tangent; the field of view is that of the shorter side, unless a script fixed it.
  focal() {
    return this.fixedFocal ?? Math.min(this.width, this.height) / 2 / Math.tan(FIELD_OF_VIEW / 2);
  }

  target() {
    return along(this.eye, this.axes()[2], this.distance);
  }

  // x and y in pixels of the page, z in metres before the camera.
  project(place) {
    const [right, down, forward] = this.axes();
    const towards = minus(place, this.eye);
    const [z, f] = [dot(towards, forward), this.focal()];
    return [this.width / 2 + (f * dot(towards, right)) / z, this.height / 2 + (f * dot(towards, down)) / z, z];
  }

  // Direction through a pixel, 1 long along the camera's axis: lengths along it are depths.
  ray(x, y) {
    const [right, down, forward] = this.axes();
    const f = this.focal();
    return along(along(forward, right, (x - this.width / 2) / f), down, (y - this.height / 2) / f);
  }

  // Turn around a place, which stays where it is in the picture.
  turnAround(pivot, heading, pitch) {
    const seen = this.axes().map((axis) => dot(axis, minus(pivot, this.eye)));
    this.turn(heading, pitch);
    this.eye = this.axes().reduce((eye, axis, i) => along(eye, axis, -seen[i]), pivot);
  }

  turn(heading, pitch) {
    this.heading = (this.heading + heading) % (2 * Math.PI);
    this.pitch = clamped(this.pitch + pitch, -STEEPEST, STEEPEST);
  }

  // Metres to the right, forward, and up the sky.
  walk(right, forward, up) {
    const axes = this.axes();
    this.eye = along(along(along(this.eye, axes[0], right), axes[2], forward), [0, 0, 1], up);
  }

  // Pixels of the picture along which what lies at a depth is to move.
  pan(x, y, depth) {
    const [right, down] = this.axes();
    this.eye = along(along(this.eye, right, (-x * depth) / this.focal()), down, (-y * depth) / this.focal());
  }

  // Bring a place nearer by a factor below 1, or push it away; it stays where it is in the picture.
  approach(place, factor) {
    this.eye = along(place, minus(this.eye, place), factor);
    this.distance = clamped(this.distance * factor, 0.05, 1e5);
  }
}

// A camera that shows a ball from before.
function facing(target, radius, heading, pitch, width, height) {
  const camera = Object.assign(new Camera(), { heading, pitch, width, height });
  const half = Math.atan((Math.min(width, height) / 2 / camera.focal()) * 0.96);
  camera.distance = radius / Math.sin(half);
  camera.eye = along(target, camera.axes()[2], -camera.distance);
  return camera;
}

// Panes as planes through their middle, ready to be met by rays.
class Panes {
  constructor(panes) {
    this.panes = panes.map(({ corners }) => {
      const c = [0, 3, 6, 9].map((i) => corners.slice(i, i + 3));
      const normal = cross(minus(c[2], c[0]), minus(c[3], c[1]));
      const length = Math.hypot(...normal) || 1;
      const middle = [0, 1, 2].map((i) => (c[0][i] + c[1][i] + c[2][i] + c[3][i]) / 4);
      const radius = Math.max(...c.map((corner) => Math.hypot(...minus(corner, middle))));
      return { corners: c, normal: normal.map((value) => value / length), middle, radius };
    });
  }

  // The nearest pane that a ray meets, from either side: { pane, t, place }, or null.
  hit(eye, ray) {
    let found = null;
    this.panes.forEach(({ corners, normal, middle }, pane) => {
      const t = dot(minus(middle, eye), normal) / dot(ray, normal);
      if (!(t > 0) || (found !== null && t >= found.t)) return;
      const place = along(eye, ray, t);
      for (let i = 0; i < 4; i++) {
        const edge = minus(corners[(i + 1) % 4], corners[i]);
        if (dot(cross(edge, minus(place, corners[i])), normal) < 0) return;
      }
      found = { pane, t, place };
    });
    return found;
  }

  // Bilinear place on a pane: u along c0 to c1, v along c0 to c3.
  place(pane, u, v) {
    const [c0, c1, c2, c3] = this.panes[pane].corners;
    return [0, 1, 2].map((i) => (1 - v) * ((1 - u) * c0[i] + u * c1[i]) + v * ((1 - u) * c3[i] + u * c2[i]));
  }
}

// The picture with panes as mirrors, by WebGPU: splats into three sums, shaded with what panes mirror, then marks.
// It has the methods of `Picture`, but those that read pixels back take their time.
const HALF = "rgba16float";
const MIXED = { srcFactor: "one", dstFactor: "one-minus-src-alpha" };
const BLEND = { color: MIXED, alpha: MIXED };
const WORDS_OF_DEGREE = [0, 3, 6, 12];
const MOST_RAYS = 4; // through a pixel, along each side
const MOST_LISTED = 2 ** 18; // rays that a network is asked about at once: 12 MB
const STRIP_MS = 50; // of shading: systems take a graphics card that is busy for 2 s for a hung one, and reset it

class MirrorPicture {
  // Of the `most` most visible Gaussians. Throws an Error where this browser or device cannot show them so; its message is
  // a key of WORDS where that is known. lost: called when the device is.
  static async made(canvas, model, panes, most, lost) {
    const adapter = await navigator.gpu?.requestAdapter({ powerPreference: "high-performance" });
    if (!adapter) throw new Error("noMirrors");
    const bytes = Math.max(32, 4 * (2 + WORDS_OF_DEGREE[model.degree])) * most;
    const sizes = { maxStorageBufferBindingSize: bytes, maxBufferSize: bytes };
    const requiredLimits = {};
    for (const [name, wanted] of Object.entries(sizes)) {
      if (wanted > adapter.limits[name]) throw new Error("large");
      if (wanted > 2 ** 27) requiredLimits[name] = wanted;
    }
    const device = await adapter.requestDevice({ requiredLimits });
    for (const filter of ["validation", "out-of-memory"]) device.pushErrorScope(filter);
    const picture = new MirrorPicture(device, canvas, model, panes, most);
    const problems = [await device.popErrorScope(), await device.popErrorScope()].filter(Boolean);
    if (problems.length) {
      device.destroy();
      throw new Error(problems[0] instanceof GPUOutOfMemoryError ? "large" : problems[0].message);
    }
    device.lost.then(({ message }) => {
      console.info(`WebGPU: ${message}`);
      lost();
    });
    return picture;
  }

  constructor(device, canvas, model, panes, most) {
    Object.assign(this, { device, canvas, model, most, n: 0, nGlass: 0, nOrdered: 0, size: [0, 0], isMirroring: true, isBusy: false, hasLight: false, version: 0, shownKey: "", rayMs: STRIP_MS / 16384 });
    this.context = canvas.getContext("webgpu");
    this.format = navigator.gpu.getPreferredCanvasFormat();
    this.context.configure({ device, format: this.format, alphaMode: "opaque" });
    this.module = device.createShaderModule({ code: WGSL });
    this.makeBuffers(panes);
    this.makeTextures();
    this.makePipelines();
    this.resize(1, 1);
    this.one = this.targets(1, 1);
    this.seenFrom = null;
  }

  buffer(bytes, usage) {
    return this.device.createBuffer({ size: Math.max(16, 4 * Math.ceil(bytes / 4)), usage: usage | GPUBufferUsage.COPY_DST });
  }

  makeBuffers(panes) {
    const { model, most } = this;
    const { STORAGE, UNIFORM, VERTEX } = GPUBufferUsage;
    const nRest = WORDS_OF_DEGREE[model.degree];
    this.view = this.buffer(128, UNIFORM);
    this.pixelView = this.buffer(128, UNIFORM);
    this.words = this.buffer(32 * most, STORAGE);
    this.rest = this.buffer(4 * nRest * most, STORAGE);
    this.rows = this.buffer(4 * most, STORAGE);
    this.glass = this.buffer(4 * (2 + nRest) * glassRoom(model, most), STORAGE);
    this.shown = this.buffer(16 * most, STORAGE);
    this.order = this.buffer(4 * most, STORAGE);
    this.tints = this.buffer(4 * (panes.panes.length + 1), STORAGE);
    this.steps = this.filled(new Float32Array([...padded(model.rest_steps), ...padded(model.mirrors.own_steps)]), UNIFORM);
    this.makeNetwork(model.mirrors.network);
    this.light = this.filled(lightNumbers(model.mirrors), UNIFORM);
    this.panes = this.filled(paneNumbers(panes, model.mirrors), STORAGE);
    this.paneCorners = this.filled(paneVertices(panes, model.panes), VERTEX);
    this.nPaneCorners = 6 * panes.panes.length;
    this.marks = this.buffer(0, VERTEX);
    this.nMarks = 0;
    this.lines = this.buffer(4 * 11 * 4 * 3, VERTEX);
  }

  // What a network is asked with; one number each where the light is of another kind.
  makeNetwork(network) {
    const { STORAGE, UNIFORM, COPY_DST } = GPUBufferUsage;
    this.weights = this.buffer(network ? 4 * network.n_words : 0, STORAGE);
    this.answers = this.buffer(network ? 16 * MOST_LISTED : 0, STORAGE);
    this.firsts = this.buffer(0, STORAGE);
    if (!network) return;
    this.network = this.filled(new Uint32Array(network.numbers), UNIFORM);
    this.raysAGroup = 4 * network.numbers.at(-1);
    this.rays = this.buffer(32 * MOST_LISTED, STORAGE);
    this.nRays = this.buffer(4, STORAGE | COPY_DST);
    this.strip = this.buffer(16, UNIFORM);
  }

  filled(values, usage) {
    const buffer = this.buffer(values.byteLength, usage);
    this.device.queue.writeBuffer(buffer, 0, values);
    return buffer;
  }

  texture(format, width, height, depth = 1, dimension = "2d", mipLevelCount = 1) {
    const usage = GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST | GPUTextureUsage.COPY_SRC
      | (dimension === "2d" ? GPUTextureUsage.RENDER_ATTACHMENT : 0);
    return this.device.createTexture({ format, dimension, mipLevelCount, size: [width, height, depth], usage });
  }

  // All of a texture, each level half as large as the one before.
  write(texture, data, bytesPerTexel) {
    let offset = 0;
    for (let mipLevel = 0; mipLevel < texture.mipLevelCount; mipLevel++) {
      const [width, height] = [texture.width >> mipLevel, texture.height >> mipLevel];
      const layout = { offset, bytesPerRow: width * bytesPerTexel, rowsPerImage: height };
      this.device.queue.writeTexture({ texture, mipLevel }, data, layout, [width, height, texture.depthOrArrayLayers]);
      offset += width * height * bytesPerTexel;
    }
  }

  makeTextures() {
    const { sky, mirrors } = this.model;
    this.sky = this.texture(HALF, 2 * sky.rows, sky.rows);
    this.write(this.sky, withAlpha(new Uint16Array(bytesOf(sky.halves).buffer)), 8);
    const [x, y, z] = mirrors.counts;
    this.cells = this.texture(HALF, x, y, z, "3d");
    this.skips = this.texture("r8uint", x - 1, y - 1, z - 1, "3d");
    this.far = this.texture(HALF, ...mirrors.far, 1, "2d", mirrors.far_levels);
    const linear = { magFilter: "linear", minFilter: "linear" };
    this.between = this.device.createSampler({ ...linear, addressModeU: "clamp-to-edge", addressModeV: "clamp-to-edge", addressModeW: "clamp-to-edge" });
    this.around = this.device.createSampler({ ...linear, addressModeU: "repeat", addressModeV: "clamp-to-edge" });
  }

  makePipelines() {
    const { module, device } = this;
    const drawn = (vertex, fragment, targets, more = {}) => device.createRenderPipeline({
      layout: "auto", primitive: { topology: "triangle-strip" }, ...more,
      vertex: { module, entryPoint: vertex, buffers: more.buffers ?? [] },
      fragment: { module, entryPoint: fragment, targets },
    });
    const attributes = (...formats) => formats.map(([format, offset], shaderLocation) => ({ format, offset, shaderLocation }));
    const corners = [{ arrayStride: 16, attributes: attributes(["float32x3", 0], ["float32", 12]) }];
    const edges = [{ arrayStride: 44, stepMode: "instance", attributes: attributes(["float32x3", 0], ["float32x3", 12], ["float32x4", 24], ["float32", 40]) }];
    const marks = [{ arrayStride: 40, stepMode: "instance", attributes: attributes(["float32x3", 0], ["float32x3", 12], ["float32x4", 24]) }];
    const deep = (depthWriteEnabled) => ({ format: "depth32float", depthWriteEnabled, depthCompare: "less-equal" });
    const ui = [{ format: HALF, blend: BLEND }];
    const triangles = { topology: "triangle-list" };
    this.pipelines = {
      colour: device.createComputePipeline({ layout: "auto", compute: { module, entryPoint: "colour_splats" } }),
      list: device.createComputePipeline({ layout: "auto", compute: { module, entryPoint: "list_rays" } }),
      ask: device.createComputePipeline({ layout: "auto", compute: { module, entryPoint: "ask_network" } }),
      splats: drawn("splat_corner", "splat_pixel", [0, 1, 2].map(() => ({ format: HALF, blend: BLEND }))),
      // Panels seen from behind neither mirror nor hide.
      numbers: drawn("pane_corner", "pane_number", [{ format: "r32uint" }], { buffers: corners, depthStencil: deep(true), primitive: { ...triangles, cullMode: "back" } }),
      shade: drawn("shade_corner", "shade_pixel", [{ format: HALF }], { primitive: triangles }),
      panes: drawn("pane_corner", "pane_pixel", ui, { buffers: corners, depthStencil: deep(true), primitive: triangles }),
      marks: drawn("mark_corner", "mark_pixel", ui, { buffers: marks, depthStencil: deep(false) }),
      lines: drawn("line_corner", "line_pixel", ui, { buffers: edges, depthStencil: { ...deep(false), depthCompare: "always" } }),
      show: drawn("show_corner", "show_pixel", [{ format: this.format }], { primitive: triangles }),
      read: drawn("show_corner", "show_pixel", [{ format: "rgba8unorm" }], { primitive: triangles }),
    };
    const own = { 0: this.view, 1: this.words };
    const { colour, splats, numbers, panes, marks: mark, lines } = this.pipelines;
    this.groups = {
      colour: this.group(colour, { ...own, 2: this.rest, 3: this.rows, 4: this.glass, 5: this.tints, 6: this.shown, 7: this.steps }),
      splats: this.group(splats, { ...own, 8: this.shown, 9: this.order }),
      pixel: this.group(splats, { 0: this.pixelView, 1: this.words, 8: this.shown, 9: this.order }),
      numbers: this.group(numbers, { 0: this.view, 22: this.tints }),
      panes: this.group(panes, { 0: this.view, 22: this.tints }),
      marks: this.group(mark, { 0: this.view }),
      lines: this.group(lines, { 0: this.view }),
    };
  }

  group(pipeline, resources) {
    const resource = (value) => (value instanceof GPUBuffer ? { buffer: value } : value instanceof GPUTexture ? value.createView() : value);
    const entries = Object.entries(resources).map(([binding, value]) => ({ binding: Number(binding), resource: resource(value) }));
    return this.device.createBindGroup({ layout: pipeline.getBindGroupLayout(0), entries });
  }

  targets(width, height) {
    const names = ["light", "mirrored", "reflectivity", "shaded", "whole"];
    const found = Object.fromEntries(names.map((name) => [name, this.texture(HALF, width, height)]));
    found.numbers = this.texture("r32uint", width, height);
    found.depth = this.device.createTexture({ format: "depth32float", size: [width, height], usage: GPUTextureUsage.RENDER_ATTACHMENT });
    return found;
  }

  resize(width, height) {
    if (this.size[0] === width && this.size[1] === height) return;
    for (const texture of Object.values(this.target ?? {})) texture.destroy();
    this.size = [this.canvas.width, this.canvas.height] = [width, height];
    this.version++;
    const found = (this.target = this.targets(width, height));
    if (this.network) this.resizeNetwork(width * height);
    this.groups.shade = this.group(this.pipelines.shade, {
      0: this.view, 10: this.light, 11: this.panes, 12: this.cells, 13: this.skips, 14: this.far, 15: this.between, 16: this.sky,
      17: this.around, 18: found.light, 19: found.mirrored, 20: found.reflectivity, 21: found.numbers, 24: this.answers, 25: this.firsts,
    });
    this.groups.show = this.group(this.pipelines.show, { 23: found.whole });
    this.groups.read = this.group(this.pipelines.read, { 23: found.whole });
  }

  resizeNetwork(nPixels) {
    this.firsts.destroy();
    this.firsts = this.buffer(4 * nPixels, GPUBufferUsage.STORAGE);
    const { target, pipelines: { list, ask } } = this;
    this.groups.list = this.group(list, {
      0: this.view, 10: this.light, 11: this.panes, 20: target.reflectivity, 21: target.numbers, 31: this.rays, 32: this.nRays,
      33: this.firsts, 34: this.strip,
    });
    this.groups.ask = this.group(ask, { 26: this.network, 27: this.weights, 28: this.rays, 29: this.nRays, 30: this.answers });
  }

  // The next Gaussians: 8 words each, bytes of their harmonics, and own values of those on panes.
  add(words, rest, glass) {
    this.nGlass += this.writeFrom(this.n, this.nGlass, words, rest, glass);
    this.n += words.length / 8;
  }

  // Gaussians of a part from `start` on.
  put(start, slot, words, rest, glass) {
    const { model } = this;
    this.writeFrom(start, model.mirrors.n_glass + slot * model.beside.most_glass, words, rest, glass);
    this.n = Math.max(this.n, start + words.length / 8);
  }

  // Returns how many are on panes.
  writeFrom(start, startGlass, words, rest, glass) {
    const { model, device: { queue } } = this;
    const n = words.length / 8;
    const held = 4 * WORDS_OF_DEGREE[model.degree];
    const rows = new Uint32Array(n);
    let nGlass = 0;
    for (let i = 0; i < n; i++) if (words[8 * i + 6] >>> 16) rows[i] = startGlass + ++nGlass;
    queue.writeBuffer(this.words, 32 * start, words);
    queue.writeBuffer(this.rows, 4 * start, rows);
    if (held) queue.writeBuffer(this.rest, held * start, spaced(rest, n, 0, held));
    if (nGlass) queue.writeBuffer(this.glass, (8 + held) * startGlass, spaced(glass, nGlass, 8, held));
    this.haveChanged();
    return nGlass;
  }

  // What panes mirror: density and light of the grid, what may be leapt over, and what is far away.
  addLight(cells, skips, far, weights) {
    this.write(this.cells, cells, 8);
    this.write(this.skips, skips, 1);
    this.write(this.far, far, 8);
    this.device.queue.writeBuffer(this.weights, 0, weights);
    this.hasLight = true;
    this.haveChanged();
  }

  setOrder(order) {
    this.device.queue.writeBuffer(this.order, 0, order);
    this.nOrdered = order.length;
    this.version++;
  }

  setTints(tints) {
    this.device.queue.writeBuffer(this.tints, 0, tints);
    this.haveChanged();
  }

  // Of colours: they are worked out anew.
  haveChanged() {
    this.seenFrom = null;
    this.version++;
  }

  setMarks(marks) {
    this.nMarks = marks.length;
    this.marks = this.filled(new Float32Array(marks.flat(2)), GPUBufferUsage.VERTEX);
  }

  // Of a target of so many pixels whose middle is `shift` from that of the whole picture; see `View` in view.wgsl.
  viewNumbers(camera, ratio, size, shift, before, rays, markWidth) {
    const { model } = this;
    const [low, high] = model.colour_range;
    const [right, down, forward] = camera.axes();
    return new Float32Array([
      ...camera.eye, camera.focal() * ratio, ...right, model.blur_px2, ...down, model.is_antialiased ? 1 : 0, ...forward, before,
      ...size, ...shift, camera.width * ratio, camera.height * ratio, rays, this.hasLight ? 1 : 0, low, high - low, model.degree, markWidth,
    ]);
  }

  drawSplats(encoder, target, group) {
    const views = [target.light, target.mirrored, target.reflectivity].map((texture) => cleared(texture));
    const pass = encoder.beginRenderPass({ colorAttachments: views });
    pass.setPipeline(this.pipelines.splats);
    pass.setBindGroup(0, group);
    if (this.nOrdered) pass.draw(4, this.nOrdered);
    pass.end();
  }

  // Once a place: colours depend on where the eye is, and on nothing else.
  colourSplats(encoder, { eye }) {
    const moved = 0.01; // m
    if (this.seenFrom && Math.hypot(...minus(eye, this.seenFrom)) < moved) return;
    this.seenFrom = eye;
    const pass = encoder.beginComputePass();
    pass.setPipeline(this.pipelines.colour);
    pass.setBindGroup(0, this.groups.colour);
    pass.dispatchWorkgroups(Math.ceil(Math.max(this.n, 1) / 256));
    pass.end();
  }

  drawNumbers(encoder) {
    const pass = encoder.beginRenderPass({ colorAttachments: [cleared(this.target.numbers)], depthStencilAttachment: deepest(this.target.depth) });
    pass.setPipeline(this.pipelines.numbers);
    pass.setBindGroup(0, this.groups.numbers);
    pass.setVertexBuffer(0, this.paneCorners);
    if (this.nPaneCorners) pass.draw(this.nPaneCorners);
    pass.end();
  }

  // Strip by strip, each a piece of work of its own: so slow cards are not taken for hung ones.
  shade(rays) {
    const [width, height] = this.size;
    const each = width * (this.hasLight ? rays * rays : 1);
    const most = this.network ? Math.floor(MOST_LISTED / each) : height;
    const rows = Math.max(1, Math.min(most, Math.floor(STRIP_MS / (this.rayMs * each))));
    for (let top = 0; top < height; top += rows) {
      const encoder = this.device.createCommandEncoder();
      if (this.network && this.hasLight) this.askNetwork(encoder, top * width, Math.min(rows, height - top) * width, rays * rays);
      const colorAttachments = [{ ...cleared(this.target.shaded), loadOp: top ? "load" : "clear" }];
      const pass = encoder.beginRenderPass({ colorAttachments });
      pass.setPipeline(this.pipelines.shade);
      pass.setBindGroup(0, this.groups.shade);
      pass.setScissorRect(0, top, width, Math.min(rows, height - top));
      pass.draw(3);
      pass.end();
      this.device.queue.submit([encoder.finish()]);
    }
  }

  // Light that mirrored rays of some pixels bring.
  askNetwork(encoder, first, n, raysEach) {
    this.device.queue.writeBuffer(this.strip, 0, new Uint32Array([first, n, 0, 0]));
    encoder.clearBuffer(this.nRays);
    const pass = encoder.beginComputePass();
    for (const [name, groups] of [["list", n / 64], ["ask", (n * raysEach) / this.raysAGroup]]) {
      pass.setPipeline(this.pipelines[name]);
      pass.setBindGroup(0, this.groups[name]);
      pass.dispatchWorkgroups(Math.ceil(groups));
    }
    pass.end();
  }

  drawOver(encoder, nEdges) {
    const colorAttachments = [{ view: this.target.whole.createView(), loadOp: "load", storeOp: "store" }];
    const pass = encoder.beginRenderPass({ colorAttachments, depthStencilAttachment: deepest(this.target.depth) });
    const drawn = [["panes", this.paneCorners, this.nPaneCorners, 1], ["marks", this.marks, 4, this.nMarks], ["lines", this.lines, 4, nEdges]];
    for (const [name, buffer, ...counts] of drawn) {
      if (counts.includes(0)) continue;
      pass.setPipeline(this.pipelines[name]);
      pass.setBindGroup(0, this.groups[name]);
      pass.setVertexBuffer(0, buffer);
      pass.draw(...counts);
    }
    pass.end();
  }

  show(encoder, texture, name) {
    const pass = encoder.beginRenderPass({ colorAttachments: [cleared(texture)] });
    pass.setPipeline(this.pipelines[name]);
    pass.setBindGroup(0, this.groups[name]);
    pass.draw(3);
    pass.end();
  }

  // As `Picture.draw`; while it moves, one mirrored ray a pixel will do.
  draw(camera, ratio, panes, looks, isMoving = false) {
    this.resize(Math.max(1, Math.round(camera.width * ratio)), Math.max(1, Math.round(camera.height * ratio)));
    const { queue } = this.device;
    const rays = isMoving ? 1 : Math.min(this.model.mirrors.rays, MOST_RAYS);
    const view = this.viewNumbers(camera, ratio, this.size, [0, 0], 0, rays, looks.markWidth * ratio);
    queue.writeBuffer(this.view, 0, view);
    const edges = looks.outlines.flatMap(({ pane, colour, width }) => edgesOf(panes.panes[pane].corners, colour, width * ratio));
    queue.writeBuffer(this.lines, 0, new Float32Array(edges));
    // Where only outlines are new, what mirrors is as it was.
    const key = `${view.join()} ${this.version}`;
    const isNew = key !== this.shownKey;
    if (isNew) {
      this.shownKey = key;
      this.drawParts(camera);
      this.shade(rays);
    }
    const encoder = this.device.createCommandEncoder();
    encoder.copyTextureToTexture({ texture: this.target.shaded }, { texture: this.target.whole }, this.size);
    this.drawOver(encoder, edges.length / 11);
    this.show(encoder, this.context.getCurrentTexture(), "show");
    queue.submit([encoder.finish()]);
    this.isBusy = true;
    const start = performance.now();
    queue.onSubmittedWorkDone().then(() => {
      this.isBusy = false;
      const nRays = this.size[0] * this.size[1] * rays * rays;
      if (isNew && this.hasLight) this.rayMs = (performance.now() - start) / nRays; // with the rest, which is little
    });
  }

  // What is shaded: sums of splats, and which pane is where.
  drawParts(camera) {
    const encoder = this.device.createCommandEncoder();
    this.colourSplats(encoder, camera);
    this.drawSplats(encoder, this.target, this.groups.splats);
    this.drawNumbers(encoder);
    this.device.queue.submit([encoder.finish()]);
  }

  // How much of what lies at a depth is hidden at a pixel of the page by Gaussians of no pane, 0 to 1.
  async hiddenAt(camera, x, y, depth) {
    const margin = 0.3; // m: frames stand out
    if (depth <= margin + NEAR) return 0;
    const shift = [Math.floor(x) + 0.5 - camera.width / 2, Math.floor(y) + 0.5 - camera.height / 2];
    this.device.queue.writeBuffer(this.pixelView, 0, this.viewNumbers(camera, 1, [1, 1], shift, depth - margin, 1, 0));
    const encoder = this.device.createCommandEncoder();
    this.drawSplats(encoder, this.one, this.groups.pixel);
    const bytes = await this.read(encoder, this.one.light, 8).catch(() => null);
    return bytes === null ? 0 : halfNumber(new Uint16Array(bytes.buffer, 0, 4)[3]); // null: the device was lost
  }

  // Bytes of a texture's rows, each as long as WebGPU copies them: a multiple of 256.
  async read(encoder, texture, bytesPerTexel) {
    const bytesPerRow = 256 * Math.ceil((texture.width * bytesPerTexel) / 256);
    const size = bytesPerRow * texture.height;
    const buffer = this.device.createBuffer({ size, usage: GPUBufferUsage.MAP_READ | GPUBufferUsage.COPY_DST });
    encoder.copyTextureToBuffer({ texture }, { buffer, bytesPerRow }, [texture.width, texture.height]);
    this.device.queue.submit([encoder.finish()]);
    await buffer.mapAsync(GPUMapMode.READ);
    const found = new Uint8Array(buffer.getMappedRange().slice(0));
    buffer.destroy();
    return found;
  }

  // Red, green, blue and opacity from the last row up.
  async pixels() {
    const [width, height] = this.size;
    const texture = this.texture("rgba8unorm", width, height);
    const encoder = this.device.createCommandEncoder();
    this.show(encoder, texture, "read");
    const rows = await this.read(encoder, texture, 4);
    texture.destroy();
    const found = new Uint8Array(4 * width * height);
    for (let row = 0; row < height; row++) {
      const start = (rows.length / height) * (height - 1 - row);
      found.set(rows.subarray(start, start + 4 * width), 4 * width * row);
    }
    return found;
  }

  done() {
    return this.device.queue.onSubmittedWorkDone();
  }

  destroy() {
    this.device.destroy();
  }
}

// Gaussians on panes of which own values are kept: the page's, and those of its parts.
const glassRoom = ({ mirrors, beside, n }, most) =>
  Math.min(mirrors.n_glass, most) + (beside ? Math.max(0, Math.ceil((most - n) / beside.size)) * beside.most_glass : 0);
const cleared = (texture) => ({ view: texture.createView(), loadOp: "clear", storeOp: "store", clearValue: [0, 0, 0, 0] });
const deepest = (texture) => ({ view: texture.createView(), depthLoadOp: "clear", depthClearValue: 1, depthStoreOp: "discard" });
const padded = (steps) => Array.from({ length: 16 }, (_, i) => steps[i] ?? 0);

// Rows of bytes, `fixed` of each as they are and the others ending at `held` more; `fixed` parts come first.
function spaced(bytes, n, fixed, held) {
  const given = bytes.length / n - fixed;
  const found = new Uint8Array((fixed + held) * n);
  for (let i = 0; i < n; i++) {
    found.set(bytes.subarray(i * fixed, (i + 1) * fixed), i * (fixed + held));
    found.set(bytes.subarray(n * fixed + i * given, n * fixed + (i + 1) * given), i * (fixed + held) + fixed);
  }
  return found;
}

// Pixels of three half numbers each as pixels of four.
function withAlpha(halves) {
  const found = new Uint16Array((halves.length / 3) * 4);
  for (let i = 0; i < halves.length / 3; i++) found.set(halves.subarray(3 * i, 3 * i + 3), 4 * i);
  return found;
}

function halfNumber(bits) {
  const [exponent, fraction] = [(bits >> 10) & 31, bits & 1023];
  return exponent ? 2 ** (exponent - 15) * (1 + fraction / 1024) : 2 ** -14 * (fraction / 1024);
}

// As `Light` in mirrored.wgsl has them.
function lightNumbers({ numbers }) {
  const { middle, half_side, inner, cell, over, outer, turn, reach, unit, far_side, far_times, density_scale, opaque, kind } = numbers;
  return new Float32Array([...middle, half_side, ...inner, cell, ...over, outer, ...turn, reach, unit, far_side, far_times, density_scale, opaque, kind, 0, 0, 0]);
}

// As `Pane` in mirrored.wgsl has them.
function paneNumbers(panes, { tilts, bows }) {
  const ofEdge = (edge) => edge.map((value) => value / Math.max(dot(edge, edge), 1e-20));
  return new Float32Array(panes.panes.flatMap(({ corners, normal }, pane) => [
    ...corners[0], tilts[pane][0], ...normal, tilts[pane][1],
    ...ofEdge(minus(corners[1], corners[0])), bows[pane][0], ...ofEdge(minus(corners[3], corners[0])), bows[pane][1],
  ]));
}

function edgesOf(corners, colour, width) {
  return corners.flatMap((corner, i) => [...corner, ...corners[(i + 1) % 4], ...colour, width]);
}

// The picture: Gaussians blended from far to near, then outlines and marks of panes.
const ROW = 1024;
const TINTS_WIDTH = 256;

class Picture {
  // Of the `most` most visible Gaussians. Throws an Error whose message is a key of WORDS where this device cannot show
  // them.
  constructor(canvas, model, panes, most) {
    const options = { antialias: false, alpha: false, powerPreference: "high-performance" };
    const gl = canvas.getContext("webgl2", options);
    if (gl === null) throw new Error("webgl");
    Object.assign(this, { canvas, gl, model, most, isMirroring: false, isBusy: false, n: 0, nOrdered: 0, size: [0, 0] });
    this.nRows = Math.max(1, Math.ceil(most / ROW));
    const widest = Math.max(2, model.degree) * ROW;
    if (Math.max(this.nRows, widest) > gl.getParameter(gl.MAX_TEXTURE_SIZE)) throw new Error("large");
    const program = (vertex, fragment) => new Program(gl, vertex, fragment);
    this.splats = program(SPLAT_VERTEX, SPLAT_FRAGMENT);
    this.colouring = program(SHOW_VERTEX, COLOUR_FRAGMENT);
    this.paneProgram = program(PANE_VERTEX, PANE_FRAGMENT);
    this.lines = program(LINE_VERTEX, LINE_FRAGMENT);
    this.marks = program(MARK_VERTEX, MARK_FRAGMENT);
    this.showing = program(SHOW_VERTEX, SHOW_FRAGMENT);
    this.data = this.texture(gl.RGBA32UI, 2 * ROW, this.nRows);
    this.rest = this.texture(gl.RGBA32UI, Math.max(1, model.degree) * (model.degree ? ROW : 1), model.degree ? this.nRows : 1);
    this.tints = this.texture(gl.RGBA8, TINTS_WIDTH, Math.ceil((panes.panes.length + 1) / TINTS_WIDTH));
    this.colours = this.texture(gl.RGBA8, ROW, this.nRows);
    this.colourTarget = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.colourTarget);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, this.colours, 0);
    this.sky = this.skyTexture(model.sky);
    if (gl.getError() === gl.OUT_OF_MEMORY) {
      for (const texture of [this.data, this.rest, this.colours]) gl.deleteTexture(texture);
      throw new Error("large");
    }
    this.empty = gl.createVertexArray();
    this.order = this.buffers([[null, 1, gl.UNSIGNED_INT, 4, 0, 1]]);
    this.paneBuffers = this.buffers([[paneVertices(panes, model.panes), 3, gl.FLOAT, 16, 0, 0], [null, 1, gl.FLOAT, 16, 12, 0]]);
    this.lineBuffers = this.buffers([[new Float32Array(0), 3, gl.FLOAT, 24, 0, 1], [null, 3, gl.FLOAT, 24, 12, 1]]);
    const mark = [[3, 0], [3, 12], [4, 24]].map(([n, start], i) => [i ? null : new Float32Array(0), n, gl.FLOAT, 40, start, 0]);
    this.markBuffers = this.buffers(mark);
    this.nMarks = 0;
    this.one = this.target(1, 1);
  }

  texture(format, width, height) {
    const { gl } = this;
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texStorage2D(gl.TEXTURE_2D, 1, format, width, height);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
    return texture;
  }

  // Light, linear between its pixels, round without a seam and ending at the poles, as the model's own.
  skyTexture({ rows, halves }) {
    const { gl } = this;
    const texture = this.texture(gl.RGB16F, 2 * rows, rows);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, 2 * rows, rows, gl.RGB, gl.HALF_FLOAT, new Uint16Array(bytesOf(halves).buffer));
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
    return texture;
  }

  // One buffer and how its attributes lie in it: data, number, type, stride, start, divisor.
  buffers(attributes) {
    const { gl } = this;
    const [array, buffer] = [gl.createVertexArray(), gl.createBuffer()];
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    attributes.forEach(([data, n, type, stride, start, divisor], place) => {
      if (data) gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
      gl.enableVertexAttribArray(place);
      if (type === gl.UNSIGNED_INT) gl.vertexAttribIPointer(place, n, type, stride, start);
      else gl.vertexAttribPointer(place, n, type, false, stride, start);
      gl.vertexAttribDivisor(place, divisor);
    });
    return { array, buffer };
  }

  fill({ buffer }, data) {
    this.gl.bindBuffer(this.gl.ARRAY_BUFFER, buffer);
    this.gl.bufferData(this.gl.ARRAY_BUFFER, data, this.gl.DYNAMIC_DRAW);
  }

  // Light as sRGB, which is blended as light, with a depth beside it.
  target(width, height) {
    const { gl } = this;
    const [light, depth, buffer] = [this.texture(gl.SRGB8_ALPHA8, width, height), gl.createRenderbuffer(), gl.createFramebuffer()];
    gl.bindRenderbuffer(gl.RENDERBUFFER, depth);
    gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT24, width, height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, buffer);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, light, 0);
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, depth);
    return { light, depth, buffer };
  }

  // The next Gaussians: 8 words each, and bytes of their harmonics; a multiple of ROW, but for the last ones.
  add(words, rest) {
    this.put(this.n, -1, words, rest);
    this.n += words.length / 8;
  }

  // Gaussians from `start` on, a multiple of ROW.
  put(start, _slot, words, rest) {
    const { gl, model } = this;
    const n = words.length / 8;
    const nRows = Math.ceil(n / ROW);
    const put = (texture, width, values) => {
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, start / ROW, width, nRows, gl.RGBA_INTEGER, gl.UNSIGNED_INT, values);
    };
    const whole = new Uint32Array(8 * ROW * nRows);
    whole.set(words);
    put(this.data, 2 * ROW, whole);
    if (model.degree > 0) {
      const [given, held] = [rest.length / n, 16 * model.degree];
      const bytes = new Uint8Array(held * ROW * nRows);
      for (let i = 0; i < n; i++) bytes.set(rest.subarray(i * given, (i + 1) * given), i * held);
      put(this.rest, model.degree * ROW, new Uint32Array(bytes.buffer));
    }
    this.seenFrom = null;
  }

  setOrder(order) {
    this.fill(this.order, order);
    this.nOrdered = order.length;
  }

  // Red, green, blue and strength for no pane and each pane, bytes.
  setTints(tints) {
    const { gl } = this;
    const nRows = Math.ceil(tints.length / 4 / TINTS_WIDTH);
    const whole = new Uint8Array(4 * TINTS_WIDTH * nRows);
    whole.set(tints);
    gl.bindTexture(gl.TEXTURE_2D, this.tints);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, TINTS_WIDTH, nRows, gl.RGBA, gl.UNSIGNED_BYTE, whole);
    this.seenFrom = null;
  }

  // Place, normal, and colour of each mark.
  setMarks(marks) {
    this.nMarks = marks.length;
    this.fill(this.markBuffers, new Float32Array(marks.flat(2)));
  }

  resize(width, height) {
    if (this.size[0] === width && this.size[1] === height) return;
    const { gl } = this;
    if (this.whole) {
      gl.deleteTexture(this.whole.light);
      gl.deleteRenderbuffer(this.whole.depth);
      gl.deleteFramebuffer(this.whole.buffer);
    }
    this.size = [this.canvas.width, this.canvas.height] = [width, height];
    this.whole = this.target(width, height);
  }

  use(program, camera, ratio) {
    const [width, height] = [camera.width * ratio, camera.height * ratio];
    program.use({ uEye: camera.eye, uCam: camera.axes().flat(), uSize: [width, height], uFocal: camera.focal() * ratio });
  }

  bind(...textures) {
    const { gl } = this;
    textures.forEach((texture, unit) => {
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(gl.TEXTURE_2D, texture);
    });
    gl.activeTexture(gl.TEXTURE0);
  }

  // Once a place and not once a corner: harmonics cost more than all the rest.
  colourSplats({ eye }) {
    const moved = 0.01; // m
    if (this.seenFrom && Math.hypot(...minus(eye, this.seenFrom)) < moved) return;
    this.seenFrom = eye;
    const { gl, model } = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.colourTarget);
    gl.viewport(0, 0, ROW, this.nRows);
    gl.disable(gl.DEPTH_TEST);
    gl.disable(gl.BLEND);
    this.bind(this.data, this.rest, this.tints);
    this.colouring.use({ uData: 0, uRest: 1, uTints: 2, uDegree: model.degree, uRange: model.colour_range, uEye: eye });
    if (model.degree > 0) this.colouring.use({ uSteps: model.rest_steps });
    gl.bindVertexArray(this.empty);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }

  drawSplats(camera, ratio, before) {
    const { gl } = this;
    gl.disable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    this.use(this.splats, camera, ratio);
    this.bind(this.data, this.colours);
    const { is_antialiased, blur_px2 } = this.model;
    this.splats.use({ uData: 0, uColours: 1, uBlur: blur_px2, uAntialiased: is_antialiased, uBefore: before });
    gl.bindVertexArray(this.order.array);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, this.nOrdered);
  }

  // ratio: pixels of the target per pixel of the page. looks: { outlines: [{ pane, colour, width }], markWidth }.
  draw(camera, ratio, panes, looks) {
    const { gl } = this;
    this.resize(Math.max(1, Math.round(camera.width * ratio)), Math.max(1, Math.round(camera.height * ratio)));
    this.colourSplats(camera);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.whole.buffer);
    gl.viewport(0, 0, ...this.size);
    gl.depthMask(true);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    this.drawSplats(camera, ratio, 0);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    this.use(this.paneProgram, camera, ratio);
    gl.bindTexture(gl.TEXTURE_2D, this.tints);
    this.paneProgram.use({ uTints: 0 });
    gl.bindVertexArray(this.paneBuffers.array);
    gl.drawArrays(gl.TRIANGLES, 0, 6 * panes.panes.length);
    gl.depthMask(false);
    this.use(this.marks, camera, ratio);
    this.marks.use({ uWidth: looks.markWidth * ratio });
    gl.bindVertexArray(this.markBuffers.array);
    gl.drawArrays(gl.POINTS, 0, this.nMarks);
    gl.disable(gl.DEPTH_TEST);
    for (const { pane, colour, width } of looks.outlines) this.drawOutline(camera, ratio, panes.panes[pane].corners, colour, width);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.disable(gl.BLEND);
    this.showing.use({ uLight: 0, uSky: 1, uSize: this.size, uFocal: camera.focal() * ratio, uCam: camera.axes().flat() });
    this.bind(this.whole.light, this.sky);
    gl.bindVertexArray(this.empty);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }

  drawOutline(camera, ratio, corners, colour, width) {
    const { gl } = this;
    this.fill(this.lineBuffers, new Float32Array(corners.flatMap((corner, i) => [...corner, ...corners[(i + 1) % 4]])));
    this.use(this.lines, camera, ratio);
    this.lines.use({ uWidth: width * ratio, uColour: colour });
    gl.bindVertexArray(this.lineBuffers.array);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, 4);
  }

  // How much of what lies at a depth is hidden at a pixel of the page by Gaussians of no pane, 0 to 1.
  hiddenAt(camera, x, y, depth) {
    const { gl } = this;
    const margin = 0.3; // m: frames stand out
    if (depth <= margin + NEAR) return 0;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.one.buffer);
    gl.viewport(-Math.floor(x), -Math.floor(camera.height - y), camera.width, camera.height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT);
    this.drawSplats(camera, 1, depth - margin);
    const found = new Uint8Array(4);
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, found);
    return found[3] / 255;
  }

  // Red, green, blue and opacity from the last row up.
  pixels() {
    const { gl, size: [width, height] } = this;
    const found = new Uint8Array(4 * width * height);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, found);
    return found;
  }

  done() {}
}

// Two triangles for each pane, and its number + 1, negative where it has Gaussians.
function paneVertices(panes, records) {
  const vertices = panes.panes.flatMap(({ corners }, pane) =>
    [0, 1, 2, 0, 2, 3].flatMap((i) => [...corners[i], records[pane].is_bare ? pane + 1 : -pane - 1]),
  );
  return new Float32Array(vertices);
}

class Program {
  constructor(gl, vertex, fragment) {
    this.gl = gl;
    this.program = gl.createProgram();
    for (const [type, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(this.program, shader);
    }
    gl.linkProgram(this.program);
    if (!gl.getProgramParameter(this.program, gl.LINK_STATUS) && !gl.isContextLost()) {
      const shaders = gl.getAttachedShaders(this.program).map((shader) => gl.getShaderInfoLog(shader));
      console.error(gl.getProgramInfoLog(this.program), ...shaders);
      throw new Error("webgl");
    }
    this.uniforms = new Map();
    for (let i = 0; i < gl.getProgramParameter(this.program, gl.ACTIVE_UNIFORMS); i++) {
      const { name, type } = gl.getActiveUniform(this.program, i);
      this.uniforms.set(name.replace("[0]", ""), [gl.getUniformLocation(this.program, name), type]);
    }
  }

  use(values) {
    const { gl } = this;
    gl.useProgram(this.program);
    const setters = new Map([
      [gl.FLOAT, (at, value) => (Array.isArray(value) ? gl.uniform1fv(at, value) : gl.uniform1f(at, value))],
      [gl.FLOAT_VEC2, (at, value) => gl.uniform2fv(at, value)],
      [gl.FLOAT_VEC3, (at, value) => gl.uniform3fv(at, value)],
      [gl.FLOAT_VEC4, (at, value) => gl.uniform4fv(at, value)],
      [gl.FLOAT_MAT3, (at, value) => gl.uniformMatrix3fv(at, false, value)],
    ]);
    for (const [name, value] of Object.entries(values)) {
      const [at, type] = this.uniforms.get(name) ?? [];
      if (at) (setters.get(type) ?? ((place, whole) => gl.uniform1i(place, whole)))(at, value);
    }
  }
}

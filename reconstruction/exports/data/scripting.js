// For scripts that drive the page; angles in degrees, places in metres.
window.reflight = Object.freeze({
  look(eye, heading, pitch, distance = 10) {
    goTo.current = null;
    Object.assign(camera, { eye: [...eye], heading: (heading * Math.PI) / 180, pitch: (pitch * Math.PI) / 180, distance });
    ask();
  },
  camera: () => ({ eye: camera.eye, heading: (camera.heading * 180) / Math.PI, pitch: (camera.pitch * 180) / Math.PI, focal: camera.focal(), width: camera.width, height: camera.height }),
  at: (x, y) => { const pane = panes.hit(camera.eye, camera.ray(x, y))?.pane; return pane === undefined ? null : model.panes[pane].id; },
  seenAt: (x, y) => { const pane = seenAt(x, y); return pane === null ? null : model.panes[pane].id; },
  pick: (id) => pick(model.panes.findIndex((pane) => pane.id === id)),
  state: () => ({ isLoaded: state.isLoaded, n: picture?.n ?? 0, picked: state.picked === null ? null : model.panes[state.picked].id }),
  // All loaded, arrived, in order and drawn at full size.
  async settled() {
    await loading;
    do {
      sorter?.want(camera);
      await pause(20);
    } while (goTo.current || (sorter && !sorter.isSettled));
    clearTimeout(restTimer);
    state.isMoving = false;
    draw();
  },
  // Of the picture: width, height, and red, green, blue, opacity from the last row up, as base64.
  pixels() {
    draw();
    const [width, height] = picture.size;
    const found = new Uint8Array(4 * width * height);
    picture.gl.readPixels(0, 0, width, height, picture.gl.RGBA, picture.gl.UNSIGNED_BYTE, found);
    let text = "";
    for (let i = 0; i < found.length; i += 32768) text += String.fromCharCode(...found.subarray(i, i + 32768));
    return { width, height, rgba: btoa(text) };
  },
});

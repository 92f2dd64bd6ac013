// For scripts that drive the page; angles in degrees, places in metres, the focal length in pixels of the page.
window.reflight = Object.freeze({
  look(eye, heading, pitch, distance = 10, focal = null) {
    goTo.current = null;
    Object.assign(camera, { eye: [...eye], heading: (heading * Math.PI) / 180, pitch: (pitch * Math.PI) / 180, distance, fixedFocal: focal });
    ask();
  },
  camera: () => ({ eye: camera.eye, heading: (camera.heading * 180) / Math.PI, pitch: (camera.pitch * 180) / Math.PI, focal: camera.focal(), width: camera.width, height: camera.height }),
  at: (x, y) => { const pane = panes.hit(camera.eye, camera.ray(x, y))?.pane; return pane === undefined ? null : model.panes[pane].id; },
  seenAt: async (x, y) => { const pane = await seenAt(x, y); return pane === null ? null : model.panes[pane].id; },
  pick: (id) => pick(model.panes.findIndex((pane) => pane.id === id)),
  state: () => ({ isLoaded: state.isLoaded, isMirroring: picture?.isMirroring ?? false, n: picture?.n ?? 0, nOrdered: picture?.nOrdered ?? 0, most: picture?.most ?? 0, parts: [...(parts?.resident.keys() ?? [])], picked: state.picked === null ? null : model.panes[state.picked].id }),
  // All loaded, arrived, in order, picked and drawn at full size.
  async settled() {
    let waited = null;
    while (waited !== loading) await (waited = loading);
    do {
      sorter?.want(camera);
      await pause(20);
      parts?.want(camera);
    } while (goTo.current || (sorter && !sorter.isSettled) || (parts && !parts.isSettled));
    clearTimeout(restTimer);
    state.isMoving = false;
    draw();
    await picture?.done();
    await state.asked;
  },
  // As when the graphics card goes away.
  lose: () => picture.destroy(),
  // Of the picture: width, height, and red, green, blue, opacity from the last row up, as base64.
  async pixels() {
    if (!picture.isMirroring) draw(); // WebGL forgets what it has shown
    const [width, height] = picture.size;
    const found = await picture.pixels();
    let text = "";
    for (let i = 0; i < found.length; i += 32768) text += String.fromCharCode(...found.subarray(i, i + 32768));
    return { width, height, rgba: btoa(text) };
  },
});

// The page: loads the model, and joins picture, list and controls.
const byId = (id) => document.getElementById(id);
const model = JSON.parse(byId("model").textContent);
const panes = new Panes(model.panes);
const records = new Records(model);
const defects = records.defects();
const camera = new Camera();
const state = { picked: null, hovered: null, column: null, matches: null, isLoaded: false, isKeeping: false, isMoving: false, hasMoved: false, quality: 1, share: 1, note: "", asked: null };
const scheme = window.matchMedia("(prefers-color-scheme: dark)");
let picture = null;
let sorter = null;
let parts = null;
let isAsked = false;
let restTimer = 0;
let lastFrame = 0;

function isDark() {
  const chosen = document.documentElement.dataset.theme;
  return chosen ? chosen === "dark" : scheme.matches;
}

function looks() {
  const accent = [...(isDark() ? hex("#ffd166") : hex("#ff9f1c")), 1];
  const outlines = [];
  if (state.hovered !== null && state.hovered !== state.picked) outlines.push({ pane: state.hovered, colour: [1, 1, 1, 0.8], width: 2 });
  if (state.picked !== null) {
    outlines.push({ pane: state.picked, colour: [0, 0, 0, 0.55], width: 7 }, { pane: state.picked, colour: accent, width: 4 });
  }
  return { outlines, markWidth: 18 };
}

const fullRatio = () => Math.min(window.devicePixelRatio || 1, 2);

function draw() {
  if (picture === null) return;
  sorter.want(camera, state.isMoving && state.share < 1 ? Math.ceil(state.share * picture.n) : undefined);
  parts?.want(camera);
  picture.draw(camera, fullRatio() * (state.isMoving ? state.quality : 1), panes, looks(), state.isMoving);
}

const CALM = 180; // ms
const COARSEST = 0.35;
const FEWEST = 0.1;

// Frames that take long make the picture coarser while it moves, and then leave out what is least visible; at rest it is
// as fine as the screen, and whole.
function adapt(took) {
  if (took > 50 && state.quality <= COARSEST) state.share = Math.max(FEWEST, 0.8 * state.share);
  else if (took < 25 && state.share < 1) state.share = Math.min(1, 1.1 * state.share);
  else state.quality = clamped(state.quality * (took > 50 ? 0.8 : took < 25 ? 1.1 : 1), COARSEST, 1);
}

function frame(now) {
  if (picture?.isBusy) return void requestAnimationFrame(frame);
  isAsked = false;
  const wasMoving = state.hasMoved;
  const took = now - lastFrame;
  lastFrame = now;
  state.hasMoved = state.isMoving;
  if (state.isMoving && wasMoving) adapt(took);
  draw();
}

function ask() {
  if (isAsked || picture === null) return;
  isAsked = true;
  requestAnimationFrame(frame);
}

function changed() {
  state.isMoving = true;
  clearTimeout(restTimer);
  restTimer = setTimeout(rest, CALM);
  ask();
}

// Where a frame is still being waited for, or a key is held, it is a slow device that makes the pause.
function rest() {
  if (isAsked || motion.held.size) {
    restTimer = setTimeout(rest, CALM);
    return;
  }
  state.isMoving = false;
  ask();
}

function goTo(goal) {
  const from = { eye: camera.eye, heading: camera.heading, pitch: camera.pitch, distance: camera.distance };
  const turn = ((((goal.heading - from.heading) % (2 * Math.PI)) + 3 * Math.PI) % (2 * Math.PI)) - Math.PI;
  const start = performance.now();
  const length = window.matchMedia("(prefers-reduced-motion: reduce)").matches ? 0 : 450;
  const step = (now) => {
    if (goTo.current !== step) return;
    const share = length ? clamped((now - start) / length, 0, 1) : 1;
    const t = share * share * (3 - 2 * share);
    camera.eye = along(from.eye, minus(goal.eye, from.eye), t);
    camera.heading = from.heading + t * turn;
    camera.pitch = from.pitch + t * (goal.pitch - from.pitch);
    camera.distance = from.distance + t * (goal.distance - from.distance);
    changed();
    if (share < 1) requestAnimationFrame(step);
    else goTo.current = null;
  };
  goTo.current = step;
  step(start);
}

// What is seen at first: all of the largest facade, square, unless something would stand in the way from that far.
function opening() {
  const { target, heading, pitch, half, front, free } = model.view;
  const found = Object.assign(new Camera(), { heading, pitch, width: camera.width, height: camera.height });
  const enough = [camera.width, camera.height].map((size, i) => half[i] / ((0.96 * size) / 2 / found.focal()));
  found.distance = front + Math.min(Math.max(...enough), free);
  found.eye = along(target, found.axes()[2], -found.distance);
  return found;
}

const home = () => goTo(opening());

function visit(pane) {
  const { middle, normal, radius } = panes.panes[pane];
  const pitch = clamped(Math.asin(clamped(-normal[2], -1, 1)), -STEEPEST, STEEPEST);
  goTo(facing(middle, Math.max(radius * 2.5, 2), Math.atan2(-normal[0], -normal[1]), pitch, camera.width, camera.height));
}

// What is picked at a pixel: a mark of a defect, else a pane that no tree or wall hides.
async function seenAt(x, y) {
  const hit = panes.hit(camera.eye, camera.ray(x, y));
  const isNear = ({ pane, record }) => {
    const place = panes.place(pane, record.u, record.v);
    const [px, py, depth] = camera.project(place);
    const isFront = dot(minus(camera.eye, place), panes.panes[pane].normal) > 0;
    return depth > 0 && isFront && Math.hypot(px - x, py - y) < 12 && panes.hit(camera.eye, camera.ray(px, py))?.pane === pane;
  };
  const marked = defects.find(isNear);
  if (marked) return marked.pane;
  if (hit === null || (picture !== null && (await picture.hiddenAt(camera, x, y, hit.t)) > 0.5)) return null;
  return hit.pane;
}

function pick(pane, isFromList = false) {
  state.picked = pane;
  try {
    history.replaceState(null, "", pane === null ? "#" : `#${encodeURIComponent(model.panes[pane].id)}`);
  } catch {
    // Some browsers allow a page from the disk no addresses of its own.
  }
  showSide();
  if (pane !== null) {
    byId("said").textContent = say("picked", model.panes[pane]);
    openSheet(true);
    if (isFromList) byId("content").querySelector("h2").focus({ preventScroll: true });
  }
  ask();
}

function showSide() {
  const box = byId("content");
  if (state.picked === null) {
    const choose = (pane) => {
      pick(pane, true);
      visit(pane);
    };
    records.showList(box, state.matches, state.column, choose);
  } else {
    const back = () => {
      pick(null);
      byId("search").focus();
    };
    records.showPane(box, state.picked, back, () => visit(state.picked));
    box.scrollTop = 0;
  }
}

function showColours() {
  picture?.setTints(tintsOf(model.panes.length, state.column, state.matches));
  showLegend(byId("legend"), state.column, defects.length > 0);
  ask();
}

function search() {
  state.matches = records.found(byId("search").value);
  state.picked = null;
  showSide();
  showColours();
}

function openSheet(isOpen) {
  document.body.classList.toggle("open", isOpen);
  byId("sheet").setAttribute("aria-expanded", String(isOpen));
}

function setFlying(isFlying) {
  motion.isFlying = isFlying;
  byId("fly").setAttribute("aria-pressed", String(isFlying));
  byId("pad").hidden = !isFlying;
}

function toggleHelp(isShown = byId("hint").hidden) {
  byId("hint").hidden = !isShown;
  byId("help").setAttribute("aria-expanded", String(isShown));
}

// All words of the page in the language chosen.
function showWords() {
  document.documentElement.lang = language;
  byId("title").textContent = model.title;
  byId("language").textContent = language === "de" ? "EN" : "DE";
  const labels = { language: "language", theme: "theme", sheet: "sheet", home: "home", nearer: "nearer", farther: "farther", fly: "fly", help: "help" };
  for (const [id, key] of Object.entries(labels)) {
    byId(id).title = say(key);
    byId(id).setAttribute("aria-label", say(key));
  }
  byId("picture").setAttribute("aria-label", say("canvas"));
  byId("loading").setAttribute("aria-label", say("loading"));
  byId("search").placeholder = say("search");
  byId("search").setAttribute("aria-label", say("search"));
  byId("colour-label").textContent = say("colour");
  showNote();
  byId("hint").replaceChildren(...sayLines("helpLines"));
  const options = [["", say("nothing")], ...model.columns.map((column, i) => [String(i), columnName(column)])];
  byId("colour").replaceChildren(...options.map(([value, text]) => Object.assign(make("option", "", text), { value })));
  byId("colour").value = state.column ? String(model.columns.indexOf(state.column)) : "";
  showSide();
  showColours();
}

// How far what panes mirror, where there are any, can be trusted.
function showNote() {
  const texts = model.n && model.panes.length ? [say(state.note || (model.is_baked ? "baked" : "plain"))] : [];
  if (parts?.isLost) texts.push(say("partsMissing", { folder: model.beside.folder }));
  if (picture !== null && picture.most < model.n) texts.push(say("partly", { n: picture.most, all: model.n }));
  byId("note").textContent = texts.join(" ");
}

const sayLines = (key) => WORDS[language][key].map((line) => make("p", "", line));

const motion = new Motion(byId("picture"), {
  camera, panes, home, changed: () => { goTo.current = null; changed(); },
  clicked: (x, y) => { state.asked = seenAt(x, y).then((pane) => pick(pane)); },
  visited: (x, y) => { state.asked = seenAt(x, y).then((pane) => { if (pane !== null) visit(pane); }); },
  hovered: (place) => {
    const pane = place ? (panes.hit(camera.eye, camera.ray(...place))?.pane ?? null) : null;
    if (pane === state.hovered) return;
    state.hovered = pane;
    byId("picture").title = pane === null ? "" : model.panes[pane].name;
    ask();
  },
  escaped: () => { if (motion.isFlying) setFlying(false); else pick(null); toggleHelp(false); },
  flew: setFlying, helped: toggleHelp,
});

function tell(key) {
  byId("trouble").textContent = say(key);
  byId("trouble").hidden = false;
}

// A picture of as many Gaussians as the device has memory for, the most visible ones: all, half of them, and so on.
async function fitting(make) {
  const least = 100000;
  const all = model.beside ? ROW * Math.ceil(model.n / ROW) + model.beside.room : model.n;
  for (let most = Math.max(all, 1); ; most = Math.ceil(most / 2 / model.at_once) * model.at_once) {
    try {
      return await make(most);
    } catch (error) {
      if (error.message !== "large" || most <= least) throw error;
    }
  }
}

// With panes as mirrors, by WebGPU; null where the model has none, or the browser cannot.
async function mirrorPicture() {
  if (!model.mirrors) return null;
  const lost = () => {
    if (picture?.isMirroring) startAgain();
  };
  try {
    return await fitting((most) => MirrorPicture.made(byId("mirrors"), model, panes, most, lost));
  } catch (error) {
    state.note = error.message === "large" ? "smallMirrors" : window.isSecureContext ? "noMirrors" : "httpMirrors";
    console.info(`no mirrors: ${error.message}`);
    return null;
  }
}

// Colours with mirrored light baked in, by WebGL 2; null, and said, where there is none. tries: half a second apart, as
// browsers need a moment after a graphics card went away.
async function plainPicture(tries = 1) {
  const canvas = byId("picture");
  try {
    const found = await fitting((most) => new Picture(canvas, model, panes, most));
    canvas.addEventListener("webglcontextlost", (event) => {
      event.preventDefault();
      picture = null;
      tell("lost");
    });
    return found;
  } catch (error) {
    if (error.message === "webgl" && tries > 1) {
      await pause(500);
      return plainPicture(tries - 1);
    }
    tell(own(WORDS.en, error.message) ? error.message : "webgl");
    return null;
  }
}

async function startPicture() {
  const mirrors = await mirrorPicture();
  if (mirrors) state.note = "mirrors";
  return begin(mirrors ?? (await plainPicture()));
}

// The graphics card went away, as laptops' do at times: on with what WebGL 2 can show.
function startAgain() {
  picture = parts = null;
  sorter?.end();
  sorter = null;
  if (!state.isKeeping) return tell("lost");
  state.note = "lostMirrors";
  loading = plainPicture(20).then(begin);
  return loading;
}

async function begin(found) {
  picture = found;
  if (picture === null) return;
  byId("mirrors").hidden = !picture.isMirroring;
  state.isLoaded = false;
  showNote();
  sorter = new Sorter((order) => {
    picture?.setOrder(order);
    ask();
  });
  picture.setMarks(defects.map(({ pane, record }) => {
    const colour = record.status === "repaired" ? [...REPAIRED, 0] : [...SEVERITIES[levelOf(record) - 1], 1];
    return [panes.place(pane, record.u, record.v), panes.panes[pane].normal, colour];
  }));
  showColours();
  try {
    const isWhole = await load();
    if (isWhole === false) tell("damaged");
    if (isWhole && model.beside) {
      parts = new Parts(picture, sorter, showNote);
      ask();
    }
  } catch (error) {
    console.error(error);
    tell("damaged");
  }
}

function listen() {
  const on = (id, name, act) => byId(id).addEventListener(name, act);
  on("search", "input", search);
  on("search", "focus", () => openSheet(true));
  on("colour", "change", () => {
    state.column = model.columns[Number(byId("colour").value)] ?? null;
    if (byId("colour").value === "") state.column = null;
    if (state.picked === null) showSide();
    showColours();
  });
  on("language", "click", () => { language = language === "de" ? "en" : "de"; showWords(); });
  on("theme", "click", () => { document.documentElement.dataset.theme = isDark() ? "light" : "dark"; ask(); });
  on("sheet", "click", () => openSheet(!document.body.classList.contains("open")));
  on("home", "click", home);
  on("nearer", "click", () => motion.zoom(0.7));
  on("farther", "click", () => motion.zoom(1 / 0.7));
  on("fly", "click", () => setFlying(!motion.isFlying));
  on("help", "click", () => toggleHelp());
  scheme.addEventListener("change", ask);
  for (const key of document.querySelectorAll("[data-walk]")) {
    const name = Object.keys(KEYS).find((each) => KEYS[each].join() === key.dataset.walk);
    key.addEventListener("pointerdown", () => { motion.held.set(name, 1); motion.run(); });
    for (const end of ["pointerup", "pointerleave", "pointercancel"]) key.addEventListener(end, () => motion.held.delete(name));
  }
  new ResizeObserver(() => {
    const isFirst = camera.width <= 1;
    Object.assign(camera, { width: Math.max(1, byId("stage").clientWidth), height: Math.max(1, byId("stage").clientHeight) });
    if (isFirst) Object.assign(camera, opening());
    ask();
  }).observe(byId("stage"));
  window.addEventListener("hashchange", pickOfAddress);
  // A ring around the picture helps with keys, and is in the way else.
  window.addEventListener("keydown", () => document.body.classList.add("keys"));
  window.addEventListener("pointerdown", () => document.body.classList.remove("keys"));
}

// Pages can be linked to with the GlobalId of a pane behind a #.
function pickOfAddress() {
  let id = "";
  try {
    id = decodeURIComponent(location.hash.slice(1));
  } catch {
    return;
  }
  const pane = model.panes.findIndex((each) => each.id === id);
  if (pane >= 0 && pane !== state.picked) pick(pane);
}

listen();
showWords();
let loading = startPicture();
pickOfAddress();

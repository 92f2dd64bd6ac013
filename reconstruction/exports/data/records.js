// The list of panes and their records. All that users wrote goes in as text, never as markup.
const LISTED = 100;
const RECORDS = ["attribute", "defect", "inspection", "maintenance", "document"];
const DRAWING = "http://www.w3.org/2000/svg";

function make(name, className, text) {
  const element = document.createElement(name);
  if (className) element.className = className;
  if (text !== undefined) element.textContent = text;
  return element;
}

function button(className, text, act) {
  const element = make("button", className, text);
  element.type = "button";
  element.addEventListener("click", act);
  return element;
}

class Records {
  constructor(model) {
    Object.assign(this, { model, shape: [100, 100] });
    this.of = new Map(Object.entries(model.records));
    this.texts = null;
  }

  // What is searched of each pane; made when it is first needed, in each language.
  textsOf() {
    if (this.texts?.language === language) return this.texts;
    const { model } = this;
    const texts = model.panes.map((pane) => {
      const facade = model.facades[pane.facade].name;
      return folded([pane.name, facade, pane.id, ...this.wordsOf(pane.id)].join("\n"));
    });
    const others = this.others().map(({ id }) => folded(this.wordsOf(id).join("\n")));
    this.texts = { language, panes: texts, others };
    return this.texts;
  }

  // Facades, other parts and the building, whose records are shown with all of their panes.
  others() {
    const { facades, parts, scene } = this.model;
    const named = facades.map(({ id, name }) => ({ id, name: say("facade", { name }) }));
    return [...named, ...parts, { id: scene, name: say("building") }];
  }

  wordsOf(id) {
    return this.ofObject(id).flatMap((record) => Object.entries(record).flatMap(([key, value]) => this.words(key, value)));
  }

  // A value is found as it is kept and as it is shown; names of stored files are not shown.
  words(key, value) {
    if (["record", "type", "picture", "inspection"].includes(key) || Array.isArray(value)) return [];
    if (key === "place" && own(this.model.files, value) !== null) return [];
    return [String(value), key === "status" ? stateWords(value) : shown(value)];
  }

  ofObject(id) {
    return this.of.get(id) ?? [];
  }

  // Panes whose records or names, or their facade's records, have a text in them; and of which others it is found.
  // Null where nothing is asked for.
  found(text) {
    const wanted = folded(text.trim());
    if (!wanted) return null;
    const { panes, others } = this.textsOf();
    const found = others.map((each) => each.includes(wanted));
    const matches = new Set(panes.flatMap((each, pane) => (each.includes(wanted) || found[this.model.panes[pane].facade] ? [pane] : [])));
    matches.others = this.others().filter((_, i) => found[i]);
    return matches;
  }

  // Defects with a place on a pane.
  defects() {
    return this.model.panes.flatMap((pane, i) =>
      this.ofObject(pane.id)
        .filter((record) => record.record === "defect" && typeof record.u === "number" && typeof record.v === "number")
        .map((record) => ({ pane: i, record })),
    );
  }

  showList(box, matches, column, pick) {
    const { model } = this;
    const all = matches === null ? model.panes.map((_, i) => i) : [...matches];
    const others = matches === null ? this.others() : matches.others;
    const counted = matches === null ? "panes" : all.length ? "found" : others.length ? "others" : "none";
    const list = make("ul", "panes");
    const scale = column && scaleOf(column);
    const add = (start) => {
      for (const pane of all.slice(start, start + LISTED)) {
        const row = button("row", "", () => pick(pane));
        row.append(make("b", "", model.panes[pane].name));
        const value = column ? column.values[pane] : null;
        if (value !== null && value !== undefined) {
          const words = make("span", "value", shown(value));
          const colour = scale.of(value);
          if (colour) words.style.borderColor = css(colour);
          row.append(words);
        }
        const item = make("li");
        item.append(row);
        list.append(item);
      }
      more.hidden = start + LISTED >= all.length;
      more.onclick = () => add(start + LISTED);
    };
    const more = button("wide", say("more"), () => {});
    add(0);
    const count = make("p", "count", say(counted === "others" ? "foundElsewhere" : counted, { n: all.length }));
    const records = make("div");
    for (const { id, name } of others) this.showOf(records, id, name, matches !== null);
    box.replaceChildren(count, ...(matches === null ? [list, more, records] : [records, list, more]));
  }

  showPane(box, number_, back, show) {
    const { model } = this;
    const pane = model.panes[number_];
    const facade = model.facades[pane.facade];
    const head = make("div", "head");
    head.append(button("small", `← ${say("back")}`, back), button("small", say("show"), show));
    const [c0, c1, c2, c3] = [0, 3, 6, 9].map((i) => pane.corners.slice(i, i + 3));
    const length = (a, b) => Math.hypot(...minus(a, b));
    const [w, h] = [(length(c0, c1) + length(c3, c2)) / 2, (length(c1, c2) + length(c0, c3)) / 2];
    const size = say("size", { w: round(w), h: round(h) });
    this.shape = [100 * Math.min(1, w / h), 100 * Math.min(1, h / w)];
    const title = make("h2", "", pane.name);
    title.tabIndex = -1;
    box.replaceChildren(head, title, make("p", "sub", `${say("facade", facade)} · ${size}`), make("code", "", pane.id));
    if (!this.ofObject(pane.id).length) box.append(make("p", "sub", say("noRecords")));
    this.showRecords(box, this.ofObject(pane.id));
    this.showOf(box, facade.id, say("facade", facade));
    this.showOf(box, model.scene, say("building"));
  }

  // Records of a facade or the building, folded up unless they were looked for.
  showOf(box, id, name, isOpen = false) {
    const records = this.ofObject(id);
    if (!records.length) return;
    const folder = make("details");
    folder.open = isOpen;
    folder.append(make("summary", "", name));
    this.showRecords(folder, records);
    box.append(folder);
  }

  showRecords(box, records) {
    const newest = (record) => String(record.date ?? record.found_on ?? "");
    for (const kind of RECORDS) {
      const ours = records.filter((record) => record.record === kind);
      if (!ours.length) continue;
      box.append(make("h3", "", say(kind)));
      if (kind === "attribute") {
        box.append(this.table(ours.map(({ name, value, unit }) => [fieldName(String(name ?? "")), value, unit ?? ""])));
        continue;
      }
      ours.sort((a, b) => (newest(a) < newest(b) ? 1 : newest(a) > newest(b) ? -1 : 0));
      for (const record of ours) box.append(kind === "defect" ? this.defect(record) : this.card(record));
    }
  }

  table(rows) {
    const list = make("dl");
    for (const [name, value, unit] of rows) {
      if (value === undefined || Array.isArray(value)) continue;
      list.append(make("dt", "", name), make("dd", "", shown(value) + (unit ? ` ${unit}` : "")));
    }
    return list;
  }

  card(record, hidden = []) {
    const card = make("article", "card");
    const skipped = ["record", "inspection", "place", "file", ...hidden];
    card.append(this.table(Object.entries(record).filter(([key]) => !skipped.includes(key)).map(([key, value]) => [fieldName(key), value])));
    if (record.place !== undefined) card.append(this.document(record));
    return card;
  }

  // A document: a link to the web, what is in the page, or why it is not.
  document({ place, file }) {
    const held = own(this.model.files, String(place));
    if (!held) return this.address(String(place));
    const name = String(file ?? place);
    const box = make("div", "file");
    if (held.picture !== undefined) box.append(make("code", "", name), this.picture(place));
    else if (held.document === undefined) box.append(make("code", "", name), this.lost(place));
    else box.append(button("wide", `${name} · ${fileSize(held.bytes)}`, () => save(held.document, name)));
    return box;
  }

  // The picture of a stored file, or why it is not there.
  picture(name) {
    const held = own(this.model.files, name);
    if (held?.picture === undefined) return this.lost(name);
    const image = make("img");
    image.alt = say("picture");
    image.loading = "lazy";
    whenRead(() => {
      const part = document.getElementById(`p${held.picture}`);
      if (part) image.src = `data:image/jpeg;base64,${part.textContent}`;
      else image.replaceWith(make("p", "sub", say("damaged")));
    });
    return image;
  }

  lost(name) {
    const held = own(this.model.files, name);
    const size = held?.bytes ? ` (${fileSize(held.bytes)})` : "";
    return make("p", "sub", say(own(LOST, held?.state ?? "") ?? "fileMissing", { name }) + size);
  }

  // A link only where it leads to the web; anything else, such as the name of a file, is text.
  address(text) {
    const isLink = /^https?:\/\/[^\s]+$/i.test(text) && URL.canParse?.(text);
    const element = make(isLink ? "a" : "code", "", text);
    if (isLink) Object.assign(element, { href: text, target: "_blank", rel: "noopener noreferrer" });
    return element;
  }

  defect(record) {
    const card = this.card(record, ["severity", "status", "kind", "u", "v", "outline", "picture"]);
    const head = make("div", "defect");
    const isOpen = record.status !== "repaired";
    const level = levelOf(record);
    const mark = badge(level, isOpen ? SEVERITIES[level - 1] : REPAIRED, !isOpen || level >= 4);
    mark.title = say("severity", { n: level });
    head.append(mark, make("b", "", String(record.kind ?? say("defect"))), make("span", "state", stateWords(record.status)));
    card.prepend(head);
    if (typeof record.u === "number" && typeof record.v === "number") card.append(placeDrawing(record, this.shape));
    if (record.picture !== undefined) card.append(this.picture(String(record.picture)));
    return card;
  }
}

const LOST = { missing: "fileMissing", damaged: "fileDamaged", large: "fileLarge" };
const stateWords = (status) => say(status === "repaired" ? "repaired" : "open");

function fileSize(bytes) {
  return bytes < 1e5 ? `${number(Math.max(1, Math.round(bytes / 1000)))} kB` : `${number(Math.round(bytes / 1e5) / 10)} MB`;
}

// Hand a document out as a file; it is never opened here, whatever it is.
function save(part, name) {
  const held = document.getElementById(`d${part}`);
  if (!held) return tell("damaged");
  const bytes = bytesOf(held.textContent);
  const address = URL.createObjectURL(new Blob([bytes], { type: "application/octet-stream" }));
  Object.assign(make("a"), { href: address, download: name }).click();
  return setTimeout(() => URL.revokeObjectURL(address), 60000);
}

// Files stand at the end of the page, and a pane may be shown before that is read.
function whenRead(act) {
  if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", act, { once: true });
  else act();
}

const levelOf = (record) => clamped(Math.round(Number(record.severity)) || 1, 1, 5);
const round = (value) => Math.round(100 * value) / 100;

// Where on the pane, as seen from outside: corner c0 is below on the left.
function placeDrawing({ u, v, outline }, [width, height]) {
  const draw = (name, attributes) => {
    const element = document.createElementNS(DRAWING, name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, String(value));
    return element;
  };
  const drawing = draw("svg", { viewBox: `-4 -4 ${width + 8} ${height + 8}`, role: "img", class: "place" });
  const title = draw("title", {});
  title.textContent = say("place");
  drawing.append(title, draw("rect", { x: 0, y: 0, width, height, rx: 2 }));
  const at = (place) => [width * clamped(place[0], 0, 1), height * (1 - clamped(place[1], 0, 1))];
  if (outline?.length) drawing.append(draw("polygon", { points: outline.map((place) => at(place).join(",")).join(" ") }));
  const [cx, cy] = at([u, v]);
  drawing.append(draw("circle", { cx, cy, r: 4 }));
  return drawing;
}

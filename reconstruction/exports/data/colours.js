// Colours of panes by a column of values, and the legend that explains them. Colours are [r, g, b], 0 to 1.
const hex = (text) => [1, 3, 5].map((i) => parseInt(text.slice(i, i + 2), 16) / 255);
const css = (colour) => `rgb(${colour.map((value) => Math.round(255 * value)).join(" ")})`;

// Readable for the colour-blind: lightness rises along each.
const NUMBERS = ["#2a2f7f", "#2f6f9e", "#38a58f", "#93cf5b", "#fbe14a"].map(hex);
const DATES = ["#8e1f2f", "#d2553a", "#f0a63e", "#a7c977", "#1c8a8f"].map(hex);
const SEVERITIES = ["#ffe07a", "#ffb84d", "#f77f3b", "#d93a3a", "#7d1535"].map(hex);
const KINDS = ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#f0e442", "#7a5cc7"].map(hex);
const YES_NO = { true: hex("#009e73"), false: hex("#d55e00") };
const OTHERS = hex("#7d8791");
const UNKNOWN = hex("#8c949c");
const ACCENT = hex("#1f8fff");
const REPAIRED = hex("#3f9b6d");

function between(stops, share) {
  const place = clamped(share, 0, 1) * (stops.length - 1);
  const i = Math.min(Math.floor(place), stops.length - 2);
  return stops[i].map((value, k) => value + (place - i) * (stops[i + 1][k] - value));
}

const day = (text) => Date.parse(`${text}T00:00:00Z`);

// How a column's values become colours: { of(value), bar or entries }.
function scaleOf(column) {
  const values = column.values.filter((value) => value !== null);
  if (column.name === ":worst_defect") {
    const entries = SEVERITIES.map((colour, i) => ({ value: i + 1, text: say("severity", { n: i + 1 }), colour }));
    return { of: (value) => SEVERITIES[clamped(Math.round(value), 1, 5) - 1], entries };
  }
  if (column.type === "number" || column.type === "date") {
    const measure = column.type === "date" ? day : Number;
    const known = values.map(measure).filter((value) => !Number.isNaN(value));
    const [low, high] = [known.reduce((a, b) => Math.min(a, b), Infinity), known.reduce((a, b) => Math.max(a, b), -Infinity)];
    const stops = column.type === "date" ? DATES : NUMBERS;
    const of = (value) => (Number.isNaN(measure(value)) ? null : between(stops, high > low ? (measure(value) - low) / (high - low) : 1));
    const end = (value) => (column.type === "date" ? new Date(value).toISOString().slice(0, 10) : value);
    return known.length ? { of, bar: { stops, low: end(low), high: end(high) } } : { of: () => null, entries: [] };
  }
  if (column.type === "yes/no") {
    const entries = [true, false].map((value) => ({ value, text: shown(value), colour: YES_NO[value] }));
    return { of: (value) => YES_NO[value], entries };
  }
  const counts = new Map();
  for (const value of values) counts.set(value, (counts.get(value) ?? 0) + 1);
  const names = [...counts.keys()].sort((a, b) => counts.get(b) - counts.get(a) || (a < b ? -1 : 1));
  const colours = new Map(names.slice(0, KINDS.length).map((name, i) => [name, KINDS[i]]));
  const entries = [...colours].map(([value, colour]) => ({ value, text: shown(value), colour }));
  if (names.length > KINDS.length) entries.push({ value: null, text: say("others"), colour: OTHERS });
  return { of: (value) => colours.get(value) ?? OTHERS, entries };
}

// Bytes for Picture.setTints: of the column's colours, with those that a search found standing out.
function tintsOf(n, column, matches) {
  const tints = new Uint8Array(4 * (n + 1));
  const scale = column && scaleOf(column);
  for (let pane = 0; pane < n; pane++) {
    const value = column ? column.values[pane] : null;
    const colour = value === null || !scale ? null : scale.of(value);
    const isFound = matches === null || matches.has(pane);
    let tint = null;
    if (column) tint = isFound ? [...(colour ?? UNKNOWN), colour ? 0.82 : 0.55] : [...UNKNOWN, 0.25];
    else if (matches !== null && isFound) tint = [...ACCENT, 0.6];
    if (tint) tints.set(tint.map((part) => Math.round(255 * part)), 4 * (pane + 1));
  }
  return tints;
}

// As the style has it.
const isNarrow = () => window.matchMedia("(max-width: 760px), (max-width: 1000px) and (orientation: portrait)").matches;

// Folded up at first where the screen is narrow, so that the model is seen.
function showLegend(box, column, hasMarks) {
  const parts = [...(column ? columnKey(column) : []), ...(hasMarks && column?.name !== ":worst_defect" ? [markKey()] : [])];
  const folder = make("details");
  const wasOpen = box.querySelector("details")?.open;
  folder.open = wasOpen ?? !isNarrow();
  folder.append(make("summary", "", column ? columnName(column) : say("defect")), ...parts);
  box.replaceChildren(folder);
  box.hidden = !parts.length;
}

function columnKey(column) {
  const scale = scaleOf(column);
  const parts = (scale.entries ?? []).map(({ text, colour }) => swatch(colour, text));
  if (scale.bar) {
    const bar = make("div", "bar");
    bar.style.background = `linear-gradient(to right, ${scale.bar.stops.map(css).join(", ")})`;
    const ends = make("div", "ends");
    for (const end of [scale.bar.low, scale.bar.high]) {
      const words = make("span", "", shown(end));
      if (column.type === "date") words.append(make("small", "", age(end)));
      ends.append(words);
    }
    parts.push(bar, ends);
  }
  const isOfDefects = [":worst_defect", ":open_defects"].includes(column.name);
  if (column.values.includes(null)) parts.push(swatch(UNKNOWN, say(isOfDefects ? "noDefect" : "noValue")));
  return parts;
}

function markKey() {
  const row = make("p", "marks-key");
  SEVERITIES.forEach((colour, i) => row.append(badge(i + 1, colour, i >= 3)));
  row.append(badge("✓", REPAIRED), make("span", "", say("marks")));
  return row;
}

function badge(text, colour, isDark = true) {
  const circle = make("i", "dot", String(text));
  circle.style.background = css(colour);
  circle.style.color = isDark ? "#fff" : "#222";
  return circle;
}

function swatch(colour, text) {
  const row = make("p", "swatch");
  const square = make("i", "square");
  square.style.background = css(colour);
  row.append(square, make("span", "", text));
  return row;
}

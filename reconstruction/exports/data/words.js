// What the page says, in English and German. Names of fields are those of records.
const WORDS = {
  en: {
    search: "Search panes and records", colour: "Colour panes by", nothing: "– nothing –",
    panes: ["{n} pane", "{n} panes"], found: ["{n} pane found", "{n} panes found"], none: "No pane has this in its records.",
    more: "Show more", back: "All panes", facade: "Facade {name}", building: "Building", noRecords: "No records yet.",
    attribute: "Properties", inspection: "Inspections", defect: "Defects", maintenance: "Maintenance", document: "Documents",
    show: "Show in the model", home: "Whole building (0)", nearer: "Nearer (+)", farther: "Further away (−)",
    fly: "Fly through (F)", help: "Help (?)", language: "Deutsch", theme: "Light or dark", sheet: "Show or hide the list",
    canvas: "The model. Arrow keys turn it, + and − zoom, 0 shows all of it. Panes can also be picked from the list.",
    foundElsewhere: "Found in records of a facade or the building.", fileMissing: "The file was missing when this page was written ({name}).",
    fileDamaged: "The picture could not be read when this page was written ({name}).", fileLarge: "The file is too large for this page; ask for it ({name})",
    noValue: "not known", noDefect: "none open", others: "others", picked: "Picked: {name}", yes: "yes", no: "no", severity: "Severity {n} of 5",
    open: "open", repaired: "repaired", size: "{w} × {h} m", loading: "Loading the model", picture: "Picture of the defect",
    place: "Place on the pane, seen from outside", earlier: "earlier", later: "later", years: ["{n} year ago", "{n} years ago"],
    months: ["{n} month ago", "{n} months ago"], days: ["{n} day ago", "{n} days ago"], today: "today",
    future: "in the future", marks: "The number is the severity; green: repaired",
    baked: "Reflections are part of the colours here and only roughly right; they do not move as on real glass.",
    mirrors: "Panes mirror here as on the real building: what they show moves with you.",
    noMirrors: "This browser cannot compute mirror images (it has no WebGPU): reflections are part of the colours here and only roughly right. Open the page in a current Chrome, Edge or Safari to see them as on real glass.",
    httpMirrors: "Mirror images are off because this page came over http: reflections are part of the colours here and only roughly right. Open the file itself, or ask for an address with https.",
    smallMirrors: "This device's graphics memory is too small for mirror images: reflections are part of the colours here and only roughly right.",
    partly: "This device has memory for the {n} most visible of {all} parts of the model.",
    partsMissing: "The folder {folder} beside this page is missing or damaged: the model is coarse. Copy it together with the page.",
    lostMirrors: "The graphics card stopped computing mirror images: reflections are part of the colours now and only roughly right. Reload the page to try again.",
    plain: "Reflections are not shown here: glass has its own colour only.",
    webgl: "This browser cannot show the model (WebGL 2 is missing or switched off). The list and the records still work.",
    large: "The model is too large for this device's graphics. The list and the records still work.",
    lost: "The picture was lost because the device ran out of graphics memory. Reload the page.",
    damaged: "Part of this file is missing or damaged. Copy it again.",
    helpLines: ["Drag: turn · two fingers or right button: move · wheel or pinch: zoom", "Click or tap a pane: its record",
      "Double-click: go there", "Keys: arrows turn, W A S D move, Q E down and up, F fly, 0 all, Esc back",
      "Flying: drag to look around, keys or arrows to move"],
    fields: { date: "Date", inspector: "Inspector", method: "Method", result: "Result", note: "Note", kind: "Kind",
      severity: "Severity", found_on: "Found on", status: "State", repaired_on: "Repaired on", work: "Work", done_by: "Done by",
      cost: "Cost", currency: "Currency", next_due: "Next due", title: "Title", place: "Place", inspection: "Inspection",
      material: "Material", maker: "Maker", product: "Product", coating: "Coating", thickness: "Thickness",
      installed_on: "Installed on", warranty_until: "Warranty until", name: "Name", value: "Value", unit: "Unit",
      picture: "Picture", u: "Across", v: "Up" },
    columns: { last_inspection: "Last inspection", worst_defect: "Worst open defect", open_defects: "Open defects",
      next_due: "Maintenance due", width: "Width", height: "Height" },
  },
  de: {
    search: "Scheiben und Einträge suchen", colour: "Scheiben einfärben nach", nothing: "– nichts –",
    panes: ["{n} Scheibe", "{n} Scheiben"], found: ["{n} Scheibe gefunden", "{n} Scheiben gefunden"],
    none: "Bei keiner Scheibe steht das in den Einträgen.",
    more: "Mehr zeigen", back: "Alle Scheiben", facade: "Fassade {name}", building: "Gebäude", noRecords: "Noch keine Einträge.",
    attribute: "Eigenschaften", inspection: "Inspektionen", defect: "Schäden", maintenance: "Wartung", document: "Unterlagen",
    show: "Im Modell zeigen", home: "Ganzes Gebäude (0)", nearer: "Näher (+)", farther: "Weiter weg (−)",
    fly: "Hindurchfliegen (F)", help: "Hilfe (?)", language: "English", theme: "Hell oder dunkel", sheet: "Liste zeigen oder verbergen",
    canvas: "Das Modell. Pfeiltasten drehen es, + und − zoomen, 0 zeigt alles. Scheiben lassen sich auch aus der Liste wählen.",
    foundElsewhere: "Gefunden in Einträgen einer Fassade oder des Gebäudes.", fileMissing: "Die Datei fehlte, als diese Seite geschrieben wurde ({name}).",
    fileDamaged: "Das Bild war nicht lesbar, als diese Seite geschrieben wurde ({name}).", fileLarge: "Die Datei ist zu groß für diese Seite; fragen Sie danach ({name})",
    noValue: "nicht bekannt", noDefect: "keine offenen", others: "andere", picked: "Gewählt: {name}", yes: "ja", no: "nein", severity: "Schwere {n} von 5",
    open: "offen", repaired: "behoben", size: "{w} × {h} m", loading: "Das Modell wird geladen", picture: "Bild des Schadens",
    place: "Ort auf der Scheibe, von außen gesehen", earlier: "früher", later: "später", years: ["vor {n} Jahr", "vor {n} Jahren"],
    months: ["vor {n} Monat", "vor {n} Monaten"], days: ["vor {n} Tag", "vor {n} Tagen"], today: "heute",
    future: "in der Zukunft", marks: "Die Zahl ist die Schwere; grün: behoben",
    baked: "Spiegelungen sind hier Teil der Farben und nur ungefähr richtig; sie wandern nicht wie auf echtem Glas.",
    mirrors: "Scheiben spiegeln hier wie am echten Gebäude: Was sie zeigen, wandert mit Ihnen.",
    noMirrors: "Dieser Browser kann keine Spiegelbilder berechnen (ihm fehlt WebGPU): Spiegelungen sind hier Teil der Farben und nur ungefähr richtig. In einem aktuellen Chrome, Edge oder Safari sind sie wie auf echtem Glas.",
    httpMirrors: "Spiegelbilder sind aus, weil diese Seite über http kam: Spiegelungen sind hier Teil der Farben und nur ungefähr richtig. Öffnen Sie die Datei selbst, oder fragen Sie nach einer Adresse mit https.",
    smallMirrors: "Der Grafikspeicher dieses Geräts ist zu klein für Spiegelbilder: Spiegelungen sind hier Teil der Farben und nur ungefähr richtig.",
    partly: "Der Speicher dieses Geräts fasst die {n} sichtbarsten von {all} Teilen des Modells.",
    partsMissing: "Der Ordner {folder} neben dieser Seite fehlt oder ist beschädigt: Das Modell ist grob. Kopieren Sie ihn zusammen mit der Seite.",
    lostMirrors: "Die Grafikkarte berechnet keine Spiegelbilder mehr: Spiegelungen sind jetzt Teil der Farben und nur ungefähr richtig. Laden Sie die Seite neu, um es noch einmal zu versuchen.",
    plain: "Spiegelungen sind hier nicht zu sehen: Glas hat nur seine eigene Farbe.",
    webgl: "Dieser Browser kann das Modell nicht zeigen (WebGL 2 fehlt oder ist abgeschaltet). Liste und Einträge gehen trotzdem.",
    large: "Das Modell ist für die Grafik dieses Geräts zu groß. Liste und Einträge gehen trotzdem.",
    lost: "Das Bild ging verloren, weil der Grafikspeicher nicht reichte. Laden Sie die Seite neu.",
    damaged: "Ein Teil dieser Datei fehlt oder ist beschädigt. Kopieren Sie sie noch einmal.",
    helpLines: ["Ziehen: drehen · zwei Finger oder rechte Taste: verschieben · Rad oder Spreizen: zoomen",
      "Klick oder Tipp auf eine Scheibe: ihr Eintrag", "Doppelklick: dorthin",
      "Tasten: Pfeile drehen, W A S D bewegen, Q E ab und auf, F fliegen, 0 alles, Esc zurück",
      "Beim Fliegen: ziehen, um sich umzusehen; Tasten oder Pfeile, um sich zu bewegen"],
    fields: { date: "Datum", inspector: "Geprüft von", method: "Verfahren", result: "Ergebnis", note: "Bemerkung", kind: "Art",
      severity: "Schwere", found_on: "Gefunden am", status: "Stand", repaired_on: "Behoben am", work: "Arbeit",
      done_by: "Ausgeführt von", cost: "Kosten", currency: "Währung", next_due: "Nächster Termin", title: "Titel", place: "Ort",
      inspection: "Inspektion", material: "Material", maker: "Hersteller", product: "Produkt", coating: "Beschichtung",
      thickness: "Dicke", installed_on: "Eingebaut am", warranty_until: "Garantie bis", name: "Name", value: "Wert",
      unit: "Einheit", picture: "Bild", u: "Quer", v: "Hoch" },
    columns: { last_inspection: "Letzte Inspektion", worst_defect: "Schwerster offener Schaden", open_defects: "Offene Schäden",
      next_due: "Wartung fällig", width: "Breite", height: "Höhe" },
  },
};

let language = (navigator.language || "en").toLowerCase().startsWith("de") ? "de" : "en";

// A text with {names} filled in; of pairs the first is for n = 1.
function say(key, values = {}) {
  const found = WORDS[language][key];
  const text = Array.isArray(found) ? found[values.n === 1 ? 0 : 1] : found;
  const shown = (value) => (typeof value === "number" ? number(value) : String(value));
  return text.replace(/\{(\w+)\}/g, (_, name) => shown(values[name]));
}

function own(table, key) {
  return Object.hasOwn(table, key) ? table[key] : null;
}

function fieldName(key) {
  return own(WORDS[language].fields, key) ?? key;
}

function columnName(column) {
  const name = column.name.startsWith(":") ? own(WORDS[language].columns, column.name.slice(1)) : null;
  return (name ?? fieldName(column.name)) + (column.unit ? ` (${column.unit})` : "");
}

// Formats are dear to make, and records are many.
const formats = new Map();
function formatOf(kind, options) {
  const key = `${language} ${kind.name}`;
  if (!formats.has(key)) formats.set(key, new kind(language, options));
  return formats.get(key);
}

function number(value) {
  return formatOf(Intl.NumberFormat, { maximumFractionDigits: 3 }).format(value);
}

const DATE = /^(\d{4})-(\d\d)-(\d\d)$/;

// A value as it is read; dates in the language's way.
function shown(value) {
  if (typeof value === "boolean") return say(value ? "yes" : "no");
  if (typeof value === "number") return number(value);
  const text = String(value);
  const day = DATE.test(text) ? new Date(`${text}T12:00:00Z`) : null;
  if (day === null || Number.isNaN(day.getTime())) return text;
  return formatOf(Intl.DateTimeFormat, { dateStyle: "medium", timeZone: "UTC" }).format(day);
}

// How long ago a day was.
function age(text, now = Date.now()) {
  const days = Math.floor((now - Date.parse(`${text}T00:00:00Z`)) / 86400000);
  if (Number.isNaN(days)) return "";
  if (days < 0) return say("future");
  if (days === 0) return say("today");
  if (days < 60) return say("days", { n: days });
  if (days < 730) return say("months", { n: Math.floor(days / 30.44) });
  return say("years", { n: Math.floor(days / 365.25) });
}

// Without accents and capitals, for searching.
function folded(text) {
  return String(text).normalize("NFKD").replace(/\p{M}/gu, "").toLowerCase().replaceAll("ß", "ss");
}

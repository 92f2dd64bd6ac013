"""Records of 5000 panes: times and size of the SQLite book, against one JSON file with the same content."""

from __future__ import annotations

import random
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import msgspec

from planning.base.json_file import write_atomically
from planning.base.progress import Clock
from reconstruction.records.book import FILE, RecordBook, make_book
from reconstruction.records.csv import read_tables, table_name, write_tables
from reconstruction.records.database import searched_texts
from reconstruction.records.entries import (
    KINDS,
    Attribute,
    Defect,
    Document,
    Entry,
    Inspection,
    Maintenance,
    global_id_of,
)
from reconstruction.records.objects import ObjectRow
from reconstruction.records.queries import (
    ObjectFilter,
    attribute_values,
    find_objects,
    latest_inspections,
    open_severities,
    search,
    worst_open_defects,
)
from tests.benchmarks.harness import Benchmark, Context, Row

N_PANES, N_QUICK = 5000, 200
N_RECORDS = 20
"""Of a pane: 6 attributes, 5 inspections, 5 defects, 3 maintenances, 1 document."""

QUERY_MS, OPEN_MS = 100.0, 50.0
"""What a click may take to feel immediate; and a part of it for opening."""

WORDS = (
    "crack", "seal", "glass", "edge", "water", "leak", "bird", "wind", "corner", "frame", "loose", "stain", "north",
    "south", "panel", "drone", "rope", "lamp", "rain", "coating",
)  # fmt: skip
RARE = "delamination"
"""In the note of one pane."""


def model(n_panes: int) -> list[ObjectRow]:
    """A scene of four facades with as many panes."""
    scene = ObjectRow(global_id_of("tower", ""), "scene", None, "tower")
    facades = [ObjectRow(global_id_of("tower", f"facade {i}"), "component", scene.global_id, i) for i in "ABCD"]
    corners = ((0.0, 0.0, 0.0), (1.5, 0.0, 0.0), (1.5, 0.0, 3.0), (0.0, 0.0, 3.0))
    panes = [
        ObjectRow(global_id_of("tower", f"pane {i}"), "element", facades[i % 4].global_id, f"A-{i:04d}", corners)
        for i in range(n_panes)
    ]
    return [scene, *facades, *panes]


def entries(rows: list[ObjectRow], seed: int = 0) -> Iterator[Entry]:
    """Twenty entries of each pane."""
    rng = random.Random(seed)
    panes = [row.global_id for row in rows if row.layer == "element"]

    def text(n_words: int) -> str:
        return " ".join(rng.choice(WORDS) for _ in range(n_words))

    for number, pane in enumerate(panes):
        rare = f" {RARE}" if number == len(panes) // 2 else ""
        for name in ("material", "maker", "coating"):
            yield Attribute(pane, name, text(2))
        yield Attribute(pane, "thickness", float(rng.choice((24, 28, 32))), "number", "mm")
        yield Attribute(pane, "installed_on", f"20{rng.randint(10, 20)}-01-01", "date")
        yield Attribute(pane, "u-value", rng.uniform(0.8, 2.0), "number", "W/m²K")
        for year in range(5):
            yield Inspection(pane, f"202{year}-03-01", "Ann Chan", text(1), text(1), text(12) + rare)
            place = rng.random(), rng.random()
            yield Defect(pane, text(1), rng.randint(1, 5), f"202{year}-03-01", *place, note=text(10))
        for year in range(3):
            yield Maintenance(pane, f"202{year}-04-01", text(4), "Bob", 100.0, "EUR")
        yield Document(pane, text(3), "https://example.org/sheet.pdf")


def measure(context: Context) -> Iterator[Row]:
    """Fill, open, ask, search, write, export, import; then the same with one JSON file."""
    n_panes = N_QUICK if context.is_quick else N_PANES
    rows = model(n_panes)
    scene = f"{n_panes} panes, {N_RECORDS * n_panes} records"
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        path, plain = folder / FILE, folder / "records.json"
        made = list(entries(rows))
        filling_s = _spent(lambda: _fill(path, rows, made))
        yield Row(scene, "all records put in, one change", filling_s, "s")
        with RecordBook(path) as book:
            found = [entry for kind in KINDS for entry in book.entries(kind.record)]
        plain.write_bytes(msgspec.json.encode([_tagged(entry) for entry in found]))
        mib = path.stat().st_size / 2**20
        other_mib = plain.stat().st_size / 2**20
        yield Row(
            scene, "size of the book, with search index and history", mib, "MiB", mib / other_mib, "one JSON file"
        )
        yield from _questions(scene, path, plain)
        yield from _writing(scene, path, plain, rows[-1].global_id)
        yield from _tables(scene, folder, path, rows)


def _fill(path: Path, rows: list[ObjectRow], made: list[Entry]) -> None:
    make_book(path)
    with RecordBook(path, True, "benchmark") as book:
        book.set_objects(rows)
        with book.changing("content") as changes:
            for entry in made:
                changes.put(entry)


def _tagged(entry: Entry) -> dict[str, Any]:
    return {"record": type(entry).__name__, **msgspec.to_builtins(entry)}


def _questions(scene: str, path: Path, plain: Path) -> Iterator[Row]:
    """The window's questions, of an open book and of the JSON file read whole."""
    opened = _best(lambda: RecordBook(path).close())
    read = _best(lambda: msgspec.json.decode(plain.read_bytes()), 3)
    yield _row(scene, "opened and checked", opened, read, "reading one JSON file", OPEN_MS)
    content: list[dict[str, Any]] = msgspec.json.decode(plain.read_bytes())
    with RecordBook(path) as book:
        pane = book.objects()[-1].global_id
        pairs: list[tuple[str, Callable[[], object], Callable[[], object]]] = [
            ("one attribute of all panes", lambda: attribute_values(book, "thickness"),
             lambda: {e["global_id"]: e["value"] for e in content if e.get("name") == "thickness"}),
            ("worst severity of all panes", lambda: open_severities(book), lambda: _worst(content)),
            ("latest inspection of all panes", lambda: latest_inspections(book), lambda: _latest(content)),
            ("worst open defect of all panes", lambda: worst_open_defects(book), lambda: _worst(content)),
            ("panes with an open defect of 5", lambda: find_objects(book, ObjectFilter(min_open_severity=5)),
             lambda: {e["global_id"] for e in content if e.get("severity") == 5 and e["status"] == "open"}),
            ("all records of one pane", lambda: [book.entries(kind.record, pane) for kind in KINDS],
             lambda: [e for e in content if e["global_id"] == pane]),
            ("a word that one note has", lambda: search(book, RARE), lambda: _scan(content, [RARE])),
            ("two words that many notes have", lambda: search(book, "bird leak"),
             lambda: _scan(content, ["bird", "leak"])),
        ]  # fmt: skip
        for what, ask, loop in pairs:
            yield _row(scene, what, _best(ask), _best(loop, 3), "a loop over the file in memory", QUERY_MS)


def _latest(content: list[dict[str, Any]]) -> dict[str, str]:
    found: dict[str, str] = {}
    for each in content:
        if each["record"] == "Inspection" and each["date"] > found.get(each["global_id"], ""):
            found[each["global_id"]] = each["date"]
    return found


def _worst(content: list[dict[str, Any]]) -> dict[str, int]:
    found: dict[str, int] = {}
    for each in content:
        if each["record"] == "Defect" and each["status"] == "open":
            found[each["global_id"]] = max(each["severity"], found.get(each["global_id"], 0))
    return found


def _scan(content: list[dict[str, Any]], words: list[str]) -> list[dict[str, Any]]:
    found = []
    for each in content:
        texts = [value.lower() for value in each.values() if isinstance(value, str)]
        if any(all(word in text for word in words) for text in texts):
            found.append(each)
    return found


def _writing(scene: str, path: Path, plain: Path, pane: str) -> Iterator[Row]:
    """One record more, safe on the disk."""
    content: list[dict[str, Any]] = msgspec.json.decode(plain.read_bytes())
    with RecordBook(path, True, "benchmark") as book:
        added = _best(lambda: book.put(Inspection(pane, "2026-01-01", note="one more")), clock=time.perf_counter)
        undone = _best(book.undo, clock=time.perf_counter)
    extra = _tagged(Inspection(pane, "2026-01-01", note="one more"))
    rewritten = _best(lambda: write_atomically(plain, msgspec.json.encode([*content, extra])), 3, time.perf_counter)
    yield _row(scene, "one record written, wall time", added, rewritten, "writing one JSON file", QUERY_MS)
    yield Row(scene, "one record taken back, wall time", 1000.0 * undone, "ms")
    with RecordBook(path) as book:
        checked = _best(book.check, 2)
    yield Row(scene, "every page and reference checked", 1000.0 * checked, "ms")


def _tables(scene: str, folder: Path, path: Path, rows: list[ObjectRow]) -> Iterator[Row]:
    """CSV tables out, and into an empty book."""
    with RecordBook(path) as book:
        exporting_s = _spent(lambda: write_tables(book, folder / "tables"))
        before = {entry for kind in KINDS for entry in book.entries(kind.record)}
    tables = [(folder / "tables" / table_name(kind), kind) for kind in KINDS]
    mib = sum(table.stat().st_size for table, _ in tables) / 2**20
    yield Row(scene, f"CSV tables of {mib:.0f} MiB written", exporting_s, "s")
    make_book(folder / "again.sqlite")
    with RecordBook(folder / "again.sqlite", True, "benchmark") as again:
        again.set_objects(rows)
        importing_s = _spent(lambda: read_tables(again, tables))
        yield Row(scene, "CSV tables read into an empty book", importing_s, "s")
        after = {entry for kind in KINDS for entry in again.entries(kind.record)}
    different = len(before ^ after)
    n_texts = sum(len(searched_texts(entry, kind)) for kind in KINDS for entry in after if type(entry) is kind.record)
    yield Row(
        scene, "records that differ after CSV and back", float(different), against=f"{n_texts} texts indexed",
        target="0", met=different == 0,
    )  # fmt: skip


def _best(work: Callable[[], object], n_runs: int = 5, clock: Clock = time.process_time) -> float:
    """Shortest of some runs, s."""
    return min(_spent(work, clock) for _ in range(n_runs))


def _spent(work: Callable[[], object], clock: Clock = time.process_time) -> float:
    """Processor time, s: what others do on the machine adds next to nothing to it."""
    started = clock()
    work()
    return clock() - started


def _row(scene: str, what: str, seconds: float, other_s: float, other: str, limit_ms: float) -> Row:
    return Row(
        scene, what, 1000.0 * seconds, "ms", seconds / other_s, other, f"under {limit_ms:g} ms",
        1000.0 * seconds < limit_ms,
    )  # fmt: skip


BENCHMARK = Benchmark(
    "records",
    "Records of panes",
    "A book of records with twenty entries for each pane, made up from a seed, and the questions that the window asks "
    "of it. Beside it stands one JSON file with the same records: read whole by the fastest reader there is here, "
    "asked by loops over what is in memory then, and written whole for each change. The book needs no reading first, "
    "writes what changed, and keeps history and search index, which the JSON file lacks. Times are processor times but "
    "where something waits for the disk, the best of several runs.",
    measure,
)

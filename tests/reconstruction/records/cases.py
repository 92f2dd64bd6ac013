"""Books, entries and texts for the tests of records."""

from datetime import UTC, datetime

from hypothesis import strategies as st

from planning.geo.frames import Origin
from reconstruction.records.book import FILE, RecordBook, make_book
from reconstruction.records.entries import (
    COMPUTED,
    KINDS,
    NAME_FORBIDDEN,
    RESERVED,
    STANDARD,
    Attribute,
    Defect,
    Document,
    Inspection,
    Maintenance,
    global_id_of,
    new_global_id,
)
from reconstruction.records.objects import ObjectRow

ORIGIN = Origin(22.3372, 114.2636, 62.0)
CORNERS = ((0.0, 0.0, 0.0), (1.5, 0.0, 0.0), (1.5, 0.0, 3.0), (0.0, 0.0, 3.0))

NASTY = (
    "'; DROP TABLE defects; --",
    '"',
    "NEAR(a b)",
    'a AND OR NOT "',
    "* ^ : ( ) { } + - ,",
    "<script>alert('x')</script>",
    '=HYPERLINK("http://x")',
    "'=1+1",
    "@SUM(A1)",
    "-2+3",
    "+1",
    "\tx",
    "a;b,c\r\nd\re",
    " blank ",
    "玻璃 裂缝",
    "a%_b\\",
    "𝔘nicode",
)
"""Texts that some part of the way could take for more than texts."""


def model(n_panels=3, name="tower"):
    """Rows of a scene with two facades; the panels alternate between them."""
    scene = ObjectRow(global_id_of(name, ""), "scene", None, name)
    facades = [ObjectRow(global_id_of(name, f"facade {i}"), "component", scene.global_id, i) for i in "AB"]
    panels = [
        ObjectRow(global_id_of(name, f"p{i}"), "element", facades[i % 2].global_id, f"{'AB'[i % 2]}-{i:04d}", CORNERS)
        for i in range(n_panels)
    ]
    return [scene, *facades, *panels]


def now():
    return datetime(2026, 3, 31, 12, tzinfo=UTC)


def new_book(folder, rows=None, **options):
    """A book in a folder, open for writing, with objects."""
    make_book(folder / FILE)
    book = RecordBook(folder / FILE, True, "Chan", now, **options)
    book.set_objects(model() if rows is None else rows, ORIGIN)
    return book


def contents(book):
    """All entries, as a set."""
    return {entry for kind in KINDS for entry in book.entries(kind.record)}


def state(book):
    """All rows of all tables that changes can touch but for the history."""
    tables = ("objects", *(kind.table for kind in KINDS))
    return {table: sorted(book.database.rows(f"SELECT * FROM {table}"), key=repr) for table in tables}


PANES = tuple(row.global_id for row in model() if row.layer == "element")

characters = st.characters(
    exclude_categories=("Cs", "Cc"), exclude_characters="\ufffe\uffff", include_characters="\t\n\r'=+-@,;\""
)
texts = st.one_of(st.sampled_from(NASTY), st.text(characters, max_size=40))
words = texts.filter(lambda text: text.strip() != "")
dates = st.dates(min_value=datetime(1900, 1, 1).date()).map(lambda day: day.isoformat())
shares = st.floats(0.0, 1.0)
numbers = st.floats(-1e15, 1e15)
panes = st.sampled_from(PANES)
keys = st.builds(new_global_id)
names = (
    st.text(
        st.characters(exclude_categories=("Cs", "Cc"), exclude_characters=NAME_FORBIDDEN + "\ufffe\uffff"), max_size=20
    )
    .map(str.strip)
    .filter(lambda name: name and name not in (*COMPUTED, *RESERVED, *STANDARD))
)

attributes = st.one_of(
    st.builds(Attribute, panes, names, words, st.just("text"), names),
    st.builds(Attribute, panes, names, numbers, st.just("number"), names),
    st.builds(Attribute, panes, names, st.booleans(), st.just("yes/no")),
    st.builds(Attribute, panes, names, dates, st.just("date")),
    st.builds(Attribute, panes, st.sampled_from(("material", "maker")), words),
    st.builds(Attribute, panes, st.just("thickness"), st.floats(0.0, 100.0), st.just("number"), st.just("mm")),
)
inspections = st.builds(Inspection, panes, dates, texts, texts, texts, texts, keys)
outlines = st.lists(st.tuples(shares, shares), min_size=3, max_size=6).map(tuple)
defects = st.builds(
    lambda place, repaired, **fields: Defect(
        u=None if place is None else place[0],
        v=None if place is None else place[1],
        status="open" if repaired is None else "repaired",
        repaired_on=repaired,
        **fields,
    ),
    global_id=panes,
    kind=words,
    severity=st.integers(1, 5),
    found_on=dates,
    place=st.none() | st.tuples(shares, shares),
    outline=st.just(()) | outlines,
    picture=st.sampled_from(("", "a.png")),
    repaired=st.none() | dates,
    note=texts,
    key=keys,
)
maintenance = st.builds(
    lambda cost, **fields: Maintenance(cost=cost, currency="" if cost is None else "EUR", **fields),
    global_id=panes,
    date=dates,
    work=words,
    done_by=texts,
    cost=st.none() | st.floats(0.0, 1e9),
    next_due=st.none() | dates,
    note=texts,
    key=keys,
)
documents = st.builds(
    Document,
    panes,
    words,
    st.sampled_from(("https://example.org/a?b=c", "sheet.pdf")),
    texts,
    st.sampled_from(("", "0" * 64)),
    keys,
)
entries = st.one_of(attributes, inspections, defects, maintenance, documents)

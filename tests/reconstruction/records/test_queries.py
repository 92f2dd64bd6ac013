"""Queries: against plain loops over all entries; and searches, which take any words whatever."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.base.errors import InputError
from reconstruction.records.changes import query_of
from reconstruction.records.entries import Attribute, Defect, Inspection
from reconstruction.records.queries import (
    AttributeValue,
    ObjectFilter,
    attribute_names,
    attribute_type,
    attribute_values,
    attributes_by_object,
    find_objects,
    inspection_dates,
    latest_inspections,
    open_severities,
    search,
    worst_open_defects,
)
from tests.reconstruction.records.cases import NASTY, PANES, contents, defects, inspections, model, new_book, texts


@pytest.fixture
def book(tmp_path):
    with new_book(tmp_path) as opened:
        yield opened


@pytest.mark.slow
@given(st.lists(st.one_of(inspections, defects), max_size=12))
def test_latest_and_worst_are_those_of_a_loop(tmp_path_factory, found):
    with new_book(tmp_path_factory.mktemp("book")) as book:
        for entry in found:
            book.put(entry)
        kept = contents(book)
        latest, worst = latest_inspections(book), worst_open_defects(book)
        for pane in PANES:
            dates = [e.date for e in kept if isinstance(e, Inspection) and e.global_id == pane]
            assert (latest[pane].date if pane in latest else None) == max(dates, default=None)
            own = [e for e in kept if isinstance(e, Defect) and e.global_id == pane and e.status == "open"]
            expected = min(((-e.severity, e.found_on) for e in own), default=None)
            assert ((-worst[pane].severity, worst[pane].found_on) if pane in worst else None) == expected
        assert inspection_dates(book) == {pane: entry.date for pane, entry in latest.items()}
        assert open_severities(book) == {pane: entry.severity for pane, entry in worst.items()}
        since = "2000-01-01"
        expected = {p for p in PANES if not (p in latest and latest[p].date >= since)}
        rows = find_objects(book, ObjectFilter(layer="element", not_inspected_since=since))
        assert {row.global_id for row in rows} == expected
        rows = find_objects(book, ObjectFilter(min_open_severity=3))
        assert {row.global_id for row in rows} == {p for p, e in worst.items() if e.severity >= 3}


def test_attributes_of_all_objects_and_filters(book):
    book.put(Attribute(PANES[0], "maker", "Glas AG"))
    book.put(Attribute(PANES[1], "u-value", 1, "number", "W/m²K"))
    book.put(Attribute(PANES[2], "tempered", True, "yes/no"))
    assert attribute_names(book) == ("width", "height", "maker", "tempered", "u-value")
    assert attribute_values(book, "maker") == {PANES[0]: AttributeValue("Glas AG", "")}
    assert attribute_values(book, "u-value") == {PANES[1]: AttributeValue(1.0, "W/m²K")}
    assert attribute_values(book, "tempered")[PANES[2]].value is True
    assert attribute_values(book, "width") == dict.fromkeys(PANES, AttributeValue(1.5, "m"))
    assert attribute_values(book, "'; --") == {}
    book.put(Defect(PANES[1], "crack", 2, "2026-01-01"))
    book.put(Inspection(PANES[1], "2026-01-01"))
    assert attributes_by_object(book)[PANES[1]] == {
        "width": 1.5, "height": 3.0, "u-value": 1.0, "last_inspection": "2026-01-01", "worst_open_severity": 2,
    }  # fmt: skip
    assert (attribute_type(book, "u-value"), attribute_type(book, "x")) == ("number", None)

    def found(**wanted):
        return [row.name for row in find_objects(book, ObjectFilter(**wanted))]

    assert found(layer="component") == ["A", "B"]
    assert found(parent=model()[1].global_id) == ["A-0000", "A-0002"]
    assert found(name_part="a-00") == found(name_part="Á-00") == ["A-0000", "A-0002"]
    assert found(name_part="%") == []
    assert found(attribute="tempered") == ["A-0002"]
    assert (found(attribute="maker", value="Glas AG"), found(attribute="maker", value="x")) == (["A-0000"], [])
    assert found(attribute="height", value=3.0) == ["A-0000", "B-0001", "A-0002"]
    book.set_objects(model(2))
    assert (found(attribute="tempered"), found(attribute="tempered", with_absent=True)) == ([], ["A-0002"])
    with pytest.raises(InputError, match="not_inspected_since: expected a date"):
        found(not_inspected_since="'x")


def test_search_names_object_kind_and_field_and_ranks(book):
    book.put(Defect(PANES[0], "crack", 3, "2026-01-01", note="long note about many things, one of them a crack"))
    book.put(Defect(PANES[1], "Crack", 3, "2026-01-01"))
    inspection = book.put(Inspection(PANES[2], "2026-01-01", "Zoë Müller", note="裂缝在玻璃上"))
    hits = search(book, "crack")
    assert [(hit.name, hit.kind, hit.field) for hit in hits[:2]] == [
        ("A-0000", "defect", "kind"), ("B-0001", "defect", "kind"),
    ]  # fmt: skip
    assert (hits[2].field, hits[0].rank <= hits[2].rank) == ("note", True)
    assert [(hit.field, hit.key) for hit in search(book, "zoe muller")] == [("inspector", inspection.key)]
    assert [hit.text for hit in search(book, "玻璃")] == ["裂缝在玻璃上"]
    assert [hit.kind for hit in search(book, "a-0000")] == ["object"]
    assert [hit.field for hit in search(book, "thi man")] == ["note"]
    assert len(search(book, "crack", 1)) == 1
    assert search(book, "crack nothing") == ()


@pytest.mark.parametrize(
    "words", ["Weiß", "weiss", "WEISS", "weiß müller", "Muller WEISS", "Mu\u0308ller", "strasse vo"]
)
def test_search_finds_umlauts_and_sharp_s_however_they_are_written(book, words):
    book.put(Inspection(PANES[0], "2026-01-01", "F. Weiß-Müller", note="von der Straße"))
    book.put(Inspection(PANES[1], "2026-01-01", "F. Weiss-Mu\u0308ller", note="VON DER STRASSE"))
    book.put(Inspection(PANES[2], "2026-01-01", "F. Weise"))
    assert {hit.name for hit in search(book, words)} == {"A-0000", "B-0001"}


def test_what_is_found_by_a_word_is_found_while_it_is_typed(book):
    book.put(Inspection(PANES[0], "2026-01-01", "F. Weiß"))
    for word in ("weiss", "WEISS", "weiß"):
        for n in range(1, len(word) + 1):
            assert len(search(book, word[:n])) == 1, word[:n]


def test_a_double_s_is_sought_as_sharp_s_too_however_many_there_are(book):
    book.put(Inspection(PANES[0], "2026-01-01", note="Flußschloßgäßchen"))
    assert len(search(book, "flussschlossgässchen")) == 1
    assert query_of("s" * 500).count("OR") == 7


@given(st.one_of(texts, st.text(max_size=200)))
def test_any_words_are_a_search_and_none_is_taken_for_the_query_language(words):
    query = query_of(words)
    if query is None:
        assert not any(character.isalnum() for character in words.replace("_", " "))
    else:
        assert query.count('"') % 2 == 0
        outside = query.split('"')[::2]
        assert set(" ".join(outside).replace("(", " ").replace(")", " ").split()) <= {"*", "AND", "OR"}


@pytest.mark.parametrize(
    "words", [*NASTY, "\x00", "a\x00b", "", "x" * 1_000_000, '"' * 100_000, "a " * 100_000, "{a b}: c"]
)
def test_hostile_words_find_what_they_say_and_nothing_else(book, words):
    kept = "".join(c for c in words[:9000] if c.isprintable() or c in "\t\r\n").strip() or "x"
    book.put(Inspection(PANES[0], "2026-01-01", note=f"{kept} end"))
    hits = search(book, words)
    assert {hit.field for hit in hits} <= {"note", "name"}
    if words in NASTY and query_of(words) is not None:
        assert [hit.text for hit in hits] == [f"{kept} end"]

"""Panels in colours that say what their records say."""

from datetime import date

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.services.model.facility_records import book_of_scene
from groundstation.services.model.panel_colours import (
    NO_COLOURS,
    OTHER,
    SCALE,
    SEVERITIES,
    WORDS,
    Computed,
    by_severity,
    by_value,
    colouring,
    scale_colour,
)
from reconstruction.objects.store import write_scene
from reconstruction.records.entries import Attribute, Defect, Inspection
from tests.reconstruction.objects.synthetic_scene import synthetic_scene

IDS = ("a", "b", "c", "d")


def test_numbers_have_the_scale_from_least_to_most():
    found = by_value({"a": 1.0, "b": 3.0, "c": 2.0}, IDS, "mm")
    assert (found.colours["a"], found.colours["b"], found.colours["c"]) == (SCALE[0], SCALE[-1], SCALE[2])
    assert [line.value for line in found.legend] == [1.0, 1.5, 2.0, 2.5, 3.0]
    assert (found.unit, found.n_without) == ("mm", 1)


def test_dates_are_told_as_dates():
    found = by_value({"a": date(2024, 1, 1), "b": date(2026, 1, 1)}, IDS)
    assert found.legend[0].value == date(2024, 1, 1)
    assert found.legend[-1].value == date(2026, 1, 1)
    assert found.colours["a"] == SCALE[0]


def test_one_value_for_all_is_one_colour_and_one_line():
    found = by_value(dict.fromkeys(IDS, 8.0), IDS)
    assert len(set(found.colours.values())) == len(found.legend) == 1


def test_words_have_colours_of_their_own_the_most_frequent_first():
    found = by_value({"a": "float", "b": "toughened", "c": "toughened", "d": True}, IDS)
    assert found.colours["b"] == WORDS[0]
    assert len({found.colours["a"], found.colours["b"], found.colours["d"]}) == 3
    assert next(line.value for line in found.legend) == "toughened"
    many = by_value({str(k): f"word {k}" for k in range(12)}, tuple(map(str, range(12))))
    assert OTHER in many.colours.values()
    assert len(many.legend) == len(WORDS)


def test_of_mixed_values_those_of_the_most_frequent_kind_count():
    found = by_value({"a": 1.0, "b": 2.0, "c": "about 3"}, IDS)
    assert set(found.colours) == {"a", "b"}
    assert found.n_without == 2


@given(st.dictionaries(st.sampled_from(IDS), st.one_of(st.floats(-1e300, 1e300), st.dates(), st.text(), st.booleans())))
def test_any_values_give_colours_of_panels(values):
    found = by_value(values, IDS)
    assert set(found.colours) <= set(values)
    assert len(found.colours) + found.n_without == len(IDS)
    assert all(0 <= part <= 255 for colour in found.colours.values() for part in colour)


@pytest.mark.parametrize(("share", "colour"), [(-1.0, SCALE[0]), (0.25, SCALE[1]), (2.0, SCALE[-1])])
def test_the_scale_ends_where_it_ends(share, colour):
    assert scale_colour(share) == colour


def test_severities_have_their_own_colours():
    found = by_severity({"a": 1, "c": 5}, IDS)
    assert found.colours == {"a": SEVERITIES[0], "c": SEVERITIES[4]}
    assert [line.value for line in found.legend] == [1.0, 5.0]


def test_records_colour_the_panels_of_a_scene(tmp_path):
    scene = synthetic_scene()
    write_scene(scene, tmp_path)
    panels = {element.global_id: component.name for component, element in scene.elements}
    first, second, *_ = panels
    assert colouring(None, Computed.INSPECTED, panels) is NO_COLOURS
    with book_of_scene(tmp_path, "test") as book:
        book.put(Defect(first, "crack", 2, "2026-01-01"))
        book.put(Defect(first, "leak", 4, "2026-01-02"))
        book.put(Inspection(second, "2025-01-01"))
        book.put(Inspection(second, "2026-01-01"))
        book.put(Attribute(second, "installed_on", "1999-12-31", "date"))
        assert colouring(book, Computed.DEFECTS, panels).colours == {first: SEVERITIES[3]}
        assert colouring(book, Computed.INSPECTED, panels).legend[0].value == date(2026, 1, 1)
        assert colouring(book, "installed_on", panels).legend[0].value == date(1999, 12, 31)
        assert set(colouring(book, "width", panels).colours) == set(panels)
        assert colouring(book, "width", panels).unit == "m"
        assert colouring(book, "nothing of that name", panels).colours == {}
    facades = colouring(None, Computed.FACADE, panels)
    assert len(set(facades.colours.values())) == 2

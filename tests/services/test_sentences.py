"""Sentences are found again by their templates, and said in other words and units."""

from __future__ import annotations

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.services.sentences import MAX_JOINTS, Phrasebook, Template
from groundstation.services.units import FOOT_M, INCH_M, MILE_M, UnitSystem

METRIC, IMPERIAL = UnitSystem.METRIC, UnitSystem.IMPERIAL

GERMAN = {
    "home lies at {0} m, below the ground at {1} m": "der Startplatz liegt bei {0} m, unter dem Boden bei {1} m",
    "{0}, at least {1}": "{0}, mindestens {1}",
    "smallest distance": "kleinster Abstand",
    "plan the route again": "die Route neu planen",
    "sortie {0:n}": "Einsatz {0:n}",
    "plan '{0}' was made for {1}": "Plan '{0}' wurde für {1} gemacht",
    "the site": "den Standort",
    "from {0:m} to {1:m} m": "von {0:m} bis {1:m} m",
    " ({0} times)": " ({0}-mal)",
    "{0} to {1} m in front": "{0} bis {1} m davor",
    " and ": " und ",
    "cannot be read ({0})": "nicht lesbar ({0})",
}

BOOK = Phrasebook(GERMAN)

UNIT_M = {"m": 1.0, "km": 1e3, "mm": 1e-3, "ft": FOOT_M, "mi": MILE_M, "in": INCH_M}

words = st.text(st.characters(exclude_categories=("Cs",)), max_size=12)


def same(template: str) -> str:
    return template


def german(template: str) -> str:
    return GERMAN.get(template, template)


@given(st.sampled_from(sorted(GERMAN)), st.lists(words, min_size=2, max_size=2), st.floats(-1e6, 1e6))
def test_a_text_made_from_a_template_is_found_and_stays_the_same_in_english(
    source: str, values: list[str], number: float
) -> None:
    kinds = Template.of(source).kinds
    filled = [f"{number:g}" if kind else value for kind, value in zip(kinds, values, strict=False)]
    text = re.sub(r"\{(\d)(?::\w)?\}", lambda field: filled[int(field[1])], source)
    found = BOOK.find(text)
    assert found is not None
    remade = re.sub(r"\{(\d)(?::\w)?\}", lambda field: found[1][int(field[1])], found[0].source)
    assert remade == text
    assert BOOK.retold(text, same, METRIC) == text


@given(words)
def test_what_no_template_makes_stays(text: str) -> None:
    if all(head not in text for head in ("at least", "sortie", "times")):
        assert BOOK.retold(text, german, IMPERIAL) == text


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("smallest distance", "kleinster Abstand"),
        ("smallest distance: 3 m, at least 10 m", "kleinster Abstand: 3 m, mindestens 10 m"),
        ("sortie 2: smallest distance; plan the route again", "Einsatz 2: kleinster Abstand; die Route neu planen"),
        ("sortie 2 and sortie 3", "Einsatz 2 und Einsatz 3"),
        ("sortie two", "sortie two"),
        ("plan 'the site' was made for the site", "Plan 'the site' wurde für den Standort gemacht"),
        ("plan the route again (3 times)", "die Route neu planen (3-mal)"),
        ("/the site/a and b.json: cannot be read (x)", "/the site/a and b.json: nicht lesbar (x)"),
        ("/data/5 m.json: plan the route again", "/data/5 m.json: die Route neu planen"),
    ],
)
def test_sentences_are_told_with_their_parts(text: str, told: str) -> None:
    assert BOOK.retold(text, german, METRIC) == told


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("home lies at -3.048 m, below the ground at 0 m", "home lies at -10.0 ft, below the ground at 0.0 ft"),
        ("smallest distance: 3.048 m, at least 1e+01 m", "smallest distance: 10.0 ft, at least 32.8 ft"),
        ("from (0, 3.048, -6.096) to (1, 2, 3) m", "from (0.0, 10.0, -20.0) to (3.3, 6.6, 9.8) ft"),
        ("3.048 to 30.48 m in front", "10.0 to 100.0 ft in front"),
        ("smallest distance: inf m, at least 10 m", "smallest distance: inf ft, at least 32.8 ft"),
        ("plan '5 m' was made for 5 m.json", "plan '5 m' was made for 5 m.json"),
    ],
)
def test_lengths_in_known_sentences_are_told_in_feet(text: str, told: str) -> None:
    assert BOOK.retold(text, same, IMPERIAL) == told
    assert BOOK.retold(told, same, IMPERIAL) == told


@given(st.floats(-1e5, 1e5), st.sampled_from(["m", "km", "mm"]))
def test_a_length_is_the_same_length_in_feet(value: float, unit: str) -> None:
    told = BOOK.retold(f"smallest distance, at least {value:.4f} {unit}", same, IMPERIAL)
    found = re.fullmatch(r"smallest distance, at least (\S+) (ft|mi|in)", told)
    assert found is not None
    shown, symbol = float(found[1]), found[2]
    digits = len(found[1].partition(".")[2])
    rounding_m = (0.5 * 10.0**-digits) * UNIT_M[symbol] + 0.5e-4 * UNIT_M[unit]
    assert shown * UNIT_M[symbol] == pytest.approx(value * UNIT_M[unit], abs=1.001 * rounding_m)


def test_the_template_with_most_words_of_its_own_is_meant() -> None:
    book = Phrasebook(["{0} is {1}", "{0} is missing", "the name is {0}", "the name is missing"])
    for text in ("the name is missing", "the name is a", "b is missing", "b is a"):
        found = book.find(text)
        assert found is not None
        assert sum(map(len, found[0].literals)) == max(
            len(re.sub(r"\{\d\}", "", source))
            for source in ("{0} is {1}", "{0} is missing", "the name is {0}", "the name is missing")
            if Template.of(source).values(text) is not None
        )


def test_a_text_of_very_many_parts_is_not_taken_apart() -> None:
    few, many = ("; ".join(["plan the route again"] * n) for n in (MAX_JOINTS // 2, MAX_JOINTS + 2))
    assert BOOK.retold(few, german, METRIC) == few.replace("plan the route again", "die Route neu planen")
    assert BOOK.retold(many, german, METRIC) == many


@pytest.mark.parametrize("source", ["{1} first", "{0} and {0}", "{0} and {2}"])
def test_a_template_with_miscounted_fields_is_refused(source: str) -> None:
    with pytest.raises(ValueError, match="fields counted from 0"):
        Template.of(source)

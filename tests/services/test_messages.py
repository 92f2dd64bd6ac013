"""Messages hold their parts whatever they are made of, and are told in any language and unit without failing."""

import json
import pickle

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.services.messages import LANGUAGES, localized, translation
from groundstation.services.settings import Language
from groundstation.services.units import UnitSystem
from planning.base.messages import Message, about, first_few, glue, joined, packed, say, unpacked, without_place

TEXTS = st.one_of(
    st.text(max_size=12),
    st.sampled_from(["5 {x}", "3 {}", "{0}", "2 %s", "-1.5 m", "1e9 km", "nan m", "'", ": ", "7 views"]),
)
VALUES = st.recursive(
    st.one_of(TEXTS, st.floats(), st.integers()),
    lambda inner: st.builds(lambda a, b: say("{}, leg {}", a, b), inner, inner) | st.builds(glue, inner, inner),
    max_leaves=4,
)


@given(VALUES, VALUES, st.sampled_from(LANGUAGES), st.sampled_from(UnitSystem))
def test_whatever_stands_in_a_message_it_can_be_told(first, second, language, units):
    for message in (
        say("cannot be read ({})", first, place=second),
        joined("; ", (first, second)),
        about(first, second),
    ):
        assert isinstance(localized(message, translation(language), units), str)


@given(VALUES, VALUES)
def test_in_english_and_metres_a_message_is_its_own_text_and_goes_to_other_processes_whole(first, second):
    message = say("the {} is not on the vehicle: {}", first, second, place="a.json")
    assert localized(message, translation("en"), UnitSystem.METRIC) == message
    other = pickle.loads(pickle.dumps(message))
    assert (other, other.template, other.values, other.place) == (
        *(message, message.template),
        *(message.values, message.place),
    )
    assert type(str(GeneratorExit(message))) is Message


@given(TEXTS, st.text(min_size=1, max_size=8).filter(lambda text: ": " not in text and not text.endswith(":")))
def test_a_place_can_be_taken_off_again(value, place):
    message = say("cannot be read ({})", value)
    there = without_place(about(place, message), place)
    assert (there, there.template, there.values) == (message, message.template, message.values)
    assert about("", message) == message


def test_numbers_with_their_units_and_known_words_are_told_names_are_not():
    german, metric, imperial = translation("de"), UnitSystem.METRIC, UnitSystem.IMPERIAL
    limit = say("{}, at least {}", "-74.2 deg", "3 views")
    assert localized(limit, german, metric) == "-74.2°, mindestens 3 Aufnahmen"
    named = say("obstacle '{}' is a mesh, not a box", "panel")
    assert localized(named, german, metric).startswith("Hindernis 'panel'")
    low = say("home lies at {} m, below the ground at {} m; put it on the ground", 3.048, 0)
    assert localized(low, german, imperial) == (
        "der Startplatz liegt bei 10.0 ft, unter dem Boden bei 0.0 ft; ihn auf den Boden setzen"
    )


def test_a_template_takes_as_many_values_as_it_has_fields():
    with pytest.raises(ValueError, match="expected 1 values"):
        say("cannot be read ({})")


def test_the_command_line_speaks_the_languages_of_the_window():
    assert set(LANGUAGES) == set(Language) - {Language.SYSTEM}


def test_a_message_comes_back_from_json_with_its_parts():
    inner = say("found {:.1f} m", 3.0, place="a.ifc")
    for text in ("plain", inner, about("b.json", inner), glue("x: ", inner), say("not read ({})", inner)):
        back = unpacked(json.loads(json.dumps(packed(text))))
        assert (back, type(back)) == (text, type(text))
        if isinstance(text, Message):
            assert (back.template, back.values, back.place) == (text.template, text.values, text.place)


def test_the_first_few_names_stand_for_all():
    assert first_few([], 2) == ""
    assert first_few(["a", "b"], 2) == "a, b"
    assert first_few(["a", "b", "c"], 2) == "a, b, ..."

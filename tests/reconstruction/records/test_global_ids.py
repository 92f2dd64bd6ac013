"""GlobalIds: as IfcOpenShell writes them, and the same for the same names."""

import uuid

import ifcopenshell.guid
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.base.errors import InputError
from reconstruction.records.entries import check_global_id, compressed, global_id_of, is_global_id, new_global_id


@given(st.uuids())
def test_compression_is_that_of_ifcopenshell(number):
    assert compressed(number) == ifcopenshell.guid.compress(number.hex)
    assert uuid.UUID(ifcopenshell.guid.expand(compressed(number))) == number
    assert is_global_id(compressed(number))


@given(st.text(max_size=30), st.text(max_size=30))
def test_made_ids_are_valid_and_follow_from_the_names(site, name):
    made = global_id_of(site, name)
    assert is_global_id(made)
    assert made == global_id_of(site, name)
    assert made != global_id_of(site + "x", name)
    assert made != global_id_of(site, name + "x")


def test_made_ids_never_change():
    assert global_id_of("office", "A-0012") == "2EChpAknzHX8Icpt1KGolS"
    assert global_id_of("a", "bc") != global_id_of("ab", "c")
    assert new_global_id() != new_global_id()


@pytest.mark.parametrize(
    "text",
    ["", "x", "4" + "0" * 21, "0" * 21, "0" * 23, "0" * 21 + "-", "0" * 21 + "é", "0" * 21 + "\n", "0" * 21 + "٣"],
)
def test_other_texts_are_none(text):
    assert not is_global_id(text)
    with pytest.raises(InputError, match="key: expected an IFC GlobalId"):
        check_global_id(text, "key")

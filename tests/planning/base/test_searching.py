"""Words are found however they are written."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.base.searching import folded


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("Weiß", "weiss"), ("WEISS", "weiß"), ("Müller", "muller"), ("Mu\u0308ller", "MÜLLER"), ("Zoë", "zoe"),
        ("Łódź", "łodz"), ("ﬁx", "FIX"), ("STRAẞE", "strasse"), ("İ", "i"), ("Ωμέγα", "ωμεγα"),
    ],
)  # fmt: skip
def test_spellings_of_one_word_are_the_same(one, other):
    assert folded(one) == folded(other)


# A dotless i has a dot as a capital, and an iota below is a letter of its own as one.
@given(st.text(st.characters(exclude_characters="\u0131\u0345")))
def test_nothing_is_left_to_fold_and_capitals_make_no_difference(text):
    assert folded(folded(text)) == folded(text)
    assert folded(text.title()) == folded(text)


def test_different_words_stay_different():
    assert len({folded(word) for word in ("weise", "weiß", "Wiese", "がん", "かん", "각", "가")}) == 7

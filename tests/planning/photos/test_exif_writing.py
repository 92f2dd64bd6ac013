"""EXIF that is written is what is read."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.photos.exif import Tag, exif_content, read_exif

TEXTS = st.text(st.characters(min_codepoint=33, max_codepoint=126), min_size=1, max_size=40)
RATIOS = st.lists(st.tuples(st.integers(0, 2**32 - 1), st.integers(1, 2**32 - 1)), min_size=1, max_size=3).map(tuple)


@given(st.dictionaries(st.sampled_from(list(Tag)), TEXTS | st.integers(0, 65535) | RATIOS))
def test_tags_come_back_as_they_were_written(tags):
    back = read_exif(exif_content(tags))
    assert set(back) == set(tags)
    for tag, content in tags.items():
        if isinstance(content, str):
            assert back[tag] == content
        elif isinstance(content, int):
            assert back[tag] == (content,)
        else:
            assert back[tag] == pytest.approx([above / below for above, below in content], rel=1e-12)


def test_bytes_are_numbers_when_they_are_read():
    assert read_exif(exif_content({Tag.GPS_ALTITUDE_REF: b"\2"})) == {Tag.GPS_ALTITUDE_REF: (2.0,)}


def test_other_programs_read_it_too():
    image = pytest.importorskip("PIL.Image")
    exif = image.Exif()
    exif.load(b"Exif\0\0" + exif_content({Tag.MAKE: "DJI", Tag.GPS_LATITUDE: ((22, 1), (20, 1), (1375, 100))}))
    assert exif[Tag.MAKE] == "DJI"
    assert [float(part) for part in exif.get_ifd(0x8825)[2]] == [22.0, 20.0, 13.75]

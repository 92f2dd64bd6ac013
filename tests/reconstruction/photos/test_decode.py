"""Photos as programs leave them, decoded without a word."""

from __future__ import annotations

import io
from itertools import product

import cv2
import numpy as np
import pytest
from PIL import Image

from planning.base.errors import InputError
from planning.photos.metadata import read_photo
from reconstruction.photos.decode import MOST_LEFT_BYTES, check_whole, decoded, grey_picture
from tests.planning.photos.photo_writer import plain_jpeg, segment
from tests.reconstruction.photos.pictures import facade


@pytest.mark.parametrize("stray", [b"\x00\x13\x00", b"\xff\x00\x07", b"rest of a longer part", b"\xff\xff"])
def test_bytes_that_belong_to_no_part_of_a_header_are_decoded_over_in_silence(stray, capfd):
    plain = plain_jpeg()
    part = segment(b"comment", 0xFE)
    content = plain[:2] + part + stray + part + stray + plain[2:]
    picture = decoded(content, cv2.IMREAD_COLOR, "a.jpg")
    np.testing.assert_array_equal(picture, decoded(plain, cv2.IMREAD_COLOR, "b.jpg"))
    assert "".join(capfd.readouterr()) == ""


def coded(grey, **options):
    buffer = io.BytesIO()
    Image.fromarray(grey).save(buffer, "JPEG", **options)
    return buffer.getvalue()


COLOUR = np.stack([facade(seed, (123, 174)) for seed in range(3)], axis=-1)

KINDS = [
    *({"quality": quality, "subsampling": sampling} for quality, sampling in product((5, 75, 100), (0, 1, 2))),
    {"quality": 95, "optimize": True},
    {"quality": 95, "progressive": True},
    {"quality": 90, "restart_marker_blocks": 1},
    {"quality": 90, "restart_marker_rows": 1, "subsampling": 2},
]


@pytest.mark.parametrize("options", KINDS)
@pytest.mark.parametrize("picture", [COLOUR, COLOUR[..., 0], COLOUR[:1, :1], COLOUR[:17, :16]])
def test_whole_pictures_of_all_kinds_pass(picture, options):
    check_whole(coded(picture, **options), "a.jpg")


def spoiled(content, kind, rng):
    """Content with 512 bytes of the picture's codes spoiled, as of a bad sector, in its last two thirds."""
    at = int(rng.integers(len(content) // 3, len(content) - 600))
    new = {"zeros": bytes(512), "ones": b"\xff" * 512, "lost": b"", "others": rng.bytes(512), "bit": b""}[kind]
    if kind == "bit":
        return content[:at] + bytes([content[at] ^ 1 << int(rng.integers(8))]) + content[at + 1 :]
    return content[:at] + new + content[at + 512 :]


@pytest.mark.parametrize("kind", ["zeros", "ones", "lost", "others"])
def test_a_photo_from_a_card_with_a_bad_sector_is_refused(tmp_path, kind):
    path, rng = tmp_path / "a.jpg", np.random.default_rng(0)
    for _ in range(5):
        path.write_bytes(spoiled(coded(COLOUR, quality=90), kind, rng))
        photo = read_photo(path)
        assert photo.is_complete
        with pytest.raises(InputError, match=r"a\.jpg: a part of the picture is damaged; copy the file again"):
            grey_picture(photo)


def test_all_is_refused_that_the_decoder_complains_of(capfd):
    rng, n_refused = np.random.default_rng(1), 0
    for number in range(120):
        kind = ("bit", "zeros", "others", "lost")[number % 4]
        more = {"restart_marker_rows": 2} if number % 3 == 0 else {}
        content = spoiled(coded(COLOUR, quality=80, **more), kind, rng)
        decoded(content, cv2.IMREAD_COLOR, "a.jpg")
        complaint = capfd.readouterr().err
        try:
            check_whole(content, "a.jpg")
        except InputError:
            n_refused += 1
        else:
            words = complaint.split()
            few = "extraneous" in words and int(words[words.index("extraneous") - 1]) <= MOST_LEFT_BYTES
            assert not complaint or few, complaint
    assert 50 < n_refused < 115

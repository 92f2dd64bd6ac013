"""Photos as programs leave them, decoded without a word."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from reconstruction.photos.decode import decoded
from tests.planning.photos.photo_writer import plain_jpeg, segment


@pytest.mark.parametrize("stray", [b"\x00\x13\x00", b"\xff\x00\x07", b"rest of a longer part", b"\xff\xff"])
def test_bytes_that_belong_to_no_part_of_a_header_are_decoded_over_in_silence(stray, capfd):
    plain = plain_jpeg()
    part = segment(b"comment", 0xFE)
    content = plain[:2] + part + stray + part + stray + plain[2:]
    picture = decoded(content, cv2.IMREAD_COLOR, "a.jpg")
    np.testing.assert_array_equal(picture, decoded(plain, cv2.IMREAD_COLOR, "b.jpg"))
    assert "".join(capfd.readouterr()) == ""

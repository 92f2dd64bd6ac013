"""Settings of the search from a file."""

from __future__ import annotations

from pathlib import Path

import pytest

from planning.base.errors import InputError
from reconstruction.panels.search.parameters import SegmentationParameters, read_parameters


def written(folder: Path, text: str) -> Path:
    path = folder / "segmentation.toml"
    path.write_text(text, "utf-8")
    return path


def test_keys_that_are_given_replace_defaults(tmp_path: Path) -> None:
    found = read_parameters(written(tmp_path, 'long_side_px = 800\ndetector = "lsd"\n'))
    assert found == SegmentationParameters(long_side_px=800, detector="lsd")


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("long_side = 800", "long_side: no such setting"),
        ("long_side_px = 2", "16 or more"),
        ('detector = "canny"', "detector"),
        ("beta = [1]", "beta"),
        ("beta = ", "TOML"),
    ],
)
def test_what_is_wrong_is_named(tmp_path: Path, text: str, named: str) -> None:
    with pytest.raises(InputError, match=named):
        read_parameters(written(tmp_path, text))


def test_parameters_out_of_range_are_named() -> None:
    with pytest.raises(ValueError, match="long_side_px"):
        SegmentationParameters(long_side_px=3)
    with pytest.raises(ValueError, match="beta"):
        SegmentationParameters(beta=0.0)
    with pytest.raises(ValueError, match="max_tilt_deg"):
        SegmentationParameters(max_tilt_deg=45.0)
    with pytest.raises(ValueError, match="least_seen"):
        SegmentationParameters(least_seen=1.0)

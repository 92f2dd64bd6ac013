"""`segment`: panels in one photo; bad photos in one clear line."""

import json

import cv2
import numpy as np
import pytest

from reconstruction.scenes.facades.cases import wide_camera
from reconstruction.scenes.facades.record import Layout
from reconstruction.scenes.facades.render import render_facade
from tests.reconstruction.synthetic_photos import simple_case


@pytest.fixture(scope="module")
def photo(tmp_path_factory):
    path = tmp_path_factory.mktemp("photo") / "facade.png"
    made = render_facade(simple_case(Layout(4, 6), intrinsics=wide_camera(800, 600)))
    cv2.imwrite(str(path), made.image)
    return path


@pytest.mark.long
def test_panels_are_written_in_pixels_of_the_photo(reflight, photo, tmp_path):
    done = reflight("segment", photo, "-o", tmp_path / "panels.json", "--json")
    assert done.status == 0
    content = json.loads((tmp_path / "panels.json").read_text())
    assert (content["image"], content["width_px"], content["height_px"]) == ("facade.png", 800, 600)
    panels = [panel for facade in content["facades"] for panel in facade["panels"]]
    assert done.json["panels"] == len(panels) > 0
    assert done.json["file"] == str(tmp_path / "panels.json")
    assert len({panel["id"] for panel in panels}) == len(panels)
    corners = np.array([panel["corners_px"] for panel in panels])
    assert corners.min() >= 0.0
    assert corners[..., 0].max() <= 800.0
    assert "rows" in reflight("segment", photo, "-o", tmp_path / "again.json").out


@pytest.mark.slow
def test_photo_said_to_be_fronto_parallel_is_searched_as_it_is(reflight, photo, tmp_path):
    out = tmp_path / "p.json"
    assert reflight("segment", photo, "-o", out, "--rectified").status == 0
    (facade,) = json.loads(out.read_text())["facades"]
    assert (facade["rows"], facade["columns"]) == (4, 6)
    for line in facade["vertical_lines"]:
        # Seen straight from the front, so upright but for what the search takes out as remaining tilt.
        assert np.ptp(np.array(line["points_px"])[:, 0]) < 2.0


def test_blank_photo_has_no_panels_and_is_no_error(reflight, tmp_path):
    cv2.imwrite(str(tmp_path / "blank.png"), np.zeros((300, 400), np.uint8))
    done = reflight("segment", tmp_path / "blank.png", "-o", tmp_path / "p.json")
    assert done.status == 0
    assert "no panels found" in done.out
    assert json.loads((tmp_path / "p.json").read_text())["facades"] == []


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (None, "found nothing of that name"),
        (b"", "an empty file"),
        (b'{"format": "reflight-site/1"}', "expected a photo (JPEG, PNG, TIFF or BMP), found a site"),
        (b"\xff\xd8\xff\xe0 no more", "the file ends in its header"),
        (b"some words", "cannot be decoded"),
    ],
)
def test_bad_photos_are_named_and_leave_no_file(reflight, tmp_path, content, words):
    path = tmp_path / "bad.jpg"
    if content is not None:
        path.write_bytes(content)
    error = reflight("segment", path, "-o", tmp_path / "p.json").error
    assert str(path) in error
    assert words in error
    assert not (tmp_path / "p.json").exists()


def test_output_that_cannot_be_written_is_refused_before_the_work(reflight, photo, tmp_path):
    assert "there is no folder" in reflight("segment", photo, "-o", tmp_path / "no" / "p.json").error
    assert "would replace" in reflight("segment", photo, "-o", photo).error


@pytest.mark.slow
def test_settings_come_from_a_file_and_from_options(reflight, photo, tmp_path):
    settings = tmp_path / "s.toml"
    settings.write_text("long_side_px = 400\n")
    out = tmp_path / "p.json"
    assert reflight("segment", photo, "-o", out, "--parameters", settings, "--samples", 64).status == 0
    assert "--long-side: expected 16 or more, got 3" in reflight("segment", photo, "-o", out, "--long-side", 3).error
    assert "--detector: expected one of" in reflight("segment", photo, "-o", out, "--detector", "sobel").error
    settings.write_text("long_sides_px = 400\n")
    assert "long_sides_px" in reflight("segment", photo, "-o", out, "--parameters", settings).error
    assert "cannot be read" in reflight("segment", photo, "-o", out, "--parameters", tmp_path / "none.toml").error

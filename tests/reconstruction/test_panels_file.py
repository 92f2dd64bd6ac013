"""The file of found panels: what stands in it, whole and in pixels of the photo."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from planning.errors import InputError
from reconstruction.panels_file import panels_content, write_panels
from reconstruction.segmentation.record import FacadeGrid, FoundPanel, GridLine, Segmentation
from reconstruction.segmentation.views import WholePicture

CORNERS = np.array([[12.0, 50.0], [30.0, 50.0], [30.0, 11.12345], [12.0, 11.0]])


def found() -> Segmentation:
    lines = (GridLine(10.0, 4.0, confidence=0.5), GridLine(40.0, is_inferred=True))
    panel = FoundPanel("A-r0c0", 0, 0, CORNERS, 0.87654321)
    full = FacadeGrid("A", WholePicture(60, 80), lines, (*lines, GridLine(55.0)), (panel,), ((0, 1),))
    return Segmentation("a.jpg", 60, 80, (full, FacadeGrid("B", WholePicture(60, 80), lines, (), ())))


def test_content_has_the_grid_in_pixels_of_the_photo() -> None:
    content = panels_content(found())
    assert content["format"] == "reflight-panels/1"
    assert (content["image"], content["width_px"], content["height_px"]) == ("a.jpg", 60, 80)
    (facade,) = content["facades"]
    assert (facade["id"], facade["rows"], facade["columns"]) == ("A", 1, 2)
    assert facade["missing"] == [{"row": 0, "column": 1}]
    (panel,) = facade["panels"]
    assert panel["corners_px"][2] == [30.0, 11.123]
    assert panel["confidence"] == 0.8765
    first, second = facade["horizontal_lines"]
    assert (first["points_px"][0], first["points_px"][-1]) == ([10.0, 10.0], [55.0, 10.0])
    assert (first["inferred"], second["inferred"]) == (False, True)
    assert facade["vertical_lines"][2]["points_px"][-1] == [55.0, 40.0]


def test_file_is_what_stands_in_the_content(tmp_path: Path) -> None:
    write_panels(tmp_path / "p.json", found())
    assert json.loads((tmp_path / "p.json").read_text()) == panels_content(found())


def test_folder_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="there is no folder"):
        write_panels(tmp_path / "nowhere" / "p.json", found())

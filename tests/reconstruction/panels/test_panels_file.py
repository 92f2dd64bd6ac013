"""The file of found panels: what stands in it, in pixels of the photo, and that it comes back as it was."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.base.errors import InputError
from reconstruction.panels.panels_file import (
    PANELS_FORMAT,
    PIXEL_CONVENTION,
    FileCell,
    FileFacade,
    FileInclined,
    FileLine,
    FilePanel,
    PanelsFile,
    panels_content,
    panels_record,
    read_panels,
    read_panels_folder,
    write_panels,
)
from reconstruction.panels.search.record import FacadeGrid, FoundPanel, GridLine, Segmentation
from reconstruction.panels.search.views import WholePicture

CORNERS = np.array([[12.0, 50.0], [30.0, 50.0], [30.0, 11.12345], [12.0, 11.0]])


def found() -> Segmentation:
    lines = (GridLine(10.0, 4.0, confidence=0.5), GridLine(40.0, is_inferred=True))
    panel = FoundPanel("A-r0c0", 0, 0, CORNERS, 0.87654321)
    full = FacadeGrid("A", WholePicture(60, 80), lines, (*lines, GridLine(55.0)), (panel,), ((0, 1),))
    return Segmentation("a.jpg", 60, 80, (full, FacadeGrid("B", WholePicture(60, 80), lines, (), ())))


def content() -> Any:
    return panels_content(panels_record(found()))


def test_content_has_the_grid_in_pixels_of_the_photo() -> None:
    written = content()
    assert written["format"] == "reflight-panels/1"
    assert (written["image"], written["width_px"], written["height_px"]) == ("a.jpg", 60, 80)
    (facade,) = written["facades"]
    assert (facade["id"], facade["rows"], facade["columns"]) == ("A", 1, 2)
    assert facade["missing"] == [{"row": 0, "column": 1}]
    (panel,) = facade["panels"]
    assert panel["corners_px"][2] == [30.0, 11.123]
    assert panel["confidence"] == 0.8765
    first, second = facade["horizontal_lines"]
    assert (first["points_px"][0], first["points_px"][-1]) == ([10.0, 10.0], [55.0, 10.0])
    assert (first["inferred"], second["inferred"]) == (False, True)
    assert facade["vertical_lines"][2]["points_px"][-1] == [55.0, 40.0]


numbers = st.floats(-1e5, 1e5)
shares = st.floats(0.0, 1.0)
points = st.tuples(numbers, numbers)
lines = st.builds(FileLine, st.lists(points, max_size=5).map(tuple), shares, st.booleans())


@st.composite
def inclined(draw: st.DrawFn) -> FileInclined:
    n = draw(st.integers(2, 4))
    left, right = (tuple(draw(st.lists(points, min_size=n, max_size=n))) for _ in range(2))
    return FileInclined(left, right, draw(st.sampled_from(["both", "left", "right"])), draw(shares))


@st.composite
def facades(draw: st.DrawFn) -> FileFacade:
    n_rows, n_columns = draw(st.integers(1, 4)), draw(st.integers(1, 4))
    cells = [(row, column) for row in range(n_rows) for column in range(n_columns)]
    chosen = draw(st.lists(st.sampled_from(cells), unique=True))
    corners = st.lists(points, min_size=3, max_size=6).map(tuple)
    panels = tuple(FilePanel(f"{draw(st.text(max_size=3))}-{i}", *cell, draw(corners), draw(shares))
                   for i, cell in enumerate(chosen))  # fmt: skip
    missing = tuple(FileCell(*cell) for cell in cells if cell not in chosen)
    horizontal, vertical = (tuple(draw(lines) for _ in range(n + 1)) for n in (n_rows, n_columns))
    braces = tuple(draw(st.lists(inclined(), max_size=2)))
    return FileFacade(draw(st.text(max_size=3)), n_rows, n_columns, horizontal, vertical, missing, panels, braces)


@pytest.mark.slow
@given(
    st.builds(
        PanelsFile,
        st.just(PANELS_FORMAT),
        st.text(max_size=20),
        st.integers(1, 10_000),
        st.integers(1, 10_000),
        st.just(PIXEL_CONVENTION),
        st.lists(facades(), max_size=3).map(tuple),
    )
)
def test_what_was_written_is_read_back_identical(tmp_path_factory: pytest.TempPathFactory, record: PanelsFile) -> None:
    path = tmp_path_factory.mktemp("panels") / "p.json"
    write_panels(path, record)
    assert read_panels(path) == record


def test_what_the_search_writes_is_read_back_and_written_the_same(tmp_path: Path) -> None:
    write_panels(tmp_path / "p.json", panels_record(found()))
    again = read_panels(tmp_path / "p.json")
    write_panels(tmp_path / "q.json", again)
    assert (tmp_path / "p.json").read_bytes() == (tmp_path / "q.json").read_bytes()
    assert json.loads((tmp_path / "p.json").read_text()) == content()


def test_folder_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="there is no folder"):
        write_panels(tmp_path / "nowhere" / "p.json", panels_record(found()))


def facade_with(**changes: Any) -> Any:
    changed = content()
    changed["facades"][0] |= changes
    return changed


BROKEN = {
    "another format": (content() | {"format": "reflight-site/1"}, "reflight-panels/1"),
    "a later version": (content() | {"format": "reflight-panels/9"}, "reflight-panels/9"),
    "no format": ({}, "format"),
    "a list": ([], "object"),
    "no width": ({key: value for key, value in content().items() if key != "width_px"}, "width_px"),
    "no size": (content() | {"height_px": 0}, "60 x 0 pixels"),
    "other pixels": (content() | {"pixel_convention": "y up"}, "pixel_convention: expected 'x right, y down"),
    "a text for a number": (content() | {"width_px": "wide"}, "width_px"),
    "too few lines": (facade_with(rows=3), "3 rows need 4 lines, found 2"),
    "no cells": (facade_with(rows=0), "0 rows need 2 lines"),
    "a cell that is not there": (facade_with(missing=[{"row": 0, "column": 7}]), "no cell in row 0 and column 7"),
    "two corners": (
        facade_with(panels=[{"id": "a", "row": 0, "column": 0, "corners_px": [[0, 0], [1, 1]], "confidence": 1.0}]),
        "panel 'a': expected three corners or more, found 2",
    ),
    "a sure line": (facade_with(horizontal_lines=[{"points_px": [], "confidence": 2.0}] * 2), "expected 0 to 1"),
    "a flat point": (facade_with(horizontal_lines=[{"points_px": [[1.0]]}] * 2), "points_px"),
}


@pytest.mark.parametrize(("broken", "words"), BROKEN.values(), ids=BROKEN)
def test_broken_files_are_refused_by_name_and_place(tmp_path: Path, broken: Any, words: str) -> None:
    path = tmp_path / "p.json"
    path.write_text(json.dumps(broken))
    with pytest.raises(InputError) as caught:
        read_panels(path)
    assert str(path) in str(caught.value)
    assert words in str(caught.value)


@pytest.mark.parametrize("text", ["", "{", '{"width_px": NaN}', '{"width_px": 1e999}', "\x00"])
def test_what_is_no_json_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / "p.json").write_text(text)
    with pytest.raises(InputError, match=r"p\.json"):
        read_panels(tmp_path / "p.json")


def test_folders_hold_one_file_a_photo(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="expected a folder of panels files"):
        read_panels_folder(tmp_path / "none")
    with pytest.raises(InputError, match="found none"):
        read_panels_folder(tmp_path)
    write_panels(tmp_path / "a.json", panels_record(found()))
    assert set(read_panels_folder(tmp_path)) == {"a.jpg"}
    write_panels(tmp_path / "b.json", panels_record(found()))
    with pytest.raises(InputError, match=r"photo 'a\.jpg' is in a\.json already"):
        read_panels_folder(tmp_path)

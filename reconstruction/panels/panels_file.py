"""`reflight-panels/1`: the panels found in one photo, as JSON, written and read; docs/reference describes it."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import msgspec
import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.json_file import encoded, expect_format, read_json, to_record, write_atomically
from planning.base.messages import say
from reconstruction.panels.rectify.surface import Rectification
from reconstruction.panels.search.record import FacadeGrid, GridLine, InclinedLine, Segmentation

Array = NDArray[np.float64]
Point = tuple[float, float]

PANELS_FORMAT = "reflight-panels/1"

PIXEL_CONVENTION = "x right, y down, in pixels; the centre of the first pixel is (0.5, 0.5)"

LINE_POINTS = 9
"""Points along a grid line: on a curved facade it is an arc in the photo."""

PIXEL_DIGITS, SHARE_DIGITS = 3, 4


@dataclass(frozen=True, slots=True)
class FileLine:
    """A line of the grid: its middle, in pixels of the photo."""

    points_px: tuple[Point, ...]
    confidence: float = 1.0
    inferred: bool = False

    def __post_init__(self) -> None:
        _check_share(self.confidence)


PanelsBeside = Literal["both", "left", "right"]
"""On which sides of an inclined profile there are panels, walking along its edges as the photo shows it."""

OPEN_SIDES: dict[PanelsBeside, int] = {"both": 0, "left": -1, "right": 1}


@dataclass(frozen=True, slots=True)
class FileInclined:
    """An inclined profile: its two edges, from the same end, in pixels of the photo."""

    left_px: tuple[Point, ...]
    right_px: tuple[Point, ...]
    panels: PanelsBeside = "both"
    confidence: float = 1.0

    def __post_init__(self) -> None:
        if len(self.left_px) < 2 or len(self.right_px) != len(self.left_px):
            raise ValueError(
                "inclined line: expected two points or more on its left edge and as many on its right one, found "
                f"{len(self.left_px)} and {len(self.right_px)}"
            )
        _check_share(self.confidence)


@dataclass(frozen=True, slots=True)
class FileCell:
    """A cell that is no panel: its row from the bottom and column from the left, from 0."""

    row: int
    column: int


@dataclass(frozen=True, slots=True)
class FilePanel:
    """A panel; corners as in `FoundPanel`."""

    id: str
    row: int
    column: int
    corners_px: tuple[Point, ...]
    confidence: float = 1.0

    def __post_init__(self) -> None:
        if len(self.corners_px) < 3:
            raise ValueError(f"panel '{self.id}': expected three corners or more, found {len(self.corners_px)}")
        _check_share(self.confidence)


@dataclass(frozen=True, slots=True)
class FileFacade:
    """A facade: `rows` and `columns` count cells, and there is a line more in each direction."""

    id: str
    rows: int
    columns: int
    horizontal_lines: tuple[FileLine, ...]
    vertical_lines: tuple[FileLine, ...]
    missing: tuple[FileCell, ...] = ()
    panels: tuple[FilePanel, ...] = ()
    inclined_lines: tuple[FileInclined, ...] = ()

    def __post_init__(self) -> None:
        for what, n_cells, lines in (
            ("rows", self.rows, self.horizontal_lines),
            ("columns", self.columns, self.vertical_lines),
        ):
            if n_cells < 1 or len(lines) != n_cells + 1:
                raise ValueError(
                    f"facade '{self.id}': {n_cells} {what} need {max(1, n_cells) + 1} lines, found {len(lines)}; a "
                    f"line that is added or taken out changes the number of {what}, too"
                )
        named = [(cell.row, cell.column) for cell in self.missing]
        for row, column in (*named, *((panel.row, panel.column) for panel in self.panels)):
            if not (0 <= row < self.rows and 0 <= column < self.columns):
                raise ValueError(
                    f"facade '{self.id}': there is no cell in row {row} and column {column}; expected rows up to "
                    f"{self.rows - 1} and columns up to {self.columns - 1}, counted from 0"
                )


@dataclass(frozen=True, slots=True)
class PanelsFile:
    """Content of the file."""

    format: str
    image: str
    width_px: int
    height_px: int
    pixel_convention: str
    facades: tuple[FileFacade, ...]

    def __post_init__(self) -> None:
        if min(self.width_px, self.height_px) < 1:
            raise ValueError(f"expected a photo of some size, found {self.width_px} x {self.height_px} pixels")
        if self.pixel_convention != PIXEL_CONVENTION:
            raise ValueError(f"pixel_convention: expected '{PIXEL_CONVENTION}', found '{self.pixel_convention}'")


def _check_share(confidence: float) -> None:
    if not 0.0 <= confidence <= 1.0:
        raise ValueError(f"confidence: expected 0 to 1, found {confidence}")


def panels_record(found: Segmentation) -> PanelsFile:
    """What stands in the file of a photo's panels."""
    facades = tuple(_facade(facade) for facade in found.facades if facade.panels)
    return PanelsFile(PANELS_FORMAT, found.image, found.width_px, found.height_px, PIXEL_CONVENTION, facades)


def panels_content(record: PanelsFile) -> Any:
    """A record as plain JSON values."""
    return msgspec.json.decode(encoded(record))


def write_panels(path: Path, record: PanelsFile) -> None:
    """Write the file, whole or not at all.

    Raises
    ------
    InputError
        It cannot be written.
    """
    content = json.dumps(panels_content(record), indent=1, allow_nan=False)
    write_atomically(path, content.encode("utf-8"))


def read_panels(path: Path) -> PanelsFile:
    """Read a file, such as one that was corrected by hand.

    Raises
    ------
    InputError
        It cannot be read, is of another format, or breaks a rule; the message names the place and the rule.
    """
    content = read_json(path, names_files=True)
    expect_format(content, PANELS_FORMAT, path)
    return to_record(content, PanelsFile, path)


def read_panels_folder(folder: Path) -> dict[str, PanelsFile]:
    """All panels files (`*.json`) of a folder, by the name of their photo.

    Raises
    ------
    InputError
        There is none, one cannot be read, or two are about one photo.
    """
    paths = sorted(folder.glob("*.json")) if folder.is_dir() else []
    if not paths:
        raise InputError(
            say("expected a folder of panels files (*.json), as 'segment' writes them; found none", place=folder)
        )
    files: dict[str, PanelsFile] = {}
    first: dict[str, Path] = {}
    for path in paths:
        record = read_panels(path)
        if record.image in files:
            raise InputError(
                say("photo '{}' is in {} already; keep one of them", record.image, first[record.image].name, place=path)
            )
        files[record.image], first[record.image] = record, path
    return files


def _facade(facade: FacadeGrid) -> FileFacade:
    view = facade.rectification
    across, along = (np.linspace(*_ends(lines), LINE_POINTS) for lines in (facade.columns, facade.rows))
    middles = [np.full(LINE_POINTS, line.position_px) for line in facade.rows]
    rows = [view.to_photo(np.column_stack([across, y])) for y in middles]
    middles = [np.full(LINE_POINTS, line.position_px) for line in facade.columns]
    columns = [view.to_photo(np.column_stack([x, along])) for x in middles]
    return FileFacade(
        id=facade.id,
        rows=len(facade.rows) - 1,
        columns=len(facade.columns) - 1,
        horizontal_lines=tuple(_line(*pair) for pair in zip(facade.rows, rows, strict=True)),
        vertical_lines=tuple(_line(*pair) for pair in zip(facade.columns, columns, strict=True)),
        missing=tuple(FileCell(row, column) for row, column in facade.missing),
        panels=tuple(
            FilePanel(panel.id, panel.row, panel.column, _points(panel.corners_px), _share(panel.confidence))
            for panel in facade.panels
        ),
        inclined_lines=tuple(
            found for line in facade.inclined if (found := _inclined(line, facade.rectification)) is not None
        ),
    )


def _inclined(line: InclinedLine, view: Rectification) -> FileInclined | None:
    """Both edges in the photo; None where the view cannot take them there."""
    first, last = np.array(line.first_px), np.array(line.last_px)
    middle = first + np.linspace(0.0, 1.0, LINE_POINTS)[:, None] * (last - first)
    along = (last - first) / np.hypot(*(last - first))
    to_right = 0.5 * line.width_px * np.array([-along[1], along[0]])
    left, right = view.to_photo(middle - to_right), view.to_photo(middle + to_right)
    if not (np.isfinite(left).all() and np.isfinite(right).all()):
        return None
    beside = next(name for name, side in OPEN_SIDES.items() if side == line.open_side)
    return FileInclined(_points(left), _points(right), beside, _share(line.confidence))


def _ends(lines: tuple[GridLine, ...]) -> tuple[float, float]:
    """Where lines across these begin and end."""
    return lines[0].position_px, lines[-1].position_px


def _line(line: GridLine, points_px: Array) -> FileLine:
    """A line in the photo; points that the view cannot take there are left out."""
    seen = points_px[np.isfinite(points_px).all(axis=1)]
    return FileLine(_points(seen), _share(line.confidence), bool(line.is_inferred))


def _points(points_px: Array) -> tuple[Point, ...]:
    return tuple((float(x), float(y)) for x, y in np.round(points_px, PIXEL_DIGITS))


def _share(confidence: float) -> float:
    return round(float(confidence), SHARE_DIGITS)

"""`reflight-panels/1`: the panels found in one photo, as JSON; docs/file-formats.md describes it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.json_file import write_atomically
from reconstruction.segmentation.record import FacadeGrid, GridLine, Segmentation

Array = NDArray[np.float64]

PANELS_FORMAT = "reflight-panels/1"

PIXEL_CONVENTION = "x right, y down, in pixels; the centre of the first pixel is (0.5, 0.5)"

LINE_POINTS = 9
"""Points along a grid line: on a curved facade it is an arc in the photo."""

PIXEL_DIGITS, SHARE_DIGITS = 3, 4


def panels_content(found: Segmentation) -> dict[str, Any]:
    """What stands in the file."""
    return {
        "format": PANELS_FORMAT,
        "image": found.image,
        "width_px": found.width_px,
        "height_px": found.height_px,
        "pixel_convention": PIXEL_CONVENTION,
        "facades": [_facade(facade) for facade in found.facades if facade.panels],
    }


def write_panels(path: Path, found: Segmentation) -> None:
    """Write the file, whole or not at all.

    Raises
    ------
    InputError
        It cannot be written.
    """
    content = json.dumps(panels_content(found), indent=1, allow_nan=False)
    write_atomically(path, content.encode("utf-8"))


def _facade(facade: FacadeGrid) -> dict[str, Any]:
    view = facade.rectification
    across, along = (np.linspace(*_ends(lines), LINE_POINTS) for lines in (facade.columns, facade.rows))
    middles = [np.full(LINE_POINTS, line.position_px) for line in facade.rows]
    rows = [view.to_photo(np.column_stack([across, y])) for y in middles]
    middles = [np.full(LINE_POINTS, line.position_px) for line in facade.columns]
    columns = [view.to_photo(np.column_stack([x, along])) for x in middles]
    return {
        "id": facade.id,
        "rows": len(facade.rows) - 1,
        "columns": len(facade.columns) - 1,
        "horizontal_lines": [_line(*pair) for pair in zip(facade.rows, rows, strict=True)],
        "vertical_lines": [_line(*pair) for pair in zip(facade.columns, columns, strict=True)],
        "missing": [{"row": row, "column": column} for row, column in facade.missing],
        "panels": [
            {
                "id": panel.id,
                "row": panel.row,
                "column": panel.column,
                "corners_px": np.round(panel.corners_px, PIXEL_DIGITS).tolist(),
                "confidence": round(float(panel.confidence), SHARE_DIGITS),
            }
            for panel in facade.panels
        ],
    }


def _ends(lines: tuple[GridLine, ...]) -> tuple[float, float]:
    """Where lines across these begin and end."""
    return lines[0].position_px, lines[-1].position_px


def _line(line: GridLine, points_px: Array) -> dict[str, Any]:
    """A line in the photo; points that the view cannot take there are left out."""
    return {
        "points_px": np.round(points_px[np.isfinite(points_px).all(axis=1)], PIXEL_DIGITS).tolist(),
        "confidence": round(float(line.confidence), SHARE_DIGITS),
        "inferred": bool(line.is_inferred),
    }

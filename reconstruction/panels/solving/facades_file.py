"""`reflight-facades/1`: what is known of found facades beyond the corners of their panels (docs/reference)."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import msgspec
import numpy as np

from reconstruction.base.cameras import PosedPhoto
from reconstruction.panels.solving.accuracy import FACADES_FORMAT, FoundFacades, PanelAccuracy
from reconstruction.panels.solving.find import FoundPanels
from reconstruction.panels.solving.record import SolvedFacade, SolvedPanel

DIGITS = 5


def facades_bytes(found: FoundPanels, photos: Sequence[PosedPhoto]) -> bytes:
    """Content of the file.

    Parameters
    ----------
    photos
        That were searched, in the order that `found` counts them.
    """
    content = {
        "format": FACADES_FORMAT,
        "facades": [_facade(facade, found, photos) for facade in found.facades],
    }
    return json.dumps(content, indent=1, allow_nan=False).encode()


def found_facades(found: FoundPanels, photos: Sequence[PosedPhoto]) -> FoundFacades:
    """The file as a reader will find it; parameters as for `facades_bytes`."""
    content = facades_bytes(found, photos)
    panels = msgspec.convert(
        [_panel(panel) for facade in found.facades for panel in facade.panels], list[PanelAccuracy]
    )
    return FoundFacades(content, {panel.id: panel for panel in panels})


def _facade(facade: SolvedFacade, found: FoundPanels, photos: Sequence[PosedPhoto]) -> dict[str, Any]:
    surface = facade.surface
    return {
        "id": facade.id,
        "surface": {
            "anchor_enu_m": _rounded(surface.anchor_enu_m),
            "right_enu": _rounded(surface.right_enu, 9),
            "up_enu": _rounded(surface.up_enu, 9),
            "curvature_per_m": surface.curvature_per_m,
        },
        "curvature": asdict(found.decisions[facade.id]),
        "search": [asdict(decision) for decision in found.search_decisions.get(facade.id, ())],
        "rows": [asdict(line) for line in facade.rows],
        "columns": [asdict(line) for line in facade.columns],
        "inclined": [asdict(line) for line in facade.inclined],
        "photos": [photos[number].name for name, number in found.grids if name == facade.id],
        "pose_changes": {photos[number].name: _rounded(change, 7) for number, change in facade.pose_changes.items()},
        "panels": [_panel(panel) for panel in facade.panels],
    }


def _panel(panel: SolvedPanel) -> dict[str, Any]:
    variances = np.maximum(np.diagonal(panel.covariance_m2, axis1=1, axis2=2), 0.0)
    outline = {} if panel.outline_enu_m is None else {"outline_enu_m": _rounded(panel.outline_enu_m)}
    return {
        "id": panel.id,
        "row": panel.row,
        "column": panel.column,
        "confidence": round(panel.confidence, 4),
        "corners_enu_m": _rounded(panel.corners_enu_m),
        "corner_sigmas_enu_m": _rounded(np.sqrt(variances)),
        **outline,
    }


def _rounded(values: np.ndarray, digits: int = DIGITS) -> Any:
    return np.round(values, digits).tolist()

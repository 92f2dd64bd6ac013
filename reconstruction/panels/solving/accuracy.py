"""How good found panels are, as a facades file says it (`reflight-facades/1`, docs/reference/file-formats.md)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from planning.base.files import read_input_file
from planning.base.json_file import JSON_FILE, expect_format, parse_json, to_record
from planning.geo.frames import Vec3
from planning.site.records import Panel

FACADES_FORMAT = "reflight-facades/1"

SAME_CORNER_M = 1e-3
"""What rounding in two files leaves is a tenth of this; a panel that was moved on purpose is moved by more."""


@dataclass(frozen=True, slots=True)
class PanelAccuracy:
    """One found panel.

    Parameters
    ----------
    confidence
        The least of its lines, 0 to 1.
    corner_sigmas_enu_m
        Standard deviations of each corner.
    corners_enu_m
        Where it was found; empty in files of versions that did not say.
    """

    id: str
    confidence: float
    corner_sigmas_enu_m: tuple[Vec3, ...]
    corners_enu_m: tuple[Vec3, ...] = ()

    def __post_init__(self) -> None:
        if not 0.0 <= self.confidence <= 1.0:
            raise ValueError(f"confidence: expected 0 to 1, got {self.confidence}")
        if not self.corner_sigmas_enu_m or any(s < 0.0 for corner in self.corner_sigmas_enu_m for s in corner):
            raise ValueError("corner_sigmas_enu_m: expected at least one corner and no negative standard deviation")

    @property
    def corner_sigma_m(self) -> float:
        """Standard deviation of a corner's place in space, the root mean square of all corners."""
        return math.sqrt(float((np.array(self.corner_sigmas_enu_m) ** 2).sum(axis=1).mean()))


@dataclass(frozen=True, slots=True, eq=False)
class FoundFacades:
    """A facades file: its bytes, which are kept as they are, and what it says of panels by their identifiers."""

    content: bytes
    panels: Mapping[str, PanelAccuracy]

    def of(self, panel: Panel) -> PanelAccuracy | None:
        """What is known of a panel of the site; None for one that was not found, or has been moved since."""
        known = self.panels.get(panel.id)
        if known is None or len(known.corners_enu_m) != len(panel.corners_enu_m):
            return None
        apart_m = np.abs(np.array(known.corners_enu_m) - np.array(panel.corners_enu_m)).max()
        return known if apart_m <= SAME_CORNER_M else None


@dataclass(frozen=True, slots=True)
class _Facade:
    panels: tuple[PanelAccuracy, ...] = ()


@dataclass(frozen=True, slots=True)
class _File:
    facades: tuple[_Facade, ...]


def read_facades(path: Path) -> FoundFacades:
    """Read a facades file.

    Raises
    ------
    InputError
        It cannot be read, or a field is missing or wrong.
    """
    return facades_of(read_input_file(path, JSON_FILE), path)


def facades_of(written: bytes, path: Path) -> FoundFacades:
    """Facades from the content of their file `path`; errors as `read_facades`."""
    content = parse_json(written, path, names_files=True)
    expect_format(content, FACADES_FORMAT, path)
    file = to_record(content, _File, path)
    return FoundFacades(written, {panel.id: panel for facade in file.facades for panel in facade.panels})


def facades_path(site: Path) -> Path:
    """File beside a site file with surfaces, lines and accuracy of its facades."""
    return site.with_name(f"{site.name.removesuffix('.json').removesuffix('.site')}.facades.json")

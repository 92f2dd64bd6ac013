"""A scene of objects as the window knows it: facades, panels and a first view, without a Gaussian being read."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from functools import cached_property
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from planning.base.files import real_path
from planning.base.json_file import expect_format, read_json
from planning.geo.frames import Origin
from reconstruction.base.cameras import Intrinsics, Pose, PosedPhoto
from reconstruction.objects.gs_scene import GsElement
from reconstruction.objects.picking import Quads
from reconstruction.objects.store import (
    DESCRIPTION,
    FORMAT,
    StoredScene,
    largest,
    middle_of,
    outward,
    places_of,
    standoff_m,
    usual_look,
)
from reconstruction.training.parameters import MODEL

Array = NDArray[np.float64]

SIZE_PX = 1280, 960
FIELD_RAD = math.radians(60.0)
"""Across, of the first view."""

WIDEST_RAD = math.radians(100.0)
"""Across, from where photos were taken near the facade."""

ROOM = 1.15
"""Around what the first view shows."""

LEAST_DISTANCE_M = 3.0


Level = Literal["panel", "facade", "building"]
"""Of what records are of."""


@dataclass(frozen=True, slots=True)
class PanelRow:
    """A panel of the scene, and its facade.

    Parameters
    ----------
    facade_id
        GlobalId of the facade.
    """

    element: GsElement
    facade: str
    facade_id: str

    @property
    def global_id(self) -> str:
        """IFC GlobalId."""
        return self.element.global_id

    @property
    def name(self) -> str:
        """In the site."""
        return self.element.name

    @property
    def size_m(self) -> tuple[float, float]:
        """Width and height: means of opposite edges."""
        corners = np.array(self.element.corners_enu_m)
        edges = np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1)
        return float(edges[0] + edges[2]) / 2.0, float(edges[1] + edges[3]) / 2.0


@dataclass(frozen=True, slots=True)
class Subject:
    """What records are of.

    Parameters
    ----------
    panel
        Where it is one.
    """

    global_id: str
    name: str
    panel: PanelRow | None = None


@dataclass(frozen=True, eq=False)
class SceneCard:
    """What is known of a scene.

    Parameters
    ----------
    panels
        In their order of facades.
    written_at
        When its description was written.
    places_enu_m
        Where its photos were taken, shape (k, 3); none where that is not known.
    look
        Place and direction, ENU, of a photo in their midst; None where that is not known.
    """

    folder: Path
    name: str
    global_id: str
    origin: Origin | None
    panels: tuple[PanelRow, ...]
    n_gaussians: int
    written_at: datetime
    places_enu_m: Array
    look: tuple[Array, Array] | None = None

    @cached_property
    def by_global_id(self) -> dict[str, PanelRow]:
        """Panels by their GlobalIds."""
        return {panel.global_id: panel for panel in self.panels}

    @cached_property
    def by_number(self) -> dict[int, PanelRow]:
        """Panels by their numbers in the model."""
        return {panel.element.panel: panel for panel in self.panels}

    def subject(self, level: Level, selected: str) -> Subject | None:
        """A panel by its GlobalId, its facade (or the only one there is), or the building; None where there is none."""
        if level == "building":
            return Subject(self.global_id, self.name)
        panel = self.by_global_id.get(selected)
        if level == "panel":
            return None if panel is None else Subject(panel.global_id, panel.name, panel)
        if panel is None and len({each.facade_id for each in self.panels}) == 1:
            panel = self.panels[0]
        return None if panel is None else Subject(panel.facade_id, panel.facade)

    @cached_property
    def quads(self) -> Quads:
        """Of the panels, in the order of `panels`."""
        return Quads.of(np.array([panel.element.corners_enu_m for panel in self.panels]))

    @cached_property
    def first_view(self) -> PosedPhoto:
        """Square before the largest facade, so that all of it is seen.

        Where it is known from how far photos of it were taken, it is from no farther, as nothing stood in the way
        there, unless the field of view would be wider than `WIDEST_RAD`. Without panels it is that of a photo in the
        midst of the others.
        """
        facades: dict[str, list[PanelRow]] = {}
        for panel in self.panels:
            facades.setdefault(panel.facade_id, []).append(panel)
        corners = [np.array([panel.element.corners_enu_m for panel in each]) for each in facades.values()]
        if not corners:
            blank = view_of(())
            if self.look is None:
                return blank
            place, forward = self.look
            return replace(blank, pose=Pose(place, _rotation(forward)))
        number = largest(corners)
        shown, standoff = tuple(facades.values())[number], standoff_m(corners[number], self.places_enu_m)
        return view_of(shown, math.inf if standoff is None else standoff)


def is_scene(folder: Path) -> bool:
    """Whether a folder holds a scene of objects."""
    return (folder / DESCRIPTION).is_file()


def is_model(folder: Path) -> bool:
    """Whether a folder holds a trained model."""
    return (folder / MODEL).is_file()


def read_card(folder: Path) -> SceneCard:
    """Look at a scene of objects.

    Raises
    ------
    InputError
        There is none, or its description is damaged.
    """
    stored = StoredScene(folder)
    panels = tuple(PanelRow(element, head.name, head.global_id) for head in stored.heads for element in head.elements)
    at = datetime.fromtimestamp((folder / DESCRIPTION).stat().st_mtime, UTC)
    places, look = places_of(stored.training), usual_look(stored.training)
    return SceneCard(folder, stored.name, stored.global_id, stored.origin, panels, stored.n_gaussians, at, places, look)


def scenes_beside(folder: Path) -> tuple[Path, ...]:
    """Folders beside a scene's that hold scenes too: the same building at another time, or of another flight."""
    found = []
    for path in sorted(real_path(folder).parent.glob(f"*/{DESCRIPTION}")):
        if path.parent != real_path(folder):
            try:
                expect_format(read_json(path), FORMAT, path)
            except Exception:
                continue
            found.append(path.parent)
    return tuple(found)


def view_of(panels: Sequence[PanelRow], furthest_m: float = math.inf) -> PosedPhoto:
    """A camera straight in front of panels, on their mean normal, that sees all of them; upright, but for roofs.

    Parameters
    ----------
    furthest_m
        From their middle; a nearer one has a wider field of view, up to `WIDEST_RAD`, for which it goes back further.
    """
    corners = np.array([panel.element.corners_enu_m for panel in panels]).reshape(-1, 4, 3)
    width, height = SIZE_PX
    focal_px = 0.5 * width / math.tan(0.5 * FIELD_RAD)
    lens = Intrinsics(width, height, focal_px, focal_px, 0.5 * width, 0.5 * height)
    if not len(corners):
        return PosedPhoto("", Path(), lens, Pose(np.zeros(3), _rotation(np.array([0.0, 1.0, 0.0]))))
    normal = outward(corners)
    # Panels all around a building have no side in common: look at them from the south.
    forward = np.array([0.0, 1.0, 0.0]) if normal is None else -normal
    rotation, middle = _rotation(forward), middle_of(corners)
    inside = (corners.reshape(-1, 3) - middle) @ rotation.T

    def enough_m(field_rad: float) -> float:
        tangents = math.tan(0.5 * field_rad) / ROOM * np.array([1.0, height / width])
        return max(LEAST_DISTANCE_M, float((np.abs(inside[:, :2]) / tangents - inside[:, 2:]).max()))

    usual_m = enough_m(FIELD_RAD)
    distance_m = min(usual_m, max(furthest_m, enough_m(WIDEST_RAD)))
    if distance_m < usual_m:
        needed = ROOM * np.abs(inside[:, :2] / (inside[:, 2:] + distance_m)).max(axis=0)
        focal_px = float(np.min(0.5 * np.array([width, height]) / needed))
        lens = replace(lens, fx_px=focal_px, fy_px=focal_px)
    return PosedPhoto("", Path(), lens, Pose(middle - distance_m * forward, rotation))


def _rotation(forward: Array) -> Array:
    """Camera axes (right, down, forward) as rows; north is up where it looks straight down."""
    up = np.array([0.0, 0.0, 1.0]) if abs(forward[2]) < 0.999 else np.array([0.0, 1.0, 0.0])
    right = np.cross(forward, up)
    right /= np.linalg.norm(right)
    return np.array([right, np.cross(forward, right), forward])

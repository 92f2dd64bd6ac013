"""What every reader returns: windows, building and neighbours in local ENU metres, and how they got there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.messages import first_few, say
from planning.geo.frames import Vec3
from planning.geo.mesh import TriangleMesh
from planning.site.importing.ground import Terrain
from planning.site.importing.placement import Placement

Array = NDArray[np.float64]

HOW_TO_GET_PANELS = (
    "panels come from the windows of a city model (level of detail 3), from IfcWindow and glazed IfcPlate of a BIM "
    "model, or from you: --panel-grid 'E,N,U E,N,U E,N,U' (lower left, lower right and upper left corner of a facade "
    "seen from outside, in the file's coordinates) --rows N --columns N; or import the building alone with "
    "--without-panels, and find them in photos with 'panels'"
)
"""What to do about a file without windows."""


MAX_NAMED = 8
"""Identifiers listed in a note."""


def left_out_notes(names: Sequence[str]) -> tuple[str, ...]:
    """What was left out of a file because it is broken, by identifier, as a note; none where nothing was."""
    if not names:
        return ()
    different = list(dict.fromkeys(name or say("without an identifier") for name in names))
    return (
        say(
            "left out, because they are broken (such as outlines of fewer than three points) or not read: {} ({})",
            len(names),
            first_few(different, MAX_NAMED),
        ),
    )


@dataclass(frozen=True, slots=True, eq=False)
class SourceWindow:
    """A window as it stands in the file.

    Parameters
    ----------
    source_id
        GlobalId, gml:id or the like.
    outline_enu_m
        Its outline in order, shape (k, 3), k >= 3, on the middle plane of the pane.
    thickness_m
        Of the pane: on either side, its face is half of this from the outline.
    is_oriented
        The outline turns counter-clockwise as seen from the side that the file calls outside; else in either sense.
    """

    source_id: str
    outline_enu_m: Array
    thickness_m: float = 0.0
    is_oriented: bool = False


@dataclass(frozen=True, slots=True)
class BuildingChoice:
    """One of the buildings in a file, for the user to choose from.

    Parameters
    ----------
    id
        What `ImportOptions.building` takes.
    name
        As the file has it; may be the identifier.
    n_windows
        Windows that could become panels.
    size_m
        Extent to the east, to the north and upwards, metres.
    """

    id: str
    name: str
    n_windows: int
    size_m: Vec3


@dataclass(frozen=True, slots=True, eq=False)
class SourceModel:
    """Content of an imported file.

    Parameters
    ----------
    name
        Of the building, as the file calls it; may be empty.
    windows
        All that could become panels.
    building
        The building, windows included.
    neighbours
        Other buildings near by.
    placement
        How file coordinates became local ones.
    repeats_panes
        The format may give one pane twice, as a window and as the plate that holds it; then only one becomes a panel.
    notes
        What the user should know about the reading.
    choices
        All buildings in the file, in its order; empty for formats that hold one.
    terrain
        Open ground in the file, which home stands on.
    question
        What has to be asked about the ground before this can become a site; empty where it is clear.
    """

    name: str
    windows: tuple[SourceWindow, ...]
    building: TriangleMesh
    neighbours: TriangleMesh
    placement: Placement
    repeats_panes: bool = False
    notes: tuple[str, ...] = ()
    choices: tuple[BuildingChoice, ...] = ()
    terrain: Terrain | None = None
    question: str = ""

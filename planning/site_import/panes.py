"""Windows to panels: four corners each, outdoors only, normals outwards."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.coverage.model import OCCLUSION_OFFSET_M
from planning.mesh import TriangleMesh
from planning.occlusion import line_of_sight
from planning.progress import Monitor
from planning.site import panel_triangles
from planning.site_import.duplicates import coincident_pairs, without_duplicates
from planning.site_import.openness import Sides, open_shares, turn_outwards
from planning.site_import.polygons import unit_normals
from planning.site_import.quads import fit_quad, start_lower_left
from planning.site_import.source import SourceModel, SourceWindow

Array = NDArray[np.float64]

OWN_REACH_M = 1.5
"""What hides a direction within this distance is the window's own frame, reveal or sill."""


MAX_NAMED = 3
"""Windows named in a note."""


@dataclass(frozen=True, slots=True, eq=False)
class Panes:
    """Panels to be, in the order of the file.

    Parameters
    ----------
    corners
        Shape (m, 4, 3), ENU metres, counter-clockwise from outside, lower left first.
    source_ids
        One for each.
    notes
        What was left out or changed, and how much of the open the panels see.
    """

    corners: Array
    source_ids: tuple[str, ...]
    notes: tuple[str, ...]


def panes_outdoors(source: SourceModel, monitor: Monitor) -> Panes:
    """Find the panels among the windows of a building."""
    monitor.report("fitting panels", 0, len(source.windows))
    quads = [fit_quad(window.outline_enu_m) for window in source.windows]
    fitted = [(window, quad) for window, quad in zip(source.windows, quads, strict=True) if quad is not None]
    notes = _counted("windows left out as slivers or without area", len(source.windows) - len(fitted))
    if not fitted:
        return Panes(np.zeros((0, 4, 3)), (), tuple(notes))
    windows = [window for window, _ in fitted]
    sides = _sides(windows, np.array([quad.corners for _, quad in fitted]), source.building, monitor)
    kept = np.flatnonzero(sides.is_outdoors)
    notes += _counted("windows left out as indoor ones, which see nothing of the open", len(windows) - len(kept))
    if source.repeats_panes:
        n_outdoors = len(kept)
        kept = kept[without_duplicates(sides.corners[kept])]
        notes += _counted("windows left out because another one shows the same pane", n_outdoors - len(kept))
    else:
        pairs = [(windows[kept[i]], windows[kept[j]]) for i, j in coincident_pairs(sides.corners[kept])]
        twice = [f"{first.source_id} = {second.source_id}" for first, second in pairs]
        notes += _counted("windows that lie exactly on others, where both stay", len(twice), twice)
    odd = [windows[i].source_id for i in kept if not fitted[i][1].is_exact]
    notes += _counted("windows that are no quads, for which a rectangle of the same area stands in", len(odd), odd)
    against = [windows[i].source_id for i in kept if sides.is_turned[i]]
    notes += _counted("windows that the file has facing into the building, turned around", len(against), against)
    n_undecided = int((~sides.is_decided[kept]).sum())
    notes += _counted("windows open on both sides, taken to face away from the building", n_undecided)
    corners = np.array([start_lower_left(quad) for quad in sides.corners[kept]]).reshape(-1, 4, 3)
    if len(corners):
        notes.append(_view(corners, sides.open_share[kept], source.building))
    return Panes(corners, tuple(windows[i].source_id for i in kept), tuple(notes))


def _sides(windows: list[SourceWindow], corners: Array, building: TriangleMesh, monitor: Monitor) -> Sides:
    triangles = np.concatenate([building.corners_enu_m, panel_triangles(corners)])
    middle = 0.5 * (triangles.min(axis=(0, 1)) + triangles.max(axis=(0, 1)))
    monitor.report("looking outdoors", 0, 1)
    thickness_m = np.array([window.thickness_m for window in windows])
    is_oriented = np.array([window.is_oriented for window in windows])
    return turn_outwards(corners, thickness_m, middle, line_of_sight(triangles), is_oriented)


def _view(corners: Array, open_share: Array, building: TriangleMesh) -> str:
    """How much of their hemispheres the panels see, as a note."""
    normals = unit_normals(corners)
    targets = corners.mean(axis=1) + OCCLUSION_OFFSET_M * normals
    own = 1.0 - open_shares(targets, normals, line_of_sight(building.corners_enu_m), OWN_REACH_M)
    return (
        f"{OCCLUSION_OFFSET_M:g} m in front of the panels the building hides "
        f"{100.0 * (1.0 - open_share.mean()):.0f} % of the directions (worst panel "
        f"{100.0 * (1.0 - open_share.min()):.0f} %); their own frames and reveals hide {100.0 * own.mean():.0f} % "
        f"(worst {100.0 * own.max():.0f} %)"
    )


def _counted(what: str, n: int, names: Sequence[str] = ()) -> list[str]:
    """A note with a count and the first few names; none where there is nothing to count."""
    if n == 0:
        return []
    more = ", ..." if len(names) > MAX_NAMED else ""
    return [f"{what}: {n}" + (f" ({', '.join(names[:MAX_NAMED])}{more})" if names else "")]

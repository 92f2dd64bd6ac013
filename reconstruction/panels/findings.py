"""What a user should know of a solved facade."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from planning.findings import Finding, Severity
from reconstruction.cameras import PosedPhoto
from reconstruction.panels.association import TOGETHER
from reconstruction.panels.record import SolvedFacade, SurfaceLine
from reconstruction.panels.solve import REACH_SIGMAS, reach_m

REPEATS = 0.7
"""Share of lines that lie on others after a step, from which on a grid looks the same one panel further."""

MOST_PANELS = 3
"""In a step: alternating widths repeat after two."""


def facade_findings(facade: SolvedFacade, photos: Sequence[PosedPhoto]) -> list[Finding]:
    """Everything worth saying of a facade; `photos` are counted as in its `pose_changes`."""
    return [*reduced_panels(facade), *photos_a_panel_apart(facade, photos)]


def reduced_panels(facade: SolvedFacade) -> list[Finding]:
    """What is said of panels whose shape a site cannot hold."""
    outlines = [panel.outline_enu_m for panel in facade.panels if panel.outline_enu_m is not None]
    many = [outline for outline in outlines if len(outline) > 4]
    if not many:
        return []
    text = (
        f"{len(many)} of {len(facade.panels)} panels have more than four corners; a site's panels have four, so that "
        "the largest four-cornered part of each is kept"
    )
    return [Finding(Severity.NOTE, "panels-with-more-corners", text, facade.id, float(len(many)))]


def photos_a_panel_apart(facade: SolvedFacade, photos: Sequence[PosedPhoto]) -> list[Finding]:
    """A warning where photos may have been matched a panel apart.

    A regular grid looks the same one panel further, so that poses must tell which panel is which: to half a panel.
    """
    steps = [step for lines in (facade.columns, facade.rows) if (step := repeated_step_m(lines)) is not None]
    sigmas = [reach_m(photos[number], facade.surface) / REACH_SIGMAS for number in facade.pose_changes]
    if not steps or max(sigmas, default=0.0) <= 0.5 * min(steps):
        return []
    text = (
        f"panels repeat every {min(steps):.2f} m, and a photo may lie {max(sigmas):.2f} m off (one standard "
        "deviation), so that the facade may stand a panel off, or photos were matched a panel apart; refine the poses, "
        "or compare with a measured corner"
    )
    return [Finding(Severity.WARNING, "photos-a-panel-apart", text, facade.id, max(sigmas))]


def repeated_step_m(lines: Sequence[SurfaceLine]) -> float | None:
    """The shortest step, of one to three panels, that leads from lines to lines; None in grids that do not repeat."""
    places = np.sort([line.position_m for line in lines])
    if len(places) < 3:
        return None
    tolerance = TOGETHER * float(np.diff(places).min())
    for n_panels in range(1, min(MOST_PANELS, len(places) - 2) + 1):
        step = float(np.median(places[n_panels:] - places[:-n_panels]))
        off = np.abs(places[:-n_panels, None] + step - places[None, :]).min(axis=1)
        if float(np.mean(off <= tolerance)) >= REPEATS:
            return step
    return None

"""A made building and the photos of a flight along its facade, for pictures of the window: all of it rendered here."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.geo.frames import Origin
from planning.geo.mesh import box_mesh, write_mesh
from planning.site.file import write_site
from planning.site.records import Airspace, Facade, Panel, Site
from reconstruction.scenes.facades.cases import photo_of, wide_camera
from reconstruction.scenes.facades.record import Case, Disturbances, Layout, SyntheticFacade, TruePanel, Wall
from reconstruction.scenes.facades.render import render_facade, write_photos

ORIGIN = Origin(22.3372, 114.2636, 62.0)
WALL = Wall((0.0, 0.0, 0.5))
LAYOUT = Layout(
    n_rows=5, n_columns=11, panel_width_m=1.5, panel_height_m=2.4, widths="alternating", top="gable", n_sloped_rows=2
)
DISTURBED = Disturbances(reflection=0.4, tilt_deg=0.3, blinds=0.15, clutter=True, blur_px=0.5, noise_grey=2.0)
SEED = 7

DIRECTIONS_DEG = ((0.0, 4.0), (-14.0, -4.0), (16.0, 8.0), (-30.0, 0.0), (34.0, 6.0), (-44.0, 10.0))
"""From where the photos are taken: to the side against the facade's normal, and how far the camera looks up."""

PHOTO_PX = (1280, 960)
"""The search takes seconds at this size, and the grid can be seen."""

BUILDING_DEPTH_M, BORDER_M = 9.0, 0.4


def write_synthetic_flight(folder: Path, monitor: Monitor = QUIET) -> tuple[Path, Path]:
    """Write a site file and a folder of photos; returns both paths.

    The site has the building and its rectangular panels, as somebody may have drawn them before the flight.

    Raises
    ------
    InputError
        The folder cannot be written.
    """
    facades = []
    for number, (aside_deg, up_deg) in enumerate(DIRECTIONS_DEG):
        monitor.report(say("rendering"), number, len(DIRECTIONS_DEG))
        photo = photo_of(WALL, LAYOUT, wide_camera(*PHOTO_PX), seed=SEED, oblique_deg=aside_deg, from_below_deg=up_deg)
        facades.append(render_facade(Case("made", LAYOUT, WALL, photo, DISTURBED, seed=SEED)))
    write_photos(folder / "photos", [(one.photo, one.image) for one in facades], ORIGIN)
    site = folder / "made.site.json"
    write_site(site, _site(folder, facades[0]))
    return site, folder / "photos"


def _site(folder: Path, facade: SyntheticFacade) -> Site:
    """The site, with its building mesh written beside it."""
    corners = np.concatenate([panel.corners_enu_m for panel in facade.panels])
    low, high = corners.min(axis=0), corners.max(axis=0)
    front = np.array([low[0] - BORDER_M, low[1], 0.0])
    back = np.array([high[0] + BORDER_M, low[1] + BUILDING_DEPTH_M, high[2] + BORDER_M])
    write_mesh(folder / "made.ply", box_mesh(front, back))
    return Site(
        name="made",
        origin=ORIGIN,
        facades=(Facade("A", tuple(_panel(panel) for panel in facade.panels if len(panel.corners_enu_m) == 4)),),
        airspace=Airspace((-60.0, -60.0, 1.0), (60.0, 40.0, 50.0), 0.0),
        home_enu_m=(-30.0, -40.0, 0.0),
        building_mesh="made.ply",
    )


def _panel(panel: TruePanel) -> Panel:
    a, b, c, d = ((float(x), float(y), float(z)) for x, y, z in panel.corners_enu_m)
    return Panel(f"A-{panel.row + 1:02d}-{panel.column + 1:02d}", (a, b, c, d))

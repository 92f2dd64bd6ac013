"""From a photo to its panels: by the lines of profiles, by the network for panes, or by what the scene calls for."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Assessment, Decision, decide
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.site.importing.facades import facade_name
from reconstruction.panels.network.confidence import LEAST_BELIEVED, SAME, find_panes
from reconstruction.panels.network.grids import grid_in_view, network_facades
from reconstruction.panels.network.predictions import LONG_SIDES_PX, FoundPanes, PhotoPrediction, predict_photo
from reconstruction.panels.network.sides import measured
from reconstruction.panels.network.votes import LEAST_SIDE_PX, Pane
from reconstruction.panels.rectify.surface import Rectification
from reconstruction.panels.search.parameters import SegmentationParameters
from reconstruction.panels.search.record import FacadeGrid, Segmentation
from reconstruction.panels.search.segment import grid_by_lines, views_without_pose
from reconstruction.panels.search.views import WholePicture, checked_image, grey

Array = NDArray[np.float64]

NO_GLASS, GLASS = 0.3, 0.6
"""Probability that a place lies on a pane below which a panel there is doubted, and from which a panel is missed."""

LEAST_DISAGREEMENT = 64
"""Places along either side of the photo at which panels may be missed."""

LEAST_GLASS = 0.01
"""Of these places that must be glass for any to be missed."""

FIRST_LOOK_PX = 486
"""Size in which a photo is looked at to decide; in full only where the network is on: it takes five times as long."""

SURE, LEAST_SURE = 0.75, 8
"""Confidence of panes at the first look from which on they are compared with panels, and their number, at least."""

MOST_OTHERS = 0.5
"""Share of these panes that are no panels, up to which panels are believed: on synthetic facades up to 0.17.

And share of the glass that no panel covers, up to which these panes say whether anything is missed: what lies around a
wall whose extent is not known is taken for glass, too, but not for panes.
"""

INNER = np.array([[0.5, 0.5], [0.25, 0.25], [0.75, 0.25], [0.75, 0.75], [0.25, 0.75]])
"""Places on a panel at which the network is asked, as shares of its sides."""


@dataclass(frozen=True, slots=True, eq=False)
class _Compared:
    """Panels between lines, and what the network says of the part of the same photo that shows their facade."""

    grids: Sequence[FacadeGrid]
    predictions: PhotoPrediction
    view: Rectification
    size_px: tuple[int, int]
    seconds: float


@dataclass(frozen=True, slots=True)
class NetworkForPanes:
    """The effect: panes by the network, where it contradicts the lines.

    Lines measure a curtain wall's grid to a fraction of a pixel, and take anything straight for a grid. The network
    tells glass from what is none, in close-ups, clutter and white light, and measures coarsely.
    """

    name: str = say("network for panes")
    unit: str = say("of panels or of glass")
    tolerance: float = 0.22

    def assess(self, scene: _Compared) -> Assessment:
        """The largest share: of panels where the network sees no glass, of its glass without panels, of other panes.

        Panes are looked for only where the first two neither suffice nor say nothing. Where most of them are panels,
        glass beside these is no reason.
        """
        no_glass, no_panel = disagreement_with_network(scene.grids, scene.predictions, scene.view, scene.size_px)
        panels, others = [panel.corners_px for grid in scene.grids for panel in grid.panels], None
        if no_glass <= self.tolerance and 0.0 < max(no_glass, no_panel) <= MOST_OTHERS:
            others = other_panes(panels, find_panes(scene.predictions).within(scene.view).panes)
        if others is not None and (others > MOST_OTHERS or others <= self.tolerance):
            reason = say(
                "the network sees no glass on {:.0f} % of {} panels, and {:.0f} % of its panes are none of them",
                *(100.0 * no_glass, len(panels), 100.0 * others),
            )
            return Assessment(max(no_glass, others), reason, scene.seconds)
        reason = say(
            "the network sees no glass on {:.0f} % of {} panels, and {:.0f} % of its glass lies outside them",
            *(100.0 * no_glass, len(panels), 100.0 * no_panel),
        )
        return Assessment(max(no_glass, no_panel), reason, scene.seconds)


def disagreement_with_network(
    grids: Sequence[FacadeGrid], predictions: PhotoPrediction, view: Rectification, size_px: tuple[int, int]
) -> tuple[float, float]:
    """Share of panels on which the network sees no glass, and share of the glass it sees that no panel covers.

    Both are 0 where panels are too small to show in the sizes that were looked at: there the network tells nothing.

    Parameters
    ----------
    view
        Part of the photo that counts.
    size_px
        Width and height of the photo.
    """
    panels = [panel for grid in grids for panel in grid.panels]
    no_glass = 0.0
    if panels:
        scale = max((look.scale for look in predictions.by_size.values()), default=0.0)
        sides = [float(np.sqrt(cv2.contourArea(panel.corners_px.astype(np.float32)))) for panel in panels]
        if np.median(sides) * scale < LEAST_SIDE_PX:
            return 0.0, 0.0
        places_px = np.concatenate([_inner(panel.corners_px) for panel in panels])
        probabilities = predictions.probability_at(places_px).reshape(len(panels), len(INNER)).mean(axis=1)
        no_glass = float((probabilities < NO_GLASS).mean())
    share = (np.arange(LEAST_DISAGREEMENT) + 0.5) / LEAST_DISAGREEMENT
    x, y = (each.ravel() for each in np.meshgrid(share * view.width_px, share * view.height_px))
    places = view.to_photo(np.column_stack([x, y]))
    seen = np.isfinite(places).all(axis=1) & (places >= 0.0).all(axis=1) & (places < size_px).all(axis=1)
    places = places[seen]
    glass = places[predictions.probability_at(places) > GLASS] if len(places) else places
    if len(glass) < LEAST_GLASS * LEAST_DISAGREEMENT**2:
        return no_glass, 0.0
    covered = np.zeros(len(glass), bool)
    for grid in grids:
        if len(grid.rows) > 1 and len(grid.columns) > 1:
            at = grid.rectification.to_rectified(glass)
            low = np.array([grid.columns[0].position_px, grid.rows[0].position_px])
            high = np.array([grid.columns[-1].position_px, grid.rows[-1].position_px])
            covered |= ((at >= low) & (at <= high)).all(axis=1)
    return no_glass, float(1.0 - covered.mean())


def other_panes(panels_px: Sequence[Array], panes: Sequence[Pane]) -> float | None:
    """Share of panes that the network is sure of and that are none of the panels; None where these panes are too few.

    Lines that divide a wall with windows into wrong cells lie on glass often enough; their cells are no panes. Next to
    panels that have not four corners the network says nothing: it knows no others.

    Parameters
    ----------
    panels_px
        Corners of each panel, convex, shape (k, 2).
    """
    sure = [pane.corners_px for pane in panes if pane.confidence >= SURE]
    if len(sure) < LEAST_SURE:
        return None
    low, high = (np.array([end(each, axis=0) for each in panels_px]).reshape(-1, 2) for end in (np.min, np.max))
    n_others = 0
    for quad in sure:
        near = np.flatnonzero((low < quad.max(axis=0)).all(axis=1) & (high > quad.min(axis=0)).all(axis=1))
        n_others += not any(len(panels_px[k]) != 4 or _iou(quad, panels_px[k]) > SAME for k in near.tolist())
    return n_others / len(sure)


def _iou(one: Array, other: Array) -> float:
    """Intersection over union of convex polygons."""
    one, other = one.astype(np.float32), other.astype(np.float32)
    shared = float(cv2.intersectConvexConvex(one, other)[0])
    return shared / max(float(cv2.contourArea(one)) + float(cv2.contourArea(other)) - shared, 1e-9)


def _inner(corners_px: Array) -> Array:
    """Places on a panel, shape (5, 2)."""
    quad = corners_px if len(corners_px) == 4 else corners_px[np.linspace(0, len(corners_px) - 1, 4).astype(int)]
    s, t = INNER[:, :1], INNER[:, 1:]
    a, b, c, d = quad
    return np.asarray((1 - s) * (1 - t) * a + s * (1 - t) * b + s * t * c + (1 - s) * t * d)


def segment_image(
    image: NDArray[Any],
    rectifications: Sequence[Rectification] | None = None,
    parameters: SegmentationParameters | None = None,
    monitor: Monitor = QUIET,
    name: str = "",
) -> Segmentation:
    """Find the panels of all facades in a photo.

    Parameters
    ----------
    image
        Shape (h, w) or (h, w, 3), 8 bit.
    rectifications
        One view for each facade; None where no pose is known: they are found from vanishing points.
    name
        Of the photo, for the record.

    Raises
    ------
    InputError
        Not such a picture.
    """
    parameters = parameters or SegmentationParameters()
    checked = checked_image(image)
    height, width = checked.shape[:2]
    network = None if parameters.network == "off" else _Network(checked, parameters, monitor)
    if rectifications is not None:
        facades = []
        for number, view in enumerate(rectifications):
            monitor.report(say("find facades"), number, len(rectifications))
            facades.append(_in_view(checked, view, parameters, monitor, facade_name(number), network))
        return Segmentation(name, width, height, tuple(facades))
    by_lines: tuple[FacadeGrid, ...] = ()
    if parameters.network != "on":
        monitor.report(say("find vanishing points"), 0, 1)
        views = views_without_pose(grey(checked), parameters.max_tilt_deg, parameters.long_side_px, parameters.seed)
        by_lines = tuple(
            grid_by_lines(checked, view, parameters, monitor, facade_name(number)) for number, view in enumerate(views)
        )
    if network is None:
        return Segmentation(name, width, height, by_lines)
    decision = network.decide(by_lines, WholePicture(width, height))
    chosen = network_facades(network.full, width, height, parameters.seed) if decision.on else by_lines
    return Segmentation(name, width, height, tuple(replace(grid, network=decision) for grid in chosen))


def segment_rectified(
    picture: NDArray[Any], parameters: SegmentationParameters | None = None, monitor: Monitor = QUIET
) -> FacadeGrid:
    """Find the panels of one facade in a picture whose rows and columns run along the grid's lines.

    Raises
    ------
    InputError
        Not a picture of shape (h, w) or (h, w, 3) and 8 bit.
    """
    checked = checked_image(picture)
    view = WholePicture(checked.shape[1], checked.shape[0])
    return segment_view(checked, view, parameters or SegmentationParameters(), monitor, "A")


def segment_view(
    image: NDArray[np.uint8],
    view: Rectification,
    parameters: SegmentationParameters,
    monitor: Monitor,
    facade_id: str,
) -> FacadeGrid:
    """Find the panels of one facade through its rectified view."""
    network = None if parameters.network == "off" else _Network(image, parameters, monitor)
    return _in_view(image, view, parameters, monitor, facade_id, network)


class _Network:
    """The network before one photo: what it says at a first look, and, once somebody asks for it, in full.

    `seconds` is what a full look costs.
    """

    def __init__(self, image: NDArray[np.uint8], parameters: SegmentationParameters, monitor: Monitor) -> None:
        colour = image if image.ndim == 3 else np.asarray(cv2.cvtColor(image, cv2.COLOR_GRAY2BGR), np.uint8)
        self._image, self._parameters, self._monitor = colour, parameters, monitor
        full_px = min(parameters.long_side_px, LONG_SIDES_PX[-1], max(image.shape[:2]))
        looked_px = full_px if parameters.network == "on" else min(FIRST_LOOK_PX, full_px)
        started = time.perf_counter()
        self.first = predict_photo(colour, looked_px, monitor=monitor)
        self.seconds = (full_px / looked_px) ** 2 * (time.perf_counter() - started)

    @cached_property
    def full(self) -> FoundPanes:
        found = find_panes(predict_photo(self._image, self._parameters.long_side_px, self.first, self._monitor))
        believed = [pane for pane in found.panes if pane.confidence >= LEAST_BELIEVED]
        return replace(found, panes=tuple(measured(believed, self._image)))

    def decide(self, grids: Sequence[FacadeGrid], view: Rectification) -> Decision:
        """Whether its panes are taken in place of these grids, in the part of the photo that a view shows."""
        size = self._image.shape[1], self._image.shape[0]
        compared = _Compared(grids, self.first, view, size, self.seconds)
        return decide(NetworkForPanes(), compared, self._parameters.network)


def _in_view(
    image: NDArray[np.uint8],
    view: Rectification,
    parameters: SegmentationParameters,
    monitor: Monitor,
    facade_id: str,
    network: _Network | None,
) -> FacadeGrid:
    by_lines: tuple[FacadeGrid, ...] = ()
    if parameters.network != "on":
        by_lines = (grid_by_lines(image, view, parameters, monitor, facade_id),)
    if network is None:
        return by_lines[0]
    decision = network.decide(by_lines, view)
    size = image.shape[1], image.shape[0]
    grid = grid_in_view(network.full.within(view), view, facade_id, size) if decision.on else by_lines[0]
    return replace(grid, network=decision)

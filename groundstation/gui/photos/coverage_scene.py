"""The site in 3-D with its panels coloured by what the photos show, and the photos where they were taken."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QCoreApplication, Qt, Signal
from PySide6.QtGui import QHideEvent, QShowEvent
from PySide6.QtWidgets import QLabel, QVBoxLayout, QWidget

from groundstation.gui.view3d.layers import ON_TOP, Drawable
from groundstation.gui.view3d.orbit import Orbit
from groundstation.gui.view3d.paint import ColourScale, flat
from groundstation.gui.view3d.scene_view import SceneView
from groundstation.gui.widgets.theme import colours
from groundstation.services.photos.intake import PhotoCoverage
from groundstation.services.project.document import Item, ItemKind
from groundstation.services.units import UnitSystem
from planning.site.records import SiteModel

Array = NDArray[np.float64]

PLACES, RAYS = "photo-places", "photo-rays"
"""Names of what is drawn on the canvas."""

PLACE_PX, SEEING_PX, RAY_PX = 7.0, 11.0, 1.5


class CoverageScene(QWidget):
    """Draws what it gets. The 3-D view in it exists only while it is seen: it holds memory and an OpenGL context.

    Signals
    -------
    picked(Item or None)
        What was clicked.
    """

    picked = Signal(object)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._scene: SceneView | None = None
        self._site: SiteModel | None = None
        self._coverage: PhotoCoverage | None = None
        self._panel_id: str | None = None
        self._orbit: Orbit | None = None
        self._units = UnitSystem.METRIC
        self._may_open = False
        self._text = QLabel(alignment=Qt.AlignmentFlag.AlignCenter, wordWrap=True)
        self._text.setProperty("role", "muted")
        self._layout = QVBoxLayout(self)
        self._layout.setContentsMargins(0, 0, 0, 0)
        self._layout.addWidget(self._text)

    def set_coverage(self, site: SiteModel | None, coverage: PhotoCoverage | None, text: str) -> None:
        """Show a site and what photos show of it; `text` stands above it, or alone where there is nothing to show."""
        before, is_same = self._site, site is self._site and coverage is self._coverage
        self._site, self._coverage = site, coverage
        self._text.setText(text)
        self._text.setVisible(bool(text))
        is_edited = site is not None and before is not None and site.site.name == before.site.name
        if site is not before and not is_edited:
            self._orbit = None
        if site is not before and self._scene is not None:
            self._scene.set_site(site, keep_camera=is_edited)
        if not is_same:
            self._paint()

    def set_panel(self, panel_id: str | None) -> None:
        """Show which photos see a panel."""
        self._panel_id = panel_id
        self._paint()

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        self._units = units
        if self._scene is not None:
            self._scene.set_units(units)

    def scene(self) -> SceneView | None:
        """The 3-D view; None while it is not seen."""
        return self._scene

    def let_open(self) -> None:
        """From now on the view may be made.

        With the first one of a window Qt makes the whole window anew, which is left to the view that all tabs share.
        """
        self._may_open = True
        if self.isVisible():
            self._open()

    def showEvent(self, event: QShowEvent) -> None:  # noqa: N802
        """Make the view."""
        super().showEvent(event)
        if self._may_open:
            self._open()

    def hideEvent(self, event: QHideEvent) -> None:  # noqa: N802
        """Free the view, unless only the window was minimised."""
        super().hideEvent(event)
        if self._scene is not None and not event.spontaneous():
            self._orbit = self._scene.orbit()
            self._scene.close_view()
            self._layout.removeWidget(self._scene)
            self._scene.deleteLater()
            self._scene = None

    def _open(self) -> None:
        if self._scene is not None:
            return
        scene = self._scene = SceneView(self)
        self._layout.addWidget(scene, 1)
        scene.set_units(self._units)
        scene.picked.connect(lambda item, _modifiers: self.picked.emit(item))
        scene.set_site(self._site)
        self._paint()
        orbit = self._first_orbit(scene) if self._orbit is None else self._orbit
        if orbit is not None:
            scene.set_orbit(orbit)

    def _first_orbit(self, scene: SceneView) -> Orbit | None:
        """Panels and photos fill the view: the airspace around them is of no interest here."""
        coverage = self._coverage
        if coverage is None:
            return None
        places = _places([photo.pose.position_enu_m for photo in coverage.photos])
        points = np.concatenate([places, coverage.frames.corners.reshape(-1, 3)])
        return scene.orbit().fitted(points, max(1, self.width()) / max(1, self.height())) if len(points) else None

    def _paint(self) -> None:
        scene, coverage = self._scene, self._coverage
        if scene is None:
            return
        scene.set_selection(() if self._panel_id is None else (Item(ItemKind.PANEL, self._panel_id),))
        if coverage is None:
            scene.set_panel_values(None)
            scene.canvas().draw(PLACES, ())
            scene.canvas().draw(RAYS, ())
            return
        scene.set_panel_values(*panel_values(coverage))
        number = None if self._panel_id is None else coverage.number(self._panel_id)
        seeing = () if number is None else coverage.sightings(number)
        places = _places([photo.pose.position_enu_m for photo in coverage.photos])
        seen_from = _places([one.photo.pose.position_enu_m for one in seeing])
        look = colours()
        scene.canvas().draw(PLACES, [_dots(places, look.muted, PLACE_PX), _dots(seen_from, look.accent, SEEING_PX)])
        scene.canvas().draw(RAYS, () if number is None else [_rays(seen_from, coverage.frames.centroids[number])])


def panel_values(coverage: PhotoCoverage) -> tuple[ColourScale, Array]:
    """How panels are coloured: by the promise that was kept, without a plan by the number of sections seen."""
    if coverage.has_promise:
        title = QCoreApplication.translate("CoverageScene", "Seen of what the plan promised")
        return ColourScale(title, "%", 0.0, 100.0), 100.0 * coverage.kept_promise()
    seen = coverage.seen_per_panel.astype(np.float64)
    title = QCoreApplication.translate("CoverageScene", "Sections that photos show")
    return ColourScale(title, "", 0.0, float(max(1.0, seen.max(initial=0.0)))), seen


def _places(positions: list[Array]) -> Array:
    return np.array(positions, np.float64).reshape(-1, 3)


def _dots(places: Array, colour: str, width_px: float) -> Drawable:
    cells = np.arange(len(places))[:, None]
    return Drawable(places, cells, flat(colour, len(places)), width_px=width_px, depth_shift=ON_TOP)


def _rays(places: Array, middle: Array) -> Drawable:
    """Lines from photos to the panel that they show."""
    ends = np.column_stack([np.zeros(len(places), np.int64), 1 + np.arange(len(places))])
    points = np.vstack([middle[None], places])
    return Drawable(points, ends, flat(colours().accent, len(ends)), width_px=RAY_PX, depth_shift=ON_TOP)

"""All that the Photos tab shows of coverage: the line of words, the site in 3-D, and the chosen panel's hemisphere."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QCoreApplication, QObject, Qt, Signal
from PySide6.QtGui import QHideEvent, QShowEvent
from PySide6.QtWidgets import QLabel, QListWidget, QListWidgetItem, QVBoxLayout, QWidget

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.charts.hemisphere_view import HemisphereView, ShownSection
from groundstation.gui.photos.photos_controller import PhotosController
from groundstation.gui.view3d.drawables import ON_TOP, Drawable
from groundstation.gui.view3d.orbit import Orbit
from groundstation.gui.view3d.paint import ColourScale, flat
from groundstation.gui.view3d.scene_view import SceneView
from groundstation.gui.widgets.theme import colours
from groundstation.services.photos.intake import PhotoCoverage
from groundstation.services.project.document import Item, ItemKind
from groundstation.services.units import UnitSystem, per_cent
from planning.insight.sections import SectionState
from planning.site.records import SiteModel

# The site in 3-D with its panels coloured by what the photos show, and the photos where they were taken.

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

    def allow_opening(self) -> None:
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


# One panel as the photos show it: its hemisphere, the sections that are missing, and the photos that see it.

MAX_NAMED = 6
"""Missing sections that are named; the hemisphere shows them all."""


class PanelSightings(QWidget):
    """Draws what it gets of one panel.

    Signals
    -------
    photoPicked(str)
        Path of a photo in the list.
    """

    photoPicked = Signal(str)  # noqa: N815  (Qt's own way of naming)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._coverage: PhotoCoverage | None = None
        self._panel_id: str | None = None
        self._section: int | None = None
        self._title, self._words = QLabel(), QLabel(wordWrap=True)
        self._title.setProperty("role", "heading")
        self._hemisphere = HemisphereView()
        self.photos = QListWidget()
        self.photos.setAccessibleName(self.tr("Photos that show the panel"))
        self.photos.setMinimumHeight(60)
        self.photos.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 4, 0, 0)
        for widget, stretch in ((self._title, 0), (self._words, 0), (self._hemisphere, 3), (self.photos, 2)):
            layout.addWidget(widget, stretch)
        self._hemisphere.sectionPicked.connect(self.pick_section)
        self.photos.itemClicked.connect(self._pick_photo)
        self.photos.itemActivated.connect(self._pick_photo)
        self._show()

    def set_coverage(self, coverage: PhotoCoverage | None) -> None:
        """Show the panel as other photos see it."""
        if coverage is not self._coverage:
            self._coverage, self._section = coverage, None
            self._show()

    def set_panel(self, panel_id: str | None) -> None:
        """Show another panel; None for none."""
        if panel_id != self._panel_id:
            self._panel_id, self._section = panel_id, None
            self._show()

    def pick_section(self, section: int | None) -> None:
        """List the photos that show one section; all of the panel's where it is picked again."""
        self._section = None if section == self._section else section
        self._show()

    def text(self) -> str:
        """Everything that is said."""
        return f"{self._title.text()}\n{self._words.text()}"

    def _pick_photo(self, row: QListWidgetItem) -> None:
        self.photoPicked.emit(row.data(Qt.ItemDataRole.UserRole))

    def _show(self) -> None:
        coverage = self._coverage
        panel = None if coverage is None or self._panel_id is None else coverage.number(self._panel_id)
        self.photos.clear()
        if coverage is None or panel is None:
            self._title.setText(self.tr("No panel selected"))
            self._words.setText(self.tr("Click a panel in 3-D to see which photos show it."))
            self._hemisphere.set_sections(30.0, ())
            return
        self._title.setText(self.tr("Panel {0}").format(self._panel_id))
        self._words.setText(self._words_of(coverage, panel))
        sections = tuple(
            self._shown(coverage, panel, section, state) for section, state in enumerate(coverage.states(panel))
        )
        self._hemisphere.set_sections(coverage.grid.step_deg, sections)
        self._hemisphere.set_marks(coverage.directions_deg(panel))
        self._hemisphere.set_picked(self._section)
        for sighting in coverage.sightings(panel, self._section):
            row = QListWidgetItem(self.tr("section {0}: {1}").format(sighting.section, sighting.photo.path.name))
            row.setData(Qt.ItemDataRole.UserRole, str(sighting.photo.path))
            self.photos.addItem(row)

    def _words_of(self, coverage: PhotoCoverage, panel: int) -> str:
        n_photos, n_seen = len(coverage.sightings(panel)), int(coverage.seen_per_panel[panel])
        lines = [self.tr("Photos that show it: {0}; sections: {1}").format(n_photos, n_seen)]
        missing = coverage.missing(panel).tolist()
        named = ", ".join(str(section) for section in missing[:MAX_NAMED]) + (" …" if len(missing) > MAX_NAMED else "")
        if not coverage.has_promise:
            lines.append(self.tr("Sections that no photo shows: {0}").format(len(missing)))
        elif missing:
            lines.append(self.tr("Promised and on no photo: {0} ({1})").format(len(missing), named))
        else:
            lines.append(self.tr("Everything that the plan promised is on photos."))
        if self._section is not None:
            lines.append(
                self.tr("Only photos of section {0} are listed; press it again for all.").format(self._section)
            )
        return "\n".join(lines)

    def _shown(self, coverage: PhotoCoverage, panel: int, section: int, state: SectionState) -> ShownSection:
        count = int(coverage.achieved.counts[panel, section])
        texts = {
            SectionState.COVERED: self.tr("photos that show it: {0}").format(count),
            SectionState.MISSED: self.tr("promised by the plan, but on no photo"),
            SectionState.UNDECIDED: self.tr("on no photo"),
        }
        return ShownSection(state, count, self.tr("section {0}: {1}").format(section, texts[state]))


class CoverageDisplay(QObject):
    """Brings coverage to the widgets that show it, and has it counted while the tab is in front."""

    def __init__(
        self,
        context: ApplicationContext,
        controller: PhotosController,
        scene: CoverageScene,
        panel: PanelSightings,
        parent: QObject,
    ) -> None:
        super().__init__(parent)
        self._context, self._controller, self._scene, self._panel = context, controller, scene, panel
        self._is_in_front = False
        scene.picked.connect(context.select)
        controller.stateChanged.connect(self.shortest_covering_flight)
        controller.photosChanged.connect(self.shortest_covering_flight)
        controller.coverageChanged.connect(self.shortest_covering_flight)
        context.selectionChanged.connect(self._select)
        context.unitsChanged.connect(self._set_units)
        self._set_units(context.units)
        self._select(context.selection)
        self.shortest_covering_flight()

    def set_in_front(self, is_in_front: bool) -> None:
        """Whether the tab is: coverage of other panels is counted when it is looked at."""
        self._is_in_front = is_in_front
        self.shortest_covering_flight()

    def shortest_covering_flight(self) -> None:
        """Bring everything up to date."""
        if self._is_in_front:
            self._controller.count()
        coverage = self._controller.coverage
        self._panel.set_coverage(coverage)
        self._scene.set_coverage(self._context.document.site, coverage, self._why_nothing())

    def words(self) -> str:
        """How much the photos show; empty before photos are read."""
        intake = self._controller.intake
        if intake is None:
            return ""
        why_nothing = self._why_nothing()
        n_photos = self.tr("{0} photos, {1} of them usable.").format(len(intake.metadata), sum(intake.usable))
        found = intake.coverage
        if why_nothing or found is None:
            return f"{n_photos} {why_nothing}"
        if found.planned_counts is None:
            seen = self.tr("They show {0} of {1} sections.").format(found.covered, found.counts.size)
        else:
            promised = int((found.planned_counts > 0).sum())
            share = per_cent(promised - int(found.missed.sum()), promised) if promised else 100.0
            seen = self.tr("They show {0} sections; the plan promised {1}, of which {2:.1f} % are seen.").format(
                found.covered, promised, share
            )
        return f"{n_photos} {seen}"

    def _why_nothing(self) -> str:
        """Why no coverage is shown; empty where it is."""
        model = self._context.document.site
        if model is None:
            return self.tr("Open or import a site first: photos are placed on it.")
        if self._controller.intake is None:
            return self.tr("Read the photos of the flight.")
        if model.site.n_panels == 0:
            return self.tr("The site has no panels yet: find them in these photos.")
        if not self._controller.is_coverage_current:
            return self.tr("The panels or the plan are others now; what the photos show is counted again.")
        return ""

    def _select(self, item: Item | None) -> None:
        panel_id = item.id if item is not None and item.kind is ItemKind.PANEL else None
        self._panel.set_panel(panel_id)
        self._scene.set_panel(panel_id)

    def _set_units(self, units: UnitSystem) -> None:
        self._scene.set_units(units)

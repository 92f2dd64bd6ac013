"""Keeps all that the Photos tab shows of coverage up to date: the line of words, the 3-D view, the chosen panel."""

from __future__ import annotations

from PySide6.QtCore import QObject

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.photos.coverage_scene import CoverageScene
from groundstation.gui.photos.panel_sightings import PanelSightings
from groundstation.gui.photos.photos_controller import PhotosController
from groundstation.services.project.document import Item, ItemKind
from groundstation.services.units import UnitSystem, per_cent


class CoverageShown(QObject):
    """Brings coverage to the widgets that show it, and has it counted while the tab is in front."""

    def __init__(
        self,
        workspace: ApplicationContext,
        controller: PhotosController,
        scene: CoverageScene,
        panel: PanelSightings,
        parent: QObject,
    ) -> None:
        super().__init__(parent)
        self._workspace, self._controller, self._scene, self._panel = workspace, controller, scene, panel
        self._is_in_front = False
        scene.picked.connect(workspace.select)
        controller.stateChanged.connect(self.show_all)
        controller.photosChanged.connect(self.show_all)
        controller.coverageChanged.connect(self.show_all)
        workspace.selectionChanged.connect(self._select)
        workspace.unitsChanged.connect(self._set_units)
        self._set_units(workspace.units)
        self._select(workspace.selection)
        self.show_all()

    def set_in_front(self, is_in_front: bool) -> None:
        """Whether the tab is: coverage of other panels is counted when it is looked at."""
        self._is_in_front = is_in_front
        self.show_all()

    def show_all(self) -> None:
        """Bring everything up to date."""
        if self._is_in_front:
            self._controller.count()
        coverage = self._controller.coverage
        self._panel.set_coverage(coverage)
        self._scene.set_coverage(self._workspace.document.site, coverage, self._why_nothing())

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
        model = self._workspace.document.site
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

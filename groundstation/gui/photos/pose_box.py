"""Refining the poses of the photos: the button, what it has brought, and the way back."""

from __future__ import annotations

from dataclasses import replace

from PySide6.QtWidgets import QGridLayout, QLabel, QPushButton, QWidget

from groundstation.gui.photos.photos_desk import PhotosDesk
from groundstation.services.jobs import JobContext
from groundstation.services.photo_poses import BetterPoses, RefinedOutcome, RefineWish, refined_poses
from groundstation.services.units import UnitSystem, length_unit


class PoseBox(QWidget):
    """Buttons for the photos of a desk, and a line about their poses."""

    def __init__(self, desk: PhotosDesk, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._desk, self._units = desk, UnitSystem.METRIC
        self.refine, self.back = QPushButton(self.tr("Refine poses")), QPushButton(self.tr("Own poses"))
        self.outcome = QLabel()
        self.refine.setToolTip(
            self.tr("Match the photos with each other and adjust all rays; computed once and kept beside the photos")
        )
        self.back.setToolTip(self.tr("Go back to the poses that the photos themselves have"))
        self.outcome.setWordWrap(True)
        self.outcome.setProperty("role", "muted")
        self.outcome.setToolTip(
            self.tr("By how much poses differ from the photos' own, and how well the photos fit each other; more below")
        )
        layout = QGridLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(4)
        layout.addWidget(self.refine, 0, 0)
        layout.addWidget(self.back, 0, 1)
        layout.addWidget(self.outcome, 1, 0, 1, 2)
        self.refine.clicked.connect(self._refine)
        self.back.clicked.connect(self._back)
        for signal in (desk.photosChanged, desk.stateChanged):
            signal.connect(self._show)
        self._show()

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        self._units = units
        self._show()

    def _refine(self) -> None:
        intake = self._desk.intake
        if intake is None:
            return

        def poses(context: JobContext) -> BetterPoses:
            return refined_poses(intake.posed.photos, intake.folder, RefineWish(), context)

        self._desk.change_poses(self.tr("Refine poses"), poses)

    def _back(self) -> None:
        intake = self._desk.intake
        if intake is not None:
            own = BetterPoses(intake.posed.photos)
            self._desk.change_poses(self.tr("Own poses"), lambda _context: own)

    def _show(self) -> None:
        intake, is_free = self._desk.intake, not self._desk.is_busy
        refined = None if intake is None else intake.better.refined
        self.refine.setEnabled(is_free and intake is not None and bool(intake.photos) and refined is None)
        self.back.setEnabled(is_free and refined is not None)
        self.outcome.setText("" if refined is None else self._words(refined))
        self.outcome.setVisible(refined is not None)

    def _words(self, refined: RefinedOutcome) -> str:
        """What a refinement has brought; findings say what was refused, and why."""
        parts = [self.tr("Refined: {0} of {1} photos.").format(refined.n_refined, refined.n_photos)]
        if refined.n_refined:
            unit = replace(length_unit(self._units), decimals=3)
            moves = self.tr("Moved {0}, at most {1}; turned {2:.2f}\u00b0, at most {3:.2f}\u00b0; {4:.2f} px.")
            moved = (unit.text(m) for m in refined.moved_m)
            parts.append(moves.format(*moved, *refined.turned_deg, refined.reprojection_px))
        if refined.not_joined:
            parts.append(self.tr("{0} found no place.").format(len(refined.not_joined)))
        return " ".join(parts)

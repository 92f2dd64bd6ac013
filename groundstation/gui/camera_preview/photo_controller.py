"""Has the photo rendered that the camera preview wants to show: a coarse one at once, then a fine one.

One job at a time, and none while nobody looks. A newer request replaces an older one, and other work comes first: the
photo gives way to it and is begun anew.
"""

from __future__ import annotations

import math
from collections import OrderedDict
from dataclasses import dataclass, replace

import numpy as np
from PySide6.QtCore import QObject, Qt, QTimer
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QDialog, QHeaderView, QLabel, QVBoxLayout, QWidget

from groundstation.gui.application.context import ApplicationContext
from groundstation.gui.application.translate import translated
from groundstation.gui.camera_preview.preview import CameraPreview
from groundstation.gui.widgets.picture_decoder import qimage_of
from groundstation.gui.widgets.table_view import Column, RowModel, table_of
from groundstation.services.jobs.runner import Job, JobContext, JobProgress, JobState
from groundstation.services.scenes.preview import (
    LEAST_WIDTH_PX,
    LEFT_OUT,
    MAX_WIDTH_PX,
    PhotoRequest,
    PreviewPhoto,
    cached_photo,
    quick_width_px,
    site_key,
    site_photo,
)
from groundstation.services.units import UnitSystem
from planning.base.effects import Decision
from planning.geo.frames import wrap_heading_deg
from planning.plan import Viewpoint
from planning.site.records import SiteModel

# The effects of a rendered photo: what is simulated, what is not, how large each would be, and why.


class EffectsWindow(QDialog):
    """A table of decisions beside the window, which follows the photo that is shown."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Effects of the photo"))
        self.resize(1000, 560)
        self._units = UnitSystem.METRIC
        self._photo: PreviewPhoto | None = None
        self._words = QLabel()
        self._words.setWordWrap(True)
        self.model: RowModel[Decision] = RowModel(self._columns(), self)
        self._table = table_of(self.model, self.tr("Effects of the photo"), self)
        self._table.setWordWrap(True)
        self._table.verticalHeader().setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        layout = QVBoxLayout(self)
        layout.addWidget(self._words)
        layout.addWidget(self._table, 1)
        self.set_photo(None)

    def _columns(self) -> tuple[Column[Decision], ...]:
        return (
            Column(self.tr("Effect"), lambda found: translated(found.effect, self._units)),
            Column(self.tr("Simulated"), lambda found: self.tr("on") if found.on else self.tr("off")),
            Column(self.tr("Size"), self._size_text, is_number=True),
            Column(self.tr("Off below"), lambda found: f"{found.tolerance:.3g}", is_number=True),
            Column(self.tr("Why"), lambda found: translated(found.reason, self._units)),
        )

    def _size_text(self, found: Decision) -> str:
        return self.tr("{0:.3g} {1}").format(found.size, translated(found.unit, self._units))

    def set_photo(self, photo: PreviewPhoto | None) -> None:
        """Show the decisions of a photo; a quick one has none yet."""
        self._photo = photo
        self.model.set_rows(() if photo is None else photo.decisions)
        if photo is None:
            self._words.setText(self.tr("No photo is shown."))
        elif photo.request.is_quick:
            self._words.setText(
                self.tr("The coarse picture has all effects of light; the scene is asked for the fine one.")
            )
        else:
            self._words.setText(
                self.tr(
                    "An effect is simulated where the picture would change by more than its limit without it: here a "
                    "picture of {0} x {1} pixels. Not in previews, because it takes long: {2}."
                ).format(
                    photo.picture.shape[1],
                    photo.picture.shape[0],
                    ", ".join(translated(name, self._units) for name in LEFT_OUT),
                )
            )
        self._table.resizeColumnsToContents()

    def set_units(self, units: UnitSystem) -> None:
        """Show lengths in other units."""
        self._units = units
        self.set_photo(self._photo)

    def text(self) -> str:
        """Everything the table says."""
        columns = range(self.model.columnCount())
        rows = range(self.model.rowCount())
        cells = [[str(self.model.data(self.model.index(row, column))) for column in columns] for row in rows]
        return "\n".join(" | ".join(row) for row in cells)

    def show_beside(self) -> None:
        """Open it, or bring it to the front."""
        self.show()
        self.raise_()
        self.activateWindow()
        self._table.setFocus(Qt.FocusReason.OtherFocusReason)


AFTER_MS = 80
"""Somebody who steps through viewpoints, or turns the sun, has come to rest."""

WIDE_ENOUGH = 0.8
"""Share of the wanted width with which a picture does: windows change their size by pixels, pictures need not."""

MAX_CACHED = 6
"""Fine pictures of up to 9 MB each, for going back and forth."""

SEED = 0
"""Of surroundings and panes: those that `scene render` makes unless it is told otherwise."""


@dataclass(frozen=True, slots=True)
class _FinePhoto:
    """A fine photo of a site."""

    model: SiteModel
    request: PhotoRequest

    @property
    def view(self) -> _FinePhoto:
        """The same for pictures that differ in nothing but their size."""
        return replace(self, request=replace(self.request, width_px=1))


class PhotoController(QObject):
    """Keeps the photo of a camera preview in step with everything that it depends on."""

    def __init__(self, context: ApplicationContext, preview: CameraPreview, parent: QObject) -> None:
        super().__init__(parent)
        self._context, self._preview = context, preview
        self._wanted: _FinePhoto | None = None
        self._refused: _FinePhoto | None = None
        """The view of what failed or was cancelled."""
        self._job: Job[tuple[PreviewPhoto, QImage]] | None = None
        self._job_view: _FinePhoto | None = None
        self._is_given_up = False
        self._shown: PreviewPhoto | None = None
        self._cached: OrderedDict[_FinePhoto, tuple[PreviewPhoto, QImage]] = OrderedDict()
        self._key: tuple[SiteModel, str] | None = None
        self._seconds_per_px: float | None = None
        self._effects: EffectsWindow | None = None
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.timeout.connect(self._go_on)
        preview.shotChanged.connect(self.look)
        preview.box.valueChanged.connect(self._try_again)
        preview.box.light.valueChanged.connect(self.look)
        preview.box.effects.clicked.connect(self.show_effects)
        context.jobsChanged.connect(self._jobs_changed)
        context.bridge.progressed.connect(self._show_progress)
        context.unitsChanged.connect(self._show_units)

    def shown(self) -> PreviewPhoto | None:
        """The photo that is shown, coarse or fine; None while lines are."""
        return self._shown

    def is_at_rest(self) -> bool:
        """Whether nothing is being rendered, nor will be as things are."""
        return self._job is None and not self._timer.isActive()

    def show_effects(self) -> None:
        """Open the table of what was decided about each effect."""
        self.effects_window().show_beside()

    def effects_window(self) -> EffectsWindow:
        """The table; made when it is first wanted."""
        if self._effects is None:
            self._effects = EffectsWindow(self._preview)
            self._effects.set_units(self._context.units)
            self._effects.set_photo(self._shown)
        return self._effects

    # What is wanted

    def look(self) -> None:
        """Find out whether another photo is wanted now."""
        wanted, before = self._request(), self._wanted
        if wanted == before:
            return
        self._wanted = wanted
        if wanted is None or before is None or wanted.view != before.view:
            self._show(*((None, None) if wanted is None else self._cached.get(wanted.view, (None, None))))
        self._timer.start(AFTER_MS)

    def _try_again(self) -> None:
        """The user asks for it: what failed or was cancelled may be rendered after all."""
        if self._refused is not None:
            self._refused = None
            self._preview.show_note("")
        self._timer.start(AFTER_MS)

    def _request(self) -> _FinePhoto | None:
        shot = self._preview.shot()
        if shot is None:
            return None
        model, camera, pose = shot
        self._preview.box.light.set_origin(model.site.origin)
        east, north, up = map(float, pose.position_enu_m)
        heading_deg = wrap_heading_deg(math.degrees(pose.heading_rad))
        view = Viewpoint("photo", (east, north, up), heading_deg, math.degrees(pose.pitch_rad))
        width = min(MAX_WIDTH_PX, max(LEAST_WIDTH_PX, self._preview.width_px()))
        return _FinePhoto(model, PhotoRequest("", self._preview.box.light.value(), SEED, view, camera, width))

    def _go_on(self) -> None:
        """Do what comes next for the photo that is wanted."""
        wanted = self._wanted
        view = None if wanted is None else wanted.view
        others = [job for job in self._context.jobs() if job is not self._job]
        if self._job is not None:
            if others or view != self._job_view:
                self._is_given_up = True
                self._context.cancel(self._job, quietly=True)
        elif wanted is None or view == self._refused or self._is_fine(wanted):
            return
        elif wanted.model.site.n_panels == 0:
            self._preview.show_note(self.tr("This site has no panels yet, and nothing to mirror in them."))
        elif others:
            self._preview.show_note(self.tr("The photo waits for: {0}").format(others[0].name))
        else:
            self._start(wanted)

    def _is_fine(self, wanted: _FinePhoto) -> bool:
        shown = self._shown
        return (
            shown is not None
            and not shown.request.is_quick
            and shown.request.width_px >= WIDE_ENOUGH * wanted.request.width_px
        )

    # Rendering

    def _start(self, wanted: _FinePhoto) -> None:
        request, model = wanted.request, wanted.model
        quick = quick_width_px(request.width_px, self._seconds_per_px)
        if self._shown is None and quick < request.width_px:
            request = replace(request, width_px=quick, is_quick=True)
        known = self._key[1] if self._key is not None and self._key[0] is model else None

        def work(context: JobContext) -> tuple[PreviewPhoto, QImage]:
            request_for_site = replace(request, site_key=site_key(model) if known is None else known)
            photo = context.run_in_process(cached_photo, request_for_site)
            if photo is None:
                photo = context.run_in_process(site_photo, model, request_for_site)
            return photo, qimage_of(photo.picture)

        self._job_view, self._is_given_up = wanted.view, False
        self._job = self._context.start(
            self.tr("Render the photo"), work, lambda found: self._done(wanted, *found), self._failed
        )

    def _done(self, wanted: _FinePhoto, photo: PreviewPhoto, image: QImage) -> None:
        self._key = wanted.model, photo.request.site_key
        self._seconds_per_px = photo.seconds / (photo.picture.shape[0] * photo.picture.shape[1])
        if not photo.request.is_quick:
            self._cached[wanted.view] = photo, image
            self._cached.move_to_end(wanted.view)
            while len(self._cached) > MAX_CACHED:
                self._cached.popitem(last=False)
        if self._wanted is not None and self._wanted.view == wanted.view:
            self._show(photo, image)

    def _failed(self, error: BaseException) -> None:
        self._refused = self._job_view
        if self._wanted is not None and self._wanted.view == self._refused:
            words = self._context.localized(str(error))
            self._preview.show_note(self.tr("The photo could not be rendered: {0}").format(words))

    def _jobs_changed(self) -> None:
        job = self._job
        if job is not None and job.state is not JobState.QUEUED and job not in self._context.jobs():
            self._job = None
            if job.state is JobState.CANCELLED and not self._is_given_up:
                self._refused = self._job_view
                self._preview.show_note(self.tr("The photo was cancelled; choose Photo again to render it."))
        if self._wanted is not None:
            # A job that has just begun is known only after this; one that has ended brings its result then, too.
            self._timer.start(0)

    # What is shown

    def _show(self, photo: PreviewPhoto | None, image: QImage | None) -> None:
        self._shown = photo
        self._preview.show_picture(image, np.zeros(0, np.int64) if photo is None else photo.panels)
        self._preview.show_note("" if photo is None else self._note(photo))
        if self._effects is not None:
            self._effects.set_photo(photo)

    def _note(self, photo: PreviewPhoto) -> str:
        if photo.is_walled_in:
            return self.tr(
                "The camera stands inside something here: a building opposite, a tree or an obstacle. Take the made-up "
                "street away, or move the viewpoint."
            )
        return self.tr("Coarse picture; the fine one follows.") if photo.request.is_quick else ""

    def _show_progress(self, event: JobProgress) -> None:
        if self._job is None or event.job_id != self._job.id or self._job.cancel_requested:
            return
        words = self._context.localized(event.stage)
        if event.total > 1:
            words = self.tr("{0} ({1:.0f} %)").format(words, 100.0 * event.done / event.total)
        warning = "" if self._shown is None or not self._shown.is_walled_in else self._note(self._shown) + "\n"
        self._preview.show_note(warning + words)

    def _show_units(self, units: UnitSystem) -> None:
        if self._effects is not None:
            self._effects.set_units(units)

"""What the Photos tab works on: the photos that were read, the panels found in them, and their corrections."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from groundstation.gui.application.context import ApplicationContext
from groundstation.services.fly.log_book import StatedSortie, flight_of_photos
from groundstation.services.jobs.runner import JobContext
from groundstation.services.photos.coarse import (
    SPARSE,
    CoarseFiles,
    UnsizedCoarse,
    coarse_files_in_process,
    lacks_size,
)
from groundstation.services.photos.found_panels import (
    AppliedPoses,
    PanelDraft,
    apply_poses,
    search_panels,
    solved_draft,
    with_found_panels,
)
from groundstation.services.photos.intake import (
    PhotoCard,
    PhotoCoverage,
    PhotoIntake,
    photo_cards,
    photo_coverage,
    photo_intake,
    recounted,
)
from groundstation.services.photos.poses import ChosenPoses
from groundstation.services.photos.tradeoff import Trial, facade_trials
from groundstation.services.project.document import Document, PlanEntry
from groundstation.services.project.input_files import read_input_site
from groundstation.services.project.session import History
from groundstation.services.scenes.panel_pictures import panel_pictures
from groundstation.services.scenes.surfaces import Surface
from groundstation.services.site.sources import with_new_site
from planning.base.errors import GroundStationError
from planning.base.findings import Finding, Severity
from planning.plan import Plan
from planning.site.records import Facade, Site, SiteModel
from reconstruction.coarse.parameters import CoarseRequest
from reconstruction.panels.solving.facades_file import found_facades
from reconstruction.scenes.runs.run_record import BegunPhotos, begun_photos, is_rendered

if TYPE_CHECKING:
    from groundstation.services.scenes.photos import RenderedScene
    from reconstruction.dataset.prepare import PreparedData

PHOTOS_FOLDER = "photos"
"""Of a project."""

IMAGES = "images"
"""Of a folder of rendered photos, which holds their truth, too."""

Edit = Callable[[PanelDraft], PanelDraft]

_Basis = tuple[tuple[Facade, ...], Plan | None]
"""What coverage is counted over: the panels, and the plan that was flown."""


@dataclass(frozen=True, slots=True, eq=False)
class FlightOfPhotos:
    """What photos say of a flight of a plan: when its sorties were flown, and what the report finds."""

    plan: Plan
    site: Site
    sorties: tuple[StatedSortie, ...]
    findings: tuple[Finding, ...]


class PhotosController(QObject):
    """Reads photos, searches them and keeps the history of corrections.

    Signals
    -------
    photosChanged()
        Others were read.
    coverageChanged()
        It was counted again, over other panels or against another plan.
    draftChanged()
        Panels were found, corrected or solved.
    trialsChanged()
        Another way of searching was measured.
    stateChanged()
        What can be done is different.
    flightStated(FlightOfPhotos)
        It is known what the photos say of their flight.
    """

    photosChanged = Signal()  # noqa: N815  (Qt's own way of naming)
    coverageChanged = Signal()  # noqa: N815
    draftChanged = Signal()  # noqa: N815
    trialsChanged = Signal()  # noqa: N815
    stateChanged = Signal()  # noqa: N815
    flightStated = Signal(object)  # noqa: N815

    def __init__(self, context: ApplicationContext, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._context = context
        self.folder: Path | None = None
        self._rendering: Path | None = None
        self.unsized: UnsizedCoarse | None = None
        self.colmap: Path | None = None
        self.intake: PhotoIntake | None = None
        self.cards: tuple[PhotoCard, ...] = ()
        self.trials: tuple[Trial, ...] = ()
        self._history: History[PanelDraft] | None = None
        self._busy: set[int] = set()
        self._counted: _Basis = ((), None)
        self._counting: _Basis = ((), None)
        self._coverage: PhotoCoverage | None = None
        self.photosChanged.connect(lambda: context.note(n_photos=len(self.cards)))
        context.documentChanged.connect(self._document_changed)
        context.jobsChanged.connect(self._jobs_changed)

    @classmethod
    def of(cls, context: ApplicationContext) -> PhotosController:
        """The one of a context: it stays when the window is made anew."""
        found = context.findChild(PhotosController)
        return cls(context, context) if found is None else found

    @property
    def is_coverage_current(self) -> bool:
        """Whether the coverage that was counted is of the panels and the plan that there are now."""
        return self.intake is not None and self._counted == self._basis()

    @property
    def coverage(self) -> PhotoCoverage | None:
        """What the photos show of the site's panels; None where that is not known, or has not been counted yet."""
        model = self._context.document.site
        if self._coverage is None and self.intake is not None and model is not None and self.is_coverage_current:
            self._coverage = photo_coverage(self.intake, model.site)
        return self._coverage if self.is_coverage_current else None

    @property
    def draft(self) -> PanelDraft | None:
        """Panels as they are now; None before a search."""
        return None if self._history is None else self._history.value

    @property
    def undo_label(self) -> str:
        """What `undo` would take back."""
        return "" if self._history is None else self._history.undo_label

    @property
    def redo_label(self) -> str:
        """What `redo` would do again."""
        return "" if self._history is None else self._history.redo_label

    @property
    def is_busy(self) -> bool:
        """Whether photos are read or searched, or corrections solved."""
        return bool(self._busy)

    def usual_folder(self) -> Path | None:
        """The folder of photos that was chosen, or the project's."""
        project = self._context.session.folder
        if self.folder is not None:
            return self.folder
        return None if project is None else project / PHOTOS_FOLDER

    @property
    def may_state_flight(self) -> bool:
        """Whether the photos are of a real flight, and may be of the active plan."""
        document = self._context.document
        if self.intake is None or not self.intake.photos or document.current is None or document.site is None:
            return False
        folder = self.intake.folder
        return document.site.site.n_panels > 0 and not any(is_rendered(each) for each in (folder, folder.parent))

    def state_flight(self) -> None:
        """Find out what the photos say of the flight of the active plan, so that it can be entered."""
        document, intake = self._context.document, self.intake
        if intake is None or document.current is None or document.site is None or not self.may_state_flight:
            return
        plan, model = document.current.plan, document.site

        def work(context: JobContext) -> FlightOfPhotos:
            found = flight_of_photos(plan, model, intake.metadata, str(intake.folder), context)
            return FlightOfPhotos(plan, model.site, *found)

        self._start(self.tr("Log book"), work, self.flightStated.emit)

    def make_coarse(self, photos: Path, out: Path, distances: tuple[tuple[str, str, float], ...] = ()) -> None:
        """Make a site of a folder of photos alone, open it, and read the photos over it.

        Parameters
        ----------
        distances
            Names of two photos, and the metres between where they were taken.
        """

        def work(context: JobContext) -> tuple[CoarseFiles, SiteModel]:
            files = context.run_in_process(coarse_files_in_process, CoarseRequest(photos, out, distances=distances))
            return files, read_input_site(files.site)

        def done(result: tuple[CoarseFiles, SiteModel]) -> None:
            files, model = result
            self.unsized = UnsizedCoarse(photos, out) if files.is_guessed else None
            for found in files.findings:
                self._context.say(found.severity, self._context.localized(found.message))
            document = with_new_site(self._context.document, model)
            self._context.change(self.tr("Make a coarse model"), document)
            self._context.select(None)
            text = self.tr("The coarse model is made: {0} of {1} photos found their place, walls: {2}. It lies in {3}")
            n_walls = len(files.report["walls"])
            self._context.say(
                Severity.OK, text.format(files.report["registered"], files.report["photos"], n_walls, out)
            )
            self.read(photos, out / SPARSE)

        def failed(error: BaseException) -> None:
            self.unsized = UnsizedCoarse(photos, out) if lacks_size(error) else None
            self.stateChanged.emit()

        self._start(self.tr("Make a coarse model"), work, done, failed)

    def read(self, folder: Path, colmap: Path | None = None) -> None:
        """Read a folder of photos over the site.

        Parameters
        ----------
        colmap
            COLMAP model with the photos' poses; None for the one that these photos were read with before, if any.
        """
        if colmap is not None or folder != self.folder:
            self.colmap = colmap
        poses = self.colmap
        model, basis = self._context.document.site, self._basis()
        if model is None:
            self._context.say(Severity.ERROR, self.tr("Open or import a site first: photos are placed on it."))
            return
        flown = basis[1]
        self.folder = folder

        def work(context: JobContext) -> PhotoIntake:
            return photo_intake(folder, model, flown, colmap=poses, monitor=context)

        def done(intake: PhotoIntake) -> None:
            if _is_same_place(model, self._context.document.site):
                self._taken_in(intake, basis)

        self._start(self.tr("Read photos"), work, done)

    def render(self, flight: Path, folder: Path, width_px: int | None) -> None:
        """Render the photos that a simulated flight of the current plan took into a folder, and read them."""
        model, entry = self._context.document.site, self._context.document.current
        if model is None or entry is None:
            return
        self._rendering = folder

        def work(context: JobContext) -> RenderedScene:
            from groundstation.services.scenes.photos import render_flight

            return context.run_in_process(render_flight, model, entry.plan, flight, folder, width_px)

        def done(rendered: RenderedScene) -> None:
            for found in rendered.findings:
                self._context.say(found.severity, self._context.localized(found.message))
            text = self.tr("Photos are rendered: {0}. They lie in {1}")
            self._context.say(Severity.OK, text.format(len(rendered.written.photos), folder))
            if _is_same_place(model, self._context.document.site):
                self.read(folder / IMAGES)

        self._start(self.tr("Render the photos"), work, done)

    def begun_rendering(self, flight: Path, usual: Path) -> BegunPhotos | None:
        """Photos of a flight whose rendering was begun: in the folder chosen last, or in one like the `usual` one."""
        places = (self._rendering, *sorted(usual.parent.glob(f"{usual.name}*")))
        begun = (begun_photos(place, flight) for place in places if place is not None)
        return next((found for found in begun if found is not None), None)

    def take_panels(self, show: Callable[[tuple[Surface, ...]], None]) -> None:
        """Take what the photos show of the panels, and show it where they are still these photos."""
        model, intake = self._context.document.site, self.intake
        if model is None or intake is None:
            return
        usable = [photo for photo, is_usable in zip(intake.photos, intake.usable, strict=True) if is_usable]

        def done(surfaces: tuple[Surface, ...]) -> None:
            if self.intake is intake:
                show(surfaces)

        self._start(
            self.tr("Photos on the building"),
            lambda context: context.run_in_process(panel_pictures, model, usable, intake.metadata),
            done,
        )

    def make_data_set(self, folder: Path) -> None:
        """Write what a model is trained on: these photos, their poses, and the panels of the site."""
        model, intake = self._context.document.site, self.intake
        if model is None or intake is None:
            return

        def work(context: JobContext) -> PreparedData:
            from groundstation.services.photos.dataset import prepare_read

            return prepare_read(intake, model, folder, context)

        def done(prepared: PreparedData) -> None:
            for found in prepared.findings:
                self._context.say(found.severity, f"{found.place}: {self._context.localized(found.message)}")
            text = self.tr("The data set is written, photos: {0}. Train a model of it on the Reconstruct tab: {1}")
            self._context.say(Severity.OK, text.format(len(prepared.photos), folder))
            self._context.note(data_set=folder)

        self._start(self.tr("Make the data set"), work, done)

    def plan_next_battery(self) -> None:
        """Look at what the photos tell of mirrored surroundings, and plan what adds most to them, as a new plan."""
        model, intake, entry = self._context.document.site, self.intake, self._context.document.current
        if model is None or intake is None or entry is None:
            return

        def work(context: JobContext) -> tuple[Plan, float, tuple[Finding, ...]]:
            from groundstation.services.photos.top_up import PhotoTopUpRequest, photo_top_up_in_process

            arguments = intake.photos, intake.folder, entry.plan, model, PhotoTopUpRequest()
            return context.run_in_process(photo_top_up_in_process, *arguments)

        def done(result: tuple[Plan, float, tuple[Finding, ...]]) -> None:
            plan, before_db, findings = result
            if not _is_same_place(model, self._context.document.site):
                return
            for found in findings:
                self._context.say(found.severity, self._context.localized(found.message))
            document, title = self._context.document, self.tr("Next battery")
            self._context.change(title, document.with_plan(PlanEntry(document.free_plan_id(), title, plan)))
            worth = plan.worth
            after_db = before_db if worth is None else worth.batteries[-1].psnr_db
            text = self.tr("Next battery planned, photos: {0}; unseen views, expected: {1:.1f} dB to {2:.1f} dB")
            self._context.say(Severity.OK, text.format(len(plan.viewpoints), before_db, after_db))

        self._start(self.tr("Plan the next battery"), work, done)

    def count(self) -> None:
        """Count the coverage again where the panels or the plan are others now; once for each, should it fail."""
        model, intake, basis = self._context.document.site, self.intake, self._basis()
        if model is None or intake is None or self.is_busy or basis in (self._counted, self._counting):
            return
        if model.site.n_panels == 0:
            return
        self._counting = basis

        def work(context: JobContext) -> PhotoIntake:
            return recounted(intake, model, basis[1], context)

        def done(counted: PhotoIntake) -> None:
            if self.intake is intake:
                self.intake, self._counted, self._coverage = counted, basis, None
                self.coverageChanged.emit()

        self._start(self.tr("Count coverage"), work, done)

    def change_poses(self, label: str, poses: Callable[[JobContext], ChosenPoses]) -> None:
        """Go on with other poses of the same photos; panels that were found stay, and are solved with them."""
        model, intake, draft, basis = self._context.document.site, self.intake, self.draft, self._basis()
        if model is None or intake is None:
            return

        def work(context: JobContext) -> AppliedPoses:
            return apply_poses(intake, draft, poses(context), model, basis[1], context)

        def done(reposed: AppliedPoses) -> None:
            if self.intake is intake and self.draft is draft:
                self._taken_in(reposed.intake, basis)
                if reposed.draft is not None:
                    self._found(reposed.draft)

        self._start(label, work, done)

    def find(self) -> None:
        """Search the photos for panels."""
        model, intake = self._context.document.site, self.intake
        if model is None or intake is None:
            return

        def work(context: JobContext) -> PanelDraft:
            usable = [photo for photo, is_usable in zip(intake.photos, intake.usable, strict=True) if is_usable]
            return search_panels(usable, intake.metadata, model, monitor=context)

        def done(draft: PanelDraft) -> None:
            if self.intake is intake:
                self._found(draft)

        self._start(self.tr("Find panels"), work, done)

    def measure(self, facade_id: str) -> None:
        """Search the photos of a facade in other ways, to see what accuracy costs."""
        draft, intake = self.draft, self.intake
        if draft is None or intake is None:
            return

        def work(context: JobContext) -> tuple[Trial, ...]:
            return facade_trials(draft, intake.metadata, facade_id, context)

        def done(trials: tuple[Trial, ...]) -> None:
            if self.intake is intake:
                self.trials = trials
                self.trialsChanged.emit()

        self._start(self.tr("Measure the search"), work, done)

    def edit(self, label: str, edit: Edit) -> None:
        """Correct the panels, as one step that can be undone; what cannot be is said."""
        if self._history is None:
            return
        try:
            draft = edit(self._history.value)
        except GroundStationError as error:
            self._context.say(Severity.ERROR, self._context.localized(str(error)))
            return
        self._history.change(label, draft)
        self._changed()

    def undo(self) -> None:
        """Take the last correction back."""
        if self._history is not None:
            self._history.undo()
            self._changed()

    def redo(self) -> None:
        """Do it again."""
        if self._history is not None:
            self._history.redo()
            self._changed()

    def use(self) -> bool:
        """Put the panels into the site in the place of its own; False where that cannot be done now."""
        document, draft = self._context.document, self.draft
        if document.site is None or draft is None or draft.unsolved:
            return False
        try:
            model = with_found_panels(document.site, draft)
        except GroundStationError as error:
            self._context.say(Severity.ERROR, self._context.localized(str(error)))
            return False
        facades = found_facades(draft.found, draft.photos)
        self._context.change(self.tr("Use found panels"), replace(document, site=model, found_facades=facades))
        return True

    def _basis(self) -> _Basis:
        model, entry = self._context.document.site, self._context.document.current
        return (() if model is None else model.site.facades), (None if entry is None else entry.plan)

    def _taken_in(self, intake: PhotoIntake, basis: _Basis) -> None:
        self.intake, self.cards, self._history, self.trials = intake, photo_cards(intake), None, ()
        if self.may_state_flight:
            self._context.say(
                Severity.NOTE,
                self.tr("Was this a flight of the active plan by card? “Enter in log book” takes its times from here."),
            )
        self._counted = self._counting = basis
        self._coverage = None
        self.trialsChanged.emit()
        self.photosChanged.emit()
        self.draftChanged.emit()
        self.stateChanged.emit()

    def _found(self, draft: PanelDraft) -> None:
        self._history, self.trials = History(draft), ()
        self.trialsChanged.emit()
        self._changed()

    def _changed(self) -> None:
        """Show the draft, and solve what was corrected beside it."""
        draft = self.draft
        self.draftChanged.emit()
        self.stateChanged.emit()
        if draft is None or not draft.unsolved:
            return

        def work(context: JobContext) -> PanelDraft:
            return solved_draft(draft, context)

        def done(solved: PanelDraft) -> None:
            # Corrected again meanwhile: the newer draft has a job of its own.
            if self._history is not None and self._history.value is draft:
                self._history.amend(solved)
                self.draftChanged.emit()

        self._start(self.tr("Solve panels"), work, done)

    def _start(
        self,
        name: str,
        work: Callable[[JobContext], object],
        done: Callable[..., None],
        failed: Callable[[BaseException], None] | None = None,
    ) -> None:
        self._busy.add(self._context.start(name, work, done, failed).id)
        self.stateChanged.emit()

    def _jobs_changed(self) -> None:
        running = {job.id for job in self._context.jobs()}
        if not self._busy <= running:
            self._busy &= running
            self.stateChanged.emit()

    def _document_changed(self, before: Document, after: Document) -> None:
        """Photos that were read over another building, or another origin, mean nothing on this one."""
        if not _is_same_place(before.site, after.site) and self.intake is not None:
            self.folder, self.intake, self.cards, self._history, self.trials = None, None, (), None, ()
            self.trialsChanged.emit()
            self.photosChanged.emit()
            self.draftChanged.emit()
        self.stateChanged.emit()


def _is_same_place(before: SiteModel | None, after: SiteModel | None) -> bool:
    """Whether a site was edited or saved, which may make its building anew, and stayed where it is."""
    if before is None or after is None or before.site.origin != after.site.origin:
        return False
    return before.building is after.building or before.site.name == after.site.name

"""The way from a building to a model in steps: what is done, what comes next, and what leads to it.

Every part of the window reports what has happened as `Milestones`. From these alone `guidance` says for each step what
is done, what is next, and which one thing leads there. `undone` says what an edit takes back.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path

from groundstation.services.project.document import Document
from missions.flight.flight_file import Flight, is_of_plan, read_flight
from missions.flight.outcome import FlightReport, Reason
from missions.flight.record import FlightRecord
from planning.base.errors import InputError
from planning.base.messages import Message, joined, say
from planning.plan import Plan
from planning.site.records import SiteModel


class Step(StrEnum):
    """The steps, in their order; named as the tabs are."""

    SITE = "site"
    PLAN = "plan"
    MISSION = "mission"
    FLY = "fly"
    PHOTOS = "photos"
    RECONSTRUCT = "reconstruct"
    MODEL = "model"


class Act(StrEnum):
    """What leads on: another place of the window, or something to be done in the step itself."""

    TO_START = "to-start"
    TO_SITE = "to-site"
    TO_PLAN = "to-plan"
    TO_MISSION = "to-mission"
    TO_FLY = "to-fly"
    TO_PHOTOS = "to-photos"
    TO_RECONSTRUCT = "to-reconstruct"
    TO_MODEL = "to-model"
    IMPORT_BUILDING = "import-building"
    IMPORT_MISSION = "import-mission"
    DRAW_PANELS = "draw-panels"
    PLAN = "plan"
    KEEP_PLAN = "keep-plan"
    CHECK = "check"
    SHOW_FINDING = "show-finding"
    CONNECT = "connect"
    UPLOAD = "upload"
    TAKE_OFF = "take-off"
    NEXT_SORTIE = "next-sortie"
    RESUME_SORTIE = "resume-sortie"
    TOP_UP = "top-up"
    FROM_PHOTOS = "from-photos"
    READ_PHOTOS = "read-photos"
    RENDER_PHOTOS = "render-photos"
    FIND_PANELS = "find-panels"
    MAKE_DATA_SET = "make-data-set"
    TRAIN = "train"
    KEEP_MODEL = "keep-model"
    OPEN_MODEL = "open-model"
    EXPORT_MODEL = "export-model"


class FlightState(StrEnum):
    """Where the flight of the plan that is shown stands; BUSY while the vehicle and the window settle something."""

    APART = "apart"
    BUSY = "busy"
    CONNECTED = "connected"
    ON_BOARD = "on-board"
    READY = "ready"
    IN_AIR = "in-air"
    SIGNAL_LOST = "signal-lost"


@dataclass(frozen=True, slots=True)
class Flown:
    """What flights of one plan brought together.

    Parameters
    ----------
    views
        Sortie, from 1, and what became of each view, by its identifier.
    is_enough
        What is missing is not worth a flight.
    """

    views: Mapping[str, tuple[int, Reason]]
    is_enough: bool = False

    def also(self, report: FlightReport) -> Flown:
        """With a later flight: a view that has a photo keeps it."""
        views = dict(self.views)
        for view in report.views:
            _, known = views.get(view.view_id, (0, Reason.NOT_FLOWN))
            if known is not Reason.TAKEN and (view.reason is not Reason.NOT_FLOWN or view.view_id not in views):
                views[view.view_id] = view.sortie, view.reason
        return Flown(views, self.is_enough)

    @property
    def n_taken(self) -> int:
        """Views with a photo, also with one that only the camera told of."""
        return sum(reason in (Reason.TAKEN, Reason.REPORT_LOST) for _, reason in self.views.values())

    @property
    def is_whole(self) -> bool:
        """Whether nothing is left to fly."""
        return self.is_enough or self.n_taken == len(self.views)

    @property
    def is_cut_short(self) -> bool:
        """Whether a sortie ended before its last views, or nobody saw it reach them."""
        return any(reason in (Reason.FLIGHT_ENDED, Reason.NOT_RECORDED) for _, reason in self.views.values())

    @property
    def sorties_left(self) -> tuple[int, ...]:
        """Those that nobody has begun."""
        begun = {sortie for sortie, reason in self.views.values() if reason is not Reason.NOT_FLOWN}
        return tuple(sorted({sortie for sortie, _ in self.views.values()} - begun))


@dataclass(frozen=True, slots=True)
class Milestones:
    """What has happened.

    Parameters
    ----------
    n_panels, n_viewpoints
        Of the site and of the plan that is shown; None without one.
    n_errors, n_warnings
        What the pre-flight check found in the plan as it is; no number of errors where it has not been checked.
    not_looked_at
        What that check could not look at, such as the sun where no time is planned.
    flight, sortie
        Where its flight stands, and which of its sorties, from 1, is to be flown next.
    flown
        What was flown of it; None for nothing.
    simulated
        File of the flight that was simulated last; None where there is none: its photos can be rendered.
    n_photos
        Photos that were read over the site.
    data_set, model
        Folders of those that were made last; None where there is none.
    """

    n_panels: int | None = None
    n_viewpoints: int | None = None
    is_planning: bool = False
    n_errors: int | None = None
    n_warnings: int = 0
    not_looked_at: tuple[str, ...] = ()
    is_exported: bool = False
    flight: FlightState = FlightState.APART
    sortie: int = 1
    flown: Flown | None = None
    simulated: Path | None = None
    n_photos: int = 0
    data_set: Path | None = None
    is_training: bool = False
    model: Path | None = None
    is_model_open: bool = False


@dataclass(frozen=True, slots=True)
class Guidance:
    """What one step says.

    Parameters
    ----------
    is_done
        Whether the step is behind.
    done, next
        What is done (empty where nothing is), and what comes next.
    label, act
        What leads there; None and empty while something goes on that has to be waited for.
    """

    is_done: bool
    done: Message | str
    next: Message | str
    label: Message | str
    act: Act | None


def guidance(step: Step, now: Milestones) -> Guidance:
    """What a step says."""
    return _ROWS[step](now)


def is_done(step: Step, now: Milestones) -> bool:
    """Whether a step is behind."""
    return guidance(step, now).is_done


def _site(now: Milestones) -> Guidance:
    if now.n_panels is None:
        return _begin()
    if now.n_panels == 0:
        return Guidance(
            False,
            say("the site has no panels yet"),
            say("lay a grid of panels on a facade, or find panels in photos"),
            say("Facade grid"),
            Act.DRAW_PANELS,
        )
    return Guidance(
        True, say("panels: {}", now.n_panels), say("choose viewpoints and a route"), say("To Plan"), Act.TO_PLAN
    )


def _plan(now: Milestones) -> Guidance:
    if now.is_planning:
        return Guidance(
            False,
            say("a plan is being made"),
            say("stop once the curve is flat, or let it end by itself"),
            say("Stop and keep"),
            Act.KEEP_PLAN,
        )
    if now.n_viewpoints is not None:
        return Guidance(
            True, say("viewpoints: {}", now.n_viewpoints), say("check the mission"), say("To Mission"), Act.TO_MISSION
        )
    if not now.n_panels:
        return _site_first(now)
    return Guidance(False, "", say("plan the flight as the form says"), say("Plan the flight"), Act.PLAN)


def _mission(now: Milestones) -> Guidance:
    if now.n_viewpoints is None:
        return _plan_first(now)
    if not now.n_panels:  # an imported mission on a bare site: what it shows of no panel, no rule can measure
        return _site_first(now)
    if now.n_errors is None:
        return Guidance(False, "", say("measure every pre-flight rule"), say("Check"), Act.CHECK)
    if now.n_errors:
        return Guidance(
            False,
            say("checked; errors: {}", now.n_errors),
            say("look at what is wrong, and change the plan"),
            say("Show the first"),
            Act.SHOW_FINDING,
        )
    if now.n_warnings:
        further = say("read the warnings; then fly it, first in simulation, or export it")
        done = _and_not_looked_at(say("no errors; warnings: {}", now.n_warnings), now)
        return Guidance(True, done, further, say("To Fly"), Act.TO_FLY)
    done = say("all checks passed; mission files are written") if now.is_exported else say("all checks passed")
    further = say("fly it, first in simulation; or export it for your aircraft")
    return Guidance(True, _and_not_looked_at(done, now), further, say("To Fly"), Act.TO_FLY)


def _and_not_looked_at(done: Message, now: Milestones) -> Message:
    if not now.not_looked_at:
        return done
    return say("{}; not looked at: {}", done, joined(", ", now.not_looked_at))


def _fly(now: Milestones) -> Guidance:
    flown = now.flown
    if now.n_viewpoints is None and now.flight is FlightState.APART:
        return _plan_first(now)
    is_done = flown is not None and flown.is_whole
    if flown is not None and now.flight in (FlightState.APART, FlightState.CONNECTED):
        further = _after_flight(flown, now.sortie)
        if further is not None:
            return further
    photos = "" if flown is None else _photos_taken(flown)
    match now.flight:
        case FlightState.BUSY:
            return Guidance(is_done, photos, say("wait for the vehicle"), "", None)
        case FlightState.CONNECTED:
            done, further_text = photos or say("connected"), say("send the mission to the vehicle")
            return Guidance(is_done, done, further_text, say("Upload"), Act.UPLOAD)
        case FlightState.ON_BOARD:
            further_text = say("wait until every line of the list before take-off is well, or put it right")
            return Guidance(is_done, say("the mission is on board"), further_text, "", None)
        case FlightState.READY:
            return Guidance(is_done, say("ready to take off"), say("start; it asks first"), say("Start"), Act.TAKE_OFF)
        case FlightState.IN_AIR:
            return Guidance(is_done, say("in the air"), say("watch the flight until it has landed"), "", None)
        case FlightState.SIGNAL_LOST:
            further_text = say("keep the aircraft in sight: it goes on by itself, and is shown again once it is heard")
            return Guidance(is_done, say("in the air, and its signal is lost"), further_text, "", None)
        case _:
            pass
    return Guidance(False, photos, say("connect; a simulation needs no aircraft"), say("Connect"), Act.CONNECT)


def _after_flight(flown: Flown, sortie: int) -> Guidance | None:
    """What follows a landing; None where the sortie that is chosen is still to be flown."""
    photos = _photos_taken(flown)
    if flown.is_whole:
        further = say("read the photos of the flight")
        return Guidance(True, say("flown; {}", photos), further, say("To Photos"), Act.TO_PHOTOS)
    if flown.is_cut_short:
        further = say("change the battery and fly the rest; or read the photos that there are")
        return Guidance(False, say("landed early; {}", photos), further, say("Resume sortie"), Act.RESUME_SORTIE)
    if sortie in flown.sorties_left:
        return None
    if flown.sorties_left:
        further = say("fly sortie {}, with a full battery", flown.sorties_left[0])
        return Guidance(False, photos, further, say("Next sortie"), Act.NEXT_SORTIE)
    further = say("fly once more for what is missing; or read the photos that there are")
    return Guidance(False, say("flown; {}", photos), further, say("Top-up flight"), Act.TOP_UP)


def _photos_taken(flown: Flown) -> Message:
    return say("{} of {} photos taken", flown.n_taken, len(flown.views))


def _photos(now: Milestones) -> Guidance:
    if now.data_set is not None:
        done = say("the data set is made")
        return Guidance(True, done, say("train a model of it"), say("To Reconstruct"), Act.TO_RECONSTRUCT)
    if now.n_panels is None:
        further = say("make a site of photos alone, or open one")
        return Guidance(False, "", further, say("From photos alone"), Act.FROM_PHOTOS)
    if now.n_photos == 0 and now.simulated is not None:
        done = say("a flight was simulated")
        return Guidance(False, done, say("render the photos that it took"), say("Render photos"), Act.RENDER_PHOTOS)
    if now.n_photos == 0:
        further = say("read the photos of a flight; the sample project has some")
        return Guidance(False, "", further, say("Read photos"), Act.READ_PHOTOS)
    done = say("photos read: {}", now.n_photos)
    if now.n_panels == 0:
        return Guidance(
            False,
            done,
            say("find the panels in them, or make the data set of a building without any"),
            say("Find panels"),
            Act.FIND_PANELS,
        )
    return Guidance(
        False, done, say("make the data set that a model learns from"), say("Make data set"), Act.MAKE_DATA_SET
    )


def _reconstruct(now: Milestones) -> Guidance:
    if now.is_training:
        further = say("stop once the curve is flat, or let it end by itself")
        return Guidance(False, say("a model is being trained"), further, say("Stop and keep"), Act.KEEP_MODEL)
    if now.model is not None:
        return Guidance(True, say("a model is trained"), say("look at it, pane by pane"), say("To Model"), Act.TO_MODEL)
    if now.data_set is not None:
        return Guidance(False, say("the data set is there"), say("train a model"), say("Train"), Act.TRAIN)
    return Guidance(False, "", say("make a data set of photos first"), say("To Photos"), Act.TO_PHOTOS)


def _model(now: Milestones) -> Guidance:
    if now.is_model_open:
        further = say("keep its records, and export it for other programs")
        return Guidance(True, say("the model is open"), further, say("Export"), Act.EXPORT_MODEL)
    if now.model is not None:
        return Guidance(False, say("a model is trained"), say("open it"), say("Open the model"), Act.OPEN_MODEL)
    further = say("open a finished model, or train one first")
    return Guidance(False, "", further, say("To Reconstruct"), Act.TO_RECONSTRUCT)


def _begin() -> Guidance:
    further = say("begin with a building model, photos of a first flight, or a mission of another program")
    return Guidance(False, "", further, say("Start page"), Act.TO_START)


def _site_first(now: Milestones) -> Guidance:
    if now.n_panels is None:
        return _begin()
    return Guidance(False, "", say("the site needs panels first"), say("To Site"), Act.TO_SITE)


def _plan_first(now: Milestones) -> Guidance:
    if not now.n_panels:
        return _site_first(now)
    return Guidance(False, "", say("plan a flight first"), say("To Plan"), Act.TO_PLAN)


_ROWS: dict[Step, Callable[[Milestones], Guidance]] = {
    Step.SITE: _site,
    Step.PLAN: _plan,
    Step.MISSION: _mission,
    Step.FLY: _fly,
    Step.PHOTOS: _photos,
    Step.RECONSTRUCT: _reconstruct,
    Step.MODEL: _model,
}


def undone(now: Milestones, before: Document, after: Document) -> Milestones:
    """What holds after an edit: a flight, photos and models are of the building that they were made for."""
    site, entry = after.site, after.current
    if not is_same_building(before.site, site):
        now = Milestones(is_planning=now.is_planning, flight=now.flight, is_training=now.is_training)
    elif before.current is not entry and (
        entry is None or before.current is None or before.current.plan is not entry.plan
    ):
        now = replace(now, n_errors=None, is_exported=False, flown=None, simulated=None)
    elif before.site is not site:
        now = replace(now, n_errors=None)
    n_panels = None if site is None else site.site.n_panels
    return replace(now, n_panels=n_panels, n_viewpoints=None if entry is None else len(entry.plan.viewpoints))


def is_same_building(before: SiteModel | None, after: SiteModel | None) -> bool:
    """Whether a site was edited or saved, rather than replaced by another."""
    if before is None or after is None:
        return before is after
    return before.building is after.building or before.site.name == after.site.name


@dataclass(frozen=True, slots=True)
class FoundFiles:
    """What a project's folder has of steps that were done on another day; see `Milestones`."""

    is_exported: bool
    flown: Flown | None
    simulated: Path | None
    data_set: Path | None
    model: Path | None


def steps_in_folder(folder: Path, plan: Plan | None) -> FoundFiles:
    """Look at the files of a project, whose current plan this is; what cannot be read counts as not there."""
    flights = list(_flights(folder))
    flown: Flown | None = None
    for _, flight in _of_plan(flights, plan):
        if flight.report is not None:
            flown = (flown or Flown({})).also(flight.report)
    return FoundFiles(
        is_exported=bool(_files(folder, "missions/*")),
        flown=flown,
        simulated=_simulated(flights),
        data_set=_newest_folder(folder, "*/dataset.json"),
        model=_newest_folder(folder, "models/*/model.json"),
    )


def flown_records(folder: Path, plan: Plan) -> tuple[FlightRecord, ...]:
    """What was flown of a plan by the flight files of a project, each sortie once.

    A file that was written later on a connection holds what was flown before.
    """
    found = {}
    for _, flight in _of_plan(list(_flights(folder)), plan):
        found.update({(each.sortie, each.duration_s, each.photos): each for each in flight.sorties})
    return tuple(found.values())


def _flights(folder: Path) -> Iterator[tuple[Path, Flight]]:
    for path in _files(folder, "flights/*.json"):
        with contextlib.suppress(InputError):
            yield path, read_flight(path)


def _of_plan(flights: Sequence[tuple[Path, Flight]], plan: Plan | None) -> list[tuple[Path, Flight]]:
    return [] if plan is None else [each for each in flights if is_of_plan(each[1], plan)]


def _simulated(flights: Sequence[tuple[Path, Flight]]) -> Path | None:
    """The newest flight, where it was simulated: then its file says with which effects."""
    if not flights:
        return None
    path, flight = flights[-1]
    return path if any(record.effects for record in flight.sorties) else None


def _newest_folder(folder: Path, pattern: str) -> Path | None:
    found = _files(folder, pattern)
    return found[-1].parent if found else None


def _files(folder: Path, pattern: str) -> list[Path]:
    """Files of a pattern, the newest last."""
    try:
        return sorted((path for path in folder.glob(pattern) if path.is_file()), key=lambda path: path.stat().st_mtime)
    except OSError:
        return []

"""Use case of asking what flights are worth: the quality of the model that each brings, against minutes in the air.

A flight is planned by each method for each number of photos, flown in simulation where that is asked, photographed over
a synthetic scene, and a model is trained of its photos. What is finished stays in the folder `worth`, so that the same
call goes on where an earlier one was stopped.
"""

from __future__ import annotations

import hashlib
import json
import statistics
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

from groundstation.services.fly.flying import FlightRequest, fly_plan
from groundstation.services.scenes.views import as_written, scene_of_request, shots_of_flight
from missions.flight.flight_file import write_flight
from missions.simulator.conditions import Conditions
from planning.aircraft.catalogue import profile
from planning.base.errors import InputError
from planning.base.files import make_folder
from planning.base.json_file import read_json, to_record, write_atomically
from planning.base.messages import say
from planning.base.parallel_map import sweep
from planning.base.parameters import check, parameter
from planning.base.progress import QUIET, Monitor, QualityPoint
from planning.parameters import DEFAULT_PROFILE, GreedyParameters, Objective
from planning.plan import Plan, ViewpointArrays, read_plan, write_plan
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.tradeoff.runner import ComparisonFiles, Line, Panel, Subject, compare, falling
from planning.viewpoints.prepare import Prepared, prepare
from reconstruction.scenes.parameters import DEFAULT_POINTS, SceneRequest
from reconstruction.scenes.photos.flight_views import Shot, planned_shots
from reconstruction.scenes.record import Scene
from reconstruction.tradeoff.flight_worth import (
    LIGHTS,
    UNSEEN_KINDS,
    Light,
    UnseenKind,
    model_quality,
    photograph,
    shots_of,
    unseen_views,
)
from reconstruction.tradeoff.scene_tradeoff import ERROR_AXIS

Flown = Literal["planned", "rtk-fixed", "single"]

WORTH_PLANNERS: dict[str, tuple[str, Objective]] = {
    "random": ("random", "sections"),
    "orbit": ("orbit", "sections"),
    "noto": ("noto", "sections"),
    "pso": ("pso", "sections"),
    "sections": ("greedy", "sections"),
    "image-error": ("greedy", "image-error"),
}
"""What flights are compared: a planning method, and what greedy chooses for."""


@dataclass(frozen=True, slots=True)
class WorthRequest:
    """Which flights are compared, over what, and by which models.

    Parameters
    ----------
    planners
        Of `WORTH_PLANNERS`.
    views
        Numbers of viewpoints to plan.
    flown
        `planned`: photos stand where they are planned; else as flown in simulation with such a receiver. Their poses
        are known exactly, as aligning photos makes them.
    n_seeds
        Each flight is planned, and its model trained, with so many seeds.
    seconds
        Of processor time for joint splats.
    """

    scene: str
    planners: tuple[str, ...] = tuple(WORTH_PLANNERS)
    views: tuple[int, ...] = (50, 100, 200)
    lights: tuple[Light, ...] = ("radiance-grid", "mlp")
    flown: tuple[Flown, ...] = ("planned",)
    n_seeds: int = parameter(3, least=1, most=100, option="--seeds")
    n_unseen: int = parameter(40, least=3, most=1000, option="--unseen")
    width_px: int = parameter(128, least=32, most=8192)
    seconds: float = parameter(120.0, above=0.0)
    plan_s: float = parameter(20.0, above=0.0)
    look: Path | None = None
    profile_id: str = DEFAULT_PROFILE

    def __post_init__(self) -> None:
        check(self)
        for name, known in (
            ("planners", WORTH_PLANNERS),
            ("lights", LIGHTS),
            ("flown", ("planned", "rtk-fixed", "single")),
        ):
            unknown = [each for each in getattr(self, name) if each not in known]
            if unknown:
                raise InputError(
                    say("there is no '{}'; known are: {}", unknown[0], ", ".join(known), place=f"--{name}")
                )
        if min(self.views, default=0) < 2:
            raise InputError(say("expected numbers of photos from 2 on", place="--views"))


@dataclass(frozen=True, slots=True)
class FlightTrial:
    """One flight."""

    planner: str
    n_views: int
    seed: int
    flown: Flown

    @property
    def name(self) -> str:
        """For its files."""
        return f"{self.planner}-{self.n_views}-{self.flown}-{self.seed}"


@dataclass(frozen=True, slots=True)
class FlightResult:
    """What a flight brought.

    Parameters
    ----------
    n_views, n_taken
        Photos asked for, and taken.
    minutes, n_sorties
        In the air, as planned.
    covered
        Share of the hemisphere sections that can be seen at all.
    psnr_db
        Of unseen views, by light and kind.
    """

    scene: str
    planner: str
    flown: Flown
    seed: int
    n_views: int
    n_taken: int
    minutes: float
    n_sorties: int
    covered: float
    psnr_db: dict[str, dict[str, float]]

    def mean_db(self, light: str) -> float:
        """Over the kinds of unseen views."""
        return statistics.fmean(self.psnr_db[light].values())


def _rows(results: Sequence[FlightResult]) -> list[dict[str, Any]]:
    """A row for each flight, light and kind of unseen views."""
    return [
        {
            "scene": result.scene,
            "planner": result.planner,
            "views": result.n_views,
            "minutes": round(result.minutes, 2),
            "light": light,
            "unseen": kind,
            "seed": result.seed,
            "db": round(value, 2),
            "flown": result.flown,
            "taken": result.n_taken,
            "sorties": result.n_sorties,
            "covered": round(result.covered, 4),
        }
        for result in results
        for light, kinds in result.psnr_db.items()
        for kind, value in kinds.items()
    ]


def summary_rows(results: Sequence[FlightResult]) -> list[dict[str, Any]]:
    """Mean and spread over seeds, a row for each light, way of flying, number of views and planner."""
    groups: dict[tuple[str, str, int, str], list[FlightResult]] = {}
    for result in results:
        for light in result.psnr_db:
            groups.setdefault((light, result.flown, result.n_views, result.planner), []).append(result)
    rows = []
    for (light, flown, n_views, planner), found in sorted(groups.items()):
        values = [result.mean_db(light) for result in found]
        kinds = {
            f"{kind}_db": round(statistics.fmean(result.psnr_db[light][kind] for result in found), 2)
            for kind in UNSEEN_KINDS
        }
        rows.append(
            {
                "light": light,
                "flown": flown,
                "views": n_views,
                "planner": planner,
                "minutes": round(statistics.fmean(result.minutes for result in found), 1),
                "mean_db": round(statistics.fmean(values), 2),
                "spread_db": round(statistics.stdev(values), 2) if len(values) > 1 else "",
                **kinds,
                "seeds": len(found),
            }
        )
    return rows


WORTH_AXIS = replace(ERROR_AXIS, time_label=say("time in the air"))


def worth_panels(results: Sequence[FlightResult]) -> list[Panel]:
    """A panel for each light and way of flying, a line for each planner: error against time in the air."""
    rows = summary_rows(results)
    panels = []
    for light, flown in dict.fromkeys((row["light"], row["flown"]) for row in rows):
        chosen = [row for row in rows if (row["light"], row["flown"]) == (light, flown)]
        lines = []
        for planner in dict.fromkeys(row["planner"] for row in chosen):
            own = sorted((row for row in chosen if row["planner"] == planner), key=lambda row: row["minutes"])
            points = [QualityPoint(60.0 * row["minutes"], 10.0 ** (-row["mean_db"] / 20.0)) for row in own]
            lines.append(Line(planner, falling(points, points[-1].t_s), f"{own[-1]['mean_db']:.1f} dB"))
        panels.append(Panel(f"{light}, {flown}", tuple(lines)))
    return panels


WORTH: Subject[tuple[FlightResult, ...]] = Subject(
    "worth",
    WORTH_AXIS,
    rows=_rows,
    title=lambda results: say("the model that a flight brings, on unseen views of '{}'", results[0].scene),
    panels=worth_panels,
    more=lambda results: {"mean": summary_rows(results)},
    stem="worth",
)


def worth_tradeoff(
    request: WorthRequest,
    out: Path,
    *,
    n_processes: int = 1,
    address: str | None = None,
    monitor: Monitor = QUIET,
) -> ComparisonFiles[tuple[FlightResult, ...]]:
    """Compare flights; write `worth.csv`, `worth-mean.csv` and `worth.png` into `out`, and keep photos and results.

    Parameters
    ----------
    address
        Scheduler of a Dask cluster whose workers see `out` under the same name.

    Raises
    ------
    InputError
        There is no such scene, the folder holds other photos or cannot be written into, or no cluster answers.
    InfeasibleError
        A method finds no flight over the site.
    ReconstructionError
        A training came to nothing.
    OperationCancelled
        From `monitor`; what is finished stays.
    """
    trials = [
        FlightTrial(planner, n_views, seed, flown)
        for seed in range(request.n_seeds)
        for n_views in request.views
        for planner in request.planners
        for flown in request.flown
    ]
    folder = kept_folder(request, out)

    def run(_folder: Path) -> tuple[FlightResult, ...]:
        monitor.report(say("photographing unseen views"), 0, 1)
        ready = _prepared(request)
        for kind in UNSEEN_KINDS:
            _unseen(request, kind, ready, folder / f"unseen-{kind}", monitor)
        arguments = [(request, trial, folder) for trial in trials]
        return tuple(sweep(run_trial, arguments, n_processes=n_processes, address=address, monitor=monitor))

    return compare(WORTH, out, run)


def kept_folder(request: WorthRequest, out: Path) -> Path:
    """Where photos and results are kept: a folder of its own for all that makes results differ but the flights.

    Raises
    ------
    InputError
        There is no such scene, or the folder cannot be made.
    """
    scene, made_from = _scene(request)
    settings = (request.width_px, request.n_unseen, request.seconds, request.plan_s, DEFAULT_POINTS)
    parts = (made_from, scene.site.sha256, profile(request.profile_id), settings)
    folder = out / "worth" / f"{scene.name}-{hashlib.sha256(repr(parts).encode()).hexdigest()[:12]}"
    make_folder(folder)
    return folder


def run_trial(request: WorthRequest, trial: FlightTrial, folder: Path) -> FlightResult:
    """Plan, fly, photograph and learn, as far as that was not done before in the folder."""
    place = folder / trial.name
    path, known = place / RESULT_FILE, None
    if path.is_file():
        known = to_record(read_json(path), FlightResult, path)
        if set(request.lights) <= set(known.psnr_db):
            return _of_lights(known, request)
    ready = _prepared(request)
    make_folder(place)
    plan = _plan(request, trial, ready, place / "plan.json")
    photographed, shots = place / "photos", _shots(trial, plan, ready, place / "flight.json")
    _, companions = as_written(ready.scene.site)
    photograph(ready.scene, shots, ready.site, request.width_px, photographed, companions=companions)
    unseen = {kind: folder / f"unseen-{kind}" / "photos" for kind in UNSEEN_KINDS}
    scores: dict[str, dict[str, float]] = dict(known.psnr_db) if known else {}
    for light in request.lights:
        if light not in scores:
            found = model_quality(light, photographed, unseen, trial.seed, request.seconds)
            scores[light] = {str(kind): value for kind, value in found.items()}
    bound = plan.coverage.reachable_upper_bound
    result = FlightResult(
        ready.scene.name,
        trial.planner,
        trial.flown,
        trial.seed,
        trial.n_views,
        len(shots),
        plan.duration_s / 60.0,
        len(plan.sorties),
        plan.coverage.covered / bound if bound else 0.0,
        scores,
    )
    write_atomically(path, json.dumps(asdict(result), indent=1).encode())
    return _of_lights(result, request)


def _of_lights(kept: FlightResult, request: WorthRequest) -> FlightResult:
    """Of what was measured of a flight, also before, what is asked for."""
    return replace(kept, psnr_db={light: kept.psnr_db[light] for light in request.lights})


RESULT_FILE, VIEWS_FILE = "result.json", "views.json"


@dataclass(frozen=True, slots=True, eq=False)
class _Ready:
    """A scene, and its site prepared for planning."""

    scene: Scene
    site: Prepared


def _scene(request: WorthRequest) -> tuple[Scene, dict[str, Any]]:
    return scene_of_request(SceneRequest(request.scene, look=request.look, profile_id=request.profile_id))


def _prepared(request: WorthRequest) -> _Ready:
    scene, _ = _scene(request)
    return _Ready(scene, prepare(scene.site, profile(request.profile_id).camera, PlanRequest().constraints))


def _unseen(request: WorthRequest, kind: UnseenKind, ready: _Ready, folder: Path, monitor: Monitor) -> None:
    """Photograph unseen views; those that an interrupted run chose, since a search by the clock chooses others."""
    path, photos = folder / VIEWS_FILE, folder / "photos"
    if (photos / "dataset.json").is_file():
        return
    make_folder(folder)
    if not path.is_file():
        views = unseen_views(kind, ready.site, request.n_unseen)
        write_atomically(path, json.dumps([column.tolist() for column in views]).encode())
    views = ViewpointArrays(*(np.array(column, np.float64) for column in read_json(path)))
    photograph(ready.scene, shots_of(views), ready.site, request.width_px, photos, monitor)


def _plan(request: WorthRequest, trial: FlightTrial, ready: _Ready, path: Path) -> Plan:
    """The plan in a file, made if it is not there: its photos may be, and planning by the clock makes another."""
    if path.is_file():
        return read_plan(path)
    method, objective = WORTH_PLANNERS[trial.planner]
    wanted = PlanRequest(
        method=method,
        n_views=trial.n_views,
        profile_id=request.profile_id,
        greedy=GreedyParameters(objective=objective),
        seed=trial.seed,
        time_budget_s=request.plan_s,
    )
    plan = plan_flight(ready.scene.site, wanted, prepared=ready.site).plan
    write_plan(path, plan)
    return plan


def _shots(trial: FlightTrial, plan: Plan, ready: _Ready, path: Path) -> tuple[Shot, ...]:
    if trial.flown == "planned":
        return planned_shots(plan)
    if path.is_file():
        return shots_of_flight(path, plan, ready.scene.site)[0]
    flight = fly_plan(
        plan, ready.scene.site, FlightRequest(conditions=Conditions(fix=trial.flown), seed=trial.seed)
    ).flight
    write_flight(path, flight)
    return shots_of_flight(path, plan, ready.scene.site)[0]

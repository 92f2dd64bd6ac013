"""A second battery that is planned from the photos of the first, on a site that lacks its neighbours."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

from groundstation.services.photos.top_up import PhotoTopUpRequest, photo_top_up, poses_of
from planning.aircraft.catalogue import profile
from planning.base.json_file import write_atomically
from planning.geo.mesh import join
from planning.geo.solids import Solids
from planning.parameters import DEFAULT_PROFILE, FlightRules
from planning.plan import Plan, ViewpointArrays, read_plan, viewpoint_arrays, write_plan
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.revision.seen_bodies import CELL_M, GAP_M, SeenBody
from planning.site.records import SiteModel
from planning.viewpoints.prepare import Prepared, prepare
from planning.viewpoints.problem import concatenate
from reconstruction.light.photo_set import read_photo_set
from reconstruction.scenes.record import Scene
from reconstruction.scenes.world.bundled import bundled_scene
from reconstruction.tradeoff.flight_worth import (
    UNSEEN_KINDS,
    UnseenKind,
    model_quality,
    photograph,
    shots_of,
    unseen_views,
)
from tests.benchmarks.harness import Benchmark, Context, Row

N_SEEDS, N_UNSEEN, WIDTH_PX = {"planar": 3, "curved": 3}, 40, 128
"""Seeds by scene: each takes ten minutes of two cores."""

BEFORE = {n: f"batteries: {n} planned before" for n in (1, 2, 3)}
FROM_PHOTOS = "batteries: 1 before and 1 from its photos"
WORTH = (*BEFORE.values(), FROM_PHOTOS)
"""Rows of each seed, and of the means of all."""

LACKING = "scene-opposite"
"""Obstacles whose names begin so are those that the site lacks: the buildings on the other side of the street."""

BATTERY_S = 420.0
"""That a battery lasts for, above the reserve."""

KEPT = Path("benchmark-out") / "next-battery"
"""Plans and photos, with which the next run goes on."""


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """A scene, its site as the pilot has it, and what unseen views show."""

    scene: Scene
    known: Prepared
    true: Prepared
    unseen: Mapping[UnseenKind, Path]
    rules: FlightRules
    folder: Path


def measure(context: Context) -> Iterator[Row]:
    """For each scene: models of one to three batteries planned before, and of a second planned from photos.

    Seeds that are recorded already are not run again.
    """
    for name in tuple(N_SEEDS)[:1] if context.is_quick else N_SEEDS:
        yield from measure_scene(name, context.recorded, is_quick=context.is_quick)


def measure_scene(name: str, recorded: Sequence[Row] = (), *, is_quick: bool) -> Iterator[Row]:
    """The same for one scene."""
    case: Case | None = None
    found: dict[str, list[float]] = {what: [] for what in WORTH}
    for seed in range(1 if is_quick else N_SEEDS[name]):
        rows = [row for row in recorded if row.scene == name and row.what.endswith(_of(seed))]
        if {what + _of(seed) for what in WORTH} - {row.what for row in rows}:
            case = case or case_of(name, is_quick)
            rows = _seed_rows(case, seed, is_quick)
        yield from rows
        values = {row.what.removesuffix(_of(seed)): float(row.value) for row in rows}
        for what in WORTH:
            found[what].append(values[what])
    for what, each in found.items():
        yield Row(name, what, round(float(np.mean(each)), 2), "dB", seeds=len(each))
    if is_quick:
        return
    short = float(np.mean(found[FROM_PHOTOS]) - np.mean(found[BEFORE[3]]))
    target = "at least 0 dB"
    what, n_seeds = "two, one from photos, above three", len(found[FROM_PHOTOS])
    yield Row(name, what, round(short, 2), "dB", None, "", target, round(short, 2) >= 0.0, n_seeds)


def _of(seed: int) -> str:
    return f", seed {seed}"


def _seed_rows(case: Case, seed: int, is_quick: bool) -> list[Row]:
    """What one seed brings. Every battery's is kept as soon as it is known, and an interrupted run goes on after it."""
    name, rows = case.scene.name, []
    for n_batteries, what in BEFORE.items():
        plan = _planned(case, n_batteries, seed)
        path = case.folder / f"quality-{n_batteries}-{seed}.json"
        if not path.is_file():
            value = _quality(case, viewpoint_arrays(plan.viewpoints), f"{n_batteries}-{seed}", seed)
            write_atomically(path, json.dumps(value).encode())
        rows.append(Row(name, what + _of(seed), round(float(json.loads(path.read_bytes())), 2), "dB"))
    path = case.folder / f"from-photos-{seed}.json"
    if not path.is_file():
        write_atomically(path, json.dumps([asdict(row) for row in _from_photos(case, seed, is_quick)]).encode())
    return rows + [Row(**row) for row in json.loads(path.read_bytes())]


def _from_photos(case: Case, seed: int, is_quick: bool) -> Iterator[Row]:
    """A second battery planned from the first one's photos: what it found, how long it took, and what both bring."""
    name, first = case.scene.name, _planned(case, 1, seed)
    photos = read_photo_set(case.folder / f"photos-1-{seed}")
    request = PhotoTopUpRequest(seed=seed, learn_s=4.0 if is_quick else 40.0)
    top_up = photo_top_up(photos, replace(first, rules=case.rules), case.known.site_model, request)
    views = concatenate([poses_of(photos.photos), viewpoint_arrays(top_up.planned.plan.viewpoints)])
    shutil.rmtree(case.folder / f"photos-1+1-{seed}", ignore_errors=True)  # of another top-up
    shares = [_true_share(case, body) for body in top_up.bodies]
    beside = "; ".join(
        f"{' x '.join(f'{side:.0f}' for side in body.size_m)} m, {100 * share:.0f} % of it within {GAP_M:g} m "
        "of what is there"
        for body, share in zip(top_up.bodies, shares, strict=True)
    )
    n_true = sum(share > 0.5 for share in shares)
    yield Row(name, "bodies found that the site lacks" + _of(seed), n_true, "", None, beside)
    yield Row(name, f"looking at {top_up.look.n_photos} photos" + _of(seed), round(top_up.look.seconds, 1), "s")
    yield Row(name, FROM_PHOTOS + _of(seed), round(_quality(case, views, f"1+1-{seed}", seed), 2), "dB")


def case_of(name: str, is_quick: bool) -> Case:
    """A scene whose site lacks its neighbours, and photos of unseen views."""
    scene = bundled_scene(name)
    kept = [k for k, obstacle in enumerate(scene.site.site.obstacles) if not obstacle.id.startswith(LACKING)]
    site = replace(scene.site.site, obstacles=tuple(scene.site.site.obstacles[k] for k in kept))
    known = replace(scene.site, site=site, obstacles=tuple(scene.site.obstacles[k] for k in kept))
    aircraft = profile(DEFAULT_PROFILE).aircraft
    battery_s = BATTERY_S / (4.0 if is_quick else 1.0)
    rules = FlightRules(battery_reserve=1.0 - battery_s / aircraft.endurance_s)
    folder = KEPT / (f"{name}-quick" if is_quick else name)
    true, unseen = _prepared(scene.site), {}
    for kind in UNSEEN_KINDS:
        unseen[kind] = folder / f"unseen-{kind}"
        if not (unseen[kind] / "dataset.json").is_file():
            views = unseen_views(kind, true, 20 if is_quick else N_UNSEEN)
            photograph(scene, shots_of(views), true, WIDTH_PX, unseen[kind])
    return Case(scene, _prepared(known), true, unseen, rules, folder)


def _prepared(site_model: SiteModel) -> Prepared:
    return prepare(site_model, profile(DEFAULT_PROFILE).camera, PlanRequest().constraints)


def _planned(case: Case, n_batteries: int, seed: int) -> Plan:
    path = case.folder / f"plan-{n_batteries}-{seed}.json"
    if not path.is_file():
        request = PlanRequest(n_batteries=n_batteries, rules=case.rules, seed=seed, time_budget_s=20.0)
        write_plan(path, plan_flight(case.known.site_model, request, prepared=case.known).plan)
    return read_plan(path)


def _quality(case: Case, views: ViewpointArrays, name: str, seed: int) -> float:
    """PSNR of unseen views, mean of the kinds, of a radiance grid that learned from photos of these views."""
    folder = case.folder / f"photos-{name}"
    photograph(case.scene, shots_of(views), case.true, WIDTH_PX, folder)
    return float(np.mean([*model_quality("radiance-grid", folder, case.unseen, seed, 1.0).values()]))


def _true_share(case: Case, body: SeenBody) -> float:
    """Of a body's cells, those that are near to something that is there."""
    site_model = case.true.site_model
    solids = Solids.of(join([site_model.building, *site_model.obstacles]).corners_enu_m)
    return float((solids.clearance_m(body.cells_m + 0.5 * CELL_M, 2.0 * GAP_M) < GAP_M).mean())


BENCHMARK = Benchmark(
    "next-battery",
    "The next battery from the photos of the last",
    "Synthetic scenes whose sites lack all buildings on the other side of the street. Batteries of seven minutes: one, "
    "two and three planned before anything is flown, and a second one that `topup --photos` plans from the photos of "
    "the first. A radiance grid learns from all photos (128 x 96 pixels), and is scored on glass of 40 unseen views of "
    "each of three kinds, whose means count alike.",
    measure,
)

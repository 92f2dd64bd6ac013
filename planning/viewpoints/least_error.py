"""Views whose photos make a model's pictures, as far as can be told before, nearest to the truth.

What is expected of pictures is said by `planning.coverage.image_error`.

With amounts a_ij >= 0 of what view i shows of element j and weights w_j, the sets S of views are worth

    f(S) = sum_j w_j A_j / (1 + A_j),   A_j = sum of a_ij over i in S,

monotone and submodular, since x / (1 + x) rises and is concave. Greedy choice reaches 1 - 1/e of what the best set of
the same candidates takes off the expected error; f(S) and the N largest gains beside any S bound that from above. Gains
only fall while views are added, so an old gain is an upper bound: greedy looks again at few of them (M. Minoux, 1978).
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Assessment, Decision, EffectSetting, decide
from planning.base.jit import chunks, kernel
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor, Stop, never
from planning.coverage.image_error import COLUMNS, FLOOR, ROWS, TERMS, ImageErrorModel, Shown, decibels
from planning.coverage.mirrored_rays import Surroundings
from planning.plan import BatteryWorth, Camera, FlightWorth, Plan, ViewpointArrays, poses_sha256, viewpoint_arrays
from planning.site.records import SiteModel
from planning.viewpoints.candidates import spread_candidates
from planning.viewpoints.cover_kernel import is_too_close
from planning.viewpoints.problem import NONE_LOCKED, ViewProblem, concatenate, take
from planning.viewpoints.spacing import ANYWHERE, SpacingRule
from planning.viewpoints.unseen import even_views, random_views, walk_views

N_UNSEEN = 200
"""Of each kind of unseen views that elements get their weights from."""

SECONDS_FOR_ALL = 20_000
"""Views that candidates are, for the stated cost."""

FEW_CANDIDATES = 1000
"""Places that another battery's photos are taken from, for what it would bring."""

CALIBRATION = (16.0, 0.476)
"""The PSNR of models against that of the expected error: b + a x, fitted to the flights over one scene; errors that are
left when much is known are the model's own, so further photos bring half of what the colours' variances say."""

FAR_DB, FAR_SHARE, NEAR_SHARE = 2.4, 0.28, 0.53
"""Models are better by so much where so small a share of what panes mirror is near: 2.95 dB those of `planar-far`, 2.9
of `curved-far`, 1.4 of the site `office`. Not at all from the larger share on, that of `court`; evenly more between."""

DEVIATION_DB, FAR_DEVIATION_DB = 0.8, 1.5
"""Of models' PSNR from that, on scenes that it was not fitted to (`python -m tests.benchmarks --only image-error`), and
where less is near than `NEAR_SHARE`: those of `office` are 2 dB below with 50 photos, 0.6 above with 100."""

SLICE, VIEWS_PER_BLOCK = 16, 500
"""Views chosen, and candidates looked at, between two looks at the clock, at least."""

LEAST_LATE, LATE_EACH = 500, 4
"""Candidates that the rest of the views is chosen from once the time is over, and for each of those views. With 20 000
candidates 0.1 dB less is expected than of all of them after 50 to 560 views, in 0.03 to 0.3 s in the place of 0.3 to 1;
what was largest when it was looked at last, unseen since, is 0.5 to 1 dB worse."""

NO_GAIN = 1e-12
"""Of all weights together: gains up to it are rounding."""


@dataclass(frozen=True, slots=True, eq=False)
class MirrorScene:
    """What the effect looks at: the panes with what they mirror, views of them, and the camera."""

    surroundings: Surroundings
    views: ViewpointArrays
    camera: Camera


class MirroredSurroundings:
    """The effect: how far what panes mirror moves, in pixels of the photos, from one pane to the next.

    The mean over mirrored rays: a pane's width over the distance of what they meet, over a pixel's angle (sky: 0).
    Where it is small, what is mirrored has its place by direction alone.
    """

    name = say("mirrored surroundings")
    unit = say("px of parallax")
    tolerance = 0.5

    def assess(self, scene: MirrorScene) -> Assessment:
        """By casting some rays."""
        # What casts rays is loaded and built with the first ones, and once only.
        scene.surroundings.rays(take(scene.views, np.arange(len(scene.views.heading_rad)) < 1), scene.camera, 1, 1)
        begun_s = time.perf_counter()
        rays = scene.surroundings.rays(scene.views, scene.camera, COLUMNS, ROWS)
        seconds = (time.perf_counter() - begun_s) * SECONDS_FOR_ALL / max(1, rays.n_views)
        if not len(rays):
            return Assessment(0.0, say("no view shows a pane"), 0.0)
        corners = scene.surroundings.frames.corners[rays.panels]
        width_m = np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1)
        parallax_px = float(np.mean(width_m / rays.distances_m)) / scene.camera.pixel_angle_rad
        n_met = int(np.isfinite(rays.distances_m).sum())
        if n_met == 0:
            return Assessment(0.0, say("the panes mirror nothing but sky"), seconds)
        reason = say(
            "{:.0f} % of what the panes mirror is ground and bodies of the site, in the median {:.0f} m away",
            *(100.0 * n_met / len(rays), float(np.median(rays.distances_m[np.isfinite(rays.distances_m)]))),
        )
        return Assessment(parallax_px, reason, seconds)


def image_error_model(
    problem: ViewProblem,
    site_model: SiteModel,
    setting: EffectSetting = "auto",
    seed: int = 0,
    photos: ViewpointArrays = NONE_LOCKED,
) -> tuple[ImageErrorModel, Decision]:
    """The expected error of models of a site, and whether places of what is mirrored count in it.

    It is that of pictures from random views, from views even over the hemispheres, and of a walk; of those that are
    possible. Those of `photos` are there already.
    """
    rng, camera = np.random.default_rng([seed, 3]), problem.model.camera
    unseen = [
        random_views(problem, N_UNSEEN, rng),
        even_views(problem, N_UNSEEN, rng),
        walk_views(problem, site_model, N_UNSEEN, rng),
    ]
    near = Surroundings(site_model, problem.model.frames)
    decision = decide(MirroredSurroundings(), MirrorScene(near, concatenate(unseen), camera), setting)
    surroundings = near if decision.on else Surroundings(site_model, problem.model.frames, is_near=False)
    model = ImageErrorModel(surroundings, camera, TERMS, unseen, FLOOR)
    return (model.after(photos) if len(photos.heading_rad) else model), decision


class ErrorState(NamedTuple):
    """Candidates, what they show, and what is chosen so far.

    Parameters
    ----------
    starts, items, amounts
        Elements that each candidate shows, `items[starts[i]:starts[i + 1]]`, and how much of each, above 0.
    weights
        Of each element.
    sums
        A: what is shown of each element.
    bounds
        Upper bounds of the candidates' gains.
    positions, taken, spacing
        As those of `cover_kernel.CoverState`.
    """

    starts: NDArray[np.int64]
    items: NDArray[np.int32]
    amounts: NDArray[np.float32]
    weights: NDArray[np.float64]
    sums: NDArray[np.float64]
    bounds: NDArray[np.float64]
    positions: NDArray[np.float64]
    taken: NDArray[np.float64]
    spacing: float


@kernel
def gain_of(state: ErrorState, candidate: int) -> float:
    """How much f grows with a candidate."""
    gain = 0.0
    for i in range(state.starts[candidate], state.starts[candidate + 1]):
        j, amount = state.items[i], float(state.amounts[i])
        before = 1.0 + state.sums[j]
        gain += state.weights[j] * amount / (before * (before + amount))
    return gain


@kernel
def add_or_remove(state: ErrorState, candidate: int, sign: float) -> None:
    """Add a candidate (`sign` 1) or take it away (-1); bounds hold only while candidates are added."""
    for i in range(state.starts[candidate], state.starts[candidate + 1]):
        j = state.items[i]
        state.sums[j] = max(0.0, state.sums[j] + sign * float(state.amounts[i]))


@kernel
def error_taken(state: ErrorState) -> float:
    """F of what is chosen."""
    total = 0.0
    for j in range(len(state.weights)):
        total += state.weights[j] * state.sums[j] / (1.0 + state.sums[j])
    return total


@kernel
def fill_gains(state: ErrorState, gains: NDArray[np.float64]) -> None:
    """Write the gains of all candidates; as the state's own bounds they are exact for a while."""
    for candidate in range(len(gains)):
        gains[candidate] = gain_of(state, candidate)


@kernel
def greedy_steps(state: ErrorState, chosen: NDArray[np.int64], n_chosen: int, n_wanted: int) -> int:
    """Add the candidate of the largest gain until `n_wanted` are chosen or nothing is gained.

    None is chosen twice: its bound is minus infinity from then on. So is that of one too close to another.
    """
    least = NO_GAIN * state.weights.sum()
    while n_chosen < n_wanted:
        best, looked_at = int(np.argmax(state.bounds)), -1
        while best != looked_at and state.bounds[best] > least:
            state.bounds[best] = gain_of(state, best)
            looked_at, best = best, int(np.argmax(state.bounds))
        if state.bounds[best] <= least:
            break
        state.bounds[best] = -np.inf
        if not is_too_close(state, best, chosen, n_chosen, -1):
            add_or_remove(state, best, 1.0)
            chosen[n_chosen] = best
            n_chosen += 1
    return n_chosen


def error_state(
    model: ImageErrorModel,
    views: ViewpointArrays,
    locked: ViewpointArrays = NONE_LOCKED,
    spacing: SpacingRule = ANYWHERE,
    monitor: Monitor = QUIET,
    stop: Stop = never,
    n_least: int = 0,
) -> ErrorState:
    """Candidates with nothing chosen yet; what `locked` views show is known all the same.

    When `stop` asks for an end, those not yet looked at are left out: the state has the first of the candidates only,
    `n_least` or more, under the same numbers.
    """
    parts: list[Shown] = []
    for start, end in chunks(len(views.heading_rad), VIEWS_PER_BLOCK):
        if parts and start >= n_least and stop():
            break
        monitor.report(say("trying viewpoints"), start, len(views.heading_rad))
        parts.append(model.shown(take(views, np.arange(start, end))))
    shown, present = Shown.joined(parts), model.shown(locked)
    n = len(shown.starts) - 1
    state = ErrorState(
        *shown,
        weights=model.weights,
        sums=np.bincount(present.items, present.amounts, model.n_elements).astype(np.float64),
        bounds=np.zeros(n),
        positions=np.array(spacing.positions_enu_m, np.float64, order="C").reshape(-1, 3)[:n],
        taken=np.array(spacing.present_enu_m, np.float64, order="C").reshape(-1, 3),
        spacing=float(spacing.spacing_m),
    )
    fill_gains(state, state.bounds)
    return state


def choose_for_least_error(state: ErrorState, n_wanted: int, monitor: Monitor, stop: Stop = never) -> NDArray[np.int64]:
    """Numbers of candidates chosen greedily, in order, at most `n_wanted`; the state holds them afterwards.

    When `stop` asks for an end, the others are chosen among some whose gains were largest when they were looked at
    last.
    """
    chosen, n_chosen = np.zeros(min(n_wanted, len(state.bounds)), np.int64), 0
    while n_chosen < len(chosen):
        if stop():
            n_kept = max(LEAST_LATE, LATE_EACH * (len(chosen) - n_chosen))
            others = np.argsort(state.bounds)[:-n_kept]
            bounds, state.bounds[others] = state.bounds[others], -np.inf
            n_now = int(greedy_steps(state, chosen, n_chosen, len(chosen)))
            state.bounds[others] = bounds  # those that were kept may all be too close to others
            return chosen[: int(greedy_steps(state, chosen, n_now, len(chosen)))]
        monitor.report(say("choosing views"), n_chosen, len(chosen))
        slice_end = min(len(chosen), n_chosen + SLICE)
        n_now = int(greedy_steps(state, chosen, n_chosen, slice_end))
        if n_now < slice_end:
            return chosen[:n_now]
        n_chosen = n_now
    return chosen


def least_error(state: ErrorState, model: ImageErrorModel, n_more: int) -> float:
    """No `n_more` further candidates leave less expected error than this, whatever the state holds.

    Gains fall while views are added (submodularity), so the largest ones at this state bound what any views add.
    """
    gains = np.zeros(len(state.bounds))
    fill_gains(state, gains)
    left = model.most_error - float(error_taken(state))
    return max(model.floor, left - float(np.sort(gains)[::-1][: max(0, n_more)].sum()))


class ErrorGain:
    """Worth of a set of candidates: the expected error that they take away (`CoverageGain` of the routing)."""

    def __init__(self, state: ErrorState) -> None:
        self._state, self._is_fresh = state, True

    @property
    def value(self) -> float:
        """Mean square error taken away."""
        return float(error_taken(self._state))

    def marginals(self) -> NDArray[np.float64]:
        """What each candidate would take away beside those in the set, shape (n,)."""
        if not self._is_fresh:
            fill_gains(self._state, self._state.bounds)
            self._is_fresh = True
        return self._state.bounds

    def add(self, candidate: int) -> None:
        """Put a candidate into the set."""
        add_or_remove(self._state, candidate, 1.0)
        self._is_fresh = False

    def remove(self, candidate: int) -> None:
        """Take a candidate out of the set."""
        add_or_remove(self._state, candidate, -1.0)
        self._is_fresh = False


def expected_psnr_db(error: float, near_share: float) -> float:
    """Of pictures of unseen views, the mean over kinds of views, from their expected mean square error.

    Parameters
    ----------
    near_share
        Of what unseen views show mirrored (`ImageErrorModel.near_share`).
    """
    least, slope = CALIBRATION
    return least + slope * decibels(error) + float(np.interp(near_share, (FAR_SHARE, NEAR_SHARE), (FAR_DB, 0.0)))


def flight_worth(problem: ViewProblem, error: ImageErrorModel, plan: Plan, seed: int = 0) -> FlightWorth | None:
    """The worth of a plan; None where it has no photos, or nothing can be said of its site.

    Another battery is taken to last as long, and for as many photos, as the plan's longest sortie.
    """
    by_id = {viewpoint.id: viewpoint for viewpoint in plan.viewpoints}
    sorties = [sortie for sortie in plan.sorties if sortie.viewpoint_ids]
    if not sorties or not error.n_elements:
        return None
    parts = [viewpoint_arrays(tuple(by_id[each] for each in sortie.viewpoint_ids)) for sortie in sorties]
    sums = np.zeros(error.n_elements)
    batteries: list[BatteryWorth] = []
    for number, (sortie, views) in enumerate(zip(sorties, parts, strict=True), 1):
        shown = error.shown(views)
        sums += np.bincount(shown.items, shown.amounts, error.n_elements)
        before = batteries[-1] if batteries else BatteryWorth(0, 0.0, 0, 0.0)
        batteries.append(
            BatteryWorth(
                number,
                before.minutes + sortie.duration_s / 60.0,
                before.n_photos + len(views.heading_rad),
                expected_psnr_db(error.error_of(sums), error.near_share),
            )
        )
    longest = max(sorties, key=lambda sortie: sortie.duration_s)
    last, n_more = batteries[-1], len(longest.viewpoint_ids)
    candidates = spread_candidates(problem, FEW_CANDIDATES, np.random.default_rng([seed, 4]))
    state = error_state(error, candidates, concatenate(parts))
    chosen = choose_for_least_error(state, n_more, QUIET)
    another = None
    if len(chosen):
        left = expected_psnr_db(error.error_of(state.sums), error.near_share)
        minutes = last.minutes + longest.duration_s / 60.0
        another = BatteryWorth(last.n_batteries + 1, minutes, last.n_photos + len(chosen), left)
    deviation_db = DEVIATION_DB if error.near_share >= NEAR_SHARE else FAR_DEVIATION_DB
    return FlightWorth(tuple(batteries), another, deviation_db, poses_sha256(plan.viewpoints))

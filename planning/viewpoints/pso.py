"""The paper's optimiser: particle swarm over sets of N views with five degrees of freedom each (3.2, Eqs. 9 and 10).

One particle is a whole set of views, 5 N numbers: east, north, up, pitch, yaw. The paper gives the population (50) and
the iterations (200) and cites Kennedy and Eberhart for the rest; inertia and attraction are Clerc and Kennedy's
constriction values unless set otherwise. The constraint (distance from the facade; here all distances and the airspace)
is kept by leaving a view where it was, at rest, when its move would break it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import run_chunks
from planning.base.messages import say
from planning.base.progress import Monitor, Stop, Trace
from planning.coverage.positions import aimed_views, spread_positions
from planning.plan import ViewpointArrays
from planning.viewpoints.candidates import facing_targets
from planning.viewpoints.problem import Goal, ViewProblem, ViewSet, nothing_to_see

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class PsoParameters:
    """Settings of the swarm.

    Parameters
    ----------
    inertia
        At the first and the last iteration, linear in between.
    cognitive, social
        Attraction to a particle's own best and to the swarm's best.
    max_step
        Largest step per iteration, as a part of each coordinate's range.
    """

    population: int = 50
    iterations: int = 200
    inertia: tuple[float, float] = (0.7298, 0.7298)
    cognitive: float = 1.49618
    social: float = 1.49618
    max_step: float = 0.2

    def __post_init__(self) -> None:
        if self.population < 1 or self.iterations < 0:
            raise ValueError("expected a population of 1 or more and 0 or more iterations")


def pso(
    problem: ViewProblem,
    goal: Goal,
    *,
    seed: int,
    stop: Stop,
    trace: Trace,
    monitor: Monitor,
    parameters: PsoParameters = PsoParameters(),
) -> ViewSet:
    """Choose N views by particle swarm; trace values are covered elements of the swarm's best.

    Raises
    ------
    InfeasibleError
        There is no allowed viewpoint.
    ValueError
        The goal is a share of the coverage: this method needs the number of views (as the paper says).
    """
    if goal.n_views is None:
        raise ValueError("particle swarm needs a number of views")
    rng = np.random.default_rng(seed)
    camera = problem.model.camera
    position = _start(problem, goal.n_views, parameters.population, rng)
    low_pitch, high_pitch = np.radians(camera.gimbal_pitch_deg)
    low = np.array([*problem.space.low_enu_m, -np.pi, low_pitch])
    high = np.array([*problem.space.high_enu_m, np.pi, high_pitch])
    limit = parameters.max_step * (high - low)
    velocity = rng.uniform(-1.0, 1.0, position.shape) * limit
    fitness = _fitness(problem, position)
    own_best, own_fitness = position.copy(), fitness.copy()
    best = int(np.argmax(own_fitness))
    trace.record(own_fitness[best])
    for iteration in range(parameters.iterations):
        monitor.report(say("moving the swarm"), iteration, parameters.iterations)
        if stop():
            break
        share = iteration / max(1, parameters.iterations - 1)
        inertia = (1.0 - share) * parameters.inertia[0] + share * parameters.inertia[1]
        to_own, to_best = own_best - position, own_best[best] - position
        for towards in (to_own, to_best):
            towards[..., 3] = np.remainder(towards[..., 3] + np.pi, 2.0 * np.pi) - np.pi
        velocity = (
            inertia * velocity
            + parameters.cognitive * rng.random(position.shape) * to_own
            + parameters.social * rng.random(position.shape) * to_best
        )
        velocity = np.clip(velocity, -limit, limit)
        moved = position + velocity
        moved[..., 3] = np.remainder(moved[..., 3] + np.pi, 2.0 * np.pi) - np.pi
        moved[..., 4] = np.clip(moved[..., 4], low_pitch, high_pitch)
        allowed = problem.space.is_allowed(moved[..., :3].reshape(-1, 3)).reshape(moved.shape[:2])
        position = np.where(allowed[..., None], moved, position)
        velocity = np.where(allowed[..., None], velocity, 0.0)
        fitness = _fitness(problem, position)
        better = fitness > own_fitness
        own_best[better], own_fitness[better] = position[better], fitness[better]
        best = int(np.argmax(own_fitness))
        trace.record(own_fitness[best])
    views = own_best[best]
    return ViewSet(_views(views[problem.flyable(views[:, :3])]))


def _views(poses: Array) -> ViewpointArrays:
    return ViewpointArrays(poses[:, :3], poses[:, 3], poses[:, 4])


def _start(problem: ViewProblem, n_views: int, population: int, rng: np.random.Generator) -> Array:
    """Random allowed positions, aimed at panels that face them: shape (population, n_views, 5)."""
    space, model = problem.space, problem.model
    positions = spread_positions(space, model.frames, 2000, rng)
    if len(positions) == 0:
        raise nothing_to_see()
    n_needed = population * n_views
    while len(positions) < n_needed:
        positions = np.concatenate([positions, spread_positions(space, model.frames, 2 * n_needed, rng)])
    positions = positions[:n_needed]
    views = aimed_views(positions, facing_targets(model.frames, positions, rng), model.camera)
    poses = np.concatenate([positions, views.heading_rad[:, None], views.pitch_rad[:, None]], axis=1)
    return poses.reshape(population, n_views, 5)


def _fitness(problem: ViewProblem, position: Array) -> NDArray[np.int64]:
    """Covered elements of each particle, on all cores."""
    counts = np.empty(len(position), np.int64)

    def work(start: int, end: int) -> None:
        for i in range(start, end):
            counts[i] = problem.model.covered_count(_views(position[i]))

    run_chunks(work, [(i, i + 1) for i in range(len(position))])
    return counts

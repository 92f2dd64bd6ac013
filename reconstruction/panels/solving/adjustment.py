"""Facade-constrained least squares: lines of the grid, the surface they lie on and the poses of the photos, together.

Every point of a line in a photo is cast onto the surface. Its coordinate across the line must be the line's, whatever
photo it is from; poses may change within their covariance, and the surface within that of its fit. This gives corners
with covariances, which averages along rows and columns (the paper's regularisation) do not, and the freedom of a column
to be a vertical line, a row a level one, on a plane or a cylinder of any lean.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InfeasibleError
from planning.base.messages import say
from reconstruction.base.cameras import Pose, PosedPhoto
from reconstruction.panels.rectify.fit import SurfaceFit, changed
from reconstruction.panels.rectify.surface import FacadeSurface
from reconstruction.panels.solving.association import LineGroup, coordinates
from reconstruction.panels.solving.record import ObservedLine

Array = NDArray[np.float64]

ROUNDS = 8
"""Of linearising and solving: poses are good to metres and degrees, and it is nearly linear in them."""

HALVINGS = 8
"""Of a step that makes things worse, or moves a photo until it does not see the facade any more."""

CONVERGED_M = 1e-6

HUBER = 2.0
"""Residuals beyond so many standard deviations count linearly: a line of a wrong neighbour does not pull the rest."""

STEP_M = 1e-4
STEP_RAD = 1e-6
"""Of central differences."""

UNKNOWN_POSE = np.diag([5.0**2] * 3 + [np.radians(5.0) ** 2] * 3)
"""Covariance of a pose that states none: single GNSS, and a compass."""

LEAST_SIGMA_M = 0.003
"""Frames are built straight and evenly spaced to some millimetres, however sharply a photo shows them."""


@dataclass(frozen=True, slots=True, eq=False)
class Adjusted:
    """Result of the adjustment.

    Parameters
    ----------
    positions_m
        Of the groups in their order, shape (g,).
    covariance
        Shape (g + f, g + f): of the positions, then of the surface's change, f = 3 or 5.
    poses
        By the number of the photo.
    pose_changes
        Shape (6,) each.
    residual
        Root mean square of the weighted residuals, about 1 where all standard deviations are right.
    """

    surface: FacadeSurface
    positions_m: Array
    covariance: Array
    poses: dict[int, Pose]
    pose_changes: dict[int, Array]
    residual: float


def adjust(photos: Sequence[PosedPhoto], fit: SurfaceFit, groups: Sequence[LineGroup]) -> Adjusted:
    """Solve for lines, surface and poses.

    Parameters
    ----------
    photos
        Those that the lines' photo numbers count.

    Raises
    ------
    InfeasibleError
        There are no lines, or one of them is on no photo's side of the surface any more.
    """
    if not groups:
        raise InfeasibleError(say("no line of a grid was found in any photo of this facade"))
    numbers = sorted({line.photo for group in groups for line in group.members})
    state = _State(
        fit.surface,
        {number: photos[number] for number in numbers},
        {number: np.zeros(6) for number in numbers},
        np.zeros(len(fit.covariance)),
    )
    problem = _Problem.of(photos, fit, groups, numbers)
    positions = np.array([np.mean([line.position_m for line in group.members]) for group in groups])
    covariance, residual = np.zeros((0, 0)), np.inf
    for _ in range(ROUNDS):
        step, covariance, residual = problem.solve(state, positions)
        cost = problem.cost(state, positions)
        for _ in range(HALVINGS):
            tried = state.moved(step[len(groups) :], numbers)
            if problem.cost(tried, positions + step[: len(groups)]) <= cost:
                positions, state = positions + step[: len(groups)], tried
                break
            step = 0.5 * step
        else:
            break
        if np.abs(step).max() < CONVERGED_M:
            break
    keep = len(groups) + len(fit.covariance)
    return Adjusted(
        state.surface,
        positions,
        covariance[:keep, :keep],
        {number: photo.pose for number, photo in state.photos.items()},
        state.pose_changes,
        residual,
    )


@dataclass(frozen=True, slots=True, eq=False)
class _State:
    surface: FacadeSurface
    photos: dict[int, PosedPhoto]
    pose_changes: dict[int, Array]
    surface_change: Array

    def moved(self, step: Array, numbers: list[int]) -> _State:
        n = len(self.surface_change)
        surface = changed(self.surface, step[:n])
        parts = {number: step[n + 6 * i : n + 6 * i + 6] for i, number in enumerate(numbers)}
        photos = {
            number: replace(photo, pose=moved_pose(photo.pose, parts[number])) for number, photo in self.photos.items()
        }
        changes = {number: change + parts[number] for number, change in self.pose_changes.items()}
        return _State(surface, photos, changes, self.surface_change + step[:n])


@dataclass(frozen=True, slots=True, eq=False)
class _Problem:
    """The observations by photo, and the priors."""

    lines: dict[int, list[ObservedLine]]
    groups: dict[int, NDArray[np.int64]]
    sigmas: dict[int, Array]
    pose_information: dict[int, Array]
    surface_information: Array
    n_groups: int
    numbers: list[int]

    @classmethod
    def of(
        cls, photos: Sequence[PosedPhoto], fit: SurfaceFit, groups: Sequence[LineGroup], numbers: list[int]
    ) -> _Problem:
        lines: dict[int, list[ObservedLine]] = {number: [] for number in numbers}
        index: dict[int, list[int]] = {number: [] for number in numbers}
        for i, group in enumerate(groups):
            for line in group.members:
                lines[line.photo].append(line)
                index[line.photo].append(i)
        k = len(groups[0].members[0].points_px)
        return cls(
            lines,
            {number: np.array(index[number], np.int64) for number in numbers},
            {
                number: np.sqrt(k) * np.maximum([line.sigma_m for line in lines[number]], LEAST_SIGMA_M)
                for number in numbers
            },
            {number: _information(photos[number].pose.covariance) for number in numbers},
            np.asarray(np.linalg.pinv(fit.covariance, hermitian=True), float),
            len(groups),
            numbers,
        )

    def solve(self, state: _State, positions: Array) -> tuple[Array, Array, float]:
        """Step, covariance and weighted residual of one linearisation; unknowns: lines, surface, poses."""
        n_surface = len(state.surface_change)
        size = self.n_groups + n_surface + 6 * len(self.numbers)
        normal, right = np.zeros((size, size)), np.zeros(size)
        squares, count = 0.0, 0
        for order, number in enumerate(self.numbers):
            design, residual = self._of_photo(state, positions, number, order, size)
            weight = np.minimum(1.0, HUBER / np.maximum(np.abs(residual), 1e-12))
            normal += design.T @ (weight[:, None] * design)
            right += design.T @ (weight * residual)
            squares, count = squares + float(weight @ residual**2), count + len(residual)
        block = slice(self.n_groups, self.n_groups + n_surface)
        normal[block, block] += self.surface_information
        right[block] -= self.surface_information @ state.surface_change
        for order, number in enumerate(self.numbers):
            start = self.n_groups + n_surface + 6 * order
            part = slice(start, start + 6)
            normal[part, part] += self.pose_information[number]
            right[part] -= self.pose_information[number] @ state.pose_changes[number]
        covariance = _inverse(normal)
        return covariance @ right, covariance, float(np.sqrt(squares / max(1, count)))

    def cost(self, state: _State, positions: Array) -> float:
        """Half the sum of squares, linear beyond `HUBER`, priors included; inf where a photo sees nothing any more."""
        total = float(state.surface_change @ self.surface_information @ state.surface_change)
        for number in self.numbers:
            change = state.pose_changes[number]
            total += float(change @ self.pose_information[number] @ change)
            here = coordinates(state.photos[number], state.surface, self.lines[number])
            if not np.isfinite(here).all():
                return np.inf
            off = np.abs(here - positions[self.groups[number]][:, None]) / self.sigmas[number][:, None]
            total += float(np.where(off <= HUBER, off**2, HUBER * (2.0 * off - HUBER)).sum())
        return 0.5 * total

    def _of_photo(self, state: _State, positions: Array, number: int, order: int, size: int) -> tuple[Array, Array]:
        """Design matrix and residuals of one photo's points, weighted."""
        photo, lines, groups = state.photos[number], self.lines[number], self.groups[number]
        here = coordinates(photo, state.surface, lines)
        if not np.isfinite(here).all():
            raise InfeasibleError(say("its pose was moved until the facade fell out of sight", place=photo.name))
        k = here.shape[1]
        sigma = np.repeat(self.sigmas[number], k)
        design = np.zeros((here.size, size))
        rows = np.arange(here.size)
        design[rows, np.repeat(groups, k)] = 1.0
        n_surface = len(state.surface_change)
        for i in range(n_surface):
            step = np.zeros(n_surface)
            step[i] = STEP_M if i in (0, 4) else STEP_RAD
            ahead = coordinates(photo, changed(state.surface, step), lines)
            behind = coordinates(photo, changed(state.surface, -step), lines)
            design[:, self.n_groups + i] = -((ahead - behind) / (2.0 * step[i])).ravel()
        for i in range(6):
            step = np.zeros(6)
            step[i] = STEP_M if i < 3 else STEP_RAD
            ahead = coordinates(replace(photo, pose=moved_pose(photo.pose, step)), state.surface, lines)
            behind = coordinates(replace(photo, pose=moved_pose(photo.pose, -step)), state.surface, lines)
            design[:, self.n_groups + n_surface + 6 * order + i] = -((ahead - behind) / (2.0 * step[i])).ravel()
        residual = (here - positions[groups][:, None]).ravel()
        return design / sigma[:, None], residual / sigma


def moved_pose(pose: Pose, change: Array) -> Pose:
    """Pose with a change in the order of its covariance: position (m, ENU), small rotation (rad, camera axes)."""
    from scipy.spatial.transform import Rotation

    turn = np.asarray(Rotation.from_rotvec(change[3:]).as_matrix(), float)
    return Pose(pose.position_enu_m + change[:3], turn @ pose.cam_from_enu, pose.covariance)


def _information(covariance: Array | None) -> Array:
    return _inverse(UNKNOWN_POSE if covariance is None else covariance)


def _inverse(matrix: Array) -> Array:
    """Inverse of a symmetric positive matrix of mixed units: scaled to a unit diagonal first."""
    scale = 1.0 / np.sqrt(np.maximum(np.diag(matrix), 1e-300))
    scaled = matrix * scale[:, None] * scale[None, :]
    return np.asarray(np.linalg.pinv(scaled, rcond=1e-13, hermitian=True) * scale[:, None] * scale[None, :], float)

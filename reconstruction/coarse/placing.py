"""A model without place, size and north gets them: by control points, by where its photos were taken, or by a length.

All that is known is adjusted together: receivers' positions with their covariances, angles of gimbals, control points,
distances, and what is up. Receivers have outliers, so a first similarity is sampled (scale, heading and place of a
model that stands upright already), and the adjustment is robust. Its normal matrix says how well scale, tilt and north
are known; what nothing says is said.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from planning.base.errors import InputError
from planning.base.findings import Finding, Severity
from planning.base.messages import say
from planning.geo.frames import Origin
from planning.geo.geoid import amsl_from_ellipsoid_m
from planning.photos.record import PhotoMetadata
from reconstruction.base.cameras import PosedPhoto
from reconstruction.coarse.cloud import Up, turn_upright, up_of_cameras, upright_axes
from reconstruction.colmap.georeference import MAD_TO_SIGMA, Similarity, are_on_a_line, fit_robustly, posed_photos
from reconstruction.colmap.record import ColmapModel

Array = NDArray[np.float64]

ScaleFrom = Literal["control points", "positions", "stated distances", "height of eyes", "height of flight"]


class SizeUnknownError(InputError):
    """Nothing says how large a model is, and there is nothing to guess it by."""


GUESSED = ("height of eyes", "height of flight")
"""Where a size is from that nothing says."""


@dataclass(frozen=True, slots=True)
class Above:
    """The usual camera above the ground, in the model's unit: what gives a size where nothing else does.

    Parameters
    ----------
    is_flown
        Whether it looks down like a drone's, and not ahead like a person's.
    is_ground_seen
        Else the lowest points count as ground.
    """

    height: float
    is_flown: bool = False
    is_ground_seen: bool = True

    @property
    def scale_from(self) -> ScaleFrom:
        """What the size is from."""
        return "height of flight" if self.is_flown else "height of eyes"

    @property
    def metres(self) -> float:
        """What the height is taken to be."""
        return FLOWN_M if self.is_flown else EYES_M

    @property
    def factor(self) -> float:
        """By which the size may be wrong."""
        return GUESSED_FACTOR if self.is_ground_seen and not self.is_flown else LOOSE_FACTOR


EYES_M, FLOWN_M = 1.6, 40.0
"""Of people who hold cameras, and of drones around buildings, above the ground."""

GUESSED_FACTOR, LOOSE_FACTOR = 2.0, 4.0
"""By which the size may be wrong where it is guessed: a castle came twice too large, since the ground was found half as
far below the cameras as it is. Drones fly between 10 and 120 m."""

N_SAMPLES = 1000
ROBUST_SIGMAS = 3.0

LEAST_SIGMA_M = 0.005
"""Positions are taken to be no better than this: RTK's own standard deviations leave out lever arm and timing."""

CONTROL_SIGMA_M = 0.02
"""Of control points in the model: surveyed to a centimetre, and measured in photos to a pixel."""

BETTER = 0.5
"""Points that fit so much better with another direction up, in parts, say that up is not where cameras put it: they
look straight down, or were held upright."""

UPSIDE_DOWN = -0.5
"""Cosine between both directions up: cameras that look straight down and are turned alike are wrong by 90 degrees, but
points that want more have east and north exchanged."""

LEAST_FREE = 4
"""Points that tell more than the similarity that is fitted to them."""

FAR_SHARE, LEAST_FAR_M = 0.01, 0.1
"""Control points contradict the model if it misses them by more, in parts of the site's size, and at least."""

WELL_KNOWN = 0.02
"""Standard deviation of the scale from which on it is told."""


@dataclass(frozen=True, slots=True, eq=False)
class Measured:
    """What is known of a photo beside the model; None where nothing is.

    Parameters
    ----------
    position_enu_m, covariance
        Shapes (3,) and (3, 3), m^2.
    cam_from_enu, angle_information
        Rotation, and the inverse covariance of its angles in camera axes as one of all photos, shapes (3, 3).
    """

    position_enu_m: Array | None = None
    covariance: Array | None = None
    cam_from_enu: Array | None = None
    angle_information: Array | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Control:
    """Points that are known in both frames, shapes (m, 3) and (m, 3), and cameras whose distance is known.

    Parameters
    ----------
    distances
        Rows of two cameras and the metres between them.
    """

    points: Array
    points_enu_m: Array
    distances: tuple[tuple[int, int, float], ...] = ()


NO_CONTROL = Control(np.zeros((0, 3)), np.zeros((0, 3)))


@dataclass(frozen=True, slots=True, eq=False)
class Placed:
    """Where a model lies.

    Parameters
    ----------
    enu_from_model
        Similarity.
    scale_from
        What its size is from.
    sigma_scale, sigma_tilt_deg, sigma_north_deg
        Standard deviations of the size, in parts of it, and of the turns; infinite where nothing says so.
    residuals_m
        Of the photos' positions, shape (n, 3), NaN where there is none.
    is_used
        Shape (n,): positions that do not contradict the model.
    control_residuals_m
        Shape (m, 3).
    is_control_used
        Shape (m,): control points that do not contradict the others.
    guessed_factor
        By which the size may be wrong where nothing says it.
    """

    enu_from_model: Similarity
    scale_from: ScaleFrom
    sigma_scale: float
    sigma_tilt_deg: float
    sigma_north_deg: float
    residuals_m: Array
    is_used: NDArray[np.bool_]
    control_residuals_m: Array
    is_control_used: NDArray[np.bool_]
    guessed_factor: float | None = None
    findings: tuple[Finding, ...] = ()


def place_model(
    centres: Array,
    rotations: Array,
    measured: Sequence[Measured],
    up: Up,
    control: Control = NO_CONTROL,
    above: Above | None = None,
    seed: int = 0,
) -> Placed:
    """Fit a model to all that is known of it.

    Parameters
    ----------
    centres, rotations
        Of the model's cameras, shapes (n, 3) and (n, 3, 3), camera from model.
    measured
        Of each of them.
    up
        In the model.
    above
        The ground; None where it is not known.

    Raises
    ------
    InputError
        What is known does not fit the model, or gives it no size.
    """
    has_place = np.array([one.position_enu_m is not None for one in measured])
    places = np.array([np.full(3, np.nan) if one.position_enu_m is None else one.position_enu_m for one in measured])
    sigmas = np.array([math.sqrt(np.trace(_covariance(one)) / 3.0) for one in measured])
    turn = turn_upright(up.direction)
    known = _known_points(centres, places, sigmas, has_place, control)
    spread_m = _spread(known[1])
    start: Similarity | None = None
    scale_from: ScaleFrom = "control points" if len(control.points) >= 2 else "positions"
    if len(known[0]) >= 2 and _spread(known[0]) > 0.0 and spread_m > 0.0:
        start, up = _of_points(*known, up, seed)
    if start is None or (control.distances and not len(control.points)):
        start, scale_from = _stated(centres, turn, measured, rotations, control, above, start)
    at, jacobian = _adjusted(start, scale_from, centres, rotations, measured, up, control)
    placed = _as_similarity(at, start)
    good = _fitting_control(placed, control)
    if not good.all():
        without = replace(control, points=control.points[good], points_enu_m=control.points_enu_m[good])
        at, jacobian = _adjusted(placed, scale_from, centres, rotations, measured, up, without)
        placed = _as_similarity(at, placed)
    residuals = placed(centres) - places
    off_control = placed(control.points) - control.points_enu_m if len(control.points) else np.zeros((0, 3))
    used = np.zeros(len(centres), bool)
    far = np.linalg.norm(residuals[has_place], axis=1) / sigmas[has_place]
    unit = max(1.0, float(np.median(far)) * MAD_TO_SIGMA) if len(far) else 1.0
    used[has_place] = far <= ROBUST_SIGMAS * math.sqrt(3.0) * unit
    if scale_from == "control points":
        unit = max(1.0, float(np.median(np.linalg.norm(off_control, axis=1))) / CONTROL_SIGMA_M * MAD_TO_SIGMA)
    sigma = _sigmas(jacobian, unit)
    findings = _findings(scale_from, above, sigma, used, has_place, spread_m)
    return Placed(
        placed,
        scale_from,
        sigma[1] if scale_from not in GUESSED else math.inf,
        math.degrees(sigma[0]),
        math.degrees(sigma[2]),
        residuals,
        used,
        off_control,
        good,
        above.factor if above is not None and scale_from in GUESSED else None,
        (*findings, *_about_control(off_control[good], spread_m)),
    )


def _of_points(a: Array, b: Array, sigmas: Array, up: Up, seed: int) -> tuple[Similarity | None, Up]:
    """A similarity by points that are known in both frames, and what is up: they may contradict the cameras."""
    upright = _sampled(a, b, sigmas, turn_upright(up.direction), seed)
    if len(a) < LEAST_FREE or are_on_a_line(a) or are_on_a_line(b):
        return upright, up
    free = fit_robustly(a, b, sigmas, seed=seed)[0]
    away = float(np.median(np.linalg.norm(free(a) - b, axis=1) / sigmas))
    if float(free.rotation[2] @ up.direction) < UPSIDE_DOWN:
        return upright, up
    if upright is not None:
        with_up = float(np.median(np.linalg.norm(upright(a) - b, axis=1) / sigmas))
        if BETTER * with_up <= max(away, 1.0 / MAD_TO_SIGMA):
            return upright, up
    return free, Up(np.asarray(free.rotation[2]), math.radians(90.0))


def _fitting_control(placed: Similarity, control: Control) -> NDArray[np.bool_]:
    """Which control points the model does not miss by far more than the others, shape (m,)."""
    if len(control.points) < LEAST_FREE:
        return np.ones(len(control.points), bool)
    far = np.linalg.norm(placed(control.points) - control.points_enu_m, axis=1)
    unit_m = max(CONTROL_SIGMA_M, float(np.median(far)) * MAD_TO_SIGMA)
    return np.asarray(far <= ROBUST_SIGMAS * math.sqrt(3.0) * unit_m)


def _about_control(residuals_m: Array, spread_m: float) -> list[Finding]:
    if not len(residuals_m):
        return []
    median_m = float(np.median(np.linalg.norm(residuals_m, axis=1)))
    most_m = max(LEAST_FAR_M, FAR_SHARE * spread_m)
    if median_m <= most_m:
        return []
    text = say(
        "the model misses the control points by {:.2f} m in the median; a receiver without corrections measures them "
        "no better, else look at their coordinates, the order of east and north, and their pixels",
        median_m,
    )
    return [Finding(Severity.WARNING, "control-contradicts", text, "", median_m, most_m, "m")]


def _known_points(
    centres: Array, places: Array, sigmas: Array, has_place: NDArray[np.bool_], control: Control
) -> tuple[Array, Array, Array]:
    """Pairs of points in both frames, and their standard deviations; control points alone where there are enough."""
    if len(control.points) >= 2:
        return control.points, control.points_enu_m, np.full(len(control.points), CONTROL_SIGMA_M)
    return centres[has_place], places[has_place], np.maximum(sigmas[has_place], LEAST_SIGMA_M)


def _spread(points: Array) -> float:
    """Largest standard deviation along an axis."""
    return float(np.sqrt(points.var(axis=0).max())) if len(points) > 1 else 0.0


def _sampled(a: Array, b: Array, sigmas: Array, turn: Array, seed: int) -> Similarity | None:
    """Scale, heading and place of an upright model by the sample of two points that most others agree with."""
    rng = np.random.default_rng(seed)
    upright = a @ turn.T
    n = len(a)
    best, least = None, math.inf
    pairs = [(i, j) for i in range(n) for j in range(i)]
    if len(pairs) > N_SAMPLES:
        pairs = [(int(i), int(j)) for i, j in rng.integers(0, n, (N_SAMPLES, 2)) if i != j]
    wide = _spread(upright[:, :2])
    for i, j in pairs:
        one, other = upright[i] - upright[j], b[i] - b[j]
        flat_one, flat_other = complex(one[0], one[1]), complex(other[0], other[1])
        if abs(flat_one) < 0.2 * wide or abs(flat_other) == 0.0:
            continue
        scale = float(np.linalg.norm(other) / np.linalg.norm(one))
        angle = float(np.angle(flat_other / flat_one))
        heading = Rotation.from_rotvec([0.0, 0.0, angle]).as_matrix()
        turned = scale * upright @ heading.T
        shift = np.median(b - turned, axis=0)
        away = float(np.median(np.linalg.norm(turned + shift - b, axis=1) / sigmas))
        if away < least:
            least, best = away, Similarity(scale, heading @ turn, shift)
    return best


def _stated(
    centres: Array,
    turn: Array,
    measured: Sequence[Measured],
    rotations: Array,
    control: Control,
    above: Above | None,
    by_places: Similarity | None,
) -> tuple[Similarity, ScaleFrom]:
    """A similarity whose size is that of stated distances, or else a guess; north by gimbals where they say so."""
    if control.distances:
        parts = [metres / float(np.linalg.norm(centres[i] - centres[j])) for i, j, metres in control.distances]
        scale, scale_from = float(np.median(parts)), "stated distances"
    elif above is not None and above.height > 0.0:
        scale, scale_from = above.metres / above.height, above.scale_from
    else:
        raise SizeUnknownError(
            say(
                "nothing says how large the model is: the photos have no positions, and nothing was found below them; "
                "measure how far apart two photos were taken, or survey control points, and state it"
            )
        )
    turns = [
        one.cam_from_enu.T @ rotation @ turn.T
        for one, rotation in zip(measured, rotations, strict=True)
        if one.cam_from_enu is not None
    ]
    heading = np.eye(3)
    if by_places is not None:
        heading = by_places.rotation @ turn.T
    elif turns:
        total = np.sum(turns, axis=0)
        angle = math.atan2(total[1, 0] - total[0, 1], total[0, 0] + total[1, 1])
        heading = Rotation.from_rotvec([0.0, 0.0, angle]).as_matrix()
    rotation = heading @ turn
    places = [
        one.position_enu_m - scale * (rotation @ centre)
        for one, centre in zip(measured, centres, strict=True)
        if one.position_enu_m is not None
    ]
    shift = np.median(places, axis=0) if places else -scale * (rotation @ np.median(centres, axis=0))
    return Similarity(scale, rotation, np.asarray(shift)), scale_from  # type: ignore[return-value]


def _as_similarity(at: Array, start: Similarity) -> Similarity:
    """Turn (ENU, on the left, about the place of the start's origin), log scale and shift on top of a start."""
    turn = Rotation.from_rotvec(at[:3]).as_matrix()
    return Similarity(start.scale * math.exp(at[3]), turn @ start.rotation, start.translation + at[4:])


def _adjusted(
    start: Similarity,
    scale_from: ScaleFrom,
    centres: Array,
    rotations: Array,
    measured: Sequence[Measured],
    up: Up,
    control: Control,
) -> tuple[Array, Array]:
    """The seven unknowns after a robust adjustment, and its Jacobian, all in standard deviations."""
    middle = centres.mean(axis=0)
    local = Similarity(start.scale, start.rotation, start(middle[None])[0])
    rows = [i for i, one in enumerate(measured) if one.position_enu_m is not None]
    whitened = [
        np.linalg.inv(np.linalg.cholesky(_covariance(measured[i]) + LEAST_SIGMA_M**2 * np.eye(3))) for i in rows
    ]
    turned = [i for i, one in enumerate(measured) if one.cam_from_enu is not None and one.angle_information is not None]
    roots = [np.linalg.cholesky(np.asarray(measured[i].angle_information)).T for i in turned]
    uses_places = scale_from != "control points"

    def residuals(at: Array) -> Array:
        now = _as_similarity(at, local)
        parts = []
        if rows and uses_places:
            off = now(centres[rows] - middle) - np.array([measured[i].position_enu_m for i in rows])
            parts.append(np.einsum("nij,nj->ni", whitened, off).ravel())
        for i, root in zip(turned, roots, strict=True):
            apart = rotations[i] @ now.rotation.T @ np.asarray(measured[i].cam_from_enu).T
            parts.append(root @ Rotation.from_matrix(apart).as_rotvec())
        if len(control.points):
            parts.append(((now(control.points - middle) - control.points_enu_m) / CONTROL_SIGMA_M).ravel())
        for i, j, metres in control.distances:
            length = now.scale * float(np.linalg.norm(centres[i] - centres[j]))
            parts.append(np.array([math.log(length / metres) / 0.005]))
        parts.append((now.rotation @ up.direction)[:2] / up.sigma_rad)
        if scale_from in GUESSED:
            parts.append(np.array([at[3] / 1e-3]))
        # What nothing fixes stays where it is.
        parts.append(1e-6 * at)
        return np.concatenate(parts)

    scale = np.array([1e-3, 1e-3, 1e-3, 1e-3, 0.1, 0.1, 0.1])
    found = least_squares(residuals, np.zeros(7), loss="soft_l1", f_scale=2.0, x_scale=scale)
    at = found.x
    # Back from turning about the cameras' middle to turning about the model's zero.
    now = _as_similarity(at, local)
    whole = Similarity(now.scale, now.rotation, now.translation - now.scale * (now.rotation @ middle))
    turn = Rotation.from_matrix(whole.rotation @ start.rotation.T).as_rotvec()
    shift = whole.translation - start.translation
    return np.concatenate([turn, [math.log(whole.scale / start.scale)], shift]), np.asarray(found.jac)


def _covariance(one: Measured) -> Array:
    return np.eye(3) if one.covariance is None else one.covariance


def in_sigmas(placed: Placed, measured: Sequence[Measured]) -> float:
    """Median distance of a model from where its photos say they were taken, in standard deviations of that; 0 for none.

    Parameters
    ----------
    measured
        Of each photo of the model.
    """
    sigmas = np.array([max(LEAST_SIGMA_M, math.sqrt(np.trace(_covariance(one)) / 3.0)) for one in measured])
    far = np.linalg.norm(placed.residuals_m, axis=1) / sigmas
    return float(np.median(far[np.isfinite(far)])) if np.isfinite(far).any() else 0.0


def contradicts(placed: Placed, measured: Sequence[Measured]) -> bool:
    """Whether most positions are further from the model than they can be by what they state of themselves."""
    return in_sigmas(placed, measured) > ROBUST_SIGMAS * math.sqrt(3.0)


def _sigmas(jacobian: Array, unit: float) -> tuple[float, float, float]:
    """Standard deviations of the tilt, the scale, and the heading; infinite for what nothing fixes."""
    values, axes = np.linalg.eigh(jacobian.T @ jacobian)
    fixed = values > 1e-9
    variances = np.where(fixed, 1.0 / np.where(fixed, values, 1.0), 0.0)
    squares = axes**2
    found = []
    for rows in ((0, 1), (3,), (2,)):
        is_open = bool((squares[list(rows)][:, ~fixed] > 1e-6).any())
        found.append(math.inf if is_open else math.sqrt(float((squares[list(rows)] @ variances).max())) * unit)
    return found[0], found[1], found[2]


def _findings(
    scale_from: ScaleFrom,
    above: Above | None,
    sigma: tuple[float, float, float],
    used: NDArray[np.bool_],
    has_place: NDArray[np.bool_],
    spread_m: float,
) -> tuple[Finding, ...]:
    found = []
    if scale_from in GUESSED and above is not None:
        text = say(
            "the size is a guess, wrong by up to a factor of {:g}: cameras are taken to be {:.1f} m above the lowest "
            "ground that was found. Before anything is flown, measure how far apart two photos were taken, or survey "
            "control points, and state it",
            above.factor,
            above.metres,
        )
        found.append(Finding(Severity.WARNING, "scale-guessed", text, "", above.factor, None, ""))
    elif sigma[1] > WELL_KNOWN:
        text = (
            say("the control points say the size of the model to {:.0f} % only", 100.0 * sigma[1])
            if scale_from == "control points"
            else say(
                "the size of the model is known to {:.0f} % only: the receivers are off by too much for photos that "
                "are {:.0f} m apart; state a distance or control points",
                100.0 * sigma[1],
                2.0 * spread_m,
            )
        )
        found.append(Finding(Severity.WARNING, "scale-unsure", text, "", 100.0 * sigma[1], 100.0 * WELL_KNOWN, "%"))
    if not math.isfinite(sigma[2]) or sigma[2] > math.radians(90.0):
        text = say("nothing says where north is: it is taken to be ahead of the first photo")
        found.append(Finding(Severity.WARNING, "north-unknown", text))
    n_out = int((has_place & ~used).sum())
    if n_out:
        text = say("the positions of {} of {} photos contradict the model", n_out, int(has_place.sum()))
        found.append(Finding(Severity.WARNING, "positions-contradict", text, "", float(n_out), 0.0, "photos"))
    return tuple(found)


LOWEST_GROUND_M = -15.0
"""Above sea level: only the shores of some salt lakes are lower. Elsewhere the heights of receivers are off."""


def about_height(origin: Origin) -> tuple[Finding, ...]:
    """Whether receivers put the ground where none is: some aircraft write heights that are off by tens of metres.

    Parameters
    ----------
    origin
        On the ground.
    """
    amsl_m = float(amsl_from_ellipsoid_m(origin.lat_deg, origin.lon_deg, origin.ellipsoid_height_m))
    if amsl_m >= LOWEST_GROUND_M:
        return ()
    text = say(
        "by the heights in the photos the ground is {:.0f} m below sea level: unless it is, they are off by that, and "
        "the height of the site with them; its sizes are not. Survey control points before missions with absolute "
        "heights",
        -amsl_m,
    )
    return (Finding(Severity.WARNING, "ground-below-sea", text, "", amsl_m, LOWEST_GROUND_M, "m"),)


def _median_off_m(placed: Placed) -> float:
    return float(np.nanmedian(np.linalg.norm(placed.residuals_m, axis=1)))


def about_positions(placed: Placed, measured: Sequence[Measured]) -> tuple[Finding, ...]:
    """What is said where positions contradict the model; arguments as of `in_sigmas`."""
    if not contradicts(placed, measured):
        return ()
    times = in_sigmas(placed, measured)
    text = say(
        "the model misses the photos' positions by {:.2f} m in the middle, {:.0f} times what these state: the lens, "
        "the time of exposure or the mount of the antenna is off, or RTK was not fixed; check a known length",
        _median_off_m(placed),
        times,
    )
    return (Finding(Severity.WARNING, "positions-missed", text, "", _median_off_m(placed), None, "m"),)


# A model of which nothing is known but itself: of other programs, for splats without a site.

UPRIGHT_DEG = 10.0
"""A model that stands so nearly upright is left as it is: cameras tell what is up no better."""

NEAREST, FARTHEST = 3.0, 300.0
"""From cameras to what they show, in units of a model that are taken for metres: splats, and their distance from
cameras, are limited in metres."""

FAR_OFF = 1000.0
"""Units from zero, from which on a model is moved there: positions of splats are stored to seven digits."""

N_LOOKED_AT, N_POINTS = 64, 2000
"""Cameras and points, evenly chosen, that tell how far cameras are from what they show."""


def in_own_frame(model: ColmapModel, metadata: Mapping[str, PhotoMetadata]) -> tuple[Similarity, tuple[Finding, ...]]:
    """A frame for a model that nothing else is known of: its own, turned upright, with units that can be metres.

    It is turned where its cameras say that it lies on its side, scaled by a power of ten where its cameras are too near
    to what they show or too far off, and moved by whole units where it is far from zero.

    Parameters
    ----------
    metadata
        Of its photos, by name, as far as it is known: which pictures are stored turned.
    """
    photos = posed_photos(model, Similarity.identity(), Path())
    axes = []
    for photo in photos:
        stored, lens = metadata.get(photo.name), photo.intrinsics
        is_as_stored = stored is not None and (stored.width_px < stored.height_px) == (lens.width_px < lens.height_px)
        axes.append(upright_axes(stored if is_as_stored else None))
    turns = [photo.pose.cam_from_enu.T for photo in photos]
    rights = np.array([turn @ right for turn, (right, _) in zip(turns, axes, strict=True)])
    downs = np.array([turn @ down for turn, (_, down) in zip(turns, axes, strict=True)])
    up = up_of_cameras(rights, downs).direction
    tilt_deg = math.degrees(math.acos(float(np.clip(up[2], -1.0, 1.0))))
    rotation = turn_upright(up) if tilt_deg > UPRIGHT_DEG else np.eye(3)
    away = usual_distance(photos, model.points.xyz)
    scale = 1.0
    if not NEAREST <= away < FARTHEST:
        scale = 10.0 ** math.ceil(math.log10(NEAREST / away))
    middle = scale * rotation @ np.median([photo.pose.position_enu_m for photo in photos], axis=0)
    shift = -np.round(middle) if np.abs(middle).max() > FAR_OFF else np.zeros(3)
    return Similarity(scale, rotation, shift), _of_own_frame(scale, tilt_deg, shift)


def _of_own_frame(scale: float, tilt_deg: float, shift: Array) -> tuple[Finding, ...]:
    text = say(
        "nothing says where on earth the photos were taken, or how large what they show is: the frame is that of their "
        "model, and one unit of it counts as {:g} m",
        scale,
    )
    findings = [Finding(Severity.NOTE, "frame-of-model", text, "", scale, None, "m")]
    if tilt_deg > UPRIGHT_DEG:
        text = say("the model was turned by {:.0f} degrees, so that its cameras stand upright", tilt_deg)
        findings.append(Finding(Severity.NOTE, "model-turned", text, "", tilt_deg, None, "deg"))
    if shift.any():
        text = say("the model was moved by {:m}, which brings it near zero", tuple(shift.tolist()))
        findings.append(Finding(Severity.NOTE, "model-moved", text, "", float(np.linalg.norm(shift)), None, "m"))
    return tuple(findings)


def usual_distance(photos: Sequence[PosedPhoto], points: Array) -> float:
    """From cameras to what they show: to points, shape (n, 3), or else to where most of them look.

    Where there are neither, as far as cameras are spread, and 1 for a single one.
    """
    chosen = [photos[row] for row in np.unique(np.linspace(0, len(photos) - 1, N_LOOKED_AT).round().astype(int))]
    some = points[:: max(1, len(points) // N_POINTS)]
    found = []
    for photo in chosen:
        seen = some[photo.sees(some)] if len(some) else some
        if len(seen):
            found.append(float(np.median(np.linalg.norm(seen - photo.pose.position_enu_m, axis=1))))
    if found and np.median(found) > 0.0:
        return float(np.median(found))
    centres = np.array([photo.pose.position_enu_m for photo in chosen])
    ahead = np.array([photo.pose.forward_enu for photo in chosen])
    across = np.eye(3) - ahead[:, :, None] * ahead[:, None, :]
    normal = across.sum(axis=0)
    if len(chosen) > 1 and np.linalg.cond(normal) < MOST_PARALLEL:
        middle = np.linalg.solve(normal, np.einsum("nij,nj->i", across, centres))
        depths = ((middle - centres) * ahead).sum(axis=1)
        if np.median(depths) > 0.0:
            return float(np.median(depths))
    return _spread(centres) or 1.0


MOST_PARALLEL = 1e3
"""Condition of the place where cameras look, beyond which their axes are parallel, and there is none."""

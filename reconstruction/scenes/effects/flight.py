"""Effects of the flight: what moves while the shutter is open, changes from photo to photo, or is told wrong."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import Assessment
from planning.base.messages import say
from reconstruction.base.cameras import PosedPhoto
from reconstruction.scenes.effects.probe import (
    N_PHOTOS,
    QUANTILE,
    RAYS_PER_PIXEL,
    SECONDS_PER_RAY,
    TOLERANCE_GREY,
    TOLERANCE_PX,
    Probe,
    spread,
)
from reconstruction.scenes.light.pane_surfaces import mirrored
from reconstruction.scenes.parameters import EXPOSURE, GIMBAL_ERROR, MOTION_BLUR, POSITION_ERROR
from reconstruction.scenes.photos.camera_model import in_stops
from reconstruction.scenes.photos.lens_effects import DARKEST, MIDDLE_GREY, grey_levels
from reconstruction.scenes.photos.motion_blur import MOST_TIMES, NEAREST_M, PX_PER_TIME
from reconstruction.scenes.photos.pose_errors import reported_poses
from reconstruction.scenes.photos.renderer import FINE
from reconstruction.scenes.record import Layer

Array = NDArray[np.float64]

FURTHER = 1.2
"""What moves furthest beside a pixel, which says how many rays that gets, against the way of most of the picture."""

MOST_TOLD, RAYS_TOLD = 400, 5
"""Photos that are asked for the error of their poses, and rays along each side of each."""


@dataclass(frozen=True, slots=True)
class MotionBlur:
    """Way of the picture while the shutter is open: of what is seen directly, and of what is mirrored."""

    tolerance: float = TOLERANCE_PX
    name = MOTION_BLUR
    unit = "px"

    def assess(self, probe: Probe) -> Assessment:
        """By the photos that move furthest; a flat mirror's image is a thing that stands still behind it."""
        ways_m = np.array([moment.moved_m for moment in probe.moments])
        if not ways_m.any():
            is_open = any(moment.exposure_s > 0.0 for moment in probe.moments)
            return Assessment(
                0.0, say("the camera is held still for every photo") if is_open else say("no shutter opens"), 0.0
            )
        direct, images = [], []
        for number in np.argsort(-ways_m, kind="stable")[:N_PHOTOS]:
            of_things, of_images = _ways_px(probe, int(number))
            direct.append(of_things)
            images.append(of_images)
        seen_px, mirrored_px = (_usual_px(np.concatenate(ways)) for ways in (direct, images))
        reason = say(
            "the camera moves up to {:.0f} mm while the shutter is open; what is seen moves {:.1f} px, what "
            "is mirrored {:.1f} px",
            1000.0 * ways_m.max(),
            seen_px,
            mirrored_px,
        )
        size = max(seen_px, mirrored_px)
        places = 2.0 ** np.ceil(np.log2(np.clip(FURTHER * size / PX_PER_TIME, 1.0, MOST_TIMES)))
        rays = float((ways_m > 0.0).mean()) * probe.n_pixels * (FINE**2 * float(places) - RAYS_PER_PIXEL)
        return Assessment(size, reason, rays * (1.0 + probe.glass_share) * SECONDS_PER_RAY)


def _usual_px(sizes_px: Array) -> float:
    """What 95 % do not exceed; 0 of none."""
    return float(np.quantile(sizes_px, QUANTILE)) if len(sizes_px) else 0.0


def _ways_px(probe: Probe, number: int) -> tuple[Array, Array]:
    """How far things that rays of a photo meet move in the picture, and things that panes mirror into them."""
    origins, directions, focal_px = spread(probe.photos[number])
    moment, geometry = probe.moments[number], probe.geometry
    way_m = np.array(moment.velocity_enu_m_s) * moment.exposure_s
    across_m = np.linalg.norm(np.cross(directions, way_m), axis=1)
    hits = geometry.meet(origins, directions)
    panes = hits.panes >= 0
    out = mirrored(directions[panes], hits.normals_enu[panes])
    starts, ahead = geometry.leaving(hits.points_enu_m[panes], out, hits.normals_enu[panes])
    path_m = hits.distance_m[panes] + ahead + geometry.meet(starts, out).distance_m
    ways_px = [
        # The sky does not move.
        (focal_px * across / np.maximum(away_m, NEAREST_M))[np.isfinite(away_m)]
        for across, away_m in ((across_m, hits.distance_m), (across_m[panes], path_m))
    ]
    return ways_px[0], ways_px[1]


@dataclass(frozen=True, slots=True)
class ExposureChanges:
    """Grey levels that photos exposed one by one differ by from photos of one exposure."""

    tolerance: float = TOLERANCE_GREY
    name = EXPOSURE
    unit = say("grey levels")

    def assess(self, probe: Probe) -> Assessment:
        """Metered on the rays of the probe."""
        if probe.camera_model.exposure == "locked":
            return Assessment(0.0, say("one exposure is locked for all photos"), 0.0)
        means = np.array([light.mean() for light in probe.lights])
        own = in_stops(MIDDLE_GREY / np.maximum(means, DARKEST) / probe.exposure)
        changes = [
            grey_levels(probe.exposure * factor * light) - grey_levels(probe.exposure * light)
            for factor, light in zip(own, probe.lights, strict=True)
        ]
        size = float(np.sqrt((np.concatenate(changes) ** 2).mean()))
        darkest, brightest = np.log2([own.min(), own.max()])
        reason = say("photos would be exposed {:+.1f} to {:+.1f} stops apart from one exposure", darkest, brightest)
        return Assessment(size, reason, 0.0)


@dataclass(frozen=True, slots=True)
class PositionError:
    """Displacement of the facade in the picture by positions that photos tell wrong."""

    tolerance: float = TOLERANCE_PX
    name = POSITION_ERROR
    unit = "px"

    def assess(self, probe: Probe) -> Assessment:
        """With the very errors that the photos would get."""
        horizontal_m, vertical_m = probe.camera_model.position.total_m
        what = say("with RTK") if probe.camera_model.position.fix == "rtk" else say("without RTK")
        reason = say(
            "{}, positions are off by {} horizontally on each axis and {} vertically",
            what,
            _length(horizontal_m),
            _length(vertical_m),
        )
        return Assessment(_told_px(probe, positions=True), reason, 0.0)


@dataclass(frozen=True, slots=True)
class GimbalError:
    """Displacement of the facade in the picture by angles that photos tell wrong."""

    tolerance: float = TOLERANCE_PX
    name = GIMBAL_ERROR
    unit = "px"

    def assess(self, probe: Probe) -> Assessment:
        """With the very errors that the photos would get."""
        gimbal = probe.camera_model.gimbal
        heading, pitch, roll = np.hypot(gimbal.bias_deg, gimbal.deviation_deg)
        reason = say("headings are off by {:.2g} degrees, pitch by {:.2g}, roll by {:.2g}", heading, pitch, roll)
        return Assessment(_told_px(probe, positions=False), reason, 0.0)


def _length(metres: float) -> str:
    return f"{metres:.1f} m" if metres >= 0.995 else say("{:.1f} cm", 100.0 * metres)


def _told_px(probe: Probe, *, positions: bool) -> float:
    """How far poses that are told wrong, in their positions or in their angles, move what photos show of buildings."""
    reported = reported_poses(
        probe.photos, probe.moments, probe.camera_model, probe.scene.seed, positions=positions, angles=not positions
    )
    is_building = np.array([*(body.layer is Layer.BUILDING for body in probe.scene.bodies), False])
    moved = []
    for number in np.unique(np.linspace(0, len(reported) - 1, min(MOST_TOLD, len(reported))).round().astype(int)):
        photo = probe.photos[number]
        hits = probe.geometry.meet(*photo.rays(_grid(photo)))
        shown = hits.points_enu_m[is_building[hits.bodies] | (hits.panes >= 0)]
        off = replace(photo, pose=reported[number].pose).pixels(shown) - photo.pixels(shown)
        # Told so wrong that it is no longer before the camera, a thing is out of the picture by more than its width.
        off = np.where(np.isfinite(off), off, photo.intrinsics.width_px)
        moved.append(np.linalg.norm(off, axis=1))
    return _usual_px(np.concatenate(moved))


def _grid(photo: PosedPhoto) -> Array:
    """Places spread over a photo, shape (n, 2)."""
    sides: Sequence[int] = photo.intrinsics.width_px, photo.intrinsics.height_px
    x, y = ((np.arange(RAYS_TOLD) + 0.5) * side / RAYS_TOLD for side in sides)
    return np.asarray(np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2))


EFFECTS = (MotionBlur(), ExposureChanges(), PositionError(), GimbalError())

"""Photos that matches placed wrongly, or nowhere, put where receiver and gimbal say that they were taken.

Plain walls and glass give few matches, and some of these are of mirror images. They do not suffice to find a photo's
place, but to mend it. The common error of gimbal and compass is known from the photos that lie well.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from reconstruction.colmap.georeference import angle_between_deg
from reconstruction.colmap.pycolmap_run import LEAST_PHOTOS, ColmapRun, as_model
from reconstruction.colmap.record import NO_POINT, ColmapImage, ColmapModel, intrinsics_of, quaternion_of

Array = NDArray[np.float64]

LEAST_SEEN = 15
"""Points of the model that a photo shows: fewer say nothing of it."""

LOOSE_DEG = 1.2
"""Error of points that photos may have which lie as receivers and gimbals say: these move about their common error."""

TIGHT_PX, N_TIGHT = 4.0, 2
"""Error of points after photos were adjusted, and how often they are after that."""

STAYED = 1.5
"""Times the largest distance of a photo from its receiver before, within which all remain."""

AGREES_SIGMAS, LEAST_SHARE = 6.0, 0.5
"""A photo is where its receiver says within so many standard deviations. A model in which fewer of all photos are is
mirror images that fit one another, and not what to begin with."""

UNKNOWN_M = 3.0
"""Standard deviation of a position that says none: of a receiver without corrections."""

ROBUST_MEDIANS, LEAST_OFF_M = 3.0, 0.01
"""The largest distance from a receiver in medians of all, where no model says it; no receiver is better than 1 cm."""

MOST_TURNED_DEG = 6.0
"""Off the gimbal, its common error taken away: three standard deviations of a heading."""


@dataclass(frozen=True, slots=True, eq=False)
class Receiver:
    """Where a photo says that it was taken, shape (3,), and how it was turned, shape (3, 3); None where it does not.

    Parameters
    ----------
    covariance
        Of the position, m^2, or of more with the position first, shape (k, k).
    """

    position_enu_m: Array
    cam_from_enu: Array | None = None
    covariance: Array | None = None

    def fits(self, image: ColmapImage, most_m: float) -> bool:
        """Whether a photo of the model is there."""
        if self.off_m(image) > most_m:
            return False
        return (
            self.cam_from_enu is None or angle_between_deg(image.cam_from_world, self.cam_from_enu) <= MOST_TURNED_DEG
        )

    def off_m(self, image: ColmapImage) -> float:
        """How far a photo of the model is from it."""
        return float(np.linalg.norm(image.centre_world - self.position_enu_m))

    def agrees_at(self, place_enu_m: Array) -> bool:
        """Whether a place, shape (3,), is where it says, within its errors."""
        variance_m2 = UNKNOWN_M**2 if self.covariance is None else float(np.diag(self.covariance)[:3].mean())
        return float(np.linalg.norm(place_enu_m - self.position_enu_m)) <= AGREES_SIGMAS * math.sqrt(variance_m2)


def placed_by_receivers(
    run: ColmapRun,
    model: ColmapModel,
    receivers: Mapping[str, Receiver],
    used: Collection[str],
    fixed_cameras: set[int],
    scratch: Path,
) -> Any | None:
    """The model with such photos, as pycolmap has it; None where there is none, or none shows what others show.

    Parameters
    ----------
    model
        In the receivers' frame.
    receivers
        By the photo's name.
    used
        Names of photos of the model whose receivers do not contradict it.
    scratch
        New folders for files in between are made below it.
    """
    there = [image for image in model.images.values() if image.name in used]
    off = _common_turn([(image, receivers[image.name].cam_from_enu) for image in there])
    good, found = set[str](), None
    if off is not None:
        most_m = STAYED * max(receivers[image.name].off_m(image) for image in there)
        usable = {
            name: one if one.cam_from_enu is None else replace(one, cam_from_enu=off @ one.cam_from_enu)
            for name, one in receivers.items()
        }
        good = {image.name for image in there if usable[image.name].fits(image, most_m)}
        found = _placed(run, model, usable, good, most_m, fixed_cameras, scratch)
    is_more = found is not None and int(found.num_reg_images()) > len(good)
    n_agreeing = (
        _n_agreeing(found, receivers)
        if is_more
        else sum(receivers[image.name].agrees_at(image.centre_world) for image in there)
    )
    if n_agreeing < LEAST_SHARE * sum(one.cam_from_enu is not None for one in receivers.values()):
        # Matches alone gave no model to speak of: begin with what the photos say, without a common error.
        alone = _placed(run, ColmapModel(model.cameras, {}), receivers, (), math.inf, fixed_cameras, scratch / "again")
        if _n_agreeing(alone, receivers) > n_agreeing:
            return alone
    return found if is_more else None


def _n_agreeing(found: Any | None, receivers: Mapping[str, Receiver]) -> int:
    """Photos of a model that are where their receivers say."""
    images = [] if found is None else [found.image(number) for number in found.reg_image_ids()]
    return sum(
        image.name in receivers and receivers[image.name].agrees_at(np.asarray(image.projection_center()))
        for image in images
    )


def _placed(
    run: ColmapRun,
    model: ColmapModel,
    receivers: Mapping[str, Receiver],
    good: Collection[str],
    most_m: float,
    fixed_cameras: set[int],
    scratch: Path,
) -> Any | None:
    """The model with all photos but the good ones where they say that they were, as far as they stay there."""
    tried, shown = {}, dict(model.images)
    for name, (number, camera) in run.identities().items():
        one = receivers.get(name)
        if name not in good and one is not None and one.cam_from_enu is not None and camera in model.cameras:
            tried[number] = shown[number] = _image_at(one.position_enu_m, one.cam_from_enu, number, camera, name)
    if not tried:
        return None
    found, alone = model, set[int]()
    longest_px = max(intrinsics_of(camera).fx_px for camera in model.cameras.values())
    for number, error_px in enumerate([longest_px * np.radians(LOOSE_DEG), *[TIGHT_PX] * N_TIGHT]):
        if len(shown) < LEAST_PHOTOS:
            return None
        folder = scratch / f"receivers-{number}"
        added = run.triangulate(replace(found, images=shown), folder, error_px)
        run.adjust(added, fixed_cameras)
        found = as_model(added, folder / "adjusted")
        seen = {key: image for key, image in found.images.items() if _n_seen(image) >= LEAST_SEEN}
        if not math.isfinite(most_m) and seen:
            offs = [receivers[image.name].off_m(image) for image in seen.values()]
            most_m = STAYED * ROBUST_MEDIANS * max(float(np.median(offs)), LEAST_OFF_M)
        shown = {
            key: image
            for key, image in seen.items()
            if key in alone or image.name not in receivers or receivers[image.name].fits(image, most_m)
        }
        if number == 0:
            # Where a receiver was wrong alone, the model was right.
            alone = (set(tried) & set(model.images)) - set(seen)
            shown |= {key: model.images[key] for key in alone}
        elif len(shown) == len(found.images):
            return added
    return run.triangulate(replace(found, images=shown), scratch / "receivers", TIGHT_PX) if len(shown) > 1 else None


def _common_turn(pairs: list[tuple[ColmapImage, Array | None]]) -> Array | None:
    """From cameras as gimbals tell them to cameras as they are: that of the photo which most others agree with."""
    turns = [image.cam_from_world @ turn.T for image, turn in pairs if turn is not None]
    if not turns:
        return None
    rotations = Rotation.from_matrix(np.array(turns))
    apart = np.array([(rotations * one.inv()).magnitude() for one in rotations])
    near = apart[int(np.argmin(np.median(apart, axis=1)))] <= np.radians(MOST_TURNED_DEG)
    return np.asarray(rotations[near].mean().as_matrix())


def _image_at(position: Array, cam_from_enu: Array, number: int, camera: int, name: str) -> ColmapImage:
    x, y, z = (-cam_from_enu @ position).tolist()
    quaternion = quaternion_of(cam_from_enu)
    return ColmapImage(number, quaternion, (x, y, z), camera, name, np.zeros((0, 2)), np.zeros(0, np.int64))


def _n_seen(image: ColmapImage) -> int:
    return int((image.point_ids != NO_POINT).sum())

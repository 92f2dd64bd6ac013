"""Pictures of a trained model, and of what it is made of, as files."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, replace
from io import BytesIO
from pathlib import Path

import cv2
import numpy as np
import torch
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator
from scipy.spatial.transform import Rotation, Slerp
from torch import Tensor

from planning.base.errors import InputError
from planning.base.files import make_folder
from planning.base.json_file import write_atomically
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from reconstruction.base.cameras import Pose, PosedPhoto
from reconstruction.dataset.layers import normals_to_16_bit
from reconstruction.light.photo_set import PhotoSet
from reconstruction.light.shading import display_from_linear
from reconstruction.metrics.image_metrics import psnr_db
from reconstruction.splats.rasterising.raster_types import RasterSettings
from reconstruction.splats.rasterising.views import View
from reconstruction.training.layers import PICTURE
from reconstruction.training.model.joint_model import Picture, SceneModel
from reconstruction.training.photos.decoded_photo import FACADE, SHOWN, DecodedPhoto, Decoding, decode_photo

# A smooth flight through cameras: many views along the way from one to the next.

Array = NDArray[np.float64]

SAME_PLACE_M = 1e-3
"""Cameras nearer to each other than this are one stop: turning there takes as long as flying this far."""


def cameras_between(photos: Sequence[PosedPhoto], n_frames: int) -> tuple[PosedPhoto, ...]:
    """Views along a path through the cameras of photos, in their order, at an even speed; the lens is the first one's.

    Positions follow a curve without overshoot (monotone cubic along each axis), so the path stays in the box around the
    cameras it lies between; views turn along the shortest way.

    Parameters
    ----------
    n_frames
        2 or more; the first and the last are the first and last photo's.

    Raises
    ------
    InputError
        There is only one camera.
    """
    if n_frames < 2:
        raise ValueError(f"n_frames: expected 2 or more, got {n_frames}")
    if len(photos) < 2:
        raise InputError(say("a path needs two views or more to go through; leave --frames out"))
    places = np.array([photo.pose.position_enu_m for photo in photos])
    steps = np.maximum(np.linalg.norm(np.diff(places, axis=0), axis=1), SAME_PLACE_M)
    way_m: Array = np.concatenate([[0.0], np.cumsum(steps)])
    asked_m = np.linspace(0.0, way_m[-1], n_frames)
    positions = PchipInterpolator(way_m, places)(asked_m)
    turns = _turns(photos, way_m, asked_m)
    lens = photos[0].intrinsics
    return tuple(
        replace(photos[0], name=name, path=Path(name), intrinsics=lens, pose=Pose(position, turn), taken_at=None)
        for name, position, turn in zip(frame_names(n_frames), positions, turns, strict=True)
    )


def _turns(photos: Sequence[PosedPhoto], way_m: Array, asked_m: Array) -> Array:
    """Rotations cam_from_enu along the way, shape (n, 3, 3)."""
    stops = Rotation.from_matrix(np.stack([photo.pose.cam_from_enu for photo in photos]))
    return np.asarray(Slerp(way_m, stops)(asked_m).as_matrix())


def frame_names(n_frames: int) -> list[str]:
    """Names that sort in their order: `frame-0001` and so on."""
    digits = max(4, len(str(n_frames)))
    return [f"frame-{number:0{digits}d}" for number in range(1, n_frames + 1)]


AT_ONCE_PX = 1 << 19
"""Pixels of a strip: about 200 MB with all that is blended into them."""


LEAST_LIGHT = 1e-6
"""Linear, of which it can be told what share of it is reflected."""


@dataclass(frozen=True, slots=True, eq=False)
class Rendered:
    """A view, rendered.

    Parameters
    ----------
    display
        sRGB, shape (h, w, 3), 0 to 1.
    layers
        By name, as `LAYERS` says, shape (h, w) or (h, w, 3).
    """

    display: NDArray[np.float32]
    layers: dict[str, NDArray[np.float32]]


def _light(values: Callable[[Picture], Tensor]) -> Callable[[Picture], Tensor]:
    return lambda picture: display_from_linear(values(picture)).clamp(0.0, 1.0)


def _fresnel(picture: Picture) -> Tensor:
    """F, mean over the colours by how much light of each there is: what is mirrored, R F L, against R L."""
    came = picture.reflectivity * picture.mirrored.sum(dim=-1)
    went = picture.reflection.sum(dim=-1)
    return torch.where(came > LEAST_LIGHT, went / came.clamp(min=LEAST_LIGHT), 0.0).clamp(0.0, 1.0)


def _normals(picture: Picture) -> Tensor:
    lengths = picture.normals.norm(dim=-1, keepdim=True)
    return torch.where(lengths > 0.25, picture.normals / lengths.clamp(min=0.25), 0.0)


OF_PICTURE: dict[str, Callable[[Picture], Tensor]] = {
    "diffuse": _light(lambda picture: picture.diffuse),
    "reflection": _light(lambda picture: picture.reflection),
    "fresnel": _fresnel,
    "mirrored": _light(lambda picture: picture.mirrored),
    "reflectivity": lambda picture: picture.reflectivity,
    "alpha": lambda picture: picture.raster.alphas,
    "normals": _normals,
    "depth": lambda picture: picture.raster.surface_depths_m,
    "panels": lambda picture: picture.panels.float(),
}


@torch.no_grad()
def render_view(
    model: SceneModel,
    view: View,
    layers: Sequence[str] = (),
    gain: Tensor | float = 1.0,
    settings: RasterSettings | None = None,
) -> Rendered:
    """Render a view strip by strip, so that its size does not matter.

    Parameters
    ----------
    layers
        Of `LAYERS`, besides the picture.
    gain
        Its exposure against the photos learned from.
    """
    rows = max(1, AT_ONCE_PX // view.width_px)
    parts: dict[str, list[NDArray[np.float32]]] = {name: [] for name in (PICTURE, *layers)}
    for top in range(0, view.height_px, rows):
        strip = view.cropped(0, top, view.width_px, min(rows, view.height_px - top))
        picture = model(strip, gain, settings=settings or RasterSettings())
        parts[PICTURE].append(picture.display.clamp(0.0, 1.0).cpu().numpy())
        for name in layers:
            parts[name].append(OF_PICTURE[name](picture).cpu().numpy())
    whole = {name: np.concatenate(strips) for name, strips in parts.items()}
    return Rendered(whole.pop(PICTURE), whole)


def render_files(
    model: SceneModel,
    photos: Sequence[PosedPhoto],
    folder: Path,
    layers: Sequence[str] = (),
    settings: RasterSettings | None = None,
    monitor: Monitor = QUIET,
) -> tuple[Path, ...]:
    """Render views from where photos were taken, without their distortion: `NAME.png`, and `LAYER/NAME.png`.

    Depth is `depth/NAME.npy`, metres along the optical axis, infinite where nothing is; normals and panels are coded as
    in a data set. Every file is whole or not there.

    Raises
    ------
    InputError
        A file cannot be written.
    OperationCancelled
        From `monitor`; the views that are done stay.
    """
    for name in ("", *layers):
        make_folder(folder / name)
    written = []
    for done, photo in enumerate(photos):
        monitor.report(say("rendering"), done, len(photos))
        straight = replace(photo, intrinsics=photo.intrinsics.straight())
        found = render_view(model, View.of(straight, model.origin_enu_m), layers, 1.0, settings)
        name = photo.name.replace("/", "_")
        for layer, values in found.layers.items():
            write_atomically(folder / layer / f"{name}{ENDINGS.get(layer, '.png')}", _encoded(layer, values))
        written.append(folder / f"{name}.png")
        write_atomically(written[-1], _encoded(PICTURE, found.display))
    return tuple(written)


ENDINGS = {"depth": ".npy"}


def _encoded(layer: str, values: NDArray[np.float32]) -> bytes:
    """Content of a layer's file."""
    if layer == "depth":
        content = BytesIO()
        np.save(content, values.astype(np.float32), allow_pickle=False)
        return content.getvalue()
    if layer == "normals":
        coded: NDArray[np.uint8] | NDArray[np.uint16] = normals_to_16_bit(values)
    elif layer == "panels":
        coded = (values + 1.0).astype(np.uint16)
    else:
        coded = np.round(255.0 * values.clip(0.0, 1.0)).astype(np.uint8)
    return png_of(coded)


def png_of(picture: NDArray[np.uint8] | NDArray[np.uint16]) -> bytes:
    """A PNG file's content: grey, shape (h, w), or red, green and blue, shape (h, w, 3)."""
    is_done, png = cv2.imencode(".png", picture[..., ::-1] if picture.ndim == 3 else picture)
    if not is_done:
        raise ValueError(f"expected a picture, got shape {picture.shape}")
    return bytes(png)


# How well a model shows each photo as it is now: one photo after the other, on small copies, beside a training.

SMALL_PX = 160 * 120
"""About as many pixels of each photo are looked at: 10 ms of a processor with 12 000 splats."""

MOST_KEPT = 2000
"""Small copies, of 80 kB each."""


class PhotoErrors:
    """PSNR of the facades of photos, in turn; of a photo that shows none, of all of it.

    Parameters
    ----------
    photos
        In the order in which they take turns.
    """

    def __init__(self, source: PhotoSet, photos: Sequence[PosedPhoto]) -> None:
        self._source, self._photos = source, tuple(photos)
        self._reader = ThreadPoolExecutor(1, thread_name_prefix="small photos")
        self._small: dict[str, DecodedPhoto] = {}
        self._next, self._coming = 0, None if not photos else self._asked(0)

    def __len__(self) -> int:
        return len(self._photos)

    @property
    def is_ready(self) -> bool:
        """Whether the next photo is at hand."""
        return self._coming is not None and self._coming.done()

    def close(self) -> None:
        """Read nothing more."""
        self._reader.shutdown(wait=True, cancel_futures=True)
        self._coming = None

    def next_db(
        self, model: SceneModel, gains: Mapping[str, Tensor | float], settings: RasterSettings
    ) -> tuple[str, float] | None:
        """Name and PSNR, dB, of the photo whose turn it is; None where it cannot be read.

        Parameters
        ----------
        gains
            Of photos, by their names; 1 for others.
        """
        if self._coming is None:
            return None
        coming, name = self._coming, self._photos[self._next].name
        self._next = (self._next + 1) % len(self._photos)
        self._coming = self._asked(self._next)
        try:
            small = coming.result()
        except InputError:
            return None
        if len(self._small) < MOST_KEPT:
            self._small[name] = small
        found = render_view(model, View.of(small.photo, model.origin_enu_m), (), gains.get(name, 1.0), settings)
        counted = small.flags & (FACADE | SHOWN) == FACADE | SHOWN
        counted = counted if counted.any() else small.flags & SHOWN > 0
        if not counted.any():
            return None
        errors = found.display[counted] - small.display[counted] / np.float32(255.0)
        return name, psnr_db(float(np.mean(np.square(errors), dtype=np.float64)))

    def _asked(self, number: int) -> Future[DecodedPhoto]:
        photo = self._photos[number]
        if photo.name in self._small:
            done: Future[DecodedPhoto] = Future()
            done.set_result(self._small[photo.name])
            return done
        lens = photo.intrinsics
        decoding = Decoding(max(1, math.isqrt(lens.width_px * lens.height_px // SMALL_PX)))
        return self._reader.submit(decode_photo, self._source, photo, decoding, 1)

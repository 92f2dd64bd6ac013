"""Pictures of a trained model, and of what it is made of, as files."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from io import BytesIO
from pathlib import Path

import cv2
import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from planning.base.files import make_folder
from planning.base.json_file import write_atomically
from planning.base.progress import QUIET, Monitor
from reconstruction.base.cameras import PosedPhoto
from reconstruction.dataset.layers import normals_to_16_bit
from reconstruction.light.shading import display_from_linear
from reconstruction.splats.rasterising.raster_types import RasterSettings
from reconstruction.splats.rasterising.views import View
from reconstruction.training.layers import PICTURE
from reconstruction.training.model.joint_model import Picture, SceneModel

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


def _depth(picture: Picture) -> Tensor:
    raster = picture.raster
    return torch.where(raster.alphas > 0.5, raster.depths / raster.alphas.clamp(min=0.5), torch.inf)


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
    "depth": _depth,
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
        monitor.report("rendering", done, len(photos))
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

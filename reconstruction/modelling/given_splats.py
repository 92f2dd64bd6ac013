"""Splats of a file to start a training from: of an earlier training, or of another program."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from planning.errors import InputError
from planning.progress import QUIET, Monitor
from reconstruction.cameras import PosedPhoto
from reconstruction.modelling.photo_stream import PhotoStream, StreamSettings
from reconstruction.reflections.photo_set import PhotoSet
from reconstruction.splatting.panel_of_splats import assign_panels
from reconstruction.splatting.ply import read_splats
from reconstruction.splatting.splats import NO_PANEL, Splats
from reconstruction.splatting.views import View

Array = NDArray[np.float64]

PANEL_VIEWS = 32
"""Photos, evenly chosen, that tell which panel splats belong to."""

PANEL_PX = 256 * 192
"""About as many pixels of each are looked at."""

REACH_M = 1000.0
"""From the model's middle; further splats are the sky's business, as of those that are placed."""


def given_splats(
    path: Path,
    source: PhotoSet,
    photos: Sequence[PosedPhoto],
    origin_enu_m: Array,
    memory_bytes: int,
    monitor: Monitor = QUIET,
) -> Splats:
    """Splats of a PLY file in the model's frame, ENU less `origin_enu_m`.

    Where the file says of no splat which panel it belongs to, photos tell (`assign_panels`). What is too far away is
    left out.

    Raises
    ------
    InputError
        The file cannot be read, or is of another site.
    OperationCancelled
        From `monitor`.
    """
    found = read_splats(path)
    splats, n_panels = found.splats, len(source.panels.corners_enu_m)
    if int(splats.panels.max()) >= n_panels:
        raise InputError(
            f"{path}: has splats on panel {int(splats.panels.max()) + 1}, and {source.folder} has {n_panels} panels; "
            "name a file of the same site"
        )
    means = splats.means.detach().double() + torch.from_numpy(np.array(found.origin_enu_m) - origin_enu_m)
    kept = means.norm(dim=1) <= REACH_M
    if not bool(kept.any()):
        raise InputError(
            f"{path}: has no splat within {REACH_M:g} m of the panels of {source.folder}; are both in one frame?"
        )
    values = {name: value.detach()[kept] for name, value in splats.named_parameters()}
    splats = Splats(values | {"means": means[kept].float()}, splats.panels[kept])
    if bool((splats.panels == NO_PANEL).all()):
        seen = _panels_seen(source, photos, origin_enu_m, memory_bytes)
        splats.panels.copy_(assign_panels(splats, seen, source.panels.corners_enu_m - origin_enu_m, monitor=monitor))
    return splats


def _panels_seen(
    source: PhotoSet, photos: Sequence[PosedPhoto], origin_enu_m: Array, memory_bytes: int
) -> Iterator[tuple[View, NDArray[np.int32]]]:
    """Views, and the panels of their pixels."""
    chosen = np.unique(np.linspace(0, len(photos) - 1, min(len(photos), PANEL_VIEWS)).round().astype(int))
    most = max(photo.intrinsics.width_px * photo.intrinsics.height_px for photo in photos)
    settings = StreamSettings(memory_bytes, reduce=max(1, math.isqrt(most // PANEL_PX)))
    with PhotoStream(source, [photos[number].name for number in chosen], origin_enu_m, settings) as stream:
        for number in range(len(stream.photos)):
            sample = stream.frame(number)
            yield sample.view, sample.panels.numpy()

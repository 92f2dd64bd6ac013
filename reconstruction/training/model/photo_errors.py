"""How well a model shows each photo as it is now: one photo after the other, on small copies, beside a training."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor

import numpy as np
from torch import Tensor

from planning.base.errors import InputError
from reconstruction.base.cameras import PosedPhoto
from reconstruction.light.photo_set import PhotoSet
from reconstruction.metrics.image_metrics import psnr_db
from reconstruction.splats.rasterising.raster_types import RasterSettings
from reconstruction.splats.rasterising.views import View
from reconstruction.training.model.joint_model import SceneModel
from reconstruction.training.model.render import render_view
from reconstruction.training.photos.decoded_photo import FACADE, SHOWN, DecodedPhoto, Decoding, decode_photo

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

"""Transients while splats are learned: errors of blocks as training sees them, and what of photos counts."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from planning.base.effects import Decision, EffectSetting, decide
from reconstruction.light.transients import (
    COST,
    TRIED,
    UNSEEN,
    Blocks,
    LeaveTransientsOut,
    Seen,
    mean_errors,
    share_of_error,
    transients,
)
from reconstruction.splats.rasterising.views import View
from reconstruction.training.photos.photo_stream import Sample

PLACES = 1 << 16
"""Of the scene that are told apart where there is no panel, by their surfaces' coordinates."""

PLACE_SHARE = 1.0 / 24.0
"""Side of such a place, of the scene's size."""

NEW_SHARE = 0.3
"""Of a new look in a block's error."""

FAR_M = 1e4


class Transients(nn.Module):
    """Errors of blocks, where in the scene they are, and which are left out.

    Parameters
    ----------
    sizes_px
        Width and height of each photo that is learned from.
    extent_m
        Size of the scene.
    known
        Blocks that are known to be transients from the beginning, shape (n_blocks,); None for none.
    """

    def __init__(
        self, sizes_px: Sequence[tuple[int, int]], extent_m: float, known: NDArray[np.bool_] | None = None
    ) -> None:
        super().__init__()
        self.blocks, self._place_m = Blocks(sizes_px), PLACE_SHARE * extent_m
        n = len(self.blocks)
        self.errors: Tensor
        self.register_buffer("errors", torch.full((n,), UNSEEN))
        self.places: Tensor
        self.register_buffer("places", torch.zeros(n, dtype=torch.int32))
        self.left_out: Tensor
        self.register_buffer("left_out", torch.zeros(n, dtype=torch.bool))
        if known is not None and known.shape == (n,):
            self.left_out.copy_(torch.from_numpy(known))
        self.share: Tensor
        self.register_buffer("share", torch.tensor(UNSEEN))
        self.n_looks: Tensor
        self.register_buffer("n_looks", torch.zeros((), dtype=torch.int64))

    def are_looked_for(self, setting: EffectSetting) -> bool:
        """Whether the next step tells about errors."""
        return setting == "on" or (
            setting == "auto" and not UNSEEN < float(self.share) <= LeaveTransientsOut().tolerance
        )

    @torch.no_grad()
    def see(self, sample: Sample, display: Tensor, depths: Tensor) -> None:
        """What a step showed in the place of a sample.

        Parameters
        ----------
        display, depths
            SRGB values, shape (h, w, 3), and depths along the optical axis, shape (h, w).
        """
        height, width = depths.shape
        of_pixels = self.blocks.of_window(sample.number, sample.x_px, sample.y_px, width, height)
        first = int(of_pixels[0, 0])
        errors = (display.cpu() - sample.display.cpu() / 255.0).numpy().reshape(-1, 3)
        found, counts = mean_errors(of_pixels.ravel() - first, errors, int(of_pixels[-1, -1]) - first + 1)
        side = int(self.blocks.sides_px[sample.number])
        seen = np.flatnonzero(2 * counts >= side * side)
        of_blocks = first + seen
        held = self.errors.numpy()
        before = held[of_blocks]
        held[of_blocks] = np.where(before == UNSEEN, found[seen], before + NEW_SHARE * (found[seen] - before))
        # Of several pixels of a block the last one tells where it is.
        places = np.zeros(int(of_pixels[-1, -1]) - first + 1, np.int64)
        every = max(1, side // 4)
        rows, columns = np.mgrid[every // 2 : height : every, every // 2 : width : every]
        panels = sample.panels.cpu().numpy()[rows, columns]
        surfaces = self._places(sample.view, columns, rows, depths.detach().cpu().numpy()[rows, columns])
        places[of_pixels[rows, columns] - first] = np.where(panels >= 0, panels - PLACES, surfaces)
        self.places.numpy()[of_blocks] = places[seen]
        self.n_looks += 1

    def _places(
        self, view: View, columns: NDArray[np.int64], rows: NDArray[np.int64], depths: NDArray[np.float32]
    ) -> NDArray[np.int64]:
        x, y = (columns + 0.5 - view.cx_px) / view.fx_px, (rows + 0.5 - view.cy_px) / view.fy_px
        depths = np.minimum(depths, FAR_M)
        matrix = view.cam_from_world.numpy()
        points = (np.stack([x * depths, y * depths, depths], axis=-1) - matrix[:3, 3]) @ matrix[:3, :3]
        a, b, c = np.moveaxis(np.floor(points / self._place_m).astype(np.int64), -1, 0)
        return np.asarray((a * 73_856_093 ^ b * 19_349_663 ^ c * 83_492_791) % PLACES)

    def settle(self, setting: EffectSetting, progress: float) -> None:
        """Find transients anew, once for about each look at every photo; the first time tells what they are worth.

        Parameters
        ----------
        progress
            Of the training, 0 to 1: nothing is looked for before `TRIED`.
        """
        if progress < TRIED:
            return
        is_first = float(self.share) == UNSEEN
        if not self.are_looked_for(setting) or not (is_first or int(self.n_looks) % len(self.blocks.shapes) == 0):
            return
        errors, are = self.errors.numpy(), np.zeros(len(self.blocks), np.bool_)
        known = errors != UNSEEN
        are[known] = transients(errors[known].astype(float), self.places.numpy()[known].astype(np.int64))
        if is_first:
            self.share.fill_(share_of_error(errors[known].astype(float), are[known]))
        if self.are_looked_for(setting):
            self.left_out.copy_(torch.from_numpy(self.blocks.with_neighbours(are)))
        else:
            self.left_out.zero_()

    def lasting(self, sample: Sample) -> Tensor | None:
        """What a sample shows that lasts, shape (h, w), bool; None for all of it."""
        if not bool(self.left_out.any()):
            return sample.shown
        height, width = sample.facade.shape
        of_pixels = self.blocks.of_window(sample.number, sample.x_px, sample.y_px, width, height)
        lasting = ~self.left_out[torch.from_numpy(of_pixels)].to(sample.facade.device)
        return lasting if sample.shown is None else lasting & sample.shown

    def decision(self, setting: EffectSetting, seconds: float) -> Decision:
        """About all of it; `seconds` is what the training takes."""
        return decide(LeaveTransientsOut(), Seen(float(self.share), COST * seconds), setting)

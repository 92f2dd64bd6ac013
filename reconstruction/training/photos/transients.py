"""Transients while splats are learned: errors of blocks as training sees them, and what of photos counts.

Of large photos a step looks at windows, and a block may come up once in a long time. Its error then is that of a model
that had learned less, and compared with later ones of its place it looks like something that one photo alone shows. So
an error counts the less the older it is, and is told nothing by at all once it is too old.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from planning.base.effects import Decision, EffectSetting, decide
from reconstruction.light.losses import no_brighter
from reconstruction.light.transients import (
    COST,
    TRIED,
    UNSEEN,
    Blocks,
    LeaveTransientsOut,
    Seen,
    evidence,
    mean_errors,
    places_of,
    transients,
)
from reconstruction.splats.rasterising.views import View
from reconstruction.training.photos.photo_stream import Sample

NEW_SHARE = 0.3
"""Of a new look in a block's error, at least: after a long time it is more."""

FRESH = 0.5
"""Share of what a training has gone through, at which a block was last seen, if its error is to tell anything."""

FAR_M = 1e4


class Transients(nn.Module):
    """Errors of blocks, where in the scene they are, and which are left out.

    Parameters
    ----------
    sizes_px
        Width and height of each photo that is learned from.
    known
        Blocks that are known to be transients from the beginning, shape (n_blocks,); None for none.
    white
        Value from which on photos are taken as overexposed: no model is too bright there.
    """

    def __init__(
        self, sizes_px: Sequence[tuple[int, int]], known: NDArray[np.bool_] | None = None, white: float = 1.0
    ) -> None:
        super().__init__()
        self.blocks, self._white = Blocks(sizes_px), white
        n = len(self.blocks)
        self.errors: Tensor
        self.register_buffer("errors", torch.full((n,), UNSEEN))
        self.seen_at: Tensor
        self.register_buffer("seen_at", torch.zeros(n))
        self.points: Tensor
        self.register_buffer("points", torch.zeros(n, 3))
        self.on_glass: Tensor
        self.register_buffer("on_glass", torch.zeros(n, dtype=torch.bool))
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
    def see(self, sample: Sample, display: Tensor, depths: Tensor, progress: float) -> None:
        """What a step showed in the place of a sample.

        Parameters
        ----------
        display, depths
            SRGB values, shape (h, w, 3), and depths of surfaces along the optical axis, shape (h, w), infinite for sky.
        progress
            Of the training, 0 to 1.
        """
        height, width = depths.shape
        of_pixels = self.blocks.of_window(sample.number, sample.x_px, sample.y_px, width, height)
        first = int(of_pixels[0, 0])
        truth = sample.display.cpu() / 255.0
        errors = (no_brighter(display.cpu(), truth, self._white) - truth).numpy().reshape(-1, 3)
        places = of_pixels.ravel() - first
        if sample.shown is not None:
            told = sample.shown.cpu().numpy().ravel()
            places, errors = places[told], errors[told]
        found, counts = mean_errors(places, errors, int(of_pixels[-1, -1]) - first + 1)
        side = int(self.blocks.sides_px[sample.number])
        seen = np.flatnonzero(2 * counts >= side * side)
        of_blocks = first + seen
        held, seen_at = self.errors.numpy(), self.seen_at.numpy()
        before = held[of_blocks]
        share = np.where(before == UNSEEN, 1.0, np.maximum(NEW_SHARE, 1.0 - seen_at[of_blocks] / max(progress, 1e-9)))
        held[of_blocks], seen_at[of_blocks] = before + share * (found[seen] - before), progress
        # Of several pixels of a block the last one tells where it is.
        every = max(1, side // 4)
        rows, columns = np.mgrid[every // 2 : height : every, every // 2 : width : every]
        places = of_pixels[rows, columns].ravel()
        points = _points(sample.view, columns, rows, depths.detach().cpu().numpy()[rows, columns])
        is_seen = np.isin(places, of_blocks)
        self.points.numpy()[places[is_seen]] = points.reshape(-1, 3)[is_seen]
        self.on_glass.numpy()[places[is_seen]] = (sample.panels.cpu().numpy()[rows, columns] >= 0).ravel()[is_seen]
        self.n_looks += 1

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
        is_known = (self.errors.numpy() != UNSEEN) & (self.seen_at.numpy() >= FRESH * progress)
        are, known = np.zeros(len(self.blocks), np.bool_), np.flatnonzero(is_known)
        errors, photos = self.errors.numpy()[known].astype(float), self.blocks.photos[known]
        places = places_of(self.points.numpy()[known], self.on_glass.numpy()[known].astype(np.int64), photos)
        if is_first:
            self.share.fill_(evidence(errors, places, photos))
        if self.are_looked_for(setting):
            are[known] = transients(errors, places, photos)
            # Of blocks that were not seen lately it stays as it was.
            found = self.blocks.with_neighbours(are) | (self.left_out.numpy() & ~is_known)
            self.left_out.copy_(torch.from_numpy(found))
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


def _points(
    view: View, columns: NDArray[np.int64], rows: NDArray[np.int64], depths: NDArray[np.float32]
) -> NDArray[np.float64]:
    """What pixels show, shape (..., 3), in the model's frame."""
    x, y = (columns + 0.5 - view.cx_px) / view.fx_px, (rows + 0.5 - view.cy_px) / view.fy_px
    depths = np.minimum(depths, FAR_M)
    matrix = view.cam_from_world.numpy()
    return np.asarray((np.stack([x * depths, y * depths, depths], axis=-1) - matrix[:3, 3]) @ matrix[:3, :3])

"""Who looks on while a training runs, what they are shown, and where it stands."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from planning.base.progress import QUIET, Monitor, Stop, Trace, never
from reconstruction.metrics.image_metrics import mean_quality, score_picture
from reconstruction.splats.rasterising.raster_types import RasterSettings
from reconstruction.training.model.joint_model import SceneModel
from reconstruction.training.photos.exposures import Exposures
from reconstruction.training.photos.photo_stream import Sample


@dataclass(frozen=True, slots=True, eq=False)
class Preview:
    """How a view looks now: its picture, sRGB, shape (h, w, 3), uint8, at a step."""

    step: int
    picture: NDArray[np.uint8]


@dataclass(frozen=True, slots=True, eq=False)
class HeldOut:
    """A whole photo that is not learned from, and the gain that it is known to have."""

    sample: Sample
    gain: float


SnapshotState = Literal["training", "paused", "settling"]


@dataclass(frozen=True, slots=True, eq=False)
class TrainingSnapshot:
    """A training between two steps, for somebody who looks at its model and must not change it.

    Parameters
    ----------
    model
        In evaluation mode until the visit ends.
    exposures
        Gains of the photos learned from, in the order of the record's `learned`.
    record
        Of the model, as `ModelRecord` has it.
    step, seconds, progress, left_s
        How far it is; progress of the joint training, 0 to 1, seconds of all, and those to go, None where not known.
    terms
        What each term of the loss was in the last step.
    history
        PSNR, dB, of held-out views, by seconds.
    settings
        Of the rasteriser.
    """

    model: SceneModel
    exposures: Exposures
    record: dict[str, Any]
    state: SnapshotState
    step: int
    seconds: float
    progress: float
    left_s: float | None
    terms: dict[str, float]
    history: tuple[tuple[float, float], ...]
    settings: RasterSettings


History = Sequence[tuple[float, float]]
"""PSNR, dB, of held-out views, by seconds."""

Show = Callable[[SceneModel, RasterSettings, History], object]
"""Of a model before its first step: how it is to be drawn, and how good it was until now."""


def unshown(model: SceneModel, settings: RasterSettings, history: History) -> None:
    """Nobody looks."""


@dataclass(slots=True, eq=False)
class Callbacks:
    """Who looks on while a training runs.

    Parameters
    ----------
    monitor
        Told about progress; cancels.
    stop
        Asked between steps; True: the model is good enough, and settles.
    pause
        Asked between steps; nothing goes on while it is True.
    trace
        Gets the quality, PSNR of held-out views over their facades, dB.
    preview
        Called with a picture of the first held-out view whenever the quality is measured.
    visit
        Called after each step, and again and again while it is paused; its time counts as the training's.
    show_before
        Called with what there is to see before the first step: splats as they were placed, then with the light that was
        learned so far, and as trials left them. Held-out views are scored then, too.
    """

    monitor: Monitor = QUIET
    stop: Stop = never
    pause: Stop = never
    trace: Trace | None = None
    preview: Callable[[Preview], None] | None = None
    visit: Callable[[TrainingSnapshot], None] | None = None
    show_before: Show = unshown


@torch.no_grad()
def quality_db(shown: Sequence[HeldOut], displayed: Callable[[HeldOut], Tensor]) -> float:
    """PSNR, dB, of the shown views' facades, as `mean_quality` has it.

    Parameters
    ----------
    displayed
        A view as the model shows it, sRGB, 0 to 1, shape (h, w, 3).
    """
    views = []
    for held_out in shown:
        found, truth = displayed(held_out).cpu().numpy(), held_out.sample.display.numpy()
        facade, whole = (
            score_picture(found, truth, mask, with_ssim=False).psnr_db for mask in held_out.sample.scored_pixels()
        )
        views.append((facade, whole))
    quality = mean_quality(views)
    return math.nan if quality is None else quality.psnr_db


@dataclass(slots=True, eq=False)
class Progress:
    """Where a training stands; what a checkpoint has besides tensors.

    Parameters
    ----------
    scored_step
        At which the quality was measured last.
    began_s
        What had been spent when the joint training began.
    """

    step: int = 0
    scored_step: int = -1
    spent_s: float = 0.0
    began_s: float = 0.0
    factor: float = 1.0
    n_undone: int = 0
    window_px: int = 0
    scored_at_s: float = -math.inf
    saved_at_s: float = 0.0
    history: list[tuple[float, float]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

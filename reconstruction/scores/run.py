"""Scoring a method on a set of photos."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from planning.errors import InfeasibleError
from planning.progress import QUIET, Clock, Monitor
from reconstruction.panels.register import registered
from reconstruction.rectify.curvature import ViewKind, decide_view, drawn_view
from reconstruction.rectify.view import SurfaceView
from reconstruction.scores.baselines import mask_folder
from reconstruction.scores.metrics import PhotoScores, SetScores, score_overlaps, summarise
from reconstruction.scores.overlaps import pixel_overlaps
from reconstruction.scores.raster import found_index, found_region
from reconstruction.scores.sets import PhotoSet, ScoredPhoto
from reconstruction.segmentation.parameters import SegmentationParameters
from reconstruction.segmentation.record import Rectification, Segmentation
from reconstruction.segmentation.segment import segment_image, segment_views

Mask = NDArray[np.bool_]

WORST_KEPT = 3


@dataclass(frozen=True, slots=True, eq=False)
class Answer:
    """What a method says about a photo.

    Parameters
    ----------
    index
        Shape (height, width): found panels; None for a method that finds glass but no single panels.
    region
        Shape (height, width): everything it takes for glass, frames between panes included; None: the panels.
    seconds
        It took, without painting these pictures.
    """

    index: NDArray[np.uint16] | None
    region: Mask | None
    seconds: float


Method = Callable[[ScoredPhoto, Monitor], Answer]


@dataclass(frozen=True, slots=True, eq=False)
class ScoredAnswer:
    """A photo, what was said about it, and how good that was."""

    photo: ScoredPhoto
    answer: Answer
    scores: PhotoScores


def own_method(parameters: SegmentationParameters | None = None, clock: Clock = time.perf_counter) -> Method:
    """Reflight's own search for panels."""

    def answer(photo: ScoredPhoto, monitor: Monitor) -> Answer:
        started = clock()
        found = segment_image(photo.image, photo.views, parameters, monitor, photo.name)
        seconds = clock() - started
        return Answer(found_index(found), found_region(found), seconds)

    return answer


def viewed_method(kind: ViewKind, parameters: SegmentationParameters, clock: Clock = time.perf_counter) -> Method:
    """The same on photos that are rectified in another way; what cannot be rectified so shows no panels."""

    def answer(photo: ScoredPhoto, monitor: Monitor) -> Answer:
        started = clock()
        found = segment_image(photo.image, viewed(photo, kind), parameters, monitor, photo.name)
        return Answer(found_index(found), found_region(found), clock() - started)

    return answer


def viewed(photo: ScoredPhoto, kind: ViewKind) -> tuple[Rectification, ...]:
    """A photo's views of known surfaces, drawn in another way."""
    views = []
    for view in photo.views or ():
        if isinstance(view, SurfaceView):
            with suppress(InfeasibleError):
                views.append(drawn_view(view, kind, decide_view([view], kind)))
    return tuple(views)


def together_method(n_views: int, parameters: SegmentationParameters, clock: Clock = time.perf_counter) -> Method:
    """The same in a photo and `n_views` - 1 beside it, brought onto one another and searched at once."""

    def answer(photo: ScoredPhoto, monitor: Monitor) -> Answer:
        (view,) = photo.views or ()
        if not isinstance(view, SurfaceView):
            raise TypeError(f"expected a view of a surface, got {type(view).__name__}")
        beside = photo.beside[: n_views - 1]
        images, views = [photo.image, *(image for image, _ in beside)], [view, *(other for _, other in beside)]
        started = clock()
        scale = min(1.0, parameters.long_side_px / max(view.width_px, view.height_px))
        placed = registered(images, [replace(one, px_per_m=one.px_per_m * scale) for one in views], parameters.seed)
        grids = segment_views(images, [one.view for one in placed], parameters, monitor, "A")
        seconds = clock() - started
        height, width = photo.image.shape[:2]
        found = Segmentation(photo.name, width, height, grids[:1])
        return Answer(found_index(found), found_region(found), seconds)

    return answer


def masks_method(folder: Path, photos: PhotoSet) -> Method:
    """Masks that another method wrote for these photos; see `baselines`.

    Raises
    ------
    InputError
        The folder lacks masks.
    """
    masks = mask_folder(folder)
    masks.check(photos.photo_names)

    def answer(photo: ScoredPhoto, _monitor: Monitor) -> Answer:
        height, width = photo.image.shape[:2]
        return Answer(None, masks.mask(photo.name, width, height), 0.0)

    return answer


def score_answer(photo: ScoredPhoto, answer: Answer) -> PhotoScores:
    """Compare an answer with the truth.

    Where the truth knows no frames (windows in a wall), neither does the answer: its region is that of its panels.
    """
    region = answer.region if photo.region is not None or answer.index is None else None
    overlaps = pixel_overlaps(photo.index, answer.index, photo.region, region)
    return score_overlaps(photo.name, overlaps, answer.index is not None, answer.seconds)


def score_set(
    photos: PhotoSet, method: Method, monitor: Monitor = QUIET, n_worst: int = WORST_KEPT
) -> tuple[SetScores, tuple[ScoredAnswer, ...]]:
    """Scores of a set, and the photos done worst, the worst first.

    A photo in which the method finds that nothing can be done scores as one in which it found nothing.

    Raises
    ------
    InputError
        A photo or mask cannot be read.
    OperationCancelled
        The user cancelled.
    """
    done: list[PhotoScores] = []
    worst: list[ScoredAnswer] = []
    for number, photo in enumerate(photos.photos()):
        monitor.report(f"scoring {photos.name}", number, photos.n_photos)
        try:
            answer = method(photo, monitor)
        except InfeasibleError:
            answer = Answer(np.zeros_like(photo.index), None, 0.0)
        scores = score_answer(photo, answer)
        done.append(scores)
        worst = sorted([*worst, ScoredAnswer(photo, answer, scores)], key=_badness)[:n_worst]
    monitor.report(f"scoring {photos.name}", len(done), len(done))
    return summarise(done), tuple(worst)


def _badness(case: ScoredAnswer) -> float:
    single = case.scores.individual_miou
    return case.scores.overall_iou if single is None else single

"""Scoring a method on a set of photos."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InfeasibleError, InputError
from planning.base.messages import say
from planning.base.progress import QUIET, Clock, Monitor
from reconstruction.metrics.metrics import PhotoScores, SetScores, score_overlaps, summarise
from reconstruction.metrics.overlaps import pixel_overlaps
from reconstruction.metrics.pictures import pictures_in, read_labels
from reconstruction.metrics.raster import found_index, found_region
from reconstruction.metrics.sets import PhotoSet, ScoredPhoto
from reconstruction.panels.rectify.curvature import ViewKind, decide_view, drawn_view
from reconstruction.panels.rectify.rectification import Rectification
from reconstruction.panels.rectify.view import SurfaceView
from reconstruction.panels.search.parameters import SegmentationParameters
from reconstruction.panels.search.record import Segmentation
from reconstruction.panels.search.segment import segment_image, segment_views
from reconstruction.panels.solving.register import registered

Mask = NDArray[np.bool_]


# Other methods' results, as a user with their weights has them: a folder with one mask for each photo.
#
# Made for EBLNet, GhostingNet and GlassSemNet, whose programs write such folders; nothing here depends on which it
# was.

THRESHOLD = 0.5
"""Probability from which a pixel is glass."""

NAMES_IN_MESSAGE = 5


@dataclass(frozen=True, slots=True)
class MaskFolder:
    """Masks of glass by the names of their photos, without suffix."""

    folder: Path
    paths: dict[str, Path]

    def mask(self, name: str, width_px: int, height_px: int) -> Mask:
        """Where a photo of that size shows glass, shape (height_px, width_px).

        A mask of another size is resized, each pixel taking the nearest one's value.

        Raises
        ------
        InputError
            There is no mask of that name, or it is no mask.
        """
        if name not in self.paths:
            raise InputError(f"{self.folder}: expected a mask for the photo '{name}', found none of that name")
        is_glass = _is_glass(self.paths[name])
        if is_glass.shape == (height_px, width_px):
            return is_glass
        size = (width_px, height_px)
        resized = cv2.resize(is_glass.astype(np.uint8), size, interpolation=cv2.INTER_NEAREST_EXACT)
        return np.asarray(resized, bool)

    def check(self, names: Sequence[str]) -> None:
        """See that there is a mask for each of these photos.

        Raises
        ------
        InputError
            Some are missing; the message names the first of them.
        """
        missing = [name for name in names if name not in self.paths]
        if missing:
            more = say(" and {} more", len(missing) - NAMES_IN_MESSAGE) if len(missing) > NAMES_IN_MESSAGE else ""
            raise InputError(
                f"{self.folder}: expected a mask for each of {len(names)} photos, named like it; missing: "
                f"{', '.join(missing[:NAMES_IN_MESSAGE])}{more}"
            )


def mask_folder(folder: Path) -> MaskFolder:
    """Find the masks in a folder.

    Raises
    ------
    InputError
        It is no folder or holds no pictures.
    """
    return MaskFolder(folder, pictures_in(folder))


def _is_glass(path: Path) -> Mask:
    """A mask from a picture of 0 and 1, 0 and 255, or probabilities over the whole range of 8 or 16 bit."""
    values = read_labels(path)
    if values.ndim == 3:
        colours = values[..., :3]
        if (colours != colours[..., :1]).any():
            raise InputError(f"{path}: expected a grey mask, found colours; write glass as white on black")
        values = colours[..., 0]
    highest = int(values.max(initial=0))
    full = 1 if highest <= 1 else int(np.iinfo(values.dtype).max)
    return np.asarray(values >= THRESHOLD * full)


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

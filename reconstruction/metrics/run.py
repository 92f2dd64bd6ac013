"""Scoring a method on a set of photos."""

from __future__ import annotations

import csv
import io
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InfeasibleError, InputError
from planning.base.json_file import write_atomically
from planning.base.messages import say
from planning.base.progress import QUIET, Clock, Monitor
from reconstruction.metrics.metrics import (
    FOUND_IOU,
    PERCENTILES,
    PhotoScores,
    SetScores,
    Spread,
    score_overlaps,
    summarise,
)
from reconstruction.metrics.overlaps import found_index, found_region, pixel_overlaps
from reconstruction.metrics.pictures import pictures_in, write_picture
from reconstruction.metrics.sets import PhotoSet, ScoredPhoto
from reconstruction.panels.rectify.fit import ViewKind, decide_view, drawn_view
from reconstruction.panels.rectify.surface import Rectification
from reconstruction.panels.rectify.view import SurfaceView
from reconstruction.panels.search.parameters import SegmentationParameters
from reconstruction.panels.search.record import Segmentation
from reconstruction.panels.search.segment import segment_views
from reconstruction.panels.segment import segment_image
from reconstruction.panels.solving.register import registered
from reconstruction.photos.decode import read_mask, resized_mask

Mask = NDArray[np.bool_]


# Other methods' results, as a user with their weights has them: a folder with one mask for each photo.
#
# Made for EBLNet, GhostingNet and GlassSemNet, whose programs write such folders; nothing here depends on which it
# was.

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
            raise InputError(
                say("expected a mask for the photo '{}', found none of that name", name, place=self.folder)
            )
        return resized_mask(read_mask(self.paths[name]), width_px, height_px)

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
                say(
                    "expected a mask for each of {} photos, named like it; missing: {}{}",
                    len(names),
                    ", ".join(missing[:NAMES_IN_MESSAGE]),
                    more,
                    place=self.folder,
                )
            )


def mask_folder(folder: Path) -> MaskFolder:
    """Find the masks in a folder.

    Raises
    ------
    InputError
        It is no folder or holds no pictures.
    """
    return MaskFolder(folder, pictures_in(folder))


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


def fused_method(n_views: int, parameters: SegmentationParameters, clock: Clock = time.perf_counter) -> Method:
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
        monitor.report(say("scoring {}", photos.name), number, photos.n_photos)
        try:
            answer = method(photo, monitor)
        except InfeasibleError:
            answer = Answer(np.zeros_like(photo.index), None, 0.0)
        scores = score_answer(photo, answer)
        done.append(scores)
        worst = sorted([*worst, ScoredAnswer(photo, answer, scores)], key=_badness)[:n_worst]
    monitor.report(say("scoring {}", photos.name), len(done), len(done))
    return summarise(done), tuple(worst)


def _badness(case: ScoredAnswer) -> float:
    single = case.scores.individual_miou
    return case.scores.overall_iou if single is None else single


# Scores as a table, as one summary, and as pictures of truth against what was found.

COLUMNS = (
    "photo", "panels", "found", "overall_iou", "overall_miou", *(f"coverage_p{percent}" for percent in PERCENTILES),
    "coverage_least", "individual_miou", "one_to_one_miou", "missed", "false", "seconds",
)  # fmt: skip

TRUE_BGR, FOUND_BGR, MISSED_BGR = (178, 114, 0), (0, 159, 230), (60, 20, 220)
"""Blue, orange, red: told apart by people who see no difference between red and green."""

DIMMED = 0.55
"""How far a photo is faded towards white below the lines."""

LARGEST_PICTURE_PX = 1400


def photo_row(scores: PhotoScores) -> dict[str, Any]:
    """One photo as a row of the table; empty where a score does not apply."""
    values = (
        scores.name,
        scores.n_true,
        scores.n_found,
        _round(scores.overall_iou),
        _round(scores.overall_miou),
        *(_round(scores.coverage_percentile(percent)) for percent in PERCENTILES),
        _round(scores.coverage_percentile(0)),
        _round(scores.individual_miou),
        _round(scores.one_to_one_miou),
        scores.n_missed,
        scores.n_false,
        _round(scores.seconds, 3),
    )
    return dict(zip(COLUMNS, values, strict=True))


def write_table(photos: Sequence[PhotoScores], path: Path) -> None:
    """Write a CSV with a row for each photo."""
    text = io.StringIO(newline="")
    writer = csv.DictWriter(text, COLUMNS)
    writer.writeheader()
    writer.writerows(photo_row(photo) for photo in photos)
    write_atomically(path, text.getvalue().encode())


def summary(scores: SetScores) -> dict[str, Any]:
    """Scores of a set for `--json`."""
    return {
        "photos": len(scores.photos),
        "panels": scores.n_panels,
        "missed": scores.n_missed,
        "false": scores.n_false,
        "overall_iou": _spread(scores.overall_iou),
        "overall_miou": _spread(scores.overall_miou),
        "coverage_percentiles": {str(percent): _round(value) for percent, value in scores.coverage.items()},
        "individual_miou": _spread(scores.individual_miou),
        "one_to_one_miou": _spread(scores.one_to_one_miou),
        "seconds": _spread(scores.seconds),
    }


def _spread(spread: Spread | None) -> dict[str, Any] | None:
    if spread is None:
        return None
    return {"mean": _round(spread.mean), "worst": _round(spread.worst), "worst_photo": spread.worst_photo}


def _round(value: float | None, digits: int = 4) -> float | None:
    return None if value is None else round(value, digits)


def picture(case: ScoredAnswer) -> NDArray[np.uint8]:
    """Truth in blue, found in orange, true panels without a partner filled with red.

    Under it lies the photo, faded, or white where its licence does not let it be shown.
    """
    photo, answer = case.photo, case.answer
    if photo.may_be_shown:
        drawn = np.asarray(photo.image * (1.0 - DIMMED) + 255.0 * DIMMED, np.uint8)
    else:
        drawn = np.full_like(photo.image, 255)
    ious = case.scores.ious
    if ious is not None:
        numbers = np.unique(photo.index)
        missed = numbers[numbers > 0][ious <= FOUND_IOU]
        is_missed = np.isin(photo.index, missed)
        drawn[is_missed] = (0.5 * drawn[is_missed] + 0.5 * np.array(MISSED_BGR)).astype(np.uint8)
    thickness = max(1, round(max(photo.image.shape) / LARGEST_PICTURE_PX))
    drawn[_outlines(photo.index, thickness + 1)] = TRUE_BGR
    found = answer.index if answer.index is not None else answer.region
    if found is not None:
        drawn[_outlines(np.asarray(found, np.uint16), thickness)] = FOUND_BGR
    scale = LARGEST_PICTURE_PX / max(photo.image.shape)
    if scale >= 1.0:
        return drawn
    return np.asarray(cv2.resize(drawn, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA), np.uint8)


def _outlines(index: NDArray[np.uint16], thickness: int) -> NDArray[np.bool_]:
    """Inner borders of the panels of an index image."""
    kernel = np.ones((2 * thickness + 1, 2 * thickness + 1), np.uint8)
    return np.asarray((cv2.dilate(index, kernel) != index) | (cv2.erode(index, kernel) != index)) & (index > 0)


def write_pictures(cases: Sequence[ScoredAnswer], folder: Path, suffix: str = ".jpg") -> list[Path]:
    """Write a picture of each case, numbered from the first; returns the paths."""
    paths = []
    for rank, case in enumerate(cases, 1):
        path = folder / f"worst-{rank}-{_file_name(case.photo.name)}{suffix}"
        write_picture(path, picture(case))
        paths.append(path)
    return paths


def _file_name(name: str) -> str:
    """The name with nothing in it that a file system could take for a folder."""
    return "".join(letter if letter.isalnum() or letter in "-_." else "-" for letter in name)

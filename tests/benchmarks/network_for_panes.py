"""The network for panes on real photos not learned from: accuracy against time, and what its confidences are worth."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice, pairwise

import numpy as np

from planning.base.progress import QUIET
from planning.tradeoff.runner import draw
from reconstruction.metrics.metrics import FOUND_IOU, SetScores, summarise
from reconstruction.metrics.overlaps import pixel_overlaps
from reconstruction.metrics.run import own_method, score_answer
from reconstruction.metrics.sets import ScoredPhoto, annotated_set, folder_set
from reconstruction.panels.network.calibration import are_there
from reconstruction.panels.network.confidence import LEAST_BELIEVED, find_panes
from reconstruction.panels.network.predictions import LONG_SIDES_PX, predict_photo
from reconstruction.panels.search.parameters import SegmentationParameters
from reconstruction.tradeoff.search_tradeoff import MIOU_AXIS, SettingScores, variants_panel
from tests.benchmarks.harness import Benchmark, Context, Row

SIZES_PX = (144, 216, 324, 486, 729, 1094)
FEW = 2
REPORTED = (0.15, 0.3, LEAST_BELIEVED, 0.75, 0.9, 1.0)
"""Confidences between which panes are counted together."""

WANTED = {"glass": 0.6, "offices": 0.3, "cmp": 0.45}
FALSE_SHARE = 0.25

WINDOW_IOU, WINDOW_HELD = 0.25, 0.8
"""A false panel that overlaps a window by so much, or holds so much of one, is that window."""


def measure(context: Context) -> Iterator[Row]:
    """By lines, by what the photo calls for, by the network in sizes; and what its confidences are worth."""
    panels = []
    for name, photos in _not_learned_from(context):
        scene = f"{name}, {len(photos)} photos"
        runs = []
        for setting in ("off", "auto"):
            scores = _scores(photos, SegmentationParameters(network=setting))
            wanted = WANTED[name] if setting == "auto" else None
            yield from _rows(scene, f"--network {setting}", scores, wanted)
        for size in SIZES_PX[:FEW] if context.is_quick else SIZES_PX:
            parameters = SegmentationParameters(network="on", long_side_px=size)
            runs.append(SettingScores("longer side", str(size), parameters, _scores(photos, parameters)))
            yield from _rows(scene, f"--network on --long-side {size}", runs[-1].scores)
        panels.append(variants_panel(scene, runs))
        yield from _reliability(scene, photos)
    for name, photos in _not_looked_at(context):
        scene = f"{name} not looked at, {len(photos)} photos"
        scores = _scores(photos, SegmentationParameters())
        yield from _rows(scene, "--network auto", scores)
        yield _false_share(scene, scores, FALSE_SHARE if name in WANTED else None)
        yield on_windows(scene, photos)
        yield from _reliability(scene, photos)
    draw("Network for panes: accuracy against time for one photo", panels, MIOU_AXIS, context.folder / "network.png")


def _not_learned_from(context: Context) -> Iterator[tuple[str, list[ScoredPhoto]]]:
    """Sets by name: every second photo where the others were learned from, all of CMP."""
    glass, facades = context.data("glass"), context.data("facades")
    step = 4 if context.is_quick else 2
    yield "glass", list(islice(folder_set(glass / "photos", glass / "truth").photos(), 1, None, step))
    yield "offices", list(islice(annotated_set("offices", facades).photos(), 1, None, 2 * step if step > 2 else step))
    yield "cmp", list(islice(annotated_set("cmp", facades).photos(), 0, FEW if context.is_quick else None))


def _not_looked_at(context: Context) -> Iterator[tuple[str, list[ScoredPhoto]]]:
    """Windows in walls by which no design was chosen: every second photo, from the second on."""
    for name in ("cmp", "ecp"):
        last = 2 * FEW if context.is_quick else None
        yield name, list(islice(annotated_set(name, context.data("facades")).photos(), 1, last, 2))


def _scores(photos: list[ScoredPhoto], parameters: SegmentationParameters) -> SetScores:
    method = own_method(parameters)
    method(photos[0], QUIET)  # compiling is in no one's time
    return summarise([score_answer(photo, method(photo, QUIET)) for photo in photos])


def _rows(scene: str, what: str, scores: SetScores, wanted: float | None = None) -> Iterator[Row]:
    single, n_false = scores.individual_miou, scores.n_false or 0
    if single is None:
        raise ValueError("expected a method that finds single panels")
    n_found = sum(photo.n_found for photo in scores.photos)
    beside = f"{n_false} of {n_found} false; {scores.n_missed} of {scores.n_panels} missed; {scores.seconds.mean:.2f} s"
    target = ("", None) if wanted is None else (f"at least {wanted}", single.mean >= wanted)
    yield Row(scene, f"individual mIoU, {what}", round(single.mean, 4), "", None, beside, *target)
    if wanted is not None:
        percentiles = ", ".join(f"{percent} %: {part:.4f}" for percent, part in scores.coverage.items())
        yield Row(scene, "overall IoU of glass", round(scores.overall_iou.mean, 4), seeds=len(scores.photos))
        yield Row(
            scene, "overall mIoU (glass and the rest)", round(scores.overall_miou.mean, 4), seeds=len(scores.photos)
        )
        yield Row(scene, "coverage percentiles", percentiles, seeds=len(scores.photos))
        yield _false_share(scene, scores, FALSE_SHARE)


def _false_share(scene: str, scores: SetScores, limit: float | None) -> Row:
    share = (scores.n_false or 0) / max(sum(photo.n_found for photo in scores.photos), 1)
    what = "false panels of those found, --network auto"
    target = ("", None) if limit is None else (f"under {limit}", share < limit)
    return Row(scene, what, round(share, 3), "", None, "", *target)


def on_windows(scene: str, photos: list[ScoredPhoto]) -> Row:
    """Of false panels, those that are windows all the same: of another size, or with something before them."""
    method, n_false, n_windows = own_method(SegmentationParameters()), 0, 0
    for photo in photos:
        areas = pixel_overlaps(photo.index, method(photo, QUIET).index)
        union = areas.true_areas[:, None] + areas.found_areas - areas.joint
        overlap = (areas.joint / union).max(axis=0, initial=0.0)
        held = (areas.joint / areas.true_areas[:, None]).max(axis=0, initial=0.0)
        is_false = overlap <= FOUND_IOU
        n_false += int(is_false.sum())
        n_windows += int((is_false & ((overlap > WINDOW_IOU) | (held > WINDOW_HELD))).sum())
    what = "of false panels, windows of another size or outline"
    return Row(scene, what, round(n_windows / max(n_false, 1), 3), "", None, f"{n_windows} of {n_false}")


def _reliability(scene: str, photos: list[ScoredPhoto]) -> Iterator[Row]:
    """Of panes with a confidence, how many are there: overlap a true one by more than half of both."""
    told: list[float] = []
    there: list[bool] = []
    for photo in photos:
        panes = find_panes(predict_photo(photo.image, LONG_SIDES_PX[-1])).panes
        told += [pane.confidence for pane in panes]
        there += are_there([pane.corners_px for pane in panes], np.asarray(photo.index, np.uint16)).tolist()
    confidence, is_there = np.array(told), np.array(there, bool)
    off = n = 0.0
    for low, high in pairwise(REPORTED):
        chosen = (confidence >= low) & (confidence < high)
        if chosen.any():
            said, share = float(confidence[chosen].mean()), float(is_there[chosen].mean())
            what = f"share there, of panes said {low:.2f} to {high:.2f}"
            yield Row(scene, what, round(share, 3), "", None, f"said {said:.2f}; {chosen.sum()} panes")
            if low >= LEAST_BELIEVED:
                off, n = off + chosen.sum() * abs(said - share), n + chosen.sum()
    yield Row(scene, "expected calibration error of reported panes", round(off / max(n, 1.0), 3))


BENCHMARK = Benchmark(
    "network",
    "The network for panes on real photos",
    "Photos of real glass and of offices at night of which the others were learned from, and CMP, of which none was: "
    "by lines, by what the photo calls for, and by the network in photos of several sizes (a size includes the smaller "
    "ones). Confidences were fitted to half of the photos of glass and offices here, too. Then, of panes with a "
    f"confidence, how many are there; those below {LEAST_BELIEVED} are not reported. At last windows in walls by which "
    "this version was not chosen; ECP's are painted only as far as balconies leave them to be seen.",
    measure,
)

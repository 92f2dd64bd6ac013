"""What accuracy of the search for panels costs in time: its knobs turned one at a time, on the same photos."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.tradeoff.runner import GapAxis, Panel, knob_lines
from reconstruction.metrics.metrics import PhotoScores, SetScores, summarise
from reconstruction.metrics.run import Method, fused_method, own_method, score_answer, viewed, viewed_method
from reconstruction.metrics.sets import PhotoSet
from reconstruction.panels.rectify.fit import VIEW_KINDS, ViewKind
from reconstruction.panels.rectify.surface import PolynomialView
from reconstruction.panels.search.parameters import DETECTORS, Detector, SegmentationParameters

SAMPLES_NAME = "samples of a row"
"""Turned with the posterior on (Eqs. 5 to 8): without it no rows are compared."""

VIEWS_NAME, RECTIFIED_NAME = "views together", "rectified"

MIOU_AXIS = GapAxis(
    label="individual mIoU",
    ticks=(1.0, 0.7, 0.5, 0.3, 0.2, 0.1, 0.05, 0.03, 0.02, 0.01, 0.005, 0.002),
    text=lambda gap: f"{1.0 - gap:g}",
    floor=1e-3,
    bound_text="1: every panel to the pixel",
)


@dataclass(frozen=True, slots=True)
class SegmentVariants:
    """Values of each knob; all others stay as they are.

    Parameters
    ----------
    samples
        Of a row or column that are compared, with the posterior on; 0 for all.
    n_views
        Photos of a facade that are searched together; they must be in the set.
    view_kinds
        Ways to rectify, for sets whose surfaces are known.
    """

    long_sides_px: tuple[int, ...] = (400, 800, 1200, 1600)
    samples: tuple[int, ...] = (32, 128, 512, 0)
    detectors: tuple[Detector, ...] = ()
    n_views: tuple[int, ...] = ()
    view_kinds: tuple[ViewKind, ...] = ()

    def __post_init__(self) -> None:
        unknown = [name for name in self.detectors if name not in DETECTORS]
        if unknown:
            raise ValueError(f"--detectors: expected {', '.join(DETECTORS)}, got {unknown[0]}")
        if any(size < 16 for size in self.long_sides_px):
            raise ValueError(f"--sizes: expected 16 or more, got {min(self.long_sides_px)}")
        if any(number < 0 for number in self.samples):
            raise ValueError(f"--samples: expected 0 (all) or more, got {min(self.samples)}")
        if any(number < 1 for number in self.n_views):
            raise ValueError(f"--views: expected 1 or more, got {min(self.n_views)}")
        kinds = [kind for kind in self.view_kinds if kind not in VIEW_KINDS]
        if kinds:
            raise ValueError(f"--rectified-by: expected {', '.join(VIEW_KINDS)}, got {kinds[0]}")


@dataclass(frozen=True, slots=True, eq=False)
class SettingScores:
    """One setting of one knob and what came of it.

    Parameters
    ----------
    knob
        Empty for the settings that the others start from.
    view_error_px
        Largest error of the map into the photo that the rectification makes; None where it makes none.
    """

    knob: str
    value: str
    parameters: SegmentationParameters
    scores: SetScores
    view_error_px: float | None = None

    @property
    def seconds(self) -> float:
        """Mean of a photo."""
        return self.scores.seconds.mean

    @property
    def gap(self) -> float:
        """1 - individual mIoU."""
        single = self.scores.individual_miou
        return 1.0 if single is None else 1.0 - single.mean

    @property
    def name(self) -> str:
        """For tables."""
        return f"{self.knob} {self.value}" if self.knob else "as asked"


def run_variants(
    photos: PhotoSet, base: SegmentationParameters, variants: SegmentVariants, monitor: Monitor = QUIET
) -> tuple[SettingScores, ...]:
    """Score every setting on every photo; each photo is made or read once.

    Raises
    ------
    InputError
        A photo cannot be read.
    OperationCancelled
        The user cancelled.
    """
    settings = _settings(base, variants)
    done: list[list[PhotoScores]] = [[] for _ in settings]
    off_px: list[list[float]] = [[] for _ in settings]
    total = photos.n_photos * len(settings)
    for number, photo in enumerate(photos.photos()):
        for which, setting in enumerate(settings):
            monitor.report(say("comparing settings"), number * len(settings) + which, total)
            if number == 0:
                # Compiling is in no setting's time.
                setting.method(photo, QUIET)
            answer = setting.method(photo, QUIET)
            done[which].append(score_answer(photo, answer))
            if setting.kind == "polynomial":
                views = viewed(photo, setting.kind)
                off_px[which] += [
                    one.photo_from_rectified.residual_px for one in views if isinstance(one, PolynomialView)
                ]
    return tuple(
        SettingScores(one.knob, one.value, one.parameters, summarise(scores), max(off, default=None))
        for one, scores, off in zip(settings, done, off_px, strict=True)
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Setting:
    knob: str
    value: str
    parameters: SegmentationParameters
    method: Method
    kind: ViewKind = "auto"


def _settings(base: SegmentationParameters, variants: SegmentVariants) -> list[_Setting]:
    changed = [
        *(("image size", str(size), replace(base, long_side_px=size)) for size in variants.long_sides_px),
        *(
            (SAMPLES_NAME, str(number), replace(base, n_samples=number, use_posterior=True))
            for number in variants.samples
        ),
        *(("detector", name, replace(base, detector=name)) for name in variants.detectors),
    ]
    return [
        *(
            _Setting(knob, value, parameters, own_method(parameters))
            for knob, value, parameters in [("", "", base), *changed]
        ),
        *(_Setting(VIEWS_NAME, str(n), base, fused_method(n, base)) for n in variants.n_views),
        *(_Setting(RECTIFIED_NAME, kind, base, viewed_method(kind, base), kind) for kind in variants.view_kinds),
    ]


def variant_rows(runs: Sequence[SettingScores]) -> list[dict[str, Any]]:
    """Rows of the table."""
    rows = []
    for run in runs:
        single, scores = run.scores.individual_miou, run.scores
        rows.append(
            {
                "setting": run.name,
                "seconds": round(scores.seconds.mean, 4),
                "individual_miou": None if single is None else round(single.mean, 5),
                "individual_miou_worst": None if single is None else round(single.worst, 5),
                "overall_iou": round(scores.overall_iou.mean, 5),
                "coverage_p5": round(scores.coverage[5], 5),
                "missed": scores.n_missed,
                "photos": len(scores.photos),
                "view_error_px": None if run.view_error_px is None else round(run.view_error_px, 3),
            }
        )
    return rows


def variants_panel(title: str, runs: Sequence[SettingScores]) -> Panel:
    """A line for each knob: the best mIoU that its settings reach in the time they take."""
    lines = knob_lines(runs, "as asked", lambda best: f"{1.0 - best.gap:.4f} in {best.seconds:.2f} s")
    return Panel(title, lines)

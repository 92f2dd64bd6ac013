"""Use case of rendering: a model to pictures."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from planning.base.errors import InputError
from planning.base.progress import QUIET, Monitor

if TYPE_CHECKING:
    from reconstruction.base.cameras import PosedPhoto
    from reconstruction.training.model.saved import TrainedModel


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


def render_files(model: Path, wish: RenderRequest, out: Path, monitor: Monitor = QUIET) -> tuple[Path, ...]:
    """Render a model's views into a folder; the pictures written.

    Raises
    ------
    InputError
        Model or views cannot be read, or a file cannot be written.
    """
    from reconstruction.training.model import render
    from reconstruction.training.model.camera_path import cameras_between
    from reconstruction.training.model.saved import read_model

    trained = read_model(model)
    photos = _cameras(wish, trained)
    if wish.n_frames is not None:
        photos = cameras_between(photos, wish.n_frames)
    return render.render_files(trained.model, photos, out, wish.layers, trained.record.config.raster, monitor)


def _cameras(wish: RenderRequest, trained: TrainedModel) -> tuple[PosedPhoto, ...]:
    from groundstation.services.project.input_files import read_given_plan
    from reconstruction.light.photo_set import read_photo_set
    from reconstruction.scenes.photos.flight_views import WIDTHS_PX, lens_of, planned_shots, posed_photos

    if wish.width_px is not None and not WIDTHS_PX[0] <= wish.width_px <= WIDTHS_PX[1]:
        raise InputError(f"--width: expected {WIDTHS_PX[0]} to {WIDTHS_PX[1]}, got {wish.width_px}")
    if not wish.views.is_dir():
        plan = read_given_plan(wish.views)
        return posed_photos(planned_shots(plan), lens_of(plan.camera, wish.width_px), Path())
    source = read_photo_set(wish.views)
    held_out = trained.record.held_out
    photos = source.named(held_out) if wish.held_out_only else source.photos
    if not photos:
        raise InputError(f"{wish.views}: has none of the views that the model did not learn from; leave --held-out out")
    return photos if wish.width_px is None else tuple(_resized(photo, wish.width_px) for photo in photos)


def _resized(photo: PosedPhoto, width_px: int) -> PosedPhoto:
    lens = photo.intrinsics
    return replace(photo, intrinsics=lens.scaled(width_px, max(1, round(width_px * lens.height_px / lens.width_px))))

"""One training of a table: photos in, model out, scored on the glass of views that nobody planned."""

from __future__ import annotations

import hashlib
import json
import statistics
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from reconstruction.base.cameras import PosedPhoto
from reconstruction.light.photo_set import PhotoSet, read_photo_set
from reconstruction.metrics.image_metrics import score_picture
from reconstruction.metrics.lpips import read_lpips_weights
from reconstruction.splats.rasterising.views import View
from reconstruction.training.config import TrainConfig, config_of
from reconstruction.training.model.render import png_of, render_view
from reconstruction.training.model.saved import TrainedModel
from reconstruction.training.model.score import score_views
from reconstruction.training.timer import Timer
from reconstruction.training.train import train_model
from tests.benchmarks.harness import machine
from tests.tables.photos import Photos, Planner, photos_in
from tests.tables.results import Result
from tests.tables.scales import SCALES, Scale

LEAST_GLASS = 0.01
"""Of a photo's pixels; of fewer no number can be made."""

OF_PANELS = ("light", "geometry", "light_share", "reflections")
"""Settings that change nothing where a method knows no panels."""


@dataclass(frozen=True, slots=True)
class Case:
    """A line of a table.

    Parameters
    ----------
    title
        As the table has it.
    method
        Of `METHODS`.
    settings
        Of `TrainConfig`, as in TOML, that differ from the method's and the scale's.
    planner
        Of the photos that are learned from.
    paper
        The paper's PSNR by its scene, ST (planar) and UST (curved), where it has one.
    width_px, n_views
        Of the photos, and how many are learned from; None for the scale's.
    """

    title: str
    method: str
    settings: Mapping[str, Any] = field(default_factory=dict)
    planner: Planner = "greedy"
    paper: Mapping[str, float] = field(default_factory=dict)
    width_px: int | None = None
    n_views: int | None = None

    def config(self, scale: Scale, seed: int) -> TrainConfig:
        """Of its trainings."""
        base = replace(scale.config, seed=seed)
        named = config_of({"method": self.method}, base, Path(self.title))
        of_scale = config_of(dict(scale.own.get(self.method, {})), named, Path(self.title))
        return config_of(dict(self.settings), of_scale, Path(self.title))

    def photos(self, scene: str, scale: Scale) -> tuple[Photos, Photos]:
        """To learn from, and to be scored on."""
        width_px, n_views = self.width_px or scale.width_px, self.n_views or scale.n_views
        return Photos(scene, self.planner, n_views, width_px), Photos(scene, "unseen", scale.n_unseen, width_px)

    def made_with(self, scene: str, scale: Scale) -> str:
        """Checksum of all that its numbers depend on, but for the seed; of the program, of what `_changes` says."""
        config = self.config(scale, 0)
        settings = asdict(config)
        if config.start_from == "surfaces":
            del settings["start_from"]  # as all did before there was a choice
        for effect in ("own_exposures", "outlier_photos", "own_poses", "light_apart", "points_for_mesh"):
            if settings[effect] == "auto":
                del settings[effect]  # these scenes' photos are exposed alike and posed right, mirror images are clear
        if settings["overexposed"] in ("auto", "off"):
            del settings["overexposed"]  # next to white is a pixel in ten thousand
        for part in ("losses", "reflections"):
            if settings[part]["white"] == 1.0:
                del settings[part]["white"]
        settings["rates"].pop("poses")
        settings["reflections"].pop("transients")
        if settings["transients"] in ("auto", "off"):
            del settings["transients"]  # photos of these scenes agree
        if not config.trained_by.knows_panels:
            settings = {name: value for name, value in settings.items() if name not in OF_PANELS}
            settings["rates"].pop("glass_geometry")
        what = [settings, [asdict(each) for each in self.photos(scene, scale)], *_changes(config)]
        return hashlib.sha256(json.dumps(what, sort_keys=True, default=str).encode()).hexdigest()[:10]


def _changes(config: TrainConfig) -> list[str]:
    """What the program does otherwise than when the first results were kept, of what numbers depend on."""
    found = []
    if config.raster.antialiased and config.trained_by.primitive == "discs":
        found.append("discs are blurred")
    if config.trained_by.knows_panels:
        found.append("surfaces that share a pixel are shaded each for itself")
    return found


def trained_and_scored(
    case: Case,
    scene: str,
    scale_name: str,
    seed: int,
    work: Path,
    weights: Sequence[Path],
    picture: Path | None,
) -> Result:
    """Train a case once, by processor time, and score it.

    Parameters
    ----------
    weights
        Of LPIPS; none leave it out.
    picture
        Where `shown_photo` goes, as a PNG file; None for nowhere.
    """
    scale = SCALES[scale_name]
    learned, unseen = (photos_in(work, each) for each in case.photos(scene, scale))
    config = case.config(scale, seed)
    trained = train_model(learned, config, watch=Timer(time.process_time))
    source = read_photo_set(unseen)
    lpips = read_lpips_weights(weights) if weights else None
    scores = score_views(trained, source, [photo.name for photo in source.photos], lpips, threads=1)
    scores = tuple(score for score in scores if score.facade.psnr_db is not None)
    shares = shares_of_glass(source)
    by_view = [(shares[score.name], float(score.facade.psnr_db or 0.0)) for score in scores]
    of_glass = glass_scores(trained, source)
    if picture is not None:
        picture.write_bytes(shown_view(trained, source))
    return Result(
        scene,
        case.title,
        seed,
        scale.name,
        case.made_with(scene, scale),
        round(statistics.fmean(psnr_db for _, psnr_db in by_view), 3),
        round(min(psnr_db for _, psnr_db in by_view), 3),
        round(statistics.fmean(score.facade.ssim or 0.0 for score in scores), 4),
        None if lpips is None else round(statistics.fmean(score.facade_lpips or 0.0 for score in scores), 4),
        round(trained.seconds, 1),
        trained.n_steps,
        trained.n_splats,
        machine(),
        " ".join(f"{share:.3f}:{psnr_db:.2f}" for share, psnr_db in by_view),
        round(statistics.fmean(of_glass), 3) if of_glass else None,
    )


@torch.no_grad()
def glass_scores(trained: TrainedModel, source: PhotoSet) -> list[float]:
    """PSNR of each view of the pixels that show one panel and nothing beside it, of views that have enough of them.

    Of small photos most pixels of a facade show a frame, too; of photos as large as the paper's few do.
    """
    found = []
    for photo in source.photos:
        within = whole_panels(source.panel_numbers(photo))
        if within.mean() < LEAST_GLASS:
            continue
        psnr_db = score_picture(_shown(trained, source, photo), source.picture(photo), within).psnr_db
        found.append(float(psnr_db or 0.0))
    return found


def whole_panels(numbers: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Of panels by pixel, shape (h, w), those whose eight neighbours show the same one; below 0 there is none."""
    around = np.pad(numbers, 1, constant_values=-1)
    height, width = numbers.shape
    beside = [around[y : y + height, x : x + width] for y in range(3) for x in range(3)]
    return np.asarray((numbers >= 0) & np.all([each == numbers for each in beside], axis=0))


def shares_of_glass(source: PhotoSet) -> dict[str, float]:
    """Of each photo's pixels, by its name."""
    return {photo.name: float((source.panel_numbers(photo) >= 0).mean()) for photo in source.photos}


def shown_photo(source: PhotoSet) -> PosedPhoto:
    """The one that shows most glass."""
    shares = shares_of_glass(source)
    return max(source.photos, key=lambda photo: shares[photo.name])


@torch.no_grad()
def shown_view(trained: TrainedModel, source: PhotoSet) -> bytes:
    """`shown_photo` as the model shows it, PNG."""
    return png_of(np.round(255.0 * _shown(trained, source, shown_photo(source))).astype(np.uint8))


def _shown(trained: TrainedModel, source: PhotoSet, photo: PosedPhoto) -> NDArray[np.float32]:
    """A photo as the model shows it, in its exposure, sRGB, shape (h, w, 3)."""
    view = View.of(replace(photo, intrinsics=photo.intrinsics.straight()), trained.model.origin_enu_m)
    gain = source.exposure / trained.record.exposure * source.own_exposures.get(photo.name, 1.0)
    settings = replace(trained.record.config.raster, threads=1)
    return render_view(trained.model, view, (), gain, settings).display

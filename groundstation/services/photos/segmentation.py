"""Use cases around panels in photos: find them in one, and score how well they are found in many."""

from __future__ import annotations

import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from groundstation.services.project.input_files import FileKind, expecting
from planning.base.errors import InputError
from planning.base.json_file import check_output
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.tradeoff.runner import ComparisonFiles, Subject, compare, output_folder
from reconstruction.metrics.metrics import SetScores
from reconstruction.metrics.pictures import read_picture, write_picture
from reconstruction.metrics.run import masks_method, own_method, score_set, write_pictures, write_table
from reconstruction.metrics.sets import (
    EXTENT_MARGIN_M,
    READERS,
    SYNTHETIC_SETS,
    PhotoSet,
    annotated_set,
    folder_set,
    synthetic_set,
    whole_view,
)
from reconstruction.panels.panels_file import panels_record, write_panels
from reconstruction.panels.search.parameters import SegmentationParameters
from reconstruction.panels.search.record import Segmentation
from reconstruction.panels.segment import segment_image
from reconstruction.scenes.facades.cases import wide_camera
from reconstruction.tradeoff.search_tradeoff import (
    MIOU_AXIS,
    SegmentVariants,
    SettingScores,
    run_variants,
    variant_rows,
    variants_panel,
)

TABLE_FILE = "segmentation-scores.csv"


@dataclass(frozen=True, slots=True, eq=False)
class SegmentedPhoto:
    """What `segment` found, and how long it took without reading and writing."""

    found: Segmentation
    seconds: float


def segment_file(
    image: Path,
    out: Path,
    parameters: SegmentationParameters | None = None,
    *,
    is_rectified: bool = False,
    monitor: Monitor = QUIET,
) -> SegmentedPhoto:
    """Find the panels in a photo and write them to `out`.

    A photo that is fronto-parallel (`is_rectified`) is searched as it is; otherwise its facades and how they are turned
    follow from vanishing points.

    Raises
    ------
    InputError
        The photo cannot be read or the result not be written.
    """
    check_output(out, [image])
    with expecting(FileKind.PHOTO, image):
        picture = read_picture(image)
    started = time.perf_counter()
    found = segment_image(picture, whole_view(picture) if is_rectified else None, parameters, monitor, image.name)
    seconds = time.perf_counter() - started
    write_panels(out, panels_record(found))
    return SegmentedPhoto(found, seconds)


def segmented_summary(done: SegmentedPhoto) -> dict[str, Any]:
    """Numbers of what was found, for `--json`."""
    facades = [
        {
            "id": facade.id,
            "rows": len(facade.rows) - 1,
            "columns": len(facade.columns) - 1,
            "panels": len(facade.panels),
            "least_confidence": round(min(panel.confidence for panel in facade.panels), 4),
        }
        for facade in done.found.facades
        if facade.panels
    ]
    decisions = [asdict(facade.network) for facade in done.found.facades if facade.network is not None]
    return {
        "panels": len(done.found.panels),
        "facades": facades,
        "network": decisions[0] if decisions else None,
        "seconds": round(done.seconds, 3),
    }


@dataclass(frozen=True, slots=True)
class ScoreRequest:
    """What is to be scored.

    Parameters
    ----------
    set_name
        One of `reconstruction.metrics.sets.SET_NAMES`.
    n_seeds, width_px
        Number and width of the photos of a synthetic set; 4 : 3.
    is_extent_known
        Whether the search is told where the walls of a synthetic set end, to 2 m, as by a coarse model.
    data
        Folder of an annotated set.
    images, truth
        Folders of the user's own set: photos, and index images of the same names.
    is_rectified
        Whether those photos are fronto-parallel.
    masks
        Another method's masks, to be scored instead of what Reflight finds.
    first_seed
        Of a synthetic set.
    """

    set_name: str
    n_seeds: int = 10
    width_px: int = 1600
    is_extent_known: bool = True
    data: Path | None = None
    images: Path | None = None
    truth: Path | None = None
    is_rectified: bool = False
    masks: Path | None = None
    parameters: SegmentationParameters | None = None
    first_seed: int = 0


@dataclass(frozen=True, slots=True, eq=False)
class ScoreReport:
    """Scores, and the files written: a table, and pictures of the photos done worst."""

    scores: SetScores
    table_path: Path
    picture_paths: tuple[Path, ...]


def score_segmentation(request: ScoreRequest, out: Path, monitor: Monitor = QUIET) -> ScoreReport:
    """Score Reflight's search for panels, or another method's masks; write a table and pictures into `out`.

    Raises
    ------
    InputError
        The set lacks a folder, a file cannot be read, the folder cannot be made.
    """
    photos = photo_set(request)
    method = own_method(request.parameters) if request.masks is None else masks_method(request.masks, photos)
    with output_folder(out) as folder:
        scores, worst = score_set(photos, method, monitor)
        write_table(scores.photos, folder / TABLE_FILE)
        pictures = write_pictures(worst, folder)
    return ScoreReport(scores, out / TABLE_FILE, tuple(out / path.name for path in pictures))


def save_photos(request: ScoreRequest, out: Path, monitor: Monitor = QUIET) -> int:
    """Write the photos of a set as PNG, for other methods to work on; returns their number.

    Raises
    ------
    InputError
        As `photo_set`, or the folder cannot be written into.
    """
    photos = photo_set(request)
    n_done = 0
    with output_folder(out) as folder:
        for photo in photos.photos():
            monitor.report(say("saving photos"), n_done, photos.n_photos)
            write_picture(folder / f"{photo.name}.png", photo.image)
            n_done += 1
    return n_done


def photo_set(request: ScoreRequest, n_beside: int = 0) -> PhotoSet:
    """The photos that a request is about.

    Parameters
    ----------
    n_beside
        More photos of each facade; synthetic sets only.

    Raises
    ------
    InputError
        A folder that the set needs was not named, or holds no such photos.
    """
    name = request.set_name
    if name in SYNTHETIC_SETS:
        camera = wide_camera(request.width_px, round(0.75 * request.width_px))
        margin_m = EXTENT_MARGIN_M if request.is_extent_known else None
        return synthetic_set(name, request.n_seeds, camera, margin_m, n_beside, request.first_seed)
    if name in READERS:
        if request.data is None:
            raise InputError(
                say("needs the folder of its annotated photos; name it with --data", place=f"--set {name}")
            )
        return annotated_set(name, request.data)
    if name == "folder":
        if request.images is None or request.truth is None:
            raise InputError(say("--set folder: needs photos and index images; name both with --images and --truth"))
        return folder_set(request.images, request.truth, request.is_rectified)
    raise ValueError(f"expected a known set, got {name}")


def segment_tradeoff(
    request: ScoreRequest, variants: SegmentVariants, out: Path, monitor: Monitor = QUIET
) -> ComparisonFiles[tuple[SettingScores, ...]]:
    """Turn the knobs of the search for panels one at a time; write `tradeoff-segment.csv` and `.png` into `out`.

    Raises
    ------
    InputError
        As `photo_set`, or the folder cannot be written into.
    """
    if request.set_name not in SYNTHETIC_SETS and (variants.n_views or variants.view_kinds):
        raise InputError(
            say(
                "--views, --rectified-by: the photos of '{}' have no poses, which both need; take a synthetic set: {}",
                request.set_name,
                ", ".join(SYNTHETIC_SETS),
            )
        )
    photos = photo_set(request, max(variants.n_views, default=1) - 1)
    base = request.parameters or SegmentationParameters()
    subject: Subject[tuple[SettingScores, ...]] = Subject(
        "segment",
        MIOU_AXIS,
        variant_rows,
        lambda runs: f"{photos.name}: {photos.n_photos} photos, {runs[0].scores.n_panels} panels",
        lambda runs: [variants_panel("accuracy against time for one photo", runs)],
    )
    return compare(subject, out, lambda _: run_variants(photos, base, variants, monitor))

"""Models of photos that are not as synthetic ones are: real sets of photos, and synthetic photos with one fault each.

What goes wrong with real photos goes wrong together: light that changes, few photos, white that is clipped, poses that
are off. On synthetic photos each is there alone, so that it can be told which of them costs what.
"""

from __future__ import annotations

import math
import shutil
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from groundstation.services.model.rendering import stored_lpips_weights
from groundstation.services.photos.coarse import REPORT_FILE, SITE_FILE, SPARSE, coarse_files
from groundstation.services.project.input_files import read_input_site
from groundstation.services.scenes.photos import render_photos
from planning.base.json_file import read_json
from reconstruction.base.cameras import Pose, PosedPhoto
from reconstruction.coarse.parameters import CoarseRequest
from reconstruction.colmap.folder import read_model, write_model
from reconstruction.colmap.georeference import Similarity, model_of, posed_photos
from reconstruction.dataset.prepare import prepare
from reconstruction.light.photo_set import held_out_names, read_photo_set
from reconstruction.metrics.lpips import read_lpips_weights
from reconstruction.scenes.parameters import SceneRequest
from reconstruction.splats.rasterising.views import View
from reconstruction.splats.surfels import colmap_points
from reconstruction.training.config import config_of
from reconstruction.training.method_registry import DEFAULT_METHOD, PLAIN_METHOD, method_named
from reconstruction.training.model.render import render_view
from reconstruction.training.model.saved import TrainedModel
from reconstruction.training.model.score import ViewScores, mean_of, score_views
from reconstruction.training.photos.exposures import HeldOutGain
from reconstruction.training.presets import preset
from reconstruction.training.timer import Timer
from reconstruction.training.train import train_model
from reconstruction.warm_up import compile_kernels
from tests.benchmarks.experiments import on_one_thread
from tests.benchmarks.harness import DATA_VARIABLE, Benchmark, Context, Row, Skipped

Array = NDArray[np.float64]

METHODS = {"2dgs": "2DGS", "3dgs": "3DGS", "refglass-gs": "RefGlass-GS", "reflight": "ours"}

ENDLESS = 1_000_000
"""Steps, so that time ends a training."""

MOST_BELOW_DB = 0.2
"""That ours may be below 2DGS, on any photos."""


def trained_within(
    folder: Path, method: str, seconds: float, gain: HeldOutGain = "none", more: Mapping[str, Any] | None = None
) -> tuple[TrainedModel, tuple[ViewScores, ...]]:
    """A training with the usual settings, by processor time, and scores of the views held out."""
    config = config_of({"method": method}, preset("10min"), Path("--method"))
    config = replace(config, time_limit_s=seconds, iterations=ENDLESS, score_every_s=seconds, **(more or {}))
    trained = train_model(folder, on_one_thread(config), watch=Timer(time.process_time))
    kept = stored_lpips_weights()
    weights = read_lpips_weights(kept) if kept else None
    return trained, score_views(trained, read_photo_set(folder), trained.record.held_out, weights, gain, threads=1)


# Real sets of photos.

LONG_PX, LONG_S = 384, 90.0
"""Longer side of the photos that are learned from, and processor time of each training."""

QUICK_LONG_PX, QUICK_S = 128, 4.0

COARSE = "coarse"
"""Folder of the model of photos alone, below that of a set."""

COARSE_PX = 1000
"""Longer side of photos that poses are found from, where none lie beside them."""

SHOWN_PX, SHOWN_QUALITY = 300, 80
"""Width of each of the pictures that are shown beside one another."""

NOT_RUN = "not run"

OTHERS = Path("benchmark-out")
"""Where pictures go whose licence lets nobody else have them."""


@dataclass(frozen=True, slots=True)
class RealSet:
    """A real set of photos.

    Parameters
    ----------
    name, title
        For file names, and for the table.
    data
        Folder below that of the real input data; photos may also lie in `DATA_VARIABLE`.
    make
        Data set folder of photos of that folder, in another folder, with photos of some longer side.
    may_be_shown
        Whether pictures made of it may be passed on.
    """

    name: str
    title: str
    data: str
    make: Callable[[Path, Path, int], Path]
    may_be_shown: bool


def smaller_photos(photos: Sequence[PosedPhoto], folder: Path, long_px: int) -> list[PosedPhoto]:
    """Photos of a longer side of so many pixels, written into a new folder, and their cameras."""
    folder.mkdir(parents=True)
    smaller = []
    for photo in photos:
        share = long_px / max(photo.intrinsics.width_px, photo.intrinsics.height_px)
        lens = photo.intrinsics.scaled(
            round(share * photo.intrinsics.width_px), round(share * photo.intrinsics.height_px)
        )
        picture = cv2.imread(str(photo.path), cv2.IMREAD_COLOR | cv2.IMREAD_IGNORE_ORIENTATION)
        path = folder / photo.name
        small = cv2.resize(picture, (lens.width_px, lens.height_px), interpolation=cv2.INTER_AREA)
        cv2.imwrite(str(path), small, [cv2.IMWRITE_JPEG_QUALITY, 97])
        smaller.append(replace(photo, path=path, intrinsics=lens))
    return smaller


def of_wall(source: Path, folder: Path, long_px: int) -> Path:
    """The data set of the wall's photos, with the poses and panels that lie beside them."""
    photos = posed_photos(read_model(source / "colmap"), Similarity.identity(), source / "photos")
    smaller = smaller_photos(photos, folder / "photos", long_px)
    return prepare(smaller, read_input_site(source / "wall.site.json"), folder / "data").folder


def of_photos_alone(source: Path, folder: Path, long_px: int) -> Path:
    """The data set of a folder of photos, as `coarse` and `train` make it of them."""
    pictures, coarse = folder / "jpegs", folder / COARSE
    pictures.mkdir(parents=True)
    for path in sorted(source.iterdir()):
        if path.suffix.lower() in (".jpg", ".jpeg"):
            shutil.copyfile(path, pictures / path.name)
    coarse_files(CoarseRequest(pictures, coarse, size_px=COARSE_PX))
    model = read_model(coarse / SPARSE)
    smaller = smaller_photos(posed_photos(model, Similarity.identity(), pictures), folder / "photos", long_px)
    site = read_input_site(coarse / SITE_FILE)
    return prepare(smaller, site, folder / "data", cloud=colmap_points(model)[0]).folder


SETS = (
    RealSet("wall", "glass wall", "glass/wall", of_wall, True),
    RealSet("sceaux", "Sceaux castle", "multiview/sceaux", of_photos_alone, False),
    RealSet("lund", "Lund door", "multiview/lund_door", of_photos_alone, False),
    RealSet("flight", "drone flight", "multiview/mirafiori", of_photos_alone, False),
)


def measure_sets(context: Context) -> Iterator[Row]:
    """Each method in as much processor time, on each set that is there."""
    compile_kernels()  # else it would count as time of the first training
    n_there = 0
    for each in SETS:
        try:
            source = context.data(each.data)
        except Skipped as reason:
            yield Row(each.title, "skipped", NOT_RUN, "", None, str(reason))
            continue
        n_there += 1
        yield from _measure_set(each, source, context)
    if not n_there:
        raise Skipped("none of the real sets of photos is on this machine")


def _measure_set(each: RealSet, source: Path, context: Context) -> Iterator[Row]:
    long_px, seconds = (QUICK_LONG_PX, QUICK_S) if context.is_quick else (LONG_PX, LONG_S)
    found: dict[str, float] = {}
    texts: dict[str, str] = {}
    pictures: dict[str, NDArray[np.uint8]] = {}
    with tempfile.TemporaryDirectory() as place:
        folder = each.make(source, Path(place), long_px)
        if (report := Path(place) / COARSE / REPORT_FILE).exists():
            yield from _about_coarse(each.title, read_json(report))
        photos = read_photo_set(folder)
        has_panels = len(photos.panels.corners_enu_m) > 0
        for method, title in METHODS.items():
            plain = method == DEFAULT_METHOD and not has_panels
            if plain:
                found[method], pictures[method] = found[PLAIN_METHOD], pictures[PLAIN_METHOD]
                text = f"{texts[PLAIN_METHOD]}; no panels: `train` takes {METHODS[PLAIN_METHOD]} by itself"
            elif method_named(method).knows_panels and not has_panels:
                yield Row(each.title, title, NOT_RUN, "", None, "no panels")
                continue
            else:
                trained, scores = trained_within(folder, method, seconds, "fitted")
                found[method] = mean_of(score.facade.psnr_db for score in scores) or 0.0
                shown = photos.named(trained.record.held_out)[0]
                pictures["truth"] = photos.picture(shown)
                view = View.of(shown, trained.model.origin_enu_m)
                pictures[method] = np.round(255.0 * render_view(trained.model, view, ()).display).astype(np.uint8)
                as_taken = score_views(trained, photos, trained.record.held_out, None, "none", threads=1)
                unfitted = mean_of(score.facade.psnr_db for score in as_taken) or 0.0
                text = texts[method] = f"{unfitted:.2f} dB at the exposure learned; {_beside(trained, scores)}"
            yield Row(each.title, title, round(found[method], 2), "dB", None, text)
        _show(each, [pictures[name] for name in ("truth", "2dgs", DEFAULT_METHOD)], context)
    yield _difference(each.title, found, context.is_quick)


def _about_coarse(scene: str, report: Mapping[str, Any]) -> Iterator[Row]:
    """What came of photos alone; against receivers where they have any."""
    text = f"of {report['photos']}; image points off by {report['reprojection_px']:.2f} px, {report['points']} points"
    yield Row(scene, "photos that found their place", report["registered"], "", None, text)
    off = report["position_residual_m"]
    if off:
        yield Row(scene, "median distance to receivers", off["median"], "m", None, f"largest {off['largest']:.2f} m")


def _show(each: RealSet, pictures: Sequence[NDArray[np.uint8]], context: Context) -> None:
    """Write pictures beside one another: a photo that was held out, and what models show there."""
    height, width = pictures[0].shape[:2]
    size = (SHOWN_PX, round(SHOWN_PX * height / width))
    beside = np.hstack([cv2.resize(picture, size, interpolation=cv2.INTER_AREA) for picture in pictures])
    folder = context.folder if each.may_be_shown else OTHERS
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"real-photos-{each.name}.jpg"
    cv2.imwrite(str(path), beside[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, SHOWN_QUALITY])


def _beside(trained: TrainedModel, scores: Sequence[ViewScores]) -> str:
    whole = mean_of(score.whole.psnr_db for score in scores) or 0.0
    likeness = (
        f"{name} {value:.3f}"
        for name, value in (
            ("SSIM", mean_of(score.facade.ssim for score in scores)),
            ("LPIPS", mean_of(score.facade_lpips for score in scores)),
            ("FLIP", mean_of(score.facade_flip for score in scores)),
        )
        if value is not None
    )
    light = "" if trained.record.light is None else f", {trained.record.light.name}"
    return f"whole pictures {whole:.2f} dB; facades {', '.join(likeness)}; {trained.n_steps} steps{light}"


def _difference(scene: str, found: dict[str, float], is_quick: bool) -> Row:
    gained = found["reflight"] - found["2dgs"]
    target = ("", None) if is_quick else (f"no more than {MOST_BELOW_DB} dB below", gained >= -MOST_BELOW_DB)
    return Row(scene, "ours against 2DGS", round(gained, 2), "dB", None, "", *target)


# Made photos with one fault each.

N_VIEWS, WIDTH_PX, FAULT_S = 36, 128, 120.0
QUICK_N_VIEWS, QUICK_FAULT_WIDTH_PX = 8, 64

GAIN_SPREAD, BALANCE_SPREAD = 0.25, 0.08
"""Of logarithms of exposure and of each colour's own gain: a camera that decides by itself, photo by photo."""

OVEREXPOSED = 3.0
"""Times the light that the photos were exposed for."""

N_OVALS, DARKER, BRIGHTER = 4, -1.5, 1.0
"""Passers-by of each photo, and the logarithm of what they do to what is mirrored."""

CHANGED = 0.6
"""Of the logarithm of what is mirrored: clouds that move from one photo to the next."""

OFF_PX, OFF_M = 2.0, 0.1
"""Of turns and places of cameras."""

FEW = 14
"""Photos."""


def linear_of(display: Array) -> Array:
    """Linear light of sRGB values."""
    return np.where(display > 0.04045, ((display + 0.055) / 1.055) ** 2.4, display / 12.92)


def display_of(linear: Array) -> Array:
    """SRGB values of linear light, as a sensor clips it."""
    linear = np.clip(linear, 0.0, 1.0)
    return np.where(linear > 0.0031308, 1.055 * linear ** (1.0 / 2.4) - 0.055, 12.92 * linear)


def rewritten(folder: Path, light: Callable[[str, Array], Array]) -> None:
    """Put other light into all photos of a data set: by name and linear light, blue first."""
    for path in sorted((folder / "images").iterdir()):
        picture = display_of(light(path.name, linear_of(cv2.imread(str(path)) / 255.0)))
        cv2.imwrite(str(path), np.round(255.0 * picture).astype(np.uint8), [cv2.IMWRITE_JPEG_QUALITY, 95])


def none(folder: Path, base: Path) -> None:
    """Photos as they were rendered."""


def exposed_one_by_one(folder: Path, base: Path) -> None:
    """Each photo with an exposure and a white balance of its own, which nobody tells."""

    def light(name: str, linear: Array) -> Array:
        rng = _rng(name)
        return np.asarray(linear * np.exp(rng.normal(0.0, GAIN_SPREAD) + rng.normal(0.0, BALANCE_SPREAD, 3)))

    rewritten(folder, light)


def overexposed(folder: Path, base: Path) -> None:
    """A seventh of the pixels is clipped."""
    rewritten(folder, lambda _, linear: OVEREXPOSED * linear)


def other_surroundings(folder: Path, base: Path) -> None:
    """What glass mirrors is brighter and darker in patches, which are others in each photo."""
    exposure = read_photo_set(base).exposure

    def light(name: str, linear: Array) -> Array:
        mirrored = exposure * np.load(base / "reflection" / f"{name}.npy").astype(float)[..., ::-1]
        patches = cv2.resize(_rng(name).normal(size=(4, 5)), linear.shape[1::-1], interpolation=cv2.INTER_CUBIC)
        return np.asarray(np.clip(linear - mirrored, 0.0, None) + mirrored * np.exp(CHANGED * patches)[..., None])

    rewritten(folder, light)


def passers_by(folder: Path, base: Path) -> None:
    """Something else stands before the facade in each photo; nothing does in views held out."""
    held_out = _held_out(folder)

    def light(name: str, linear: Array) -> Array:
        if name in held_out:
            return linear
        rng, found, brightest = _rng(name), linear.copy(), float(np.quantile(linear, 0.9))
        for area in _ovals(rng, linear.shape[:2], (0.08, 0.16), (0.2, 0.4)):
            found[area] = brightest * rng.uniform(0.02, 0.6, 3)
        return found

    rewritten(folder, light)


def mirrored_passers_by(folder: Path, base: Path) -> None:
    """Glass mirrors something else in places of each photo; it does not in views held out."""
    held_out, exposure = _held_out(folder), read_photo_set(base).exposure

    def light(name: str, linear: Array) -> Array:
        if name in held_out:
            return linear
        mirrored = exposure * np.load(base / "reflection" / f"{name}.npy").astype(float)[..., ::-1]
        rng, factors = _rng(name), np.ones(linear.shape[:2])
        for area in _ovals(rng, linear.shape[:2], (0.1, 0.25), (0.1, 0.25)):
            factors[area] = math.exp(rng.choice((DARKER, BRIGHTER)))
        return np.asarray(np.clip(linear - mirrored, 0.0, None) + mirrored * factors[..., None])

    rewritten(folder, light)


def _ovals(
    rng: np.random.Generator, shape: tuple[int, ...], width: tuple[float, float], height: tuple[float, float]
) -> Iterator[NDArray[np.bool_]]:
    """Areas somewhere in a picture, by the least and most shares of its sides that they take."""
    y, x = np.mgrid[: shape[0], : shape[1]]
    for _ in range(N_OVALS):
        half = 0.5 * rng.uniform(*width) * shape[1], 0.5 * rng.uniform(*height) * shape[0]
        middle = rng.uniform(0.0, shape[1]), rng.uniform(0.2 * shape[0], shape[0])
        yield ((x - middle[0]) / half[0]) ** 4 + ((y - middle[1]) / half[1]) ** 4 < 1.0


def _held_out(folder: Path) -> tuple[str, ...]:
    usual = preset("10min")
    return held_out_names([photo.name for photo in _cameras(folder)], usual.held_out, usual.seed)


def with_poses_off(folder: Path, base: Path) -> None:
    """Cameras that are said to be a little elsewhere, and turned; those of views held out are where they are."""
    held_out = _held_out(folder)

    def off(photo: PosedPhoto) -> PosedPhoto:
        rng, pose = _rng(photo.name), photo.pose
        turn = Rotation.from_rotvec(rng.normal(0.0, OFF_PX / photo.intrinsics.fx_px, 3)).as_matrix()
        return replace(photo, pose=Pose(pose.position_enu_m + rng.normal(0.0, OFF_M, 3), turn @ pose.cam_from_enu))

    _write_cameras(folder, [photo if photo.name in held_out else off(photo) for photo in _cameras(folder)])


def few(folder: Path, base: Path) -> None:
    """A third of the photos."""
    photos = _cameras(folder)
    chosen = np.unique(np.linspace(0, len(photos) - 1, min(FEW, len(photos))).round().astype(int))
    _write_cameras(folder, [photos[number] for number in chosen])


FAULTS: dict[str, Callable[[Path, Path], None]] = {
    "as rendered": none,
    "exposed one by one": exposed_one_by_one,
    "overexposed": overexposed,
    "other surroundings in each": other_surroundings,
    "passers-by": passers_by,
    "mirrored passers-by": mirrored_passers_by,
    "poses off by 2 px": with_poses_off,
    "14 photos": few,
}


OVERRULED = {
    with_poses_off: ("own_poses", "off", "ours, poses as told"),
    passers_by: ("transients", "off", "ours, passers-by not left out"),
    mirrored_passers_by: ("transients", "off", "ours, passers-by not left out"),
}
"""Effect and its setting in one more training with a fault, and what that is called."""


def _rng(name: str) -> np.random.Generator:
    return np.random.default_rng(list(name.encode()))


def _cameras(folder: Path) -> tuple[PosedPhoto, ...]:
    return posed_photos(read_model(folder / "sparse" / "0"), Similarity.identity(), folder / "images")


def _write_cameras(folder: Path, photos: Sequence[PosedPhoto]) -> None:
    shutil.rmtree(folder / "sparse" / "0")
    (folder / "sparse" / "0").mkdir()
    write_model(folder / "sparse" / "0", model_of(photos))


def measure_faults(context: Context) -> Iterator[Row]:
    """2DGS and ours on the same photos with one fault after the other."""
    n_views, width_px = (QUICK_N_VIEWS, QUICK_FAULT_WIDTH_PX) if context.is_quick else (N_VIEWS, WIDTH_PX)
    seconds = QUICK_S if context.is_quick else FAULT_S
    compile_kernels()
    with tempfile.TemporaryDirectory() as place:
        base = Path(place) / "base"
        render_photos(SceneRequest("planar", n_views=n_views, width_px=width_px), base, 1)
        for name, fault in FAULTS.items():
            folder = Path(place) / "with-fault"
            shutil.copytree(base, folder, ignore=shutil.ignore_patterns("depth", "diffuse", "glass", "reflection"))
            fault(folder, base)
            found: dict[str, float] = {}
            for method in ("2dgs", "reflight"):
                trained, scores = trained_within(folder, method, seconds, "fitted")
                found[method] = mean_of(score.facade.psnr_db for score in scores) or 0.0
                yield Row(name, METHODS[method], round(found[method], 2), "dB", None, _beside(trained, scores))
            yield _difference(name, found, context.is_quick)
            if fault in OVERRULED:
                effect, setting, title = OVERRULED[fault]
                trained, scores = trained_within(folder, "reflight", seconds, "fitted", {effect: setting})
                without = mean_of(score.facade.psnr_db for score in scores) or 0.0
                yield Row(name, title, round(without, 2), "dB", None, _beside(trained, scores))
            shutil.rmtree(folder)


BENCHMARK = Benchmark(
    "real-photos",
    "Models of real photos",
    f"Real photos, made smaller ({LONG_PX} pixels), a sixth of them held out. Usual settings, one thread, "
    f"{LONG_S:g} s of processor for each method; facades of the views held out, whose exposure is fitted; where "
    "there are no panels whole pictures. LPIPS is AlexNet's. Photos of the wall, and the picture made of one: "
    "B. Johns, E. Abdi, M. Arashpour, Glass Curtain Wall Installation Dataset, 2023, doi 10.26180/23538198, CC BY 4.0; "
    "poses were fitted to its grid. Sceaux castle (github.com/openMVG/ImageDataset_SceauxCastle) and the door in Lund "
    "(C. Olsson) go the way of a folder of JPEGs: `coarse`, `train`. So does a drone flight, 32 photos of a Phantom 4 "
    "Multispectral with RTK, straight down from 44 m onto a ruin in Turin (DJI_*.JPG of github.com/vinstray/i-sfm, MIT "
    f"licence). {DATA_VARIABLE} names folders with more data (`multiview/sceaux`, `multiview/mirafiori`). Pictures of "
    f"these three stay in {OTHERS}. Shown are photo, 2DGS, ours.",
    measure_sets,
)

FAULTS_BENCHMARK = Benchmark(
    "photo-faults",
    "Photos with one fault",
    f"{N_VIEWS} rendered photos of {WIDTH_PX} x {WIDTH_PX * 3 // 4} pixels of the bundled planar scene, and the same "
    "with one fault each, in the views held out, too, but for poses and passers-by. Usual settings, one thread, "
    f"{FAULT_S:g} s of processor for both; facades of the views held out, whose exposure is fitted.",
    measure_faults,
)

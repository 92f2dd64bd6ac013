"""Size of compressed models against what is lost of their pictures, and the time to write and read them."""

from __future__ import annotations

import statistics
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import torch
from numpy.typing import NDArray

from groundstation.services.scenes.photos import render_photos
from reconstruction.exports.component_parts import Ellipsoids, ellipsoids_of_all
from reconstruction.exports.compression import PRESETS, Compressed, Compression
from reconstruction.exports.mesh import ALMOST_NO_LOGIT, baked
from reconstruction.exports.ply_export import write_ply
from reconstruction.exports.sog import write_sog
from reconstruction.exports.spz import write_spz
from reconstruction.exports.web import WebOptions
from reconstruction.light.photo_set import PhotoSet, read_photo_set
from reconstruction.light.shading import display_from_linear
from reconstruction.objects.gs_scene import GsGaussian, GsScene
from reconstruction.objects.organise import organised, put_together
from reconstruction.objects.picking import Quads, panel_map
from reconstruction.scenes.parameters import SceneRequest
from reconstruction.splats.harmonic_colour import display_colours, light_of_display
from reconstruction.splats.ply import ODD, read_splats
from reconstruction.splats.rasterising.rasteriser import rasterise
from reconstruction.splats.rasterising.views import View
from reconstruction.training.config import ANTIALIASED, TrainConfig
from reconstruction.training.model.joint_model import SceneModel
from reconstruction.training.model.render import render_view
from reconstruction.training.model.saved import TrainedModel
from reconstruction.training.model.score import score_views
from reconstruction.training.train import train_model
from tests.benchmarks.harness import Benchmark, Context, Row
from tests.benchmarks.page_pictures import LEAST_PICKED, page_rows
from tests.reconstruction.exports.sog.reading import read_sog
from tests.reconstruction.exports.spz.reading import read_spz

N_VIEWS, WIDTH_PX = 60, 256
QUICK_N_VIEWS, QUICK_WIDTH_PX = 10, 48
N_SHOWN, QUICK_N_SHOWN = 12, 2

FURTHER_SCENES = ("curved", "court", "concrete")
"""Whose web pages are measured as well: glass that is bent along an arc, that sees glass, and set back in a wall."""

FURTHER_N_VIEWS, FURTHER_WIDTH_PX = 24, 192
"""Fewer and smaller: a page is compared with the program, and photos of the court take long."""

MANY, QUICK_MANY = 1_000_000, 20_000
"""Gaussians of the model that times are taken of: the trained ones over and over, each time changed a little."""

CHANGE = 0.1
"""Standard deviations of each number, by which it is changed: of the same ones, size would say nothing."""

FORMATS: dict[str, tuple[Callable[[GsScene, Path, Compression], Compressed], Callable[[Path], Ellipsoids]]] = {
    "spz": (write_spz, read_spz),
    "spz-4": (partial(write_spz, version=4), read_spz),
    "sog": (write_sog, read_sog),
}

COLOURS = {"spz": "#0072b2", "spz-4": "#009e73", "sog": "#d55e00"}

BITS = tuple(Compression(first_bits=bits, further_bits=bits) for bits in (2, 3, 4, 5, 6, 7, 8))
PALETTES = tuple(Compression(palette=65_536, gaussians_each=each) for each in (256, 64, 32, 16, 8, 4, 2))
DEGREES = tuple(Compression(degree=degree, first_bits=8, further_bits=8) for degree in (0, 1, 2))
"""Each knob turned for itself, for the curve."""


@dataclass(frozen=True, slots=True)
class Found:
    """One file: bytes for each Gaussian, and PSNR of its pictures against those of the model, dB."""

    each_bytes: float
    psnr_db: float
    size_bytes: int


def measure(context: Context) -> Iterator[Row]:
    """Presets and single knobs on a trained model with its mirrored light baked in; times on a large one; more pages.

    What is recorded already of the planar scene, or of the page of another one, is not measured again.
    """
    known = [row for row in context.recorded if row.scene not in FURTHER_SCENES]
    yield from known or _of_planar(context)
    for name in FURTHER_SCENES[:1] if context.is_quick else FURTHER_SCENES:
        known = [row for row in context.recorded if row.scene == name]
        yield from known or _page_of(name, context.is_quick)


def _page_of(name: str, is_quick: bool) -> Iterator[Row]:
    """A model of another scene and its web page, with the scene in the place of what a row was measured on."""
    with tempfile.TemporaryDirectory() as place:
        size = (QUICK_N_VIEWS, QUICK_WIDTH_PX) if is_quick else (FURTHER_N_VIEWS, FURTHER_WIDTH_PX)
        trained = _trained(name, Path(place) / name, *size, is_quick)
        scene, source = baked(organised(trained), trained.model), read_photo_set(Path(place) / name)
        for row in (*_baking(trained, scene, source, Path(place)), _picking(trained, source)):
            yield replace(row, scene=name, what=f"{row.what}, {row.scene}")


def _trained(name: str, folder: Path, n_views: int, width: int, is_quick: bool) -> TrainedModel:
    render_photos(SceneRequest(name, n_views=n_views, width_px=width), folder, 1)
    return train_model(folder, _config(is_quick))


def _of_planar(context: Context) -> Iterator[Row]:
    is_quick = context.is_quick
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "planar"
        size = (QUICK_N_VIEWS, QUICK_WIDTH_PX) if is_quick else (N_VIEWS, WIDTH_PX)
        trained = _trained("planar", folder, *size, is_quick)
        scene = baked(organised(trained), trained.model)
        photos = read_photo_set(folder).photos
        shown = photos[:: max(1, len(photos) // (QUICK_N_SHOWN if is_quick else N_SHOWN))]
        views = [View.of(photo, np.asarray(trained.record.origin_enu_m)) for photo in shown]
        truth = pictures(ellipsoids_of_all(scene.components), trained.model, views)
        named = f"{scene.n_gaussians} Gaussians"

        def tried(kind: str, compression: Compression) -> Found:
            write, read = FORMATS[kind]
            done = write(scene, Path(place) / f"model.{kind}", compression)
            again = pictures(read(done.path), trained.model, views)
            return Found(done.n_bytes / scene.n_gaussians, psnr_db(again, truth), done.n_bytes)

        yield from _baking(trained, scene, read_photo_set(folder), Path(place))
        yield _picking(trained, read_photo_set(folder))
        plain = write_ply(scene, Path(place) / "model.ply")
        yield Row(named, "PLY", round(plain.n_bytes / 1e6, 3), "MB")
        presets = {kind: {name: tried(kind, preset) for name, preset in PRESETS.items()} for kind in FORMATS}
        for kind, by_name in presets.items():
            for name, found in by_name.items():
                beside = f"{found.psnr_db:.1f} dB, {found.each_bytes:.1f} bytes each"
                size_mb = round(found.size_bytes / 1e6, 3)
                ratio = round(found.size_bytes / plain.n_bytes, 4)
                yield Row(named, f"{kind.upper()}, {name}: {beside}", size_mb, "MB", ratio, "PLY")
        curves = {
            "SPZ: bits of colours by direction": ("spz", [tried("spz", each) for each in BITS]),
            "SOG: entries of the palette": ("sog", [tried("sog", each) for each in PALETTES]),
            "SPZ: degree 0 to 2": ("spz", [tried("spz", each) for each in DEGREES]),
        }
        draw(curves, presets, context.folder / "model-size.png")
        yield from _times(scene, QUICK_MANY if is_quick else MANY, Path(place))


def _baking(trained: TrainedModel, scene: GsScene, source: PhotoSet, folder: Path) -> Iterator[Row]:
    """What is lost where mirror images are blurred into colours, or left out: facades of photos not learned from."""
    psnrs_db = []
    dull = put_together(organised(trained), Path())
    with torch.no_grad():
        dull.model.splats.reflectivity_logits.fill_(ALMOST_NO_LOGIT)
    unseen = trained.record.held_out
    for name, model in (
        ("that mirrors", trained),
        ("with mirrored light baked into colours", put_together(scene, Path())),
        ("of own colours only", dull),
    ):
        scores = score_views(model, source, unseen)
        known = [score.facade.psnr_db for score in scores if score.facade.psnr_db is not None]
        psnrs_db.append(statistics.fmean(known))
        yield Row(f"{len(known)} unseen photos", f"facades, model {name}", round(psnrs_db[-1], 2), "dB")
    yield from page_rows(
        trained, baked(organised(trained), trained.model, WebOptions().degree), source, psnrs_db[0], folder
    )


def _picking(trained: TrainedModel, source: PhotoSet) -> Row:
    """Glass of unseen photos whose true panel is picked, with what the model itself shows before the panels."""
    quads = Quads.of(source.panels.corners_enu_m)
    n_right = n_glass = 0
    for photo in source.named(trained.record.held_out):
        truth, glass = (
            cv2.imread(str(source.folder / layer / f"{photo.name}.png"), cv2.IMREAD_UNCHANGED)
            for layer in ("panels", "glass")
        )
        straight = replace(photo, intrinsics=photo.intrinsics.straight())
        view = View.of(straight, np.asarray(trained.record.origin_enu_m))
        depth = render_view(trained.model, view, ("depth",), settings=trained.record.config.raster).layers["depth"]
        found, is_glass = panel_map(quads, straight, depth), glass > 0
        n_right += int((found[is_glass] == truth[is_glass].astype(int) - 1).sum())
        n_glass += int(is_glass.sum())
    share = round(100.0 * n_right / max(n_glass, 1), 3)
    target = (f"at least {LEAST_PICKED:g} %", share >= LEAST_PICKED)
    name = f"{len(trained.record.held_out)} unseen photos"
    return Row(name, f"glass picked right, of {n_glass} pixels", share, "%", None, "", *target)


def _config(is_quick: bool) -> TrainConfig:
    config = TrainConfig(method="reflight", light="radiance-grid", iterations=700, n_splats=8000, max_splats=16_000)
    if not is_quick:
        return replace(config, reflections=replace(config.reflections, steps=500))
    return replace(config, iterations=10, n_splats=500, reflections=replace(config.reflections, steps=10, batch=256))


@torch.no_grad()
def pictures(ellipsoids: Ellipsoids, model: SceneModel, views: Sequence[View]) -> NDArray[np.float32]:
    """What discs show, before the model's sky, shape (views, h, w, 3), display values."""
    means, sh = torch.from_numpy(ellipsoids.means_m), torch.from_numpy(ellipsoids.sh * ODD[:, None])
    quats, opacities = torch.from_numpy(ellipsoids.quats), torch.from_numpy(ellipsoids.opacities)
    scales = torch.from_numpy(ellipsoids.scales_m[:, :2].copy())
    found = []
    for view in views:
        colours = light_of_display(display_colours(means, sh, view.position_m, 3))
        raster = rasterise(means, quats, scales, opacities, colours, view, settings=ANTIALIASED)
        light = raster.features + model.sky.behind(view.directions(), raster.alphas)
        found.append(display_from_linear(light).clamp(0.0, 1.0).numpy())
    return np.stack(found)


def psnr_db(one: NDArray[np.float32], other: NDArray[np.float32]) -> float:
    """Of all pictures together; 120 where they are as good as the same."""
    error = float(((one.astype(np.float64) - other) ** 2).mean())
    return -10.0 * float(np.log10(max(error, 1e-12)))


def _times(scene: GsScene, n: int, folder: Path) -> Iterator[Row]:
    large = repeated(scene, n)
    named = f"{large.n_gaussians} Gaussians"
    path = folder / "large.ply"
    seconds, written = _timed(lambda: write_ply(large, path))
    yield Row(named, "PLY: writing", seconds, "s", None, f"{written.n_bytes / 1e6:.1f} MB")
    yield Row(named, "PLY: reading", _timed(lambda: read_splats(path))[0], "s")
    for kind, (write, read) in FORMATS.items():
        for name, preset in PRESETS.items():
            path = folder / f"large.{kind}"
            seconds, written = _timed(lambda write=write, path=path, preset=preset: write(large, path, preset))
            beside = f"{written.n_bytes / 1e6:.1f} MB"
            yield Row(named, f"{kind.upper()}, {name}: writing", seconds, "s", None, beside)
            seconds = _timed(lambda read=read, path=path: read(path))[0]
            yield Row(named, f"{kind.upper()}, {name}: reading", seconds, "s")


def _timed(work: Callable[[], Any]) -> tuple[float, Any]:
    """Processor seconds, and what came of it."""
    started = time.process_time()
    found = work()
    return round(time.process_time() - started, 2), found


def repeated(scene: GsScene, n: int) -> GsScene:
    """A scene of at least `n` Gaussians without panels: all of the scene's, again and again, changed at random."""
    rng = np.random.default_rng(0)
    copies = -(-n // scene.n_gaussians)
    tables = [component.gaussians for component in scene.components]
    values = {name: np.concatenate([table.values[name] for table in tables]) for name in tables[0].values}
    values = {
        name: np.concatenate([value] * copies) + _noise(rng, value, copies * len(value))
        for name, value in values.items()
    }
    table = GsGaussian(values, np.arange(len(values["means"]), dtype=np.int32))
    background = replace(scene.components[-1], kind="background", elements=(), gaussians=table)
    return replace(scene, components=(background,), n_gaussians=len(table))


def _noise(rng: np.random.Generator, values: NDArray[np.float32], n: int) -> NDArray[np.float32]:
    deviations = CHANGE * values.std(axis=0)
    return rng.standard_normal((n, *values.shape[1:]), np.float32) * deviations.astype(np.float32)


def draw(curves: dict[str, tuple[str, Sequence[Found]]], presets: dict[str, dict[str, Found]], path: Path) -> None:
    """Quality against size."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 4.6), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    for number, (name, (kind, found)) in enumerate(curves.items()):
        style = ("-", "-", ":")[number]
        sizes, qualities = [each.each_bytes for each in found], [each.psnr_db for each in found]
        axes.plot(sizes, qualities, style, marker=".", color=COLOURS[kind], label=name)
    with_curve = {kind for kind, _ in curves.values()}
    for kind, by_name in presets.items():
        sizes, qualities = zip(*((each.each_bytes, each.psnr_db) for each in by_name.values()), strict=True)
        has_curve = kind in with_curve
        style, title = ("full", None) if has_curve else ("none", f"{kind.upper()}, the same presets")
        axes.plot(sizes, qualities, "o", color=COLOURS[kind], fillstyle=style, label=title)
        for name, each in by_name.items() if has_curve else ():
            axes.annotate(f" {name}", (each.each_bytes, each.psnr_db), va="top", fontsize=8)
    axes.set_xlabel("bytes for each Gaussian (PLY: 252)")
    axes.set_ylabel("PSNR against the model not compressed, dB")
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8)
    figure.savefig(path, dpi=110)


BENCHMARK = Benchmark(
    "model-size",
    "Compressed models: size against quality",
    f"A model of {N_VIEWS} rendered photos of the bundled planar scene, its mirrored light baked into colours by "
    "direction (what that costs comes first, also in the web page in headless Chromium, for models of "
    f"{FURTHER_N_VIEWS} photos of the {', '.join(FURTHER_SCENES[:-1])} and {FURTHER_SCENES[-1]} scenes, too), "
    "written as SPZ and SOG, read back and rendered: PSNR of whole pictures "
    "against those of the baked model as it was. Times are processor times of one thread, of a model of the same "
    "Gaussians many times over, each copy with random changes of all numbers.",
    measure,
)

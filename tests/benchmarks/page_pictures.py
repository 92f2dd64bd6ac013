"""A model's web page in headless Chromium, photo by photo: with panes as mirrors, and with mirrored light baked in.

Its pictures are compared with photos not learned from and with the program's own, and panes are picked in it.
"""

from __future__ import annotations

import statistics
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import torch
from numpy.typing import NDArray

from reconstruction.exports.web import WebOptions, sky_light, write_web
from reconstruction.light.photo_set import PhotoSet
from reconstruction.light.shading import display_from_linear, linear_from_display
from reconstruction.metrics.image_metrics import score_picture
from reconstruction.objects.gs_scene import GsScene
from reconstruction.splats.rasterising.views import View
from reconstruction.training.model.joint_model import SceneModel
from reconstruction.training.model.pane_mirrors import mirrors_of
from reconstruction.training.model.render import render_view
from reconstruction.training.model.saved import TrainedModel
from reconstruction.training.photos.photo_stream import PhotoStream, Sample, StreamSettings
from tests.benchmarks.harness import Row
from tests.reconstruction.exports.web_browser import CHROMIUM, DRIVER, Browser, chromium

Picture = NDArray[np.float32]

WINDOW = (1100, 500)
"""Of the browser; the page's list takes 370 pixels of it."""

WITHOUT_WEBGPU = "delete Navigator.prototype.gpu"

MOST_LOST_DB = 1.0


N_PICKED = 40
"""Places in each photo at which a pane is picked, all on glass."""

LEAST_PICKED = 99.9


def page_rows(trained: TrainedModel, scene: GsScene, source: PhotoSet, model_db: float, folder: Path) -> Iterator[Row]:
    """PSNR of facades of photos not learned from, and of whole pictures against the program's own; panes picked right.

    Parameters
    ----------
    scene
        With mirrored light baked in.
    model_db
        Of the same facades in the program's own pictures.
    """
    if CHROMIUM is None or DRIVER is None:
        yield Row("unseen photos", "web page in a browser", "not run: chromium or chromedriver is missing")
        return
    options = WebOptions(mirrors=mirrors_of(trained.model), sky=sky_light(trained.model.sky))
    page = write_web(scene, folder / "page", (), options)
    plain = write_web(scene, folder / "plain", (), replace(options, mirrors=None))
    size_mb = round(page.n_bytes / 1e6, 2)
    ratio = page.n_bytes / plain.n_bytes
    yield Row(f"{page.n_gaussians} Gaussians", "web page whose panes mirror", size_mb, "MB", ratio, "baked alone")
    unseen = trained.record.held_out
    with (
        chromium(folder / "chromium") as browser,
        PhotoStream(source, unseen, trained.model.origin_enu_m, StreamSettings()) as photos,
    ):
        samples = [photos.frame(number) for number in range(len(photos.photos))]
        for name in ("WebGPU, panes mirror", "WebGL 2, mirrored light baked in"):
            if "WebGL" in name:
                browser.cdp("Page.addScriptToEvaluateOnNewDocument", source=WITHOUT_WEBGPU)
            browser.window(*WINDOW)
            browser.open(page.path)
            browser.settled()
            found = [
                (
                    *_scores(trained, source, sample, photos.photos[number].name, browser),
                    _picked_right(scene, source, sample.view, photos.photos[number].name, browser),
                )
                for number, sample in enumerate(samples)
            ]
            facade, own, picked = (statistics.fmean(each) for each in zip(*found, strict=True))
            is_met = facade >= model_db - MOST_LOST_DB
            target = (f"at most {MOST_LOST_DB:g} dB below the model", is_met) if "WebGPU" in name else ()
            on = f"{len(found)} unseen photos"
            yield Row(on, f"facades, page by {name}", round(facade, 2), "dB", None, "", *target)
            yield Row(on, f"page by {name}, against the program's pictures", round(own, 2), "dB")
            target = (f"at least {LEAST_PICKED:g} %", 100.0 * picked >= LEAST_PICKED)
            what = f"glass picked right, page by {name}, of {N_PICKED * len(found)} places"
            yield Row(on, what, round(100.0 * picked, 2), "%", None, "", *target)


def _scores(
    trained: TrainedModel, source: PhotoSet, sample: Sample, name: str, browser: Browser
) -> tuple[float, float]:
    """PSNR of the facade against the photo, and of the picture against the program's own, dB."""
    model, view = trained.model, sample.view
    shown, square = _shown(view, browser)
    own = _without_lens(model, square, trained)
    # A photo's corners are darker, and its exposure may be another; its pixels are not quite square.
    gain = source.exposure / trained.record.exposure * source.own_exposures.get(name, 1.0)
    light = linear_from_display(torch.from_numpy(_resampled(shown, square, view)))
    found = display_from_linear(model._vignetting(view)[..., None].detach() * gain * light).clamp(0.0, 1.0).numpy()
    facade, _ = sample.scored_pixels()
    scored = score_picture(found, sample.display.numpy(), facade, with_ssim=False).psnr_db
    assert scored is not None
    return scored, -10.0 * float(np.log10(max(float(np.mean((shown - own) ** 2)), 1e-12)))


def _picked_right(scene: GsScene, source: PhotoSet, view: View, name: str, browser: Browser) -> float:
    """Share of places on glass of a photo, which the page shows, whose pane a click there picks."""
    truth, glass = (
        cv2.imread(str(source.folder / layer / f"{name}.png"), cv2.IMREAD_UNCHANGED) for layer in ("panels", "glass")
    )
    rows, columns = np.nonzero(glass)
    chosen = np.random.default_rng(0).choice(len(rows), N_PICKED, replace=len(rows) < N_PICKED)
    rows, columns = rows[chosen], columns[chosen]
    camera = browser.run("return reflight.camera()")
    x = 0.5 * camera["width"] + camera["focal"] * (columns + 0.5 - view.cx_px) / view.fx_px
    y = 0.5 * camera["height"] + camera["focal"] * (rows + 0.5 - view.cy_px) / view.fy_px
    script = """const found = [];
    for (const [x, y] of arguments[0]) found.push(await reflight.seenAt(x, y));
    return found;"""
    numbers = {element.global_id: element.panel for _, element in scene.elements}
    found = [numbers.get(each, -1) for each in browser.run(script, np.column_stack([x, y]).tolist())]
    return float(np.mean(np.array(found) == truth[rows, columns].astype(int) - 1))


def _shown(view: View, browser: Browser) -> tuple[Picture, View]:
    """The page's picture from a camera, and what camera exactly: with square pixels, and the whole page wide."""
    axes, place = view.cam_from_world[:3, :3].numpy(), view.position_m.double().numpy()
    east, north, up = axes[2]
    heading, pitch = np.degrees(np.arctan2(east, north)), np.degrees(np.arcsin(up))
    browser.run("reflight.look(...arguments)", place.tolist(), heading, pitch, 10, view.fx_px)
    browser.settled()
    shown = browser.pixels().astype(np.float32) / np.float32(255.0)
    height, width = shown.shape[:2]
    square = View(width, height, view.fx_px, view.fx_px, width / 2, height / 2, view.cam_from_world)
    return shown, square


@torch.no_grad()
def _without_lens(model: SceneModel, view: View, trained: TrainedModel) -> Picture:
    """The program's own picture, with bright corners as the page has them."""
    loss = model.corner_loss.clone()
    model.corner_loss.zero_()
    try:
        return render_view(model, view, settings=trained.record.config.raster).display
    finally:
        model.corner_loss.copy_(loss)


def _resampled(shown: Picture, square: View, view: View) -> Picture:
    """The part of a page's picture that a photo shows, in the photo's pixels."""
    x, y = square.fx_px / view.fx_px, square.fy_px / view.fy_px
    # Continuous coordinates have the middle of the first pixel at 0.5, OpenCV's at 0.
    columns = np.array([[x, 0.0, square.cx_px - x * (view.cx_px - 0.5) - 0.5], [0.0, y, 0.0]])
    columns[1, 2] = square.cy_px - y * (view.cy_px - 0.5) - 0.5
    flags = cv2.INTER_CUBIC | cv2.WARP_INVERSE_MAP
    return cv2.warpAffine(shown, columns, (view.width_px, view.height_px), flags=flags).clip(0.0, 1.0)

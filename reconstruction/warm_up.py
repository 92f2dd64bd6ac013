"""Compile the kernels of reconstruction once and keep them on disk: `python -m reconstruction.warm_up`."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from planning.effects import Wish
from reconstruction.cameras import Intrinsics, Pose, PosedPhoto
from reconstruction.dataset.panel_images import draw_panels
from reconstruction.photos.sharpness import sharpness
from reconstruction.scenes.bundled import bundled_scene
from reconstruction.scenes.effect_names import NEAR_FIELD
from reconstruction.scenes.renderer import Renderer, RenderSettings
from reconstruction.scores.overlaps import pixel_overlaps
from reconstruction.scores.raster import index_image
from reconstruction.segmentation.segment import segment_rectified


def compile_kernels() -> None:
    """Run every kernel on small inputs."""
    lens = Intrinsics(32, 24, 20.0, 20.0, 16.0, 12.0)
    photo = PosedPhoto("", Path(), lens, Pose.looking(np.zeros(3), 0.0, 0.0))
    draw_panels(photo, np.array([[[-1.0, 5.0, -1.0], [1.0, 5.0, -1.0], [1.0, 5.0, 1.0], [-1.0, 5.0, 1.0]]]))
    y, x = np.mgrid[:400, :400]
    frame = (x % 80 < 6) | (y % 100 < 6) | (np.abs(x - y) < 4)
    grid = np.where(frame, 60, 180) + np.random.default_rng(0).integers(0, 9, x.shape)
    picture = grid.astype(np.uint8)
    sharpness(picture)
    segment_rectified(picture)
    index = index_image([np.array([[1.0, 1.0], [9.0, 1.0], [9.0, 9.0]])], 12, 12)
    pixel_overlaps(index, index)
    court = bundled_scene("court")
    eastwards = court.panes.corners_enu_m[0].mean(axis=0) + np.array([12.0, 0.0, 0.0])
    facing = PosedPhoto("", Path(), lens, Pose.looking(eastwards, -90.0, 0.0))
    wishes: tuple[Wish, ...] = ("on", "off")
    for near in wishes:
        settings = RenderSettings(samples=1, wishes={NEAR_FIELD: near}, environment_rows=16)
        Renderer(court, settings).render(facing)


if __name__ == "__main__":
    compile_kernels()

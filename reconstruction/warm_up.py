"""Compile the kernels of reconstruction once and keep them on disk: `python -m reconstruction.warm_up`."""

from __future__ import annotations

import gc
from pathlib import Path

import cv2
import numpy as np
import torch

from planning.base.effects import EffectSetting
from reconstruction.base.cameras import Intrinsics, Pose, PosedPhoto
from reconstruction.coarse.plane_sweep import Patches, ShownPhotos
from reconstruction.dataset.layers import draw_panels
from reconstruction.light.config import GlassLearned
from reconstruction.light.cube_map import CubeMap
from reconstruction.light.environment_map import EnvironmentMap
from reconstruction.light.glass_light import GlassLight
from reconstruction.light.glass_rays import rays_of_pixels
from reconstruction.light.harmonics import HarmonicTexture
from reconstruction.light.photo_set import PanelPlanes
from reconstruction.light.radiance_grid import GridBox, RadianceGrid
from reconstruction.light.ray_table import RayTable
from reconstruction.light.reflective_panels import ReflectivePanels
from reconstruction.metrics.overlaps import index_image, pixel_overlaps
from reconstruction.panels.segment import segment_rectified
from reconstruction.photos.decode import check_whole
from reconstruction.photos.quality import sharpness
from reconstruction.scenes.parameters import NEAR_FIELD, RenderSettings
from reconstruction.scenes.photos.renderer import Renderer
from reconstruction.scenes.world.bundled import bundled_scene
from reconstruction.splats.merged_splats import FEWEST, detail_tree
from reconstruction.splats.rasterising.rasteriser import rasterise
from reconstruction.splats.rasterising.views import View
from reconstruction.splats.sky import Sky
from reconstruction.splats.splats import Splats
from reconstruction.training.losses import dissimilarity
from reconstruction.training.methods.ref_gs import SphMip


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
    check_whole(cv2.imencode(".jpg", picture)[1].tobytes(), "")
    segment_rectified(picture)
    index = index_image([np.array([[1.0, 1.0], [9.0, 1.0], [9.0, 9.0]])], 12, 12)
    pixel_overlaps(index, index)
    dissimilarity(np.zeros((12, 36)), np.zeros((12, 36)), 3, True)
    _draw_splats()
    _choose_details()
    _march_grid()
    _shade_panes()
    _shade_by_cubes()
    _sweep_planes()
    court = bundled_scene("court")
    eastwards = court.panes.corners_enu_m[0].mean(axis=0) + np.array([12.0, 0.0, 0.0])
    facing = PosedPhoto("", Path(), lens, Pose.looking(eastwards, -90.0, 0.0))
    both: tuple[EffectSetting, ...] = ("on", "off")
    for near in both:
        settings = RenderSettings(samples=1, effects={NEAR_FIELD: near}, environment_rows=16)
        Renderer(court, settings).render(facing)


def _draw_splats() -> None:
    """Colours, raster and sky of a few splats and an environment map, forward and backward."""
    view = View(16, 16, 16.0, 16.0, 8.0, 8.0, torch.eye(4, dtype=torch.float64))
    means = torch.tensor([[0.0, 0.0, 2.0], [0.1, 0.0, 3.0]])
    quats, panels = torch.tensor([[1.0, 0.0, 0.0, 0.0]]).expand(2, 4), torch.zeros(2, dtype=torch.int32)
    splats = Splats.of(means, quats, torch.full((2, 2), 0.3), torch.full((2,), 0.8), torch.full((2, 3), 0.5), panels)
    raster = rasterise(
        splats.means, splats.quats, splats.scales, splats.opacities, splats.features(view.position_m, 3), view,
        labels=panels,
    )  # fmt: skip
    solid = rasterise(splats.means, splats.quats, torch.full((2, 3), 0.3), splats.opacities, means, view)
    light = Sky(rows=4).behind(view.directions(), raster.alphas)
    (raster.features.sum() + raster.depths.sum() + solid.depths.sum() + light.sum()).backward()  # type: ignore[no-untyped-call]
    directions = view.directions().reshape(-1, 3)
    EnvironmentMap(4, 0.5)(directions, directions).sum().backward()


def _choose_details() -> None:
    """Cubes of splats on a line, and what of them a view calls for."""
    places = np.linspace(0.0, 1.0, 3 * FEWEST).repeat(3).reshape(-1, 3)
    tree = detail_tree(places, np.full(len(places), 1e-3), np.zeros(len(places), np.int32))
    tree.rows_for(View(16, 16, 16.0, 16.0, 8.0, 8.0, torch.eye(4, dtype=torch.float64)), 1.0)


def _march_grid() -> None:
    """A few rays through a radiance grid, forward and backward, with and without gradients of the rays."""
    grid = RadianceGrid(GridBox(0.0, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), (4, 4, 4), 0.5, 1.0), 0.5, 0, 4)
    points, directions = torch.zeros(4, 3), torch.tensor([[0.0, 0.0, 1.0]]).repeat(4, 1)
    for is_moved in (False, True):
        light = grid(points.clone().requires_grad_(is_moved), directions)
        (light.sum() + grid.roughness(1.0, 1.0, 1.0)).backward()


def _shade_panes() -> None:
    """A few rays of one pane, forward and backward: met, mirrored, with what is behind the glass, and their colours."""
    corners = np.array([[[-1.0, 5.0, -1.0], [1.0, 5.0, -1.0], [1.0, 5.0, 1.0], [-1.0, 5.0, 1.0]]])
    planes = PanelPlanes(corners)
    photo = PosedPhoto("", Path(), Intrinsics(32, 24, 20.0, 20.0, 16.0, 12.0), Pose.looking(np.zeros(3), 0.0, 0.0))
    pixels, panes = torch.arange(14, 18), torch.zeros(4, dtype=torch.long)
    table = RayTable.of([photo], planes, {})
    rays = rays_of_pixels(table, 0, pixels, panes + 12, panes)
    table.holds(rays.photos, rays.middles_px, rays.panels, np.zeros((1, 2)))
    texture = HarmonicTexture(torch.from_numpy(planes.rescaled(corners)), 2, torch.full((1, 3), 0.5), 1)
    grid = RadianceGrid(GridBox(0.0, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), (4, 4, 4), 0.5, 1.0), 0.5, 0, 4)
    ReflectivePanels(texture, GlassLight(grid, planes, GlassLearned(tilts=True)))(rays).sum().backward()


def _shade_by_cubes() -> None:
    """Lookups in an environment cube and in a grid of features, forward and backward."""
    directions = torch.tensor([[0.0, 0.6, 0.8], [1.0, 0.0, 0.0]], requires_grad=True)
    roughness = torch.tensor([0.2, 0.7], requires_grad=True)
    light = CubeMap(8)(directions, roughness).sum() + SphMip(8, 2, 16)(directions, roughness).sum()
    light.backward()


def _sweep_planes() -> None:
    """A patch in two photos at two distances."""
    photos = [
        PosedPhoto("", Path(), Intrinsics(32, 24, 20.0, 20.0, 16.0, 12.0), Pose.looking(place, 0.0, 0.0))
        for place in np.eye(3)[:2]
    ]
    shown = ShownPhotos.of(photos, [0, 1], lambda _: np.zeros((24, 32), np.uint8), 0.1, 0.1)
    patches = Patches(
        np.array([0.0, -1.0, 0.0]), np.array([1.0, 0.0, 0.0]), np.array([[0.5, 9.0, 0.0]]), np.array([[0, 1]])
    )
    shown.likeness(patches, 0.1, np.array([0.0, 0.1]))


if __name__ == "__main__":
    gc.disable()  # a compiler leaves little garbage, and looking for it takes a twentieth of the time
    compile_kernels()

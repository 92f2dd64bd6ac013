"""Which blocks a splat is worked in: all of those that it touches, and few of the others."""

import numpy as np
import torch

from planning.base.jit import kernel
from reconstruction.splats.rasterising.numba_blend import (
    BLOCK_COLUMNS,
    BLOCK_ROWS,
    bytes_a_splat,
    exp_half,
    find_blocks,
    gather,
    list_block,
    reached_of,
)
from reconstruction.splats.rasterising.numba_lanes import load_lanes, spread, store_lanes
from reconstruction.splats.rasterising.numba_projection import N_GEOMETRY, project_splats
from reconstruction.splats.rasterising.raster_types import RasterSettings
from tests.reconstruction.splats.drawn_splats import draw, random_splats, turned_view

SIZE = 64
SETTINGS = RasterSettings(tile_px=SIZE)


def blocks_reached(splats, view):
    """Of each splat and each block of a square as large as the picture, shape (n, rows, columns)."""
    n = len(splats.means)
    means, quats, scales, opacities, _ = (t.float().numpy() for t in splats.tensors)
    geometry, depths = np.zeros((n, N_GEOMETRY), np.float32), np.zeros(n)
    boxes, radii = np.zeros((n, 4), np.int32), np.zeros(n, np.float32)
    least_change = SETTINGS.least_depth_change(min(view.fx_px, view.fy_px))
    limits = np.array(
        [SETTINGS.near_m, SETTINGS.min_alpha, SETTINGS.low_pass_px, SETTINGS.reach, least_change, 0.0, 0.0]
    )
    lens = np.array([view.fx_px, view.fy_px, view.cx_px, view.cy_px])
    project_splats(
        means, quats, scales, opacities, np.zeros((0, 2), np.float32), view.cam_from_world.numpy().copy(), lens,
        (view.width_px, view.height_px), limits, 0, n, geometry, depths, boxes, radii,
    )  # fmt: skip
    drawn = np.flatnonzero(boxes[:, 1] > boxes[:, 0]).astype(np.int32)
    g, f = np.empty((len(drawn), N_GEOMETRY), np.float32), np.empty((len(drawn), 8), np.float32)
    gather(geometry, np.zeros((n, 8), np.float32), drawn, 0, len(drawn), 0, 0, g, f)
    reached = reached_of(np.empty((len(drawn), bytes_a_splat(SIZE)), np.uint8), 0, len(drawn), SIZE)
    find_blocks(g, reached)
    found = np.zeros((n, SIZE // BLOCK_ROWS, SIZE // BLOCK_COLUMNS), bool)
    listed = np.empty(len(drawn) + 1, np.int32)
    for row in range(found.shape[1]):
        for column in range(found.shape[2]):
            n_listed = list_block(reached, row, column, listed)
            assert (np.diff(listed[:n_listed]) > 0).all()
            found[drawn[listed[:n_listed]], row, column] = True
    return found


def blocks_touched(splats, view):
    """The same of what the definition draws, and how many pixels it touches."""
    n, found, n_pixels = len(splats.means), [], 0
    for i in range(n):
        picture = np.zeros((SIZE, SIZE), bool)
        alphas = draw(splats.picked(torch.tensor([i])), view, "torch", seed=None).raster.alphas
        picture[: view.height_px, : view.width_px] = alphas.numpy() > 0.0
        n_pixels += picture.sum()
        blocks = picture.reshape(SIZE // BLOCK_ROWS, BLOCK_ROWS, SIZE // BLOCK_COLUMNS, BLOCK_COLUMNS)
        found.append(blocks.any(axis=(1, 3)))
    return np.array(found), n_pixels


def test_splats_of_all_shapes_are_worked_where_they_are_seen_and_hardly_elsewhere():
    view = turned_view(61, 47, 55.0)
    splats = random_splats(60, view, 2)
    for stretch, least_share in (((2.0, 2.0), 0.55), ((6.0, 0.3), 0.4)):
        shaped = splats.changed(scales=splats.scales * torch.tensor(stretch, dtype=torch.float64))
        reached, (touched, n_pixels) = blocks_reached(shaped, view), blocks_touched(shaped, view)
        assert touched.sum() > 400
        assert not (touched & ~reached).any()
        assert reached.sum() < 1.02 * touched.sum()
        assert n_pixels > least_share * reached.sum() * BLOCK_ROWS * BLOCK_COLUMNS


def test_splats_that_are_no_ellipses_are_worked_wherever_they_are_seen():
    view = turned_view(61, 47, 55.0)
    splats = random_splats(40, view, 3)
    for factor in (40.0, 1e4, 1e-4):
        shaped = splats.changed(scales=splats.scales * factor)
        touched, _ = blocks_touched(shaped, view)
        assert touched.any()
        assert not (touched & ~blocks_reached(shaped, view)).any()


def test_the_exponential_is_exact_to_the_last_digits():
    @kernel
    def all_of(q, out):
        for at in range(0, len(q), 8):
            store_lanes(out, at, exp_half(spread(np.float32(0.5)), load_lanes(q, at)))

    q = np.concatenate([np.linspace(0.0, 40.0, 8000), [1e30, np.inf, 41.0, 0.0, 1e-30, 40.0, 20.0, 19.4]])
    q, out = q.astype(np.float32), np.empty(8008, np.float32)
    all_of(q, out)
    truth = 0.5 * np.exp(-0.5 * np.minimum(q.astype(np.float64), 40.0))
    # Of which 1.2e-6 is what rounding the exponent 40 / (2 ln 2) to float32 makes of it.
    assert np.abs(out / truth - 1.0).max() < 1.5e-6
    assert np.abs(out / truth - 1.0)[q < 11.0].max() < 5e-7

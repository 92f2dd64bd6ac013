"""Panes from votes, and grids from panes: on truth, with noise, and on photos."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from reconstruction.metrics.overlaps import index_image, pixel_overlaps
from reconstruction.panels.network.grids import network_facades
from reconstruction.panels.network.made_pictures import made_picture
from reconstruction.panels.network.network import STRIDE
from reconstruction.panels.network.votes import FoundPanes, Pane, gathered, surest

Array = NDArray[np.float64]

GLASS_EVERYWHERE = ((0.01, np.ones((2, 3), np.float32)),)


def true_votes(seed: int, noise: float) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.uint16]]:
    """What a network would say that knows a made picture, with corners off by a share of the pane's size."""
    made = made_picture(seed, 256)
    index = made.index[STRIDE // 2 :: STRIDE, STRIDE // 2 :: STRIDE]
    corners = np.concatenate([np.zeros((1, 4, 2), np.float32), made.corners_px])[index]
    size = np.ptp(corners, axis=2).max(axis=2, keepdims=True)[..., None] if len(made.corners_px) else 0.0
    corners = corners + noise * size * np.random.default_rng(seed).standard_normal(corners.shape)
    return (index > 0).astype(np.float32), corners.astype(np.float32), made.index


@pytest.mark.parametrize("noise", [0.0, 0.03])
def test_panes_that_votes_name_are_found(noise: float) -> None:
    n_true = n_found = n_false = 0
    for seed in range(12):
        probability, corners, index = true_votes(seed, noise)
        panes = gathered(probability, corners, (256, 256))
        found = index_image([pane.corners_px for pane in panes], 256, 256)
        overlaps = pixel_overlaps(index, found)
        union = overlaps.true_areas[:, None] + overlaps.found_areas[None] - overlaps.joint
        ious = overlaps.joint / np.maximum(union, 1.0)
        is_usual = (overlaps.true_areas > 10.0**2) & (overlaps.true_areas < 50.0**2)
        n_true += int(is_usual.sum())
        n_found += int((ious.max(axis=1, initial=0.0)[is_usual] > 0.6).sum())
        n_false += int((ious.max(axis=0, initial=0.0) < 0.3).sum())
    assert n_true > 100
    assert n_found >= 0.95 * n_true
    assert n_false <= 0.03 * n_true


def facade_panes(
    rng: np.random.Generator, n_rows: int, n_columns: int, gap: float, noise_px: float
) -> tuple[list[Pane], list[tuple[int, int]], Array]:
    """Panes of a facade seen from the side, one cell in ten without; places (row from below, column), true corners."""
    yaw, pitch = rng.uniform(-0.9, 0.9), rng.uniform(-0.3, 0.3)
    cy, sy, cp, sp = np.cos(yaw), np.sin(yaw), np.cos(pitch), np.sin(pitch)
    turn = np.array([[1, 0, 0], [0, cp, -sp], [0, sp, cp]]) @ np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    panes, places, corners = [], [], []
    for row in range(n_rows):
        for column in range(n_columns):
            if rng.random() < 0.1:
                continue
            left, right = column - 0.5 * n_columns + 0.5 * gap, column + 1 - 0.5 * n_columns - 0.5 * gap
            low, high = 0.5 * n_rows - row - 0.5 * gap, 0.5 * n_rows - row - 1 + 0.5 * gap
            flat = 1.3 * np.array([[left, low, 0], [right, low, 0], [right, high, 0], [left, high, 0]])
            seen = flat @ turn.T + [0.0, 0.0, 1.6 * max(n_rows, n_columns)]
            quad = 900.0 * seen[:, :2] / seen[:, 2:] + [500.0, 400.0]
            places.append((row, column))
            corners.append(quad)
            panes.append(Pane(quad + noise_px * rng.standard_normal((4, 2)), 0.9, 0.02, 30.0, max(noise_px, 0.3)))
    return panes, places, np.array(corners)


@given(seed=st.integers(0, 10_000), n_rows=st.integers(3, 9), n_columns=st.integers(3, 9), gap=st.floats(0.05, 0.5))
def test_panes_of_a_facade_seen_from_the_side_stand_in_its_rows_and_columns(
    seed: int, n_rows: int, n_columns: int, gap: float
) -> None:
    rng = np.random.default_rng(seed)
    panes, places, corners = facade_panes(rng, n_rows, n_columns, gap, 0.0)
    facades = network_facades(FoundPanes(tuple(panes)), 1000, 800)
    assert len(facades) == 1
    lowest, leftmost = min(row for row, _ in places), min(column for _, column in places)
    found = {(panel.row + lowest, panel.column + leftmost): panel.corners_px for panel in facades[0].panels}
    assert set(found) == set(places)
    for place, quad in zip(places, corners, strict=True):
        assert np.abs(found[place] - quad).max() < 0.5


def test_an_edge_is_measured_by_all_panes_along_it() -> None:
    own, shared = [], []
    for seed in range(8):
        panes, places, corners = facade_panes(np.random.default_rng(seed), 6, 8, 0.15, 1.5)
        (grid,) = network_facades(FoundPanes(tuple(panes)), 1000, 800)
        lowest, leftmost = min(row for row, _ in places), min(column for _, column in places)
        found = {(panel.row + lowest, panel.column + leftmost): panel.corners_px for panel in grid.panels}
        off = [np.abs(found[place] - quad) for place, quad in zip(places, corners, strict=True) if place in found]
        assert len(off) >= len(places) - 1
        shared.append(np.mean(off))
        own.append(np.mean(np.abs(np.stack([pane.corners_px for pane in panes]) - corners)))
    assert np.mean(shared) < 0.7 * np.mean(own)


def test_a_cell_where_the_network_says_glass_is_a_pane() -> None:
    panes, places, _ = facade_panes(np.random.default_rng(3), 5, 6, 0.2, 0.2)
    assert len(places) < 30
    (without,) = network_facades(FoundPanes(tuple(panes)), 1000, 800)
    (filled,) = network_facades(FoundPanes(tuple(panes), GLASS_EVERYWHERE), 1000, 800)
    assert len(without.panels) == len(places)
    assert len(without.missing) == 30 - len(places)
    assert len(filled.panels) == 30
    assert not filled.missing


def test_two_facades_of_a_corner_are_two_grids() -> None:
    left, places, _ = facade_panes(np.random.default_rng(11), 4, 5, 0.2, 0.2)
    right, more, _ = facade_panes(np.random.default_rng(12), 5, 4, 0.2, 0.2)
    aside = np.array([1100.0, 0.0])
    moved = [Pane(pane.corners_px + aside, pane.share, pane.scatter, 30.0, 0.3) for pane in right]
    facades = network_facades(FoundPanes((*left, *moved)), 2100, 800)
    assert sorted(len(facade.panels) for facade in facades) == sorted([len(places), len(more)])
    assert [facade.id for facade in facades] == ["A", "B"]


def test_of_panes_that_cover_one_another_the_surest_stays() -> None:
    quad = np.array([[0.0, 40.0], [30.0, 40.0], [30.0, 0.0], [0.0, 0.0]])
    panes = [Pane(quad + shift, share, 0.02, 30.0, 0.5) for shift, share in ((0.0, 0.6), (3.0, 0.9), (31.0, 0.5))]
    assert surest(panes) == [panes[1], panes[2]]


def test_nothing_is_found_where_nothing_is() -> None:
    assert network_facades(FoundPanes(()), 100, 100) == ()
    assert gathered(np.zeros((8, 8), np.float32), np.zeros((8, 8, 4, 2), np.float32), (32, 32)) == []

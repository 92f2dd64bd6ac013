"""Panes from votes, and grids from panes: on truth, with noise, and on photos."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from safetensors.torch import load_file

from planning.base.progress import QUIET
from reconstruction.metrics.metrics import PhotoScores
from reconstruction.metrics.overlaps import index_image, pixel_overlaps
from reconstruction.metrics.run import own_method, score_answer
from reconstruction.metrics.sets import ScoredPhoto, annotated_set, folder_set, scored, synthetic_set, whole_view
from reconstruction.panels.network import pool, training
from reconstruction.panels.network.calibration import Source, are_there, calibrated, calibrated_last, write_regressions
from reconstruction.panels.network.confidence import (
    LEAST_BELIEVED,
    Candidates,
    Joined,
    candidates_of,
    find_panes,
    first_features,
    glass_beyond,
    second_features,
    seen_larger,
)
from reconstruction.panels.network.crops import CROP_PX, CropSampler
from reconstruction.panels.network.grids import network_facades
from reconstruction.panels.network.network import LARGE, OFFSET_PX, SMALL, PaneNetwork, Shape, network
from reconstruction.panels.network.pool import SYNTHETIC_PX, Pool, read_gathered, write_gathered
from reconstruction.panels.network.predictions import FoundPanes, PhotoPrediction, SizePrediction, predict_photo
from reconstruction.panels.network.random_pictures import SyntheticPicture, synthetic_picture
from reconstruction.panels.network.sides import measured
from reconstruction.panels.network.training import NetworkToTrain, train
from reconstruction.panels.network.votes import STRIDE, Pane, gathered, signed_areas
from reconstruction.panels.search.parameters import SegmentationParameters
from reconstruction.panels.segment import LEAST_SURE, SURE, other_panes, segment_image
from reconstruction.scenes.facades.cases import random_case, wide_camera
from reconstruction.scenes.facades.render import render_facade

Array = NDArray[np.float64]

GLASS_EVERYWHERE = PhotoPrediction(
    {10: SizePrediction((10, 8), 0.01, np.ones((2, 3), np.float32), np.zeros((2, 3, 4, 2), np.float32))}
)


def true_votes(seed: int, noise: float) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.uint16]]:
    """What a network would say that knows a synthetic picture, with corners off by a share of the pane's size."""
    made = synthetic_picture(seed, 256)
    index = made.index[STRIDE // 2 :: STRIDE, STRIDE // 2 :: STRIDE]
    corners = np.concatenate([np.zeros((1, 4, 2), np.float32), made.corners_px])[index]
    size = np.ptp(corners, axis=2).max(axis=2, keepdims=True)[..., None] if len(made.corners_px) else 0.0
    corners = corners + noise * size * np.random.default_rng(seed).standard_normal(corners.shape)
    return (index > 0).astype(np.float32), corners.astype(np.float32), made.index


@pytest.mark.slow
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
            panes.append(Pane(quad + noise_px * rng.standard_normal((4, 2)), 0.9, 0.02, max(noise_px, 0.3)))
    return panes, places, np.array(corners)


@pytest.mark.slow
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


@pytest.mark.slow
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
    moved = [Pane(pane.corners_px + aside, pane.share, pane.scatter, 0.3) for pane in right]
    facades = network_facades(FoundPanes((*left, *moved)), 2100, 800)
    assert sorted(len(facade.panels) for facade in facades) == sorted([len(places), len(more)])
    assert [facade.id for facade in facades] == ["A", "B"]


QUAD = np.array([[0.0, 40.0], [30.0, 40.0], [30.0, 0.0], [0.0, 0.0]])


def blank_look(scale: float = 0.5) -> SizePrediction:
    return SizePrediction((50, 50), scale, np.ones((13, 13), np.float32), np.zeros((13, 13, 4, 2), np.float32))


def test_of_panes_that_cover_one_another_the_most_probable_stays_and_equals_measure_it() -> None:
    shifts = (0.0, 3.0, 31.0)
    panes = [Pane(QUAD + shift, 0.8, 0.02, 0.5) for shift in shifts]
    found = Candidates(panes, [blank_look()] * 3).joined(np.array([0.6, 0.9, 0.5]), np.zeros((3, 13)))
    assert len(found.panes) == 2
    assert found.probability.tolist() == [0.9, 0.5]
    weights = np.array([0.6, 0.9]) ** 2
    assert found.panes[0].corners_px == pytest.approx(QUAD + 3.0 * weights[1] / weights.sum())
    assert np.array_equal(found.panes[1].corners_px, QUAD + 31.0)


def test_features_of_panes_tell_sizes_that_agree_and_neighbours_that_are_alike() -> None:
    panes = [Pane(QUAD + np.array([40.0 * i, 0.0]), 0.8, 0.0, 0.5) for i in range(3)]
    predictions = [blank_look(), blank_look(), blank_look()]
    alone = first_features(Candidates(panes, predictions))
    again = first_features(Candidates([*panes, replace(panes[0], share=0.5)], [*predictions, blank_look(0.3)]))
    assert alone[:, 7].tolist() == [0.0, 0.0, 0.0]
    assert again[:, 7] == pytest.approx([0.5, 0.0, 0.0, 0.8])
    assert again[:3, [0, 1, 3]] == pytest.approx(np.tile([0.8, 0.0, np.log(0.75)], (3, 1)))
    beside = second_features(Joined(panes, np.full(3, 0.6), alone, predictions, np.zeros(3)))
    other = Pane(QUAD[:, ::-1] @ np.array([[0.0, -1.0], [1.0, 0.0]]) + [200.0, 0.0], 0.8, 0.0, 0.5)
    assert beside[:, 1] == pytest.approx(np.log1p(1.2))
    assert beside[:, 2] == pytest.approx(np.log1p(1.2))
    assert beside[:, 3] == pytest.approx(0.0)
    apart = second_features(Joined([panes[0], other], np.full(2, 0.6), alone[:2], predictions[:2], np.zeros(2)))
    assert (apart[:, 1] < 0.1).all()


def test_a_pane_s_rival_is_the_most_probable_other_pane_in_its_place() -> None:
    half = QUAD * [0.4, 1.0]
    quads = [QUAD, QUAD + 1.0, half, half + np.array([15.0, 0.0]), QUAD + 200.0]
    panes = [Pane(quad, 0.8, 0.02, 0.5) for quad in quads]
    probability = np.array([0.9, 0.8, 0.5, 0.7, 0.6])
    found = Candidates(panes, [blank_look()] * 5).joined(probability, np.zeros((5, 13)))
    assert found.probability.tolist() == [0.9, 0.6]
    assert found.rivals.tolist() == [0.7, 0.0], "one that is nearly the same is none"


@given(probability=st.floats(0.0, 1.0), left=st.floats(0.0, 1.0), right=st.floats(0.0, 1.0))
def test_glass_beyond_a_pane_counts_where_no_other_pane_explains_it(
    probability: float, left: float, right: float
) -> None:
    look = look_of_everything(0.5, probability)
    middle, apart = 2.0 * QUAD + [200.0, 100.0], np.array([61.0, 0.0])
    panes = [Pane(middle + shift, 0.8, 0.02, 0.5) for shift in (0.0, -apart, apart)]
    alone = Joined(panes[:1], np.full(1, 0.9), np.zeros((1, 13)), [look], np.zeros(1))
    assert glass_beyond(alone) == pytest.approx(probability, abs=1e-6)
    beside = Joined(panes, np.array([0.9, left, right]), np.zeros((3, 13)), [look] * 3, np.zeros(3))
    explained = 1.0 - glass_beyond(beside)[0] / probability if probability > 1e-3 else 0.25 * (left + right)
    assert explained == pytest.approx(0.25 * (left + right), abs=0.1 * (left + right) + 1e-3)


def look_of_everything(scale: float, probability: float) -> SizePrediction:
    high, wide = (int(scale * side) // STRIDE for side in (400, 600))
    corners = np.zeros((high, wide, 4, 2), np.float32)
    return SizePrediction(
        (wide * STRIDE, high * STRIDE), scale, np.full((high, wide), probability, np.float32), corners
    )


@given(larger=st.lists(st.tuples(st.floats(1.5, 11.9), st.floats(0.0, 1.0)), max_size=4), smaller=st.floats(0.0, 1.0))
def test_a_pane_is_asked_again_where_it_is_seen_larger_and_only_there(
    larger: list[tuple[float, float]], smaller: float
) -> None:
    own = look_of_everything(0.2, 0.9)
    looks = [own, look_of_everything(0.1, smaller), *(look_of_everything(0.2 * by, p) for by, p in larger)]
    predictions = PhotoPrediction(dict(enumerate(looks)))
    panes = [Pane(4.0 * QUAD + [100.0, 50.0], 0.8, 0.02, 0.5)]
    (seen,) = seen_larger(Joined(panes, np.full(1, 0.9), np.zeros((1, 13)), [own], np.zeros(1)), predictions)
    assert seen == pytest.approx(np.mean([p for _, p in larger]) if larger else 1.0, abs=1e-6)


@pytest.mark.slow
def test_confidences_fitted_to_pictures_are_probabilities_of_others(tmp_path: Path) -> None:
    def pictures(first: int) -> list[tuple[NDArray[np.uint8], NDArray[np.uint16]]]:
        made = [synthetic_picture(7_000_000 + first + seed, 256) for seed in range(60)]
        return [(one.image, one.index) for one in made]

    told: list[str] = []
    fitted = calibrated([Source(pictures(0), 1.0)], told.append)
    assert len(told) == 1
    last = calibrated_last([Source(pictures(200)[:20], 1.0)], *fitted, told.append)
    assert last.weight[0] > 0.0, "a pane is the more probable, the more so the second regression says"
    write_regressions((*fitted, last), tmp_path / "confidence.json")
    assert {"first", "second", "third"} == set(json.loads((tmp_path / "confidence.json").read_text()))
    sure, there = [], []
    for image, index in pictures(100):
        candidates = candidates_of(predict_photo(image, 1600))
        sure.append(fitted[0].probability(first_features(candidates)))
        there.append(are_there(list(candidates.quads), index))
    probability, is_there = np.concatenate(sure), np.concatenate(there)
    assert abs(probability.mean() - is_there.mean()) < 0.1
    assert is_there[probability > 0.8].mean() > 0.7
    assert is_there[probability < 0.2].mean() < 0.3


@pytest.mark.long
def test_each_picture_is_looked_at_by_the_network_that_has_not_learned_from_it() -> None:
    def n_candidates(*networks: PaneNetwork) -> int:
        made = synthetic_picture(7_000_200, 192)
        told: list[str] = []
        calibrated([Source([(made.image, made.index)] * 2, 1.0, networks)], told.append)
        return int(told[0].split()[2])

    blind = PaneNetwork().eval()
    torch.nn.init.zeros_(blind.head.weight)
    torch.nn.init.constant_(blind.head.bias, -9.0)
    seen = n_candidates(network(), blind)
    assert seen > 0
    assert n_candidates() == n_candidates(network(), network()) == 2 * seen


def test_a_quadrilateral_is_there_where_it_covers_a_pane_by_more_than_half() -> None:
    index = index_image([QUAD + 5.0], 60, 60)
    quads = [QUAD + 5.0, QUAD + np.array([12.0, 5.0]), QUAD + np.array([28.0, 5.0]), QUAD + 500.0]
    assert are_there(quads, index).tolist() == [True, True, False, False]


def test_nothing_is_found_where_nothing_is() -> None:
    assert network_facades(FoundPanes(()), 100, 100) == ()
    assert find_panes(PhotoPrediction()).panes == ()
    dark = predict_photo(np.zeros((40, 40, 3), np.uint8), 40)
    assert all(pane.confidence < 0.5 for pane in find_panes(dark).panes)
    assert gathered(np.zeros((8, 8), np.float32), np.zeros((8, 8, 4, 2), np.float32), (32, 32)) == []


@given(seed=st.integers(0, 10_000))
def test_sides_of_a_pane_are_measured_by_its_edges(seed: int) -> None:
    rng = np.random.default_rng(seed)
    size = rng.uniform(60.0, 160.0)
    true = np.array([200.0, 200.0]) + size * (np.array([[-0.5, 0.5], [0.5, 0.5], [0.5, -0.5], [-0.5, -0.5]]))
    true += rng.uniform(-0.05, 0.05, (4, 2)) * size
    is_glass = index_image([true], 400, 400) > 0
    image = np.where(is_glass, 90, 170)[..., None] + rng.normal(0.0, 6.0, (400, 400, 3))
    told = true + rng.uniform(-0.07, 0.07, (4, 2)) * size
    (found,) = measured([Pane(told, 0.9, 0.02, 0.05 * size)], np.clip(image, 0, 255).astype(np.uint8))
    assert np.abs(found.corners_px - true).max() < 0.03 * size + 1.0
    assert np.abs(found.corners_px - true).mean() < 0.5 * np.abs(told - true).mean() + 0.5


def test_sides_without_an_edge_stay() -> None:
    pane = Pane(QUAD + 30.0, 0.9, 0.02, 1.0)
    (found,) = measured([pane], np.full((120, 120, 3), 90, np.uint8))
    assert np.abs(found.corners_px - pane.corners_px).max() < 0.01
    assert measured([], np.full((120, 120, 3), 90, np.uint8)) == []


SQUARE = np.array([[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]])


@given(seed=st.integers(0, 10_000), n=st.integers(3, 6))
def test_cells_that_are_other_panes_than_the_network_s_are_told_from_the_same_ones(seed: int, n: int) -> None:
    rng, side = np.random.default_rng(seed), 20.0
    places = [np.array([x, y], float) for x in range(n) for y in range(n)]
    cells = [side * (SQUARE + place) for place in places]
    panes = [Pane(cell + rng.uniform(-1.5, 1.5, (4, 2)), 0.9, 0.02, 1.0, confidence=0.8) for cell in cells]
    assert other_panes(cells, panes) == 0.0
    halves = [side * (SQUARE * [0.5, 1.0] + place + shift) for place in places for shift in ([0, 0], [0.5, 0])]
    assert (
        other_panes(halves, [replace(pane, corners_px=pane.corners_px + np.array([0.0, 8.0])) for pane in panes]) == 1.0
    )
    triangles = [cell[np.array(kept)] for cell in cells for kept in ((0, 1, 2), (0, 2, 3))]
    assert other_panes(triangles, panes) == 0.0, "the network knows four corners only"
    assert other_panes([], panes) == 1.0
    assert other_panes(cells[n:], panes) == pytest.approx(1.0 / n)
    assert other_panes([], [replace(pane, confidence=SURE - 0.01) for pane in panes]) is None
    assert other_panes([], panes[: LEAST_SURE - 1]) is None


@pytest.mark.long
def test_what_lies_around_a_wall_and_looks_like_glass_is_no_reason_against_panels_that_all_panes_are():
    (photo,) = synthetic_set("made-planar", 1, extent_margin_m=None, first_seed=3).photos()
    (facade,) = segment_image(photo.image, photo.views).facades
    assert facade.network is not None
    assert not facade.network.on, facade.network.reason
    assert "of its panes are none of them" in facade.network.reason


GLASS = Path(__file__).parents[5] / "shared" / "data" / "glass"
"""Photos of a real curtain wall; every second one, from the second on, was not learned from."""


@pytest.fixture(scope="module")
def glass() -> list[ScoredPhoto]:
    if not GLASS.is_dir():
        pytest.skip("the photos of real glass are not beside the project")
    return list(folder_set(GLASS / "photos", GLASS / "truth").photos())[1::2]


def scores(photos: list[ScoredPhoto], parameters: SegmentationParameters) -> list[PhotoScores]:
    return [score_answer(photo, own_method(parameters)(photo, QUIET)) for photo in photos]


@pytest.mark.slow
def test_panes_of_real_glass_are_found_where_lines_find_none(glass: list[ScoredPhoto]) -> None:
    by_lines, by_choice = (scores(glass, SegmentationParameters(network=setting)) for setting in ("off", "auto"))
    individual = [np.mean([one.individual_miou for one in each]) for each in (by_lines, by_choice)]
    assert individual[0] < 0.1
    assert individual[1] > 0.7
    assert np.mean([one.overall_iou for one in by_choice]) > 0.85
    assert sum(one.n_false or 0 for one in by_choice) < 0.15 * sum(one.n_found for one in by_choice)


@pytest.mark.slow
def test_the_network_is_on_where_lines_take_a_close_up_for_something_else(glass: list[ScoredPhoto]) -> None:
    image = np.asarray(cv2.resize(glass[0].image, None, fx=0.25, fy=0.25, interpolation=cv2.INTER_AREA), np.uint8)
    found = segment_image(image, None, SegmentationParameters())
    decision = found.facades[0].network
    assert decision is not None
    assert decision.on
    assert len(found.panels) >= 3
    assert "the network sees no glass" in decision.reason
    unasked = segment_image(np.full((60, 80, 3), 90, np.uint8), None, SegmentationParameters(network="off"))
    assert [grid.network for grid in unasked.facades] == [None]


@pytest.mark.slow
def test_lines_that_the_network_agrees_with_stay() -> None:
    made = render_facade(random_case("planar", 3, wide_camera(640, 480)))
    photo = scored(made)
    views, lines = photo.views, SegmentationParameters(network="off")
    (by_choice,), (by_lines,) = (
        segment_image(made.image, views, setting).facades for setting in (SegmentationParameters(), lines)
    )
    assert by_choice.network is not None
    assert not by_choice.network.on
    assert [panel.id for panel in by_choice.panels] == [panel.id for panel in by_lines.panels]
    for chosen, other in zip(by_choice.panels, by_lines.panels, strict=True):
        assert np.array_equal(chosen.corners_px, other.corners_px)


def test_the_networks_weights_are_small_and_finite() -> None:
    weights = network().state_dict()
    assert sum(value.numel() for value in weights.values()) < 4_000_000
    assert all(bool(value.isfinite().all()) for value in weights.values())


@pytest.mark.parametrize("shape", [SMALL, LARGE])
def test_a_networks_shape_follows_from_its_weights(shape: Shape) -> None:
    assert Shape.of(PaneNetwork(shape).state_dict()) == shape


@pytest.mark.slow
def test_training_learns_from_a_pool_that_is_still_being_made(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pool, "PER_FILE", 4)
    monkeypatch.setitem(training.BATCH, "cpu", 2)
    told: list[str] = []
    wanted = [NetworkToTrain(tmp_path / "large", LARGE), NetworkToTrain(tmp_path / "small")]
    with Pool(tmp_path / "pool", 8, 1) as made:
        first = made.arrived(least=4)
        assert len(first) in (4, 8)
        assert np.array_equal(first[1].image, synthetic_picture(1, SYNTHETIC_PX).image)
        bank = CropSampler("cpu", (1.0,))
        bank.add(first, 0)
        train(bank, 0.05, wanted, more=lambda: made.arrived(least=1), tell=told.append)
    for one in wanted:
        trained = PaneNetwork(one.shape)
        trained.load_state_dict({name: value.float() for name, value in load_file(one.out).items()})
        torch.manual_seed(0)
        assert not torch.equal(trained.state_dict()["head.bias"], PaneNetwork(one.shape).state_dict()["head.bias"])
    with Pool(tmp_path / "pool", 4, 1) as again:  # nothing is made anew
        assert np.array_equal(again.arrived(least=4)[1].image, first[1].image)
        assert not again.arrived(least=1)


def test_gathered_pictures_come_back_from_their_file(tmp_path: Path) -> None:
    pictures = [synthetic_picture(seed, 128) for seed in range(3)]
    write_gathered((pictures[:1], pictures[1:]), tmp_path / "gathered.npz")
    back = read_gathered(tmp_path / "gathered.npz")
    assert [len(source) for source in back] == [1, 2]
    for one, other in zip(pictures, [*back[0], *back[1]], strict=True):
        assert np.array_equal(one.index, other.index)
        assert np.array_equal(one.corners_px, other.corners_px)
        kept, given_one = (cv2.blur(each.image.astype(float), (9, 9)) for each in (other, one))  # but for noise
        assert np.abs(kept - given_one).mean() < 2.0


def fits(picture: SyntheticPicture) -> bool:
    return len(picture.corners_px) > 0 and len(bank_of([picture])) == 1


def bank_of(pictures: list[SyntheticPicture], source: int = 0) -> CropSampler:
    bank = CropSampler("cpu", (0.0, 0.0, 0.0))
    bank.shares[source] = 1.0
    bank.add(pictures, source)
    return bank


@pytest.mark.long
@pytest.mark.parametrize("seed", range(8))
def test_crops_show_what_opencv_shows_of_the_same_view(seed: int) -> None:
    made = next(
        each for each in (synthetic_picture(seed, 384) for seed in range(100 * seed, 100 * seed + 100)) if fits(each)
    )
    bank = bank_of([made], 2)
    views = bank.views(3, np.random.default_rng(seed))
    images, numbers, _ = bank.plain(views)
    half = np.array([[1.0, 0.0, 0.5], [0.0, 1.0, 0.5], [0.0, 0.0, 1.0]])  # pixel middles lie at .5
    for to_crop, image, number in zip(views.to_crop, images, numbers, strict=True):
        shrink = 1.0 / np.sqrt(abs(np.linalg.det(to_crop)))
        level = max(0, int(np.floor(np.log2(shrink) + 0.5)))
        smaller: NDArray[np.float32] = made.image.astype(np.float32)
        for _ in range(level):
            halved = cv2.resize(smaller, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
            smaller = np.asarray(halved, np.float32)
        size, border = (CROP_PX, CROP_PX), cv2.BORDER_REPLICATE
        warp = np.linalg.inv(half) @ to_crop @ np.diag([2.0**level, 2.0**level, 1.0]) @ half
        expected = cv2.warpPerspective(smaller, warp, size, flags=cv2.INTER_LINEAR, borderMode=border)
        assert np.abs(255.0 * image.permute(1, 2, 0).numpy() - expected).mean() < 1.0
        warp = np.linalg.inv(half) @ to_crop @ half
        shown = cv2.warpPerspective(made.index, warp, size, flags=cv2.INTER_NEAREST, borderMode=border)
        assert (number.numpy() != shown).mean() < 0.02


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(12))
def test_a_crops_truth_lies_where_its_picture_shows_it(seed: int) -> None:
    """A picture that is its own truth, painted white where there are panes."""
    made = next(
        each for each in (synthetic_picture(seed, 384) for seed in range(100 * seed, 100 * seed + 100)) if fits(each)
    )
    painted = np.repeat((255 * (made.index > 0)).astype(np.uint8)[..., None], 3, axis=2)
    bank = bank_of([SyntheticPicture(painted, made.index, made.corners_px)])
    views = bank.views(4, np.random.default_rng(seed))
    images, _, truth = bank.plain(views)
    seen, is_pane = images[..., 2::4, 2::4].mean(dim=1), truth.is_pane > 0
    assert float((is_pane & (seen < 0.15)).float().mean()) < 0.01
    assert float((~is_pane & (seen > 0.8)).float().mean()) < 0.01
    # Pixels half of one beside a place, which tell whether it lies on a pane, lie between the corners it names.
    quads = OFFSET_PX * truth.offsets.reshape(4, *is_pane.shape[1:], 4, 2).numpy()
    quads = quads[(is_pane & (truth.counts > 0) & (truth.weight[..., 0] > 0)).numpy()].astype(float)
    assert (signed_areas(quads) > 0.0).all()
    sides, to_pixel = np.roll(quads, -1, axis=1) - quads, np.array([0.5, 0.5]) - quads
    outside = sides[..., 0] * to_pixel[..., 1] - sides[..., 1] * to_pixel[..., 0]
    assert (outside / np.linalg.norm(sides, axis=-1)).max(initial=0.0) < 2.0  # a pixel of the picture, made larger


@pytest.mark.long
def test_changed_crops_are_finite_and_keep_their_truth() -> None:
    bank = bank_of([synthetic_picture(seed, 384) for seed in range(6)], 2)
    images, truth = bank.crops(24, np.random.default_rng(4), torch.Generator().manual_seed(4))
    plain, _, same = bank.plain(bank.views(24, np.random.default_rng(4)))
    assert images.shape == (24, 3, CROP_PX, CROP_PX)
    assert bool(images.isfinite().all())
    assert float(images.abs().max()) <= 1.0
    assert float((images - (2.0 * plain - 1.0)).abs().mean()) > 0.1
    for name in ("is_pane", "counts", "offsets", "weight"):
        assert torch.equal(getattr(truth, name), getattr(same, name))


@pytest.mark.slow
def test_the_network_is_on_where_lines_divide_a_wall_with_windows_into_wrong_cells(shared_data: Path) -> None:
    photo = next(each for each in annotated_set("cmp", shared_data / "facades").photos() if "b0368" in each.name)
    decision = segment_image(photo.image, whole_view(photo.image), SegmentationParameters()).facades[0].network
    assert decision is not None
    assert decision.on
    assert "of its panes are none of them" in decision.reason


@pytest.mark.slow
def test_confidences_of_windows_in_walls_are_shares_of_those_that_are_there(shared_data: Path) -> None:
    """On every second photo of CMP: by these nothing was chosen when confidences were fitted."""
    told, there = [], []
    for photo in list(annotated_set("cmp", shared_data / "facades").photos())[1::2]:
        panes = find_panes(predict_photo(photo.image, 1600)).panes
        told += [pane.confidence for pane in panes]
        there += are_there([pane.corners_px for pane in panes], photo.index).tolist()
    confidence, is_there = np.array(told), np.array(there)
    reported = confidence >= LEAST_BELIEVED
    assert reported.sum() > 400
    assert 1.0 - is_there[reported].mean() < 0.2
    for low, high in ((0.5, 0.75), (0.75, 0.9), (0.9, 1.0)):
        chosen = (confidence >= low) & (confidence < high)
        assert chosen.sum() >= 30
        assert abs(confidence[chosen].mean() - is_there[chosen].mean()) < 0.15

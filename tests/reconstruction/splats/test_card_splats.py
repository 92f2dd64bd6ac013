"""Splats in a card's memory: which of them a picture needs, and Adam's moments in half the bytes."""

from __future__ import annotations

import gc
import math
from dataclasses import replace

import numpy as np
import pytest
import torch
from torch import Tensor

from reconstruction.base.adam import Adam
from reconstruction.gpu import shaders
from reconstruction.gpu.device import Device, open_device, why_no_gpu
from reconstruction.splats import card_splats
from reconstruction.splats.card_splats import (
    LEARNED_QUADS,
    OTHER_FEATURES,
    PLACES,
    RATED,
    AdamStep,
    CardSplats,
    first_of_half,
    half_of_first,
    half_of_second,
    second_of_half,
)
from reconstruction.splats.densification.strategy import NO_CHANGES, Limits
from reconstruction.splats.splats import Splats
from reconstruction.training.config import ANTIALIASED
from tests.reconstruction.splats.drawn_splats import (
    MadeSplats,
    level_view,
    one_splat,
    random_ellipsoids,
    random_splats,
    rounded,
    seeded,
    together,
)

VIEW = level_view(60, 40, 50.0)
BY = AdamStep(dict.fromkeys((*RATED, "details"), 0.01), 0.5, 1e-3, 1.0, Limits(), NO_CHANGES, 3)


@pytest.fixture(autouse=True)
def _card() -> None:
    if reason := why_no_gpu():
        pytest.skip(f"no graphics card: {reason}")


def splats_of(made: MadeSplats) -> Splats:
    means, quats, scales, opacities, features = (values.float() for values in made.tensors)
    panels = torch.arange(len(means), dtype=torch.int32) % 2 - 1
    splats = Splats.of(means, quats, scales, opacities, features[:, :3].sigmoid(), panels)
    splats.sh.data += 0.2 * torch.randn(splats.sh.shape, generator=seeded(1))
    return splats


def hard_splats(solid: bool) -> Splats:
    """Behind the camera, at its side, edge-on, huge, no numbers, too faint, and cut by the nearest plane."""
    made = (random_ellipsoids if solid else random_splats)(300, VIEW, 3)
    sizes = (0.3, 0.3, 0.1) if solid else (0.3, 0.3)
    more = []
    for depth_m in (-4.0, 0.0, 0.0999, 0.1001, 0.2, 4.0):
        for x_m in (-40.0, -2.5, 0.0, 2.5, 40.0):
            more.append(one_splat(depth_m=depth_m, x_m=x_m, scale_m=sizes))
    more += [one_splat(tilt_deg=tilt, x_m=-1.0, scale_m=sizes) for tilt in (89.0, 89.999, 90.0, 90.001)]
    more += [one_splat(scale_m=tuple(factor * size for size in sizes), x_m=3.0) for factor in (1e-9, 1e3, 1e6, 1e18)]
    more += [one_splat(opacity=opacity, scale_m=sizes) for opacity in (0.9 / 255.0, 1.0 / 255.0, 1.1 / 255.0)]
    placed = together(*more).changed(features=torch.ones(len(more), 5, dtype=torch.float64))
    splats = splats_of(rounded(together(made, placed)))
    for number, name in enumerate(("means", "quats", "log_scales", "opacity_logits")):
        for k, value in enumerate((math.nan, math.inf, -math.inf)):
            getattr(splats, name).data[20 + 3 * number + k] = value
    return splats


def adam_of(splats: Splats) -> Adam:
    return Adam([{"name": name, "params": [getattr(splats, name)]} for name in splats.names], eps=1e-15)


def learned(device: Device, splats: Splats, n_steps: int = 2) -> dict[str, Tensor]:
    """What is learned in some steps, with moments, what densification is told, and how many splats were drawn."""
    own = splats.some(torch.arange(len(splats)))
    optimiser = adam_of(own)
    card = CardSplats(device, own, optimiser, with_glass=True)
    n_drawn = card.drawing(VIEW, ANTIALIASED, 3).drawing.n
    pull = torch.randn((VIEW.height_px, VIEW.width_px, 4 * card_splats.GLASS_FEATURES + 4), generator=seeded(2))
    for _ in range(n_steps):
        card.try_step(VIEW, ANTIALIASED, pull.numpy(), BY)
    card.bring(own, optimiser)
    seen = card.seen(torch.zeros(1, 3))
    found = {name: getattr(own, name).detach() for name in PLACES}
    for name in PLACES:
        state = optimiser.state[getattr(own, name)]
        found |= {f"{name} {key}": state[key] for key in ("exp_avg", "exp_avg_sq")}
    found |= {name: getattr(seen, name) for name in ("pulls", "views", "weights", "sigmas_px")}
    return found | {"drawn": torch.tensor(n_drawn)}


@pytest.mark.long
@pytest.mark.parametrize("solid", [False, True])
def test_splats_that_a_picture_does_not_touch_change_no_bit_of_what_is_learned(
    solid: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    usual = shaders._lines_of
    cases = {"some": hard_splats(solid)}
    numbers = torch.arange(len(cases["some"]))
    weights = learned(open_device(), cases["some"])["weights"]
    cases["all"] = cases["some"].some(numbers[weights > 0.0])
    cases["none"] = cases["some"].some(numbers[10:300:10] - 1)
    found = {}
    with monkeypatch.context() as changed:
        # In several parts, that have one piece of totals together.
        changed.setattr(card_splats, "MOST_OF_PART", 64)
        found = {name: learned(open_device(), splats) for name, splats in cases.items()}

    def lines_of(name: str) -> tuple[str, ...]:
        if name != "find_seen":
            return usual(name)
        return tuple(line.replace("touched_by(given, SLACK).is_any", "true") for line in usual(name))

    monkeypatch.setattr(shaders, "_lines_of", lines_of)
    device = open_device()
    others = {key: kernel for key, kernel in device._kernels.items() if key[0] != "find_seen"}
    monkeypatch.setattr(device, "_kernels", others)
    for name, splats in cases.items():
        expected = learned(device, splats)
        assert int(expected.pop("drawn")) == len(splats)
        n = int(found[name].pop("drawn"))
        assert n == {"some": n, "all": len(splats), "none": 0}[name]
        for key, values in expected.items():
            assert torch.equal(found[name][key].view(torch.int32), values.view(torch.int32)), (name, key)
    n_some = int((weights > 0.0).sum())
    assert 100 < n_some < len(cases["some"]) - 50


def test_totals_of_parts_share_pieces_that_the_card_holds() -> None:
    assert card_splats._pieces([0, 30, 30, 70, 100, 190], 100) == ([(0, 100), (100, 90)], (0, 0, 0, 0, 1))
    assert card_splats._pieces([0], 100) == ([], ())
    assert card_splats._pieces([0, 0, 0], 100) == ([(0, 0)], (0, 0))


def test_moments_of_16_bits_are_those_in_float64_but_for_rounding() -> None:
    g = np.random.default_rng(0)
    exact = g.choice([-1.0, 1.0], 100_000) * 2.0 ** g.uniform(-49.0, 13.0, 100_000)
    values = exact.astype(np.float32)
    first = first_of_half(half_of_first(values)).astype(np.float64)
    assert np.abs(first / values.astype(np.float64) - 1.0).max() <= 2.0**-10
    squares = np.square(exact).astype(np.float32)
    roots = np.sqrt(second_of_half(half_of_second(squares)).astype(np.float64))
    assert np.abs(roots / np.sqrt(squares.astype(np.float64)) - 1.0).max() <= 2.0**-11 * (1.0 + 1e-3)
    # All of them are kept as they are when they are brought again, and what is out of range ends at its limits.
    codes = np.arange(1 << 16, dtype=np.uint16)
    assert np.array_equal(half_of_second(second_of_half(codes)), codes)
    assert np.array_equal(half_of_first(first_of_half(codes)) & 0x7FFF, codes & 0x7FFF)
    ends = np.array([0.0, -0.0, 1e-30, 1e30, -1e30], np.float32)
    assert first_of_half(half_of_first(ends)).tolist() == pytest.approx([0.0, 0.0, 0.0, 2.0**14, -(2.0**14)], rel=1e-3)
    assert second_of_half(half_of_second(ends[[0, 2, 3]])).tolist() == pytest.approx([0.0, 0.0, 2.0**28], rel=3e-3)


@pytest.mark.long
def test_a_step_with_moments_of_16_bits_is_that_with_32_and_they_are_forgotten_as_fast(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    splats, device, n_steps = splats_of(random_splats(300, VIEW, 3)), open_device(), 400
    whole = learned(device, splats, 1)
    monkeypatch.setattr(card_splats, "MOST_WHOLE", 0)
    half = learned(device, splats, 1)
    ups = []
    for name in PLACES:
        # The step is taken by moments as they are before they are rounded.
        assert torch.equal(half[name], whole[name]), name
        first, second = (whole[f"{name} {key}"].numpy() for key in ("exp_avg", "exp_avg_sq"))
        assert np.array_equal(half[f"{name} exp_avg"].numpy(), first_of_half(half_of_first(first))), name
        down, exact = np.sqrt(half[f"{name} exp_avg_sq"].numpy().astype(float)), np.sqrt(second.astype(float))
        is_kept = exact > 2.0**-48
        ups.append((down / np.maximum(exact, 1e-30) - 1.0)[is_kept].ravel())
    apart = np.concatenate(ups)
    assert len(apart) > 5000
    assert np.abs(apart).max() < 2.0**-10
    assert abs(apart.mean()) < 4.0 * apart.std() / math.sqrt(len(apart))
    # Nothing is seen from the other side: moments are forgotten, each at the rate of Adam.
    own = splats.some(torch.arange(len(splats)))
    optimiser = adam_of(own)
    for name in PLACES:
        values = getattr(own, name)
        roots = 1e-4 * 2.0 ** torch.rand(values.shape, generator=seeded(3))
        optimiser.state[values] = {"step": torch.tensor(1.0), "exp_avg": roots, "exp_avg_sq": roots.square()}
    card = CardSplats(device, own, optimiser, with_glass=True)
    before = optimiser.state[own.sh]["exp_avg_sq"].double()
    matrix = VIEW.cam_from_world.clone()
    matrix[2, 3] = -1e4
    away = card.drawing(replace(VIEW, cam_from_world=matrix), ANTIALIASED, 3)
    assert away.drawing.n == 0
    totals, weights = [device.buffer(16)], device.buffer(16)
    for step in range(n_steps):
        card.learn(away, 3, totals, weights, replace(BY, seed=step))
    card.bring(own, optimiser)
    state = optimiser.state[own.sh]
    kept = (state["exp_avg_sq"].double() / before) / 0.999**n_steps
    assert float(kept.mean()) == pytest.approx(1.0, abs=1e-3)
    assert float(kept.std()) < 0.03
    assert float(state["exp_avg"].abs().max()) < 1e-3 * float(before.sqrt().min())


@pytest.mark.long
def test_what_a_splat_takes_of_the_memory_is_laid_out_and_counted() -> None:
    device = open_device()
    splats = splats_of(random_splats(20_000, VIEW, 3))
    gc.collect()
    device.forget_idle()
    before = device.held_bytes
    card = CardSplats(device, splats, adam_of(splats), with_glass=False)
    assert device.held_bytes - before == len(splats) * (3 * 16 * LEARNED_QUADS + 16)
    assert device.peak_bytes >= device.held_bytes
    pull = np.ones((VIEW.height_px, VIEW.width_px, 4 * OTHER_FEATURES + 4), np.float32)
    card.try_step(VIEW, ANTIALIASED, pull, BY)
    held = device.held_bytes
    card.try_step(VIEW, ANTIALIASED, pull, BY)
    assert device.held_bytes == held
    del card
    gc.collect()
    assert device.held_bytes == held - len(splats) * (3 * 16 * LEARNED_QUADS + 16)

"""What splats are drawn on: the decision and its reasons, and trainings on a card and after it has failed."""

from __future__ import annotations

import gc
from dataclasses import replace

import numpy as np
import pytest
import torch
from numpy.typing import NDArray

from planning.base.effects import decide
from planning.base.errors import InputError
from reconstruction.gpu.device import Adapter, DeviceFailed, open_device, why_no_gpu
from reconstruction.splats import card_splats
from reconstruction.splats.card_splats import CardSplats
from reconstruction.splats.rasterising.wgpu_backend import Drawing
from reconstruction.splats.splats import Splats
from reconstruction.training import devices
from reconstruction.training.config import ANTIALIASED, TrainConfig
from reconstruction.training.devices import (
    CardTrial,
    SplatsByCard,
    check_device,
    drawn_by_card,
    shown_by_card,
    training_bytes,
)
from reconstruction.training.train import train_model
from tests.reconstruction.splats.drawn_splats import level_view, random_splats, seeded

SMALL = TrainConfig(method="2dgs", iterations=8, n_splats=100, max_splats=100, score_every_s=1e9)
CARD = Adapter("Intel UHD 620", "integrated", "Vulkan", "Mesa 24")


@pytest.fixture
def splats() -> Splats:
    made = [values.float() for values in random_splats(100, level_view()).tensors]
    colours, panels = made[4][:, :3].sigmoid(), torch.full((100,), -1, dtype=torch.int32)
    return Splats.of(*made[:4], colours, panels)


def needs_card() -> None:
    if reason := why_no_gpu():
        pytest.skip(f"no graphics card: {reason}")


def test_a_card_is_taken_where_it_saves_a_tenth_of_a_step() -> None:
    for card_s, on in ((0.02, True), (0.085, True), (0.095, False), (0.3, False)):
        found = decide(SplatsByCard(), CardTrial("Arc", "", 0.1, card_s, 1.5, 10**9))
        assert found.on == on
        assert found.cost_s == 1.5
        assert f"Arc takes {1e3 * card_s:.0f} ms, the processor 100 ms; about 1.0 GB" in found.reason
    assert not decide(SplatsByCard(), CardTrial("Arc", "it was tried, and it failed")).on


def test_who_asks_for_the_processor_is_not_asked(splats: Splats, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(devices, "why_no_gpu", lambda: 1 / 0)
    for device in ("cpu", "cuda"):
        assert drawn_by_card(replace(SMALL, device=device), splats, level_view()) == (False, None)


def test_programs_in_the_place_of_a_card_are_not_chosen_by_themselves(
    splats: Splats, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(devices, "why_no_gpu", str)
    monkeypatch.setattr(devices, "adapters", lambda: (replace(CARD, name="llvmpipe", kind="software"),))
    on, decision = drawn_by_card(SMALL, splats, level_view())
    assert not on
    assert "there is no graphics card but llvmpipe, which the processor runs" in str(decision)


def test_a_card_is_tried_and_the_reason_says_how_it_did(splats: Splats, monkeypatch: pytest.MonkeyPatch) -> None:
    times = {False: iter([0.5, 0.3]), True: iter([2.0, 0.01])}
    monkeypatch.setattr(devices, "learning_s", lambda *given: 0.05 if given[3] else 0.2)
    monkeypatch.setattr(devices, "why_no_gpu", str)
    monkeypatch.setattr(devices, "adapters", lambda: (CARD,))
    monkeypatch.setattr(devices, "_survives", lambda: True)
    monkeypatch.setattr(devices, "_step", lambda _, __, s: (next(times[s.on_gpu]), [torch.ones(3)]))
    on, decision = drawn_by_card(SMALL, splats, level_view())
    assert on
    assert decision.cost_s == 2.0
    assert decision.size == pytest.approx(0.75)
    assert "Intel UHD 620 takes 50 ms, the processor 200 ms" in decision.reason
    # One that draws something else is not taken, nor one that fails.
    monkeypatch.setattr(devices, "_step", lambda _, __, s: (1.0, [1.0 + 0.1 * s.on_gpu * torch.ones(3)]))
    on, decision = drawn_by_card(SMALL, splats, level_view())
    assert not on
    assert "does not draw what the processor draws (apart: 0.1)" in decision.reason

    def failing(*given: object) -> object:
        if given[2].on_gpu:
            raise DeviceFailed("it has no memory left")
        return 1.0, [torch.ones(3)]

    monkeypatch.setattr(devices, "_step", failing)
    on, decision = drawn_by_card(SMALL, splats, level_view())
    assert not on
    assert "it was tried, and it has no memory left" in decision.reason
    with pytest.raises(DeviceFailed):
        drawn_by_card(replace(SMALL, device="gpu"), splats, level_view())


def test_a_card_shows_models_where_its_picture_is_the_processors_and_comes_sooner(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    now, error = [0.0], [0.0]

    def draw(on_card: bool) -> NDArray[np.float32]:
        now[0] += 0.05 if on_card else 0.2
        return np.full((4, 4, 3), 0.5 + on_card * error[0], np.float32)

    monkeypatch.setattr(devices, "why_no_gpu", str)
    monkeypatch.setattr(devices, "adapters", lambda: (CARD,))
    monkeypatch.setattr(devices, "_survives", lambda: True)
    monkeypatch.setattr(devices.time, "perf_counter", lambda: now[0])
    found = shown_by_card(draw, 1000, "auto")
    assert found.on
    assert found.size == pytest.approx(0.75)
    assert "Intel UHD 620 takes 50 ms, the processor 200 ms" in found.reason
    # 40 dB are an error of 0.01; what is no number is no picture.
    for error[0], on in ((0.0099, True), (0.0101, False), (np.nan, False)):
        assert shown_by_card(draw, 1000, "auto").on == on
    monkeypatch.setattr(devices, "adapters", lambda: (replace(CARD, name="llvmpipe", kind="software"),))
    found = shown_by_card(lambda _: np.ones((1, 1, 3), np.float32), 1000, "auto")
    assert not found.on
    assert "there is no graphics card but llvmpipe" in found.reason


@pytest.mark.long
@pytest.mark.parametrize("most_whole", [card_splats.MOST_WHOLE, 0])
def test_a_step_takes_the_memory_that_is_told_at_most(most_whole: int, monkeypatch: pytest.MonkeyPatch) -> None:
    needs_card()
    monkeypatch.setattr(card_splats, "MOST_WHOLE", most_whole)
    device, view = open_device(), level_view(96, 64, 90.0)
    turns = 2.0 * torch.pi * torch.rand(60_000, generator=seeded(0))
    made = [values.float()[torch.arange(60_000) % 600] for values in random_splats(600, view).tensors]
    # A share of them only is before the camera.
    far = made[0].norm(dim=1)
    means = torch.stack([far * turns.sin(), made[0][:, 1], far * turns.cos()], dim=1)
    splats = Splats.of(means, made[1], 0.1 * made[2], made[3], made[4][:, :3].sigmoid())
    told = training_bytes(splats, view, ANTIALIASED, len(splats), device.adapter.is_software)
    gc.collect()
    device.forget_idle()
    before = device.held_bytes
    device.forget_peak()
    devices.learning_s(splats, view, ANTIALIASED, True)
    taken = device.peak_bytes - before
    learned = len(splats) * (784 if most_whole else 528)
    assert learned < taken < told
    # Beside what lies there for all, it is told well enough to choose a card by.
    assert told - card_splats.BYTES_FOR_ALL < 2.0 * taken
    # More splats take more by what is learned of each, and by what a picture needs of those in it.
    twice = training_bytes(splats, view, ANTIALIASED, 2 * len(splats), device.adapter.is_software)
    assert learned < twice - told < 2 * taken


@pytest.mark.long
def test_a_card_that_takes_its_process_along_is_not_taken(splats: Splats, monkeypatch: pytest.MonkeyPatch) -> None:
    needs_card()
    assert devices._survives()
    monkeypatch.setattr(devices, "why_no_gpu", str)
    monkeypatch.setattr(devices, "adapters", lambda: (CARD,))
    monkeypatch.setattr(devices.sys, "executable", "/bin/false")
    on, decision = drawn_by_card(SMALL, splats, level_view())
    assert not on
    assert "Intel UHD 620 ended the process that tried it, or did not answer" in decision.reason


def test_a_device_that_is_not_there_is_refused_with_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(devices, "why_no_gpu", lambda: "no driver answers (install one)")
    with pytest.raises(InputError, match=r"'gpu' is asked for, and no driver answers \(install one\); leave it out"):
        check_device(replace(SMALL, device="gpu"))
    check_device(SMALL)


@pytest.mark.long
def test_a_training_on_the_card_is_the_one_on_the_processor_and_survives_the_card(
    data_set, monkeypatch: pytest.MonkeyPatch
) -> None:
    needs_card()
    by_processor = train_model(data_set, replace(SMALL, device="cpu"))
    by_card = train_model(data_set, replace(SMALL, device="gpu"))
    decision = next(each for each in by_card.record.decisions if each.effect == SplatsByCard().name)
    assert (decision.on, decision.decided_by) == (True, "user")
    assert "llvmpipe" in decision.reason or not open_device().adapter.is_software
    mine, theirs = by_card.model.splats.means, by_processor.model.splats.means
    assert not torch.equal(mine, theirs)
    torch.testing.assert_close(mine, theirs, atol=0.02, rtol=0.0)
    assert by_card.quality.psnr_db == pytest.approx(by_processor.quality.psnr_db, abs=0.2)
    # The card is lost on the way: in a picture, and then in a step of Adam. Nothing else asks for splats before.
    alone = replace(SMALL, device="gpu", transients="off")
    for owner, method in ((Drawing, "blend_back"), (CardSplats, "learn")):
        calls = iter(range(100))
        usual = getattr(owner, method)

        def lost(self: object, *given: object, usual: object = usual, calls: object = calls) -> object:
            if next(calls) == 6:
                self.device.raw.destroy()
            return usual(self, *given)

        with monkeypatch.context() as changed:
            changed.setattr(owner, method, lost)
            trained = train_model(data_set, alone)
        assert trained.n_steps == 8
        note, lost_steps = trained.notes
        assert "on splats were drawn by the processor: the graphics card" in note
        assert "does not answer any more" in note
        n_lost = 2 if owner is Drawing else 4
        assert lost_steps == f"what splats learned in the {n_lost} steps before was lost with it"


@pytest.mark.slow
def test_a_short_training_on_the_card_is_as_good_as_on_the_processor(data_set) -> None:
    needs_card()
    config = replace(SMALL, iterations=150, n_splats=1500, max_splats=2000)
    found = {each: train_model(data_set, replace(config, device=each)).quality.psnr_db for each in ("cpu", "gpu")}
    assert found["gpu"] == pytest.approx(found["cpu"], abs=0.2)
    assert found["cpu"] > 15.0

"""Adapters, buffers and kernels of a graphics card, and what is said when it fails."""

from __future__ import annotations

import gc

import numpy as np
import pytest

from planning.base.errors import ReconstructionError
from reconstruction.gpu import device as devices
from reconstruction.gpu.device import Adapter, Device, DeviceFailed, adapters, open_device, uniform


def test_programs_that_stand_in_for_a_card_are_known_and_come_last(card: Device) -> None:
    found = adapters()
    assert [each.is_software for each in found] == sorted(each.is_software for each in found)
    assert all(each.is_software == ("llvmpipe" in each.name) for each in found if each.kind in ("software", "discrete"))
    assert card.adapter == found[0]


def test_cards_come_before_programs_and_a_named_one_before_all(monkeypatch: pytest.MonkeyPatch) -> None:
    names: dict[str, devices.Kind] = {
        "llvmpipe": "software", "Intel UHD 620": "integrated", "Radeon RX": "discrete", "Arc A770": "discrete",
    }  # fmt: skip
    found = tuple((Adapter(name, kind, "Vulkan", ""), None) for name, kind in names.items())
    monkeypatch.setattr(devices, "_found", lambda: found)
    monkeypatch.delenv(devices.NAME_VARIABLE, raising=False)
    assert [each.name for each in adapters()] == ["Radeon RX", "Arc A770", "Intel UHD 620", "llvmpipe"]
    monkeypatch.setenv(devices.NAME_VARIABLE, "arc")
    assert adapters()[0].name == "Arc A770"
    monkeypatch.setenv(devices.NAME_VARIABLE, "llvm")
    assert adapters()[0].name == "llvmpipe"


def test_a_device_is_opened_once_and_has_the_bytes_that_are_asked_for(card: Device) -> None:
    assert open_device() is card
    small = open_device(most_bytes=1 << 20)
    assert small.most_bytes == 1 << 20 < card.most_bytes
    with pytest.raises(ValueError, match="1048576 at most"):
        small.buffer((1 << 20) + 4)


def test_buffers_and_tables_hold_what_is_written_and_go_back_to_the_pool(card: Device) -> None:
    piece = card.buffer(4000)
    values = np.arange(1000, dtype=np.uint32)
    card.write(piece, values)
    assert np.array_equal(card.read((piece, 4000))[0].view(np.uint32), values)
    first, second = card.read((piece, 8), (piece, 400))
    assert len(first) == 8
    assert np.array_equal(second.view(np.uint32), values[:100])
    raw = piece.raw
    del piece
    gc.collect()
    assert card.buffer(3900).raw is raw


def test_what_is_held_is_counted_and_idle_pieces_make_room_where_much_is(
    card: Device, monkeypatch: pytest.MonkeyPatch
) -> None:
    gc.collect()
    card.forget_idle()
    before = card.held_bytes
    card.forget_peak()
    pieces = [card.buffer(1 << 20), card.table(1), card.buffer(1000, stays=True)]
    taken = (1 << 20) + 8192 * 16 + 1000
    assert card.held_bytes - before == taken
    card.read((pieces[0], 4096))
    assert (card.held_bytes - before, card.peak_bytes - before) == (taken, taken + 4096)
    # What stays is none of the pool; the others are idle and held.
    pieces.clear()
    gc.collect()
    assert card.held_bytes - before == taken - 1000
    assert card.buffer(1 << 20).size == 1 << 20
    assert card.held_bytes - before == taken - 1000
    monkeypatch.setattr(devices, "ROOMY_BYTES", before + taken)
    larger = card.buffer(1 << 21)
    assert card.held_bytes - before == 1 << 21
    del larger
    card.forget_idle()
    assert card.held_bytes == before


def test_more_uniforms_than_the_arena_holds_are_handed_over_in_turn(card: Device) -> None:
    totals = card.buffer(8)
    pieces = [card.buffer(4) for _ in range(300)]
    for number, piece in enumerate(pieces):
        card.write(piece, np.array([number], np.uint32))
    commands = card.commands()
    seen = []
    for piece in pieces:
        commands.run("ends", {}, 1, uniform(0, 0), piece, piece, totals)
    seen = commands.read((totals, 8))[0].view(np.uint32).tolist()
    assert seen == [299, 299]


def test_a_wrong_number_of_bindings_is_a_wrong_call(card: Device) -> None:
    with pytest.raises(ValueError, match="ends: expected 4 bindings, got 1"):
        card.commands().run("ends", {}, 1, uniform(0))


def test_a_lost_card_is_said_with_what_to_type_and_opened_anew() -> None:
    if devices.why_no_gpu():
        pytest.skip(devices.why_no_gpu())
    own = open_device(most_bytes=1 << 21)
    piece = own.buffer(400)
    own.raw.destroy()
    with pytest.raises(DeviceFailed, match=r"does not answer any more; compute on the processor"), own.errors_said():
        own.read((piece, 400))
    again = open_device(most_bytes=1 << 21)
    assert again is not own
    assert len(again.read((again.buffer(16), 16))[0]) == 16


def test_a_card_without_memory_is_said_and_a_wrong_call_is_not_hidden(card: Device) -> None:
    library = devices._library()
    own = open_device(most_bytes=1 << 22)
    with pytest.raises(DeviceFailed, match="no memory left"), own.errors_said():
        raise library.GPUOutOfMemoryError("Out of memory")
    with pytest.raises(library.GPUValidationError), card.errors_said():
        card.raw.create_buffer(size=1 << 40, usage=library.BufferUsage.STORAGE)


def test_without_a_card_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(devices, "_found", tuple)
    monkeypatch.setattr(devices, "_library", lambda: object())
    assert "apt-get install mesa-vulkan-drivers" in devices.why_no_gpu()
    with pytest.raises(ReconstructionError, match="on the processor"):
        open_device()
    monkeypatch.setattr(devices, "_library", lambda: None)
    assert "pip install" in devices.why_no_gpu()


def test_an_adapter_is_told_by_name_and_system() -> None:
    assert str(Adapter("Intel UHD 620", "integrated", "Vulkan", "Mesa 24")) == "Intel UHD 620 (Vulkan)"

"""Checkpoints: bit by bit the same, and files of strangers refused in words."""

import json
import math

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from safetensors.torch import save

from planning.base.errors import InputError
from reconstruction.training.training_state import read_checkpoint, write_checkpoint

leaves = st.one_of(
    st.none(), st.booleans(), st.integers(-(2**60), 2**60), st.floats(allow_nan=False), st.text(max_size=8)
)
states = st.dictionaries(
    st.one_of(st.text(max_size=6), st.integers(0, 99)),
    st.recursive(leaves, lambda inner: st.one_of(st.lists(inner, max_size=3), st.dictionaries(st.text(), inner))),
    max_size=5,
)


@pytest.mark.slow
@settings(max_examples=12, deadline=None)
@given(states)
def test_plain_state_comes_back_as_it_was(tmp_path_factory, state):
    path = tmp_path_factory.getbasetemp() / "plain.safetensors"
    write_checkpoint(path, state)
    assert read_checkpoint(path) == state


def test_adam_and_generator_go_on_bit_by_bit(tmp_path):
    generator = torch.Generator().manual_seed(3)
    weights = torch.nn.Parameter(torch.randn(5, 3, generator=generator))
    optimiser = torch.optim.Adam([{"params": [weights], "name": "w"}], lr=0.1, fused=True)

    def step():
        optimiser.zero_grad()
        ((weights - torch.randn(5, 3, generator=generator)) ** 2).sum().backward()
        optimiser.step()

    step()
    state = {
        "weights": weights,
        "adam": optimiser.state_dict(),
        "generator": generator.get_state(),
        "history": (1.5, math.inf),
        "empty": torch.zeros(0, 3),
    }
    write_checkpoint(tmp_path / "c", state)
    step()
    expected = weights.detach().clone()
    back = read_checkpoint(tmp_path / "c")
    with torch.no_grad():
        weights.copy_(back["weights"])
    optimiser.load_state_dict(back["adam"])
    generator.set_state(back["generator"])
    step()
    assert torch.equal(weights, expected)
    assert back["history"] == [1.5, math.inf]
    assert back["empty"].shape == (0, 3)


def test_what_cannot_be_kept_is_a_programmers_mistake(tmp_path):
    with pytest.raises(TypeError, match="/a/0: expected tensors"):
        write_checkpoint(tmp_path / "c", {"a": [object()]})
    with pytest.raises(TypeError, match="keys of text"):
        write_checkpoint(tmp_path / "c", {(1, 2): 3})
    assert not (tmp_path / "c").exists()


def record(content):
    return {"record": json.dumps(content)}


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"\x80\x04\x95 pickle",
        b"\xff" * 64,
        save({"a": torch.zeros(2)}),
        save({}, metadata={"record": "{"}),
        save({}, metadata=record({"format": "reflight-checkpoint/9", "state": {}})),
        save({}, metadata=record({"format": "reflight-checkpoint/1"})),
        save({}, metadata=record({"format": "reflight-checkpoint/1", "state": [1]})),
        save({}, metadata=record({"format": "reflight-checkpoint/1", "state": {"$tensor": "none"}})),
        save({}, metadata=record({"format": "reflight-checkpoint/1", "state": {"$items": [[1]]}})),
        save({}, metadata=record({"format": "reflight-checkpoint/1", "state": {"$items": [[[], 1]]}})),
        save({}, metadata={"record": "[" * 5000 + "]" * 5000}),
    ],
)
def test_damaged_and_hostile_files_are_refused(tmp_path, content):
    (tmp_path / "c").write_bytes(content)
    with pytest.raises(InputError, match="begin the training anew"):
        read_checkpoint(tmp_path / "c")


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(InputError, match=r"none: cannot be read"):
        read_checkpoint(tmp_path / "none")


def test_an_interrupted_write_leaves_the_last_one_whole(tmp_path, monkeypatch):
    write_checkpoint(tmp_path / "c", {"step": 1})
    monkeypatch.setattr("os.fsync", lambda _: (_ for _ in ()).throw(OSError(28, "No space left on device")))
    with pytest.raises(InputError, match="No space left"):
        write_checkpoint(tmp_path / "c", {"step": 2})
    monkeypatch.undo()
    assert read_checkpoint(tmp_path / "c") == {"step": 1}
    assert [path.name for path in tmp_path.iterdir()] == ["c"]

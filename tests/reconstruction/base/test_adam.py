"""Adam against torch's own, bit by bit."""

from __future__ import annotations

import copy
import subprocess
import sys

import pytest
import torch
from torch import Tensor

from reconstruction.base.adam import Adam

SHAPES = ((5, 3), (), (2, 4, 1))


def parameters() -> list[Tensor]:
    generator = torch.Generator().manual_seed(1)
    return [torch.nn.Parameter(torch.randn(shape, generator=generator)) for shape in SHAPES]


def groups(values: list[Tensor]) -> list[dict[str, object]]:
    return [
        {"params": values[:1], "lr": 0.1, "name": "first"},
        {"params": values[1:], "lr": 0.02, "weight_decay": 0.3, "eps": 1e-15},
    ]


def set_gradients(values: list[Tensor], step: int) -> None:
    generator = torch.Generator().manual_seed(100 + step)
    for number, value in enumerate(values):
        # One is without a gradient now and then.
        value.grad = None if (step + number) % 4 == 3 else torch.randn(value.shape, generator=generator)


@pytest.mark.long
def test_steps_are_those_of_torch_bit_by_bit() -> None:
    mine, theirs = parameters(), parameters()
    own = Adam(groups(mine), betas=(0.9, 0.99))
    other = torch.optim.AdamW(groups(theirs), betas=(0.9, 0.99), weight_decay=0.0, fused=True)
    for step in range(9):
        for values, optimiser in ((mine, own), (theirs, other)):
            set_gradients(values, step)
            optimiser.step()
    assert all(torch.equal(a, b) for a, b in zip(mine, theirs, strict=True))
    assert not torch.equal(mine[0], parameters()[0])


def test_a_state_that_is_put_back_goes_on_bit_by_bit() -> None:
    values = parameters()
    optimiser = Adam(groups(values))
    for step in range(3):
        set_gradients(values, step)
        optimiser.step()
    kept, kept_values = copy.deepcopy(optimiser.state_dict()), copy.deepcopy(values)
    later = Adam(groups(kept_values))
    later.load_state_dict(kept)
    for step in range(3, 6):
        for each, own in ((values, optimiser), (kept_values, later)):
            set_gradients(each, step)
            own.step()
    assert all(torch.equal(a, b) for a, b in zip(values, kept_values, strict=True))
    assert later.param_groups[0]["name"] == "first"


def test_the_state_of_other_parameters_is_refused() -> None:
    with pytest.raises(ValueError, match="as many parameters"):
        Adam([{"params": parameters()}]).load_state_dict(Adam(groups(parameters())).state_dict())


def test_gradients_are_forgotten() -> None:
    values = parameters()
    optimiser = Adam(groups(values))
    set_gradients(values, 0)
    optimiser.zero_grad(set_to_none=False)
    assert all(value.grad is None or not value.grad.any() for value in values)
    optimiser.zero_grad()
    assert all(value.grad is None for value in values)


@pytest.mark.slow
def test_torchs_compiler_is_not_loaded() -> None:
    program = (
        "import sys, torch; from reconstruction.base.adam import Adam; v = torch.nn.Parameter(torch.ones(2)); "
        "o = Adam([{'params': [v]}]); v.sum().backward(); o.step(); o.zero_grad(); o.state_dict(); "
        "sys.exit('torch._dynamo' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0

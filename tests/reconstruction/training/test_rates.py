"""How far one step of Adam takes each part of a model."""

import pytest
import torch

from reconstruction.splats.splats import NO_PANEL, Splats
from reconstruction.training.config import Rates
from reconstruction.training.training_state import take_step

N = 12


def moved(rates):
    """What a step changes, by name, and which splats are glass."""
    generator = torch.Generator().manual_seed(3)

    def random(*shape):
        return torch.rand(*shape, generator=generator)

    panels = torch.tensor([0, 1, NO_PANEL] * (N // 3))
    splats = Splats.of(random(N, 3), random(N, 4), 0.1 + random(N, 2), 0.1 + 0.8 * random(N), random(N, 3), panels)
    before = {name: getattr(splats, name).detach().clone() for name in splats.names}
    optimiser = torch.optim.Adam(splats.parameters(), lr=1e-2)
    for value in splats.parameters():
        value.grad = torch.rand(value.shape, generator=generator) - 0.5
    take_step(optimiser, splats, rates)
    return {name: getattr(splats, name).detach() - before[name] for name in splats.names}, panels >= 0


@pytest.mark.parametrize("share", [0.0, 0.1, 1.0])
def test_places_and_rotations_of_glass_go_a_share_of_a_step_and_nothing_else_does(share):
    whole, _ = moved(Rates(colour_details=1.0, glass_geometry=1.0))
    found, is_glass = moved(Rates(colour_details=1.0, glass_geometry=share))
    for name in ("means", "quats"):
        assert torch.allclose(found[name][is_glass], share * whole[name][is_glass], atol=1e-7)
        assert torch.equal(found[name][~is_glass], whole[name][~is_glass])
    for name in whole.keys() - {"means", "quats"}:
        assert torch.equal(found[name], whole[name])
        assert whole[name].abs().max() > 0.0


def test_bands_of_colour_above_the_first_go_their_share():
    whole, _ = moved(Rates(colour_details=1.0))
    found, _ = moved(Rates(colour_details=0.05))
    assert torch.equal(found["sh"][:, 0], whole["sh"][:, 0])
    assert torch.allclose(found["sh"][:, 1:], 0.05 * whole["sh"][:, 1:], atol=1e-7)

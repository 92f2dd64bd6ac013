"""The Reflection MLP: its wiring, that it starts alive, and that one without the right start dies."""

from dataclasses import replace

import pytest
import torch

from reconstruction.light.reflection_mlp import MlpShape, ReflectionMlp, fourier_features

SMALL = MlpShape(16, 4, 3, 2)


def made(shape=SMALL, expected=0.3, seed=0):
    return ReflectionMlp(shape, expected, torch.Generator().manual_seed(seed))


def rays(n=300, seed=1):
    generator = torch.Generator().manual_seed(seed)
    omega_r = torch.randn(n, 3, generator=generator)
    return torch.rand(n, 3, generator=generator) * 2.0 - 1.0, omega_r / omega_r.norm(dim=1, keepdim=True)


def n_parameters(mlp):
    return sum(parameter.numel() for parameter in mlp.parameters())


def test_the_papers_architecture_has_two_million_parameters_and_fuses_at_its_fifth_layer():
    shape = MlpShape()
    assert (shape.width, shape.layers, shape.position_order, shape.fusion_layer) == (512, 8, 12, 4)
    mlp = made(shape)
    assert [layer.in_features for layer in mlp.hidden] == [72, 512, 512, 512, 512 + 72 + 72, 512, 512, 512]
    assert 1.9e6 < n_parameters(mlp) < 2.0e6


@pytest.mark.parametrize(
    ("skip", "staged", "first", "middle"),
    [(True, True, 18, 16 + 18 + 12), (False, True, 18, 28), (True, False, 30, 34), (False, False, 30, 16)],
)
def test_every_wiring_of_table_4_gives_light_between_0_and_1(skip, staged, first, middle):
    mlp = made(replace(SMALL, skip=skip, staged=staged))
    assert (mlp.hidden[0].in_features, mlp.hidden[2].in_features) == (first, middle)
    light = mlp(*rays())
    assert light.shape == (300, 3)
    assert ((light > 0.0) & (light < 1.0)).all()


def test_values_and_gradients_follow_a_float64_twin_written_layer_by_layer():
    mlp = made()
    points, omega_r = rays()
    light = mlp(points, omega_r)
    (light**2).sum().backward()
    weights = {name: value.detach().double().requires_grad_() for name, value in mlp.named_parameters()}
    x = fourier_features(points.double(), 3)
    value = x
    for number in range(4):
        if number == 2:
            value = torch.cat([value, x, fourier_features(omega_r.double(), 2)], dim=1)
        value = torch.relu(value @ weights[f"hidden.{number}.weight"].T + weights[f"hidden.{number}.bias"])
    twin = torch.sigmoid(value @ weights["last.weight"].T + weights["last.bias"])
    (twin**2).sum().backward()
    assert (light.double() - twin).abs().max() < 1e-6
    for name, parameter in mlp.named_parameters():
        scale = weights[name].grad.abs().max()
        assert (parameter.grad.double() - weights[name].grad).abs().max() < 1e-5 * scale


def test_staged_positions_alone_decide_the_first_half():
    mlp = made()
    points, omega_r = rays()
    first = mlp._activations(points, omega_r)
    second = mlp._activations(points, -omega_r)
    assert torch.equal(first[1], second[1])
    assert not torch.equal(first[2], second[2])


@pytest.mark.parametrize("expected", [0.02, 0.3, 0.9])
def test_it_starts_alive_around_the_light_that_is_expected(expected):
    points, omega_r = rays(4000)
    mlp = made(MlpShape(64, 4, 8, 8), expected)
    assert mlp(points, omega_r).median().item() == pytest.approx(expected, abs=0.15)
    health = mlp.health(points, omega_r)
    assert health.is_alive
    assert health.dead_units < 0.05


def test_one_whose_units_never_fire_is_seen_to_be_dead():
    mlp = made()
    with torch.no_grad():
        for layer in mlp.hidden:
            layer.bias.fill_(-1e3)
    health = mlp.health(*rays())
    assert health.dead_units == 1.0
    assert health.output_std == 0.0
    assert not health.is_alive


def test_the_same_seed_gives_the_same_weights_and_another_one_others():
    same, again, other = made(seed=4), made(seed=4), made(seed=5)
    assert all(torch.equal(a, b) for a, b in zip(same.parameters(), again.parameters(), strict=True))
    assert not torch.equal(same.hidden[0].weight, other.hidden[0].weight)


@pytest.mark.parametrize("changes", [{"width": 0}, {"layers": 1}, {"position_order": 0}, {"direction_order": 25}])
def test_shapes_that_are_no_network_are_refused(changes):
    with pytest.raises(ValueError, match=next(iter(changes))):
        MlpShape(**changes)


@pytest.mark.parametrize("expected", [0.0, 1.0, float("nan")])
def test_light_that_a_sigmoid_cannot_start_from_is_refused(expected):
    with pytest.raises(ValueError, match="expected"):
        made(expected=expected)

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from reconstruction.splats.splats import AT_ONCE, FEATURES, Splats
from tests.reconstruction.splats.learned_scenes import random_splats

EYE = torch.tensor([0.5, -4.0, 1.0])


def as_doubles(splats):
    """The same, which plain torch gives the features of."""
    return Splats({name: getattr(splats, name).detach().double() for name in splats.names}, splats.panels)


def gradients(splats, given_features):
    splats.zero_grad()
    splats.features(EYE, 3).backward(given_features.to(splats.means))
    return {name: getattr(splats, name).grad for name in splats.names if getattr(splats, name).grad is not None}


def some_splats(n, seed=0):
    splats = random_splats(n)
    generator = torch.Generator().manual_seed(seed)
    with torch.no_grad():
        splats.reflectivity_logits.normal_(generator=generator)
        splats.f0_logits.normal_(generator=generator)
        splats.quats.mul_(3.0)
    splats.panels[::2] = 1
    return splats, torch.randn(n, 11, generator=generator)


def test_the_kernel_gives_what_plain_torch_gives_in_double_precision():
    splats, by_features = some_splats(300)
    exact = as_doubles(splats)
    torch.testing.assert_close(splats.features(EYE, 3).double(), exact.features(EYE.double(), 3), atol=2e-6, rtol=0.0)
    found, expected = gradients(splats, by_features), gradients(exact, by_features)
    assert set(found) == set(expected) == {"means", "quats", "sh", "reflectivity_logits", "f0_logits"}
    for name, value in found.items():
        assert (value - expected[name]).norm() <= 1e-6 * expected[name].norm(), name


def test_pieces_of_work_leave_no_seam():
    splats, by_features = some_splats(AT_ONCE + 3)
    features, whole = splats.features(EYE, 3), gradients(splats, by_features)
    tail = slice(AT_ONCE - 2, AT_ONCE + 3)
    part = Splats({name: getattr(splats, name).detach()[tail] for name in splats.names}, splats.panels[tail])
    assert torch.equal(features[tail], part.features(EYE, 3))
    for name, value in gradients(part, by_features[tail]).items():
        assert torch.equal(whole[name][tail], value), name


@given(st.floats(-200.0, 200.0), st.floats(-200.0, 200.0), st.sampled_from([0.0, 1e-9, 1e-3, 1e6]))
def test_extreme_parameters_stay_finite(reflectivity, f0, length):
    splats, _ = some_splats(4)
    with torch.no_grad():
        splats.reflectivity_logits.fill_(reflectivity)
        splats.f0_logits.fill_(f0)
        splats.quats.mul_(length / splats.quats.norm(dim=1, keepdim=True))
        splats.means[0] = EYE
    features = splats.features(EYE, 3)
    assert torch.isfinite(features).all()
    shares = features[:, FEATURES["reflectivity"].start : FEATURES["f0"].stop]
    assert shares.min() >= 0.0
    assert shares.max() <= 1.0
    assert torch.allclose(features[:, FEATURES["normal"]].norm(dim=1), torch.ones(4), atol=1e-6)
    for name, value in gradients(splats, torch.ones(4, 11)).items():
        assert torch.isfinite(value).all(), name


def test_what_is_no_number_is_seen_where_it_belongs_and_nowhere_else():
    splats, _ = some_splats(3)
    with torch.no_grad():
        splats.sh[0, 0, 0] = float("nan")
        splats.f0_logits[1, 0] = float("nan")
    is_number = torch.isfinite(splats.features(EYE, 3))
    assert not is_number[0, 0]
    assert not is_number[1, FEATURES["f0"].start]
    assert is_number.sum() == is_number.numel() - 2


@pytest.mark.parametrize("n", [0, 1])
def test_few_splats_have_features(n):
    splats, by_features = some_splats(n)
    assert splats.features(EYE, 3).shape == (n, 11)
    assert gradients(splats, by_features)["quats"].shape == (n, 4)


def test_colours_of_another_shading_are_taken_as_they_are_with_gradients():
    splats, by_features = some_splats(5)
    colours = torch.rand(5, 3, requires_grad=True)
    features = splats.features(EYE, 3, colours)
    features.backward(by_features)
    assert torch.equal(features[:, FEATURES["colour"]], colours)
    assert torch.equal(colours.grad, by_features[:, FEATURES["colour"]])
    assert splats.sh.grad is None

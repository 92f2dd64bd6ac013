"""Exposures of photos: what is learned, what cannot drift, and what a fit to one view gives."""

import pytest
import torch

from reconstruction.light.shading import display_from_linear
from reconstruction.training.photos.exposures import Exposures, fitted_gain


def test_they_start_from_what_is_known():
    known = [1.0, 0.5, 4.0]
    for channels in (1, 3):
        exposures = Exposures(known, channels)
        exposures.project()
        for number, gain in enumerate(known):
            assert exposures(number).tolist() == pytest.approx([gain] * channels, rel=1e-6)


def test_learning_finds_the_gains_and_the_scene_keeps_its_light():
    generator = torch.Generator().manual_seed(0)
    true_gains = torch.tensor([0.5, 1.0, 1.0, 2.0])
    scene = torch.rand(50, 3, generator=generator)
    photos = [gain * scene for gain in true_gains]
    exposures, light = Exposures([1.0] * 4), torch.full((50, 3), 0.5, requires_grad=True)
    for step in range(600):
        number = step % 4
        for value in (exposures.log_gains, light):
            value.grad = None
        (exposures(number) * light - photos[number]).square().mean().backward()
        with torch.no_grad():
            exposures.log_gains -= 0.3 * exposures.log_gains.grad
            light -= 10.0 * light.grad
        exposures.project()
    found = torch.cat([exposures(number) for number in range(4)]).detach()
    assert found.tolist() == pytest.approx(true_gains.tolist(), rel=0.02)
    assert torch.allclose(light, scene, atol=0.02)


def test_a_cast_that_all_gains_share_is_taken_back():
    exposures = Exposures([1.0, 2.0, 0.5, 1.0], 3)
    before = exposures.log_gains.detach().clone()
    with torch.no_grad():
        exposures.log_gains += torch.tensor([0.3, -0.2, 0.0])
        exposures.log_gains[0, 0] += 1.0
    exposures.project()
    change = exposures.log_gains.detach() - before
    assert change.mean(dim=0).abs().max() < 1e-7
    assert change[:, 0].tolist() == pytest.approx([0.75, -0.25, -0.25, -0.25], abs=1e-6)


def test_a_thousand_projections_do_not_wander():
    exposures = Exposures([3.0] * 7)
    for _ in range(1000):
        exposures.project()
    assert exposures(3).item() == pytest.approx(3.0, rel=1e-6)


def test_state_keeps_the_mean_that_is_held():
    first, second = Exposures([2.0, 4.0]), Exposures([1.0, 1.0])
    second.load_state_dict(first.state_dict())
    second.project()
    assert second(1).item() == pytest.approx(4.0, rel=1e-6)


@pytest.mark.parametrize("channels", [1, 3])
def test_the_fitted_gain_is_the_photos_own(channels):
    generator = torch.Generator().manual_seed(1)
    light = torch.rand(2000, 3, generator=generator)
    gains = torch.tensor([1.3]) if channels == 1 else torch.tensor([1.1, 0.8, 0.5])
    clean = gains * light
    photo = torch.where(clean > 1.0, 1.0, clean)  # clipped as a camera does
    photo[::7] = 1.0  # a glint that was not rendered
    found = fitted_gain(light, photo, display_from_linear(photo), channels)
    assert found.tolist() == pytest.approx(gains.tolist(), rel=1e-4)


def test_where_nothing_tells_the_gain_is_1():
    black, some = torch.zeros(500, 3), torch.full((500, 3), 0.4)
    display = display_from_linear(some)
    assert fitted_gain(black, some, display).tolist() == [1.0]
    assert fitted_gain(some, some, torch.ones(500, 3), 3).tolist() == [1.0] * 3
    assert fitted_gain(some[:20], 2.0 * some[:20], display[:20]).tolist() == [1.0]
    spoilt = some.clone()
    spoilt[0] = torch.nan
    spoilt[1] = torch.inf
    assert fitted_gain(spoilt, 2.0 * some, display).tolist() == pytest.approx([2.0])


def test_wrong_calls_are_refused():
    for known, channels in (([], 1), ([1.0, 0.0], 1), ([1.0, float("nan")], 1), ([1.0], 2)):
        with pytest.raises(ValueError, match="expected"):
            Exposures(known, channels)
    with pytest.raises(ValueError, match="expected three"):
        fitted_gain(torch.zeros(4, 3), torch.zeros(5, 3), torch.zeros(4, 3))

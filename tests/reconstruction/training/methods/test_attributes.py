"""What splats get: starts that are what they say, after the activation."""

import pytest
import torch

from reconstruction.training.methods.gaussian_shader import GaussianShaderSettings
from reconstruction.training.methods.ref_gaussian import RefGaussianSettings
from reconstruction.training.methods.ref_gs import RefGsSettings
from reconstruction.training.methods.shader import Attribute


@pytest.mark.parametrize("settings", [GaussianShaderSettings(), RefGaussianSettings(), RefGsSettings()])
def test_attributes_of_methods_start_where_they_say(settings):
    names = [each.name for each in settings.attributes()]
    assert len(set(names)) == len(names)
    for each in settings.attributes():
        learned = each.learned(400, torch.Generator().manual_seed(0))
        assert learned.shape == (400, *each.shape)
        assert float(each.value(learned).mean()) == pytest.approx(each.start, abs=1e-5 + 0.1 * each.spread)
        assert float(learned.std()) == pytest.approx(each.spread, rel=0.1, abs=1e-6)


def test_logits_are_called_logits():
    assert Attribute("metallic", (), 0.5, "sigmoid").parameter == "metallic_logits"
    assert Attribute("feature", (4,), 0.0).parameter == "feature"


def test_a_share_that_cannot_be_is_refused():
    for start in (0.0, 1.0, 2.0):
        with pytest.raises(ValueError, match="above 0 and below 1"):
            Attribute("metallic", (), start, "sigmoid")


@pytest.mark.parametrize("settings", [GaussianShaderSettings, RefGaussianSettings, RefGsSettings])
def test_settings_that_are_negative_or_no_numbers_are_refused(settings):
    for value in (-0.1, float("nan"), float("inf")):
        with pytest.raises(ValueError, match="material_rate: expected 0 or more"):
            settings(material_rate=value)

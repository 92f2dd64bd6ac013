"""The way in for methods that make light of their own: what it adds is learned, densified, kept, and read back."""

from dataclasses import replace

import pytest
import torch
from torch import nn

from planning.base.errors import InputError
from reconstruction.splats.splats import FEATURES
from reconstruction.training.config import TrainConfig
from reconstruction.training.method_registry import METHODS
from reconstruction.training.methods.shader import Shaded, Shader
from reconstruction.training.model.saved import read_model, save_model
from reconstruction.training.train import train_model

CONFIG = TrainConfig(
    method="2dgs", iterations=12, n_splats=120, max_splats=160, densify_from=0.0, densify_until=1.0, score_every_s=1e9
)


class Glossy(Shader):
    """Colours that are darkened splat by splat, and one tint of light that all of them mirror."""

    def __init__(self):
        super().__init__()
        self.tint = nn.Parameter(torch.full((3,), 0.2))

    def attributes(self, splats):
        return {"gloss_logits": torch.full((len(splats), 2), -1.0)}

    def attribute_rates(self):
        return {"gloss_logits": 1e-2}

    def colours(self, splats, position_m, degree):
        return splats.colours(position_m, degree) * torch.sigmoid(splats.gloss_logits[:, :1])

    def channels(self, splats, position_m):
        return torch.sigmoid(splats.gloss_logits)

    def forward(self, view, raster, directions, channels, splats):
        own = raster.features[..., FEATURES["colour"]]
        mirrored = self.tint.expand_as(own)
        return Shaded(own, channels[..., 1:] * mirrored, mirrored, channels[..., 1], self.tint.square().sum())

    def parameter_groups(self):
        return [{"params": [self.tint], "lr": 1e-2}]


@pytest.fixture
def glossy(monkeypatch):
    with_gloss = replace(METHODS["2dgs"], shader=lambda config, surroundings: Glossy())
    monkeypatch.setitem(METHODS, "2dgs", with_gloss)


def test_attributes_and_parameters_of_a_shader_are_learned_and_handed_on(glossy, data_set):
    trained = train_model(data_set, CONFIG)
    splats, shader = trained.model.splats, trained.model.shader
    assert splats.gloss_logits.shape == (len(splats), 2)
    assert (splats.gloss_logits.detach() != -1.0).any(dim=0).all()
    # Its penalty draws it to 0.
    assert (shader.tint.detach() < 0.2).all()


def test_a_model_with_a_shader_is_read_back_bit_by_bit(glossy, data_set, tmp_path):
    trained = train_model(data_set, CONFIG)
    save_model(trained, tmp_path / "m")
    back = read_model(tmp_path / "m").model
    mine, theirs = trained.model.state_dict(), back.state_dict()
    assert mine.keys() == theirs.keys()
    assert all(torch.equal(mine[name], theirs[name]) for name in mine)
    assert isinstance(back.shader, Glossy)


def test_a_model_whose_method_lacks_what_its_splats_have_is_refused(glossy, data_set, tmp_path, monkeypatch):
    save_model(train_model(data_set, replace(CONFIG, iterations=1)), tmp_path / "m")
    monkeypatch.setitem(METHODS, "2dgs", replace(METHODS["2dgs"], shader=None))
    with pytest.raises(InputError, match="weights of another model"):
        read_model(tmp_path / "m")

"""Mirrored light in Gaussians' own colours."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from reconstruction.exports.mesh import LEAST_COSINE, N_DIRECTIONS, baked, needs_baking, outward_directions
from reconstruction.light.config import ReflectionConfig
from reconstruction.light.photo_set import read_photo_set
from reconstruction.light.shading import display_from_linear, schlick
from reconstruction.objects.organise import organised, put_together
from reconstruction.splats.harmonic_colour import display_colours, light_of_display
from reconstruction.training.config import TrainConfig
from reconstruction.training.photos.photo_stream import PhotoStream
from reconstruction.training.train import train_model
from tests.reconstruction.training.synthetic_data_set import write_data_set

LIGHT = ReflectionConfig(environment_rows=8, steps=30, batch=512)
CONFIG = TrainConfig(
    iterations=3, n_splats=200, max_splats=250, reflections=LIGHT, score_every_s=1e9, light="environment-map"
)


@pytest.fixture(scope="module")
def data_set(tmp_path_factory):
    folder = tmp_path_factory.mktemp("baked") / "glass"
    write_data_set(folder, n=4)
    return folder


@pytest.fixture(scope="module")
def trained(data_set):
    return train_model(data_set, CONFIG)


@pytest.mark.slow
def test_under_even_light_colours_are_those_of_eq_19(trained):
    model = put_together(organised(trained), Path()).model
    model.light.light.load_state_dict(
        {name: torch.full_like(value, 0.7) for name, value in model.light.light.state_dict().items()}
    )
    directions = torch.tensor([[0.0, 0.0, 1.0]])
    light = model.light.light(torch.zeros(1, 3), directions, torch.zeros(1, dtype=torch.long))
    found = baked(organised(trained), model)
    splats = model.splats
    for component in found.components[:1]:
        values = {name: torch.from_numpy(value) for name, value in component.gaussians.values.items()}
        places = torch.from_numpy(component.gaussians.places).long()
        for eye in ([0.0, -30.0, 3.0], [12.0, -20.0, 9.0]):
            position = torch.tensor(eye)
            shown = display_colours(values["means"], values["sh"], position, 3)
            towards = torch.nn.functional.normalize(values["means"] - position, dim=1)
            fresnel = schlick(splats.f0[places], towards[:, 1].abs())
            r = splats.reflectivity[places][:, None]
            own = light_of_display(display_colours(splats.means[places], splats.sh[places], position, 3))
            expected = display_from_linear((1.0 - r) * own + r * fresnel * light).clamp(max=1.0)
            assert (shown - expected).abs().max() < 0.03


@pytest.mark.slow
@torch.no_grad()
def test_pictures_without_mirroring_come_nearer_to_those_with_it(trained, data_set):
    scene = organised(trained)
    plain = put_together(baked(scene, trained.model), Path()).model
    dull = put_together(scene, Path()).model
    dull.splats.reflectivity_logits.fill_(-20.0)
    errors = {"baked": 0.0, "dull": 0.0}
    with PhotoStream(read_photo_set(data_set), None, trained.model.origin_enu_m) as photos:
        for number in range(3):
            view = photos.frame(number).view
            truth = trained.model(view).display
            for name, model in (("baked", plain), ("dull", dull)):
                errors[name] += float(((model(view).display - truth) ** 2).mean())
    assert errors["baked"] < 0.5 * errors["dull"]


@pytest.mark.slow
@torch.no_grad()
def test_colours_of_a_lower_degree_are_fitted_with_it_and_nearer_than_those_that_are_cut(trained):
    scene = organised(trained)
    fine, fitted = (baked(scene, trained.model, degree).components[0].gaussians for degree in (3, 2))
    assert not fitted.values["sh"][:, 9:].any()
    means = torch.from_numpy(fine.values["means"])
    cut = fine.values["sh"].copy()
    cut[:, 9:] = 0.0
    errors = {"cut": 0.0, "fitted": 0.0}
    for eye in ([0.0, -30.0, 3.0], [12.0, -20.0, 9.0], [-15.0, -12.0, 2.0]):
        shown, *others = (
            display_colours(means, torch.from_numpy(sh), torch.tensor(eye), 3)
            for sh in (fine.values["sh"], cut, fitted.values["sh"])
        )
        for name, other in zip(errors, others, strict=True):
            errors[name] += float(((other - shown) ** 2).mean())
    assert errors["fitted"] < 0.7 * errors["cut"]


def test_only_panels_change_and_parts_of_a_scene_will_do(trained):
    scene = organised(trained)
    before = scene.components[0].gaussians.values["sh"].copy()
    found = baked(scene, trained.model)
    assert np.array_equal(scene.components[0].gaussians.values["sh"], before)
    assert np.array_equal(found.components[-1].gaussians.values["sh"], scene.components[-1].gaussians.values["sh"])
    one = replace(scene, components=scene.components[:1])
    again = baked(one, trained.model)
    assert np.array_equal(again.components[0].gaussians.values["sh"], found.components[0].gaussians.values["sh"])


def test_models_that_mirror_nothing_have_nothing_to_bake(data_set):
    trained = train_model(data_set, replace(CONFIG, light="harmonics", iterations=1))
    assert not needs_baking(trained.model)
    with pytest.raises(ValueError, match="panels mirror light"):
        baked(organised(trained), trained.model)


@pytest.mark.parametrize("normal", [(0.0, 0.0, 1.0), (0.0, -1.0, 0.0), (0.6, -0.64, -0.48)])
def test_directions_are_spread_evenly_before_the_panel(normal):
    found = outward_directions(torch.tensor(normal, dtype=torch.float64))
    cosines = found @ torch.tensor(normal, dtype=torch.float64)
    np.testing.assert_allclose(found.norm(dim=1), 1.0, atol=1e-12)
    assert cosines.min() >= LEAST_COSINE
    # Equal solid angles are equal steps of the cosine.
    np.testing.assert_allclose(
        np.sort(cosines)[::-1], 1 - (1 - LEAST_COSINE) * (np.arange(N_DIRECTIONS) + 0.5) / N_DIRECTIONS
    )
    assert (found - cosines[:, None] * torch.tensor(normal, dtype=torch.float64)).mean(dim=0).norm() < 0.03

"""Methods of others in the joint training: they learn, are kept, and mirror what their maps show."""

from dataclasses import replace
from pathlib import Path

import pytest
import torch

from reconstruction.light.photo_set import read_photo_set
from reconstruction.splats.splats import Splats
from reconstruction.training.config import TrainConfig, config_of
from reconstruction.training.method_registry import METHODS
from reconstruction.training.methods.ref_gaussian import RefGaussian
from reconstruction.training.methods.shader import Surroundings, covered_pixels
from reconstruction.training.methods.shaders import shader_of, with_primitive
from reconstruction.training.model.saved import read_model, save_model
from reconstruction.training.photos.photo_stream import PhotoStream
from reconstruction.training.train import train_model

BASE = TrainConfig(iterations=14, n_splats=200, max_splats=260, densify_from=0.0, score_every_s=1e9)
OTHERS = [name for name, method in METHODS.items() if not method.knows_panels]


def config_named(name, **changes):
    return replace(config_of({"method": name}, BASE, Path("test")), **changes)


@pytest.fixture(scope="module", params=OTHERS)
def trained(request, data_set):
    return train_model(data_set, config_named(request.param))


def pictures(trained, data_set):
    source = read_photo_set(data_set)
    with PhotoStream(source, None, trained.model.origin_enu_m) as photos, torch.no_grad():
        return [trained.model(photos.frame(number).view) for number in range(2)]


@pytest.mark.few(1)
def test_a_method_gets_better_in_a_few_steps_and_its_pictures_are_numbers(trained, data_set):
    assert trained.n_steps == BASE.iterations
    before, after = trained.history[0].value, trained.history[-1].value
    assert after > before + 0.2
    for picture in pictures(trained, data_set):
        for part in (picture.display, picture.reflection, picture.mirrored, picture.reflectivity):
            assert torch.isfinite(part).all()
        assert (picture.display >= 0.0).all()


@pytest.mark.few(2)
def test_its_model_is_read_back_bit_by_bit(trained, data_set, tmp_path):
    save_model(trained, tmp_path / "m")
    back = read_model(tmp_path / "m")
    assert back.record == trained.record
    for one, other in zip(pictures(trained, data_set), pictures(back, data_set), strict=True):
        assert torch.equal(one.display, other.display)


def test_all_that_a_shader_has_is_learned(trained):
    splats, shader = trained.model.splats, trained.model.shader
    begun = shader_of(trained.record.config, Surroundings(torch.zeros(0, 3, 3).numpy()))
    for (name, mine), other in zip(shader.named_parameters(), begun.parameters(), strict=True):
        assert not torch.equal(mine, other), name
    assert set(shader.attribute_rates()) == set(shader.attributes(splats))
    in_groups = {id(value) for group in shader.parameter_groups() for value in group["params"]}
    assert in_groups == {id(value) for value in shader.parameters()}


def test_pixels_meet_the_plane_of_their_splats(data_set):
    trained = train_model(data_set, config_named("ref-gs", iterations=1))
    with PhotoStream(read_photo_set(data_set), None, trained.model.origin_enu_m) as photos, torch.no_grad():
        view = photos.frame(0).view
        picture = trained.model(view)
    raster, directions = picture.raster, view.directions()
    pixels = covered_pixels(raster, directions, raster.features[..., :0])
    by_plane = pixels.points_m(raster, view.position_m)
    forward = view.cam_from_world[2, :3].float()
    depths = (raster.depths / raster.alphas.clamp(min=1e-6))[pixels.place]
    by_depth = view.position_m + pixels.directions * (depths / (pixels.directions @ forward))[:, None]
    is_closed = pixels.alphas[:, 0] > 0.9
    assert is_closed.sum() > 80
    assert (by_plane - by_depth)[is_closed].norm(dim=1).median() < 0.05


def test_where_the_mirrored_ray_meets_the_mesh_the_light_is_indirect(data_set):
    trained = train_model(data_set, config_named("ref-gaussian", iterations=1))
    model = trained.model
    with torch.no_grad():
        model.splats.attribute("indirect")[:, 0] = 3.0
    view = pictures_view(trained, data_set)
    with torch.no_grad():
        open_sky = model(view).mirrored
        # A wall all around: every mirrored ray meets it.
        half, far = torch.eye(3) * 500.0, torch.tensor([1.0, 1.0, 1.0]) * 500.0
        corners = torch.stack([-half[0] - half[1], half[0] - half[1], half[0] + half[1], half[1] - half[0]])
        walls = []
        for axis in range(3):
            turned = torch.roll(corners, axis, dims=1)
            for side in (-1.0, 1.0):
                square = turned + side * torch.roll(torch.tensor([0.0, 0.0, far[2]]), axis)
                walls += [square[[0, 1, 2]], square[[0, 2, 3]]]
        model.shader = RefGaussian(torch.stack(walls))
        walled = model(view).mirrored
    covered = walled.sum(dim=-1) > 0.0
    assert covered.any()
    assert (walled[covered] > open_sky[covered] + 0.2).all()


def pictures_view(trained, data_set):
    with PhotoStream(read_photo_set(data_set), None, trained.model.origin_enu_m) as photos:
        return photos.frame(0).view


def test_discs_become_flat_ellipsoids_and_the_same_discs_again():
    generator = torch.Generator().manual_seed(0)
    quats, scales = torch.randn(20, 4, generator=generator), 0.1 + torch.rand(20, 2, generator=generator)
    panels = torch.arange(20) % 3 - 1
    ones = torch.ones(20)
    discs = Splats.of(torch.randn(20, 3, generator=generator), quats, scales, 0.8 * ones, torch.rand(20, 3), panels)
    solid = with_primitive(discs, "ellipsoids")
    assert not solid.is_flat
    assert (solid.scales[:, 2] < discs.scales.min(dim=1).values).all()
    assert with_primitive(discs, "discs") is discs
    back = with_primitive(solid, "discs")
    camera = torch.tensor([0.0, 0.0, 50.0])
    assert torch.allclose(back.normals(camera), discs.normals(camera), atol=1e-5)
    assert torch.allclose(back.scales.sort(dim=1).values, discs.scales.sort(dim=1).values, rtol=1e-5)
    assert torch.equal(back.panels, discs.panels)

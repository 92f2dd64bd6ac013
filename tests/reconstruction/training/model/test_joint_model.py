"""The joint model: pictures of glass whose mirrored light is known, by panels and by splats."""

import copy

import numpy as np
import pytest
import torch
from torch import nn

from reconstruction.light.config import GlassLearned, ReflectionConfig
from reconstruction.light.environment_map import EnvironmentMap
from reconstruction.light.glass_light import GlassLight
from reconstruction.light.photo_set import read_photo_set
from reconstruction.light.shading import display_from_linear, reflected_directions
from reconstruction.light.training import untrained_panels
from reconstruction.splats.initialise import InitialParameters, initial_splats
from reconstruction.splats.rasterising.rasteriser import rasterise
from reconstruction.splats.sky import Sky
from reconstruction.splats.splats import FEATURES, NO_PANEL, SHAPES, Splats, logit
from reconstruction.splats.surfels import known_scene, model_origin
from reconstruction.training.layers import LAYERS
from reconstruction.training.model.joint_model import LEAST_REFLECTIVITY, SceneModel
from reconstruction.training.model.render import OF_PICTURE, render_view
from reconstruction.training.photos.photo_stream import PhotoStream, StreamSettings
from reconstruction.training.start import warm_start_splats
from tests.reconstruction.light.synthetic_folder import DIFFUSE, F0, REFLECTIVITY, far


class Known(nn.Module):
    """The light that the made folder's glass mirrors."""

    def forward(self, points, omega_r, panels=None):
        return torch.from_numpy(far(points.detach().double().numpy(), omega_r.detach().double().numpy())).float()


class Turning(nn.Module):
    """Light that changes with place and direction, with gradients to both."""

    def forward(self, points, omega_r, panels=None):
        return torch.sigmoid(3.0 * points + 2.0 * omega_r)


@pytest.fixture(scope="module")
def parts(data_set):
    source = read_photo_set(data_set)
    scene = known_scene(source)
    origin = model_origin(scene)
    splats = initial_splats(scene, source.photos, origin, InitialParameters(n_splats=3000))
    with torch.no_grad():
        splats.reflectivity_logits.fill_(float(logit(torch.tensor(REFLECTIVITY))))
        splats.f0_logits.fill_(float(logit(torch.tensor(F0))))
        display = display_from_linear(torch.tensor(DIFFUSE))
        splats.sh.zero_()
        splats.sh[:, 0] = (display - 0.5) / 0.28209479
    return source, origin, splats


@pytest.fixture
def model_of(parts):
    source, origin, splats = parts

    def made(light, geometry="panels"):
        glass = None if light is None else GlassLight(light, source.panels, GlassLearned())
        return SceneModel(splats, Sky(), glass, source.panels, origin, 1.0, geometry)

    return made


@pytest.fixture
def samples(parts):
    source, origin, _ = parts
    with PhotoStream(source, None, origin, StreamSettings()) as photos:
        yield [photos.frame(number) for number in range(len(photos.photos))]


def inside(sample):
    """Glass pixels all of whose neighbours show the same panel."""
    panels = sample.panels.numpy()
    same = panels[1:-1, 1:-1] >= 0
    for dy in (-1, 0, 1):
        for dx in (-1, 0, 1):
            same &= panels[1 + dy : panels.shape[0] - 1 + dy, 1 + dx : panels.shape[1] - 1 + dx] == panels[1:-1, 1:-1]
    return torch.from_numpy(np.pad(same, 1))


@pytest.mark.parametrize(("geometry", "within"), [("panels", 0.012), ("splats", 0.03)])
def test_glass_with_known_light_looks_as_in_its_photos(model_of, samples, geometry, within):
    model = model_of(Known(), geometry)
    checked = 0
    for sample in samples:
        with torch.no_grad():
            picture = model(sample.view)
        glass = inside(sample)
        error = (picture.display - sample.display / 255.0).abs()[glass]
        checked += len(error)
        assert error.mean() < within
        assert (picture.panels[glass] == sample.panels[glass]).float().mean() > 0.99
    assert checked > 1000


def test_place_and_normal_of_splats_are_those_of_the_panels_where_splats_lie_on_them(model_of, samples):
    for sample in samples[:3]:
        with torch.no_grad():
            by_panels = model_of(Turning())(sample.view).mirrored
            by_splats = model_of(Turning(), "splats")(sample.view).mirrored
        glass = inside(sample)
        assert (by_panels - by_splats).abs()[glass].mean() < 2e-3


def test_what_shines_through_panes_does_not_move_them(parts, samples):
    source, origin, splats = parts
    values = {name: getattr(splats, name).detach() for name in SHAPES}
    behind = {**values, "means": values["means"] + torch.tensor([0.0, 3.0, 0.0])}
    both = {name: torch.cat([value, behind[name]]) for name, value in values.items()}
    both["opacity_logits"] = torch.full((2 * len(splats),), float(logit(torch.tensor(0.4))))
    thin = Splats(both, torch.cat([splats.panels, torch.full_like(splats.panels, NO_PANEL)]))
    glass = GlassLight(Turning(), source.panels, GlassLearned())
    for sample in samples[:2]:
        with torch.no_grad():
            pictures = [
                SceneModel(thin, Sky(), glass, source.panels, origin, 1.0, geometry)(sample.view)
                for geometry in ("panels", "splats")
            ]
        shown = inside(sample) & (pictures[1].panels >= 0)
        assert shown.sum() > 50
        assert (pictures[0].mirrored - pictures[1].mirrored).abs()[shown].mean() < 5e-3


def test_gradients_go_through_place_and_normal_of_splats_only_where_these_are_asked(model_of, samples):
    exact = model_of(Turning())(samples[0].view).mirrored
    assert not exact.requires_grad
    model = model_of(Turning(), "splats")
    model.zero_grad()
    model(samples[0].view).mirrored.sum().backward()
    for value in (model.splats.quats, model.splats.means):
        assert torch.isfinite(value.grad).all()
        assert value.grad.abs().max() > 0.0


def test_reflectivity_counts_only_where_a_panel_mirrors(model_of, samples):
    picture = model_of(Known())(samples[0].view)
    nowhere = picture.panels < 0
    assert nowhere.any()
    assert (picture.reflectivity[nowhere] == 0.0).all()
    assert (picture.reflection[nowhere] == 0.0).all()
    own = picture.raster.features[..., FEATURES["colour"]]
    sky = picture.diffuse - own
    assert (sky[nowhere] >= 0.0).all()


def test_glass_behind_a_wide_frame_mirrors_by_its_share_and_draws_the_frame_back(parts, samples):
    # A frame finer than a pixel is drawn a pixel wide, and may weigh most where nearly all that is seen is glass.
    source, origin, splats = parts
    values = {name: getattr(splats, name).detach() for name in SHAPES}
    nearer = values["means"] - 0.05 * (values["means"] - samples[0].view.position_m)
    frame = {**values, "means": nearer, "opacity_logits": torch.full((len(splats),), float(logit(torch.tensor(0.7))))}
    both = {name: torch.cat([value, frame[name]]) for name, value in values.items()}
    covered = Splats(both, torch.cat([splats.panels, torch.full_like(splats.panels, NO_PANEL)]))
    light = GlassLight(Turning(), source.panels, GlassLearned())
    picture = SceneModel(covered, Sky(), light, source.panels, origin, 1.0, "splats")(samples[0].view)
    blended = picture.raster.features[..., FEATURES["reflectivity"]].squeeze(-1)
    is_frame = inside(samples[0]) & (picture.panels < 0) & (blended > LEAST_REFLECTIVITY)
    assert is_frame.sum() > 50
    assert torch.equal(picture.reflectivity[is_frame], blended[is_frame])
    assert (picture.reflection[is_frame] > 0.0).all()
    picture.reflection[is_frame].sum().backward()
    assert (covered.opacity_logits.grad[len(splats) :] <= 0.0).all()
    assert (covered.opacity_logits.grad[len(splats) :] < 0.0).any()


class Even(nn.Module):
    """The same light from everywhere."""

    def forward(self, points, omega_r, panels=None):
        return torch.full_like(points, LIGHT)


LIGHT = 0.5


def test_where_glass_and_frame_share_a_pixel_each_is_shaded_for_itself(parts, samples):
    source, origin, splats = parts
    of_glass, of_frame = torch.tensor(DIFFUSE), torch.tensor([0.6, 0.5, 0.4])
    is_frame = torch.arange(len(splats)) % 2 == 0
    values = {name: getattr(splats, name).detach().clone() for name in SHAPES}
    values["sh"][is_frame, 0] = (display_from_linear(of_frame) - 0.5) / 0.28209479
    values["f0_logits"][is_frame] = 2.0
    mixed = Splats(values, torch.where(is_frame, NO_PANEL, splats.panels))
    model = SceneModel(
        mixed, Sky(), GlassLight(Even(), source.panels, GlassLearned()), source.panels, origin, 1.0, "splats"
    )
    view, shares = samples[0].view, torch.stack([is_frame, (~is_frame) & (splats.panels >= 0)], dim=1).float()
    with torch.no_grad():
        picture = model(view)
        drawn = splats.means, splats.quats, splats.scales, splats.opacities
        of_pixel = rasterise(*drawn, shares, view).features
    cosines = (view.directions() * torch.from_numpy(source.panels.normals_enu[0]).float()).sum(dim=-1).abs()
    fresnel = F0 + (1.0 - F0) * (1.0 - cosines[..., None]) ** 5
    mirrors = (1.0 - REFLECTIVITY) * of_glass + REFLECTIVITY * fresnel * LIGHT
    expected = of_pixel[..., :1] * of_frame + of_pixel[..., 1:] * mirrors
    at = inside(samples[0]) & (of_pixel.sum(dim=-1) > 0.95)
    is_shared = at & (of_pixel.min(dim=-1).values > 0.2)
    assert is_shared.sum() > 50
    blended, whole = picture.raster.features, of_pixel.sum(dim=-1, keepdim=True)
    found = blended[..., FEATURES["colour"]] + picture.reflection
    assert (found - expected).abs()[is_shared].max() < 0.01
    # With c and R blended each for itself, much of the frame's light is lost.
    reflectivity = blended[..., FEATURES["reflectivity"]]
    colours = of_pixel[..., :1] * of_frame + of_pixel[..., 1:] * of_glass
    as_maps = (1.0 - reflectivity / whole) * colours + picture.reflection
    assert (as_maps - expected).abs()[is_shared].mean() > 0.05


def test_parts_add_up_and_exposure_and_vignetting_come_last(model_of, samples):
    model = model_of(Known())
    view = samples[0].view
    with torch.no_grad():
        picture = model(view, 0.5)
        assert torch.allclose(picture.light, picture.diffuse + picture.reflection)
        assert torch.allclose(picture.display, display_from_linear(0.5 * picture.light))
        model.corner_loss.fill_(0.3)
        darker = model(view, 0.5)
    ratio = darker.display / picture.display
    assert ratio[15, 20].min() > 0.995
    assert ratio[0, 0].max() < ratio[15, 20].min()


def test_without_light_all_is_the_splats_own(model_of, samples):
    picture = model_of(None)(samples[0].view)
    assert (picture.reflectivity == 0.0).all()
    assert (picture.panels == -1).all()


def test_a_window_is_the_part_of_the_picture(model_of, samples):
    model, view = model_of(Known()), samples[0].view
    with torch.no_grad():
        whole = model(view)
        window = model(view.cropped(9, 8, 20, 15))
    assert torch.allclose(window.raster.features, whole.raster.features[8:23, 9:29], atol=1e-6)
    inner = (slice(1, -1), slice(1, -1))
    assert torch.allclose(window.display[inner], whole.display[8:23, 9:29][inner], atol=1e-5)


def test_pictures_are_the_same_in_strips(model_of, samples, monkeypatch):
    model, view = model_of(Known()), samples[0].view
    whole = render_view(model, view, tuple(LAYERS))
    monkeypatch.setattr("reconstruction.training.model.render.AT_ONCE_PX", 7 * view.width_px)
    strips = render_view(model, view, tuple(LAYERS))
    assert np.abs(strips.display - whole.display).mean() < 2e-3
    for name in ("alpha", "depth", "normals"):
        finite = np.isfinite(whole.layers[name])
        np.testing.assert_allclose(strips.layers[name][finite], whole.layers[name][finite], atol=1e-4)


def test_every_layer_that_is_named_can_be_rendered():
    assert set(OF_PICTURE) == set(LAYERS)


def test_panes_that_light_was_learned_with_are_handed_over(parts, samples):
    source, origin, splats = copy.deepcopy(parts)
    generator = torch.Generator().manual_seed(0)
    means = 0.1 + 0.2 * torch.rand(len(source.panels.corners_enu_m), 3, generator=generator)
    panels = untrained_panels(source.panels, "environment-map", ReflectionConfig(diffuse_degree=1), means, generator)
    with torch.no_grad():
        panels.reflectivity.copy_(torch.randn(panels.reflectivity.shape, generator=generator))
        panels.base_reflectance.copy_(torch.randn(panels.base_reflectance.shape, generator=generator))
        panels.diffuse.coefficients.copy_(0.3 * torch.randn(panels.diffuse.coefficients.shape, generator=generator))
    cameras = np.array([photo.pose.position_enu_m for photo in source.photos])
    warm_start_splats(panels, splats, source.panels, origin, cameras)
    numbers = splats.panels.long()
    glass = numbers >= 0
    assert glass.sum() > 1000
    assert torch.allclose(splats.reflectivity[glass], torch.sigmoid(panels.reflectivity[numbers[glass], 0]))
    assert torch.allclose(splats.f0[glass], torch.sigmoid(panels.base_reflectance[numbers[glass]]))
    position = torch.from_numpy(cameras[0] - origin).float()
    towards = nn.functional.normalize(splats.means.detach()[glass] - position, dim=1)
    normals = torch.from_numpy(source.panels.normals_enu).float()[numbers[glass]]
    middle = torch.from_numpy(source.panels.middle_enu_m - origin).float()
    points = (splats.means.detach()[glass] - middle) / source.panels.half_side_m
    with torch.no_grad():
        expected = panels.diffuse(points, reflected_directions(towards, normals), numbers[glass])
        found = splats.colours(position)[glass]
    assert (found - expected).abs().mean() < 0.01
    assert isinstance(panels.light.light, EnvironmentMap)

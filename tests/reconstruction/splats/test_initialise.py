import numpy as np
import pytest
import torch

from planning.base.errors import InputError
from planning.geo.mesh import empty_mesh, from_corners
from reconstruction.base.cameras import Intrinsics, Pose, PosedPhoto
from reconstruction.splats.initialise import InitialParameters, initial_splats
from reconstruction.splats.rasterising.rasteriser import rasterise
from reconstruction.splats.rasterising.views import View
from reconstruction.splats.splats import FEATURES
from reconstruction.splats.surfels import KnownScene, model_origin

LENS = Intrinsics(60, 45, 54.0, 54.0, 30.0, 22.5)
FRAME_M = 0.1


def quad(a, b, c, d):
    return [[a, b, c], [a, c, d]]


def facade():
    """Six panes of 1.9 m in a wall of 6 m x 4 m in the plane y = 0, frames between them, far from ENU's origin."""
    panes, walls = [], quad((0, 0.01, 0), (6, 0.01, 0), (6, 0.01, 4), (0, 0.01, 4))
    for row in range(2):
        for column in range(3):
            x, z, gap = 2.0 * column, 2.0 * row, FRAME_M / 2
            a, b, c, d = x + gap, x + 2.0 - gap, z + gap, z + 2.0 - gap
            panes.append([(a, 0, c), (b, 0, c), (b, 0, d), (a, 0, d)])
    shift = np.array([300.0, -200.0, 50.0])
    return np.array(panes, float) + shift, from_corners(np.array(walls, float) + shift), shift


def photos_of(shift, n=5):
    made = []
    for number in range(n):
        position = shift + np.array((1.0 + number, -7.0, 1.5 + 0.3 * number))
        made.append(PosedPhoto(f"{number}.png", None, LENS, Pose.looking(position, 2.0 * (2 - number), 0.0)))
    return tuple(made)


def of_points(points, rgb):
    return KnownScene(np.zeros((0, 4, 3)), empty_mesh(), points, rgb)


@pytest.fixture(scope="module")
def scene():
    corners, mesh, shift = facade()
    rng = np.random.default_rng(0)
    points = np.column_stack([rng.uniform(0, 6, 3000), np.zeros(3000), rng.uniform(0, 4, 3000)]) + shift
    left = points[:, 0] < shift[0] + 3.0
    rgb = np.where(left[:, None], (200, 40, 40), (40, 40, 200)).astype(np.uint8)
    return KnownScene(corners, mesh, points, rgb), photos_of(shift), shift


@pytest.fixture(scope="module")
def splats(scene):
    known, photos, _ = scene
    return initial_splats(known, photos, model_origin(known), InitialParameters(n_splats=1500))


def test_the_budget_is_met(splats):
    assert 1350 <= len(splats) <= 1500


def test_splats_are_centred_on_the_model(splats):
    assert splats.means.abs().max() < 10.0


def test_splats_of_panes_are_in_their_planes_and_know_their_panel(scene, splats):
    known, _, _ = scene
    glass = splats.panels >= 0
    assert glass.float().mean() > 0.5
    places = splats.means.detach().numpy()[glass] + model_origin(known)
    corners = known.corners_enu_m[splats.panels[glass].numpy()]
    assert np.abs(places[:, 1] - corners[:, 0, 1]).max() < 1e-4
    assert (places[:, 0] > corners[:, 0, 0]).all()
    assert (places[:, 0] < corners[:, 1, 0]).all()
    assert sorted(splats.panels.unique().tolist()) == [-1, 0, 1, 2, 3, 4, 5]
    normals = splats.normals(torch.tensor([0.0, -50.0, 0.0])).detach()[glass]
    assert torch.allclose(normals, torch.tensor([0.0, -1.0, 0.0]).expand_as(normals), atol=1e-6)


def test_splats_of_frames_are_as_narrow_as_the_frame(splats):
    frame = splats.panels < 0
    inner = frame & (splats.means[:, 0].abs() < 2.8) & (splats.means[:, 2].abs() < 1.8)
    assert inner.sum() > 20
    assert splats.scales.detach()[inner].min(dim=1).values.max() < 0.8 * FRAME_M


def test_pictures_of_the_first_splats_are_solid_and_show_each_pane_as_itself(scene, splats):
    known, photos, _ = scene
    view = View.of(photos[2], model_origin(known))
    with torch.no_grad():
        features = splats.features(view.position_m, 0)
        raster = rasterise(
            splats.means, splats.quats, splats.scales, splats.opacities, features, view, labels=splats.panels
        )
    rays = view.directions().numpy().reshape(-1, 3)
    position = view.position_m.numpy() + model_origin(known)
    met = position + rays * ((known.corners_enu_m[0, 0, 1] - position[1]) / rays[:, 1])[:, None]
    truth = np.full(len(rays), -1)
    for number, corners in enumerate(known.corners_enu_m):
        inside = (met >= corners.min(axis=0) - 1e-9) & (met <= corners.max(axis=0) + 1e-9)
        truth[inside[:, 0] & inside[:, 2]] = number
    truth = truth.reshape(45, 60)
    glass = truth >= 0
    assert glass.mean() > 0.3
    assert raster.alphas.numpy()[glass].min() > 0.9
    assert raster.alphas.numpy()[glass].mean() > 0.97
    assert (raster.labels.numpy() == truth)[glass].mean() > 0.95
    depths = (raster.depths / raster.alphas).numpy()[glass]
    along = ((met - position) @ photos[2].pose.forward_enu).reshape(45, 60)[glass]
    assert np.abs(depths - along).max() < 0.05
    reflectivity = raster.features[..., FEATURES["reflectivity"]][..., 0].numpy()
    assert reflectivity[glass].mean() > 0.7


def test_colours_are_those_of_the_next_points(splats):
    colours = splats.sh.detach()[:, 0] * 0.28209479 + 0.5
    left = splats.means[:, 0] < -0.3
    assert torch.allclose(colours[left], torch.tensor([200.0, 40.0, 40.0]) / 255.0, atol=1e-5)
    assert torch.allclose(colours[splats.means[:, 0] > 0.3], torch.tensor([40.0, 40.0, 200.0]) / 255.0, atol=1e-5)


def test_without_points_photos_tell_the_colours(scene):
    known, photos, _ = scene
    bare = KnownScene(known.corners_enu_m, known.mesh, np.zeros((0, 3)), np.zeros((0, 3), np.uint8))
    teal = np.broadcast_to(np.array([0, 128, 128], np.uint8), (45, 60, 3))
    origin, parameters = model_origin(bare), InitialParameters(n_splats=200)
    coloured = initial_splats(bare, photos, origin, parameters, pictures=lambda photo: teal)
    grey = initial_splats(bare, photos, origin, parameters)
    assert torch.allclose(
        coloured.sh[:, 0].median(dim=0).values * 0.28209479 + 0.5, torch.tensor([0.0, 0.502, 0.502]), atol=1e-3
    )
    assert torch.allclose(grey.sh[:, 0] * 0.28209479 + 0.5, torch.tensor(128 / 255), atol=1e-5)


def test_points_alone_are_a_scene_too(scene):
    known, photos, _ = scene
    cloud = of_points(known.points_enu_m, known.rgb)
    found = initial_splats(cloud, photos, model_origin(cloud), InitialParameters(n_splats=400))
    assert 300 <= len(found) <= 400
    assert (found.panels == -1).all()
    assert torch.allclose(found.opacities, torch.tensor(0.5), atol=1e-5)
    assert found.normals(torch.tensor([0.0, -50.0, 0.0])).detach()[:, 1].median() < -0.99


def test_points_behind_glass_are_what_it_mirrors_and_are_left_out(scene):
    known, photos, shift = scene
    rng = np.random.default_rng(1)
    behind = shift + np.column_stack([rng.uniform(1, 5, 500), rng.uniform(3, 8, 500), rng.uniform(1, 3, 500)])
    before = behind * (1, -1, 1) + (0, 2 * shift[1], 0)
    for cloud, expected in ((behind, 0), (before, 50)):
        mixed = KnownScene(known.corners_enu_m, known.mesh, cloud, np.full((500, 3), 99, np.uint8))
        found = initial_splats(mixed, photos, model_origin(mixed), InitialParameters(n_splats=600))
        loose = (found.means[:, 1].abs() > 1.0).sum()
        assert loose == 0 if expected == 0 else loose > expected


def test_panels_that_no_photo_faces_get_no_splats(scene):
    known, photos, _ = scene
    turned = known.corners_enu_m.copy()
    turned[0] = turned[0, ::-1]
    found = initial_splats(
        KnownScene(turned, known.mesh, known.points_enu_m, known.rgb),
        photos,
        model_origin(known),
        InitialParameters(600),
    )
    assert sorted(found.panels.unique().tolist()) == [-1, 1, 2, 3, 4, 5]


def test_more_than_photos_can_tell_apart_is_not_placed(scene):
    known, photos, _ = scene
    cloud = of_points(known.points_enu_m[:50], known.rgb[:50])
    assert len(initial_splats(cloud, photos, model_origin(cloud), InitialParameters(n_splats=5000))) <= 50


def test_the_ground_is_level_where_nothing_else_is(scene):
    known, _, shift = scene
    down = [PosedPhoto("0", None, LENS, Pose.looking(shift + np.array((3.0, -9.0, 6.0)), 0.0, -40.0))]
    grounded = KnownScene(known.corners_enu_m, known.mesh, known.points_enu_m, known.rgb, float(shift[2]))
    found = initial_splats(grounded, down, model_origin(grounded), InitialParameters(n_splats=600))
    low = (found.means[:, 2] < -1.99) & ((found.means[:, 1] - 0.01).abs() > 1e-3)
    assert low.sum() > 50
    assert (found.means[low, 1] < 0.0).sum() > 50
    in_the_shadow = low & (found.means[:, 0].abs() < 1.5) & (found.means[:, 1] > 0.1) & (found.means[:, 1] < 10.0)
    assert in_the_shadow.sum() == 0
    assert torch.allclose(found.normals(torch.tensor([0.0, 0.0, 50.0])).detach()[low], torch.tensor([0.0, 0.0, 1.0]))
    assert torch.allclose(found.opacities[low], torch.tensor(0.5), atol=1e-5)


def test_the_same_seed_gives_the_same_splats(scene, splats):
    known, photos, _ = scene
    again = initial_splats(known, photos, model_origin(known), InitialParameters(n_splats=1500))
    assert torch.equal(again.means, splats.means)
    assert torch.equal(again.sh, splats.sh)


def test_origins_come_from_panels_points_or_mesh():
    corners, mesh, shift = facade()
    none, grey = np.zeros((0, 3)), np.zeros((0, 3), np.uint8)
    assert np.allclose(model_origin(KnownScene(corners, mesh, none, grey)), shift + np.array((3, 0, 2)))
    assert np.allclose(model_origin(of_points(np.ones((3, 3)), grey)), 1.0)
    assert np.allclose(
        model_origin(KnownScene(np.zeros((0, 4, 3)), mesh, none, grey)), shift + np.array((3, 0.01, 2)), atol=1.0
    )
    with pytest.raises(InputError, match="no panels, no mesh and no points"):
        model_origin(of_points(none, grey))


def test_what_cannot_be_started_from_is_said(scene):
    known, photos, shift = scene
    with pytest.raises(InputError, match="there are no photos"):
        initial_splats(known, (), model_origin(known))
    away = [PosedPhoto("0", None, LENS, Pose.looking(shift + np.array((3.0, -7.0, 2.0)), 180.0, 0.0))]
    with pytest.raises(InputError, match="seen by one of the 1 photos"):
        initial_splats(known, away, model_origin(known))
    with pytest.raises(InputError, match="within 1000 m"):
        initial_splats(of_points(known.points_enu_m, known.rgb), photos, np.array([1e6, 0.0, 0.0]))


@pytest.mark.parametrize(
    "wrong", [{"n_splats": 0}, {"width": 0.0}, {"opacity": 0.003}, {"loose_opacity": 1.0}, {"reach_m": np.nan}]
)
def test_settings_that_cannot_be_are_wrong_calls(wrong):
    with pytest.raises(ValueError, match="expected"):
        InitialParameters(**wrong)

"""The ground of pictures: terrain where the glass shows the difference, level ground where it does not."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.geo.height_field import HeightField
from planning.geo.ray_casting import RayCaster
from planning.site.terrain import terrain_of
from reconstruction.base.cameras import Intrinsics
from reconstruction.scenes.effects.registry import decide_effects
from reconstruction.scenes.parameters import RenderSettings
from reconstruction.scenes.photos.flight_views import square_photos, square_shots
from reconstruction.scenes.photos.renderer import Renderer
from reconstruction.scenes.record import Layer
from reconstruction.scenes.world.build import build_scene
from reconstruction.scenes.world.ground import CAMERA_M, MirroredTerrain, SceneGround, decide_ground, scene_ground
from reconstruction.scenes.world.look import Look
from tests.planning.plan_cases import kiosk
from tests.planning.site.test_terrain import hill_site, slope, terrain

LOOK = Look(street_m=20.0)
LENS = Intrinsics(160, 120, 128.0, 128.0, 80.0, 60.0)


def bodies(scene, *names):
    return [body for body in scene.bodies if body.name in names]


def step(x, y):
    """Level to 40 m south of the building, and 3 m lower from there on."""
    return np.where(y < -40.0, -3.0, 0.0)


@pytest.mark.long
def test_flat_terrain_is_off_and_the_scene_is_that_of_level_ground():
    flat = hill_site(lambda x, y: 0.0 * x)
    decision = decide_ground(flat)
    assert (decision.on, decision.size) == (False, 0.0)
    scene, plain = (
        build_scene(flat, LOOK, 3),
        build_scene(replace(flat, site=replace(flat.site, terrain=None)), LOOK, 3),
    )
    assert scene.terrain == decision
    assert plain.terrain is None
    for ours, level in zip(scene.bodies, plain.bodies, strict=True):
        assert ours.name == level.name
        np.testing.assert_array_equal(ours.mesh.corners_enu_m, level.mesh.corners_enu_m)


def test_the_angle_by_which_the_mirrored_ground_moves_is_that_of_the_closed_form():
    """Lower by 3 m from 40 m on before panes whose middles are 4.5 m up: by the triangle, not by its first order."""
    decision = decide_ground(hill_site(step))
    away_m = 40.0 + CAMERA_M + 2.0  # the first node beyond the edge, or the next one
    true_deg = np.degrees(np.arctan2(4.5 + 3.0, away_m) - np.arctan2(4.5, away_m))
    assert decision.on
    assert decision.size == pytest.approx(true_deg, rel=0.05)
    assert "up to 3.0 m" in decision.reason
    assert not decide_ground(hill_site(lambda x, y: 0.05 * step(x, y))).on


def test_the_user_decides_by_the_effect_first_and_else_by_the_site():
    model = hill_site()
    off = replace(model, site=replace(model.site, terrain=replace(model.site.terrain, use="off")))
    assert decide_ground(model).on
    assert not decide_ground(off).on
    assert decide_ground(off).decided_by == "user"
    assert decide_ground(off, "on").on
    assert not decide_ground(model, "off").on
    assert scene_ground(off, decide_ground(off, "on")).z_m is not None
    assert decide_ground(kiosk()) is None


def test_the_ground_is_the_terrain_and_what_stands_on_it_stands_on_it():
    scene = build_scene(hill_site(), LOOK, 3)
    (asphalt,) = bodies(scene, "asphalt")
    points = np.random.default_rng(1).uniform(-55.0, 55.0, (200, 2))
    down = np.tile([0.0, 0.0, -1.0], (200, 1))
    met = 500.0 - RayCaster(asphalt.mesh).cast(np.c_[points, np.full(200, 500.0)], down).distance_m
    np.testing.assert_allclose(met, slope(points[:, 0], points[:, 1]), atol=1e-3)
    for body in bodies(scene, "pavement", "markings"):
        above = body.mesh.vertices_enu_m[:, 2] - ground_of(scene).heights_m(body.mesh.vertices_enu_m[:, :2])
        assert above.min() >= 0.019
        assert above.max() < 0.2
    (trunks,) = bodies(scene, "trunks")
    foot = trunks.mesh.vertices_enu_m
    above = foot[:, 2] - ground_of(scene).heights_m(foot[:, :2])
    assert above.min() == pytest.approx(0.0, abs=0.05)
    for name, mesh in zip(scene.site.site.obstacles, scene.site.obstacles, strict=True):
        if "opposite" in name.id:
            xy = mesh.vertices_enu_m[:, :2]
            assert mesh.vertices_enu_m[:, 2].min() <= ground_of(scene).heights_m(xy).min() + 1e-6
    assert all(body.layer is Layer.GROUND for body in bodies(scene, "asphalt", "pavement"))


def ground_of(scene):
    model = scene.site
    return scene_ground(model, scene.terrain)


@given(st.integers(0, 2**32 - 1))
def test_what_is_laid_on_terrain_lies_above_it_everywhere(seed):
    rng = np.random.default_rng(seed)
    x, y = (np.sort(rng.uniform(-30.0, 30.0, n)) for n in (6, 9))
    ground = SceneGround(0.0, x, y, rng.normal(0.0, 2.0, (9, 6)))
    turn, (width, height) = rng.uniform(0.0, 2.0 * np.pi), rng.uniform(0.2, 20.0, 2)
    axes = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    rectangle = rng.uniform(-20.0, 20.0, 2) + np.array([[0, 0], [width, 0], [width, height], [0, height]]) @ axes
    laid = ground.draped(rectangle, 0.02)
    corners = laid.corners_enu_m
    assert (np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2] > 0.0).all()
    weights = rng.dirichlet(np.ones(3), len(corners))
    points = np.einsum("tk,tkx->tx", weights, corners)
    assert (points[:, 2] - ground.heights_m(points[:, :2])).min() > -0.25
    assert np.median(points[:, 2] - ground.heights_m(points[:, :2])) >= 0.02


@given(st.integers(0, 2**32 - 1))
def test_heights_are_those_of_the_triangles_that_are_drawn(seed):
    rng = np.random.default_rng(seed)
    x, y = (np.cumsum(rng.uniform(0.5, 5.0, n)) for n in (5, 4))
    ground = SceneGround(0.0, x, y, rng.normal(0.0, 5.0, (4, 5)))
    corners = ground.mesh(np.zeros((4, 2))).corners_enu_m
    weights = rng.dirichlet(np.ones(3), len(corners))
    points = np.einsum("tk,tkx->tx", weights, corners)
    np.testing.assert_allclose(ground.heights_m(points[:, :2]), points[:, 2], atol=1e-9)


def test_holes_are_filled_and_the_ground_goes_on_beyond_the_terrain():
    model = hill_site()
    field = terrain(slope)
    nodes = np.arange(-60.0, 60.1, 2.0)
    x, y = np.meshgrid(nodes, nodes)
    z = slope(x, y)
    z[10:14, 20:30] = np.nan
    holed = terrain_of(HeightField(-60.0, -60.0, 2.0, z), z, z, use="on")
    model = replace(model, site=replace(model.site, terrain=holed))
    ground = scene_ground(model, decide_ground(model))
    assert np.isfinite(ground.z_m).all()
    (west, east), south = (
        ground.heights_m(np.array([[-1400.0, 0.0], [1400.0, 0.0]])),
        ground.heights_m(np.array([[0.0, -1400.0]])),
    )
    assert (west, east) == pytest.approx((3.0, 3.0))
    assert south == pytest.approx(-3.0)
    nothing = replace(model, site=replace(model.site, terrain=replace(field, west_south_m=(5000.0, 5000.0))))
    decision = decide_ground(nothing, "on")
    assert scene_ground(nothing, decision).z_m is None
    assert MirroredTerrain().assess(nothing).reason == "the terrain has no heights around the glass"


def test_square_photos_are_taken_from_above_the_terrain(tmp_path):
    model = hill_site(lambda x, y: np.clip(-y, 0.0, 30.0), use="on")
    scene = build_scene(model, LOOK, 1)
    for shot in square_shots(scene, LENS, 6):
        _, y, z = shot.view.position_enu_m
        assert z >= np.clip(-y, 0.0, 30.0) + 1.9


@pytest.mark.slow
def test_pictures_show_the_terrain_in_the_glass_only_where_it_is_on(tmp_path):
    """The street falls away before the building: with it, the panes mirror other ground."""
    model = hill_site(step)
    photos = square_photos(build_scene(model, LOOK, 5), LENS, 1, tmp_path)
    pictures = {}
    for setting in ("auto", "on", "off"):
        scene = build_scene(model, LOOK, 5, setting)
        settings = RenderSettings(samples=1)
        decided = decide_effects(scene, photos, settings)
        assert next(iter(decided)) == "terrain"
        assert decided["terrain"].on == (setting != "off")
        pictures[setting] = Renderer(scene, settings.decided(decided.values())).render(photos[0]).reflection
    np.testing.assert_array_equal(pictures["auto"], pictures["on"])
    assert np.abs(pictures["on"] - pictures["off"]).max() > 0.02

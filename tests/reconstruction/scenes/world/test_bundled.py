"""Bundled scenes are what they say, the same for the same seed, and can be flown."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields
from functools import cache

import numpy as np
import pytest

from planning.base.errors import InputError
from planning.coverage.sections import panel_frames
from planning.geo.mesh import TriangleMesh, from_corners, join
from planning.geo.ray_casting import RayCaster
from planning.site.free_space import free_space
from planning.site.records import panel_corners, panel_triangles
from reconstruction.scenes.record import Interiors, Layer, Scene
from reconstruction.scenes.world.bundled import SCENES, bundled_scene
from tests.slow import slow

scene_of = cache(bundled_scene)

NAMES = sorted(SCENES)
MOST_TRIANGLES = 60_000


def arrays(scene: Scene) -> Iterator[np.ndarray]:
    yield from (scene.panes.corners_enu_m, scene.panes.tilts_rad, scene.panes.bows_per_m)
    yield from (scene.panes.glass, scene.panes.rooms, scene.sky.panorama)
    yield from (getattr(scene.interiors, field.name) for field in fields(Interiors))
    for body in scene.bodies:
        yield from (body.mesh.vertices_enu_m, body.mesh.triangles, np.array(body.albedo))
        if body.texture is not None:
            yield body.texture.picture


def are_equal(one: Scene, other: Scene) -> bool:
    a, b = list(arrays(one)), list(arrays(other))
    return len(a) == len(b) and all(map(np.array_equal, a, b)) and one.site.site == other.site.site


def mirrored(scene: Scene, mesh: TriangleMesh) -> np.ndarray:
    """Distances at which rays that fall on the panes' middles from 30 degrees above, mirrored, meet a mesh."""
    panels = panel_frames(scene.panes.corners_enu_m)
    directions = panels.normals - [0.0, 0.0, np.tan(np.radians(15.0))]
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return RayCaster(mesh).cast(panels.centroids + 0.1 * panels.normals, directions).distance_m


def bodies_of(scene: Scene, *layers: Layer) -> TriangleMesh:
    return join([body.mesh for body in scene.bodies if body.layer in layers])


@pytest.mark.slow
@pytest.mark.parametrize("name", [name if name in ("planar", "court") else slow(name) for name in NAMES])
def test_the_same_seed_gives_the_same_scene(name: str) -> None:
    assert are_equal(scene_of(name), bundled_scene(name))
    assert scene_of(name).name == name == scene_of(name).site.site.name


@pytest.mark.slow
@pytest.mark.parametrize("name", ["planar", "curved-far"])
def test_another_seed_gives_other_panes_surroundings_and_clouds(name: str) -> None:
    one, other = scene_of(name), bundled_scene(name, 1)
    for a, b in ((one.panes.tilts_rad, other.panes.tilts_rad), (one.sky.panorama, other.sky.panorama)):
        assert np.abs(a - b).mean() > 0.1 * a.std()
    assert not are_equal(one, other)
    assert (one.site.site != other.site.site) == name.isalpha(), "where other buildings stand opposite"


@pytest.mark.few(1)
@pytest.mark.parametrize("name", NAMES)
def test_everything_is_finite_and_sends_back_no_more_light_than_it_gets(name: str) -> None:
    scene = scene_of(name)
    assert all(np.isfinite(array).all() for array in arrays(scene))
    for body in scene.bodies:
        brightest = np.array(body.albedo)
        if body.texture is not None:
            picture = body.texture.picture
            assert picture.dtype == np.float32
            assert picture.min() >= 0.0
            brightest = brightest * picture.max(axis=(0, 1))
        assert (brightest <= 1.0).all()
    panorama = scene.sky.panorama
    assert panorama.dtype == np.float32
    assert panorama.shape[1:] == (2 * panorama.shape[0], 3)
    assert 0.0 <= panorama.min() <= panorama.max() <= 1.0
    assert all(
        array.min() >= 0.0 for array in (scene.panes.rooms, scene.interiors.lights, scene.interiors.blind_lights)
    )
    assert scene.panes.rooms.max() <= 1.0
    assert ((scene.panes.glass >= 0) & (scene.panes.glass < len(scene.glasses))).all()
    assert sum(len(body.mesh.triangles) for body in scene.bodies) + 2 * len(scene.panes.glass) < MOST_TRIANGLES


@pytest.mark.few(2)
@pytest.mark.parametrize("name", NAMES)
def test_panes_are_the_panels_and_can_be_flown_before(name: str) -> None:
    scene = scene_of(name)
    np.testing.assert_array_equal(scene.panes.corners_enu_m, panel_corners(scene.site.site))
    panels = panel_frames(scene.panes.corners_enu_m)
    space = free_space(scene.site, 10.0)
    before = panels.centroids + 11.0 * panels.normals
    highest = before[before[:, 2] > before[:, 2].max() - 0.5]
    assert len(highest) >= 10
    assert space.is_allowed(highest).mean() > 0.7, "but in the corner of the court"
    # Outwards there is the street, inwards the building.
    walls = RayCaster(bodies_of(scene, Layer.BUILDING))
    assert np.isfinite(walls.cast(panels.centroids - 0.01 * panels.normals, -panels.normals).distance_m).all()


@pytest.mark.long
@pytest.mark.parametrize("name", ["planar", "curved", "planar-far", "curved-far"])
def test_facades_have_the_papers_proportions(name: str) -> None:
    panels = panel_frames(scene_of(name).panes.corners_enu_m)
    assert len(panels) == 160
    widths = np.linalg.norm(panels.corners[:, 1] - panels.corners[:, 0], axis=1)
    assert widths == pytest.approx(1.5, abs=0.07)
    assert np.ptp(panels.corners[..., 2]) == pytest.approx(20.0, abs=0.1)
    turn = np.degrees(np.ptp(np.arctan2(panels.normals[:, 0], panels.normals[:, 1])))
    assert turn == pytest.approx(0.0 if name.startswith("planar") else 62.8, abs=0.2)


@pytest.mark.long
@pytest.mark.parametrize("name", ["planar", "curved"])
def test_far_scenes_differ_by_what_is_near_alone(name: str) -> None:
    near, far = scene_of(name), scene_of(f"{name}-far")
    assert {body.layer for body in far.bodies} == {Layer.BUILDING}
    np.testing.assert_array_equal(near.sky.panorama, far.sky.panorama)
    for one, other in zip(near.bodies, far.bodies, strict=False):
        np.testing.assert_array_equal(one.mesh.vertices_enu_m, other.mesh.vertices_enu_m)
    for part in ("corners_enu_m", "tilts_rad", "bows_per_m", "glass", "rooms"):
        np.testing.assert_array_equal(getattr(near.panes, part), getattr(far.panes, part))
    for field in fields(Interiors):
        np.testing.assert_array_equal(getattr(near.interiors, field.name), getattr(far.interiors, field.name))
    distances = mirrored(near, bodies_of(near, Layer.NEAR, Layer.GROUND))
    assert np.mean(distances < 80.0) > 0.7, "near things dominate what is mirrored"
    assert not np.isfinite(mirrored(far, bodies_of(far, *Layer))).any()


def test_glass_sees_glass_in_the_court_alone() -> None:
    for name, low, high in (("court", 0.5, 0.95), ("curved", 0.0, 0.0), ("concrete", 0.0, 0.0)):
        scene = scene_of(name)
        panels = panel_frames(scene.panes.corners_enu_m)
        panes = RayCaster(from_corners(panel_triangles(panels.corners)))
        # A camera that looks along the wing at 45 degrees.
        sideways = panels.normals + np.where(panels.normals[:, :1] > 0.5, [[0.0, 1.0, 0.0]], [[-1.0, 0.0, 0.0]])
        hits = panes.cast(panels.centroids + 0.1 * panels.normals, sideways)
        assert low <= hits.is_hit.mean() <= high, name


def test_concrete_has_glass_in_its_windows_alone() -> None:
    scene = scene_of("concrete")
    x, z = np.meshgrid(np.linspace(-14.9, 14.9, 150), np.linspace(0.1, 21.9, 110))
    origins = np.column_stack([x.ravel(), np.full(x.size, 20.0), z.ravel()])
    south = np.broadcast_to([0.0, -1.0, 0.0], origins.shape)
    wall = RayCaster(bodies_of(scene, Layer.BUILDING)).cast(origins, south).distance_m
    glass = RayCaster(from_corners(panel_triangles(scene.panes.corners_enu_m))).cast(origins, south).distance_m
    is_glass = glass < wall
    assert np.mean(is_glass) == pytest.approx(60 * 1.34 * 1.74 / (30.0 * 22.0), rel=0.05)
    np.testing.assert_allclose(glass[is_glass], 20.2, atol=1e-3)
    assert np.quantile(wall[~is_glass], [0.0, 0.8]) == pytest.approx([20.0, 20.0], abs=1e-3)


def test_an_unknown_scene_is_refused_with_those_there_are() -> None:
    with pytest.raises(InputError, match="no bundled scene 'tower'; known are: planar, curved, planar-far, curved-far"):
        bundled_scene("tower")

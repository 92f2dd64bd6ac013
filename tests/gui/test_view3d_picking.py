"""Picking finds what a slow search over all triangles finds, and what is nearest to the pointer."""

import time

import numpy as np
import pytest

from groundstation.gui.view3d.drawables import Layer, shown_panels
from groundstation.gui.view3d.orbit import Orbit, facing, photo_pinhole
from groundstation.gui.view3d.picking import PickIndex, footprint, pick
from groundstation.gui.view3d.site_scene import plan_scene, site_scene
from groundstation.gui.widgets.theme import LIGHT
from groundstation.services.project.document import Item, ItemKind
from planning.aircraft.catalogue import profiles
from planning.site.bundled import canyon, court, library, office
from planning.site.records import panel_triangles
from tests.benchmarks.view3d import large_plan, large_site
from tests.slow import slow

SIZE = (1280, 720)
CAMERA = profiles()["m3e"].camera


def slow_first_hit(eye, ray, corners):
    """Distance to the first triangle that a ray meets, by solving for each triangle; inf for none."""
    best = np.inf
    for a, b, c in corners:
        matrix = np.stack([b - a, c - a, -ray], axis=1)
        if abs(np.linalg.det(matrix)) < 1e-12:
            continue
        u, v, t = np.linalg.solve(matrix, eye - a)
        if u >= 0 and v >= 0 and u + v <= 1 and t > 0:
            best = min(best, t)
    return best


@pytest.mark.slow
@pytest.mark.parametrize("make", [office, slow(library), court, slow(canyon)])
def test_the_ray_through_a_pixel_meets_what_the_slow_search_meets(make):
    model = make()
    scene = site_scene(model, LIGHT)
    index = PickIndex(scene)
    panels = panel_triangles(shown_panels(scene.frames))
    solids = [mesh.corners_enu_m for mesh in (model.building, *model.obstacles)]
    view = facing(scene.frames.normals[0], scene.extent(), 16 / 9, 30.0, 20.0).pinhole(*SIZE)
    rng = np.random.default_rng(1)
    n_panels = 0
    for x, y in rng.uniform(0.1, 0.9, (60, 2)) * SIZE:
        ray = view.ray(x, y)
        hit = index.surface(view.eye_enu_m, ray, frozenset({Layer.HOME}))
        at_panels = slow_first_hit(view.eye_enu_m, ray, panels)
        at_solids = min(slow_first_hit(view.eye_enu_m, ray, corners) for corners in solids)
        if hit is None:
            assert min(at_panels, at_solids) == np.inf
            continue
        assert hit.depth_m == pytest.approx(min(at_panels, at_solids), abs=1e-6)
        assert (hit.item.kind is ItemKind.PANEL) == (at_panels <= at_solids)
        assert hit.normal @ ray <= 0.0
        n_panels += hit.item.kind is ItemKind.PANEL
    assert n_panels >= 1


@pytest.mark.parametrize("make", [court, canyon])
def test_many_rays_at_once_meet_what_each_meets_by_itself(make):
    scene = site_scene(make(), LIGHT)
    index, rng = PickIndex(scene), np.random.default_rng(2)
    eye = facing(scene.frames.normals[0], scene.extent(), 16 / 9, 30.0, 20.0).pinhole(*SIZE).eye_enu_m
    rays = scene.frames.centroids[rng.integers(0, len(scene.frames), 200)] + rng.normal(0.0, 4.0, (200, 3)) - eye
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    depths_m, normals = index.bodies(eye, rays)
    hidden = frozenset({Layer.NO_FLY, Layer.ZONES, Layer.HOME})
    for ray, depth_m, normal in zip(rays, depths_m, normals, strict=True):
        hit = index.surface(eye, ray, hidden)
        assert np.isfinite(depth_m) == (hit is not None)
        if hit is not None:
            assert depth_m == pytest.approx(hit.depth_m, abs=1e-6)
            assert normal == pytest.approx(hit.normal, abs=1e-9)
    assert 20 < np.isfinite(depths_m).sum() < 200


def test_every_panel_is_picked_at_the_pixel_of_its_centroid():
    model = office()
    scene = site_scene(model, LIGHT)
    index = PickIndex(scene)
    view = facing(np.array([0.0, -1.0, 0.0]), scene.extent(), 16 / 9).pinhole(*SIZE)
    pixels, _ = view.project(scene.frames.centroids)
    for panel, (x, y) in zip(model.site.panels, pixels, strict=True):
        hit = pick(index, None, view, x, y)
        assert hit.item == Item(ItemKind.PANEL, panel.id)


def test_hidden_layers_are_not_picked_and_a_miss_is_none():
    scene = site_scene(office(), LIGHT)
    index = PickIndex(scene)
    view = facing(np.array([0.0, -1.0, 0.0]), scene.extent(), 16 / 9).pinhole(*SIZE)
    (x, y), _ = view.project(scene.frames.centroids[100])
    assert pick(index, None, view, x, y, frozenset({Layer.PANELS})).item.kind is ItemKind.BUILDING
    assert pick(index, None, view, x, y, frozenset({Layer.PANELS, Layer.BUILDING})) is None
    assert pick(index, None, view, 2.0, 2.0) is None


def test_a_no_fly_volume_is_picked_only_where_nothing_but_the_building_is_behind_it():
    from dataclasses import replace

    from planning.site.records import NoFlyZone

    model = office()
    zone = NoFlyZone("road", ((-30.0, -30.0), (30.0, -30.0), (30.0, -20.0), (-30.0, -20.0)), 0.0, 60.0)
    site = replace(model.site, airspace=replace(model.site.airspace, no_fly=(zone,)))
    scene = site_scene(replace(model, site=site), LIGHT)
    index = PickIndex(scene)
    view = facing(np.array([0.0, -1.0, 0.0]), scene.extent(), 16 / 9).pinhole(*SIZE)
    (x, y), _ = view.project(scene.frames.centroids[100])
    assert pick(index, None, view, x, y).item.kind is ItemKind.PANEL
    (x, y), _ = view.project(np.array([25.0, -25.0, 50.0]))
    assert pick(index, None, view, x, y).item == Item(ItemKind.NO_FLY, "road")
    (x, y), _ = view.project(np.array([0.0, 0.0, 42.8]))
    assert pick(index, None, view, x, y).item == Item(ItemKind.NO_FLY, "road")


@pytest.mark.slow
def test_viewpoints_and_legs_are_picked_by_their_pixels_unless_a_surface_hides_them():
    site = site_scene(large_site(), LIGHT)
    index, plan = PickIndex(site), plan_scene(large_plan(), LIGHT)
    view = Orbit((0.0, 0.0, 80.0), 400.0, 20.0, -20.0).pinhole(*SIZE)
    pixels, _ = view.project(plan.views.positions_enu_m)
    n_hidden = 0
    for i in range(0, 1000, 7):
        away = float(np.linalg.norm(plan.views.positions_enu_m[i] - view.eye_enu_m))
        surface = index.surface(view.eye_enu_m, view.ray(*pixels[i]))
        hit = pick(index, plan, view, *pixels[i])
        if surface is not None and surface.depth_m < away - 1.0:
            n_hidden += 1
            assert hit.item.id != f"v{i:04d}"
        else:
            nearest = np.hypot(*(pixels - pixels[i]).T) < 0.5
            assert hit.item in [Item(ItemKind.VIEWPOINT, f"v{k:04d}") for k in np.flatnonzero(nearest)]
    assert n_hidden >= 5
    path = plan.paths[4]
    (a, b), _ = view.project(path[20:22])
    hit = pick(index, plan, view, *(0.5 * (a + b)), frozenset({Layer.VIEWPOINTS, Layer.PANELS, Layer.BUILDING}))
    assert hit.item.kind is ItemKind.LEG
    sortie, _, leg = hit.item.id.partition("/")
    ends = plan.paths[int(sortie) - 1][int(leg) - 1 : int(leg) + 1]
    along = (hit.point_enu_m - ends[0]) @ (ends[1] - ends[0]) / np.sum((ends[1] - ends[0]) ** 2)
    assert 0.0 <= along <= 1.0


@pytest.mark.slow
def test_a_pick_among_ten_thousand_panels_and_a_thousand_viewpoints_takes_under_20_ms():
    site = site_scene(large_site(), LIGHT)
    index, plan = PickIndex(site), plan_scene(large_plan(), LIGHT)
    view = Orbit((0.0, 0.0, 80.0), 400.0, 20.0, -20.0).pinhole(*SIZE)
    times = []
    for x, y in np.random.default_rng(0).uniform(0.2, 0.8, (100, 2)) * SIZE:
        started = time.perf_counter()
        pick(index, plan, view, x, y)
        times.append(time.perf_counter() - started)
    assert np.median(times) < 0.02


def test_the_footprint_of_a_level_photo_is_the_rectangle_of_its_angles_of_view():
    scene = site_scene(office(), LIGHT)
    eye = np.array([0.0, -15.0, 20.0])
    (piece,) = footprint(PickIndex(scene), photo_pinhole(eye, 0.0, 0.0, CAMERA, 1000.0))
    depth = 15.0 - 0.05
    size = np.ptp(piece, axis=0)
    assert size[0] == pytest.approx(2.0 * CAMERA.half_width * depth, abs=0.3)
    assert size[2] == pytest.approx(2.0 * CAMERA.half_height * depth, abs=0.3)


def test_the_footprint_breaks_where_the_picture_leaves_the_building():
    scene = site_scene(office(), LIGHT)
    eye = np.array([15.0, -15.0, 40.0])
    pieces = footprint(PickIndex(scene), photo_pinhole(eye, 0.0, 0.0, CAMERA, 1000.0))
    for piece in pieces:
        assert np.isfinite(piece).all()
        assert np.linalg.norm(np.diff(piece, axis=0), axis=1).max() < 20.0
    assert footprint(PickIndex(scene), photo_pinhole(eye, 3.14, 0.7, CAMERA, 1000.0)) == []

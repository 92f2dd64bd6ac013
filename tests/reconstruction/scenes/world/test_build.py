"""Scenes out of sites: panes where the panels are, free to be seen, in profiles, on streets that flights can use."""

from __future__ import annotations

from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.base.errors import InputError
from planning.coverage.sections import panel_frames
from planning.geo.mesh import TriangleMesh, box_mesh, closed_parts, empty_mesh, from_corners, join
from planning.geo.ray_casting import RayCaster
from planning.site.bundled import ORIGIN, arc_grid, panel_grid
from planning.site.bundled import SCENES as SITES
from planning.site.free_space import free_space
from planning.site.records import Airspace, Facade, Panel, Site, SiteModel, panel_corners, panel_triangles
from reconstruction.scenes.record import Glass, Layer, Scene
from reconstruction.scenes.world.build import build_scene, edge_gaps, profile_rings, without_openings
from reconstruction.scenes.world.look import Look, read_look
from reconstruction.scenes.world.surroundings import crown

FAR = Look(near=False, clouds=0.0, skyline_deg=0.0)


def site_of(facade: Facade, building: TriangleMesh | None = None, east_m: float = 0.0) -> SiteModel:
    airspace = Airspace((east_m - 90.0, -90.0, 3.0), (east_m + 90.0, 90.0, 80.0), ground_z_m=0.0)
    mesh = "wall.ply" if building else None
    site = Site("made", ORIGIN, (facade,), airspace, (east_m, -70.0, 0.0), building_mesh=mesh)
    return SiteModel(site, building or empty_mesh())


def turned_facade(heading_rad: float, gap_m: float, middle: tuple[float, float] = (0.0, 0.0)) -> Facade:
    """Four by three panels, 6 m x 6 m, whose outward normal is at an angle from east."""
    right = np.array([-np.sin(heading_rad), np.cos(heading_rad)])
    low_left, low_right = ((*(middle + side * right), 1.0) for side in (-3.0, 3.0))
    return panel_grid("A", (low_left, low_right, (*low_left[:2], 7.0)), 3, 4, gap_m=gap_m)


def mesh_of(scene: Scene, name: str) -> TriangleMesh:
    return next(body.mesh for body in scene.bodies if body.name == name)


def area_m2(mesh: TriangleMesh) -> float:
    corners = mesh.corners_enu_m
    crossed = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return float(0.5 * np.linalg.norm(crossed, axis=1).sum())


def points_on(corners: np.ndarray, rng: np.random.Generator, margin: float, n: int) -> np.ndarray:
    """Random points on quads, that share of their width and height away from the edges, shape (m n, 3)."""
    u, v = rng.uniform(margin, 1.0 - margin, (2, len(corners), n, 1))
    a, b, c, d = (corners[:, None, i] for i in range(4))
    return ((1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * d + u * c)).reshape(-1, 3)


def share_hidden(scene: Scene, mesh: TriangleMesh, margin: float) -> float:
    """Of rays to points on the panes, from up to 50 degrees off their normals, those that meet a mesh before them."""
    rng = np.random.default_rng(5)
    panels = panel_frames(scene.panes.corners_enu_m)
    points = points_on(panels.corners, rng, margin, 8)
    normals = np.repeat(panels.normals, 8, axis=0)
    ways = normals + rng.uniform(-0.7, 0.7, points.shape)
    origins = points + 4.0 * ways
    hits = RayCaster(mesh).cast(origins, points - origins)
    return float((hits.distance_m < 1.0 + 1e-4).mean())


@pytest.mark.few(1)
@pytest.mark.parametrize("name", ["court", "library", "roof"])
def test_panes_are_the_sites_panels_from_their_lower_left_corner(name: str) -> None:
    model = SITES[name]()
    corners = panel_corners(model.site)
    rolled = np.stack([np.roll(quad, i % 4, axis=0) for i, quad in enumerate(corners)])
    panels = tuple(Panel(f"P-{i}", tuple(tuple(map(float, c)) for c in quad)) for i, quad in enumerate(rolled))
    scene = build_scene(replace(model, site=replace(model.site, facades=(Facade("P", panels),))), FAR)
    np.testing.assert_array_equal(scene.panes.corners_enu_m, corners)


@pytest.mark.few(1)
@pytest.mark.parametrize("name", ["library", "court", "canyon", "roof"])
def test_no_ray_meets_the_wall_before_the_pane(name: str) -> None:
    model = SITES[name]()
    scene = build_scene(model, FAR)
    # The wings of the court hide each other from some directions.
    wings = 0.1 if name == "court" else 0.0
    assert share_hidden(scene, mesh_of(scene, "walls"), 0.0) <= wings
    assert share_hidden(scene, model.building, 0.0) > 0.3, "the site's own mesh lies in the plane of the panes"


@pytest.mark.parametrize(
    ("before_m", "is_cut"), [(0.4, False), (0.25, True), (0.0, True), (-0.03, True), (-0.1, False)]
)
@settings(max_examples=5, deadline=None)
@given(heading=st.floats(-3.1, 3.1), gap_m=st.sampled_from([0.0, 0.05]))
def test_of_a_wall_near_the_panels_exactly_their_area_is_cut(
    before_m: float, is_cut: bool, heading: float, gap_m: float
) -> None:
    outward = np.array([np.cos(heading), np.sin(heading), 0.0])
    panels = panel_frames(panel_corners(site_of(turned_facade(heading, gap_m)).site))
    right = np.array([-outward[1], outward[0], 0.0])
    corners = [[-5.0, 0.0], [5.0, 0.0], [5.0, 9.0], [-5.0, 9.0]]
    quad = np.array([u * right + before_m * outward + [0.0, 0.0, v] for u, v in corners])
    wall = from_corners(panel_triangles(quad[None]))
    glass = area_m2(from_corners(panel_triangles(panels.corners))) if is_cut else 0.0
    assert area_m2(without_openings(wall, panels)) == pytest.approx(90.0 - glass, abs=2e-3)


def test_a_wall_that_no_panel_touches_stays_the_same_mesh() -> None:
    panels = panel_frames(panel_corners(site_of(turned_facade(0.3, 0.0)).site))
    wall = box_mesh(np.array([-8.0, -8.0, 0.0]), np.array([-4.0, 8.0, 9.0]))
    assert without_openings(wall, panels) is wall
    assert without_openings(empty_mesh(), panels).triangles.shape == (0, 3)


def test_profiles_fill_the_gaps_between_panels_and_leave_the_glass_free() -> None:
    scene = build_scene(SITES["office"](), FAR)
    rings = mesh_of(scene, "profiles")
    panels = panel_frames(scene.panes.corners_enu_m)
    # 1 mm from the edges, straight from the front.
    inside = panels.centroids[:, None] + (panels.corners - panels.centroids[:, None]) * 0.9985
    towards = np.broadcast_to(-panels.normals[:, None], inside.shape).reshape(-1, 3)
    caster = RayCaster(rings)
    is_hit = caster.cast(inside.reshape(-1, 3) - 5.0 * towards, towards).is_hit
    is_inner = (np.abs(inside[..., 0]) < 17.9) & (inside[..., 2] > 0.1) & (inside[..., 2] < 41.9)
    assert not is_hit[is_inner.reshape(-1)].any(), "the outline alone has no gap"
    # The mullions' middles, at any height, also where they cross transoms.
    x, z = np.meshgrid(np.arange(-16.2, 17.0, 1.8), np.linspace(0.05, 41.95, 97))
    gaps = np.column_stack([x.ravel(), np.full(x.size, -5.0), z.ravel()])
    assert caster.cast(gaps, np.broadcast_to([0.0, 1.0, 0.0], gaps.shape)).is_hit.all()


def test_profiles_where_panels_meet_are_as_wide_as_asked_and_closed_on_a_curve() -> None:
    facade = arc_grid("A", (0.0, 0.0), 12.0, (-2.5, -0.6), (0.0, 8.0), 4, 12)
    panels = panel_frames(panel_corners(site_of(facade).site))
    rings = profile_rings(panels, 0.06, 0.05)
    caster = RayCaster(rings)
    joints = panels.corners[:11, 1] + [0.0, 0.0, 1.0]
    radial = joints * [1.0, 1.0, 0.0] / 12.0
    for across_m, is_hit in ((0.0, True), (0.002, True), (0.027, True), (0.036, False), (0.2, False)):
        side = across_m * np.column_stack([-radial[:, 1], radial[:, 0], np.zeros(11)])
        hits = caster.cast(joints + side + 3.0 * radial, -radial)
        assert hits.is_hit.all() if is_hit else not hits.is_hit.any(), across_m
    before = 12.0 - np.linalg.norm(rings.vertices_enu_m[:, :2], axis=1)
    assert -0.06 < before.min() < -0.04, "they stand out by their depth"


def test_gaps_are_those_to_the_panel_that_follows_across_each_edge() -> None:
    # Two narrow panels with a gap of 10 cm, a wide one 2 cm above both, and another around a right-angled corner.
    quads = [
        [[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.5, 0.0, 2.0], [0.0, 0.0, 2.0]],
        [[0.6, 0.0, 0.0], [1.1, 0.0, 0.0], [1.1, 0.0, 2.0], [0.6, 0.0, 2.0]],
        [[0.0, 0.0, 2.02], [1.1, 0.0, 2.02], [1.1, 0.0, 2.6], [0.0, 0.0, 2.6]],
        [[1.1, 0.0, 0.0], [1.1, 3.0, 0.0], [1.1, 3.0, 2.0], [1.1, 0.0, 2.0]],
    ]
    gaps, cosines = edge_gaps(panel_frames(np.array(quads)))
    inf = np.inf
    expected = [[inf, 0.1, 0.02, inf], [inf, inf, 0.02, 0.1], [0.0539, inf, inf, inf], [inf, inf, inf, inf]]
    np.testing.assert_allclose(gaps, expected, atol=1e-4)
    assert (cosines == 1.0).all()


def test_odd_panels_get_finite_profiles_within_their_neighbourhood() -> None:
    shapes = {
        "triangle": ((0, 0, 1), (2, 0, 1), (2, 0, 4), (2, 0, 4)),
        "in-line": ((3, 0, 1), (4, 0, 1), (5, 0, 1), (4, 0, 4)),
        "tiny": ((6, 0, 1), (6.02, 0, 1), (6.02, 0, 1.02), (6, 0, 1.02)),
        "sharp": ((8, 0, 1), (12, 0, 1), (12, 0, 1.01), (8.5, 0, 1.1)),
        "warped": ((13, 0, 1), (15, 0.04, 1), (15, 0, 3), (13, 0.04, 3)),
    }
    panels = tuple(Panel(name, tuple(tuple(map(float, c)) for c in corners)) for name, corners in shapes.items())
    model = site_of(Facade("A", panels), box_mesh(np.array([-1.0, 0.0, 0.0]), np.array([16.0, 5.0, 6.0])))
    scene = build_scene(model, FAR)
    for body in scene.bodies:
        assert np.isfinite(body.mesh.vertices_enu_m).all()
        edges = np.diff(body.mesh.corners_enu_m, axis=1)
        assert (np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1) > 0.0).all()
    for part in (scene.panes.tilts_rad, scene.panes.bows_per_m, scene.panes.rooms):
        assert np.isfinite(part).all()
    rings = mesh_of(scene, "profiles").vertices_enu_m
    assert rings.min(axis=0)[0] > -0.3
    assert rings.max(axis=0)[0] < 15.3
    assert share_hidden(scene, mesh_of(scene, "walls"), 0.0) == 0.0


@pytest.mark.slow
def test_panes_are_tilted_bent_and_replaced_as_the_look_says() -> None:
    model = site_of(panel_grid("A", ((-30.0, 0.0, 0.0), (30.0, 0.0, 0.0), (-30.0, 0.0, 60.0)), 30, 30))
    look = replace(FAR, tilt_deg=0.3, bow_deg=0.2, replaced=0.2, blinds=0.0)
    panes = build_scene(model, look, 3).panes
    assert np.degrees(panes.tilts_rad.std(axis=0)) == pytest.approx([0.3, 0.3], rel=0.06)
    halves = np.array([1.0, 1.0])
    edge_turns_deg = np.degrees(panes.bows_per_m * halves)
    assert edge_turns_deg.mean(axis=0) == pytest.approx([0.2, 0.2], rel=0.05)
    assert edge_turns_deg.std(axis=0) == pytest.approx([0.06, 0.06], rel=0.1)
    assert np.mean(panes.glass == 2) == pytest.approx(0.2, abs=0.03)
    flat = build_scene(model, replace(look, tilt_deg=0.0, bow_deg=0.0), 3).panes
    assert not flat.tilts_rad.any()
    assert not flat.bows_per_m.any()
    np.testing.assert_array_equal(flat.rooms, panes.rooms)
    assert build_scene(model, replace(look, blinds=1.0), 3).panes.rooms.mean() > 2.0 * panes.rooms.mean()


@pytest.mark.few(1)
@pytest.mark.parametrize("heading", [-0.5 * np.pi, 0.7, 2.9])
def test_buildings_stand_across_the_street_whatever_way_the_facade_looks(heading: float) -> None:
    outward, right = np.array([np.cos(heading), np.sin(heading)]), np.array([-np.sin(heading), np.cos(heading)])
    model = site_of(turned_facade(heading, 0.0))
    home = (*(-30.0 * outward), 0.0)
    model = replace(model, site=replace(model.site, home_enu_m=home))
    scene = build_scene(model, Look(street_m=20.0), 1)
    opposite = [body for body in scene.bodies if body.name.startswith("opposite")]
    across = np.array([(body.mesh.vertices_enu_m[:, :2] @ outward).min() for body in opposite])
    assert ((across >= 20.0 - 1e-6) & (across <= 21.5)).all()
    spans = [(body.mesh.vertices_enu_m[:, :2] @ right) for body in opposite]
    assert min(span.min() for span in spans) < -20.0
    assert max(span.max() for span in spans) > 20.0
    trees = mesh_of(scene, "crowns").vertices_enu_m[:, :2] @ outward
    assert 14.0 < trees.min() <= trees.max() < 20.0
    space = free_space(scene.site, 5.0)
    middle = np.array([[*(10.0 * outward), 30.0]])
    inside = np.array([[*(across[len(across) // 2] * outward + 3.0 * outward), 8.0]])
    assert space.is_allowed(middle).all()
    assert not space.is_allowed(inside).any()
    assert all(obstacle.mesh or obstacle.box_enu_m for obstacle in scene.site.site.obstacles)


@pytest.mark.slow
def test_no_building_stands_in_a_street_of_the_court_or_upon_home() -> None:
    scene = build_scene(SITES["court"](), Look(street_m=24.0), 2)
    points = np.concatenate([body.mesh.vertices_enu_m for body in scene.bodies if body.name.startswith("opposite")])
    before_west = (points[:, 0] < -25.0 + 24.0 - 1e-6) & (np.abs(points[:, 1] + 20.0) < 18.0)
    before_north = (points[:, 1] > -24.0 + 1e-6) & (points[:, 1] < 0.0) & (np.abs(points[:, 0] - 1.0) < 24.0)
    assert not before_west.any()
    assert not before_north.any()
    assert np.hypot(points[:, 0] - 15.0, points[:, 1] + 50.0).min() > 12.0


@pytest.mark.slow
def test_what_is_near_is_ground_and_street_and_can_be_left_out() -> None:
    model = SITES["office"]()
    near, far = build_scene(model, Look(), 4), build_scene(model, Look(near=False), 4)
    assert {body.layer for body in near.bodies} == set(Layer)
    assert {body.layer for body in far.bodies} == {Layer.BUILDING}
    assert far.site is model
    assert near.site.sha256 == model.sha256
    for field in fields(near.panes):
        np.testing.assert_array_equal(getattr(near.panes, field.name), getattr(far.panes, field.name))
    np.testing.assert_array_equal(near.sky.panorama, far.sky.panorama)
    bare = build_scene(model, Look(tree_spacing_m=0.0, car_spacing_m=0.0, people_spacing_m=0.0), 4)
    names = {body.name.rstrip("0123456789") for body in bare.bodies}
    assert names == {"profiles", "walls", "asphalt", "pavement", "markings", "opposite-", "roofs"}


def test_a_sites_own_obstacles_are_near_things_that_streets_keep_off() -> None:
    scene = build_scene(SITES["canyon"](), Look(street_m=20.0))
    body = next(body for body in scene.bodies if body.name == "obstacle-opposite")
    assert body.layer is Layer.NEAR
    for other in scene.bodies:
        if other.name.startswith("opposite-"):
            x, y = other.mesh.vertices_enu_m[:, :2].T
            assert not ((np.abs(x) < 30.0) & (y > -40.0) & (y < -24.0)).any()


def test_a_site_far_from_its_origin_is_built_as_finely() -> None:
    facade = panel_grid("A", ((18_000.0, 0.0, 1.0), (18_006.0, 0.0, 1.0), (18_000.0, 0.0, 7.0)), 3, 4)
    building = box_mesh(np.array([17_999.0, 0.0, 0.0]), np.array([18_007.0, 6.0, 8.0]))
    scene = build_scene(site_of(facade, building, 18_000.0), Look())
    walls = mesh_of(scene, "walls")
    assert area_m2(walls) == pytest.approx(area_m2(building) - 36.0, abs=1e-3)
    assert share_hidden(scene, walls, 0.0) == 0.0


def test_a_site_without_panels_is_refused() -> None:
    model = site_of(Facade("A", ()), box_mesh(np.zeros(3), np.ones(3)))
    with pytest.raises(InputError, match="no panels yet"):
        build_scene(model)


def test_crowns_are_closed_and_look_outwards() -> None:
    mesh = crown(np.random.default_rng(0), np.array([3.0, 4.0, 5.0]), 1.5)
    corners = mesh.corners_enu_m
    parts = closed_parts(corners)
    assert set(parts) == {0, 1, 2, 3}
    volumes = np.einsum("tk,tk->t", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6.0
    for part in range(4):
        assert 1.0 < volumes[parts == part].sum() < 14.0
    assert len(join([mesh, mesh]).triangles) == 2 * 4 * 128


def test_a_look_is_read_from_a_file(tmp_path: Path) -> None:
    path = tmp_path / "look.toml"
    path.write_text(
        "street_m = 22\nnear = false\nopposite_height_m = [8, 12]\nwall_albedo = [0.1, 0.2, 0.3]\n"
        "[glass]\ncoating = 0.4\nsheets = 1\n"
    )
    assert read_look(path) == Look(
        near=False,
        street_m=22.0,
        opposite_height_m=(8.0, 12.0),
        wall_albedo=(0.1, 0.2, 0.3),
        glass=Glass(coating=0.4, sheets=1),
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("street = 22", r"look.toml: street: no such setting; known are: near, .*street_m"),
        ("[glass]\ncolour = 1", r"look.toml: glass.colour: no such setting; known are: index"),
        ("street_m = 'wide'", r"look.toml: street_m: expected number, got text"),
        ("street_m = 1", r"look.toml: street_m: expected 4 to 500, got 1.0"),
        ("street_m = nan", r"look.toml: street_m: expected 4 to 500, got nan"),
        ("opposite_height_m = [30, 10]", r"opposite_height_m: expected lowest and highest"),
        ("[glass]\nsheets = 3", r"look.toml: glass.sheets: expected 1 or 2, got 3"),
        ("street_m = ", r"look.toml: not valid TOML"),
    ],
)
def test_a_wrong_look_is_refused_by_name(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "look.toml"
    path.write_text(text)
    with pytest.raises(InputError, match=message):
        read_look(path)

"""Rooms behind panes: where rays meet them, against a slow search; their mean light; and no light out of nothing."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from planning.coverage.sections import panel_frames
from planning.site.bundled import panel_grid
from planning.site.records import Facade, panel_corners
from reconstruction.scenes.light.geometry import PaneFrames
from reconstruction.scenes.light.interiors import CEILING, FADES_M, FLANK, FLOOR, SIDE, TOP, RoomLight
from reconstruction.scenes.parameters import RenderSettings
from reconstruction.scenes.photos.renderer import Renderer
from reconstruction.scenes.record import Glass, Interiors, Scene
from reconstruction.scenes.world.build import PAINT, build_scene, facade_bows_per_m, shared_rooms
from reconstruction.scenes.world.bundled import bundled_scene, curved_site, planar_site
from reconstruction.scenes.world.look import Look
from tests.reconstruction.scenes.small_scenes import facing_south, panes, photo, scene

Array = NDArray[np.float64]

BLOCK = np.array([-1.0, 0.5, 1.2, 1.0, 2.0, 0.6])
PATTERN = 0.7


def one_room(blind: float = 0.0, light: float = PATTERN, lamps: float = 1.0) -> Interiors:
    """A room of 6 m x 4 m, 5 m deep, behind a pane of 4 m x 3 m, with a cupboard in it."""
    return Interiors(
        rooms_m=np.array([[-3.0, 3.0, -2.0, 2.0, 5.0]]),
        furniture_m=BLOCK[None, None],
        lamps=np.array([lamps]),
        lights=np.full((1, 3), light),
        blinds=np.array([blind]),
        blind_lights=np.full((1, 3), 0.9),
    )


def seen(rooms: Interiors, points: Array, directions: Array) -> Array:
    """Light from behind the pane y = 0, 4 m x 3 m around (0, 0, 10), shape (n,)."""
    made = panes(facing_south(4.0, 3.0))
    n = len(points)
    flat = np.tile([0.0, -1.0, 0.0], (n, 1))
    light = RoomLight(rooms, made, PaneFrames.of(made))
    return light.light_from(points, directions, np.zeros(n, np.int64), flat, np.full(n, np.inf))[:, 0]


def by_steps(point: Array, direction: Array) -> float:
    """Share of the light of the first thing met, in steps of 2 mm."""
    t = np.arange(0.0, 14.0, 0.002)
    u, v, w = (point + t[:, None] * direction).T[[0, 2, 1]]
    v = v - 10.0
    in_block = (u > BLOCK[0]) & (u < BLOCK[1]) & (v < -2.0 + BLOCK[2]) & (w > BLOCK[3]) & (w < BLOCK[4])
    outside = (np.abs(u) > 3.0) | (np.abs(v) > 2.0) | (w > 5.0)
    k = int(np.argmax(in_block | outside))
    if in_block[k]:
        past = np.array([max(BLOCK[0] - u[k - 1], u[k - 1] - BLOCK[1]), v[k - 1] + 2.0 - BLOCK[2], BLOCK[3] - w[k - 1]])
        share = BLOCK[5] * (FLANK, TOP, 1.0)[int(past.argmax())]
    else:
        past = np.array([abs(u[k]) - 3.0, abs(v[k]) - 2.0, w[k] - 5.0])
        share = (SIDE, CEILING if v[k] > 0.0 else FLOOR, 1.0)[int(past.argmax())]
    return float(share * math.exp(-w[k] / FADES_M))


@settings(max_examples=30, deadline=None)
@given(st.floats(-1.9, 1.9), st.floats(-1.4, 1.4), st.floats(-1.2, 1.2), st.floats(-1.2, 1.2))
def test_rays_meet_walls_and_furniture_where_a_slow_search_finds_them(u: float, v: float, a: float, b: float) -> None:
    direction = np.array([math.tan(a), 1.0, math.tan(b)]) / math.hypot(math.tan(a), 1.0, math.tan(b))
    point = np.array([u, 0.0, 10.0 + v])
    found = seen(one_room(), point[None], direction[None])[0]
    # Beside an edge, either side of it will do.
    aside = np.array([[0.0, 0.0], [0.005, 0.005], [0.005, -0.005], [-0.005, 0.005], [-0.005, -0.005]])
    around = [by_steps(point + np.array([du, 0.0, dv]), direction) for du, dv in aside]
    assert 0.998 * min(around) <= found / PATTERN <= 1.002 * max(around)


def test_a_blind_covers_its_share_of_the_pane_from_above() -> None:
    height = np.linspace(8.51, 11.49, 150)
    points = np.column_stack([np.zeros(150), np.zeros(150), height])
    straight = np.tile([0.0, 1.0, 0.0], (150, 1))
    light = seen(one_room(blind=0.4), points, straight)
    # Slats are 0.8 as bright on average as where they are brightest.
    assert np.array_equal(np.isclose(light, 0.8 * 0.9), height > 8.5 + 0.6 * 3.0)


@pytest.mark.parametrize("direction", [(1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.6, -0.0, 0.8), (1.0, 1e-300, 0.0)])
def test_rays_along_the_glass_see_something_finite(direction: tuple[float, float, float]) -> None:
    points = np.array([[0.0, 0.0, 10.0], [-2.0, 0.0, 8.5], [2.2, 0.01, 11.5]])
    light = seen(one_room(), points, np.tile(direction, (3, 1)))
    assert np.isfinite(light).all()
    assert ((light >= 0.0) & (light <= 1.0)).all()


def test_seen_from_inside_a_pane_shows_the_mean() -> None:
    made = panes(facing_south(4.0, 3.0), room=0.31)
    light = RoomLight(one_room(), made, PaneFrames.of(made)).light_from(
        np.array([[0.0, 0.0, 10.0]]), np.array([[0.0, -1.0, 0.0]]), np.zeros(1, np.int64), np.array([[0.0, 1.0, 0.0]]),
        np.ones(1),
    )  # fmt: skip
    assert np.allclose(light, 0.31)


@pytest.mark.parametrize("heading", [0.0, 60.0])
def test_rooms_as_bright_as_everything_else_make_nothing_brighter(heading: float) -> None:
    lit = replace(one_room(blind=0.3, light=0.5), blind_lights=np.full((1, 3), 0.5))
    clear = Glass(tint=(1.0, 1.0, 1.0), coating=0.1)
    made = replace(scene(corners=facing_south(4.0, 3.0), glass=clear, room=0.5), interiors=lit)
    camera = photo((0.0, -2.0, 10.0), heading, width_px=64, height_px=48)
    assert Renderer(made, RenderSettings(samples=1)).render(camera).linear.max() <= 0.5 + 1e-6


def far_and_wide(made: Scene, rng: np.random.Generator) -> tuple[Array, Array]:
    """Mean light of each pane over places and directions of light from all sides, and what it is to be, (m, 3)."""
    frames, m, n = PaneFrames.of(made.panes), len(made.panes.glass), 400
    which = np.repeat(np.arange(m), n)
    corners = made.panes.corners_enu_m[which]
    a, b = rng.random((2, m * n, 1))
    points = corners[:, 0] + a * (corners[:, 1] - corners[:, 0]) + b * (corners[:, 3] - corners[:, 0])
    radius, azimuth = np.sqrt(rng.random(m * n)), rng.uniform(0.0, 2.0 * np.pi, m * n)
    local = np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), -np.sqrt(1.0 - radius**2)], axis=1)
    axes = np.stack([frames.rights, frames.ups, frames.normals], axis=1)[which]
    directions = np.einsum("nj,njk->nk", local, axes)
    assert made.interiors is not None
    light = RoomLight(made.interiors, made.panes, frames).light_from(
        points, directions, which, frames.normals[which], np.full(m * n, np.inf)
    )
    return light.reshape(m, n, 3).mean(axis=1), made.panes.rooms


@pytest.mark.slow
@pytest.mark.parametrize("name", ["curved", "concrete"])
def test_panes_have_the_mean_light_of_what_is_behind_them(name: str) -> None:
    found, expected = far_and_wide(bundled_scene(name), np.random.default_rng(0))
    assert found.mean() == pytest.approx(expected.mean(), rel=0.02)
    # 400 rays through each.
    assert np.abs(found / expected - 1.0).mean() < 0.05
    assert np.quantile(np.abs(found / expected - 1.0), 0.95) < 0.2


def test_neighbours_share_rooms_and_see_the_same_furniture() -> None:
    made = build_scene(planar_site(), Look(near=False, blinds=0.0), 2)
    rooms, frames = made.interiors, PaneFrames.of(made.panes)
    assert rooms is not None
    first = shared_rooms(made.panes, np.random.default_rng([2, 4]))
    assert 0.3 < np.mean(first != np.arange(len(first))) < 0.8
    assert np.bincount(first).max() <= 4
    for pane in np.flatnonzero(first != np.arange(len(first)))[:20]:
        beside = (frames.middles_enu_m[pane] - frames.middles_enu_m[first[pane]]) @ frames.rights[pane]
        assert 1.0 < abs(beside) < 6.1
        assert np.allclose(rooms.rooms_m[pane, :2] + beside, rooms.rooms_m[first[pane], :2])
        assert np.allclose(rooms.furniture_m[pane, :, :2] + beside, rooms.furniture_m[first[pane], :, :2])
        assert np.allclose(rooms.lights[pane], rooms.lights[first[pane]])
    width = rooms.rooms_m[:, 1] - rooms.rooms_m[:, 0]
    assert ((width >= 2.4 - 1e-9) & (width < 6.6)).all()


def test_rooms_of_odd_and_level_panes_are_finite() -> None:
    level = panel_grid("R", ((0.0, 0.0, 5.0), (4.0, 0.0, 5.0), (0.0, 4.0, 5.0)), 2, 2)
    model = planar_site()
    site = replace(model.site, facades=(Facade("R", level.panels),))
    made = build_scene(replace(model, site=site), Look(near=False))
    assert made.interiors is not None
    assert (made.interiors.blinds == 1.0).all(), "skylights show no room"
    assert all(np.isfinite(getattr(made.interiors, name)).all() for name in ("rooms_m", "furniture_m", "lights"))


@pytest.mark.slow
@pytest.mark.parametrize(("site", "per_m"), [(curved_site(), 1.0 / 26.0), (planar_site(), 0.0)])
def test_curved_glass_is_bent_as_its_facade_is(site: object, per_m: float) -> None:
    panels = panel_frames(panel_corners(site.site))  # type: ignore[attr-defined]
    bows = facade_bows_per_m(panels)
    assert bows[:, 0] == pytest.approx(per_m, abs=2e-4)
    assert bows[:, 1] == pytest.approx(0.0, abs=1e-6)
    look = Look(near=False, bow_deg=0.0, tilt_deg=0.0, curved_glass=True)
    made = build_scene(site, look)  # type: ignore[arg-type]
    assert np.allclose(made.panes.bows_per_m, bows)
    assert not build_scene(site, replace(look, curved_glass=False)).panes.bows_per_m.any()  # type: ignore[arg-type]


@pytest.mark.slow
def test_a_corner_is_not_a_curve() -> None:
    made = build_scene(bundled_scene("court").site, Look(near=False, bow_deg=0.0, curved_glass=True))
    assert np.allclose(made.panes.bows_per_m, 0.0, atol=1e-6)


@pytest.mark.slow
def test_every_third_row_is_painted_behind_and_all_other_rooms_stay() -> None:
    site = planar_site()
    plain, made = (build_scene(site, Look(near=False, spandrel_every=every), 4) for every in (0, 3))
    middles = made.panes.corners_enu_m.mean(axis=1)
    rows = np.rint((middles[:, 2] - middles[:, 2].min()) / 2.5).astype(int)
    is_painted = rows % 3 == 2
    assert set(rows[is_painted]) == {2, 5}
    np.testing.assert_array_equal(made.panes.rooms[is_painted], np.broadcast_to(PAINT, (int(is_painted.sum()), 3)))
    np.testing.assert_array_equal(made.panes.rooms[~is_painted], plain.panes.rooms[~is_painted])
    assert made.interiors is not None
    assert plain.interiors is not None
    np.testing.assert_array_equal(made.interiors.rooms_m[~is_painted], plain.interiors.rooms_m[~is_painted])
    # Paint looks the same from everywhere, a room does not.
    frames = PaneFrames.of(made.panes)
    rng, which = np.random.default_rng(1), np.repeat(np.flatnonzero(is_painted), 20)
    away = rng.uniform(-0.8, 0.8, (len(which), 2))
    rays = -frames.normals[which] + away[:, :1] * frames.rights[which] + away[:, 1:] * frames.ups[which]
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    places = middles[which] + rng.uniform(-0.5, 0.5, (len(which), 1)) * frames.rights[which]
    light = RoomLight(made.interiors, made.panes, frames)
    seen = light.light_from(places, rays, which, frames.normals[which], np.full(len(which), 0.01))
    np.testing.assert_allclose(seen, np.broadcast_to(PAINT, seen.shape), rtol=0.01)

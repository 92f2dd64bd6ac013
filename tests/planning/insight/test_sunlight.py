"""Light on facades and glare in pictures, against the mirror law, closed forms and a slow reference."""

import math
from dataclasses import replace
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.geo.bvh import line_of_sight
from planning.geo.frames import camera_axes
from planning.geo.height_field import HeightField
from planning.geo.sun import is_within, joined_spans, total_s
from planning.insight.sunlight import (
    MIRRORS,
    SHADOW_END_S,
    SHADOWS,
    TILTS,
    TOLERANCE_S,
    SunSite,
    picture_planes,
    sun_day,
)
from planning.plan import viewpoint_arrays
from planning.site.records import Obstacle, Panel, panel_corners
from planning.site.terrain import terrain_of
from tests.planning.insight.sun_cases import CAMERA, aimed, day_of, moment_of, wall
from tests.planning.plan_cases import kiosk, solid_triangles


def day(model, views=(), on="2026-03-20", **options):
    return sun_day(SunSite(model), day_of(model, on), views, CAMERA, **options)


def looking_into_mirror(model, track, second, distance_m=20.0):
    """A view of the first pane's middle, from where it shows the sun at a second."""
    sun = track.directions_enu(second)
    corners = panel_corners(model.site)[0]
    normal = np.cross(corners[2] - corners[0], corners[3] - corners[1])
    normal /= np.linalg.norm(normal)
    ray = sun - 2.0 * (sun @ normal) * normal
    return aimed("v0", corners.mean(axis=0) - distance_m * ray, ray)


# The mirror law


@pytest.mark.parametrize(
    ("lat_deg", "heading_deg", "slope_deg"),
    [(48.0, 180.0, 0.0), (48.0, 100.0, 10.0), (-33.0, 0.0, -5.0), (0.0, 0.0, 90.0), (22.0, 250.0, 60.0)],
)
def test_a_small_pane_shows_the_sun_when_the_mirror_law_says_and_for_as_long(lat_deg, heading_deg, slope_deg):
    """A pane of 0.2 m at 20 m is 0.57 degrees wide, the sun 0.53; the sun moves 0.25 degrees a minute at the most."""
    model = wall(lat_deg, 0.0, heading_deg, slope_deg, size_m=0.2)
    track = day_of(model)
    lit = [t for t in np.arange(0.0, 86_400.0, 3600.0) if is_lit_before(model, track.directions_enu(t))]
    assert len(lit) >= 4
    for second in lit[1:-1]:
        found = day(model, (looking_into_mirror(model, track, second),)).views["v0"]
        ((first, last),) = found.mirrored
        assert first < second < last
        assert found.panes == (0,)
        # From the disc's first touch of the pane to its last, along a diagonal at the longest.
        assert 0.53 / 0.251 * 60.0 < last - first < (0.57 * math.sqrt(2.0) + 0.6) / 0.2 * 60.0


def is_lit_before(model, sun):
    corners = panel_corners(model.site)[0]
    normal = np.cross(corners[2] - corners[0], corners[3] - corners[1])
    return sun[2] > 0.1 and sun @ normal / np.linalg.norm(normal) > 0.2


def mirrored_by_images(model, view, suns):
    """Whether a view shows one of some suns, shape (n, 3), in a pane: by the sun's mirror image behind each pane."""
    forward, right, up = (
        axis.reshape(3) for axis in camera_axes(math.radians(view.heading_deg), math.radians(view.gimbal_pitch_deg))
    )
    place, found = np.array(view.position_enu_m), np.zeros(len(suns), bool)
    triangles = line_of_sight(solid_triangles(model))
    for quad in panel_corners(model.site):
        normal = np.cross(quad[2] - quad[0], quad[3] - quad[1])
        normal = normal / np.linalg.norm(normal)
        image = place + 1e9 * suns
        image = image - 2.0 * ((image - quad[0]) @ normal)[:, None] * normal
        rays = (image - place) / np.linalg.norm(image - place, axis=1, keepdims=True)
        depth = rays @ forward
        shows = (depth > 0.0) & (suns @ normal > 0.0) & (suns[:, 2] > 0.0)
        shows &= np.abs(rays @ right) <= CAMERA.half_width * depth
        shows &= np.abs(rays @ up) <= CAMERA.half_height * depth
        sinks = -(rays @ normal)
        ahead = ((place - quad[0]) @ normal) / np.where(sinks > 1e-9, sinks, 1.0)
        points = place + ahead[:, None] * rays
        shows &= (sinks > 1e-9) & (ahead > 0.0)
        for k in range(4):
            shows &= np.cross(quad[(k + 1) % 4] - quad[k], points - quad[k]) @ normal >= 0.0
        before = points + 0.15 * normal
        shows &= triangles(before, np.broadcast_to(place, before.shape))
        found |= shows & triangles(before, before + 500.0 * suns)
    return found


@settings(max_examples=8)
@given(st.integers(0, 364), st.integers(0, 2**32 - 1))
def test_glare_is_that_of_mirror_images_within_two_minutes(days, seed):
    model = kiosk()
    rng = np.random.default_rng(seed)
    start = datetime(2026, 1, 1, tzinfo=UTC) + timedelta(days=days)
    track = day_of(model, start.date().isoformat())
    views = []
    for n in range(3):
        place = np.array([rng.uniform(-20, 30), rng.uniform(-30, -8), rng.uniform(4, 30)])
        views.append(aimed(f"v{n}", place, np.array([0.0, 0.0, 4.5]) + rng.uniform(-3, 3, 3) - place))
    found = sun_day(SunSite(model), track, views, CAMERA).views
    seconds = np.arange(0.0, 86_400.0, 120.0)
    suns = track.directions_enu(seconds)
    for view in views:
        expected = mirrored_by_images(model, view, suns)
        spans = found[view.id].mirrored
        wide = np.column_stack([spans[:, 0] - TOLERANCE_S, spans[:, 1] + TOLERANCE_S])
        assert (is_within(joined_spans([wide]), seconds) | ~expected).all(), "what is there is found"
        # The disc begins before its middle: what is found is there within 2 minutes.
        near = np.convolve(expected, np.ones(5), "same") > 0
        long = spans[spans[:, 1] - spans[:, 0] > 2.5 * TOLERANCE_S]
        inner = np.column_stack([long[:, 0] + TOLERANCE_S, long[:, 1] - TOLERANCE_S])
        share = (is_within(inner, seconds) & ~near).sum() / max(1, is_within(inner, seconds).sum())
        assert share <= 0.1, "but where the disc slides along a border"


def test_a_view_into_the_sun_and_one_into_its_mirror_image_are_found_and_others_are_not():
    model = wall(n=4, size_m=8.0)
    at = datetime(2026, 3, 20, 10, tzinfo=UTC)
    track = moment_of(model, at)
    sun = track.directions_enu(0.0)
    ray = sun * (1.0, -1.0, 1.0)
    place = np.array([0.0, 0.0, 10.0]) - 20.0 * ray
    views = (
        aimed("into-the-sun", place, sun),
        aimed("into-the-mirror", place, ray),
        aimed("away", place, np.cross(sun, ray) + np.array([0.0, 0.0, 0.01])),
        aimed("beside", place + np.array([40.0, 0.0, 0.0]), ray),
        aimed("from-behind", np.array([0.0, 0.0, 10.0]) + 20.0 * sun * (1.0, -1.0, -1.0), -sun * (1.0, -1.0, -1.0)),
    )

    def shown(model):
        # A moment is too short for effects to be worth their while.
        found = sun_day(SunSite(model), track, views, CAMERA, {MIRRORS: "on"}).views
        return [{name for name, view in found.items() if len(spans(view))} for spans in SEEN]

    assert shown(model) == [{"into-the-sun"}, {"into-the-mirror"}]
    middle = (place + 10.0 * sun).tolist()
    before_sun = Obstacle("a", box_enu_m=(tuple(c - 1.0 for c in middle), tuple(c + 1.0 for c in middle)))
    middle = (np.array([0.0, 0.0, 10.0]) - 10.0 * ray).tolist()
    before_pane = Obstacle("b", box_enu_m=(tuple(c - 2.0 for c in middle), tuple(c + 2.0 for c in middle)))
    middle = (np.array([0.0, 0.0, 10.0]) + 40.0 * sun).tolist()
    shade = Obstacle("c", box_enu_m=(tuple(c - 8.0 for c in middle), tuple(c + 8.0 for c in middle)))
    assert shown(wall(n=4, size_m=8.0, obstacles=(before_sun,))) == [set(), {"into-the-mirror"}]
    assert shown(wall(n=4, size_m=8.0, obstacles=(before_pane,))) == [{"into-the-sun"}, set()]
    assert shown(wall(n=4, size_m=8.0, obstacles=(shade,)))[1] == set()


SEEN = (lambda view: view.direct, lambda view: view.mirrored)


def test_pictures_are_bounded_by_the_planes_of_their_edges():
    views = (aimed("a", (0.0, 0.0, 0.0), (1.0, 2.0, 0.3)), aimed("b", (0.0, 0.0, 0.0), (0.0, 0.0, -1.0)))
    planes = picture_planes(viewpoint_arrays(views), CAMERA)
    arrays = viewpoint_arrays(views)
    forward, right, up = camera_axes(arrays.heading_rad, arrays.pitch_rad)
    for n in range(2):
        for x, y in ((1.0, 0.3), (-1.0, -0.9), (0.2, 1.0), (0.0, -1.0)):
            edge = forward[n] + x * CAMERA.half_width * right[n] + y * CAMERA.half_height * up[n]
            margins = planes[n] @ edge
            assert margins.min() == pytest.approx(0.0, abs=1e-12)
            assert (planes[n] @ (forward[n] + 0.99 * (edge - forward[n])) > 0.0).all()
            assert (planes[n] @ (forward[n] + 1.01 * (edge - forward[n])) < 0.0).any()


def test_shorter_leaps_find_the_same_glare_and_more_of_what_is_short():
    model = wall(n=3, size_m=6.0)
    views = [looking_into_mirror(model, day_of(model), 40_000.0 + 1000.0 * n) for n in range(8)]
    views = [replace(view, id=f"v{n}") for n, view in enumerate(views)]
    fine, coarse = (day(model, views, least_s=least_s).views for least_s in (1.0, 60.0))
    for name, view in fine.items():
        assert abs(total_s(view.mirrored) - total_s(coarse[name].mirrored)) < 60.0


# Light


def test_a_wall_to_the_east_is_in_the_sun_from_rise_to_noon_and_one_to_the_north_never_in_winter():
    model = wall(heading_deg=90.0)
    found = day(model, on="2026-12-21")
    track = found.track
    ((first, last),) = found.facades[0].lit
    assert first == pytest.approx(track.up[0, 0], abs=SHADOW_END_S)
    assert last == pytest.approx(track.highest()[0], abs=20.0)
    assert not len(found.facades[0].partly)
    (north,) = day(wall(heading_deg=0.0), on="2026-12-21").facades
    assert not len(north.lit)
    assert total_s(north.even(track.up)) == total_s(track.up)


def test_a_roof_is_in_the_sun_all_day_and_a_ceiling_never():
    (roof,) = day(wall(slope_deg=90.0)).facades
    track = day_of(wall())
    assert total_s(roof.lit) == pytest.approx(total_s(track.up), abs=300.0)
    assert roof.tilt_deg == pytest.approx(90.0)
    (ceiling,) = day(wall(slope_deg=-90.0)).facades
    # Refraction shows the sun from below by half its disc at rise and set.
    assert total_s(ceiling.lit) < 600.0


def test_a_bent_facade_is_in_the_sun_in_part_while_the_sun_is_beside_it():
    model = wall(n=1)
    turned = wall(heading_deg=90.0).site.facades[0].panels[0]
    panels = (*model.site.facades[0].panels, Panel("B", turned.corners_enu_m))
    model = replace(model, site=replace(model.site, facades=(replace(model.site.facades[0], panels=panels),)))
    found = day(model, settings={SHADOWS: "off"})
    noon = found.track.highest()[0]
    (facade,) = found.facades
    # At the equinox both are in the sun in the morning, the one to the south alone from noon on.
    assert is_within(facade.lit, noon - 7200.0)
    assert is_within(facade.partly, noon + 7200.0)
    assert not is_within(facade.even(found.track.up), noon + 7200.0)


def test_a_wall_opposite_shades_panes_up_to_the_profile_angle():
    """Behind a long wall h above a pane and d before it the sun is hidden while tan(elevation in section) < h / d."""
    opposite = Obstacle("o", box_enu_m=((-900.0, -31.0, 0.0), (900.0, -30.0, 25.0)))
    model = wall(size_m=0.2, obstacles=(opposite,))
    found = day(model, on="2026-02-15")
    assert found.shadows.on
    times = np.arange(0.0, 86_400.0, 1.0)
    suns = found.track.directions_enu(times)
    free = (suns[:, 2] > 0.0) & (suns[:, 1] < 0.0) & (suns[:, 2] * 29.85 > -suns[:, 1] * 15.08)
    # The lowest place that is looked at lies 0.08 m below the middle. Beside the wall the sun comes in.
    free &= np.abs(suns[:, 0]) * 30.0 < 890.0 * -suns[:, 1]
    ((first, last),) = (span for span in found.facades[0].lit if span[1] - span[0] > 3600.0)
    assert first == pytest.approx(times[free][0], abs=30.0)
    assert last == pytest.approx(times[free][-1], abs=30.0)


def test_a_hill_of_the_terrain_hides_the_sun_like_a_wall_of_its_height():
    """A ridge 15 m above the pane and 30 m before it, over the whole width of the terrain."""
    x = y = np.arange(-400.0, 401.0, 5.0)
    z = np.where(np.abs(y + 30.0)[:, None] < 1.0, 25.0, 0.0) + 0.0 * x
    hill = terrain_of(HeightField(-400.0, -400.0, 5.0, z), z, z)
    flat = wall(size_m=0.2)
    found = day(replace(flat, site=replace(flat.site, terrain=hill)), on="2026-02-15")
    opposite = Obstacle("o", box_enu_m=((-400.0, -30.01, 0.0), (400.0, -30.0, 25.0)))
    expected = day(wall(size_m=0.2, obstacles=(opposite,)), on="2026-02-15")
    assert found.shadows.on
    lit = [max(each.facades[0].lit.tolist(), key=lambda span: span[1] - span[0]) for each in (found, expected)]
    np.testing.assert_allclose(lit[0], lit[1], atol=20.0)
    unused = replace(flat, site=replace(flat.site, terrain=replace(hill, use="off")))
    assert not day(unused, on="2026-02-15").shadows.on


# Effects, both ways


def test_a_facade_that_never_mirrors_the_sun_is_left_out_and_nothing_is_missed():
    model = wall(heading_deg=0.0, n=3)
    views = [aimed(f"v{n}", (2.0 * n - 4.0, 20.0, 10.0), (0.0, -1.0, 0.2)) for n in range(5)]
    off = day(model, views, on="2026-12-21")
    assert not off.facades[0].mirrors.on
    assert "never before its panes" in off.facades[0].mirrors.reason
    on = day(model, views, on="2026-12-21", settings={MIRRORS: "on"})
    assert on.facades[0].mirrors.on
    assert all(total_s(view.mirrored) <= TOLERANCE_S for view in on.views.values())
    # In summer the sun comes round in the morning and in the evening.
    assert day(model, views, on="2026-06-21").facades[0].mirrors.on


def test_glare_that_is_switched_off_is_missed_by_more_than_its_tolerance():
    model = wall(n=3)
    view = looking_into_mirror(model, day_of(model), 43_200.0)
    assert day(model, (view,)).facades[0].mirrors.on
    assert total_s(day(model, (view,)).views["v0"].mirrored) > TOLERANCE_S
    assert not len(day(model, (view,), settings={MIRRORS: "off"}).views["v0"].mirrored)


def test_shadows_are_looked_for_where_bodies_cast_some():
    free = wall(n=3)
    assert not day(free).shadows.on
    lit = [day(free, settings={SHADOWS: way}).facades[0].lit for way in ("on", "off")]
    assert abs(total_s(lit[0]) - total_s(lit[1])) <= TOLERANCE_S
    shaded = wall(n=3, obstacles=(Obstacle("o", box_enu_m=((-9.0, -20.0, 0.0), (9.0, -18.0, 30.0))),))
    assert day(shaded).shadows.on
    lit = [day(shaded, settings={SHADOWS: way}).facades[0].lit for way in ("on", "off")]
    assert abs(total_s(lit[0]) - total_s(lit[1])) > TOLERANCE_S


@pytest.mark.parametrize("tilt_deg", [(0.0, 3.0), (2.0, 0.0), (-1.0, -2.0)])
def test_a_measured_tilt_does_what_turning_the_pane_does(tilt_deg):
    flat, tilted = wall(size_m=0.3), wall(size_m=0.3, tilt_deg=tilt_deg)
    right, up = (math.radians(angle) for angle in tilt_deg)
    turned = wall(size_m=0.3, heading_deg=180.0 - math.degrees(math.atan(right)), slope_deg=math.degrees(math.atan(up)))
    view = looking_into_mirror(turned, day_of(turned), 41_000.0)
    ((first, last),) = day(turned, (view,)).views["v0"].mirrored
    ((found, end),) = day(tilted, (view,)).views["v0"].mirrored
    assert (found, end) == pytest.approx((first, last), abs=20.0)
    assert day(tilted, (view,)).tilts.on
    missed = day(tilted, (view,), settings={TILTS: "off"}).views["v0"].mirrored
    assert abs(total_s(missed) - (last - first)) > 60.0 or abs(missed[0, 0] - first) > 60.0
    assert day(flat).tilts is None


def test_a_tilt_too_small_to_matter_is_left_out_and_nothing_is_missed():
    model = wall(tilt_deg=(0.05, 0.05))
    view = looking_into_mirror(model, day_of(model), 43_200.0)
    found = day(model, (view,))
    assert not found.tilts.on
    spans = [day(model, (view,), settings={TILTS: way}).views["v0"].mirrored for way in ("on", "off")]
    np.testing.assert_allclose(spans[0], spans[1], atol=TOLERANCE_S)


def test_a_tilt_that_no_pane_has_is_refused():
    with pytest.raises(ValueError, match="tilt_deg"):
        wall(tilt_deg=(0.0, 45.0))


# Hard cases


@pytest.mark.parametrize("slope_deg", [0.0, 90.0, -90.0])
@pytest.mark.parametrize("lat_deg", [90.0, -90.0, 80.0, 0.0])
@pytest.mark.parametrize("on", ["2026-06-21", "2026-12-21"])
def test_no_day_and_no_pane_gives_what_is_not_finite(lat_deg, slope_deg, on):
    model = wall(lat_deg, 180.0, slope_deg=slope_deg)
    views = (
        aimed("down", (0.0, 0.0, 40.0), (0.0, 0.0, -1.0)),
        aimed("level", (0.0, -20.0, 10.0), (0.0, 1.0, 0.0)),
        aimed("in-plane", (0.0, 0.0, 30.0), (0.0, 0.0, -1.0)),
    )
    found = day(model, views, on=on)
    every = [found.track.up, *(view.dazzled for view in found.views.values())]
    every += [spans for facade in found.facades for spans in (facade.lit, facade.partly, facade.facing)]
    for spans in every:
        assert np.isfinite(spans).all()
        assert (spans[:, 1] >= spans[:, 0]).all()
        assert total_s(spans) <= 86_400.0
    if abs(lat_deg) >= 80.0:
        is_up = (lat_deg > 0.0) == (on == "2026-06-21")
        assert total_s(found.track.up) == (86_400.0 if is_up else 0.0)


def test_at_the_equator_a_roof_mirrors_the_noon_sun_straight_up():
    model = wall(0.0, slope_deg=90.0)
    found = day(model, (aimed("down", (0.0, 0.0, 40.0), (0.0, 0.0, -1.0)),)).views["down"]
    ((first, last),) = found.mirrored
    # The pane of 4 m at 30 m is 7.6 degrees wide, the disc 0.5: 30 and 2 minutes at 15 degrees an hour.
    assert last - first == pytest.approx(60.0 * (2.0 * math.degrees(math.atan(2.0 / 30.0)) + 0.53) / 0.25, rel=0.03)
    assert first < day_of(model).highest()[0] < last


def test_a_sun_in_the_plane_of_a_pane_is_neither_missed_nor_a_fault():
    """At noon it is in the plane of a wall to the east: what grazes within the disc's radius may be seen or not."""
    model = wall(heading_deg=90.0)
    noon = day_of(model).highest()[0]
    at = datetime(2026, 3, 20, tzinfo=UTC) + timedelta(seconds=noon)
    sun = day_of(model).directions_enu(noon)
    view = aimed("along", np.array([0.05, 0.0, 10.0]) - 20.0 * sun, sun)
    found = sun_day(SunSite(model), moment_of(model, at), (view,), CAMERA).views["along"]
    assert len(found.direct) == 1
    hour = sun_day(SunSite(model), day_of(model), (view,), CAMERA).views["along"]
    assert np.isfinite(hour.mirrored).all()
    # Mirrored or direct, the sun leaves the picture by half its width, 35 degrees at 15 an hour.
    assert total_s(hour.dazzled) < 5.0 * 3600.0


@pytest.mark.parametrize("precision", [np.float32, np.float64])
def test_planes_in_single_precision_move_times_by_less_than_the_tolerance(precision):
    model = wall(n=2)
    view = looking_into_mirror(model, day_of(model), 43_200.0)
    rounded = replace(
        view,
        position_enu_m=tuple(map(float, np.array(view.position_enu_m, precision))),
        heading_deg=float(precision(view.heading_deg)),
    )
    exact, found = day(model, (view,)).views["v0"].mirrored, day(model, (rounded,)).views["v0"].mirrored
    np.testing.assert_allclose(found, exact, atol=2.0)


def test_a_site_without_panels_has_light_and_no_facades():
    model = kiosk(facades=())
    found = sun_day(SunSite(model), day_of(model))
    assert found.facades == ()
    assert not found.shadows.on

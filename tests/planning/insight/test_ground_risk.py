"""Ground risk: published distances, proofs that the areas hold what they have to, and what is refused."""

import itertools
import math
from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from planning.aircraft.catalogue import profiles
from planning.base.errors import InfeasibleError, InputError
from planning.base.findings import Severity
from planning.geo.height_field import HeightField
from planning.insight.falling import LEAST_GRAVITY_M_S2, fall_s, longest_fall_s, reach_m
from planning.insight.ground_risk import (
    BARO_ERROR_M,
    GNSS_HEIGHT_ERROR_M,
    assess_ground_risk,
    grown,
)
from planning.insight.ground_risk_class import ground_risk_tables
from planning.insight.ground_risk_request import BANDS, GroundRiskRequest
from planning.site.records import NoFlyZone
from planning.site.terrain import surfaces, terrain_of
from tests.planning.insight.ground_risk_cases import BENT, ROUND, flown, place

CALM = GroundRiskRequest(wind_m_s=0.0)

PUBLISHED = [
    # BBK and LBA, STS-BOS 1.0 (June 2025), tables 1 and 2: speed, height, contingency and ballistic buffer in metres,
    # rounded up to tenths; multirotors of 1.5 m that brake with 30 degrees.
    (12.0, 30.0, 31.8, 37.9), (12.0, 50.0, 31.8, 45.1), (12.0, 70.0, 31.8, 51.3), (12.0, 100.0, 31.8, 59.4),
    (12.0, 120.0, 31.8, 64.2), (4.0, 30.0, 12.5, 11.4), (4.0, 50.0, 12.5, 14.2), (4.0, 70.0, 12.5, 16.4),
    (4.0, 100.0, 12.5, 19.3), (4.0, 120.0, 12.5, 21.0),
]  # fmt: skip


@pytest.mark.parametrize(("speed", "height", "contingency", "buffer"), PUBLISHED)
def test_published_distances_come_out(speed, height, contingency, buffer):
    top = height - 1.5 * 1.5
    request = replace(CALM, speed_m_s=speed, dimension_m=1.5, tilt_deg=30.0)
    plan = flown(((0.0, 0.0, 0.0), (0.0, 0.0, top)))
    plan = replace(plan, aircraft=replace(plan.aircraft, max_ascent_m_s=0.5))
    risk = assess_ground_risk(plan, place(), request)
    assert risk.geography_top_m == pytest.approx(height)
    assert math.ceil(10.0 * risk.value_of("S_CV")) / 10.0 == contingency
    assert math.ceil(10.0 * (risk.value_of("S_fall") + 0.5 * 1.5)) / 10.0 == buffer


def test_a_fall_with_drag_is_the_closed_form_straight_down_and_never_shorter_than_without():
    k = 0.05
    terminal = math.sqrt(LEAST_GRAVITY_M_S2 / k)
    for height in (0.01, 1.0, 50.0, 400.0):
        exact = terminal / LEAST_GRAVITY_M_S2 * math.acosh(math.exp(k * height))
        assert longest_fall_s(height, 0.0, 0.0, k) == pytest.approx(exact, rel=1e-6)
    assert longest_fall_s(80.0, 5.0, 20.0, 1e-12) == pytest.approx(fall_s(80.0, 5.0), rel=1e-6)
    assert longest_fall_s(0.0, 0.0, 30.0, k) == pytest.approx(0.0, abs=1e-12)


def fallen(height, climb, level, wind, k, turn):
    """Where a body with quadratic drag comes down, by SciPy: slow, and with nothing of the bound in it."""

    def slope(_t, state):
        air = state[3:] - wind * np.array([math.cos(turn), math.sin(turn), 0.0])
        return np.r_[state[3:], -k * np.linalg.norm(air) * air - [0.0, 0.0, LEAST_GRAVITY_M_S2]]

    def ground(_t, state):
        return state[2]

    ground.terminal, ground.direction = True, -1
    wind_xy = wind * np.array([math.cos(turn), math.sin(turn)])
    start = np.r_[0.0, 0.0, height, level + wind_xy[0], wind_xy[1], climb]
    found = solve_ivp(slope, (0.0, 1e3), start, events=ground, rtol=1e-9, atol=1e-9)
    return math.hypot(*found.y_events[0][0][:2])


@given(
    st.floats(1.0, 150.0), st.floats(0.0, 8.0), st.floats(0.5, 25.0), st.floats(0.0, 15.0), st.floats(0.002, 0.08),
    st.floats(0.0, 1.0), st.floats(-math.pi, math.pi),
)  # fmt: skip
def test_no_fall_of_any_drag_goes_further_than_the_reach(height, climb, level, wind, most_k, share, turn):
    bound = reach_m(height, climb, level, wind, most_k)
    assert fallen(height, climb, level, wind, share * most_k, turn) <= bound * (1.0 + 1e-6)


def test_the_reach_is_not_much_more_than_the_furthest_fall():
    for height, level, wind in ((60.0, 21.0, 0.0), (100.0, 21.0, 12.0), (5.0, 15.0, 10.0)):
        furthest = max(fallen(height, 6.0, level, wind, k, 0.0) for k in np.linspace(0.0, 0.047, 9))
        bound = reach_m(height, 6.0, level, wind, 0.047)
        assert furthest <= bound <= 1.25 * furthest


def numbers(request, path=ROUND):
    return {each.symbol: each.value for each in assess_ground_risk(flown(path), place(), request).quantities}


@given(
    st.sampled_from(["wind_m_s", "speed_m_s", "reaction_s", "height"]),
    st.floats(0.0, 12.0), st.floats(0.5, 25.0), st.floats(0.0, 10.0), st.floats(0.0, 100.0), st.floats(0.0, 1.0),
)  # fmt: skip
def test_more_of_anything_never_shrinks_a_volume(which, wind, speed, reaction, height, share):
    low = {"wind_m_s": wind * share, "speed_m_s": max(0.5, speed * share), "reaction_s": reaction * share}
    high = {"wind_m_s": wind, "speed_m_s": speed, "reaction_s": reaction}
    less = replace(GroundRiskRequest(), **{**high, **({which: low[which]} if which in low else {})})
    more = replace(GroundRiskRequest(), **high)
    lower = height * share if which == "height" else height
    a = numbers(less, ((0.0, 0.0, 0.0), (30.0, 0.0, lower)))
    b = numbers(more, ((0.0, 0.0, 0.0), (30.0, 0.0, height)))
    for symbol in ("S_CV", "H_CV", "S_GRB", "S_fall"):
        assert a[symbol] <= b[symbol] * (1.0 + 1e-6), symbol


points = st.tuples(st.floats(-50.0, 50.0), st.floats(-50.0, 50.0))


@given(st.lists(points, min_size=1, max_size=9), st.floats(0.5, 60.0), st.sampled_from([0.01, 0.1, 2.0]))
def test_an_offset_holds_the_exact_one_and_is_at_most_the_tolerance_wider(found, by_m, tolerance):
    path = tuple((x, y, 10.0) for x, y in found)
    plan = flown(path if len(path) > 1 else path * 2)
    risk = assess_ground_risk(plan, place(), replace(CALM, geography="paths", arc_tolerance_m=tolerance))
    area = grown(risk.core, by_m, tolerance)
    line = np.array([*found, found[-1]])
    rng = np.random.default_rng(0)
    legs = rng.integers(0, len(line) - 1, 200)
    along = rng.random((200, 1))
    on_path = line[legs] + along * (line[legs + 1] - line[legs])
    turn = rng.uniform(0.0, 2.0 * math.pi, 200)
    near = on_path + by_m * (1.0 - 1e-9) * np.c_[np.cos(turn), np.sin(turn)]
    assert shapely.covers(area, shapely.points(near)).all()
    corners = shapely.points(shapely.get_coordinates(area))
    assert shapely.distance(risk.core, corners).max() <= by_m + tolerance + 1e-6


def test_a_path_that_crosses_itself_loses_no_area():
    """GEOS 3.14 leaves pieces out when it grows such a line at once."""
    rng = np.random.default_rng(3)
    path = tuple((float(x), float(y), 20.0) for x, y in rng.uniform(-25.0, 25.0, (60, 2)))
    risk = assess_ground_risk(flown(path), place(), replace(CALM, geography="paths"))
    legs = [shapely.linestrings([a[:2], b[:2]]) for a, b in itertools.pairwise(path)]
    exact = shapely.union_all([shapely.buffer(leg, risk.value_of("S_FG"), quad_segs=64) for leg in legs])
    assert shapely.difference(exact, risk.geography).area < 1e-6


def test_each_volume_holds_the_one_before_and_the_paths_however_they_bend():
    for geography in ("hull", "paths"):
        risk = assess_ground_risk(flown(ROUND, BENT), place(), replace(CALM, geography=geography))
        assert shapely.covers(risk.buffer, risk.contingency)
        assert shapely.covers(risk.contingency, risk.geography)
        for path in (ROUND, BENT):
            assert shapely.covers(risk.geography, shapely.linestrings([p[:2] for p in path]))
    hull = assess_ground_risk(flown(BENT), place(), CALM)
    alone = assess_ground_risk(flown(BENT), place(), replace(CALM, geography="paths"))
    assert alone.geography.area < 0.2 * hull.geography.area
    # Any straight way home stays in the hull.
    assert shapely.covers(hull.geography, shapely.linestrings([BENT[0][:2], BENT[-1][:2]]))


@pytest.mark.parametrize(
    "path", [((3.0, 4.0, 0.0),), ((3.0, 4.0, 0.0), (3.0, 4.0, 0.0)), ((3.0, 4.0, 0.0), (3.0, 4.0, 9.0))]
)
@pytest.mark.parametrize("geography", ["hull", "paths"])
def test_a_flight_over_one_place_is_a_disc(path, geography):
    risk = assess_ground_risk(flown(path), place(), replace(CALM, geography=geography, arc_tolerance_m=0.01))
    radius = risk.value_of("S_FG") + risk.value_of("S_CV") + risk.value_of("S_GRB")
    assert risk.buffer.area == pytest.approx(math.pi * radius**2, rel=1e-3)
    assert risk.buffer.area >= math.pi * radius**2 * (1.0 - 1e-9)
    assert risk.geography_top_m == pytest.approx(max(3 * 0.62, path[-1][2] + 1.5 * 0.62))


def test_places_far_from_the_origin_and_long_reactions_stay_sound():
    near = assess_ground_risk(flown(ROUND), place(), CALM)
    far = tuple((x + 1.9e4, y - 1.9e4, z) for x, y, z in ROUND)
    assert assess_ground_risk(flown(far), place(), CALM).buffer.area == pytest.approx(near.buffer.area, rel=1e-6)
    slow = assess_ground_risk(flown(ROUND), place(), replace(CALM, reaction_s=600.0))
    assert slow.value_of("S_RZ") == pytest.approx(600.0 * 21.0)
    assert math.isfinite(slow.buffer.area)


def test_heights_count_from_the_ground_and_the_return_home():
    high = assess_ground_risk(flown(ROUND), place(-12.0), CALM)
    assert high.value_of("H_top") == pytest.approx(52.0)
    returning = assess_ground_risk(flown(ROUND), place(), CALM, return_height_m=70.0)
    assert returning.value_of("H_top") == pytest.approx(70.0)
    by_gnss = assess_ground_risk(flown(ROUND), place(), replace(CALM, height_by="gnss"))
    more = GNSS_HEIGHT_ERROR_M - BARO_ERROR_M
    assert by_gnss.contingency_top_m == pytest.approx(
        assess_ground_risk(flown(ROUND), place(), CALM).contingency_top_m + more
    )


def test_finer_arcs_have_more_corners_and_less_area():
    fine, coarse = (
        assess_ground_risk(flown(ROUND), place(), replace(CALM, arc_tolerance_m=tolerance)).buffer
        for tolerance in (0.01, 5.0)
    )
    assert fine.area < coarse.area
    assert shapely.get_num_coordinates(fine) > 3 * shapely.get_num_coordinates(coarse)


def test_wind_is_the_plans_else_the_strongest_allowed_and_more_is_refused():
    plan = flown(ROUND)
    assert assess_ground_risk(plan, place()).value_of("w") == 12.0
    windy = replace(plan, rules=replace(plan.rules, wind_m_s=5.0))
    assert assess_ground_risk(windy, place()).value_of("w") == 5.0
    with pytest.raises(InfeasibleError, match=r"wind of up to 12 m/s, but 12.5 m/s are stated"):
        assess_ground_risk(plan, place(), GroundRiskRequest(wind_m_s=12.5))
    calm = assess_ground_risk(plan, place(), CALM)
    assert "any wind carries" in next(each.message for each in calm.findings if each.code == "sora-wind")


def test_nothing_is_guessed_of_an_aircraft_without_a_body():
    plan = flown(ROUND, profile_id="ardupilot")
    with pytest.raises(InputError, match="state largest dimension, take-off mass, braking tilt"):
        assess_ground_risk(plan, place(), GroundRiskRequest(speed_m_s=12.0))
    stated = GroundRiskRequest(speed_m_s=12.0, dimension_m=0.9, mass_kg=2.0, tilt_deg=30.0)
    assert assess_ground_risk(plan, place(), stated).value_of("V_0") == 20.0


def test_a_plan_without_sorties_is_refused():
    with pytest.raises(InfeasibleError, match="no sorties"):
        assess_ground_risk(flown(), place())


def test_classes_follow_the_table_and_ten_times_the_people_are_one_class_more():
    tables = ground_risk_tables()
    assert tuple(band.word for band in tables.bands) == BANDS
    counted = tables.bands[1:-1]
    for fewer, more in itertools.pairwise(counted):
        assert more.below_per_km2 == 10.0 * fewer.below_per_km2
        assert more.classes == tuple(each + 1 for each in fewer.classes)
    assert [tables.column_of(d, v) for d, v in ((1.0, 25.0), (1.01, 1.0), (0.5, 26.0), (41.0, 1.0))] == [0, 1, 1, None]


TABLE_1 = {
    # AMC1 Article 11 of (EU) 2019/947 (ED Decision 2025/018/R), Table 1 = SORA 2.5, Table 2, cell by cell.
    "controlled": (0.0, (1, 1, 2, 3, 3)),
    "remote": (5.0, (2, 3, 4, 5, 6)),
    "lightly": (50.0, (3, 4, 5, 6, 7)),
    "sparsely": (500.0, (4, 5, 6, 7, 8)),
    "suburban": (5_000.0, (5, 6, 7, 8, 9)),
    "city": (50_000.0, (6, 7, 8, 9, 10)),
    "assembly": (math.inf, (7, 8, None, None, None)),
}
COLUMNS_1 = ((1.0, 25.0), (3.0, 35.0), (8.0, 75.0), (20.0, 120.0), (40.0, 200.0))
TABLE_5 = {
    # The same, Table 5: low, medium, high; None for n/a.
    "sheltering": (1, 2, None),
    "restrictions": (None, 1, 2),
    "observers": (1, None, None),
    "impact": (None, 1, 2),
}


def classed(**stated):
    return assess_ground_risk(flown(ROUND), place(), replace(CALM, wind_m_s=0.0, **stated))


@pytest.mark.parametrize("word", TABLE_1)
def test_each_cell_of_the_published_table_comes_out_and_says_its_row_and_column(word):
    below, classes = TABLE_1[word]
    assert next(band.below_per_km2 for band in ground_risk_tables().bands if band.word == word) == below
    for (dimension_m, speed_m_s), wanted in zip(COLUMNS_1, classes, strict=True):
        for size, speed in ((dimension_m, 25.0), (0.5, speed_m_s)):
            risk = classed(population=word, dimension_m=size, speed_m_s=speed)
            assert risk.intrinsic_class == risk.final_class == wanted
            if wanted is not None:
                assert f"column up to {dimension_m:g} m and {speed_m_s:g} m/s; row " in risk.how_intrinsic
                assert (f"less than {below:g} people" in risk.how_intrinsic) == (0.0 < below < math.inf)


@pytest.mark.parametrize("name", TABLE_5)
def test_each_cell_of_the_published_mitigations_takes_off_what_it_says(name):
    for level, points in zip(("low", "medium", "high"), TABLE_5[name], strict=True):
        try:
            risk = classed(population="city", **{name: level})
        except ValueError:
            assert points is None
            continue
        assert (points or 0) == 6 - risk.final_class
        assert f"6 - {points or 0} (" in risk.how_final


def test_what_is_raised_to_controlled_ground_says_so():
    risk = classed(population="remote", restrictions="high", impact="high")
    assert risk.how_final == (
        "2 - 2 (M1(B) high) - 2 (M2 high) = -2, raised to 1, the class of controlled ground in this column"
    )


def test_a_small_aircraft_is_of_class_1_but_over_assemblies():
    # The same, note of Table 1: at most 250 g and 25 m/s.
    for population in ("controlled", "city"):
        risk = classed(population=population, mass_kg=0.25, speed_m_s=25.0)
        assert (risk.intrinsic_class, risk.final_class) == (1, 1)
        assert "at most 250 g" in risk.how_intrinsic
    assert classed(population="assembly", mass_kg=0.25).intrinsic_class == 7
    assert classed(population="city", mass_kg=0.251).intrinsic_class == 6
    assert classed(population="city", mass_kg=0.25, speed_m_s=25.1).intrinsic_class == 7


def test_a_speed_that_a_mode_limits_moves_no_column():
    # S.4.2.4 (b): the maximum speed is the fastest that can be commanded, not that of the flight.
    fast = replace(profiles()["m3e"].body, full_speed_m_s=30.0)
    plan = replace(flown(ROUND), profile="fast")
    own = replace(profiles()["m3e"], id="fast", body=fast)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("planning.insight.ground_risk.profiles", lambda: {"fast": own})
        limited = assess_ground_risk(plan, place(), replace(CALM, population="suburban", speed_m_s=10.0))
    assert limited.intrinsic_class == 6
    assert "30 m/s: column up to 3 m and 35 m/s" in limited.how_intrinsic
    assert limited.value_of("v") == 10.0


@pytest.mark.parametrize(
    ("population", "word", "intrinsic"),
    [("controlled", "controlled", 1), ("0", "remote", 2), ("4.9", "remote", 2), ("5", "lightly", 3),
     ("499", "sparsely", 4), ("suburban", "suburban", 5), ("49999", "city", 6), ("50000", "assembly", 7)],
)  # fmt: skip
def test_people_are_a_word_or_a_number(population, word, intrinsic):
    risk = assess_ground_risk(flown(ROUND), place(), replace(CALM, population=population))
    assert (risk.band.word, risk.intrinsic_class, risk.final_class) == (word, intrinsic, intrinsic)


def test_mitigations_take_off_but_not_below_controlled_ground():
    def final(population, **taken):
        return assess_ground_risk(flown(ROUND), place(), replace(CALM, population=population, **taken)).final_class

    assert final("suburban", restrictions="medium", impact="medium") == 3
    assert final("suburban", sheltering="low", observers="low") == 3
    assert final("remote", restrictions="high", impact="high") == 1
    with pytest.raises(ValueError, match="count the same people"):
        GroundRiskRequest(sheltering="medium", restrictions="medium")
    with pytest.raises(ValueError, match=r"expected one of controlled, .* got 'many'"):
        GroundRiskRequest(population="many")
    for wrong in ("nan", "inf", "-1", ""):
        with pytest.raises(ValueError, match="people per square kilometre"):
            GroundRiskRequest(population=wrong)


def test_what_the_table_does_not_hold_is_an_error_not_a_class():
    large = replace(CALM, population="assembly", dimension_m=5.0)
    risk = assess_ground_risk(flown(ROUND), place(), large)
    assert (risk.intrinsic_class, risk.final_class) == (None, None)
    assert [each.severity for each in risk.findings if each.code == "sora-class"] == [Severity.ERROR]
    eight = assess_ground_risk(flown(ROUND), place(), replace(CALM, population="assembly", dimension_m=2.0))
    assert eight.final_class == 8
    assert "sora-class" in [each.code for each in eight.findings]


def test_one_to_one_says_where_it_is_not_enough():
    high = replace(CALM, buffer="one-to-one")
    risk = assess_ground_risk(flown(ROUND), place(), high)
    assert risk.value_of("S_GRB") == pytest.approx(risk.contingency_top_m + 0.31)
    assert "sora-one-to-one" in [each.code for each in risk.findings]
    slow = assess_ground_risk(flown(ROUND), place(), replace(high, speed_m_s=2.0))
    assert "sora-one-to-one" not in [each.code for each in slow.findings]


def sloping(use="auto", half=600.0, step=10.0):
    """Falls 1 m in 4 m to the east; heights to `half` metres from the origin."""
    nodes = np.arange(-half, half + 0.5 * step, step)
    z = np.tile(-0.25 * nodes, (len(nodes), 1))
    return terrain_of(HeightField(-half, -half, step, z), z, z, use=use)


def test_the_lowest_ground_in_the_buffer_counts_where_a_site_has_terrain():
    slow = replace(CALM, speed_m_s=3.0)
    level = assess_ground_risk(flown(ROUND), place(), slow)
    risk = assess_ground_risk(flown(ROUND), replace(place(), terrain=sloping("on")), slow)
    _west, _south, east, _north = risk.buffer.bounds
    assert risk.ground_z_m <= -0.25 * east
    assert risk.ground_z_m == pytest.approx(-0.25 * east, abs=0.25 * 10.0)
    assert risk.value_of("H_top") == pytest.approx(40.0 - risk.ground_z_m)
    assert risk.value_of("S_GRB") > level.value_of("S_GRB")
    off = assess_ground_risk(flown(ROUND), replace(place(), terrain=sloping("off")), slow)
    assert off.value_of("S_GRB") == level.value_of("S_GRB")
    small = assess_ground_risk(flown(ROUND), replace(place(), terrain=sloping("on", half=70.0)), slow)
    assert "sora-terrain" in [each.code for each in small.findings]
    assert "sora-terrain" not in [each.code for each in risk.findings]


def test_no_fly_zones_that_the_volumes_reach_are_named():
    def zone(name, low):
        return NoFlyZone(name, ((low, -5.0), (low + 5.0, -5.0), (low + 5.0, 5.0), (low, 5.0)), 0.0, 50.0)

    site = place()
    zones = zone("near", 65.0), zone("further", 150.0), zone("far", 900.0)
    risk = assess_ground_risk(
        flown(ROUND), replace(site, airspace=replace(site.airspace, no_fly=zones)), replace(CALM, speed_m_s=15.0)
    )
    found = [(each.severity, each.place) for each in risk.findings if each.code == "sora-no-fly"]
    assert found == [(Severity.WARNING, "near"), (Severity.NOTE, "further")]


# Over terrain, each place has its own height


def hill(use="on", half=900.0, step=15.0):
    """A ridge beside the flight and a valley on its other side."""
    nodes = np.arange(-half, half + 0.5 * step, step)
    x, y = np.meshgrid(nodes, nodes)
    z = 25.0 * np.tanh((y - 120.0) / 60.0) - 30.0 / (1.0 + ((x - 150.0) / 70.0) ** 2)
    return terrain_of(HeightField(-half, -half, step, z), z, z, use=use)


SLOPES = pytest.mark.parametrize("terrain", [sloping("on", half=900.0), hill()])


@SLOPES
def test_over_terrain_the_buffer_is_no_wider_than_for_the_lowest_ground_and_no_narrower_than_for_the_highest(terrain):
    risk = assess_ground_risk(flown(ROUND), replace(place(), terrain=terrain), CALM)
    widest, narrowest = risk.value_of("S_GRB"), risk.value_of("S_GRB-")
    assert 0.0 < narrowest < widest
    tolerance_m = CALM.arc_tolerance_m
    outer = grown(risk.contingency, widest, tolerance_m)
    assert outer.buffer(tolerance_m).covers(risk.buffer)
    assert risk.buffer.covers(risk.contingency.buffer(narrowest, quad_segs=32))
    assert risk.buffer.area < 0.99 * outer.area


@pytest.mark.long
@SLOPES
@settings(deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_no_fall_from_the_contingency_volume_ends_outside_of_the_buffer_over_terrain(terrain, seed):
    """A fall of any drag, followed step by step until it meets the terrain, by the equations of motion alone."""
    rng = np.random.default_rng(seed)
    request = replace(CALM, wind_m_s=8.0)
    risk = _over(terrain, request)
    low, high = np.array(risk.contingency.bounds).reshape(2, 2)
    while True:
        start = low + rng.random(2) * (high - low)
        if risk.contingency.covers(shapely.Point(start)):
            break
    course, wind = rng.uniform(-math.pi, math.pi, 2)
    speed, wind_m_s, drag = risk.value_of("v"), risk.value_of("w"), risk.value_of("k") * rng.random()
    air = wind_m_s * np.array([math.cos(wind), math.sin(wind), 0.0])
    velocity = np.array([speed * math.cos(course), speed * math.sin(course), risk.value_of("c") * rng.random()])
    position = np.array([*start, risk.ground_z_m + risk.contingency_top_m])
    step_s = 0.01
    while position[2] > float(risk.ground.terrain.ground.heights_m(position[None])[0]):
        velocity = velocity - step_s * (drag * np.linalg.norm(velocity) * velocity + np.array([0.0, 0.0, 9.81]))
        position = position + step_s * (velocity + air)
    assert risk.buffer.distance(shapely.Point(position[:2])) <= 0.0


@lru_cache(maxsize=4)
def _over(terrain, request):
    return assess_ground_risk(flown(ROUND), replace(place(), terrain=terrain), request)


def test_on_level_terrain_the_buffer_is_that_without_terrain():
    nodes = np.zeros((121, 121))
    flat = terrain_of(HeightField(-900.0, -900.0, 15.0, nodes), nodes, nodes, use="on")
    with_terrain = assess_ground_risk(flown(ROUND), replace(place(), terrain=flat), CALM)
    without = assess_ground_risk(flown(ROUND), place(), CALM)
    assert with_terrain.value_of("S_GRB-") == with_terrain.value_of("S_GRB") == without.value_of("S_GRB")
    assert with_terrain.buffer.symmetric_difference(without.buffer).area < 0.01 * without.buffer.area
    assert "S_GRB-" not in {each.symbol for each in without.quantities}, "what is off costs nothing"


def test_a_height_above_the_place_decides_on_other_rules_and_on_the_cells_of_people():
    """30 m above a slope that falls 100 m within the buffer is not above 120 m."""
    z = _falls(151, 20.0)
    steep = terrain_of(HeightField(-1500.0, -1500.0, 20.0, z), z, z, use="on")
    risk = assess_ground_risk(flown(ROUND), replace(place(), terrain=steep), replace(CALM, wind_m_s=8.0))
    assert risk.value_of("H_FG") > 120.0 > risk.value_of("H_AGL")
    assert "sora-height" not in {each.code for each in risk.findings}


def _falls(n, step):
    """Level below the flight, and far down some way east of it."""
    x = -1500.0 + step * np.arange(n)
    return np.tile(np.where(x > 150.0, -np.minimum(x - 150.0, 100.0), 0.0), (n, 1))


def test_where_a_part_of_the_ground_is_not_known_the_width_for_the_lowest_is_kept():
    terrain = sloping("on", half=900.0)
    z = surfaces(terrain).ground.z_m.copy()
    z[:, : z.shape[1] // 2] = np.nan
    holes = terrain_of(HeightField(-900.0, -900.0, 10.0, z), z, z, use="on")
    risk = assess_ground_risk(flown(ROUND), replace(place(), terrain=holes), CALM)
    west = risk.contingency.bounds[0] - risk.value_of("S_GRB")
    assert risk.buffer.bounds[0] <= west + 1e-6
    nothing = np.full_like(z, np.nan)
    unknown = terrain_of(HeightField(-900.0, -900.0, 10.0, nothing), nothing, nothing, use="on")
    none = assess_ground_risk(flown(ROUND), replace(place(), terrain=unknown), CALM)
    assert none.value_of("S_GRB-") == none.value_of("S_GRB")

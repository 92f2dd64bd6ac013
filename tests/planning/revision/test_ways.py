"""Ways between single places: clear where they can be, as short as the planner's table has them, straight otherwise."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from planning.aircraft.catalogue import profile
from planning.parameters import FlightRules
from planning.revision.edits import HOME, RoadmapPaths
from planning.routing.legs import build_leg_table
from planning.routing.roadmap import build_roadmap, leg_length
from planning.site.bundled import SCENES
from planning.site.free_space import free_space
from tests.planning.plan_cases import dense_points, distances, inside_zone, kiosk, solid_triangles
from tests.planning.revision.cases import prepared
from tests.planning.routing.test_legs import DISTANCE_M, allowed_stops, room

M3E = profile("m3e").aircraft


def ways_of(name: str) -> RoadmapPaths:
    return RoadmapPaths.over(prepared(name).problem.roadmap, M3E, FlightRules())


@pytest.mark.slow
def test_ways_keep_every_distance_and_are_those_of_a_table_of_the_same_places() -> None:
    paths, model = ways_of("kiosk"), kiosk()
    places = [HOME, *(tuple(stop) for stop in allowed_stops(model, 8, height_m=6.0).tolist())]
    pairs = [(a, b) for a, b in itertools.permutations(range(len(places)), 2) if b != 0]
    found = paths.between([(places[a], places[b]) for a, b in pairs])
    triangles, n_around = solid_triangles(model), 0
    for (a, b), way in zip(pairs, found, strict=True):
        path = np.array(way)
        points = dense_points(path, 0.5)
        assert distances(points, triangles).min() >= DISTANCE_M
        assert not any(inside_zone(points, zone).any() for zone in model.site.airspace.no_fly)
        stops = np.array([place for place in (places[a], places[b]) if place is not None])
        table = build_leg_table(paths.roadmap, stops, paths.metric)
        drawn = table.polyline(len(stops) - 1, len(stops))
        np.testing.assert_allclose(path[[0, -1]], drawn[[0, -1]], atol=1e-4)
        cost, of_table = (paths.metric(np.diff(line, axis=0)).sum() for line in (path, drawn))
        assert cost == pytest.approx(of_table, rel=1e-3)
        n_around += len(way) > 2
    assert n_around > 10
    backwards = paths.between([(places[b], places[a]) for a, b in pairs])
    length, back = (np.array([leg_length(np.diff(way, axis=0)).sum() for way in part]) for part in (found, backwards))
    np.testing.assert_allclose(length, back, rtol=0.05)


def test_the_way_from_a_home_on_the_border_of_the_airspace_leads_around_the_building() -> None:
    office = SCENES["office"]()
    border = replace(office, site=replace(office.site, home_enu_m=(0.0, -70.0, 0.0)))
    paths = RoadmapPaths.over(build_roadmap(free_space(border, DISTANCE_M)), M3E, FlightRules())
    (way,) = paths.between([(HOME, (0.0, 30.0, 20.0))])
    assert distances(dense_points(np.array(way), 0.5), solid_triangles(border)).min() >= DISTANCE_M


def test_ways_to_places_that_are_not_allowed_or_not_reached_are_straight() -> None:
    space = free_space(room(), DISTANCE_M)
    paths = RoadmapPaths.over(build_roadmap(space), M3E, FlightRules())
    outside, hall, wall, sky = (-30.0, -30.0, 20.0), (35.0, 35.0, 16.0), (15.5, 30.0, 10.0), (0.0, 0.0, 90.0)
    for place in (hall, wall, sky):
        assert paths.between([(outside, place), (place, outside)]) == [(outside, place), (place, outside)]
        (from_home, to_home) = paths.between([(HOME, place), (place, HOME)])
        assert from_home == to_home[::-1]
        home, top = (tuple(point.tolist()) for point in (space.home_enu_m, space.column_top_enu_m))
        assert from_home == (home, pytest.approx(top, abs=1e-4), place)


def test_ways_in_wind_that_allows_no_flight_are_the_shortest() -> None:
    paths = RoadmapPaths.over(prepared("kiosk").problem.roadmap, M3E, FlightRules(wind_m_s=20.0))
    assert paths.metric is leg_length
    (way,) = paths.between([((0.0, -12.0, 12.0), (8.0, -14.0, 10.0))])
    assert way == ((0.0, -12.0, 12.0), (8.0, -14.0, 10.0))


def test_a_way_from_a_place_to_itself_has_two_vertices() -> None:
    place = (0.0, -12.0, 12.0)
    assert ways_of("kiosk").between([(place, place)]) == [(place, place)]
    assert ways_of("kiosk").between([]) == []


def test_flights_from_home_leave_straight_up() -> None:
    (way,) = ways_of("kiosk").between([(HOME, (10.0, -14.0, 20.0))])
    assert way[0] == (0.0, -30.0, 0.0)
    assert way[1][:2] == way[0][:2]
    assert way[1][2] >= 2.0
    length = sum(math.dist(a, b) for a, b in itertools.pairwise(way))
    assert length < 1.2 * (20.0 + math.dist((0.0, -30.0), (10.0, -14.0)))

"""Bodies that panes mirror and the site lacks: found where they stand, and nowhere else."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planning.aircraft.catalogue import profile
from planning.parameters import Constraints
from planning.plan import viewpoint_arrays
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.revision.seen_bodies import CELL_M, GAP_M, MirroredPlaces, bodies_not_in, with_bodies
from planning.site.free_space import unchecked_space
from planning.site.records import SiteModel
from planning.viewpoints.prepare import prepare
from tests.planning.plan_cases import kiosk

NOWHERE = np.zeros((0, 3))
FRONT = np.array([[-6.0, 30.0, 4.0], [6.0, 32.0, 16.0]])
"""Of a neighbour north of the kiosk, which its site does not have."""


AWAY = np.array([0.0, 25.0, 0.0])


def seen(low, high, n=4000, seed=0, halves=(0, 1)) -> MirroredPlaces:
    """Rays that end all over a box, of twenty photos."""
    rng = np.random.default_rng(seed)
    photos = rng.integers(0, 20, n)
    places, half = rng.uniform(low, high, (n, 3)), np.array(halves)[photos % len(halves)]
    return MirroredPlaces(places - AWAY, places, np.full(n, 25.0), photos, half)


def test_a_neighbour_that_the_site_lacks_is_found_where_it_stands():
    (body,) = bodies_not_in(kiosk(), seen(*FRONT), NOWHERE, 8.0)
    assert np.array_equal(body.low_enu_m, FRONT[0])
    assert np.array_equal(body.size_m, FRONT[1] - FRONT[0])
    corners = body.mesh().vertices_enu_m
    assert np.array_equal(np.stack([corners.min(axis=0), corners.max(axis=0)]), FRONT)


def test_what_one_half_of_the_photos_saw_alone_is_believed_of_none():
    assert bodies_not_in(kiosk(), seen(*FRONT, halves=(0,)), NOWHERE, 8.0) == []


def test_what_is_on_the_site_already_is_not_lacking():
    site_model = kiosk()
    low, high = site_model.building.vertices_enu_m.min(axis=0), site_model.building.vertices_enu_m.max(axis=0)
    assert bodies_not_in(site_model, seen(low - 1.0, high + 1.0), NOWHERE, 8.0) == []
    ground = site_model.site.airspace.ground_z_m
    assert bodies_not_in(site_model, seen([-20, 20, ground - 8], [20, 40, ground + 1]), NOWHERE, 8.0) == []


def test_where_the_aircraft_was_is_nothing():
    flown = np.array([[0.0, 31.0, 10.0]])
    assert bodies_not_in(kiosk(), seen(*FRONT), flown, 12.0) == []


def test_what_as_many_rays_go_through_as_end_there_is_empty():
    there = seen(*FRONT)
    behind = seen(*FRONT, n=12_000, seed=1)
    through = MirroredPlaces(
        np.concatenate([there.panes_enu_m, behind.panes_enu_m]),
        np.concatenate([there.places_enu_m, behind.places_enu_m + 2.0 * AWAY]),
        np.concatenate([there.distances_m, behind.distances_m + 50.0]),
        np.concatenate([there.photos, behind.photos]),
        np.concatenate([there.halves, behind.halves]),
    )
    found = bodies_not_in(kiosk(), through, NOWHERE, 8.0)
    assert all(body.low_enu_m[1] > FRONT[1][1] for body in found)
    assert found, "what the rays end at is there"


def test_nothing_seen_is_no_body():
    none = np.zeros(0, np.int64)
    assert bodies_not_in(kiosk(), MirroredPlaces(NOWHERE, NOWHERE, np.zeros(0), none, none), NOWHERE, 8.0) == []


@given(seed=st.integers(0, 2**32 - 1), x=st.floats(-40, 40), y=st.floats(-40, 40), side=st.floats(1, 20))
@settings(max_examples=25)
def test_no_body_touches_what_the_site_has(seed, x, y, side):
    site_model = kiosk()
    found = bodies_not_in(site_model, seen([x, y, -2.0], [x + side, y + side, 12.0], seed=seed), NOWHERE, 1.0)
    solids = unchecked_space(site_model, 0.0).solids
    for body in found:
        assert (solids.clearance_m(body.cells_m + 0.5 * CELL_M) > GAP_M).all()
        assert (body.cells_m[:, 2] > site_model.site.airspace.ground_z_m).all()


@pytest.mark.slow
def test_a_flight_over_the_site_with_its_bodies_keeps_clear_of_them():
    plain: SiteModel = kiosk()
    near = Constraints(min_distance_m=5.0)
    open_plan = plan_flight(plain, PlanRequest(n_views=8, constraints=near, time_budget_s=2.0)).plan
    place = viewpoint_arrays(open_plan.viewpoints).positions_enu_m[0]
    low = np.floor((place - 3.0) / CELL_M) * CELL_M
    bodies = bodies_not_in(plain, seen(low, low + 6.0), NOWHERE, 0.0)
    with_them = with_bodies(plain, bodies)
    assert with_them.sha256 == plain.sha256
    assert bodies
    assert prepare(plain, profile("m3e").camera, near).problem.space.is_allowed(place[None])[0]
    assert not prepare(with_them, profile("m3e").camera, near).problem.space.is_allowed(place[None])[0]

"""Before a link is opened: the item limit, and the battery of a simulation."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.services.fly.connection import PartlyDischarged, with_charge
from groundstation.services.mission.readiness import split_to_fit, too_long
from missions.mavlink.autopilots import Autopilot, facts
from missions.mavlink.items import photos_that_fit
from missions.simulator.airframe.state import Target
from missions.simulator.build import make_airframe
from tests.services.live_cases import planned


def with_long_sortie(n):
    """The plan, its one sortie naming its views over and over."""
    _, plan = planned()
    ids = plan.sorties[0].viewpoint_ids
    return replace(plan, sorties=(replace(plan.sorties[0], viewpoint_ids=(ids * n)[:n]),))


@given(st.sampled_from([*Autopilot]), st.integers(1, 300))
def test_a_sortie_is_too_long_from_one_photo_more_than_fit(autopilot, n):
    found = too_long(with_long_sortie(n), [autopilot])
    assert (found is not None) == (n > photos_that_fit(autopilot))


def test_where_either_autopilot_may_answer_the_one_with_less_room_counts():
    n = min(map(photos_that_fit, Autopilot)) + 1
    assert too_long(with_long_sortie(n - 1)) is None
    found = too_long(with_long_sortie(n))
    assert (found.autopilot, found.longest, found.limit) == (min(Autopilot, key=photos_that_fit), n, n - 1)
    assert facts(found.autopilot).max_items == min(facts(autopilot).max_items for autopilot in Autopilot)


def test_views_are_shared_out_so_that_each_is_in_one_sortie_that_fits():
    model, plan = planned()
    found = replace(too_long(with_long_sortie(300)), limit=4)
    anew = split_to_fit(plan, model, found)
    flown = [view_id for each in anew.sorties for view_id in each.viewpoint_ids]
    assert sorted(flown) == sorted(plan.sorties[0].viewpoint_ids)
    assert max(len(each.viewpoint_ids) for each in anew.sorties) <= 4
    assert anew.viewpoints == plan.viewpoints


def airframe(sags):
    model, plan = planned()
    return make_airframe(plan, model, plan.sorties[0], settings={"battery sag": "on" if sags else "off"})


@pytest.mark.parametrize("sags", [True, False])
def test_a_battery_that_was_flown_before_is_drawn_further_as_a_full_one_is(sags):
    full, decisions = airframe(sags)
    worn = with_charge(airframe(sags)[0], 0.6, decisions)
    here = full.truth.position_enu_m
    hover = Target((here[0], here[1], here[2] + 20.0), 5.0, 3.0, 3.0, 0.0, 1.0, 0.0)
    assert full.battery.remaining == 1.0
    assert worn.battery.remaining == pytest.approx(0.6)
    for _ in range(20):
        full.step(3.0, hover)
        worn.step(3.0, hover)
    assert worn.battery.remaining == pytest.approx(full.battery.remaining - 0.4)
    assert worn.battery.consumed_mah > full.battery.consumed_mah
    assert (worn.battery.voltage_v < full.battery.voltage_v) == sags
    assert worn.truth == full.truth


def test_an_empty_battery_stays_empty_and_a_full_one_is_the_airframe_itself():
    frame, decisions = airframe(sags=False)
    assert with_charge(frame, 1.0, decisions) is frame
    assert with_charge(frame, 0.0, decisions).battery.remaining == 0.0
    with pytest.raises(ValueError, match="charge: expected 0 to 1"):
        PartlyDischarged(frame, 1.2, sags=False)

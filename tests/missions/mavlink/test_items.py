"""A photo must never be lost or turned: the items, run by slow models of both autopilots."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings

from missions.mavlink.autopilots import Autopilot
from missions.mavlink.items import MissionItem, mission_items, plain
from missions.mission.build import missions_from_plan
from missions.mission.export_choices import HeightReference
from missions.mission.model import Mission, altitude_amsl_m
from planning.parameters import FlightRules
from planning.plan import Plan, Viewpoint
from tests.missions.mavlink.reference_autopilots import Px4Twin, ReferenceArduPilot, Shot
from tests.missions.plans import HONG_KONG, example_plan, make_plan, plans, ring

ABOVE = HeightReference.ABOVE_TAKEOFF
ARDUPILOT, PX4 = Autopilot.ARDUPILOT, Autopilot.PX4


def home_of(mission: Mission) -> tuple[float, float, float]:
    home = mission.takeoff
    return home.lat_deg, home.lon_deg, home.height_ellipsoid_m


def check_photos(shots: list[Shot], mission: Mission, plan: Plan) -> None:
    views = {view.id: view for view in plan.viewpoints}
    wanted = [views[photo.viewpoint_id] for waypoint in mission.waypoints for photo in waypoint.photos]
    assert len(shots) == len(wanted)
    for shot, view in zip(shots, wanted, strict=True):
        assert not shot.moving
        np.testing.assert_allclose(shot.position, view.position_enu_m, atol=0.005)
        assert abs((shot.heading - view.heading_deg + 180.0) % 360.0 - 180.0) <= 0.006
        assert shot.pitch == pytest.approx(view.gimbal_pitch_deg, abs=0.006)
        assert shot.steady_for_s >= max(1.0, plan.rules.photo_s) - 1e-6
    assert all(b.t_s - a.t_s >= 0.1 for a, b in itertools.pairwise(shots))


@pytest.mark.slow
@pytest.mark.parametrize("two_axis", [False, True])
@given(plan=plans())
@settings(max_examples=40)
def test_ardupilot_takes_every_photo_in_its_place_and_turned_to_it(plan: Plan, two_axis: bool) -> None:
    for mission in missions_from_plan(plan):
        reference = ReferenceArduPilot(mission.origin, home_of(mission), two_axis=two_axis)
        shots = reference.run(mission_items(mission, ARDUPILOT, ABOVE))
        check_photos(shots, mission, plan)
        assert reference.n_dropped == 0


@pytest.mark.slow
@given(plan=plans())
@settings(max_examples=40)
def test_px4_takes_every_photo_in_its_place_and_turned_to_it(plan: Plan) -> None:
    for mission in missions_from_plan(plan):
        shots = Px4Twin(mission.origin, home_of(mission)).run(mission_items(mission, PX4, ABOVE))
        check_photos(shots, mission, plan)


def test_hard_turns_on_short_legs_are_waited_for() -> None:
    """180 degree turns and 60 degree tilts between views one metre apart, the case that loses 7 of 8 naive photos."""
    views = [Viewpoint(f"v{i}", (10.0 + i, 0.0, 25.0), 180.0 * (i % 2), -40.0 + 60.0 * (i % 2)) for i in range(8)]
    plan = make_plan([(views, {})], rules=FlightRules(settle_s=0.0))
    (mission,) = missions_from_plan(plan)
    reference = ReferenceArduPilot(mission.origin, home_of(mission))
    check_photos(reference.run(mission_items(mission, ARDUPILOT, ABOVE)), mission, plan)
    check_photos(Px4Twin(mission.origin, home_of(mission)).run(mission_items(mission, PX4, ABOVE)), mission, plan)


class TestTheTwinSeesWhatWasMeasured:
    """The model must fail where the real simulation failed, or it proves nothing."""

    def mission(self) -> Mission:
        views = [Viewpoint(f"v{i}", (10.0 + i, 0.0, 25.0), 180.0 * (i % 2), -10.0) for i in range(8)]
        return missions_from_plan(make_plan([(views, {})]))[0]

    def ours(self) -> list[MissionItem]:
        return list(mission_items(self.mission(), ARDUPILOT, ABOVE))

    def run(self, items: list[MissionItem], two_axis: bool = False) -> ReferenceArduPilot:
        reference = ReferenceArduPilot(HONG_KONG, home_of(self.mission()), two_axis=two_axis)
        reference.run(items)
        return reference

    def test_naive_order_loses_nearly_all_photos_on_short_legs(self) -> None:
        items = self.ours()
        naive = []
        for item in items:
            if item.command == 16:
                naive.append(replace(item, params=(0.0, *item.params[1:])))
            elif item.command in (203, 93):
                continue
            elif item.command == 115:
                held = item
            elif item.command != 205:
                naive.append(item)
            if item.command == 16 and len(naive) > 4:
                naive += [held, plain(203, 0, 0, 0, 0, 1)]
        reference = self.run(naive)
        assert reference.n_dropped >= 6

    def test_mount_after_yaw_turns_photos_of_the_south_to_the_north_on_a_gimbal_without_pan(self) -> None:
        items = self.ours()
        swapped = list(items)
        for i, (a, b) in enumerate(itertools.pairwise(items)):
            if a.command == 205 and b.command == 115:
                swapped[i : i + 2] = [b, a]
        south = [shot.heading for shot in self.run(swapped, two_axis=True).shots[1::2]]
        assert all(abs((heading + 180.0) % 360.0 - 180.0) < 60.0 for heading in south)
        assert {round(shot.heading) % 360 for shot in self.run(swapped).shots} == {0, 180}

    def test_without_delay_the_camera_turns_on_in_the_instant_of_the_photo(self) -> None:
        rushed = [item for item in self.ours() if item.command != 93]
        assert min(shot.steady_for_s for shot in self.run(rushed).shots) == 0.0

    def test_hold_of_half_a_second_is_none(self) -> None:
        items = [replace(i, params=(0.9, *i.params[1:])) if i.command == 16 else i for i in self.ours()]
        shots = self.run(items).shots
        assert any(abs((shot.heading - 180.0 * (i % 2) + 180.0) % 360.0 - 180.0) > 10.0 for i, shot in enumerate(shots))


def of_command(items: tuple[MissionItem, ...], command: int) -> list[MissionItem]:
    return [item for item in items if item.command == command]


def places(items: tuple[MissionItem, ...]) -> list[MissionItem]:
    """Waypoints, without those that only keep the aircraft where it is."""
    waypoints = of_command(items, 16)
    return [b for a, b in zip([None, *waypoints], waypoints, strict=False) if a is None or a.params[4:] != b.params[4:]]


def test_order_of_the_items_of_one_view() -> None:
    (mission,) = missions_from_plan(make_plan([(ring(1), {})]))
    ardupilot = [item.command for item in mission_items(mission, ARDUPILOT, ABOVE)]
    assert ardupilot == [22, 178, 16, 205, 115, 16, 203, 93, 16, 21]
    assert [i.command for i in mission_items(mission, PX4, ABOVE)] == [22, 178, 1001, 16, 1000, 16, 2000, 16, 16, 21]


def test_px4_stays_at_each_view_without_a_delay_which_has_no_height() -> None:
    """With an item at hand that has no height, PX4 of 2025 flew towards sea level when it corrected its home."""
    for mission in missions_from_plan(example_plan()):
        items = mission_items(mission, PX4, ABOVE)
        assert not of_command(items, 93)
        triggers = [number for number, item in enumerate(items) if item.command == 2000]
        assert len(triggers) == mission.n_photos
        for number in triggers:
            view, stay = items[number - 1], items[number + 1]
            assert stay == replace(view, params=(stay.params[0], *view.params[1:]))
            assert stay.params[0] >= 1.0


def test_holds_are_whole_seconds_on_ardupilot_and_waypoints_without_photo_stop_too() -> None:
    for mission in missions_from_plan(example_plan()):
        waypoints = of_command(mission_items(mission, ARDUPILOT, ABOVE), 16)
        holds = [item.params[0] for item in waypoints]
        assert all(hold == math.floor(hold) for hold in holds)
        assert [hold >= 2 for hold in holds] == [bool(w.photos) for w in mission.waypoints]
        assert min(holds) >= 1


def test_settling_time_of_the_plan_is_kept() -> None:
    mission = missions_from_plan(example_plan(rules=FlightRules(settle_s=3.2)))[0]
    with_photo = [i for i, w in enumerate(mission.waypoints) if w.photos]
    ardupilot = of_command(mission_items(mission, ARDUPILOT, ABOVE), 16)
    assert all(ardupilot[i].params[0] >= 4.0 for i in with_photo)
    px4 = mission_items(mission, PX4, ABOVE)
    assert all(px4[i - 1].params[0] >= 3.2 for i, item in enumerate(px4) if item.command == 2000)


@pytest.mark.parametrize("autopilot", list(Autopilot))
def test_heights_are_above_takeoff_or_above_sea_level_as_asked(autopilot: Autopilot) -> None:
    mission = missions_from_plan(example_plan())[0]
    relative, absolute = (places(mission_items(mission, autopilot, r)) for r in (ABOVE, HeightReference.AMSL))
    for above, amsl, waypoint in zip(relative, absolute, mission.waypoints, strict=True):
        point = waypoint.position
        assert (above.frame, amsl.frame) == (3, 0)
        assert above.params[6] == pytest.approx(mission.height_above_takeoff_m(point), abs=1e-4)
        assert amsl.params[6] == pytest.approx(altitude_amsl_m(point), abs=1e-4)
    with pytest.raises(ValueError, match="ellipsoid"):
        mission_items(mission, autopilot, HeightReference.ELLIPSOID)


@pytest.mark.slow
@given(plan=plans())
@settings(max_examples=20)
def test_items_hold_what_each_autopilot_takes(plan: Plan) -> None:
    for mission in missions_from_plan(plan):
        for item in mission_items(mission, ARDUPILOT, ABOVE):
            assert not any(math.isnan(value) for value in item.params)
            if item.command == 115:
                assert 0.0 <= item.params[0] < 360.0
        for item in mission_items(mission, PX4, ABOVE):
            assert item.frame == (3 if item.command in (16, 21, 22) else 2)


def test_takeoff_climbs_the_column_and_landing_is_below_the_last_waypoint() -> None:
    mission = missions_from_plan(example_plan())[0]
    items = mission_items(mission, ARDUPILOT, ABOVE)
    home = (mission.takeoff.lat_deg, mission.takeoff.lon_deg)
    assert items[0].params[4:6] == pytest.approx(home, abs=1e-9)
    assert items[0].params[6] == pytest.approx(20.0, abs=1e-3)
    assert items[-1].params[4:] == pytest.approx((*home, 0.0), abs=1e-8)

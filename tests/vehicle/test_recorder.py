"""What a watched flight leaves behind when the radio loses messages, and when the camera fails."""

from collections import Counter
from functools import cache

import pytest

from groundstation.vehicle.conduct import conduct
from groundstation.vehicle.flight_run import FlightRun
from groundstation.vehicle.orders import sortie_orders
from groundstation.vehicle.recorder import Recorder
from groundstation.vehicle.run_records import RunOptions
from missions.build import missions_from_plan
from missions.flight.lost_reports import n_lost
from missions.flight.matching import match_flight
from missions.flight.outcome import Reason
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.messages import Attitude, CameraImageCaptured, GimbalDeviceAttitudeStatus
from missions.simulator.build import make_airframe
from missions.simulator.effects.link_loss import LossyLink
from missions.simulator.server import DirectLink
from missions.simulator.vehicle import SimulatedVehicle
from tests.missions.simulator.flying import planned

IDENTITY = (1.0, 0.0, 0.0, 0.0)


@cache
def flown(autopilot, loss, seed):
    """The record of a flight over a radio, and its plan."""
    model, plan = planned("single-panel", 12)
    (mission,) = missions_from_plan(plan)
    orders = sortie_orders(plan, model, mission)
    airframe, _ = make_airframe(plan, model, plan.sorties[0])
    vehicle = SimulatedVehicle(autopilot, airframe, model.site.origin, orders.home_enu_m)
    direct = DirectLink(vehicle)
    run = FlightRun(orders, RunOptions(autopilot=autopilot, sets_parameters=True), "simulation")
    outcome = conduct(run, LossyLink(direct, loss, (), direct.clock, seed), direct.clock)
    assert outcome.error is None
    assert len(vehicle.shots) == len(plan.viewpoints)
    return outcome.record, plan


@pytest.mark.parametrize("autopilot", list(Autopilot))
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_photos_whose_reports_the_radio_lost_are_not_taken_for_missing_ones(autopilot, seed):
    """All were taken: what lies between the first and the last that was told of is known to be."""
    record, plan = flown(autopilot, 0.25, seed)
    matching = match_flight(plan, (record,))
    reasons = [match.reason for match in matching.views]
    taken = [i for i, reason in enumerate(reasons) if reason is Reason.TAKEN]
    assert set(reasons[taken[0] : taken[-1]]) <= {Reason.TAKEN, Reason.REPORT_LOST}
    counts = Counter(reasons)
    assert len(taken) == len(record.photos)
    assert counts[Reason.REPORT_LOST] == n_lost(record)


def test_a_photo_that_failed_is_an_event_and_no_photo():
    recorder = Recorder("test", Autopilot.PX4)
    recorder.take(Attitude(1000, 0.0, 0.0, 0.0))
    recorder.take(CameraImageCaptured(1500, 0, 1, 0, 0, 0, 0, IDENTITY, 7, 0))
    assert not recorder.log.photos
    (event,) = recorder.log.events
    assert (event.time_s, event.code) == (1.5, "camera-failed")
    assert "photo 7" in event.text


@pytest.mark.parametrize(
    ("flags", "from_north"), [(0, False), (32, False), (64, True), (16, True), (32 | 16, False), (12, False)]
)
def test_the_gimbals_flags_say_from_where_its_yaw_counts(flags, from_north):
    recorder = Recorder("test", Autopilot.PX4)
    recorder.take(GimbalDeviceAttitudeStatus(0, 0, 1000, flags, IDENTITY))
    assert bool(recorder.log.gimbal_headings) == from_north
    assert bool(recorder.log.gimbal_yaws) != from_north

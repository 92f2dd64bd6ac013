"""What a watched flight leaves behind when the radio loses messages."""

from collections import Counter
from functools import cache

import pytest

from groundstation.vehicle.orders import sortie_orders
from groundstation.vehicle.sortie.conduct import conduct
from groundstation.vehicle.sortie.flight_run import FlightRun
from groundstation.vehicle.sortie.run_records import RunOptions
from missions.flight.matching import match_flight, n_lost
from missions.flight.outcome import Reason
from missions.mavlink.autopilots import Autopilot
from missions.mission.build import missions_from_plan
from missions.simulator.build import make_airframe
from missions.simulator.effects.link_loss import LossyLink
from missions.simulator.server import DirectLink
from missions.simulator.vehicle import SimulatedVehicle
from tests.missions.simulator.flying import planned
from tests.slow import slow


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


@pytest.mark.long
@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("autopilot", "seed"),
    [
        (Autopilot.ARDUPILOT, 0),
        slow(Autopilot.PX4, 0),
        slow(Autopilot.ARDUPILOT, 1),
        (Autopilot.PX4, 1),
    ],
)
def test_photos_whose_reports_the_radio_lost_are_not_taken_for_missing_ones(autopilot, seed):
    """All were taken: PX4's camera tells of them when asked again, ArduPilot's says how many there were."""
    record, plan = flown(autopilot, 0.25, seed)
    matching = match_flight(plan, (record,))
    reasons = [match.reason for match in matching.views]
    counts = Counter(reasons)
    assert set(counts) <= {Reason.TAKEN, Reason.REPORT_LOST}
    assert counts[Reason.TAKEN] == len(record.photos)
    assert counts[Reason.REPORT_LOST] == n_lost(record)
    assert (record.counted_before, record.counted_after) == (0, len(reasons))
    if autopilot is Autopilot.PX4:
        assert counts[Reason.TAKEN] == len(reasons)
    else:
        assert counts[Reason.REPORT_LOST] > 0

"""A fence that another program has put on the vehicle, in the real window: told, and removed by a typed word alone."""

import pytest

from groundstation.services.fly.events import Request
from groundstation.vehicle.preflight import FOREIGN_FENCE, Remedy
from missions.mavlink.fence import FenceCircle, fence_items
from missions.mavlink.transfer.exchange import MissionType
from missions.mavlink.transfer.wire_items import to_wire
from missions.simulator.autopilot.mission_store import stored
from tests.gui.driving import clicked, escape, turn_until
from tests.gui.fly.test_fly_page import answer, connect_radio, controller, page, radio, remedy
from tests.services.live_cases import Reopening

__all__ = ["controller", "page", "radio"]


CIRCLE = 5003
"""MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION."""


class Fenced(Reopening):
    """The vehicle at a radio, with a fence around a place 2 km away."""

    def open(self, orders, clock, observe):
        is_first = self._opened is None
        opened = super().open(orders, clock, observe)
        if is_first:
            store, autopilot = opened.simulated.stores.fence, opened.simulated.autopilot
            circle = FenceCircle(orders.home.lat_deg + 0.02, orders.home.lon_deg, 100.0, is_inclusion=True)
            store._items = [
                stored(item, autopilot) for item in to_wire(fence_items([circle]), autopilot, MissionType.FENCE)
            ]
        return opened

    @property
    def fence(self):
        return self._opened.simulated.stores.fence.items


@pytest.mark.slow
def test_a_fence_of_another_program_goes_by_a_typed_word_alone(application, controller, page, monkeypatch):
    fenced = Fenced(parameters={"FENCE_ENABLE": 1})
    try:
        connect_radio(application, fenced, page, monkeypatch)
        turn_until(application, lambda: "this sortie has its own, which would replace it" in page.checks.text())
        assert "Geofence of others" in page.checks.text()
        assert not page.buttons.button(Request.START).isEnabled()
        for typed in (answer("go on"), escape):
            with clicked(typed) as asked:
                remedy(application, page, FOREIGN_FENCE, Remedy.OVERRULE)
            assert "type FOREIGN-FENCE" in asked[-1]
            assert [item.command for item in fenced.fence] == [CIRCLE]
        with clicked(answer("foreign-fence")):
            remedy(application, page, FOREIGN_FENCE, Remedy.OVERRULE)
        turn_until(application, lambda: page.buttons.button(Request.START).isEnabled())
        assert CIRCLE not in [item.command for item in fenced.fence]
        assert "was removed, as the pilot said" in page.checks.text()
    finally:
        fenced.end()

"""Reading back what a vehicle holds."""

from collections.abc import Sequence

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from missions.mavlink.autopilots import Autopilot
from missions.mavlink.fence import _CIRCLES, _POLYGONS, Fence, FenceCircle, FencePolygon
from missions.mavlink.items import MissionItem
from missions.mavlink.messages import MissionItemInt
from missions.mavlink.transfer.exchange import MissionType
from missions.mavlink.transfer.wire_items import _item, has_home
from planning.base.errors import MissionError


def fences_of(items: Sequence[MissionItem]) -> tuple[Fence, ...]:
    """Fences of items that were read back; a return point is none, and is left out.

    Raises
    ------
    MissionError
        A polygon is not complete, or an item is no part of a fence.
    """
    fences: list[Fence] = []
    corners: list[tuple[float, float]] = []
    for number, item in enumerate(items, 1):
        lat_deg, lon_deg = item.params[4:6]
        if item.command in _POLYGONS:
            corners.append((lat_deg, lon_deg))
            if len(corners) == item.params[0]:
                fences.append(FencePolygon(tuple(corners), _POLYGONS[item.command]))
                corners = []
                continue
            following = items[number] if number < len(items) else None
            if following is None or (following.command, following.params[0]) != (item.command, item.params[0]):
                raise MissionError(
                    f"fence item {number}: its polygon has {len(corners)} corners; expected {item.params[0]:g}"
                )
        elif item.command in _CIRCLES:
            fences.append(FenceCircle(lat_deg, lon_deg, item.params[0], _CIRCLES[item.command]))
        elif item.command != mavlink.MAV_CMD_NAV_FENCE_RETURN_POINT:
            raise MissionError(f"fence item {number}: the command {item.command} is no part of a fence")
    return tuple(fences)


def from_wire(
    messages: Sequence[MissionItemInt], autopilot: Autopilot, mission_type: MissionType = MissionType.MISSION
) -> tuple[MissionItem, ...]:
    """Items of messages that were read back, without home."""
    flown = messages[1:] if has_home(autopilot, mission_type) else messages
    return tuple(_item(message) for message in flown)

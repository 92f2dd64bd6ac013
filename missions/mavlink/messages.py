"""MAVLink messages as plain records: what state machines and the simulated vehicle speak, without any link.

`MissionItemInt` is MISSION_ITEM_INT. `records.py` makes each record from pymavlink's dialect when it is first asked
for; `messages.pyi` shows them all. Who sent a message stands beside it, in `Received`.
"""

from __future__ import annotations

from missions.mavlink import records
from missions.mavlink.records import Address, Message, Received

__all__ = ["Address", "Message", "Received"]


def __getattr__(name: str) -> type[Message]:
    record = globals()[name] = records.layout(name).record
    return record

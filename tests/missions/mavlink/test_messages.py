from __future__ import annotations

import inspect
import pickle
from dataclasses import MISSING, fields
from pathlib import Path

import pytest

from missions.mavlink import messages
from missions.mavlink.records import MESSAGES, NOTES, layout

STUB = Path(inspect.getfile(messages)).with_suffix(".pyi")
HEAD = """# Written by `python -m tests.missions.mavlink.test_messages` from pymavlink's dialect.

from dataclasses import dataclass

from missions.mavlink.records import Address as Address
from missions.mavlink.records import Message as Message
from missions.mavlink.records import Received as Received
"""


def stub() -> str:
    """`messages.pyi`: the records with the types of their fields, and units or enums beside them."""
    lines = []
    for name in MESSAGES:
        told = layout(name)
        lines += ["", f"# {told.packet.msgname} ({told.packet.id}). {NOTES.get(name, '')}".rstrip()]
        lines += ["@dataclass(frozen=True, slots=True)", f"class {name}(Message):"]
        for each in told.fields:
            value = "" if each.default is MISSING else " = ..."
            lines.append(f"    {each.name}: {each.annotation}{value}" + (f"  # {each.unit}" if each.unit else ""))
    return HEAD + "\n".join(lines) + "\n"


def test_type_checkers_read_what_the_dialect_says() -> None:
    assert STUB.read_text() == stub()


@pytest.mark.parametrize("name", MESSAGES)
def test_record_has_all_fields_of_its_message_and_may_lack_what_mavlink_2_added(name: str) -> None:
    told = layout(name)
    record = getattr(messages, name)
    assert record is told.record
    assert {each.name for each in fields(record)} == set(told.packet.fieldnames)
    required = {each.name for each in fields(record) if each.default is MISSING}
    assert not required & {each.name for each in told.fields if each.is_extension}


def test_records_travel_between_processes() -> None:
    message = messages.MissionAck(1, 1, 0)
    assert pickle.loads(pickle.dumps(message)) == message


def test_a_message_that_is_not_used_is_no_record() -> None:
    with pytest.raises(AttributeError, match="no MAVLink message Dragon is used here"):
        messages.Dragon  # type: ignore[attr-defined]  # noqa: B018


if __name__ == "__main__":
    STUB.write_text(stub())

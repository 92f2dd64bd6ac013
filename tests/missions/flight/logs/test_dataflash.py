"""Our tables of ArduPilot's logs against pymavlink's reader, which turns every record into an object."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from missions.flight.logs.dataflash import MESSAGES_READ, binary_tables, column, text_tables, texts
from tests.missions.flight import log_writers as write
from tests.missions.flight.flights import flown_as_planned
from tests.missions.plans import example_plan


def compare(path: Path) -> int:
    """Check every value of the wanted messages; how many there were."""
    from pymavlink import DFReader

    is_text = path.suffix == ".log"
    judge = DFReader.DFReader_text(str(path)) if is_text else DFReader.DFReader_binary(str(path))
    tables, _ = (text_tables if is_text else binary_tables)(path.read_bytes(), MESSAGES_READ)
    found: dict[str, dict[str, list[object]]] = {}
    while (message := judge.recv_msg()) is not None:
        if message.get_type() in MESSAGES_READ:
            columns = found.setdefault(message.get_type(), {})
            for label, value in message.to_dict().items():
                columns.setdefault(label, []).append(value)
    judge.filehandle.close()
    assert {name for name, table in tables.items() if len(next(iter(table.values())))} == set(found)
    n_values = 0
    for name, columns in found.items():
        for label, values in columns.items():
            numbers = column(tables[name], label) if label in tables[name] else None
            if numbers is not None:
                np.testing.assert_allclose(numbers, np.array(values, np.float64), rtol=1e-9, atol=1e-9)
            elif label in tables[name]:
                assert texts(tables[name], label) == values
            n_values += len(values)
    return n_values


@pytest.mark.few(2)
@pytest.mark.parametrize("name", ["pymavlink_test.BIN", "dronekit_la_log171.bin", "ardupilot_text_underpowered.log"])
def test_real_logs_are_read_as_pymavlink_reads_them(shared_data: Path, name: str) -> None:
    assert compare(shared_data / "logs" / name) > 1000


def test_our_test_writer_writes_what_pymavlink_reads(tmp_path: Path) -> None:
    path = tmp_path / "flight.BIN"
    path.write_bytes(write.dataflash(flown_as_planned(example_plan())[:1], write.log_site()))
    assert compare(path) > 1000

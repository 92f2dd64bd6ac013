"""The fences that this ground station has put on vehicles: only these may be cleared without a pilot's word.

A vehicle keeps its fence when it is switched off, and says of none who put it there. One file for all flights of this
user holds the newest; a fence is entered before it goes up, so that one whose upload broke off is known, too.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from groundstation.services.settings import data_folder
from groundstation.vehicle.orders import SortieOrders, fence_messages
from missions.mavlink.messages import MissionItemInt
from missions.mavlink.transfer.exchange import MissionType
from planning.base.errors import InputError
from planning.base.files import MIB, FileLimit, make_folder
from planning.base.json_file import encoded, expect_format, read_json, to_record, write_atomically
from planning.base.messages import say

FORMAT = "reflight-fences/1"

FENCES_FILE = FileLimit(say("a list of geofences"), 4 * MIB)

LOCK_S = 5.0
"""Longest wait for another window that writes."""

MAX_FENCES = 200
"""Some months of flights; of older ones the pilot is asked."""

Fence = tuple[MissionItemInt, ...]


@dataclass(frozen=True, slots=True)
class _Corner:
    command: int
    frame: int
    n_corners: float
    lat_e7: int
    lon_e7: int


@dataclass(frozen=True, slots=True)
class _Fences:
    format: str
    fences: tuple[tuple[_Corner, ...], ...] = ()


def fences_path() -> Path:
    """Where they are kept."""
    return data_folder() / "flights" / "fences.json"


def own_fences(orders: SortieOrders) -> tuple[tuple[Fence, ...], str]:
    """Fences that were put on vehicles from here, those of a sortie among them, and why they are not known or kept.

    Where the file cannot be read or written, none of an earlier flight is known, so that all are asked about.
    """
    from filelock import FileLock, Timeout

    path = fences_path()
    drawn = (fence_messages(fences, autopilot) for autopilot, fences in orders.fences.items() if fences)
    new = kept = tuple(dict.fromkeys(map(_corners, drawn)))
    problem = ""
    try:
        if new:
            make_folder(path.parent)
            with FileLock(path.with_suffix(".lock"), timeout=LOCK_S):
                before = _read(path)
                kept = tuple(dict.fromkeys((*before, *new)))[-MAX_FENCES:]
                if kept != before:
                    write_atomically(path, encoded(_Fences(FORMAT, kept)))
        else:
            kept = _read(path)
    except (Timeout, InputError, OSError) as error:
        problem = say("geofences of earlier flights are not known from here ({})", str(error))
    return tuple(_items(corners) for corners in kept), problem


def _read(path: Path) -> tuple[tuple[_Corner, ...], ...]:
    if not path.exists():
        return ()
    content = read_json(path, FENCES_FILE)
    expect_format(content, FORMAT, path)
    return to_record(content, _Fences, path).fences


def _corners(items: Fence) -> tuple[_Corner, ...]:
    return tuple(_Corner(item.command, item.frame, float(item.param1), item.x, item.y) for item in items)


def _items(corners: tuple[_Corner, ...]) -> Fence:
    return tuple(_item(seq, each) for seq, each in enumerate(corners))


def _item(seq: int, corner: _Corner) -> MissionItemInt:
    where = (corner.lat_e7, corner.lon_e7)
    return MissionItemInt(
        0, 0, seq, corner.frame, corner.command, 0, 1, corner.n_corners, 0.0, 0.0, 0.0, *where, 0.0, MissionType.FENCE
    )

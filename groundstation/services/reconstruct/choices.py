"""What can be chosen for a training, and what this computer makes of it."""

from __future__ import annotations

import os
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from groundstation.services.reconstruct.folders import DataSetCard
from reconstruction.training.method_registry import DEFAULT_METHOD, method_named, training_methods
from reconstruction.training.parameters import DEFAULT_PRESET, PRESETS, TrainRequest
from reconstruction.training.photos.decoded_photo import DECODING_BYTES_PER_PX, Decoding, decoded_bytes, usual_reduce

LONGEST_MIN = 7 * 24 * 60

USUAL_MEMORY_BYTES = 1 << 30
"""For decoded photos, and as much for rays of glass: what trainings are measured with."""

STREAM_SHARE = 0.75
"""Of that, for the photos that are learned from; the rest is for those that quality is measured on."""

MEMORY_SHARE = 0.25
"""Of the memory that is free, for each of the two, at most: program, splats and the window need theirs."""

PROGRAM_BYTES = 700 << 20
"""Of the process that trains, besides photos and rays: 1.0 GB was measured with 60 small photos."""


@dataclass(frozen=True, slots=True)
class MethodRow:
    """A method.

    Parameters
    ----------
    name, title, what
        For the program, for people, and what it is in one clause.
    light
        What mirrored light is learned with unless something else is asked for; `auto` leaves it to the scene.
    """

    name: str
    title: str
    what: str
    knows_panels: bool
    light: str


def method_rows() -> tuple[MethodRow, ...]:
    """All methods, the usual one first."""
    rows = [
        MethodRow(name, each.title, each.what, each.knows_panels, str(each.settings.get("light", "auto")))
        for name, each in training_methods().items()
    ]
    return tuple(sorted(rows, key=lambda row: row.name != DEFAULT_METHOD))


def preset_rows() -> dict[str, float]:
    """Presets that somebody would wait for, and how long at most, minutes."""
    return {name: each.minutes for name, each in PRESETS.items() if each.minutes is not None}


def preset_for(minutes: float) -> str:
    """The preset whose settings fit a time: that which is nearest to it by factors."""
    rows = preset_rows()
    return min(rows, key=lambda name: max(rows[name] / minutes, minutes / rows[name]))


@dataclass(frozen=True, slots=True)
class TrainChoice:
    """What the window asks for.

    Parameters
    ----------
    minutes
        None: as the preset has it.
    """

    method: str = DEFAULT_METHOD
    preset: str = DEFAULT_PRESET
    minutes: float | None = None
    light: str = "auto"
    on_cuda: bool = False

    @property
    def longest_s(self) -> float | None:
        """How long it may take; None where its preset has no limit."""
        minutes = preset_rows().get(self.preset) if self.minutes is None else self.minutes
        return None if minutes is None else 60.0 * minutes

    def request(self, memory_bytes: int | None = None) -> TrainRequest:
        """What is asked of the training."""
        knows_panels = method_named(self.method).knows_panels
        return TrainRequest(
            self.preset if self.minutes is None else preset_for(self.minutes),
            self.method,
            self.light if knows_panels and self.light != "auto" else None,
            time_limit_s=None if self.minutes is None else 60.0 * self.minutes,
            device="cuda" if self.on_cuda else None,
            memory_bytes=memory_bytes,
        )


@dataclass(frozen=True, slots=True)
class Machine:
    """A computer; None where its system does not say.

    Parameters
    ----------
    cores
        That this program may use.
    """

    cores: int
    memory_bytes: int | None
    free_bytes: int | None


def this_machine() -> Machine:
    """What the system says of itself now."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    total, free = _memory()
    limit = _number(Path("/sys/fs/cgroup/memory.max"))
    used = _number(Path("/sys/fs/cgroup/memory.current"))
    if limit is not None and total is not None and limit < total:
        total = limit
        free = free if used is None or free is None else min(free, max(0, limit - used))
    return Machine(cores, total, free)


def _memory() -> tuple[int | None, int | None]:
    try:
        lines = Path("/proc/meminfo").read_text("ascii").splitlines()
    except OSError:
        try:
            return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"), None
        except (AttributeError, ValueError, OSError):
            return None, None
    found = {name: 1024 * int(rest.split()[0]) for name, _, rest in (line.partition(":") for line in lines) if rest}
    return found.get("MemTotal"), found.get("MemAvailable")


def _number(path: Path) -> int | None:
    try:
        text = path.read_text("ascii").strip()
    except OSError:
        return None
    return int(text) if text.isdigit() else None


@dataclass(frozen=True, slots=True)
class Forecast:
    """What memory a training asks for.

    Parameters
    ----------
    reduce
        Pixels of photos, along each side, that make one that is learned from.
    photos_bytes
        Of all decoded photos.
    least_bytes
        Limit below which not even one of them can be read.
    limit_bytes
        For photos, and as much for rays of glass: the usual, or less where little memory is free.
    needed_bytes
        All in all, at most.
    """

    reduce: int
    photos_bytes: int
    least_bytes: int
    limit_bytes: int
    needed_bytes: int

    @property
    def all_fit(self) -> bool:
        """Whether each photo is read once, and held from then on."""
        return self.photos_bytes + self.least_bytes <= STREAM_SHARE * self.limit_bytes

    @property
    def is_reduced(self) -> bool:
        """Whether less memory is taken than usual."""
        return self.limit_bytes < USUAL_MEMORY_BYTES


def forecast(card: DataSetCard, machine: Machine, choice: TrainChoice) -> Forecast:
    """What memory a training on a data set would ask for on a computer."""
    knows_panels = method_named(choice.method).knows_panels
    lenses = Counter(photo.intrinsics for photo in card.source.photos)
    reduce = usual_reduce(lenses, PRESETS[choice.request().preset].window_px)
    decoding = Decoding(reduce, knows_panels)
    sizes = {lens: decoded_bytes(lens, decoding, card.normal_step) for lens in lenses}
    whole = sum(n * sizes[lens] for lens, n in lenses.items())
    least = DECODING_BYTES_PER_PX * card.largest_px + max(sizes.values())
    free = machine.free_bytes
    limit = USUAL_MEMORY_BYTES if free is None else min(USUAL_MEMORY_BYTES, int(MEMORY_SHARE * free))
    limit = max(limit, int(least / STREAM_SHARE) + 1)
    held = min(whole + least, limit)
    return Forecast(reduce, whole, least, limit, PROGRAM_BYTES + held + (limit if knows_panels else 0))

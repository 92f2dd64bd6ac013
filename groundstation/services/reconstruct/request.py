"""What is asked of a training."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

DEFAULT_PRESET = "10min"


@dataclass(frozen=True, slots=True)
class TrainRequest:
    """What is asked of a training; None: as the preset has it.

    Parameters
    ----------
    settings
        TOML file with settings that differ from the preset's.
    start
        PLY file of splats to start from.
    device
        `cpu` or `cuda`.
    memory_bytes
        For decoded photos, and as much for rays of glass.
    """

    preset: str = DEFAULT_PRESET
    method: str | None = None
    light: str | None = None
    iterations: int | None = None
    time_limit_s: float | None = None
    seed: int | None = None
    settings: Path | None = None
    start: Path | None = None
    device: str | None = None
    memory_bytes: int | None = None

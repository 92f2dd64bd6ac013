"""The figures of all effects, from `data/effects.toml`, which names their sources."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

from planning.base.json_file import read_toml

FACTS_PATH = Path(__file__).parent / "data" / "effects.toml"


@dataclass(frozen=True, slots=True)
class WindFacts:
    """Gains of the position control, how strongly the air pushes, and the largest tilt against it."""

    position_per_s: float
    velocity_per_s: float
    velocity_integral_per_s2: float
    drag_per_s: float
    tilt_deg: float


@dataclass(frozen=True, slots=True)
class ReceiverFacts:
    """A kind of GNSS fix: 1 sigma per horizontal axis and vertical, and how long an error lasts."""

    fix_type: int
    n_satellites: int
    horizontal_m: float
    vertical_m: float
    correlation_s: float


@dataclass(frozen=True, slots=True)
class MultipathFacts:
    """Reflections of satellite signals, and the geometry under open sky."""

    amplitude: float
    wavelength_m: float
    chip_m: float
    spacing_chips: float
    mask_deg: float
    hdop: float
    vdop: float
    correlation_s: float


@dataclass(frozen=True, slots=True)
class GimbalFacts:
    """Time constant of the gimbal's control."""

    lag_s: float


@dataclass(frozen=True, slots=True)
class BarometerFacts:
    """How the air pressure drifts (1 sigma), and what that is in height."""

    drift_hpa_per_h: float
    m_per_hpa: float


@dataclass(frozen=True, slots=True)
class BatteryFacts:
    """A battery pack, and how power depends on speed.

    Parameters
    ----------
    hover_induced_m_s, induced_share
        Speed of the air through the rotors at hover, and the share of the power that moves it.
    endurance_speed_m_s
        Airspeed at which the aircraft's endurance holds.
    """

    capacity_mah: float
    nominal_v: float
    full_v: float
    empty_v: float
    resistance_ohm: float
    hover_induced_m_s: float
    induced_share: float
    drag_per_s: float
    endurance_speed_m_s: float


@dataclass(frozen=True, slots=True)
class EffectFacts:
    """Everything in the file."""

    wind: WindFacts
    receivers: dict[str, ReceiverFacts]
    multipath: MultipathFacts
    gimbal: GimbalFacts
    barometer: BarometerFacts
    battery: BatteryFacts


@cache
def effect_facts() -> EffectFacts:
    """The figures, read once."""
    return read_toml(FACTS_PATH, EffectFacts)

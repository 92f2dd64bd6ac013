"""The weather, the camera and the links of a simulated flight, each parameter declared once. Light to import."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

from planning.base.messages import say
from planning.base.parameters import Choice, check, like, parameter
from planning.parameters import FlightRules

FixKind = Literal["rtk-fixed", "rtk-float", "single"]
HeightSource = Literal["auto", "gnss", "barometer"]


BRIGHT_DAY_S = 0.002


@dataclass(frozen=True, slots=True)
class Conditions:
    """What the weather, the camera and the links are like; nothing of it is in a plan but the wind.

    Parameters
    ----------
    outages_s
        Begin and end of times in which the radio loses all, seconds after take-off.
    """

    wind_m_s: float = like(
        FlightRules,
        "wind_m_s",
        0.0,
        help="mean wind at the height of a mast (6 m)",
        expected="0 m/s or more",
        group="",
        row="first",
    )
    wind_from_deg: float = parameter(
        270.0,
        "where the wind comes from, clockwise from north",
        label="Wind from",
        unit="deg",
        expected="degrees clockwise from north",
        option="--wind-from",
        metavar="DEG",
        row="first",
        offered=(0.0, 360.0),
        step=10.0,
        decimals=0,
    )
    fix: FixKind = parameter(
        "rtk-fixed",
        "what the GNSS receiver reaches under open sky",
        label="GNSS",
        choices=(
            Choice("rtk-fixed", "RTK fixed", "rtk"),
            Choice("rtk-float", "RTK float", "float"),
            Choice("single", say("without RTK")),
        ),
        option="--gnss",
        row="first",
    )
    height_source: HeightSource = parameter(
        "auto",
        "what the autopilot takes its height from; auto is the receiver with an RTK fix, as DJI does, else the "
        "barometer; ArduPilot's default (EK3_SRC1_POSZ 1) is always the barometer",
        choices=(Choice("auto"), Choice("gnss"), Choice("barometer")),
    )
    exposure_s: float = parameter(
        BRIGHT_DAY_S,
        "1/500 s is what automatic exposure chooses on a bright day; a plan that states a shutter time has that",
        unit="s",
        least=0.0,
    )
    photo_latency_s: float = parameter(
        0.1,
        "from the command to the opening of the shutter; a camera at the end of a cable takes 0.1 s, one that has to "
        "focus first much longer",
        unit="s",
        least=0.0,
    )
    message_loss: float = parameter(
        0.0, "share of the messages that the radio loses, each way", unit="share", least=0.0, below=1.0
    )
    outages_s: tuple[tuple[float, float], ...] = ()

    def __post_init__(self) -> None:
        check(self)
        for begin_s, end_s in self.outages_s:
            if not 0.0 <= begin_s < end_s:
                raise ValueError(f"outages_s: expected begin before end, got {begin_s} and {end_s}")

    def with_shutter(self, shutter_s: float | None) -> Conditions:
        """With the shutter time of a plan, where it states one and nobody asked for another."""
        if shutter_s is None or self.exposure_s != BRIGHT_DAY_S:
            return self
        return replace(self, exposure_s=shutter_s)

    @property
    def height_by_gnss(self) -> bool:
        """Whether heights come from the GNSS receiver."""
        return self.height_source == "gnss" or (self.height_source == "auto" and self.fix == "rtk-fixed")

    @property
    def wind_enu_m_s(self) -> tuple[float, float, float]:
        """Mean wind, towards where it blows."""
        angle = math.radians(self.wind_from_deg)
        return -self.wind_m_s * math.sin(angle), -self.wind_m_s * math.cos(angle), 0.0

"""What a pilot may choose for mission files, declared once for command, window and docs, and what comes of it."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from missions.mavlink.autopilots import Autopilot
from missions.mission.export_choices import HIGHEST_RETURN_M, LOWEST_RETURN_M, HeightReference, LinkLoss
from planning.base.findings import Finding
from planning.base.parameters import Choice, parameter

if TYPE_CHECKING:
    from planning.site.records import SiteModel

GROUP = "missions"


@dataclass(frozen=True, slots=True)
class ExportOptions:
    """What a pilot may choose; each format takes what concerns it.

    Parameters
    ----------
    height_reference
        Of DJI and MAVLink files; KML is always above sea level, a table of photos has a column for each.
    autopilot
        Whose rules MAVLink files follow; None: PX4 for the profile px4, ArduPilot for all others.
    rth_height_m
        Without it the aircraft returns as high as `site` or, without that, the path needs, and as remote controllers
        take.
    site
        For the return height and for fences.
    clock
        Seconds since 1970 UTC, for the time of creation in DJI files.
    """

    height_reference: HeightReference = parameter(
        HeightReference.ABOVE_TAKEOFF,
        "reference of heights in the file",
        label="Heights in the file",
        choices=(
            Choice(HeightReference.ABOVE_TAKEOFF, "above take-off"),
            Choice(HeightReference.AMSL, "above sea level (EGM96)"),
            Choice(HeightReference.ELLIPSOID, "above ellipsoid (WGS 84)"),
        ),
        option="--heights",
        group=GROUP,
        row="first",
    )
    autopilot: Autopilot | None = parameter(
        None,
        "whose rules MAVLink files follow",
        label="Autopilot",
        choices=tuple(Choice(each, each.product) for each in Autopilot),
        option="--autopilot",
        group=GROUP,
        unset="by aircraft",
        row="first",
    )
    link_loss: LinkLoss = parameter(
        LinkLoss.CONTINUE,
        "DJI: what to do without radio link",
        label="Without radio link",
        choices=(
            Choice(LinkLoss.CONTINUE, "continue mission"),
            Choice(LinkLoss.GO_HOME, "return home straight"),
        ),
        option="--link-loss",
        group=GROUP,
        row="first",
    )
    rth_height_m: float | None = parameter(
        None,
        f"DJI: of the return above take-off, {LOWEST_RETURN_M:g} to {HIGHEST_RETURN_M:g}",
        label="Return height",
        unit="m",
        least=LOWEST_RETURN_M,
        most=HIGHEST_RETURN_M,
        step=5.0,
        option="--return-height",
        metavar="M",
        group=GROUP,
        unset="above everything on the site",
        row="first",
    )
    site: SiteModel | None = None
    clock: Callable[[], float] = time.time


@dataclass(frozen=True, slots=True)
class EncodedFiles:
    """Contents of the files of an export, and what the checks found on them."""

    contents: tuple[bytes, ...]
    findings: tuple[Finding, ...]


DEFAULT_OPTIONS = ExportOptions()

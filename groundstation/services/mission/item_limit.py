"""Sorties with more photos than an autopilot keeps items for: found before a link is opened, and shared out anew."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from missions.mavlink.autopilots import Autopilot
from missions.mavlink.items import photos_that_fit
from planning.base.progress import QUIET, Monitor
from planning.plan import Plan
from planning.planner import share_out_anew
from planning.site.records import SiteModel


@dataclass(frozen=True, slots=True)
class TooLong:
    """A sortie has too many photos for an autopilot.

    Parameters
    ----------
    autopilot
        The one with the least room, of those that may be met.
    longest, limit
        Photos of the longest sortie, and those that the autopilot has room for.
    """

    autopilot: Autopilot
    longest: int
    limit: int


def too_long(plan: Plan, autopilots: Sequence[Autopilot] = tuple(Autopilot)) -> TooLong | None:
    """Whether a sortie has more photos than all of these autopilots keep items for; None where all fit."""
    autopilot = min(autopilots, key=photos_that_fit)
    limit = photos_that_fit(autopilot)
    longest = max((len(sortie.viewpoint_ids) for sortie in plan.sorties), default=0)
    return TooLong(autopilot, longest, limit) if longest > limit else None


def shared_out(plan: Plan, site_model: SiteModel, found: TooLong, monitor: Monitor = QUIET) -> Plan:
    """The same views in sorties that fit.

    Raises
    ------
    InfeasibleError
        Home cannot be used, or a view cannot be reached from it.
    """
    return share_out_anew(plan, site_model, found.limit, monitor)

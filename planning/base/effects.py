"""Effects: simulate only what a scene calls for.

An effect looks at a scene and says how large it would be, in units of the result. It is on where that is more than its
stated tolerance; what is off costs nothing. The user sees the decision with its reason and may overrule it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Protocol, TypeVar

from planning.base.messages import say

EffectSetting = Literal["auto", "on", "off"]
"""What the user asked for; `auto` leaves it to the scene."""

Scene_contra = TypeVar("Scene_contra", contravariant=True)


@dataclass(frozen=True, slots=True)
class Assessment:
    """What an effect found in a scene.

    Parameters
    ----------
    size
        How much the result would change, in the effect's unit.
    reason
        One clause for the user: what in the scene makes it large or small.
    cost_s
        Expected extra time when it is on, seconds.
    """

    size: float
    reason: str
    cost_s: float


@dataclass(frozen=True, slots=True)
class Decision:
    """An effect, on or off, and why. `decided_by` is `scene` or `user`."""

    effect: str
    on: bool
    decided_by: str
    reason: str
    size: float
    tolerance: float
    unit: str
    cost_s: float

    def __str__(self) -> str:
        state, by = say("on") if self.on else say("off"), "" if self.decided_by == "scene" else say(", as you asked")
        return say(
            "{}{} - {} ({:.3g} {}, tolerance {:.3g}; costs about {:.1f} s)",
            *(state, by, self.reason, self.size, self.unit, self.tolerance, self.cost_s),
            place=self.effect,
        )


class Effect(Protocol[Scene_contra]):
    """Something a simulation may take into account or leave out."""

    @property
    def name(self) -> str:
        """What the user knows it by."""

    @property
    def unit(self) -> str:
        """Of size and tolerance."""

    @property
    def tolerance(self) -> float:
        """Changes of the result up to this size are not worth their cost."""

    def assess(self, scene: Scene_contra) -> Assessment:
        """Size, reason and cost of the effect in this scene."""


def decide(
    effect: Effect[Scene_contra], scene: Scene_contra, setting: EffectSetting = "auto", factor: float = 1.0
) -> Decision:
    """Ask the scene, and let the user overrule it; `factor` multiplies the effect's tolerance."""
    found, tolerance = effect.assess(scene), factor * effect.tolerance
    on = found.size > tolerance if setting == "auto" else setting == "on"
    return Decision(
        effect=effect.name,
        on=on,
        decided_by="scene" if setting == "auto" else "user",
        reason=found.reason,
        size=found.size,
        tolerance=tolerance,
        unit=effect.unit,
        cost_s=found.cost_s,
    )

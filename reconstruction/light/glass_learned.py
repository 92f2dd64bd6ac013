"""What is learned of panes and photos beside the light that is mirrored."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class GlassLearned:
    """What is learned beside the light.

    Parameters
    ----------
    rays
        Through each pixel, a square number.
    tilts, bows
        Of each pane.
    poses
        Of each photo learned from.
    """

    rays: int = 1
    tilts: bool = False
    bows: bool = False
    poses: bool = False

    def __post_init__(self) -> None:
        if self.rays < 1 or math.isqrt(self.rays) ** 2 != self.rays:
            raise ValueError(f"rays: expected a square number, got {self.rays}")

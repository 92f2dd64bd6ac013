"""Values against time, kept short however long a training takes."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

MOST_POINTS = 1200
"""More than a chart has columns of pixels."""


@dataclass(slots=True)
class ThinCurve:
    """Points by rising x; where there are too many, every second goes, and later ones come half as often.

    The last point is always there.
    """

    x: list[float] = field(default_factory=list)
    y: list[float] = field(default_factory=list)
    _every: int = 1
    _since: int = 0

    def add(self, x: float, y: float) -> None:
        """Add a point."""
        if self.x and self._since % self._every:
            self.x[-1], self.y[-1] = x, y
        else:
            self.x.append(x)
            self.y.append(y)
        self._since += 1
        if len(self.x) > MOST_POINTS:
            self.x, self.y = self.x[::2], self.y[::2]
            self._every *= 2
            self._since = 1

    def arrays(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Both, shape (n,)."""
        return np.array(self.x), np.array(self.y)


def smoothed(y: NDArray[np.float64], n: int) -> NDArray[np.float64]:
    """Mean of the last `n` values at each, of fewer where there are fewer, shape kept: losses differ by photo."""
    if not len(y):
        return y
    total = np.concatenate([[0.0], np.cumsum(y)])
    last = np.arange(1, len(y) + 1)
    first = np.maximum(last - n, 0)
    return np.asarray((total[last] - total[first]) / (last - first))

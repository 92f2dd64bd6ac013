"""The end of a training that was stopped: its rates fall to their last in a short time.

While rates are high, parameters dance about what they are on average, and pictures are worse than they could be. A
training that ends by itself has let its rates fall; one that is stopped goes the rest of that way quickly, adds no more
splats, and keeps the losses that it has. Nothing is chosen: what is kept is where it ends.
"""

from __future__ import annotations

from dataclasses import dataclass

SHARE = 0.05
"""Of the time spent, for settling: the user has just said that it is enough."""

MOST_S = 60.0


@dataclass(frozen=True, slots=True)
class Settling:
    """How far a stopped training has settled.

    Parameters
    ----------
    progress
        Of the training when it was stopped, 0 to 1.
    begun_s
        That it had taken then.
    """

    progress: float
    begun_s: float

    @property
    def lasts_s(self) -> float:
        """All in all."""
        return min(MOST_S, SHARE * self.begun_s)

    def share(self, spent_s: float) -> float:
        """Of settling, 0 to 1, when the training has taken `spent_s`."""
        done_s = spent_s - self.begun_s
        return 1.0 if done_s >= self.lasts_s else max(0.0, done_s / self.lasts_s)

    def progress_of_rates(self, spent_s: float) -> float:
        """Progress that the rates are to be those of: the rest of the training, gone through evenly."""
        return self.progress + (1.0 - self.progress) * self.share(spent_s)

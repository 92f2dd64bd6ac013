"""What is known of the training that runs, or ran last."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from groundstation.services.reconstruct_curves import ThinCurve
from groundstation.services.reconstruct_messages import Ended, Stage, Stepped


@dataclass(slots=True, eq=False)
class TrainingInHand:
    """A training.

    Parameters
    ----------
    dataset, out
        Folders of what is learned from, and of the model.
    quality
        PSNR, dB, of unseen views by seconds.
    terms
        Of the loss by seconds.
    """

    dataset: Path = field(default_factory=Path)
    out: Path = field(default_factory=Path)
    stage: Stage | None = None
    stepped: Stepped | None = None
    ended: Ended | None = None
    quality: ThinCurve = field(default_factory=ThinCurve)
    terms: dict[str, ThinCurve] = field(default_factory=dict)

    @property
    def has_model(self) -> bool:
        """Whether there is a model of it to look at."""
        return self.stepped is not None or (self.ended is not None and self.ended.outcome == "done")

    def take_step(self, stepped: Stepped) -> None:
        """It has gone on."""
        self.stepped = stepped
        if stepped.phase != "paused":
            for name, value in stepped.terms.items():
                self.terms.setdefault(name, ThinCurve()).add(stepped.seconds, value)

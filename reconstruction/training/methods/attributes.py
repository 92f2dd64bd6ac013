"""What methods give each splat besides its shape: names, shapes, and where learning starts."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Any, Literal

import torch
from torch import Tensor

Activation = Literal["sigmoid", "none"]


@dataclass(frozen=True, slots=True)
class Attribute:
    """One number, or several, of each splat.

    Parameters
    ----------
    name
        Of the value; what is learned is called the same with `_logits` behind it where it passes a sigmoid.
    shape
        For one splat.
    start
        Of the value.
    activation
        From what is learned to the value.
    spread
        Standard deviation of normal noise on what is learned, at the start: features that all were alike would stay so.
    """

    name: str
    shape: tuple[int, ...]
    start: float
    activation: Activation = "none"
    spread: float = 0.0

    def __post_init__(self) -> None:
        if self.activation == "sigmoid" and not 0.0 < self.start < 1.0:
            raise ValueError(f"{self.name}: start: expected above 0 and below 1, got {self.start}")

    @property
    def parameter(self) -> str:
        """Name of what is learned."""
        return f"{self.name}_logits" if self.activation == "sigmoid" else self.name

    def learned(self, n: int, generator: torch.Generator | None = None) -> Tensor:
        """What is learned, at the start, shape (n, *shape), float32."""
        start = math.log(self.start / (1.0 - self.start)) if self.activation == "sigmoid" else self.start
        return start + self.spread * torch.randn((n, *self.shape), generator=generator)

    def value(self, learned: Tensor) -> Tensor:
        """From what is learned."""
        return torch.sigmoid(learned) if self.activation == "sigmoid" else learned


def require_not_negative(settings: Any) -> None:
    """Check a record of settings.

    Raises
    ------
    ValueError
        One of its numbers is negative, or none.
    """
    for each in fields(settings):
        value = getattr(settings, each.name)
        if isinstance(value, int | float) and not (math.isfinite(value) and value >= 0.0):
            raise ValueError(f"{each.name}: expected 0 or more, got {value}")

"""The Reflection MLP (paper 3.3.3, Fig. 10): light that a place on glass mirrors from a direction, memorised."""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
from torch import Tensor, nn

# Fourier features of positions and directions (paper Eq. 22), exact to float32's rounding at every order.

MAX_ORDER = 24
"""From there on the finest wave is shorter than float32 can tell places in [-1, 1] apart."""


def fourier_features(values: Tensor, order: int) -> Tensor:
    """sin(2^k pi p) and cos(2^k pi p) for k = 0 to `order` - 1 (Eq. 22), float32 or float64 as the values.

    The sine of 2^k pi p itself is wrong by 4e-4 in float32 at k = 11: pi times 2^11 is rounded before the sine is
    taken. Here whole periods are taken away first, which is exact in binary: with h = 2^(k-1) p, the angle is
    2 pi (h - round h). What is left is the rounding of one sine, 2e-7, whatever k is.

    Parameters
    ----------
    values
        Shape (n, c), meant for [-1, 1]; gradients flow through. Half precision is refused: at order 12 it would be
        noise.
    order
        L of the paper, 0 to `MAX_ORDER`.

    Returns
    -------
    Tensor
        Shape (n, 2 `order` c): for each k all sines, then all cosines.
    """
    if values.dtype not in (torch.float32, torch.float64):
        raise TypeError(f"expected float32 or float64, got {values.dtype}")
    if values.ndim != 2:
        raise ValueError(f"values: expected shape (n, c), got {tuple(values.shape)}")
    if not 0 <= order <= MAX_ORDER:
        raise ValueError(f"order: expected 0 to {MAX_ORDER}, got {order}")
    n, c = values.shape
    powers = torch.exp2(torch.arange(order, dtype=values.dtype, device=values.device) - 1.0)
    half_turns = values[:, None, :] * powers[:, None]
    angles = (2.0 * math.pi) * (half_turns - torch.round(half_turns))
    return torch.stack([torch.sin(angles), torch.cos(angles)], dim=2).reshape(n, 2 * order * c)


def n_features(n_channels: int, order: int) -> int:
    """Columns that `fourier_features` makes."""
    return 2 * order * n_channels


@dataclass(frozen=True, slots=True)
class MlpShape:
    """The factors of the paper's Table 4; the defaults are its final architecture.

    Parameters
    ----------
    width, layers
        Units of each hidden layer, and how many of them.
    position_order, direction_order
        L of the Fourier features (Eq. 22); the paper has one for both.
    skip
        Whether the encoded position is given again in the middle.
    staged
        Whether the encoded direction is given in the middle, rather than at the start.
    """

    width: int = 512
    layers: int = 8
    position_order: int = 12
    direction_order: int = 12
    skip: bool = True
    staged: bool = True

    def __post_init__(self) -> None:
        if self.width < 1 or self.layers < 2:
            raise ValueError(f"width, layers: expected at least 1 and at least 2, got {self.width} and {self.layers}")
        for name in ("position_order", "direction_order"):
            if not 0 < getattr(self, name) <= MAX_ORDER:
                raise ValueError(f"{name}: expected 1 to {MAX_ORDER}, got {getattr(self, name)}")

    @property
    def fusion_layer(self) -> int:
        """Which layer, from 0, is given what comes in the middle: the fifth of eight."""
        return self.layers // 2


@dataclass(frozen=True, slots=True)
class MlpHealth:
    """Whether an MLP is alive: one that died gives the same light whatever it is asked.

    Parameters
    ----------
    output_std
        Standard deviation of its output over the rays, on average over red, green and blue; 0 to 0.5.
    dead_units
        Share of hidden units that are 0 for every ray.
    """

    output_std: float
    dead_units: float

    @property
    def is_alive(self) -> bool:
        """Whether what it says depends on what it is asked, by more than a grey level or so."""
        return self.output_std > LEAST_STD and self.dead_units < MOST_DEAD


LEAST_STD = 0.005
MOST_DEAD = 0.9
"""Networks that learned had standard deviations around 0.16, and 2 % of their units dead at most."""


class ReflectionMlp(nn.Module):
    """ReLU layers and a sigmoid at the end. Positions go in first, directions in the middle where it is `staged`.

    Parameters
    ----------
    expected
        Light, 0 to 1, that it starts from: its last bias is the logit of this. From 0.5, where sigmoids start, all rays
        would drive it down alike, since panes are darker, which may kill its units.
    """

    def __init__(self, shape: MlpShape, expected: float, generator: torch.Generator) -> None:
        super().__init__()
        if not 0.0 < expected < 1.0:
            raise ValueError(f"expected: expected light between 0 and 1, got {expected}")
        self.shape = shape
        position, direction = n_features(3, shape.position_order), n_features(3, shape.direction_order)
        hidden = []
        n_in = position if shape.staged else position + direction
        for number in range(shape.layers):
            if number == shape.fusion_layer:
                n_in += position * shape.skip + direction * shape.staged
            hidden.append(nn.Linear(n_in, shape.width))
            n_in = shape.width
        self.hidden = nn.ModuleList(hidden)
        self.last = nn.Linear(n_in, 3)
        for layer in hidden:
            nn.init.kaiming_uniform_(layer.weight, nonlinearity="relu", generator=generator)
            nn.init.zeros_(layer.bias)
        nn.init.kaiming_uniform_(self.last.weight, nonlinearity="linear", generator=generator)
        nn.init.constant_(self.last.bias, float(torch.logit(torch.tensor(expected, dtype=torch.float64))))

    def forward(self, points: Tensor, omega_r: Tensor, panels: Tensor | None = None) -> Tensor:
        """Light, shape (n, 3), 0 to 1, float32.

        Parameters
        ----------
        points
            Places on the glass, rescaled to [-1, 1], shape (n, 3).
        omega_r
            Unit directions that mirrored rays go, shape (n, 3).
        panels
            Not asked for; other models do.
        """
        return torch.sigmoid(self._activations(points, omega_r)[-1].float())

    @torch.no_grad()
    def health(self, points: Tensor, omega_r: Tensor) -> MlpHealth:
        """How alive it is on some rays; as `forward` takes them."""
        *hidden, last = self._activations(points, omega_r)
        dead = torch.cat([(activation <= 0.0).all(dim=0) for activation in hidden])
        return MlpHealth(float(torch.sigmoid(last.float()).std(dim=0).mean()), float(dead.float().mean()))

    def _activations(self, points: Tensor, omega_r: Tensor) -> list[Tensor]:
        """Of each hidden layer, and the logits."""
        shape = self.shape
        position = fourier_features(points, shape.position_order)
        direction = fourier_features(omega_r, shape.direction_order)
        value = position if shape.staged else torch.cat([position, direction], dim=1)
        found = []
        for number, layer in enumerate(self.hidden):
            if number == shape.fusion_layer:
                again = [position] * shape.skip + [direction] * shape.staged
                value = torch.cat([value, *(part.to(value.dtype) for part in again)], dim=1)
            value = torch.relu(layer(value))
            found.append(value)
        return [*found, self.last(value)]

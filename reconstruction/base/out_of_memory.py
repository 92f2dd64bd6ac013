"""What a training survives: steps without numbers, and memory that runs out."""

from __future__ import annotations

from collections.abc import Iterable

import torch
from torch import Tensor

from planning.base.messages import say

LARGEST = 1e15
"""Gradients beyond are no use: their squares, which Adam keeps, would be infinite for good."""

OUT_OF_MEMORY = ("out of memory", "can't allocate memory", "cannot allocate memory", "not enough memory")
"""How torch says it, by device and system; on a processor it has no error class of its own."""


class NotFinite(ArithmeticError):  # noqa: N818  (the name says what happened)
    """A loss or gradient is no number."""


def require_finite(loss: Tensor, parameters: Iterable[Tensor]) -> None:
    """See that a step can be taken.

    Raises
    ------
    NotFinite
        The loss or a gradient is NaN, infinite or beyond `LARGEST`.
    """
    if not bool(torch.isfinite(loss)):
        raise NotFinite(say("the loss is not a number"))
    for parameter in parameters:
        # One pass: NaN and infinity reach the largest absolute value.
        if parameter.grad is not None and parameter.grad.numel():
            low, high = torch.aminmax(parameter.grad)
            if not bool((low > -LARGEST) & (high < LARGEST)):
                raise NotFinite(say("a gradient is not a number"))


def is_out_of_memory(error: BaseException) -> bool:
    """Whether an error says that there is no memory."""
    if isinstance(error, MemoryError | torch.OutOfMemoryError):
        return True
    return isinstance(error, RuntimeError) and any(words in str(error).lower() for words in OUT_OF_MEMORY)

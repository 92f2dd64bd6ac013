"""Adam with decoupled decay, as torch has it, without what torch loads for compilers that are not used here.

`torch.optim` imports torch's compiler with the first optimiser of a process, which takes as long as all else of torch.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable
from typing import Any

import torch
from torch import Tensor
from torch.optim import Optimizer

EPSILON = 1e-8
"""Added to roots of mean squares, as in the paper."""


class Adam(Optimizer):
    """AdamW (D. P. Kingma and J. Ba, 2015; I. Loshchilov and F. Hutter, 2019), the same bits as torch's fused one.

    Parameters
    ----------
    groups
        Each with `params` and, where they are not those below, `lr`, `betas`, `eps` and `weight_decay`; what else it
        has is kept with it. Parameters without a gradient stay.
    """

    def __init__(
        self,
        groups: Iterable[dict[str, Any]],
        lr: float = 1e-3,
        betas: tuple[float, float] = (0.9, 0.999),
        eps: float = EPSILON,
        weight_decay: float = 0.0,
    ) -> None:
        # Torch's own would load the compiler.
        self.defaults = {"lr": lr, "betas": betas, "eps": eps, "weight_decay": weight_decay}
        self.state: defaultdict[Tensor, Any] = defaultdict(dict)
        self.param_groups = [{**self.defaults, **group, "params": [*group["params"]]} for group in groups]

    @torch.no_grad()
    def step(self, closure: Callable[[], float] | None = None) -> None:  # type: ignore[override]
        """One step along the gradients that there are; `closure` is not asked."""
        for group in self.param_groups:
            values = [value for value in group["params"] if value.grad is not None]
            if not values:
                continue
            states = [self._state_of(value) for value in values]
            counts = [state["step"] for state in states]
            for count in counts:
                count += 1.0
            torch._fused_adamw_(
                values,
                [value.grad for value in values],
                [state["exp_avg"] for state in states],
                [state["exp_avg_sq"] for state in states],
                [],
                counts,
                lr=group["lr"],
                beta1=group["betas"][0],
                beta2=group["betas"][1],
                weight_decay=group["weight_decay"],
                eps=group["eps"],
                amsgrad=False,
                maximize=False,
            )

    def zero_grad(self, set_to_none: bool = True) -> None:
        """Forget all gradients; zeros take their place where they are not to be None."""
        for group in self.param_groups:
            for value in group["params"]:
                if set_to_none:
                    value.grad = None
                elif value.grad is not None:
                    value.grad = torch.zeros_like(value)

    def state_dict(self) -> dict[str, Any]:
        """What it remembers, parameters by their number, as torch's has it."""
        numbers = {id(value): number for number, value in enumerate(self._parameters())}
        groups = [{**group, "params": [numbers[id(value)] for value in group["params"]]} for group in self.param_groups]
        return {"state": {numbers[id(value)]: state for value, state in self.state.items()}, "param_groups": groups}

    def load_state_dict(self, state_dict: dict[str, Any]) -> None:
        """Go on from there.

        Raises
        ------
        ValueError
            It is of other parameters.
        """
        mine, theirs = self.param_groups, state_dict["param_groups"]
        if [len(group["params"]) for group in mine] != [len(group["params"]) for group in theirs]:
            raise ValueError("expected the state of as many parameters, in as many groups")
        values = self._parameters()
        self.param_groups = [{**new, "params": old["params"]} for new, old in zip(theirs, mine, strict=True)]
        self.state = defaultdict(dict)
        for number, state in state_dict["state"].items():
            # Numbers of steps stay as they are; moments lie where their parameters do.
            self.state[values[number]] = {
                key: value.to(values[number]) if value.ndim else value.clone() for key, value in state.items()
            }

    def _parameters(self) -> list[Tensor]:
        return [value for group in self.param_groups for value in group["params"]]

    def _state_of(self, value: Tensor) -> dict[str, Tensor]:
        state: dict[str, Tensor] = self.state[value]
        if not state:
            of_step = torch.zeros((), dtype=torch.float32, device=value.device)
            state |= {"step": of_step, "exp_avg": torch.zeros_like(value), "exp_avg_sq": torch.zeros_like(value)}
        return state

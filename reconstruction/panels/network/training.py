"""How the network for panes learns: synthetic pictures and photos in crops, each pane by lot in a size by lot.

`python -m reconstruction.pane_training` gathers what it learns from and begins.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import torch
from safetensors.torch import load_file, save_file
from torch import Tensor
from torch.nn import functional

from reconstruction.panels.network.crops import CropSampler, Truth
from reconstruction.panels.network.network import SMALL, PaneNetwork, Shape
from reconstruction.panels.network.random_pictures import SyntheticPicture

BATCH = {"cpu": 16, "cuda": 192}
"""Crops of a step, by where it learns."""

HIGHEST_RATE = {"cpu": 2e-3, "cuda": 3e-3}

SHARP = 0.05
"""Where the loss of an offset turns from square to linear, as a share of the pane's side."""

SOURCES = (0.62, 0.08, 0.3)
"""Shares of pictures made by chance, of traced facades, and of photos."""

FIRST_PICTURES = 1000
"""Pictures made by chance with which it begins; others come while it learns."""


def loss_of(output: Tensor, is_pane: Tensor, counts: Tensor, offsets: Tensor, weight: Tensor) -> tuple[Tensor, Tensor]:
    """Losses of logits and of offsets: told is (n, 9, h, w), the truths (n, h, w) twice and (n, h, w, 8) twice."""
    each = functional.binary_cross_entropy_with_logits(output[:, 0], is_pane, reduction="none")
    logits = (each * counts).sum() / counts.sum().clamp(min=1.0)
    off = torch.abs(output[:, 1:].permute(0, 2, 3, 1) - offsets) * weight
    robust = torch.where(off < SHARP, 0.5 * off * off / SHARP, off - 0.5 * SHARP)
    return logits, robust.sum() / (8.0 * torch.count_nonzero(weight[..., 0]).clamp(min=1))


@dataclass(frozen=True, slots=True)
class NetworkToTrain:
    """A network to train: the file of its weights, its shape, and weights of that shape to go on from."""

    out: Path
    shape: Shape = SMALL
    start: Path | None = None


@dataclass(slots=True, eq=False)
class _Learner:
    """A network that learns, and its weights averaged over the last thousand steps."""

    wanted: NetworkToTrain
    net: PaneNetwork
    optimiser: torch.optim.Optimizer
    average: dict[str, Tensor] = field(default_factory=dict)
    losses: list[Tensor] = field(default_factory=list)

    @classmethod
    def of(cls, wanted: NetworkToTrain, device: str) -> _Learner:
        net = PaneNetwork(wanted.shape)
        if wanted.start is not None:
            net.load_state_dict({name: value.float() for name, value in load_file(wanted.start).items()}, strict=False)
        net = net.to(device).to(memory_format=torch.channels_last)  # type: ignore[call-overload]
        return cls(wanted, net, torch.optim.AdamW(net.parameters(), lr=1e-3, weight_decay=1e-4))

    def step(self, images: Tensor, truth: Truth, rate: float) -> None:
        """Learn from crops."""
        for group in self.optimiser.param_groups:
            group["lr"] = rate
        with torch.autocast(images.device.type, torch.bfloat16, enabled=images.is_cuda):
            output = self.net(images)
        logits, off = loss_of(output.float(), truth.is_pane, truth.counts, truth.offsets, truth.weight)
        self.optimiser.zero_grad(set_to_none=True)
        torch.autograd.backward([logits + off])
        torch.nn.utils.clip_grad_norm_(self.net.parameters(), 5.0)
        self.optimiser.step()
        self.losses.append(torch.stack([logits.detach(), off.detach()]))

    def shown(self) -> str:
        """Losses since the last time."""
        panes, corners = torch.stack(self.losses).mean(dim=0).tolist()
        self.losses.clear()
        return f"panes {panes:.4f}, corners {corners:.4f}"


def train(
    bank: CropSampler,
    minutes: float,
    networks: Sequence[NetworkToTrain],
    seed: int = 0,
    more: Callable[[], Sequence[SyntheticPicture]] = lambda: (),
    tell: Callable[[str], None] = lambda text: None,
) -> None:
    """Learn for so many minutes where the bank is, and write the weights, every 500 steps and at the end.

    Parameters
    ----------
    bank
        Made pictures, traced facades, photos: sources 0, 1, 2.
    networks
        All learn from the same crops, one step of each after the other.
    more
        Is asked every 20 steps for further pictures made by chance.
    tell
        Is told the losses every 100 steps.
    """
    torch.manual_seed(seed)
    device = bank.device.type
    if device == "cpu":
        torch.set_num_threads(1)
    torch.backends.cudnn.benchmark = True
    rng, generator = np.random.default_rng(seed), torch.Generator(bank.device).manual_seed(seed)
    learners = [_Learner.of(wanted, device) for wanted in networks]
    began, number = time.monotonic(), 0
    while (done := (time.monotonic() - began) / (60.0 * minutes)) < 1.0:
        rate = HIGHEST_RATE[device] * min(1.0, (number + 1) / 200) * (0.5 * (1.0 + np.cos(np.pi * done)) + 0.005)
        images, truth = bank.crops(BATCH[device], rng, generator)
        images = images.contiguous(memory_format=torch.channels_last)
        for learner in learners:
            learner.step(images, truth, rate)
        number += 1
        if number % 20 == 0:
            arrived = more()
            if arrived:
                bank.add(arrived, 0)
        if number % 20 == 0 or number == 1:
            for learner in learners:
                _averaged(learner.average, learner.net, min(0.98, number / (number + 100.0)))
        if number % 100 == 0:
            losses = "; ".join(learner.shown() for learner in learners)
            tell(f"{number} steps, {100 * done:.0f} %, {len(bank)} pictures: {losses}")
        if number % 500 == 0:
            for learner in learners:
                _write(learner.average, learner.wanted.out)
    for learner in learners:
        _write(learner.average, learner.wanted.out)


def _averaged(average: dict[str, Tensor], net: PaneNetwork, keep: float) -> None:
    """Weights averaged over the last thousand steps: less noisy than those of the last."""
    for name, value in net.state_dict().items():
        if name not in average or not value.is_floating_point():
            average[name] = value.detach().clone()
        else:
            average[name].mul_(keep).add_(value.detach(), alpha=1.0 - keep)


def _write(weights: Mapping[str, Tensor], out: Path) -> None:
    """Weights in half precision. Sums over batches keep theirs: variances may be beyond its range."""
    halved = {
        name: value.half() if value.is_floating_point() and "running" not in name else value
        for name, value in weights.items()
    }
    save_file({name: value.cpu().contiguous() for name, value in halved.items()}, out)

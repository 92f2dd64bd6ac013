"""Several processes that train one model together: each looks at another photo, and all take the same step.

Every process has all splats and all of Adam, starts from the same checkpoint and draws the same random numbers; what
they exchange in a step is gradients, what densification looks at, and how much time the first of them has spent. So
parameters stay the same everywhere, bit by bit. Processes are started by `torchrun`, on one machine.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import torch
import torch.distributed as dist
from torch import Tensor

from planning.base.errors import InputError
from planning.base.messages import say
from reconstruction.gpu.device import adapters

# What torch finds to compute on besides the processor.


def cuda_devices() -> tuple[str, ...]:
    """Names of CUDA devices, with their memory."""
    if not torch.cuda.is_available():
        return ()
    found = [torch.cuda.get_device_properties(number) for number in range(torch.cuda.device_count())]
    return tuple(f"{each.name}, {each.total_memory / 2**30:.0f} GiB" for each in found)


def graphics_cards() -> tuple[str, ...]:
    """Names of graphics cards that WebGPU finds, without programs that stand in for one."""
    return tuple(str(each) for each in adapters() if not each.is_software)


def use_threads(number: int) -> None:
    """Let torch compute with so many threads of the processor."""
    torch.set_num_threads(number)


@dataclass(frozen=True, slots=True)
class Ranks:
    """Which of how many processes this is; alone, exchanging costs nothing.

    Parameters
    ----------
    rank
        From 0; the first one writes files and tells how it goes.
    n
        Processes in all.
    """

    rank: int = 0
    n: int = 1

    @property
    def is_first(self) -> bool:
        """Whether this process writes files."""
        return self.rank == 0

    def average_gradients(self, parameters: Sequence[Tensor], loss: Tensor) -> Tensor:
        """Give all gradients their mean over the processes, and return that of the loss.

        A loss that is no number in one process is none in all, so that all undo their step.
        """
        if self.n == 1:
            return loss
        with_gradient = [value for value in parameters if value.requires_grad]
        parts = [torch.zeros_like(value) if value.grad is None else value.grad for value in with_gradient]
        flat = torch.cat([loss.reshape(1), *(part.reshape(-1) for part in parts)])
        dist.all_reduce(flat)
        flat /= self.n
        start = 1
        for value, part in zip(with_gradient, parts, strict=True):
            value.grad = flat[start : start + part.numel()].reshape(part.shape).clone()
            start += part.numel()
        return flat[0]

    def gathered(self, values: Tensor) -> list[Tensor]:
        """A tensor of one shape, of every process in turn."""
        if self.n == 1:
            return [values]
        found = [torch.empty_like(values) for _ in range(self.n)]
        dist.all_gather(found, values.contiguous())
        return found

    def agreed(self, numbers: Sequence[float]) -> list[float]:
        """Numbers of the first process, in all of them."""
        if self.n == 1:
            return list(numbers)
        values = torch.tensor(numbers, dtype=torch.float64)
        dist.broadcast(values, 0)
        return [float(value) for value in values]

    def wait(self) -> None:
        """Until all processes are here."""
        if self.n > 1:
            dist.barrier()


ALONE = Ranks()


@contextmanager
def ranks_of_environment() -> Iterator[Ranks]:
    """The processes that `torchrun` has started, as its environment variables say; this one alone without them.

    Raises
    ------
    InputError
        The variables are no numbers.
    """
    text = os.environ.get("WORLD_SIZE", "1")
    if text == "1":
        yield ALONE
        return
    try:
        n, rank = int(text), int(os.environ["RANK"])
    except (ValueError, KeyError) as error:
        raise InputError(
            say("WORLD_SIZE is '{}', but RANK is no number; start the processes with torchrun", text)
        ) from error
    dist.init_process_group("gloo", rank=rank, world_size=n)
    try:
        yield Ranks(rank, n)
    finally:
        dist.destroy_process_group()

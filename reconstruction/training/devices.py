"""What torch finds to compute on besides the processor."""

from __future__ import annotations

import torch


def cuda_devices() -> tuple[str, ...]:
    """Names of CUDA devices, with their memory."""
    if not torch.cuda.is_available():
        return ()
    found = [torch.cuda.get_device_properties(number) for number in range(torch.cuda.device_count())]
    return tuple(f"{each.name}, {each.total_memory / 2**30:.0f} GiB" for each in found)


def use_threads(number: int) -> None:
    """Let torch compute with so many threads of the processor."""
    torch.set_num_threads(number)

"""Compile the simulator's kernels once and keep them on disk: `python -m missions.simulator.warm_up`."""

from __future__ import annotations

import gc

from missions.simulator.airframe.trajectory import plan_trajectory


def compile_kernels() -> None:
    """Run every kernel of this package."""
    nowhere = (0.0, 0.0, 0.0)
    plan_trajectory((nowhere, nowhere, nowhere), (1.0, 0.0, 0.0), (1.0, 1.0, 1.0), 1.0, 1.0, passes=True)


if __name__ == "__main__":
    gc.disable()  # a compiler leaves little garbage, and looking for it takes a twentieth of the time
    compile_kernels()

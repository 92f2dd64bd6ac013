"""The methods of choosing views by name, as they stand in plan.json and on the command line."""

from __future__ import annotations

from planning.errors import InputError
from planning.optimise.greedy import greedy
from planning.optimise.noto import noto
from planning.optimise.orbit import orbit
from planning.optimise.problem import Optimiser
from planning.optimise.pso import pso

METHODS: dict[str, Optimiser] = {"greedy": greedy, "pso": pso, "noto": noto, "orbit": orbit}


def method_named(name: str) -> Optimiser:
    """One method.

    Raises
    ------
    InputError
        There is no such method; the message lists those there are.
    """
    if name not in METHODS:
        raise InputError(f"there is no planning method '{name}'; known are: {', '.join(METHODS)}")
    return METHODS[name]

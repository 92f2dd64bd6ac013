"""The methods of choosing views by name, as they stand in plan.json and on the command line."""

from __future__ import annotations

from planning.base.errors import InputError
from planning.viewpoints.greedy import greedy
from planning.viewpoints.noto import noto
from planning.viewpoints.orbit import orbit
from planning.viewpoints.problem import Optimiser
from planning.viewpoints.pso import pso
from planning.viewpoints.unseen import random_oblique

METHODS: dict[str, Optimiser] = {"greedy": greedy, "pso": pso, "noto": noto, "orbit": orbit, "random": random_oblique}


def method_named(name: str) -> Optimiser:
    """One method.

    Raises
    ------
    InputError
        There is no such method; the message lists those there are.
    """
    if name not in METHODS:
        raise InputError.say("there is no planning method '{}'; known are: {}", name, ", ".join(METHODS))
    return METHODS[name]

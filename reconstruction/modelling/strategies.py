"""The strategy that a configuration asks for, with its schedule in steps."""

from __future__ import annotations

from reconstruction.modelling.config import TrainConfig
from reconstruction.splatting.densification import Densification, FixedNumber, Limits
from reconstruction.splatting.densify_adaptive import AdaptiveControl, AdaptiveParameters
from reconstruction.splatting.densify_mcmc import MarkovChain, McmcParameters


def strategy_of(config: TrainConfig, n_splats: int) -> Densification:
    """Adds splats between two shares of the training, to `max_splats` at most.

    Opacities are never reset: splats start on surfaces that are known, and trainings are short.
    """
    limits = Limits(n_most=max(config.max_splats, n_splats))
    if config.densification == "none":
        return FixedNumber(limits)
    start, stop = (round(share * config.iterations) for share in (config.densify_from, config.densify_until))
    stop = max(start, stop)
    if config.densification == "mcmc":
        return MarkovChain(McmcParameters(start=start, stop=stop, n_splats=config.max_splats), limits)
    return AdaptiveControl(AdaptiveParameters(start=start, stop=stop, reset_every=0), limits)

"""One Adam for all that is learned, and the learning rate that each part has at each step."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import torch
from torch import Tensor, nn

from reconstruction.light.grid.radiance_grid import RadianceGrid
from reconstruction.splats.splats import SHAPES, Splats
from reconstruction.training.config import Rates, TrainConfig
from reconstruction.training.model.joint_model import SceneModel

EPSILON = 1e-15
"""Of Adam: gradients of splats that few pixels see are tiny, and the usual 1e-8 would stop them."""

MEANS = "means"


def adam_of(model: SceneModel, gains: nn.Module, config: TrainConfig, extent_m: float) -> torch.optim.Adam:
    """Adam over model and gains of photos, each group with its `name` and its full rate, `full`.

    With decoupled decay (AdamW) where a group asks for it. Fused: a quarter of the time on a processor, the same bits
    for the same input.

    Parameters
    ----------
    extent_m
        Size of the scene, which the rate of means is a share of.
    """
    rates = config.rates
    groups: list[dict[str, Any]] = [
        {"name": name, "params": params, "full": full} for name, params, full in _of_splats(model.splats, rates)
    ]
    groups[0]["full"] *= extent_m
    groups.append({"name": "sky", "params": list(model.sky.parameters()), "full": rates.sky})
    groups.append({"name": "corner loss", "params": [model.corner_loss], "full": rates.corner_loss})
    groups.append({"name": "exposures", "params": list(gains.parameters()), "full": rates.exposures})
    of_attributes = model.shader.attribute_rates()
    groups += [
        {"name": name, "params": [getattr(model.splats, name)], "full": of_attributes[name]}
        for name in model.splats.names[len(SHAPES) :]
    ]
    groups += [
        {"name": f"shading {number}", "params": group["params"], "full": group["lr"]}
        for number, group in enumerate(model.shader.parameter_groups())
    ]
    if model.light is not None:
        learned = config.reflections.for_grid if isinstance(model.light.light, RadianceGrid) else config.reflections
        groups += [
            {**group, "name": f"light {number}", "full": rates.light * group["lr"]}
            for number, group in enumerate(model.light.parameter_groups(learned))
        ]
    groups = [group for group in groups if group["params"]]
    return torch.optim.AdamW(groups, lr=0.0, eps=EPSILON, weight_decay=0.0, fused=True)


def _of_splats(splats: Splats, rates: Rates) -> Sequence[tuple[str, list[Tensor], float]]:
    return (
        (MEANS, [splats.means], rates.means),
        ("quats", [splats.quats], rates.quats),
        ("scales", [splats.log_scales], rates.scales),
        ("opacities", [splats.opacity_logits], rates.opacities),
        ("colours", [splats.sh], rates.colours),
        ("reflectivity", [splats.reflectivity_logits], rates.reflectivity),
        ("f0", [splats.f0_logits], rates.f0),
    )


@torch.no_grad()
def take_step(optimiser: torch.optim.Adam, splats: Splats, rates: Rates) -> None:
    """A step of Adam, in which some of what splats have goes only a share of it.

    That is the bands of spherical harmonics above the first (`colour_details`), and places and rotations of splats on
    panels (`glass_geometry`). Adam's steps do not depend on the gradients' size, so it is the step that is shortened.
    """
    glass = splats.panels >= 0
    turned = (splats.means, splats.quats) if rates.glass_geometry != 1.0 else ()
    details, before = splats.sh[:, 1:].clone(), [value[glass] for value in turned]
    optimiser.step()
    splats.sh[:, 1:] = torch.lerp(details, splats.sh[:, 1:], rates.colour_details)
    for value, old in zip(turned, before, strict=True):
        value[glass] = torch.lerp(old, value[glass], rates.glass_geometry)


def set_rates(optimiser: torch.optim.Adam, rates: Rates, step: int, progress: float, factor: float) -> None:
    """Give each group the rate of this step.

    Parameters
    ----------
    progress
        Of the whole training, 0 to 1, by steps or by time, whichever is further.
    factor
        Of all rates: halved whenever a step gave no numbers.
    """
    share, of_means = rates.share(step, progress), rates.means_share(step, progress)
    for group in optimiser.param_groups:
        group["lr"] = factor * group["full"] * (of_means if group["name"] == MEANS else share)

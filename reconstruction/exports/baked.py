"""What panels show, mirrored light and all, put into their Gaussians' own colours: for programs that mirror nothing.

Colours by direction are harmonics of degree 3, so what is mirrored becomes a blur of some tens of degrees that stays on
the pane. The model itself keeps its sharp mirror images; `docs/reference/exports.md` says how much is lost.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from reconstruction.light.ray_table import RayTable
from reconstruction.light.shading import display_from_linear, schlick, shade
from reconstruction.objects.gs_scene import GsComponent, GsScene
from reconstruction.splats.harmonic_colour import display_colours, fitted_harmonics, light_of_display
from reconstruction.training.model.joint_model import SceneModel

N_DIRECTIONS = 96
"""From which a pane is looked at: six for each harmonic."""

DEGREE = 3

LEAST_COSINE = 0.05
"""Of directions against the pane's normal: at 87 degrees, glass mirrors nearly all, and nobody flies there."""

AT_ONCE = 200_000
"""Rays of one piece of work."""

ALMOST_NO_LOGIT = -20.0
"""Reflectivity that is left: 2e-9."""

FAR_M = 1e4


def needs_baking(model: SceneModel) -> bool:
    """Whether panels show light that is not in their Gaussians' own colours, and can be put there."""
    return model.light is not None


@torch.no_grad()
def baked(scene: GsScene, model: SceneModel, monitor: Monitor = QUIET) -> GsScene:
    """The scene with Gaussians on panels that have, and no longer mirror, what the panels show.

    Parameters
    ----------
    scene
        Any of the components of `model`'s.

    Raises
    ------
    ValueError
        The model has no light that panels mirror.
    """
    if model.light is None:
        raise ValueError("model: expected one whose panels mirror light")
    table = RayTable.of([], model.planes, {})
    n_panels = sum(len(component.elements) for component in scene.components)
    done = 0
    components = []
    for component in scene.components:
        sh = component.gaussians.values["sh"].copy()
        reflectivity = component.gaussians.values["reflectivity_logits"].copy()
        for element in component.elements:
            monitor.report(say("baking panels"), done, n_panels)
            done += 1
            for rows in _pieces(element.start, element.stop):
                sh[rows] = _shown(component, rows, element.panel, model, table, np.asarray(scene.origin_enu_m))
                reflectivity[rows] = ALMOST_NO_LOGIT
        values = {**component.gaussians.values, "sh": sh, "reflectivity_logits": reflectivity}
        components.append(replace(component, gaussians=replace(component.gaussians, values=values)))
    return replace(scene, components=tuple(components))


def _pieces(start: int, stop: int) -> Iterator[slice]:
    step = AT_ONCE // N_DIRECTIONS
    return (slice(first, min(first + step, stop)) for first in range(start, stop, step))


def _shown(
    component: GsComponent,
    rows: slice,
    panel: int,
    model: SceneModel,
    table: RayTable,
    origin_enu_m: NDArray[np.float64],
) -> NDArray[np.float32]:
    """Coefficients, shape (n, 16, 3), of what Gaussians on a panel show from in front of it."""
    assert model.light is not None
    part = {name: torch.from_numpy(value[rows].copy()) for name, value in component.gaussians.values.items()}
    n = len(part["means"])
    outwards = outward_directions(table.normals[panel])
    k = len(outwards)
    panels = torch.full((n * k,), panel, dtype=torch.long)
    points = part["means"].double() + torch.from_numpy(origin_enu_m) - table.middle_m
    met = table.arriving(points.repeat_interleave(k, dim=0), (-outwards).repeat(n, 1), panels)
    omega_r, cosines = model.light.mirrored(table, met, panels)
    light = model.light.light(table.rescaled(met.points_m).float(), omega_r, panels)
    own = torch.stack(
        [
            display_colours(part["means"], part["sh"], (part["means"].mean(0) + FAR_M * each).float(), 3)
            for each in outwards
        ],
        dim=1,
    )
    colours = light_of_display(own).reshape(n * k, 3)
    reflectivity = torch.sigmoid(part["reflectivity_logits"]).repeat_interleave(k)[:, None]
    fresnel = schlick(torch.sigmoid(part["f0_logits"]).repeat_interleave(k, dim=0), cosines)
    shown = display_from_linear(shade(colours, reflectivity, fresnel, light)).clamp(max=1.0)
    return fitted_harmonics(-outwards, shown.reshape(n, k, 3), DEGREE).numpy()


def outward_directions(normal: Tensor) -> Tensor:
    """Evenly spread over the hemisphere before a panel, but for its rim, shape (k, 3), float64, unit.

    A Fibonacci spiral, of equal solid angles.
    """
    number = torch.arange(N_DIRECTIONS, dtype=torch.float64) + 0.5
    height = 1.0 - (1.0 - LEAST_COSINE) * number / N_DIRECTIONS
    turn = number * math.pi * (3.0 - math.sqrt(5.0))
    flat = torch.sqrt(1.0 - height * height)
    # Any axis across the normal will do.
    other = torch.eye(3, dtype=torch.float64)[int(normal.abs().argmin())]
    u = torch.nn.functional.normalize(torch.linalg.cross(normal, other), dim=0)
    v = torch.linalg.cross(normal, u)
    across = torch.cos(turn)[:, None] * u + torch.sin(turn)[:, None] * v
    found: Tensor = height[:, None] * normal + flat[:, None] * across
    return found

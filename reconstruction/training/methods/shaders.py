"""The shading of each method that knows no panels, and splats as it needs them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from reconstruction.splats.splats import NO_PANEL, SHAPES, Splats, flattened
from reconstruction.training.config import TrainConfig
from reconstruction.training.method_registry import Primitive
from reconstruction.training.methods.gaussian_shader import GaussianShader
from reconstruction.training.methods.ref_gaussian import RefGaussian
from reconstruction.training.methods.ref_gs import RefGs
from reconstruction.training.methods.shader import Shader

FLATNESS = 0.3
"""Smallest size of an ellipsoid that begins in a disc's place, of the disc's smaller one: it is on a surface."""


@dataclass(frozen=True, slots=True, eq=False)
class Surroundings:
    """What a shading may know of the scene.

    Parameters
    ----------
    triangles_m
        Of the refined mesh, in the model's frame, shape (m, 3, 3), float32.
    """

    triangles_m: NDArray[np.float32]


_SHADERS: dict[str, Callable[[TrainConfig, Surroundings], Shader]] = {
    "gaussian-shader": lambda config, surroundings: GaussianShader(),
    "ref-gaussian": lambda config, surroundings: RefGaussian(torch.from_numpy(surroundings.triangles_m)),
    "ref-gs": lambda config, surroundings: RefGs(config.seed),
}
"""By the method's name; plug-ins bring theirs, and all others have harmonics alone."""


def shader_of(config: TrainConfig, surroundings: Surroundings) -> Shader:
    """For a training that begins."""
    if config.method in _SHADERS:
        return _SHADERS[config.method](config, surroundings)
    of_plugin = config.trained_by.shader
    if of_plugin is None:
        return Shader()
    made = of_plugin(config, surroundings)
    if not isinstance(made, Shader):
        raise TypeError(f"the method '{config.method}': expected a Shader, got {type(made).__name__}")
    return made


def empty_shader(config: TrainConfig, tensors: Mapping[str, Tensor]) -> Shader:
    """Of the shape that a configuration tells, for weights to be put in."""
    triangles = tensors.get("shader.triangles_m")
    return shader_of(config, Surroundings(np.zeros((0, 3, 3), np.float32) if triangles is None else triangles.numpy()))


def converted_for_method(splats: Splats, config: TrainConfig, shader: Shader) -> Splats:
    """Splats on surfaces as those that a method which knows no panels begins with."""
    plain = with_primitive(splats, config.trained_by.primitive)
    values = {name: plain.get_parameter(name).detach() for name in SHAPES}
    return Splats(values | shader.attributes(plain), torch.full_like(plain.panels, NO_PANEL))


def with_primitive(splats: Splats, primitive: Primitive) -> Splats:
    """Discs as ellipsoids that are nearly as flat, ellipsoids as discs without their shortest axis, or the same."""
    values = {name: splats.get_parameter(name).detach() for name in SHAPES}
    sizes = values["log_scales"]
    if splats.is_flat == (primitive == "discs"):
        return splats
    if splats.is_flat:
        thin = sizes.min(dim=1, keepdim=True).values + math.log(FLATNESS)
        values["log_scales"] = torch.cat([sizes, thin], dim=1)
    else:
        values["quats"], values["log_scales"] = flattened(values["quats"], sizes)
    return Splats(values, splats.panels)

"""The shading of each method that knows no panels, and splats as it needs them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from importlib import import_module
from importlib.util import find_spec

import numpy as np
import torch
from torch import Tensor

from reconstruction.splats.splats import NO_PANEL, SHAPES, Splats, flattened
from reconstruction.training.config import TrainConfig
from reconstruction.training.method_registry import Primitive
from reconstruction.training.methods.shader import Shader, Surroundings

FLATNESS = 0.3
"""Smallest size of an ellipsoid that begins in a disc's place, of the disc's smaller one: it is on a surface."""


def shader_of(config: TrainConfig, surroundings: Surroundings) -> Shader:
    """For a training that begins: as the method's plug-in or its module makes it; all others have harmonics alone.

    The module of `ref-gs` is `ref_gs` in this room, and its `make_shader` takes what this function takes.
    """
    module = f"{__package__}.{config.method.replace('-', '_')}"
    make = config.trained_by.shader
    if make is None and find_spec(module) is not None:
        make = getattr(import_module(module), "make_shader", None)
    if make is None:
        return Shader()
    made = make(config, surroundings)
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

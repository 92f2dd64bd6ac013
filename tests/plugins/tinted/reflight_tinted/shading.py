"""Shading with one tint."""

import torch

from reconstruction.training.methods.shader import Shader


class Tinted(Shader):
    """Harmonics times one colour."""

    def __init__(self):
        super().__init__()
        self.tint = torch.nn.Parameter(torch.ones(3))

    def colours(self, splats, position_m, degree):
        return super().colours(splats, position_m, degree) * self.tint

    def parameter_groups(self):
        return [{"params": [self.tint], "lr": 1e-3}]

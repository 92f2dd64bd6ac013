"""Scenes that formats may stumble over, and what several tests of formats ask."""

import math
from dataclasses import replace

import numpy as np

from planning.base.errors import OperationCancelled
from reconstruction.exports.component_parts import Ellipsoids, ellipsoids_of_all
from reconstruction.exports.gaussian_blocks import morton_order, turned
from tests.reconstruction.objects.synthetic_scene import synthetic_scene


def scene_with(n=40, **columns):
    """A background whose Gaussians have numbers of a test's own."""
    scene = synthetic_scene(((1,),), n)
    for name, value in columns.items():
        for component in scene.components:
            component.gaussians.values[name][:] = value
    return scene


USUAL_BLUR_PX = math.sqrt(0.3)


def antialiased(scene, is_on=True, blur_px=USUAL_BLUR_PX):
    """The scene, as if it had been learned so."""
    return replace(scene, training={**scene.training, "config": {"raster": {"antialiased": is_on, "blur_px": blur_px}}})


def spread(scene, furthest_m, seed=0):
    """The scene, its Gaussians up to so far from the origin."""
    rng = np.random.default_rng(seed)
    for component in scene.components:
        means = component.gaussians.values["means"]
        means[:] = rng.uniform(-furthest_m, furthest_m, means.shape)
    return scene


def in_order(scene, axes) -> Ellipsoids:
    """A scene's Gaussians, told in ENU, in the order of a file of these axes."""
    ellipsoids = ellipsoids_of_all(scene.components)
    return ellipsoids.chosen(morton_order(turned(ellipsoids, axes).means_m))


def quaternion_errors(one, other):
    """Of the same rotations whatever their sign, shape (n,)."""
    return np.minimum(np.abs(one - other).max(axis=1), np.abs(one + other).max(axis=1))


class Interrupted:
    """A monitor that ends the work at the n-th report."""

    def __init__(self, n):
        self.left = n

    def report(self, stage, done, total):
        self.left -= 1
        if self.left < 0:
            raise OperationCancelled("no longer wanted")

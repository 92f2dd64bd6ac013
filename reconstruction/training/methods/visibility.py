"""Where mirrored rays meet the scene: against a known mesh, for methods that treat that light by itself."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reconstruction.base.ray_casting import RayCaster

Array = NDArray[np.float64]

LIFT_M = 0.02
"""Along the normal, from which mirrored rays begin: a surface does not meet itself, and frames stand out further."""


def meets_scene(caster: RayCaster, points_enu_m: Array, normals_enu: Array, omega_o: Array) -> NDArray[np.bool_]:
    """Whether rays mirrored at points meet the mesh, shape (n,).

    Parameters
    ----------
    points_enu_m, normals_enu
        On the surface, shape (n, 3); normals unit, either way round.
    omega_o
        Unit directions from the camera to the points, ENU, shape (n, 3).
    """
    along = (omega_o * normals_enu).sum(axis=1, keepdims=True)
    lifted = points_enu_m - np.sign(along) * LIFT_M * normals_enu
    return np.asarray(caster.cast(lifted, omega_o - 2.0 * along * normals_enu).is_hit)


def points_on_mesh(caster: RayCaster, position_enu_m: Array, omega_o: Array, otherwise_enu_m: Array) -> Array:
    """Where lines of sight meet the mesh, shape (n, 3).

    Blended depths are metres off while a training begins, and mirrored rays that start behind a facade meet it from
    behind; these points are right from the start.

    Parameters
    ----------
    position_enu_m
        Of the camera, shape (3,).
    omega_o
        Unit directions away from it, ENU, shape (n, 3).
    otherwise_enu_m
        Points for those that meet nothing, shape (n, 3).
    """
    distances = caster.cast(position_enu_m, omega_o).distance_m[:, None]
    meets = np.isfinite(distances)
    return np.where(meets, position_enu_m + np.where(meets, distances, 0.0) * omega_o, otherwise_enu_m)

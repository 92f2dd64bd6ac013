"""Random errors that change smoothly with time, exact for any step."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planning.geo.frames import Vec3

Floats = NDArray[np.float64]

SHORT_STEP = 1e-3
"""Steps shorter than this share of the correlation time use the leading terms of the step's covariance: the exact ones
are differences of nearly equal numbers there, and the terms left out are smaller than this share."""


class SmoothNoise:
    """Three independent second-order Gauss-Markov processes: x'' + 2 x'/T + x/T^2 = white noise.

    Both roots are equal, as in Gelb (1974, Applied Optimal Estimation, section 2.2). The autocorrelation is
    s^2 (1 + |t|/T) exp(-|t|/T), so that there is a velocity (1 sigma: s/T) and nothing jumps. It begins in its
    stationary state.

    Parameters
    ----------
    sigma
        1 sigma of x, by axis.
    correlation_s
        T.
    """

    def __init__(self, sigma: Vec3, correlation_s: float, rng: np.random.Generator) -> None:
        if not (correlation_s > 0.0 and min(sigma) >= 0.0):
            raise ValueError(f"expected sigmas of 0 or more and a positive time, got {sigma} and {correlation_s}")
        self._sigma, self._rng = np.array(sigma), rng
        self._correlation_s = correlation_s
        self._state: Floats = rng.standard_normal((2, 3)) / np.array([[1.0], [correlation_s]])
        self._duration_s = 0.0
        self._transition, self._spread = _step_of(0.0, correlation_s)

    @property
    def value(self) -> Vec3:
        """The errors now."""
        x, y, z = (self._sigma * self._state[0]).tolist()
        return x, y, z

    def step(self, duration_s: float) -> None:
        """Let them change for a time."""
        if duration_s != self._duration_s:
            self._transition, self._spread = _step_of(duration_s, self._correlation_s)
            self._duration_s = duration_s
        self._state = self._transition @ self._state + self._spread @ self._rng.standard_normal((2, 3))


def _step_of(duration_s: float, correlation_s: float) -> tuple[Floats, Floats]:
    """Transition of (x, x') of unit sigma over a time, and a root of the covariance that is added."""
    t, big = duration_s, correlation_s
    u = t / big
    decay = math.exp(-u)
    transition = decay * np.array([[1.0 + u, t], [-u / big, 1.0 - u]])
    if u < SHORT_STEP:
        q = 4.0 / big**3
        covariance = q * np.array([[t**3 / 3.0, t**2 / 2.0], [t**2 / 2.0, t]])
    else:
        stationary = np.diag([1.0, 1.0 / big**2])
        covariance = stationary - transition @ stationary @ transition.T
    return transition, covariance_root(covariance)


def covariance_root(covariance: Floats) -> Floats:
    """A matrix R with R R^T = the covariance, also where that is singular or not quite definite by rounding."""
    scale = np.sqrt(np.maximum(np.diagonal(covariance), np.finfo(np.float64).tiny))
    values, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
    return np.asarray(scale[:, None] * vectors * np.sqrt(np.maximum(values, 0.0)))

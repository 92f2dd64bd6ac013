"""How far and how long an aircraft falls whose motors are off, with any drag up to a stated one.

With u the speed through the air, w the wind, c the climb and H the height:

    through the air it moves by x <= u T0, T0 = (c + sqrt(c^2 + 2 g H)) / g, since drag takes it down nearer (the slope
    dz/dx changes by -g / u^2, and drag only lessens u), and by x <= ln(1 + k u T) / k, since u' <= -k u^2,
    with the air it moves by w T, T(k) the longest fall with the drag k (`longest_fall_s`),
    so that over the ground it is S <= max over k of min(u T0, ln(1 + k u T) / k) + w T.
"""

from __future__ import annotations

import math

import numpy as np

LEAST_GRAVITY_M_S2 = 9.78
"""At the equator, at sea level: things fall slowest there, and so furthest."""

AIR_KG_M3 = 1.225
"""ISA at sea level: the densest air that a flight is likely to meet carries a falling aircraft furthest."""


def fall_s(height_m: float, climb_m_s: float, gravity_m_s2: float = LEAST_GRAVITY_M_S2) -> float:
    """Time from switching motors off to the ground without drag: g t = c + sqrt(c^2 + 2 g h)."""
    return (climb_m_s + math.sqrt(climb_m_s * climb_m_s + 2.0 * gravity_m_s2 * height_m)) / gravity_m_s2


def longest_fall_s(height_m: float, climb_m_s: float, level_m_s: float, drag_per_m: float) -> float:
    """Longest time to the ground with quadratic drag, of a body that climbs and moves level through the air at first.

    Upwards it takes no longer, and comes no higher, than without drag. Downwards from there, with k the drag,

        v' = g - k sqrt(u^2 + v^2) v,   u <= u0 / (1 + k u0 t),

    since drag on the level speed alone is already k u^2. k u grows with k and u0, so that less drag and less speed fall
    faster: it holds for every drag up to that of `drag_per_m` and every level speed up to `level_m_s`.
    """
    g, k = LEAST_GRAVITY_M_S2, drag_per_m
    apex_m, up_s = height_m + climb_m_s * climb_m_s / (2.0 * g), climb_m_s / g

    def slope(t: float, v: float) -> float:
        level = level_m_s / (1.0 + k * level_m_s * t)
        return g - k * math.hypot(level, v) * v

    def after(h: float) -> tuple[float, float]:
        """Runge and Kutta's fourth order for v; z by Simpson's rule over the same stages."""
        a = slope(t, v)
        b = slope(t + 0.5 * h, v + 0.5 * h * a)
        c = slope(t + 0.5 * h, v + 0.5 * h * b)
        d = slope(t + h, v + h * c)
        return v + h / 6.0 * (a + 2.0 * b + 2.0 * c + d), z + h * v + h * h / 6.0 * (a + b + c)

    t, v, z, step_s = 0.0, 0.0, 0.0, FALL_STEP / math.sqrt(g * k)
    for _ in range(FALL_STEPS):
        next_v, next_z = after(step_s)
        if next_z >= apex_m:
            low, high = 0.0, step_s
            for _ in range(60):
                middle = 0.5 * (low + high)
                low, high = (middle, high) if after(middle)[1] < apex_m else (low, middle)
            return max(up_s + t + high, fall_s(height_m, climb_m_s))
        t, v, z = t + step_s, next_v, next_z
    # It only becomes faster from here on.
    return up_s + t + (apex_m - z) / v


FALL_STEP, FALL_STEPS = 0.02, 1000
"""Steps of a fall in times of 1 / sqrt(g k), within which speeds change: 20 of them, after which it is as fast as it
gets to seven digits. Against steps a tenth as long the time differs by less than 1e-6 of itself."""


def reach_m(height_m: float, climb_m_s: float, level_m_s: float, wind_m_s: float, most_drag_per_m: float) -> float:
    """How far over the ground a body can fall, whatever its drag up to the stated one; see the module.

    Between two drags, the lower bounds the way through the air and the higher the time: the first term falls with the
    drag and the second rises, so that nothing between them is missed.
    """
    drags = most_drag_per_m * np.linspace(0.0, 1.0, DRAGS) ** 2
    through_m = level_m_s * fall_s(height_m, climb_m_s)
    if wind_m_s == 0.0:
        return through_m
    furthest_m = 0.0
    for less, more in zip(drags[:-1].tolist(), drags[1:].tolist(), strict=True):
        time_s = longest_fall_s(height_m, climb_m_s, level_m_s, more)
        slowed_m = math.log1p(less * level_m_s * time_s) / less if less > 0.0 else math.inf
        furthest_m = max(furthest_m, min(through_m, slowed_m) + wind_m_s * time_s)
    return furthest_m


DRAGS = 33
"""Drags that are tried, closer together where they are small: twice as many bring the reach down by 1 % at most."""


def drag_per_m(mass_kg: float, drag_area_m2: float) -> float:
    """Deceleration by drag over the square of the speed."""
    return 0.5 * AIR_KG_M3 * drag_area_m2 / mass_kg

"""Squared distances between points, segments and triangles, robust for degenerate ones; compiled, float64.

Triangles of no area are treated as the segments they are. Squared distances are never negative and never NaN for
finite input.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import inline, kernel

Array = NDArray[np.float64]


@inline
def _clamp01(x: float) -> float:
    return min(max(x, 0.0), 1.0)


@kernel
def point_segment_d2(p: Array, a: Array, b: Array) -> float:
    """Squared distance of a point and a segment, points of shape (3,)."""
    abx, aby, abz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    apx, apy, apz = p[0] - a[0], p[1] - a[1], p[2] - a[2]
    length2 = abx * abx + aby * aby + abz * abz
    t = _clamp01((apx * abx + apy * aby + apz * abz) / length2) if length2 > 0.0 else 0.0
    dx, dy, dz = apx - t * abx, apy - t * aby, apz - t * abz
    return float(dx * dx + dy * dy + dz * dz)


@kernel
def segment_segment_d2(a: Array, b: Array, c: Array, d: Array) -> float:
    """Squared distance of segments ab and cd (after Ericson, Real-Time Collision Detection, 5.1.9)."""
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    vx, vy, vz = d[0] - c[0], d[1] - c[1], d[2] - c[2]
    wx, wy, wz = a[0] - c[0], a[1] - c[1], a[2] - c[2]
    uu, vv = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz
    if uu <= 0.0:
        return point_segment_d2(a, c, d)
    if vv <= 0.0:
        return point_segment_d2(c, a, b)
    uv = ux * vx + uy * vy + uz * vz
    uw, vw = ux * wx + uy * wy + uz * wz, vx * wx + vy * wy + vz * wz
    determinant = uu * vv - uv * uv
    # Nearly parallel: the end points below find the distance, so any s will do.
    s = _clamp01((uv * vw - vv * uw) / determinant) if determinant > 1e-12 * uu * vv else 0.0
    t = (uv * s + vw) / vv
    if t < 0.0:
        t = 0.0
        s = _clamp01(-uw / uu)
    elif t > 1.0:
        t = 1.0
        s = _clamp01((uv - uw) / uu)
    dx, dy, dz = wx + s * ux - t * vx, wy + s * uy - t * vy, wz + s * uz - t * vz
    best = dx * dx + dy * dy + dz * dz
    if determinant <= 1e-12 * uu * vv:
        best = min(best, point_segment_d2(a, c, d), point_segment_d2(b, c, d))
        best = min(best, point_segment_d2(c, a, b), point_segment_d2(d, a, b))
    return float(best)


@kernel
def point_triangle_d2(p: Array, triangle: Array) -> float:
    """Squared distance of a point and a triangle, corners of shape (3, 3)."""
    a, b, c = triangle[0], triangle[1], triangle[2]
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    vx, vy, vz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    wx, wy, wz = p[0] - a[0], p[1] - a[1], p[2] - a[2]
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    area2 = nx * nx + ny * ny + nz * nz
    if area2 > 1e-20 * (ux * ux + uy * uy + uz * uz) * (vx * vx + vy * vy + vz * vz):
        # Barycentric coordinates of the foot point on the plane.
        s = ((wy * vz - wz * vy) * nx + (wz * vx - wx * vz) * ny + (wx * vy - wy * vx) * nz) / area2
        t = ((uy * wz - uz * wy) * nx + (uz * wx - ux * wz) * ny + (ux * wy - uy * wx) * nz) / area2
        if s >= 0.0 and t >= 0.0 and s + t <= 1.0:
            along = wx * nx + wy * ny + wz * nz
            return float(along * along / area2)
    return min(point_segment_d2(p, a, b), point_segment_d2(p, b, c), point_segment_d2(p, c, a))


@kernel
def segment_hits_triangle(a: Array, b: Array, triangle: Array) -> float:
    """Where segment ab meets a triangle: the parameter in [0, 1], or -1 where it does not (or lies in its plane)."""
    p = triangle[0]
    ux, uy, uz = triangle[1, 0] - p[0], triangle[1, 1] - p[1], triangle[1, 2] - p[2]
    vx, vy, vz = triangle[2, 0] - p[0], triangle[2, 1] - p[1], triangle[2, 2] - p[2]
    dx, dy, dz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    hx, hy, hz = dy * vz - dz * vy, dz * vx - dx * vz, dx * vy - dy * vx
    determinant = ux * hx + uy * hy + uz * hz
    if determinant == 0.0:
        return -1.0
    wx, wy, wz = a[0] - p[0], a[1] - p[1], a[2] - p[2]
    s = (wx * hx + wy * hy + wz * hz) / determinant
    qx, qy, qz = wy * uz - wz * uy, wz * ux - wx * uz, wx * uy - wy * ux
    t = (dx * qx + dy * qy + dz * qz) / determinant
    along = (vx * qx + vy * qy + vz * qz) / determinant
    if s >= 0.0 and t >= 0.0 and s + t <= 1.0 and 0.0 <= along <= 1.0:
        return float(along)
    return -1.0


@kernel
def segment_triangle_d2(a: Array, b: Array, triangle: Array) -> float:
    """Squared distance of segment ab and a triangle; 0 where they meet."""
    if segment_hits_triangle(a, b, triangle) >= 0.0:
        return 0.0
    best = min(point_triangle_d2(a, triangle), point_triangle_d2(b, triangle))
    best = min(best, segment_segment_d2(a, b, triangle[0], triangle[1]))
    best = min(best, segment_segment_d2(a, b, triangle[1], triangle[2]))
    return min(best, segment_segment_d2(a, b, triangle[2], triangle[0]))

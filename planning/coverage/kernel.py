"""The fast coverage kernel: which section of which panel a view covers, without trigonometry and without branches.

With d = o - c (not normalised) and q = |d|^2, the ring is the number of k with (d.n)^2 <= cos^2(k step) q, and the
sector follows from the signs of u = d.t and v = d.b and from comparisons |v| >= tan(k step) |u| within a quadrant. Both
agree with `planning.coverage.sections` except for rounding on the section borders. The same source is compiled for
float32 and float64; loops over views vectorise. Arrays of views have 11 rows: position (3), forward (3), right (2, its
z is 0), up (3). All coordinates are relative to a centre near the panels, so that float32 keeps its digits.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import kernel

N_VIEW_ROWS = 11
WIDTHS = (2, 8)
"""Border comparisons unrolled into the first pass: 2 do for steps from 30 degrees on, else 8; further passes take 8."""

Floats = NDArray[Any]


@kernel
def panel_codes(
    panel: Floats,
    views: Floats,
    limits: Floats,
    cos2: tuple[float, ...],
    tangents: tuple[float, ...],
    base: int,
    sectors_per_quadrant: int,
    codes: NDArray[np.int32],
) -> None:
    """Codes (section + 1, or 0 for not covered) of one panel in views of shape (11, n), written or added to `codes`.

    Parameters
    ----------
    panel
        Shape (12,): centroid, normal, tangent, bitangent.
    limits
        Tangents of the half angles of view (2), largest squared distance, and the constants 0 and the smallest normal
        number, in the dtype of all other arrays, so that no operation is widened.
    base
        1 in the first pass, which starts the codes; 0 in further ones, which only add comparisons.
    """
    cx, cy, cz, nx, ny, nz = panel[0], panel[1], panel[2], panel[3], panel[4], panel[5]
    tx, ty, tz, bx, by, bz = panel[6], panel[7], panel[8], panel[9], panel[10], panel[11]
    half_width, half_height, max_q, zero, tiny = limits[0], limits[1], limits[2], limits[3], limits[4]
    none, one = np.int32(0), np.int32(1)
    quadrant = np.int32(sectors_per_quadrant * base)
    ring = np.int32(4 * sectors_per_quadrant)
    first = np.int32(base)
    ox, oy, oz, fx, fy, fz = views[0], views[1], views[2], views[3], views[4], views[5]
    rx, ry, ux, uy, uz = views[6], views[7], views[8], views[9], views[10]
    for i in range(len(ox)):
        dx, dy, dz = ox[i] - cx, oy[i] - cy, oz[i] - cz
        along = dx * nx + dy * ny + dz * nz
        u = dx * tx + dy * ty + dz * tz
        v = dx * bx + dy * by + dz * bz
        depth = -(fx[i] * dx + fy[i] * dy + fz[i] * dz)
        across = abs(rx[i] * dx + ry[i] * dy)
        upwards = abs(ux[i] * dx + uy[i] * dy + uz[i] * dz)
        q = dx * dx + dy * dy + dz * dz
        slack = min(half_width * depth - across, half_height * depth - upwards)
        covered = (along > zero) & (slack >= zero) & (q <= max_q)
        lower = (v < zero) | ((v == zero) & (u < zero))
        odd = (lower & (u >= zero)) | ((v > zero) & (u <= zero))
        leg = max(abs(v) if odd else abs(u), tiny)
        rise = abs(u) if odd else abs(v)
        code = first + (quadrant + quadrant if lower else none) + (quadrant if odd else none)
        for k in range(len(tangents)):
            code += one if rise >= tangents[k] * leg else none
        for k in range(len(cos2)):
            code += ring if along * along <= cos2[k] * q else none
        if base == 1:
            codes[i] = code if covered else none
        else:
            codes[i] += code if covered else none


@kernel
def _all_passes(
    panel: Floats,
    views: Floats,
    limits: Floats,
    cos2: tuple[float, ...],
    tangents: tuple[float, ...],
    further: Floats,
    sectors_per_quadrant: int,
    codes: NDArray[np.int32],
) -> None:
    panel_codes(panel, views, limits, cos2, tangents, 1, sectors_per_quadrant, codes)
    for c, t in zip(further[0], further[1]):  # noqa: B905  (Numba knows no strict)
        more_cos2 = (c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7])
        more_tangents = (t[0], t[1], t[2], t[3], t[4], t[5], t[6], t[7])
        panel_codes(panel, views, limits, more_cos2, more_tangents, 0, sectors_per_quadrant, codes)


@kernel
def mark_covered(
    panels: Floats,
    views: Floats,
    limits: Floats,
    cos2: tuple[float, ...],
    tangents: tuple[float, ...],
    further: Floats,
    sectors_per_quadrant: int,
    hits: NDArray[np.uint8],
) -> None:
    """Set `hits[j, code]` to 1 for every panel j (rows of `panels`, shape (m, 12)) and view; code 0 is "not covered".

    `cos2` and `tangents` are the section borders of the first pass, `further` (2, passes, 8) those of the others.
    """
    n = views.shape[1]
    codes = np.empty(n, np.int32)
    for j in range(len(panels)):
        _all_passes(panels[j], views, limits, cos2, tangents, further, sectors_per_quadrant, codes)
        row = hits[j]
        for i in range(n):
            row[np.uint32(codes[i])] = 1


@kernel
def fill_codes(
    panels: Floats,
    views: Floats,
    limits: Floats,
    cos2: tuple[float, ...],
    tangents: tuple[float, ...],
    further: Floats,
    sectors_per_quadrant: int,
    codes: NDArray[np.int32],
) -> None:
    """Write the codes of all panels and views, shape (m, n)."""
    for j in range(len(panels)):
        _all_passes(panels[j], views, limits, cos2, tangents, further, sectors_per_quadrant, codes[j])


@kernel
def elements_per_view(codes: NDArray[np.int32], counts: NDArray[np.int64]) -> None:
    """Number of panels that each view covers, from codes of shape (m, n), added to `counts`, shape (n,)."""
    for j in range(codes.shape[0]):
        for i in range(codes.shape[1]):
            counts[i] += 1 if codes[j, i] > 0 else 0


@kernel
def gather_elements(
    codes: NDArray[np.int32], n_sections: int, next_free: NDArray[np.int64], elements: NDArray[np.int32]
) -> None:
    """Write element numbers (panel * n_sections + section) view by view; `next_free` holds each view's first place."""
    for j in range(codes.shape[0]):
        for i in range(codes.shape[1]):
            if codes[j, i] > 0:
                elements[next_free[i]] = j * n_sections + codes[j, i] - 1
                next_free[i] += 1

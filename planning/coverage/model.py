"""The coverage model of a site: which elements (panel and section) a view covers, effects included."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import chunks, kernel, run_chunks
from planning.coverage.sections import NOT_SEEN, PanelFrames, SectionGrid, in_picture, sections_of, sections_seen
from planning.geo.bvh import OCCLUSION_OFFSET_M, LineOfSight
from planning.geo.frames import camera_axes
from planning.parameters import Precision
from planning.plan import Camera, ViewpointArrays

# The fast coverage kernel: which section of which panel a view covers, without trigonometry and without branches.
#
# With d = o - c (not normalised) and q = |d|^2, the ring is the number of k with (d.n)^2 <= cos^2(k step) q, and the
# sector follows from the signs of u = d.t and v = d.b and from comparisons |v| >= tan(k step) |u| within a quadrant.
# Both agree with `planning.coverage.sections` except for rounding on the section borders. The same source is compiled
# for float32 and float64; loops over views vectorise. Arrays of views have 11 rows: position (3), forward (3), right
# (2, its z is 0), up (3). All coordinates are relative to a centre near the panels, so that float32 keeps its digits.

N_VIEW_ROWS = 11
WIDTHS = (2, 8)
"""Border comparisons unrolled into the first pass: 2 do for steps from 30 degrees on, else 8; further passes take 8."""

Floats = NDArray[Any]


@kernel
def _panel_codes(
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
    _panel_codes(panel, views, limits, cos2, tangents, 1, sectors_per_quadrant, codes)
    for c, t in zip(further[0], further[1]):  # noqa: B905  (Numba knows no strict)
        more_cos2 = (c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7])
        more_tangents = (t[0], t[1], t[2], t[3], t[4], t[5], t[6], t[7])
        _panel_codes(panel, views, limits, more_cos2, more_tangents, 0, sectors_per_quadrant, codes)


@kernel
def _mark_covered(
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
def _fill_codes(
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
def _elements_per_view(codes: NDArray[np.int32], counts: NDArray[np.int64]) -> None:
    """Number of panels that each view covers, from codes of shape (m, n), added to `counts`, shape (n,)."""
    for j in range(codes.shape[0]):
        for i in range(codes.shape[1]):
            counts[i] += 1 if codes[j, i] > 0 else 0


@kernel
def _gather_elements(
    codes: NDArray[np.int32], n_sections: int, next_free: NDArray[np.int64], elements: NDArray[np.int32]
) -> None:
    """Write element numbers (panel * n_sections + section) view by view; `next_free` holds each view's first place."""
    for j in range(codes.shape[0]):
        for i in range(codes.shape[1]):
            if codes[j, i] > 0:
                elements[next_free[i]] = j * n_sections + codes[j, i] - 1
                next_free[i] += 1


VIEWS_PER_CHUNK = 2048
PAIRS_PER_CHUNK = 4_000_000
"""Bounds the memory of one chunk of codes to 16 MB."""


class Elements(NamedTuple):
    """Elements covered by each of n views, as compressed rows: view i covers `items[starts[i]:starts[i + 1]]`.

    An element is panel * n_sections + section. `starts` has shape (n + 1,), int64; `items` int32.
    """

    starts: NDArray[np.int64]
    items: NDArray[np.int32]

    def of(self, view: int) -> NDArray[np.int32]:
        """Elements of one view."""
        return self.items[self.starts[view] : self.starts[view + 1]]


@dataclass(frozen=True, slots=True, eq=False)
class CoverageModel:
    """What counts as covered.

    Parameters
    ----------
    frames, camera, grid
        Panels, camera, and sections of their hemispheres.
    whole_panel
        All four corners must be in the picture, not only the centroid.
    max_distance_m
        Views from further away cover nothing; None for no limit.
    sharp_m
        Views from further away cover, but are not sharp; None for no limit.
    sight
        Line-of-sight test where occlusion is taken into account, else None.
    precision
        Of the fast kernel. `f32` differs from `f64` only on section borders.
    """

    frames: PanelFrames
    camera: Camera
    grid: SectionGrid
    whole_panel: bool = False
    max_distance_m: float | None = None
    sharp_m: float | None = None
    sight: LineOfSight | None = None
    precision: Precision = "f32"
    _arguments: _Arguments = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_arguments", _Arguments.of(self))

    @property
    def n_elements(self) -> int:
        """Number of (panel, section) pairs."""
        return len(self.frames) * self.grid.n_sections

    @property
    def targets_enu_m(self) -> NDArray[np.float64]:
        """Where lines of sight end, shape (m, 3): just in front of each centroid."""
        return self.frames.centroids + OCCLUSION_OFFSET_M * self.frames.normals

    def of_sharp_views(self) -> CoverageModel:
        """The model in which views that are not sharp cover nothing; this one where they are all sharp."""
        limits = [limit for limit in (self.sharp_m, self.max_distance_m) if limit is not None]
        if min(limits, default=None) == self.max_distance_m:
            return self
        return replace(self, max_distance_m=min(limits))

    def covered_count(self, views: ViewpointArrays) -> int:
        """Number of elements that at least one view covers: the paper's fitness E (Eq. 10)."""
        return int(np.count_nonzero(self.covered(views)))

    def covered(self, views: ViewpointArrays) -> NDArray[np.bool_]:
        """Whether at least one view covers each element, shape (n_elements,)."""
        if self.whole_panel or self.sight is not None:
            hit = np.zeros(self.n_elements, np.bool_)
            hit[self.elements(views).items] = True
            return hit
        arguments = self._arguments
        packed = arguments.pack(views)
        hits = np.zeros((len(self.frames), self.grid.n_sections + 1), np.uint8)
        _mark_covered(*arguments.call(packed, hits))
        return hits[:, 1:].reshape(-1).view(np.bool_)

    def elements(self, views: ViewpointArrays) -> Elements:
        """Elements that each view covers, on all cores; the result does not depend on their number."""
        n, m = len(views.positions_enu_m), len(self.frames)
        arguments = self._arguments
        packed = arguments.pack(views)

        def work(start: int, stop: int) -> Elements:
            codes = np.empty((m, stop - start), np.int32)
            _fill_codes(*arguments.call(np.ascontiguousarray(packed[:, start:stop]), codes))
            counts = np.zeros(stop - start, np.int64)
            _elements_per_view(codes, counts)
            starts = np.concatenate([[0], np.cumsum(counts)])
            items = np.empty(starts[-1], np.int32)
            _gather_elements(codes, self.grid.n_sections, starts[:-1].copy(), items)
            return self._with_effects(_rows(views, start, stop), Elements(starts, items))

        size = max(1, min(VIEWS_PER_CHUNK, PAIRS_PER_CHUNK // max(m, 1)))
        parts = run_chunks(work, chunks(n, size))
        counts = [np.diff(part.starts) for part in parts]
        starts = np.concatenate([[0], np.cumsum(np.concatenate(counts))]) if parts else np.zeros(1, np.int64)
        items = np.concatenate([part.items for part in parts]) if parts else np.zeros(0, np.int32)
        return Elements(starts.astype(np.int64), items)

    def _with_effects(self, views: ViewpointArrays, found: Elements) -> Elements:
        """Drop elements that are only partly in the picture or hidden, where that counts."""
        if not self.whole_panel and self.sight is None:
            return found
        view = np.repeat(np.arange(len(found.starts) - 1), np.diff(found.starts))
        panel = found.items // self.grid.n_sections
        kept = np.ones(len(view), np.bool_)
        if self.whole_panel:
            kept &= _corners_in_picture(views, self.frames.corners, self.camera, view, panel)
        if self.sight is not None:
            to_check = np.flatnonzero(kept)
            kept[to_check] = self.sight(views.positions_enu_m[view[to_check]], self.targets_enu_m[panel[to_check]])
        counts = np.bincount(view[kept], minlength=len(found.starts) - 1)
        return Elements(np.concatenate([[0], np.cumsum(counts)]).astype(np.int64), found.items[kept])


def codes_all_around(model: CoverageModel, points_enu_m: NDArray[np.float64]) -> NDArray[np.int32]:
    """Section + 1 of each panel's hemisphere in which points lie, whatever a camera looks at: shape (m, n), 0 for none.

    Points, shape (n, 3), further away than the largest distance count as none; occlusion is not looked at.
    """
    arguments = model._arguments
    packed = np.zeros((N_VIEW_ROWS, len(points_enu_m)), arguments.dtype)
    packed[:3] = (points_enu_m - arguments.centre).T
    codes = np.empty((len(model.frames), len(points_enu_m)), np.int32)
    _fill_codes(*arguments.call(packed, codes))
    return codes


EXACT_PAIRS_AT_ONCE = 100_000
"""Of views and panels, for each thread: some 50 MB."""


def exact_sections(model: CoverageModel, views: ViewpointArrays) -> NDArray[np.int64]:
    """Section of each panel that each view covers, by the definition in float64: shape (n, m), -1 for none.

    Slow; this is what is written into plans and what the fast kernel is tested against.
    """
    n, m = len(views.positions_enu_m), len(model.frames)
    section = np.full((n, m), NOT_SEEN, np.int64)

    def fill(start: int, stop: int) -> None:
        part = _rows(views, start, stop)
        section[start:stop] = sections_seen(
            part, model.frames, model.camera, model.grid, model.whole_panel, model.max_distance_m
        )

    run_chunks(fill, chunks(n, max(1, EXACT_PAIRS_AT_ONCE // max(m, 1))))
    if model.sight is not None:
        view, panel = np.nonzero(section != NOT_SEEN)
        free = model.sight(views.positions_enu_m[view], model.targets_enu_m[panel])
        section[view[~free], panel[~free]] = NOT_SEEN
    return section


def exact_coverage(model: CoverageModel, views: ViewpointArrays) -> NDArray[np.int64]:
    """Number of views that cover each element by the definition in float64, shape (m, n_sections)."""
    section = exact_sections(model, views)
    view, panel = np.nonzero(section != NOT_SEEN)
    counts = np.zeros((len(model.frames), model.grid.n_sections), np.int64)
    np.add.at(counts, (panel, section[view, panel]), 1)
    return counts


class _Arguments(NamedTuple):
    """Arrays as the kernel wants them, relative to the panels' centre."""

    centre: NDArray[np.float64]
    dtype: type[np.floating[Any]]
    panels: NDArray[Any]
    limits: NDArray[Any]
    cos2: tuple[Any, ...]
    tangents: tuple[Any, ...]
    further: NDArray[Any]
    n_rings: int

    @classmethod
    def of(cls, model: CoverageModel) -> _Arguments:
        dtype: type[np.floating[Any]] = np.float32 if model.precision == "f32" else np.float64
        frames = model.frames
        centre = frames.centroids.mean(axis=0)
        panels = np.concatenate(
            [frames.centroids - centre, frames.normals, frames.tangents, frames.bitangents], axis=1
        ).astype(dtype)
        farthest = np.inf if model.max_distance_m is None else model.max_distance_m**2
        limits = np.array(
            [model.camera.half_width, model.camera.half_height, farthest, 0.0, np.finfo(dtype).tiny], dtype
        )
        borders = np.radians(model.grid.step_deg * np.arange(1, model.grid.n_rings))
        narrow, wide = WIDTHS
        width = narrow if len(borders) <= narrow else wide
        n_further = -(-max(0, len(borders) - width) // wide)
        # Borders that no direction crosses fill the last pass up.
        cos2 = np.full(width + n_further * wide, -1.0)
        tangents = np.full(width + n_further * wide, np.inf)
        cos2[: len(borders)], tangents[: len(borders)] = np.cos(borders) ** 2, np.tan(borders)
        cos2, tangents = cos2.astype(dtype), tangents.astype(dtype)
        further = np.stack([cos2[width:], tangents[width:]]).reshape(2, n_further, wide)
        return cls(
            centre, dtype, panels, limits, tuple(cos2[:width]), tuple(tangents[:width]), further, model.grid.n_rings
        )

    def call(self, packed: NDArray[Any], output: NDArray[Any]) -> tuple[Any, ...]:
        """Arguments of a kernel."""
        return self.panels, packed, self.limits, self.cos2, self.tangents, self.further, self.n_rings, output

    def pack(self, views: ViewpointArrays) -> NDArray[Any]:
        """Views as 11 rows: position, forward, right (x, y), up."""
        forward, right, up = camera_axes(views.heading_rad, views.pitch_rad)
        columns = [views.positions_enu_m - self.centre, forward, right[:, :2], up]
        return np.ascontiguousarray(np.concatenate(columns, axis=1).T.astype(self.dtype))


def _rows(views: ViewpointArrays, start: int, stop: int) -> ViewpointArrays:
    return ViewpointArrays(
        views.positions_enu_m[start:stop], views.heading_rad[start:stop], views.pitch_rad[start:stop]
    )


def _corners_in_picture(
    views: ViewpointArrays,
    corners: NDArray[np.float64],
    camera: Camera,
    view: NDArray[np.int64],
    panel: NDArray[np.int32],
) -> NDArray[np.bool_]:
    """Whether all four corners lie in the picture, for pairs of view and panel of shape (k,)."""
    forward, right, up = (axis[view][:, None, :] for axis in camera_axes(views.heading_rad, views.pitch_rad))
    v = corners[panel] - views.positions_enu_m[view][:, None, :]
    depth = (v * forward).sum(axis=2)
    inside = (
        (depth > 0.0)
        & (np.abs((v * right).sum(axis=2)) <= camera.half_width * depth)
        & (np.abs((v * up).sum(axis=2)) <= camera.half_height * depth)
    )
    return np.asarray(inside.all(axis=1))


def element_weights(model: CoverageModel, by_solid_angle: bool) -> NDArray[np.float64]:
    """Weight of each element: 1, or its section's solid angle relative to the mean."""
    if not by_solid_angle:
        return np.ones(model.n_elements)
    solid_angles = model.grid.solid_angles_sr()
    return np.tile(solid_angles / solid_angles.mean(), len(model.frames))


__all__ = [
    "CoverageModel",
    "Elements",
    "LineOfSight",
    "element_weights",
    "exact_coverage",
    "exact_sections",
    "in_picture",
    "sections_of",
]

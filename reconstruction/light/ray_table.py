"""Cameras and panels as tensors: rays through any places of any pixels are made from them when they are needed."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from planning.base.jit import kernel
from reconstruction.base.cameras import PosedPhoto
from reconstruction.light.photo_set import PanelPlanes

# Rays of pixels met with the planes of panels, and mirrored by panes that lean a little, compiled, one ray at a time.
#
# As `RayTable.meet` and `GlassLight.mirrored` have them in plain torch, which takes five times as long for a few
# thousand
# rays.

Array = NDArray[np.float64]
Single = NDArray[np.float32]
Index = NDArray[np.int64]
Flags = NDArray[np.bool_]
Number = np.float32

ONE, TWO, NONE = np.float32(1.0), np.float32(2.0), np.float32(0.0)

SHORTEST = np.float32(1e-12)
"""Of a normal before it is made unit."""


@kernel
def undistorted(x: float, y: float, distortion: Array, n_steps: int) -> tuple[float, float]:
    """Place in a straight picture of one in the photo, in focal lengths, by a fixed-point iteration."""
    k1, k2, p1, p2, k3 = distortion
    u, v = x, y
    for _ in range(n_steps):
        r2 = u * u + v * v
        radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
        u, v = (
            (x - 2.0 * p1 * u * v - p2 * (r2 + 2.0 * u * u)) / radial,
            (y - p1 * (r2 + 2.0 * v * v) - 2.0 * p2 * u * v) / radial,
        )
    return u, v


@kernel
def meet(
    photos: Index, places: Array, panels: Index, positions: Array, turns: Array, lenses: Array, distortions: Array,
    corners: Array, normals: Array, n_steps: int, least: float,
    points: Array, directions: Array, cosines: Array, shares: Array, distances: Array,
) -> None:  # fmt: skip
    """Write the fields of `PaneHits`; the other arguments are those of `RayTable.meet`, and fields of the table.

    Parameters
    ----------
    n_steps
        Of the iteration that takes distortion away; 0 where pictures are straight.
    least
        Cosine that distances are worked out with at least.
    """
    for ray in range(len(photos)):
        photo, panel = photos[ray], panels[ray]
        x, y = (
            (places[ray, 0] - lenses[photo, 2]) / lenses[photo, 0],
            (places[ray, 1] - lenses[photo, 3]) / lenses[photo, 1],
        )
        if n_steps > 0:
            x, y = undistorted(x, y, distortions[photo], n_steps)
        turn = turns[photo]
        dx = turn[0, 0] * x + turn[0, 1] * y + turn[0, 2]
        dy = turn[1, 0] * x + turn[1, 1] * y + turn[1, 2]
        dz = turn[2, 0] * x + turn[2, 1] * y + turn[2, 2]
        length = math.sqrt(dx * dx + dy * dy + dz * dz)
        dx, dy, dz = dx / length, dy / length, dz / length
        ox, oy, oz = positions[photo, 0], positions[photo, 1], positions[photo, 2]
        nx, ny, nz = normals[panel, 0], normals[panel, 1], normals[panel, 2]
        corner = corners[panel]
        cosine = -(dx * nx + dy * ny + dz * nz)
        height = (ox - corner[0, 0]) * nx + (oy - corner[0, 1]) * ny + (oz - corner[0, 2]) * nz
        distance = height / max(cosine, least)
        px, py, pz = ox + distance * dx, oy + distance * dy, oz + distance * dz
        points[ray, 0], points[ray, 1], points[ray, 2] = px, py, pz
        directions[ray, 0], directions[ray, 1], directions[ray, 2] = dx, dy, dz
        cosines[ray], distances[ray] = cosine, distance
        for number in range(2):
            end = corner[1 + 2 * number]
            ex, ey, ez = end[0] - corner[0, 0], end[1] - corner[0, 1], end[2] - corner[0, 2]
            along = ex * (px - corner[0, 0]) + ey * (py - corner[0, 1]) + ez * (pz - corner[0, 2])
            shares[ray, number] = along / max(ex * ex + ey * ey + ez * ez, 1e-20)


@kernel
def lie_inside(
    photos: Index, places: Array, panels: Index, around: Array, positions: Array, turns: Array, lenses: Array,
    distortions: Array, corners: Array, normals: Array, n_steps: int, least: float, found: Flags,
) -> None:  # fmt: skip
    """Whether rays through all places around each of some meet the fronts of their panels inside their edges, written.

    Parameters
    ----------
    around
        Off each place, pixels, shape (k, 2).
    found
        Shape (n,).
    """
    for ray in range(len(photos)):
        photo, panel = photos[ray], panels[ray]
        turn, corner = turns[photo], corners[panel]
        ox, oy, oz = positions[photo, 0], positions[photo, 1], positions[photo, 2]
        nx, ny, nz = normals[panel, 0], normals[panel, 1], normals[panel, 2]
        height = (ox - corner[0, 0]) * nx + (oy - corner[0, 1]) * ny + (oz - corner[0, 2]) * nz
        is_inside = True
        for number in range(len(around)):
            x = (places[ray, 0] + around[number, 0] - lenses[photo, 2]) / lenses[photo, 0]
            y = (places[ray, 1] + around[number, 1] - lenses[photo, 3]) / lenses[photo, 1]
            if n_steps > 0:
                x, y = undistorted(x, y, distortions[photo], n_steps)
            dx = turn[0, 0] * x + turn[0, 1] * y + turn[0, 2]
            dy = turn[1, 0] * x + turn[1, 1] * y + turn[1, 2]
            dz = turn[2, 0] * x + turn[2, 1] * y + turn[2, 2]
            length = math.sqrt(dx * dx + dy * dy + dz * dz)
            cosine = -(dx * nx + dy * ny + dz * nz) / length
            if not cosine > least:
                is_inside = False
                break
            distance = height / cosine / length
            px, py, pz = ox + distance * dx, oy + distance * dy, oz + distance * dz
            for first in range(4):
                a, b = corner[first], corner[(first + 1) % 4]
                ex, ey, ez = b[0] - a[0], b[1] - a[1], b[2] - a[2]
                fx, fy, fz = px - a[0], py - a[1], pz - a[2]
                left = (ey * fz - ez * fy) * nx + (ez * fx - ex * fz) * ny + (ex * fy - ey * fx) * nz
                is_inside = is_inside and left >= 0.0
            if not is_inside:
                break
        found[ray] = is_inside


@kernel
def tilted_normal(
    panel: int, normals: Single, edges: Single, tilts: Single, bows: Single, a: Number, b: Number
) -> tuple[Number, Number, Number]:
    """Normal of a pane, not yet unit, at a place that is `a` and `b` off its middle, -1 to 1."""
    s, t = tilts[panel, 0] + bows[panel, 0] * a, tilts[panel, 1] + bows[panel, 1] * b
    e, f = edges[panel, 0], edges[panel, 1]
    return (
        normals[panel, 0] + s * e[0] + t * f[0],
        normals[panel, 1] + s * e[1] + t * f[1],
        normals[panel, 2] + s * e[2] + t * f[2],
    )


@kernel
def off_middle(share: float) -> Number:
    """-1 to 1, of a share along an edge, which is 0 to 1 within a pane."""
    return np.float32(2.0 * min(max(share, 0.0), 1.0) - 1.0)


@kernel
def mirror(
    directions: Array, shares: Array, panels: Index, normals: Single, edges: Single, tilts: Single, bows: Single,
    omega_r: Single, cosines: Single,
) -> None:  # fmt: skip
    """Where rays are mirrored to, and cosines of their angles of incidence.

    Parameters
    ----------
    directions, shares
        Of `PaneHits`.
    panels
        Shape (n,).
    normals, edges
        Unit normals, shape (m, 3), and unit vectors along the lower edges and up from them, shape (m, 2, 3).
    tilts, bows
        How far normals lean along the edges, and how much further at their ends, radians, shape (m, 2).
    omega_r, cosines
        Shapes (n, 3) and (n,), written.
    """
    for ray in range(len(panels)):
        a, b = off_middle(shares[ray, 0]), off_middle(shares[ray, 1])
        nx, ny, nz = tilted_normal(panels[ray], normals, edges, tilts, bows, a, b)
        length = max(np.float32(math.sqrt(nx * nx + ny * ny + nz * nz)), SHORTEST)
        nx, ny, nz = nx / length, ny / length, nz / length
        dx, dy, dz = np.float32(directions[ray, 0]), np.float32(directions[ray, 1]), np.float32(directions[ray, 2])
        along = dx * nx + dy * ny + dz * nz
        omega_r[ray, 0], omega_r[ray, 1] = dx - TWO * along * nx, dy - TWO * along * ny
        omega_r[ray, 2] = dz - TWO * along * nz
        cosines[ray] = min(abs(along), ONE)


@kernel
def mirror_back(
    directions: Array, shares: Array, panels: Index, normals: Single, edges: Single, tilts: Single, bows: Single,
    by_omega_r: Single, by_cosines: Single, by_tilts: Array, by_bows: Array,
) -> None:  # fmt: skip
    """Gradients by tilts and bows, added to float64 arrays of shape (m, 2); arguments as those of `mirror`."""
    for ray in range(len(panels)):
        panel = panels[ray]
        a, b = off_middle(shares[ray, 0]), off_middle(shares[ray, 1])
        nx, ny, nz = tilted_normal(panel, normals, edges, tilts, bows, a, b)
        length = max(np.float32(math.sqrt(nx * nx + ny * ny + nz * nz)), SHORTEST)
        nx, ny, nz = nx / length, ny / length, nz / length
        dx, dy, dz = np.float32(directions[ray, 0]), np.float32(directions[ray, 1]), np.float32(directions[ray, 2])
        along = dx * nx + dy * ny + dz * nz
        gx, gy, gz = by_omega_r[ray, 0], by_omega_r[ray, 1], by_omega_r[ray, 2]
        # Of omega_r = d - 2 (d . n) n and |d . n|, by the unit normal, then by the one before it was made unit.
        by_along = -TWO * (gx * nx + gy * ny + gz * nz)
        if abs(along) <= ONE:
            by_along += by_cosines[ray] * (ONE if along > NONE else (-ONE if along < NONE else NONE))
        hx, hy, hz = (
            by_along * dx - TWO * along * gx,
            by_along * dy - TWO * along * gy,
            by_along * dz - TWO * along * gz,
        )
        out = hx * nx + hy * ny + hz * nz
        hx, hy, hz = (hx - out * nx) / length, (hy - out * ny) / length, (hz - out * nz) / length
        e, f = edges[panel, 0], edges[panel, 1]
        s, t = hx * e[0] + hy * e[1] + hz * e[2], hx * f[0] + hy * f[1] + hz * f[2]
        by_tilts[panel, 0] += s
        by_tilts[panel, 1] += t
        by_bows[panel, 0] += s * a
        by_bows[panel, 1] += t * b


LEAST_COSINE = 1e-3
"""Between a ray and its panel's normal: below, at 89.94 degrees, a pixel is as long as a hundred panels."""

UNDISTORT_STEPS = 12
"""Of the fixed-point iteration that takes Brown's distortion away: each leaves a fifth of the error at most."""


@dataclass(frozen=True, slots=True, eq=False)
class PaneHits:
    """Where n rays meet the planes of their panels.

    Parameters
    ----------
    points_m
        World places less the middle of all panels, shape (n, 3); meaningless where `cosines` is under `LEAST_COSINE`.
    directions
        Unit, ENU, from the camera, shape (n, 3).
    cosines
        Against the outward normals, shape (n,); negative where a panel is seen from behind.
    shares
        Along the lower edge and along the left one, 0 to 1 inside a panel, shape (n, 2).
    distances_m
        From the camera, shape (n,).
    """

    points_m: Tensor
    directions: Tensor
    cosines: Tensor
    shares: Tensor
    distances_m: Tensor


@dataclass(frozen=True, slots=True, eq=False)
class RayTable:
    """Of p photos and m panels, all float64; places are ENU less `middle_m`.

    Parameters
    ----------
    positions_m, enu_from_cam
        Of the cameras, shapes (p, 3) and (p, 3, 3).
    lenses
        fx, fy, cx, cy in pixels, then the picture's width and height, shape (p, 6).
    distortions
        Brown's k1, k2, p1, p2, k3, shape (p, 5).
    gains
        Exposure of each photo on top of that of all photos, shape (p,).
    corners_m
        Of the panels, shape (m, 4, 3).
    normals
        Outward, unit, shape (m, 3).
    middle_m
        Of the smallest box around all corners, ENU, shape (3,).
    half_side_m
        Of the cube that places are rescaled by, shape ().
    """

    positions_m: Tensor
    enu_from_cam: Tensor
    lenses: Tensor
    distortions: Tensor
    gains: Tensor
    corners_m: Tensor
    normals: Tensor
    middle_m: Tensor
    half_side_m: Tensor

    @staticmethod
    def of(photos: Sequence[PosedPhoto], planes: PanelPlanes, gains: Mapping[str, float]) -> RayTable:
        """Of photos in this order; `gains` by name, 1 where there is none."""
        lenses = [photo.intrinsics for photo in photos]
        rows = [(lens.fx_px, lens.fy_px, lens.cx_px, lens.cy_px, lens.width_px, lens.height_px) for lens in lenses]
        positions = np.array([photo.pose.position_enu_m for photo in photos]).reshape(-1, 3)
        turns = np.array([photo.pose.cam_from_enu.T for photo in photos]).reshape(-1, 3, 3)
        return RayTable(
            torch.from_numpy(positions - planes.middle_enu_m),
            torch.from_numpy(turns),
            torch.tensor(rows, dtype=torch.float64).reshape(-1, 6),
            torch.tensor([lens.distortion for lens in lenses], dtype=torch.float64).reshape(-1, 5),
            torch.tensor([gains.get(photo.name, 1.0) for photo in photos], dtype=torch.float64),
            torch.from_numpy(planes.corners_enu_m - planes.middle_enu_m),
            torch.from_numpy(planes.normals_enu),
            torch.from_numpy(planes.middle_enu_m),
            torch.tensor(planes.half_side_m, dtype=torch.float64),
        )

    def to(self, device: torch.device | str) -> RayTable:
        """The same on another device."""
        return RayTable(*(getattr(self, field.name).to(device) for field in fields(self)))

    def meet(self, photos: Tensor, places_px: Tensor, panels: Tensor, moves: Tensor | None = None) -> PaneHits:
        """Rays through places in pictures, met with the planes of panels.

        Parameters
        ----------
        photos, panels
            Numbers, shape (n,), integer.
        places_px
            Continuous pixel coordinates, shape (n, 2).
        moves
            Corrections of each photo's pose, shape (p, 6): metres along ENU, and a small rotation vector, radians,
            ENU; gradients flow through.
        """
        if moves is None and not places_px.requires_grad and places_px.device.type == "cpu":
            return self._hits(photos, places_px, panels)
        lenses = self.lenses[photos]
        bent = (places_px - lenses[:, 2:4]) / lenses[:, :2]
        x, y = self._unbent(bent[:, 0], bent[:, 1], photos).unbind(dim=1)
        turns = self.enu_from_cam[photos]
        directions = turns[:, :, 0] * x[:, None] + turns[:, :, 1] * y[:, None] + turns[:, :, 2]
        directions = directions / directions.norm(dim=1, keepdim=True)
        origins = self.positions_m[photos]
        if moves is not None:
            moved = moves.to(directions.dtype)[photos]
            origins = origins + moved[:, :3]
            directions = directions + torch.linalg.cross(moved[:, 3:], directions)
            directions = directions / directions.norm(dim=1, keepdim=True)
        normals, corners = self.normals[panels], self.corners_m[panels]
        cosines = -(directions * normals).sum(dim=1)
        heights = ((origins - corners[:, 0]) * normals).sum(dim=1)
        distances = heights / cosines.clamp(min=LEAST_COSINE)
        points = origins + distances[:, None] * directions
        return PaneHits(points, directions, cosines, _shares(points, corners), distances)

    def _hits(self, photos: Tensor, places_px: Tensor, panels: Tensor) -> PaneHits:
        """The same without corrections, on a processor."""
        n = len(photos)
        found = tuple(np.empty((n, *shape)) for shape in ((3,), (3,), (), (2,), ()))
        parts = self.positions_m, self.enu_from_cam, self.lenses, self.distortions, self.corners_m, self.normals
        run: Any = meet
        run(
            photos.long().numpy(), places_px.double().contiguous().numpy(), panels.long().numpy(),
            *(np.ascontiguousarray(part.numpy()) for part in parts),
            UNDISTORT_STEPS if bool(self.distortions.any()) else 0, LEAST_COSINE, *found,
        )  # fmt: skip
        return PaneHits(*(torch.from_numpy(part) for part in found))

    def arriving(self, points_m: Tensor, directions: Tensor, panels: Tensor) -> PaneHits:
        """Rays that come from no camera, but arrive at places of panels from infinitely far away.

        Parameters
        ----------
        points_m
            ENU less `middle_m`, shape (n, 3), float64.
        directions
            Of the rays, unit, shape (n, 3), float64.
        """
        cosines = -(directions * self.normals[panels]).sum(dim=1)
        shares = _shares(points_m, self.corners_m[panels])
        return PaneHits(points_m, directions, cosines, shares, torch.full_like(cosines, torch.inf))

    def holds(self, photos: Tensor, places_px: Tensor, panels: Tensor, around_px: Array) -> Tensor:
        """Whether rays meet the fronts of their panels, which are convex, inside their edges, shape (n,), bool.

        On a processor.

        Parameters
        ----------
        photos, places_px, panels
            As for `meet`.
        around_px
            Off each place, shape (k, 2): all of its rays have to.
        """
        found = np.empty(len(photos), np.bool_)
        parts = self.positions_m, self.enu_from_cam, self.lenses, self.distortions, self.corners_m, self.normals
        run: Any = lie_inside
        run(
            photos.long().numpy(), places_px.double().contiguous().numpy(), panels.long().numpy(), around_px,
            *(np.ascontiguousarray(part.numpy()) for part in parts),
            UNDISTORT_STEPS if bool(self.distortions.any()) else 0, LEAST_COSINE, found,
        )  # fmt: skip
        return torch.from_numpy(found)

    def off_axis(self, photos: Tensor, places_px: Tensor) -> Tensor:
        """Squared distance from the principal point, 1 in the corners of a picture around it, shape (n,)."""
        lenses = self.lenses[photos]
        off = places_px - lenses[:, 2:4]
        return (off * off).sum(dim=1) / (0.25 * (lenses[:, 4:] ** 2).sum(dim=1))

    def rescaled(self, points_m: Tensor) -> Tensor:
        """Places in the cube around all panels as -1 to 1."""
        return points_m / self.half_side_m

    def _unbent(self, x: Tensor, y: Tensor, photos: Tensor) -> Tensor:
        """Places in a straight picture, shape (n, 2), of those in the photo, in focal lengths (D. C. Brown, 1971)."""
        if not bool(self.distortions.any()):
            return torch.stack([x, y], dim=1)
        k1, k2, p1, p2, k3 = self.distortions[photos].unbind(dim=1)
        u, v = x, y
        for _ in range(UNDISTORT_STEPS):
            r2 = u * u + v * v
            radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
            u, v = (
                (x - 2.0 * p1 * u * v - p2 * (r2 + 2.0 * u * u)) / radial,
                (y - p1 * (r2 + 2.0 * v * v) - 2.0 * p2 * u * v) / radial,
            )
        return torch.stack([u, v], dim=1)


def _shares(points_m: Tensor, corners_m: Tensor) -> Tensor:
    """How far along the lower and the left edges places are, 0 to 1, shape (n, 2)."""
    offsets = points_m - corners_m[:, 0]
    edges = corners_m[:, [1, 3]] - corners_m[:, :1]
    lengths = (edges * edges).sum(dim=2).clamp(min=1e-20)
    return (edges * offsets[:, None]).sum(dim=2) / lengths

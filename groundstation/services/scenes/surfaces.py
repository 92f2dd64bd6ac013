"""What a site looks like from outside: the virtual scene's walls, street and neighbours as triangles with pictures."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from planning.base.messages import say
from planning.base.progress import QUIET, Monitor, Stop, Trace, never
from planning.site.records import SiteModel

if TYPE_CHECKING:
    from reconstruction.scenes.record import Body

Array = NDArray[np.float64]

GAMMA = 2.2
"""Of screens: brightness is the value to this power."""

GROUND_BESIDE_M = 12.0
"""Ground is drawn so far around what stands on it; a photo shows it for 1.5 km, which no view of a plan asks for."""

PLAIN = 0.12
"""Spread of a picture's brightness below which its mean is drawn instead: grain of asphalt and plaster is not seen from
where a plan is looked at, and a picture costs a processor that draws in place of a graphics card most of a frame."""


LEVEL_TRIANGLES = 2
"""Of level ground."""


class Part(StrEnum):
    """What a surface belongs to."""

    WALLS = "walls"
    SURROUNDINGS = "surroundings"
    PANES = "panes"


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """Triangles of one picture, or of a colour each.

    Parameters
    ----------
    corners_enu_m
        Shape (t, 3, 3).
    colours
        Red, green and blue of each triangle, shape (t, 3); they multiply the picture.
    uv
        Places in the picture, shape (t, 3, 2): 1 is its width or height, from its lower left corner. It repeats.
    picture
        Shape (h, w, 3), the first row uppermost; None for colours alone.
    """

    part: Part
    corners_enu_m: Array
    colours: NDArray[np.uint8]
    uv: NDArray[np.float32] | None = None
    picture: NDArray[np.uint8] | None = None


def site_surfaces(
    model: SiteModel, *, stop: Stop = never, trace: Trace | None = None, monitor: Monitor = QUIET
) -> tuple[Surface, ...]:
    """Walls and surroundings of a site's virtual scene, the same that its photos are rendered from.

    Panes are left out: what they show depends on from where one looks. So are the site's own obstacles, which a plan
    has to keep from and which stay in the colour that says so.

    Raises
    ------
    InputError
        The site has no panels.
    """
    from reconstruction.scenes.record import Layer
    from reconstruction.scenes.world.build import build_scene

    monitor.report(say("building the scene"), 0, 1)
    bodies = [body for body in build_scene(model).bodies if not body.name.startswith("obstacle-")]
    near = [(body, body.mesh.corners_enu_m) for body in bodies if body.layer is Layer.NEAR]
    standing = [corners for _, corners in near] or [model.building.corners_enu_m]
    low, high = _around(np.concatenate([corners.reshape(-1, 3) for corners in standing]))
    ground = [(body, _cut(body.mesh.corners_enu_m, low, high)) for body in bodies if body.layer is Layer.GROUND]
    walls = [(body, body.mesh.corners_enu_m) for body in bodies if body.name == "walls"]
    return (*_surfaces(Part.WALLS, walls), *_surfaces(Part.SURROUNDINGS, [*ground, *near]))


def _around(points_enu_m: Array) -> tuple[Array, Array]:
    """Corners, shape (2,), of the rectangle of ground that is drawn."""
    if not len(points_enu_m):
        return np.full(2, -GROUND_BESIDE_M), np.full(2, GROUND_BESIDE_M)
    return points_enu_m[:, :2].min(axis=0) - GROUND_BESIDE_M, points_enu_m[:, :2].max(axis=0) + GROUND_BESIDE_M


def _cut(corners_enu_m: Array, low: Array, high: Array) -> Array:
    """Ground inside a rectangle: of level ground a piece, of terrain the triangles whose middles are inside."""
    if len(corners_enu_m) <= LEVEL_TRIANGLES:
        found = corners_enu_m.copy()
        found[..., :2] = np.clip(found[..., :2], low, high)
        return found
    middles = corners_enu_m.mean(axis=1)[:, :2]
    return np.asarray(corners_enu_m[((middles >= low) & (middles <= high)).all(axis=1)])


def _surfaces(part: Part, bodies: Sequence[tuple[Body, Array]]) -> Iterator[Surface]:
    """All bodies without a picture in one, and each other one by itself."""
    plain: list[Array] = []
    colours: list[NDArray[np.uint8]] = []
    for body, corners in bodies:
        reflectance = np.array(body.albedo, np.float32)
        if body.texture is not None:
            reflectance = reflectance * body.texture.picture
        picture = on_screen(reflectance)
        if body.texture is None or picture.mean(axis=2).std() < PLAIN * 255.0:
            plain.append(corners)
            colours.append(np.tile(on_screen(reflectance.reshape(-1, 3).mean(axis=0)), (len(corners), 1)))
            continue
        height, width = picture.shape[:2]
        uv = _places_m(corners) * body.texture.px_per_m / np.array([width, height])
        # Counted from a whole picture near each triangle: float32 is too coarse for what is far from the origin.
        uv -= np.floor(uv.min(axis=1, keepdims=True))
        white = np.full((len(corners), 3), 255, np.uint8)
        yield Surface(part, corners, white, uv.astype(np.float32), picture)
    if plain:
        yield Surface(part, np.concatenate(plain), np.concatenate(colours))


def on_screen(reflectance: NDArray[np.floating]) -> NDArray[np.uint8]:
    """Bytes of a matt surface in full light, 0 to 1, as a screen shows them."""
    return np.asarray(np.rint(255.0 * np.clip(reflectance, 0.0, 1.0) ** (1.0 / GAMMA)), np.uint8)


def _places_m(corners_enu_m: Array) -> Array:
    """How far each corner lies to the right and upwards in its face, metres, shape (t, 3, 2)."""
    from reconstruction.scenes.light.geometry import texture_axes

    across = np.cross(corners_enu_m[:, 1] - corners_enu_m[:, 0], corners_enu_m[:, 2] - corners_enu_m[:, 0])
    lengths = np.linalg.norm(across, axis=1, keepdims=True)
    normals = np.divide(across, lengths, out=np.tile([0.0, 0.0, 1.0], (len(across), 1)), where=lengths > 0.0)
    rights, ups = texture_axes(normals)
    return np.stack(
        [np.einsum("tcx,tx->tc", corners_enu_m, rights), np.einsum("tcx,tx->tc", corners_enu_m, ups)], axis=2
    )

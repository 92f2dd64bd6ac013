"""Photographs by Mitsuba's path tracer: the physically based judge of the embedded renderer."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planning.base.effects import EffectSetting
from reconstruction.base.cameras import PosedPhoto
from reconstruction.scenes.light.geometry import PaneFrames, texture_axes
from reconstruction.scenes.light.pane_surfaces import half_sides_m
from reconstruction.scenes.light.shading import SkyLight, facade_middle_enu_m
from reconstruction.scenes.light.tracing import DUST_ALBEDO, Switches
from reconstruction.scenes.mitsuba.plugins import SheetRole, lens, mitsuba
from reconstruction.scenes.parameters import DISTORTION, INTERIOR, MOTION_BLUR, SUN_GLARE, RenderSettings
from reconstruction.scenes.photos.renderer import RenderedPhoto, Renderer, switches_of
from reconstruction.scenes.record import Body, Glass, Panes, Scene, Sky

Array = NDArray[np.float64]


# Scenes as Mitsuba 3 has them: the same surfaces, materials, light and units, for a physically based judge.
#
# Coordinates are those of the scene moved to the panes' middle, since Mitsuba computes in float32.

PARTS = 8
"""Quads along each side of a bowed pane; normals are interpolated between them."""

ROOM_DEPTH_M = 0.016
"""From a pane in one surface to what sends its room's light; behind double panes their second sheet does."""

SIDES_IN = 1e-3
"""Of the way to a pane's middle."""

NO_LIGHT: dict[str, Any] = {"type": "rgb", "value": 0.0}
BLACK: dict[str, Any] = {"type": "diffuse", "reflectance": NO_LIGHT}

RAY_START = 2e-4
"""Of the largest coordinate: twice as far as Mitsuba's rays start from a surface, so that they meet one this close."""

CLEAR_ROWS = 513
"""Of the picture of a clear sky, from zenith to nadir."""

DEPTH = 16
"""Most meetings of a path: three for each double pane that mirrors."""

SURE_DEPTH = 9
"""Meetings from which on paths end at random, the fainter the sooner."""


def mitsuba_scene(mi: Any, scene: Scene, switches: Switches) -> Any:
    """The scene for Mitsuba's path tracer.

    Of the switches `fresnel`, `tilt`, `curvature` and `doubling` count. Near field, second bounce, shadow and occlusion
    are what a path tracer cannot leave out; each room is one mean light, and the sun's disc is not seen.
    """
    middle = middle_enu_m(scene)
    content: dict[str, Any] = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": DEPTH, "rr_depth": SURE_DEPTH},
    }
    content |= _sky(mi, scene.sky) | _sun(scene.sky) or {"dark": {"type": "constant", "radiance": NO_LIGHT}}
    for number, group in enumerate(_alike(scene.bodies)):
        content[f"bodies-{number}"] = _bodies(mi, group, middle)
    content |= _panes(mi, scene, switches, middle)
    return mi.load_dict(content)


def middle_enu_m(scene: Scene) -> Array:
    """What lies at Mitsuba's origin, shape (3,)."""
    return facade_middle_enu_m(scene) if len(scene.panes.corners_enu_m) else np.zeros(3)


def _sky(mi: Any, sky: Sky) -> dict[str, Any]:
    """Mitsuba's rows are at its picture's edges and its columns at pixels' middles; ours are both at middles.

    Twice as many rows, less one at the edges, have ours among them: in between both are linear, so nothing is lost.
    """
    height, width = (CLEAR_ROWS, 4) if sky.panorama is None else (2 * len(sky.panorama) + 1, sky.panorama.shape[1])
    elevation = math.pi * (0.5 - np.arange(height) / (height - 1))
    heading = 2.0 * math.pi * (np.arange(width) + 0.5) / width
    elevation, heading = (a.ravel() for a in np.meshgrid(elevation, heading, indexing="ij"))
    level = np.cos(elevation)
    directions = np.column_stack([level * np.sin(heading), level * np.cos(heading), np.sin(elevation)])
    picture = SkyLight(sky).light_from(directions).reshape(height, width, 3).astype(np.float32)
    if not picture.any():
        return {}
    # Its axes are east, up, south.
    to_world = mi.ScalarTransform4f().rotate([1, 0, 0], 90)
    return {"sky": {"type": "envmap", "bitmap": mi.Bitmap(picture), "to_world": to_world}}


def _sun(sky: Sky) -> dict[str, Any]:
    """White matt surfaces send back 1 / pi of the light that falls on them, from each direction: our unit."""
    towards = sky.sun_direction_enu
    if towards[2] <= 0.0 or not any(sky.sun):
        return {}
    irradiance = {"type": "rgb", "value": [math.pi * part for part in sky.sun]}
    return {"sun": {"type": "directional", "direction": (-towards).tolist(), "irradiance": irradiance}}


def _alike(bodies: tuple[Body, ...]) -> list[list[Body]]:
    """Bodies of one material together."""
    groups: dict[tuple[Any, int], list[Body]] = {}
    for body in bodies:
        if len(body.mesh.triangles):
            groups.setdefault((body.albedo, id(body.texture)), []).append(body)
    return list(groups.values())


def _bodies(mi: Any, bodies: list[Body], middle: Array) -> Any:
    corners = np.concatenate([body.mesh.corners_enu_m for body in bodies])
    albedo, texture = np.array(bodies[0].albedo), bodies[0].texture
    places = None
    if texture is None:
        reflectance = {"type": "rgb", "value": albedo.tolist()}
    else:
        height, width = texture.picture.shape[:2]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        lengths = np.linalg.norm(normals, axis=1, keepdims=True)
        rights, ups = texture_axes(np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0.0))
        u = np.einsum("tck,tk->tc", corners, rights) * texture.px_per_m / width
        v = -np.einsum("tck,tk->tc", corners, ups) * texture.px_per_m / height
        # Whole pictures are taken off: float32 is finest around 0.
        places = np.stack([a - np.floor(a.min(axis=1, keepdims=True)) for a in (u, v)], axis=-1).reshape(-1, 2)
        picture = np.ascontiguousarray(texture.picture * albedo, np.float32)
        reflectance = {"type": "bitmap", "bitmap": mi.Bitmap(picture), "raw": True, "wrap_mode": "repeat"}
    matt = {"type": "twosided", "matt": {"type": "diffuse", "reflectance": reflectance}}
    vertices = (corners - middle).reshape(-1, 3)
    return _mesh(mi, vertices, np.arange(len(vertices)).reshape(-1, 3), {"bsdf": matt}, places=places)


def _panes(mi: Any, scene: Scene, switches: Switches, middle: Array) -> dict[str, Any]:
    """Surfaces of all panes by their kind of glass, and the rooms behind."""
    content: dict[str, Any] = {}
    if not len(scene.panes.corners_enu_m):
        return content
    panes = replace(
        scene.panes,
        tilts_rad=switches.tilt * scene.panes.tilts_rad,
        bows_per_m=switches.curvature * scene.panes.bows_per_m,
    )
    for kind, glass in enumerate(scene.glasses):
        rows = np.flatnonzero(panes.glass == kind)
        if len(rows):
            content |= _of_glass(mi, f"panes-{kind}", glass, panes, rows, switches, middle)
    return content


def _of_glass(
    mi: Any, name: str, glass: Glass, panes: Panes, rows: NDArray[np.int64], switches: Switches, middle: Array
) -> dict[str, Any]:
    """Panes of one kind of glass: their first sheets, what is behind these, and the sides of the space between."""
    frames = PaneFrames.of(panes)
    front = _surfaces(panes, frames, rows)
    vertices = front.vertices - middle
    is_apart = glass.sheets == 2 and switches.doubling
    closest_m = RAY_START * (1.0 + float(np.abs(vertices).max()))
    depth_m = max(glass.gap_m if is_apart else ROOM_DEPTH_M, closest_m)
    first = SheetRole(glass, "front" if is_apart else "whole", switches.fresnel).plugin()
    if glass.dirt > 0.0:
        dust = {"type": "diffuse", "reflectance": {"type": "rgb", "value": DUST_ALBEDO}}
        first = {"type": "blendbsdf", "weight": glass.dirt, "clear": first, "dust": dust}
    behind = SheetRole(glass, "back", switches.fresnel).plugin() if is_apart else BLACK
    sides = _sides(panes.corners_enu_m[rows] - middle, frames.normals[rows], depth_m - float(front.heights_m.min()))
    room = {"emitter": _rooms_light(mi, panes.rooms[rows])}
    return {
        f"{name}-front": _mesh(mi, vertices, front.triangles, {"bsdf": first}, front.normals),
        f"{name}-back": _mesh(
            mi,
            vertices - depth_m * front.outwards,
            front.triangles,
            {"bsdf": behind, **room},
            front.normals,
            _which(len(rows), len(vertices)),
        ),
        f"{name}-sides": _mesh(
            mi,
            sides.reshape(-1, 3),
            (4 * np.arange(len(sides))[:, None, None] + np.array([[0, 1, 2], [0, 2, 3]])).reshape(-1, 3),
            {"bsdf": BLACK, **room},
            places=_which(len(rows), 4 * len(sides)),
        ),
    }


@dataclass(frozen=True, slots=True, eq=False)
class _Surfaces:
    """Of panes: vertices, their normals and those of the flat panes, shape (n, 3), how high above these, (n,)."""

    vertices: Array
    normals: Array
    outwards: Array
    heights_m: Array
    triangles: NDArray[np.int64]


def _surfaces(panes: Panes, frames: PaneFrames, rows: NDArray[np.int64]) -> _Surfaces:
    """Panes as `Panes` describes them."""
    steps = np.linspace(0.0, 1.0, PARTS + 1) if panes.bows_per_m[rows].any() else np.array([0.0, 1.0])
    across, along = (a.ravel() for a in np.meshgrid(steps, steps))
    weights = np.stack([(1 - across) * (1 - along), across * (1 - along), across * along, (1 - across) * along])
    points = np.einsum("cg,mck->mgk", weights, panes.corners_enu_m[rows])
    outwards = np.repeat(frames.normals[rows, None], len(across), axis=1)
    normals, heights = outwards, np.zeros(points.shape[:2])
    halves = half_sides_m(panes, frames)[rows]
    for axis, directions in enumerate((frames.rights[rows], frames.ups[rows])):
        away = np.einsum("mgk,mk->mg", points - frames.middles_enu_m[rows, None], directions)
        tilt, bow = panes.tilts_rad[rows, axis, None], panes.bows_per_m[rows, axis, None]
        heights += 0.5 * bow * (halves[:, axis, None] ** 2 - away**2) - tilt * away
        normals = normals + (tilt + bow * away)[..., None] * directions[:, None]
    normals = normals / np.linalg.norm(normals, axis=-1, keepdims=True)
    n, side = len(across), len(steps)
    first = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).ravel()
    quads = first[:, None] + np.array([0, 1, side + 1, side])
    one = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    triangles = (n * np.arange(len(rows))[:, None, None] + one).reshape(-1, 3)
    vertices = points + heights[..., None] * outwards
    vertices, normals, outwards = (array.reshape(-1, 3) for array in (vertices, normals, outwards))
    return _Surfaces(vertices, normals, outwards, heights.ravel(), triangles)


def _rooms_light(mi: Any, rooms: Array) -> dict[str, Any]:
    """What surfaces behind the glass send, each room's the same into all directions; `_which` says whose it is."""
    picture = mi.Bitmap(np.ascontiguousarray(rooms[None], np.float32))
    light = {"type": "bitmap", "bitmap": picture, "raw": True, "filter_type": "nearest"}
    # Rooms are found by paths that pass the glass, and by no others.
    return {"type": "area", "radiance": light, "sampling_weight": 0.0}


def _which(n_panes: int, n_vertices: int) -> Array:
    """Places of the panes' vertices in the rooms' picture, shape (n, 2)."""
    u = np.repeat((np.arange(n_panes) + 0.5) / n_panes, n_vertices // n_panes)
    return np.column_stack([u, np.full(len(u), 0.5)])


def _sides(corners: Array, normals: Array, depth_m: float) -> Array:
    """Quads around the space behind panes, facing in, shape (4 m, 4, 3): light that comes slantwise meets them.

    They stand a little in from the panes' edges, where those of neighbours stand.
    """
    middles = corners.mean(axis=1, keepdims=True)
    front = middles + (1.0 - SIDES_IN) * (corners - middles)
    back = front - depth_m * normals[:, None]
    sides = [np.stack([front[:, k], front[:, k - 3], back[:, k - 3], back[:, k]], axis=1) for k in range(4)]
    return np.stack(sides, axis=1).reshape(-1, 4, 3)


def _mesh(
    mi: Any,
    vertices: Array,
    triangles: NDArray[np.int64],
    parts: dict[str, Any],
    normals: Array | None = None,
    places: Array | None = None,
) -> Any:
    """A mesh with its material; `places` are in its texture."""
    props = mi.Properties()
    for key, part in parts.items():
        props[key] = mi.load_dict(part)
    mesh = mi.Mesh("", len(vertices), len(triangles), props, normals is not None, places is not None)
    params = mi.traverse(mesh)
    params["vertex_positions"] = np.ascontiguousarray(vertices, np.float32).ravel()
    params["faces"] = np.ascontiguousarray(triangles, np.uint32).ravel()
    if normals is not None:
        params["vertex_normals"] = np.ascontiguousarray(normals, np.float32).ravel()
    if places is not None:
        params["vertex_texcoords"] = np.ascontiguousarray(places, np.float32).ravel()
    params.update()
    return mesh


RAYS_AT_ONCE = 1 << 23
"""Half a gigabyte."""

LACKING = (INTERIOR, SUN_GLARE)
"""Effects whose light Mitsuba's scene has not: rooms in detail, and the sun's disc with its mirror images."""

SAMPLES = 4
"""Rays along a pixel's side of the embedded pictures that help."""


class MitsubaRenderer:
    """A scene that is photographed like by `Renderer`, with light by Mitsuba.

    What is true of each pixel, and the share of mirror images in its light, is the embedded renderer's. So is the light
    that Mitsuba's scene lacks (`LACKING`): what these effects change in the embedded picture is added.

    Parameters
    ----------
    n_rays
        Through each pixel, at random places of its area.
    variant
        Of Mitsuba; the fastest that works where it is None.

    Raises
    ------
    InputError
        Mitsuba is not installed, or as `Renderer` says.
    """

    def __init__(self, scene: Scene, settings: RenderSettings, n_rays: int, variant: str | None = None) -> None:
        if n_rays < 1:
            raise ValueError(f"n_rays: expected 1 or more, got {n_rays}")
        mi = mitsuba(variant)
        self._settings, self._n_rays, self._variant = settings, n_rays, mi.variant()
        self._embedded = Renderer(scene, replace(settings, samples=SAMPLES))
        self._without: Renderer | None = None
        if any(map(settings.is_on, LACKING)):
            off: dict[str, EffectSetting] = dict.fromkeys(LACKING, "off")
            self._without = Renderer(scene, replace(settings, samples=SAMPLES, effects={**settings.effects, **off}))
        self._middle = middle_enu_m(scene)
        self._scene = mitsuba_scene(mi, scene, switches_of(settings))

    def render(self, photo: PosedPhoto, seed: int = 0, moved_enu_m: Array | None = None) -> RenderedPhoto:
        """Take a photograph, as `Renderer` does; `seed` is that of Mitsuba's rays, too."""
        rendered = self._embedded.render(photo, seed, moved_enu_m)
        lacking = (
            0.0 if self._without is None else rendered.linear - self._without.render(photo, seed, moved_enu_m).linear
        )
        if not self._settings.is_on(DISTORTION):
            photo = replace(photo, intrinsics=photo.intrinsics.straight())
        moved = moved_enu_m if self._settings.is_on(MOTION_BLUR) else None
        linear = np.maximum(self._linear(photo, seed, moved) + lacking, np.float32(0.0))
        mirrored = np.divide(
            rendered.reflection, rendered.linear, out=np.zeros_like(linear), where=rendered.linear > 0.0
        )
        reflection = mirrored * linear
        return replace(rendered, linear=linear, diffuse=linear - reflection, reflection=reflection)

    def _linear(self, photo: PosedPhoto, seed: int, moved_enu_m: Array | None) -> NDArray[np.float32]:
        mi = mitsuba(self._variant)
        sensor = lens(mi, photo, self._middle, moved_enu_m)
        height, width = photo.intrinsics.height_px, photo.intrinsics.width_px
        total = np.zeros((height, width, 3))
        passes = -(-self._n_rays * height * width // RAYS_AT_ONCE)
        for number in range(passes):
            rays = self._n_rays // passes + (number < self._n_rays % passes)
            if rays:
                of_pass = int(np.random.SeedSequence([seed, number]).generate_state(1)[0])
                total += rays * np.asarray(mi.render(self._scene, sensor=sensor, spp=rays, seed=of_pass), np.float64)
        return np.asarray(total / self._n_rays, np.float32)


def renderer_of(scene: Scene, settings: RenderSettings) -> Renderer | MitsubaRenderer:
    """The one that the settings ask for."""
    if settings.mitsuba_rays is None:
        return Renderer(scene, settings)
    return MitsubaRenderer(scene, settings, settings.mitsuba_rays)

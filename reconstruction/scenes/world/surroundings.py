"""What stands around a site: ground, the buildings opposite, trees, cars and people."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from planning.coverage.sections import panel_frames
from planning.geo.mesh import TriangleMesh, box_mesh, extrude, from_corners, join
from planning.site.records import Obstacle, SiteModel, box_geometry, panel_triangles
from reconstruction.scenes.record import Body, Layer, Rgb, Texture
from reconstruction.scenes.world.ground import GROUND_HALF_M, SceneGround
from reconstruction.scenes.world.look import Look
from reconstruction.scenes.world.textures import grain, paving, windows

Array = NDArray[np.float64]


# The streets before a site's facades: in which directions they look, and what ground is free there.

UPRIGHT = 0.5
"""Horizontal length of a panel's unit normal from which it looks at the surroundings and not at the sky."""

HOME_CLEAR_M = 13.0
"""Around where the aircraft starts and may land: the usual distance from everything, and 3 m."""

WALL_CLEAR_M = 0.8
"""Around the building and its obstacles: room for a person."""

FRONT_M = 5.0
"""Trees and cars keep this far from facades."""

Keeps = Literal["streets", "fronts", "walls"]
"""What something leaves free: all streets, as a building does; the last metres before facades; or walls alone."""


@dataclass(frozen=True, slots=True, eq=False)
class Street:
    """What panels that look one way have before them.

    Places are given along the street (m to the right as seen from outside), across (m outwards) and above ground, from
    its foot.

    Parameters
    ----------
    foot_enu_m
        On the ground, shape (3,): along the street in the middle of the panels, across at the foremost of them.
    outward
        Unit vector, shape (2,).
    half_m
        Half the panels' extent along the street.
    """

    foot_enu_m: Array
    outward: Array
    half_m: float

    @property
    def right(self) -> Array:
        """Unit vector along the street, shape (2,)."""
        return np.array([-self.outward[1], self.outward[0]])

    def points_enu_m(self, along_across_up_m: Array) -> Array:
        """Places in ENU, shape (..., 3)."""
        axes = np.zeros((3, 3))
        axes[0, :2], axes[1, :2], axes[2, 2] = self.right, self.outward, 1.0
        return np.asarray(self.foot_enu_m + along_across_up_m @ axes)

    def rectangle(self, along_m: tuple[float, float], across_m: tuple[float, float]) -> Array:
        """Corners of a rectangle on the ground, shape (4, 2), counter-clockwise seen from above."""
        (a, b), (c, d) = along_m, across_m
        return self.points_enu_m(np.array([[b, c, 0.0], [b, d, 0.0], [a, d, 0.0], [a, c, 0.0]]))[:, :2][::-1]


def streets(model: SiteModel) -> tuple[Street, ...]:
    """One street for each facade, or for each quarter of the compass into which a strongly curved one looks.

    Panels that look upwards or downwards have none.
    """
    return tuple(_streets(model))


def _streets(model: SiteModel) -> Iterator[Street]:
    for facade in model.site.facades:
        if not facade.panels:
            continue
        panels = panel_frames(np.array([panel.corners_enu_m for panel in facade.panels], np.float64))
        upright = np.hypot(panels.normals[:, 0], panels.normals[:, 1]) >= UPRIGHT
        if not upright.any():
            continue
        corners, level = panels.corners[upright], panels.normals[upright, :2]
        mean = level.sum(axis=0)
        turn = np.arctan2(level[:, 1], level[:, 0]) - np.arctan2(mean[1], mean[0])
        quarter = np.round(turn / (0.5 * np.pi)).astype(int) % 4
        for number in np.unique(quarter):
            yield _street(corners[quarter == number], level[quarter == number], model.site.airspace.ground_z_m)


def _street(corners: Array, level: Array, ground_z_m: float) -> Street:
    outward = level.sum(axis=0)
    outward = outward / np.linalg.norm(outward)
    right = np.array([-outward[1], outward[0]])
    points = corners.reshape(-1, 3)[:, :2]
    along, across = points @ right, points @ outward
    foot = 0.5 * (along.min() + along.max()) * right + across.max() * outward
    return Street(np.array([*foot, ground_z_m]), outward, float(np.ptp(along)) / 2.0)


class FreeGround:
    """What ground is still free; every place taken is taken for those that ask later."""

    def __init__(self, model: SiteModel, sides: tuple[Street, ...], street_m: float) -> None:
        import shapely

        site = model.site
        homes = [site.home_enu_m, *(point.position_enu_m for point in site.rally_points)]
        built = shapely.union_all(
            [
                _footprint(model.building).buffer(WALL_CLEAR_M),
                *(_footprint(mesh).buffer(WALL_CLEAR_M) for mesh in model.obstacles),
                *(shapely.Point(home[:2]).buffer(HOME_CLEAR_M) for home in homes),
            ]
        )
        self._taken: list[Any] = []
        streets_and_walls, fronts_and_walls = (
            shapely.union_all([built, *(shapely.Polygon(_before(side, depth)) for side in sides)])
            for depth in (street_m - 0.01, FRONT_M)
        )
        self._kept: dict[Keeps, Any] = {
            "streets": streets_and_walls,
            "fronts": fronts_and_walls,
            "walls": built,
        }

    def take(self, outline_enu_m: Array, keeps: Keeps) -> bool:
        """Take ground with a convex outline, shape (k, 2); whether it was free."""
        import shapely

        outline = shapely.Polygon(outline_enu_m)
        if outline.intersects(self._kept[keeps]) or any(outline.intersects(other) for other in self._taken):
            return False
        self._taken.append(outline)
        return True


def _before(side: Street, depth_m: float) -> Array:
    return side.rectangle((-side.half_m - 1.0, side.half_m + 1.0), (-1.0, depth_m))


def _footprint(mesh: TriangleMesh) -> Any:
    import shapely

    triangles = shapely.polygons(mesh.corners_enu_m[:, :, :2]) if len(mesh.triangles) else np.zeros(0, object)
    return shapely.union_all(triangles[shapely.area(triangles) > 1e-6]) if len(triangles) else shapely.Polygon()


# Things of a street as meshes: houses, trees, cars and people, of boxes and bent spheres.


@dataclass(frozen=True, slots=True)
class Part:
    """A box about a thing's middle, metres: lengths along and across, and its bottom and top."""

    along: tuple[float, float]
    across: tuple[float, float]
    up: tuple[float, float]


CAR_PAINT = (Part((-2.2, 2.2), (-0.9, 0.9), (0.35, 0.85)), Part((-1.3, 1.0), (-0.8, 0.8), (1.35, 1.45)))
CAR_DARK = (
    Part((-1.3, 1.0), (-0.78, 0.78), (0.85, 1.35)),
    *(Part((x - 0.32, x + 0.32), (y - 0.1, y + 0.1), (0.0, 0.64)) for x in (-1.4, 1.4) for y in (-0.82, 0.82)),
)
PERSON_CLOTHES = (Part((-0.23, 0.23), (-0.14, 0.14), (0.8, 1.45)),)
PERSON_DARK = (Part((-0.16, 0.16), (-0.1, 0.1), (0.0, 0.8)),)
PERSON_SKIN = (Part((-0.1, 0.1), (-0.11, 0.11), (1.45, 1.72)),)


def boxes(street: Street, along_m: float, across_m: float, parts: tuple[Part, ...], size: float = 1.0) -> TriangleMesh:
    """Closed boxes at a place of a street, normals outwards."""
    meshes = []
    for part in parts:
        low, high = (np.array([pair[i] for pair in (part.along, part.across, part.up)]) * size for i in (0, 1))
        box = box_mesh(low, high)
        placed = street.points_enu_m(box.vertices_enu_m + np.array([along_m, across_m, 0.0]))
        # Along, outwards, up is left-handed: the triangles are turned over.
        meshes.append(TriangleMesh(placed, box.triangles[:, ::-1]))
    return join(meshes)


def walls(outline_enu_m: Array, bottom_m: float, top_m: float) -> TriangleMesh:
    """Upright walls over a convex outline, shape (k, 2), counter-clockwise seen from above; normals outwards."""
    following = np.roll(outline_enu_m, -1, axis=0)
    quads = np.stack(
        [
            np.insert(outline_enu_m, 2, bottom_m, axis=1),
            np.insert(following, 2, bottom_m, axis=1),
            np.insert(following, 2, top_m, axis=1),
            np.insert(outline_enu_m, 2, top_m, axis=1),
        ],
        axis=1,
    )
    return from_corners(panel_triangles(quads))


def flat(outline_enu_m: Array, height_m: float) -> TriangleMesh:
    """Level quad over an outline, shape (4, 2), counter-clockwise seen from above; it looks upwards."""
    return from_corners(panel_triangles(np.insert(outline_enu_m, 2, height_m, axis=1)[None]))


def crown(rng: np.random.Generator, middle_enu_m: Array, radius_m: float) -> TriangleMesh:
    """Crown of a tree: four dented spheres that overlap."""
    sphere = _sphere()
    meshes = []
    for _ in range(4):
        middle = middle_enu_m + rng.uniform(-0.5, 0.5, 3) * radius_m
        dents = rng.uniform(0.75, 1.1, (len(sphere.vertices_enu_m), 1)) * rng.uniform(0.6, 0.8) * radius_m
        meshes.append(TriangleMesh(middle + sphere.vertices_enu_m * dents, sphere.triangles))
    return join(meshes)


def _sphere() -> TriangleMesh:
    """Unit sphere of 128 triangles: an octahedron whose faces are divided twice; normals outwards."""
    signs = np.array([[x, y, z] for x in (1, -1) for y in (1, -1) for z in (1, -1)], float)
    corners = signs[:, :, None] * np.eye(3)
    # Mirrored an odd number of times, a face is turned over.
    corners = np.where((signs.prod(axis=1) < 0)[:, None, None], corners[:, ::-1], corners)
    for _ in range(2):
        middles = 0.5 * (corners + np.roll(corners, -1, axis=1))
        a, b, c = (corners[:, i] for i in range(3))
        ab, bc, ca = (middles[:, i] for i in range(3))
        corners = np.concatenate(
            [np.stack(part, axis=1) for part in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
        )
    points, triangles = np.unique(corners.reshape(-1, 3).round(9), axis=0, return_inverse=True)
    points = points / np.linalg.norm(points, axis=1, keepdims=True)
    return TriangleMesh(points, triangles.reshape(-1, 3).astype(np.int64))


PAVEMENT_M = 5.0
"""Width of the pavements on both sides of a street."""

BEYOND_M = 25.0
"""The row of buildings opposite goes on this far beyond the facade at both ends."""

RAISED_M = 0.02
"""Pavements and markings lie this far above what is below them."""

CAR_COLOURS: tuple[Rgb, ...] = (
    (0.75, 0.75, 0.76), (0.06, 0.06, 0.07), (0.45, 0.05, 0.05), (0.08, 0.16, 0.4), (0.4, 0.41, 0.42),
)  # fmt: skip
CLOTHES: tuple[Rgb, ...] = ((0.7, 0.1, 0.08), (0.1, 0.25, 0.6), (0.8, 0.75, 0.2), (0.15, 0.4, 0.2), (0.8, 0.8, 0.8))
DARK, SKIN, MARKING = (0.04, 0.04, 0.045), (0.5, 0.34, 0.26), (0.75, 0.75, 0.72)
WALL_COLOURS: tuple[Rgb, ...] = (
    (0.75, 0.7, 0.6), (0.55, 0.3, 0.2), (0.8, 0.8, 0.78), (0.45, 0.45, 0.44), (0.7, 0.6, 0.35), (0.5, 0.55, 0.6),
)  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False)
class Surroundings:
    """What stands around, and the site with the high ones among its obstacles."""

    model: SiteModel
    bodies: tuple[Body, ...]


def surround(model: SiteModel, look: Look, rng: np.random.Generator, below: SceneGround) -> Surroundings:
    """Ground below a site and a street before each of its facades; what stands on terrain stands at its height.

    Nothing meets the building, the site's own obstacles, home or rally points; a building that would stand in another
    facade's street is left out.
    """
    sides = streets(model)
    ground = FreeGround(model, sides, look.street_m)
    builder = _Builder(rng, look, ground, below)
    builder.lay_ground(model, sides)
    for side in sides:
        builder.put_buildings(side)
    for side in sides:
        builder.put_trees(side)
        builder.put_cars(side)
        builder.put_people(side)
    return Surroundings(_with_obstacles(model, builder.high), builder.bodies())


class _Builder:
    """Collects meshes by what they are made of, so that a scene has few bodies."""

    def __init__(self, rng: np.random.Generator, look: Look, ground: FreeGround, below: SceneGround) -> None:
        self._rng, self._look, self._ground, self._below = rng, look, ground, below
        self._meshes: dict[str, list[TriangleMesh]] = defaultdict(list)
        self._materials: dict[str, tuple[Layer, Rgb, Texture | None]] = {}
        self.high: list[tuple[str, TriangleMesh]] = []
        self._facings = [
            windows(rng, colour, rng.uniform(2.4, 4.2), rng.uniform(2.9, 3.8), tuple(rng.uniform(0.45, 0.8, 2)))
            for colour in WALL_COLOURS
        ]
        self._leaves = grain(rng, (0.13, 0.24, 0.07), 0.5, 60.0)

    def bodies(self) -> tuple[Body, ...]:
        """All that was built."""
        return tuple(
            Body(name, layer, join(self._meshes[name]), albedo, texture)
            for name, (layer, albedo, texture) in self._materials.items()
        )

    def _add(
        self, name: str, mesh: TriangleMesh, albedo: Rgb, texture: Texture | None = None, layer: Layer = Layer.NEAR
    ) -> None:
        self._materials.setdefault(name, (layer, albedo, texture))
        self._meshes[name].append(mesh)

    def lay_ground(self, model: SiteModel, sides: tuple[Street, ...]) -> None:
        """Asphalt all around, pavements and a dashed line along every street."""
        rng, width, white = self._rng, self._look.street_m, (1.0, 1.0, 1.0)
        points = np.array([corner for panel in model.site.panels for corner in panel.corners_enu_m])[:, :2]
        east, north = 0.5 * (points.min(axis=0) + points.max(axis=0))
        half = GROUND_HALF_M
        west, south, east, north = east - half, north - half, east + half, north + half
        square = np.array([[west, south], [east, south], [east, north], [west, north]])
        self._add("asphalt", self._below.mesh(square), white, grain(rng, (0.13, 0.13, 0.135), 0.25, 40.0), Layer.GROUND)
        slabs = paving(rng, (0.42, 0.4, 0.37))
        for side in sides:
            way = (-side.half_m - BEYOND_M, side.half_m + BEYOND_M)
            for across in ((0.0, PAVEMENT_M), (width - PAVEMENT_M, width)):
                strip = self._below.draped(side.rectangle(way, across), RAISED_M)
                self._add("pavement", strip, white, slabs, Layer.GROUND)
            for start in np.arange(way[0], way[1] - 3.0, 7.0):
                dash = side.rectangle((start, start + 3.0), (0.5 * width - 0.08, 0.5 * width + 0.08))
                self._add("markings", self._below.draped(dash, 2.0 * RAISED_M), MARKING, None, Layer.GROUND)

    def put_buildings(self, side: Street) -> None:
        """A row along the other side of a street."""
        rng, look = self._rng, self._look
        along, end = -side.half_m - BEYOND_M, side.half_m + BEYOND_M
        while along < end:
            width, depth = rng.uniform(9.0, 20.0), rng.uniform(10.0, 16.0)
            front, height = look.street_m + rng.uniform(0.0, 1.5), rng.uniform(*look.opposite_height_m)
            kind, shade = int(rng.integers(len(self._facings))), rng.uniform(0.75, 1.0)
            outline = side.rectangle((along, along + width), (front, front + depth))
            if self._ground.take(outline, "streets"):
                name = f"opposite-{len(self.high):02d}"
                foot, top = self._below.lowest_m(outline), self._below.highest_m(outline) + height
                self._add(name, walls(outline, foot, top), (shade, shade, shade), self._facings[kind])
                self._add("roofs", flat(outline, top), (0.35, 0.33, 0.32))
                self.high.append((name, extrude(outline, foot, top)))
            along += width + rng.choice([0.1, 0.1, rng.uniform(1.0, 6.0)])

    def _along(self, side: Street, spacing_m: float) -> Array:
        """Places along a street, about `spacing_m` apart."""
        if spacing_m <= 0.0:
            return np.zeros(0)
        start, end = -side.half_m - BEYOND_M, side.half_m + BEYOND_M
        places = np.arange(start + 0.5 * spacing_m, end, spacing_m)
        return np.asarray(places + self._rng.uniform(-0.25, 0.25, len(places)) * spacing_m)

    def put_trees(self, side: Street) -> None:
        """On the pavement opposite."""
        rng, across = self._rng, self._look.street_m - 3.0
        for along in self._along(side, self._look.tree_spacing_m):
            radius, stem = rng.uniform(1.1, 1.8), rng.uniform(2.4, 3.4)
            reach = 1.4 * radius
            outline = side.rectangle((along - reach, along + reach), (across - reach, across + reach))
            middle = side.points_enu_m(np.array([along, across, stem + radius]))
            leaves = crown(rng, middle, radius)
            if self._ground.take(outline, "fronts"):
                trunk = boxes(side, along, across, (Part((-0.14, 0.14), (-0.14, 0.14), (0.0, stem + radius)),))
                trunk, leaves = self._standing(trunk, outline), self._standing(leaves, outline)
                self._add("trunks", trunk, (0.16, 0.12, 0.09))
                self._add("crowns", leaves, (1.0, 1.0, 1.0), self._leaves)
                self.high.append((f"tree-{len(self.high):02d}", join([trunk, leaves])))

    def put_cars(self, side: Street) -> None:
        """Parked along both kerbs."""
        for across in (PAVEMENT_M + 1.3, self._look.street_m - PAVEMENT_M - 1.3):
            for along in self._along(side, self._look.car_spacing_m):
                colour = int(self._rng.integers(len(CAR_COLOURS)))
                outline = side.rectangle((along - 2.4, along + 2.4), (across - 1.0, across + 1.0))
                if self._ground.take(outline, "fronts"):
                    paint, dark = boxes(side, along, across, CAR_PAINT), boxes(side, along, across, CAR_DARK)
                    self._add(f"cars-{colour}", self._standing(paint, outline), CAR_COLOURS[colour])
                    self._add("dark", self._standing(dark, outline), DARK)

    def _standing(self, mesh: TriangleMesh, outline: Array) -> TriangleMesh:
        """A mesh that was made for level ground, on the ground below the middle of its outline."""
        up_m = float(self._below.heights_m(outline.mean(axis=0)[None])[0]) - self._below.level_z_m
        return TriangleMesh(mesh.vertices_enu_m + np.array([0.0, 0.0, up_m]), mesh.triangles)

    def put_people(self, side: Street) -> None:
        """On the pavements of both sides."""
        rng, width = self._rng, self._look.street_m
        spacing = self._look.people_spacing_m
        half = side.half_m + 5.0
        for _ in range(round(2.0 * half / spacing) if spacing > 0.0 else 0):
            along = rng.uniform(-half, half)
            across = rng.uniform(1.0, PAVEMENT_M) + rng.choice([0.0, width - PAVEMENT_M - 1.0])
            size, colour = rng.uniform(0.9, 1.1), int(rng.integers(len(CLOTHES)))
            outline = side.rectangle((along - 0.25, along + 0.25), (across - 0.2, across + 0.2))
            if not self._ground.take(outline, "walls"):
                continue
            for name, parts, shown in (
                (f"clothes-{colour}", PERSON_CLOTHES, CLOTHES[colour]),
                ("dark", PERSON_DARK, DARK),
                ("skin", PERSON_SKIN, SKIN),
            ):
                self._add(name, self._standing(boxes(side, along, across, parts, size), outline), shown)


def _with_obstacles(model: SiteModel, high: list[tuple[str, TriangleMesh]]) -> SiteModel:
    """The site with what flights have to keep away from, too."""
    added = [_obstacle(f"scene-{name}", mesh) for name, mesh in high]
    meshes = [
        mesh if obstacle.box_enu_m is None else box_geometry(obstacle)
        for obstacle, (_, mesh) in zip(added, high, strict=True)
    ]
    return replace(
        model,
        site=replace(model.site, obstacles=(*model.site.obstacles, *added)),
        obstacles=(*model.obstacles, *meshes),
    )


def _obstacle(name: str, mesh: TriangleMesh) -> Obstacle:
    """The box around something, but for buildings at an angle to the axes, whose box would narrow the street."""
    low, high = mesh.vertices_enu_m.min(axis=0), mesh.vertices_enu_m.max(axis=0)
    is_aligned = bool((np.isclose(mesh.vertices_enu_m, low) | np.isclose(mesh.vertices_enu_m, high)).all())
    if "opposite" in name and not is_aligned:
        return Obstacle(name, mesh=f"{name}.ply")
    (x0, y0, z0), (x1, y1, z1) = (tuple(float(value) for value in corner) for corner in (low, high))
    return Obstacle(name, box_enu_m=((x0, y0, z0), (x1, y1, z1)))

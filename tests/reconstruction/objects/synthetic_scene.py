"""Scenes of objects made of random Gaussians, without a training."""

from __future__ import annotations

import numpy as np

from planning.geo.frames import Origin
from reconstruction.objects.gs_scene import GsAuxiliary, GsComponent, GsElement, GsGaussian, GsScene
from reconstruction.records.entries import global_id_of

COLUMNS = {"means": (3,), "quats": (4,), "log_scales": (2,), "opacity_logits": (), "sh": (16, 3)} | {
    "reflectivity_logits": (),
    "f0_logits": (3,),
}
ORIGIN = Origin(22.3372, 114.2636, 62.0)


def gaussians(n: int, rng: np.random.Generator, places=None) -> GsGaussian:
    """Any ones, near the origin and a few centimetres large."""
    values = {name: rng.normal(size=(n, *shape)).astype(np.float32) for name, shape in COLUMNS.items()}
    values["log_scales"] = np.log(rng.uniform(0.02, 0.1, (n, 2))).astype(np.float32)
    values["sh"][:, 1:] *= 0.1
    places = np.arange(n, dtype=np.int32) if places is None else places.astype(np.int32)
    return GsGaussian(values, places)


def pane(column: int, row: int, width_m: float = 1.5, height_m: float = 2.0):
    """Corners of a panel of a facade in the plane y = 0 that looks south."""
    west, east, low, high = column * width_m, (column + 0.9) * width_m, row * height_m, (row + 0.9) * height_m
    return ((west, 0.0, low), (east, 0.0, low), (east, 0.0, high), (west, 0.0, high))


def synthetic_scene(sizes=((3, 0, 5), (2,)), n_background=4, seed=0, name="made") -> GsScene:
    """Facades with panels of so many Gaussians each, and a background."""
    rng = np.random.default_rng(seed)
    n = sum(map(sum, sizes)) + n_background
    places, first, panel = rng.permutation(n), 0, 0
    components = []
    for number, facade in enumerate(sizes):
        elements, start = [], 0
        for column, size in enumerate(facade):
            named = f"{'ABCDEFGH'[number]}-{column:04d}"
            corners = pane(column, number)
            elements.append(GsElement(global_id_of(name, named), named, panel, corners, start, start + size))
            start, panel = start + size, panel + 1
        table = gaussians(start, rng, places[first : first + start])
        facade_id = global_id_of(name, f"facade {number}")
        components.append(GsComponent(facade_id, "ABCDEFGH"[number], "facade", tuple(elements), table))
        first += start
    rest = gaussians(n_background, rng, places[first:])
    components.append(GsComponent(global_id_of(name, "background"), "background", "background", (), rest))
    sky = GsAuxiliary("sky", {"sky.texels": rng.normal(size=(4, 8, 3)).astype(np.float32)})
    origin_enu_m = (1.0, 2.0, 3.0)
    return GsScene(
        global_id_of(name, "scene"), name, ORIGIN, origin_enu_m, tuple(components), (sky,), {"format": "none"}, n
    )

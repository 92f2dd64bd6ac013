"""A flight along one facade as files, and what a search for panels finds in its photos."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from groundstation.services.photos.found_panels import PanelDraft
from planning.base.effects import Decision
from planning.geo.mesh import box_mesh
from planning.site.file import site_sha256
from planning.site.records import Airspace, Facade, Panel, Site, SiteModel
from reconstruction.base.cameras import PosedPhoto
from reconstruction.panels.rectify.fit import SurfaceFit
from reconstruction.panels.solving.find import FoundPanels
from reconstruction.panels.solving.solve import solve_facade
from tests.reconstruction.panels.rectify.scenes import looking_at
from tests.reconstruction.panels.rectify.test_surface import surface
from tests.reconstruction.panels.solving.test_solve import RTK, found_grid, stated
from tests.reconstruction.synthetic_photos import ORIGIN, write_flight

FLAT = Decision("facade curvature", False, "scene", "it is flat", 0.0, 1.0, "px", 0.0)
PLACES = ((0.0, 0.0), (7.0, 2.0), (-6.0, -2.0))


def true_photos() -> list[PosedPhoto]:
    """Three cameras that look at the facade from 22 m."""
    return [looking_at(surface(0.0, lean_rad=0.0), 22.0, aside, above) for aside, above in PLACES]


def draft_of(photos: list[PosedPhoto] | None = None, seed: int = 0) -> PanelDraft:
    """Found panels, 3 rows of 10; the poses are those of `photos`, or wrong by what RTK leaves."""
    rng = np.random.default_rng(seed)
    truth = surface(0.0, lean_rad=0.0)
    fit = SurfaceFit(truth, np.diag([0.02, 2e-4, 2e-4]) ** 2, 0.05, 1000)
    true = true_photos()
    told = [stated(photo, RTK, rng) for photo in true] if photos is None else photos
    grids = {i: found_grid(true[i], told[i], truth, truth, 0.3, rng) for i in range(len(true))}
    found = FoundPanels(
        (solve_facade("A", told, grids, fit),),
        {("A", number): grid for number, grid in grids.items()},
        {"A": fit},
        {"A": FLAT},
        (),
    )
    return PanelDraft(tuple(told), found)


def site_model() -> SiteModel:
    """The facade's building, with one panel that somebody drew."""
    building = box_mesh(np.array([8.0, 0.0, 0.0]), np.array([16.0, 8.0, 30.0]))
    panel = Panel("X-1", ((0.0, -0.1, 5.0), (1.0, -0.1, 5.0), (1.0, -0.1, 6.0), (0.0, -0.1, 6.0)))
    airspace = Airspace((-80.0, -80.0, 0.0), (80.0, 80.0, 100.0), 0.0, ())
    site = Site(
        name="made",
        origin=ORIGIN,
        facades=(Facade("X", (panel,)),),
        airspace=airspace,
        home_enu_m=(-60.0, -60.0, 0.0),
        building_mesh="made.ply",
    )
    return SiteModel(site, building, (), site_sha256(site))


def write_photos(folder: Path) -> None:
    """The three photos as files: noise, but with where and how they were taken."""
    rng = np.random.default_rng(3)
    made = []
    for photo in true_photos():
        lens = photo.intrinsics
        coarse = rng.integers(40, 200, (lens.height_px // 16 + 1, lens.width_px // 16 + 1, 3), np.uint8)
        image = np.kron(coarse, np.ones((16, 16, 1), np.uint8))[: lens.height_px, : lens.width_px]
        made.append(SimpleNamespace(photo=photo, image=image))
    folder.mkdir(parents=True, exist_ok=True)
    write_flight(folder, made)


def with_paths(draft: PanelDraft, paths: list[Path]) -> PanelDraft:
    """A draft whose photos are these files."""
    photos = tuple(replace(photo, path=path) for photo, path in zip(draft.photos, paths, strict=True))
    return replace(draft, photos=photos)

"""A shop with plans made by hand: a site that is small enough for exact judging, and has everything that is claimed.

As a hut it has two panels, three views and wider sections: thousands of tampered huts are judged in minutes.
"""

from __future__ import annotations

import itertools
import json
import tempfile
import zipfile
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

from planning.aircraft.catalogue import profile
from planning.coverage.evaluate import coverage
from planning.coverage.model import CoverageModel
from planning.coverage.reachability import Reachability, find_reachable
from planning.geo.frames import Vec3, aim
from planning.geo.mesh import TriangleMesh, box_mesh, ply_bytes
from planning.motion.timing import sortie_flight_path, stopping_duration_s
from planning.parameters import Constraints, FlightRules
from planning.plan import Coverage, Plan, Sortie, Viewpoint, plan_to_json
from planning.site.bundled import ORIGIN, panel_grid
from planning.site.file import site_bytes, site_sha256
from planning.site.free_space import FreeSpace, free_space
from planning.site.records import Airspace, NoFlyZone, Obstacle, Site, SiteModel, box_geometry
from planning.viewpoints.prepare import coverage_model

HOME: Vec3 = (0.0, -18.0, 0.25)

LOOKS: tuple[tuple[Vec3, Vec3], ...] = (
    ((-6.5, -6.0, 5.75), (-2.0, 0.0, 3.0)),
    ((-2.5, -8.0, 6.0), (2.0, 0.0, 5.0)),
    ((3.25, -8.0, 8.0), (2.0, 0.0, 2.0)),
    ((7.25, -4.5, 9.25), (0.0, 0.0, 5.0)),
    ((8.75, 4.0, 6.5), (4.0, 3.0, 3.5)),
    ((1.25, 2.0, 13.0), (0.0, 3.0, 7.0)),
)
"""Places of the views, and what each looks at."""

PASSED: dict[Vec3, Vec3] = {(1.25, 2.0, 13.0): (8.75, 3.0, 13.0)}
"""Vertices without a photo, before the view at a place."""


def shop(*, is_hut: bool = False) -> SiteModel:
    """Building of 8 x 6 x 7 m with four panels to the south, one to the east and one on its roof."""
    south = panel_grid("A", ((-4.0, 0.0, 0.0), (4.0, 0.0, 0.0), (-4.0, 0.0, 7.0)), 2, 2)
    east = panel_grid("B", ((4.0, 1.0, 1.0), (4.0, 5.0, 1.0), (4.0, 1.0, 6.0)), 1, 1)
    roof = panel_grid("C", ((-2.0, 1.0, 7.0), (2.0, 1.0, 7.0), (-2.0, 5.0, 7.0)), 1, 1)
    zone = NoFlyZone("road", ((-20.0, -25.0), (-14.0, -25.0), (-12.0, 0.0), (-14.0, 20.0), (-20.0, 20.0)), 0.0, 30.0)
    obstacles = (
        Obstacle("tree", box_enu_m=((10.0, -9.5, 0.0), (11.5, -8.0, 8.0))),
        Obstacle("sign", box_enu_m=((-1.0, -3.0, 0.0), (1.0, -2.5, 2.75))),
    )
    site = Site(
        name="shop",
        origin=ORIGIN,
        facades=(replace(south, panels=south.panels[3:]), roof) if is_hut else (south, east, roof),
        airspace=Airspace((-22.0, -22.0, 3.0), (20.0, 18.0, 25.0), ground_z_m=0.0, no_fly=(zone,)),
        home_enu_m=HOME,
        building_mesh="shop.ply",
        obstacles=obstacles,
    )
    building = _in_single(box_mesh(np.array([-4.0, 0.0, 0.0]), np.array([4.0, 6.0, 7.0])))
    return SiteModel(site, building, tuple(box_geometry(each) for each in obstacles), site_sha256(site))


def _in_single(mesh: TriangleMesh) -> TriangleMesh:
    """As the mesh file holds it."""
    return TriangleMesh(mesh.vertices_enu_m.astype(np.float32).astype(np.float64), mesh.triangles)


def constraints(*, is_hut: bool = False) -> Constraints:
    """Of the plan."""
    step_deg = 45.0 if is_hut else 30.0
    return Constraints(4.0, section_step_deg=step_deg, occlusion="on", min_height_above_ground_m=5.0)


@cache
def prepared(*, is_hut: bool = False) -> tuple[SiteModel, FreeSpace, CoverageModel, Reachability]:
    """The shop with what planning finds out about it."""
    site_model, limits = shop(is_hut=is_hut), constraints(is_hut=is_hut)
    space = free_space(site_model, limits.min_distance_m)
    model = coverage_model(site_model, space, profile("m3e").camera, limits)
    return site_model, space, model, find_reachable(model, space)


def viewpoints(looks: Sequence[tuple[Vec3, Vec3]] = LOOKS) -> tuple[Viewpoint, ...]:
    """Views from places towards others, rounded as in plan files."""
    found = []
    for k, (place, at) in enumerate(looks):
        heading, pitch = aim(np.subtract(at, place))
        found.append(
            Viewpoint(f"v{k:04d}", place, round(float(np.degrees(heading)), 3), round(float(np.degrees(pitch)), 3))
        )
    return tuple(found)


@cache
def plan(*, is_hut: bool = False) -> Plan:
    """The views shared out between sorties that leave and reach home by the column above it; one sortie for the hut."""
    site_model, _, model, reachability = prepared(is_hut=is_hut)
    chosen, rules = profile("m3e"), FlightRules()
    views, n_sorties = (viewpoints(LOOKS[1:3] + LOOKS[5:]), 1) if is_hut else (viewpoints(), 2)
    # The hut's aircraft has a limit of jerk, which has a closed form of its own.
    aircraft = replace(chosen.aircraft, max_jerk_m_s3=4.0) if is_hut else chosen.aircraft
    parts = np.array_split(np.arange(len(views)), n_sorties)
    sorties = []
    for part in parts:
        flown = [views[k] for k in part]
        top = (HOME[0], HOME[1], 14.0 if flown[-1].position_enu_m[1] > 0.0 else 6.0)
        path = (HOME, (HOME[0], HOME[1], 9.0), *_vertices(flown), top, HOME)
        length_m = sum(float(np.linalg.norm(np.subtract(a, b))) for a, b in itertools.pairwise(path))
        sortie = Sortie(tuple(view.id for view in flown), path, round(length_m, 3), 0.0)
        timed = sortie_flight_path(sortie, {view.id: view for view in views}, aircraft, rules)
        assert timed is not None
        sorties.append(replace(sortie, duration_s=round(stopping_duration_s(timed[0], aircraft, rules), 1)))
    return Plan(
        site=site_model.site.name,
        site_sha256=site_model.sha256,
        method="greedy",
        seed=0,
        camera=chosen.camera,
        aircraft=aircraft,
        constraints=constraints(is_hut=is_hut),
        viewpoints=views,
        sorties=tuple(sorties),
        coverage=Coverage(*_counted(model, views, reachability)),
        origin=site_model.site.origin,
        home_enu_m=HOME,
        rules=rules,
        profile="m3e",
    )


def _vertices(views: Sequence[Viewpoint]) -> list[Vec3]:
    found = []
    for view in views:
        found += [PASSED[view.position_enu_m]] if view.position_enu_m in PASSED else []
        found.append(view.position_enu_m)
    return found


def _counted(model: CoverageModel, views: Sequence[Viewpoint], reachability: Reachability) -> tuple[int, int, int]:
    found = coverage(model, views, reachability)
    return found.covered, found.total, found.reachable_upper_bound


def files(*, is_hut: bool = False) -> dict[str, bytes]:
    """Site, mesh, plan, proof, and the missions of all formats, as planning and export write them."""
    from missions.formats.options import ExportOptions
    from missions.formats.registry import encode
    from planning.proof.make import proof_of

    site_model, _, _, reachability = prepared(is_hut=is_hut)
    flown = plan(is_hut=is_hut)
    written = {"site.json": site_bytes(site_model.site), "shop.ply": ply_bytes(site_model.building)}
    written["plan.json"] = json.dumps(plan_to_json(flown)).encode()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file, content in written.items():
            (folder / file).write_bytes(content)
        paths = folder / "site.json", folder / "plan.json"
        written["plan.proof"] = proof_of(*paths, written["plan.json"], site_model, reachability)
    for format_name, ending in (("dji-kmz", "kmz"), ("mavlink-plan", "plan"), ("mavlink-wpl", "waypoints")):
        contents = encode(flown, None, None, format_name, ExportOptions(site=site_model)).contents
        written |= {f"shop-{k}.{ending}": content for k, content in enumerate(contents, 1)}
    return written


def places(*, is_hut: bool = False) -> list[tuple[int, Vec3]]:
    """Sections that can be seen, each with a place that planning found."""
    witnesses = prepared(is_hut=is_hut)[3].witnesses_enu_m.reshape(-1, 3)
    return [(int(k), tuple(witnesses[k].tolist())) for k in np.flatnonzero(~np.isnan(witnesses[:, 0]))]


KEPT = Path(__file__).parent / "hut.zip"
"""The hut's files and places as they were written once: what was proved then is proved by later versions, too."""


@cache
def kept_hut() -> tuple[dict[str, bytes], list[tuple[int, Vec3]]]:
    """Files and places of the hut, without planning it."""
    with zipfile.ZipFile(KEPT) as archive:
        found = {name: archive.read(name) for name in archive.namelist()}
    return found, [(element, tuple(place)) for element, place in json.loads(found.pop("places.json"))]


def keep_hut() -> None:
    """Write `KEPT` anew: python -m tests.planning.proof.scenes."""
    with zipfile.ZipFile(KEPT, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in (*files(is_hut=True).items(), ("places.json", json.dumps(places(is_hut=True)).encode())):
            member = zipfile.ZipInfo(name, date_time=(1980, 1, 1, 0, 0, 0))
            member.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(member, content)


if __name__ == "__main__":
    keep_hut()

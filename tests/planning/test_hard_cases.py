"""Whole plans on sites that are hard: nothing to see, nowhere to be, too many views, one panel and thousands, far away.

Hard cases of single parts stand with those parts: section borders, the pole and the panel's plane in
`test_coverage_model` and `test_sections`; the exact minimum distance in `test_free_space` and `test_checks`; degenerate
panels, NaN and UTM coordinates in files in `test_plan_file` and the tests of site files; photos at one place in
`test_flights` and `test_tour`.
"""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np
import pytest

from planning.aircraft.catalogue import profile
from planning.base.errors import InfeasibleError
from planning.base.findings import is_flyable
from planning.checks import check_plan
from planning.coverage.model import CoverageModel, codes_all_around, exact_coverage
from planning.coverage.sections import SectionGrid, panel_frames
from planning.geo.frames import Vec3
from planning.geo.mesh import TriangleMesh, empty_mesh
from planning.parameters import Constraints, GreedyParameters
from planning.plan import Plan, ViewpointArrays, viewpoint_arrays
from planning.planner import Planned, plan_flight
from planning.request import PlanRequest
from planning.site.bundled import SCENES
from planning.site.records import Airspace, Facade, NoFlyZone, Panel, SiteModel, panel_corners
from tests.planning.plan_cases import kiosk, seen_by_contract

FEW = GreedyParameters(n_candidates=400, improve=False, certify=False)
NEAR = Constraints(min_distance_m=5.0)


def plan_kiosk(model: SiteModel, **wanted: object) -> Planned:
    request = PlanRequest(**{"n_views": 6, "constraints": NEAR, "greedy": FEW, **wanted})  # type: ignore[arg-type]
    return plan_flight(model, request)


def with_panels(model: SiteModel, *facades: Facade) -> SiteModel:
    return replace(model, site=replace(model.site, facades=facades))


def clockwise(facade: Facade) -> Facade:
    return Facade(facade.id, tuple(Panel(p.id, p.corners_enu_m[::-1]) for p in facade.panels))  # type: ignore[arg-type]


@pytest.mark.slow
def test_clockwise_panels_are_named_and_the_others_are_planned_for() -> None:
    south, east = kiosk().site.facades
    planned = plan_kiosk(with_panels(kiosk(), south, clockwise(east)))
    inwards = {f.place for f in planned.findings if f.code == "panel-faces-inwards"}
    assert inwards == {panel.id for panel in east.panels}
    assert all("clockwise" in f.message for f in planned.findings if f.code == "panel-faces-inwards")
    assert planned.plan.coverage.covered > 0
    assert planned.plan.coverage.reachable_upper_bound <= 9 * 36


def test_site_of_clockwise_panels_only_is_refused_with_a_hint() -> None:
    facades = (clockwise(facade) for facade in kiosk().site.facades)
    with pytest.raises(InfeasibleError, match=r"no allowed viewpoint sees any panel.*clockwise"):
        plan_kiosk(with_panels(kiosk(), *facades))


@pytest.mark.slow
def test_panel_that_nobody_can_see_is_named_and_costs_nothing_else() -> None:
    # A pane in the underside of a canopy below the airspace: no allowed place lies in front of it.
    corners = ((7.0, 3.0, 2.5), (7.0, 5.0, 2.5), (9.0, 5.0, 2.5), (9.0, 3.0, 2.5))
    model = kiosk()
    planned = plan_kiosk(with_panels(model, *model.site.facades, Facade("C", (Panel("under", corners),))))
    (unseen,) = [f for f in planned.findings if f.code == "panel-unseen"]
    assert (unseen.place, unseen.value, unseen.limit) == ("under", 0.0, 36.0)
    assert planned.plan.coverage.reachable_upper_bound <= 15 * 36 < planned.plan.coverage.total
    assert planned.plan.coverage.covered > 0


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"airspace": Airspace((-8.0, -3.0, 3.0), (8.0, 10.0, 12.0), 0.0)}, "home .* is not below or inside"),
        (
            {"airspace": Airspace((-6.5, -3.0, 3.0), (6.5, 8.0, 12.0), 0.0), "home_enu_m": (0.0, -2.0, 0.0)},
            "take-off column above home .* comes within 2.00 m",
        ),
        ({"home_enu_m": (0.0, 4.0, 0.0)}, "home .* lies inside a building or obstacle"),
        ({"home_enu_m": (-25.0, 0.0, 0.0)}, "home .* lies inside a no-fly volume"),
        ({"home_enu_m": (0.0, -30.0, 39.0)}, "home .* is not below or inside the airspace box"),
    ],
)
def test_sites_from_which_nobody_can_take_off_say_why(changes: dict[str, object], message: str) -> None:
    with pytest.raises(InfeasibleError, match=message):
        plan_kiosk(kiosk(**changes))


def test_airspace_that_is_only_the_column_above_home_is_refused() -> None:
    narrow = Airspace((-0.001, -30.001, 3.0), (0.001, -29.999, 40.0), 0.0)
    with pytest.raises(InfeasibleError, match=r"no place in it keeps 5 m.*widen the airspace or lower the minimum"):
        plan_kiosk(kiosk(airspace=narrow))


@pytest.mark.slow
def test_a_no_fly_volume_over_everything_but_home_leaves_what_can_be_seen_from_there() -> None:
    ring = NoFlyZone("ring", ((-40.0, -24.0), (40.0, -24.0), (40.0, 40.0), (-40.0, 40.0)), -1.0, 90.0)
    model = kiosk(airspace=Airspace((-40.0, -40.0, 3.0), (40.0, 40.0, 40.0), 0.0, (ring,)))
    planned = plan_kiosk(model, time_budget_s=2.0)
    assert all(v.position_enu_m[1] <= -24.0 for v in planned.plan.viewpoints)
    free = plan_kiosk(kiosk())
    assert planned.plan.coverage.reachable_upper_bound < free.plan.coverage.reachable_upper_bound
    assert is_flyable(check_plan(planned.plan, model))


@pytest.mark.slow
def test_more_views_than_are_useful_are_spent_on_depth_or_left_out() -> None:
    model = SCENES["single-panel"]()
    by_sections = replace(FEW, objective="sections")
    planned = plan_flight(model, PlanRequest(n_views=120, greedy=by_sections, time_budget_s=600.0))
    plan = planned.plan
    assert plan.coverage.covered == plan.coverage.reachable_upper_bound == 34
    assert 34 < len(plan.viewpoints) <= 120
    assert planned.depth[1].covered > 25, "most sections are seen a second time"
    poses = {(v.position_enu_m, v.heading_deg, v.gimbal_pitch_deg) for v in plan.viewpoints}
    assert len(poses) == len(plan.viewpoints)
    assert is_flyable(check_plan(plan, model))


@pytest.mark.long
def test_one_view_of_one_panel_makes_a_flight() -> None:
    plan = plan_flight(SCENES["single-panel"](), PlanRequest(n_views=1, greedy=FEW)).plan
    assert (len(plan.viewpoints), len(plan.sorties), plan.coverage.covered) == (1, 1, 1)


@pytest.mark.slow
def test_horizontal_and_slanted_panels_are_planned_as_the_contract_counts_them() -> None:
    skylight: tuple[Vec3, Vec3, Vec3, Vec3] = ((-1.0, 3.0, 9.05), (1.0, 3.0, 9.05), (1.0, 5.0, 9.05), (-1.0, 5.0, 9.05))
    slanted: tuple[Vec3, Vec3, Vec3, Vec3] = ((2.0, 2.0, 9.1), (4.0, 2.0, 9.1), (4.0, 4.0, 9.1001), (2.0, 4.0, 9.1001))
    soffit: tuple[Vec3, Vec3, Vec3, Vec3] = ((7.0, 3.0, 8.0), (7.0, 5.0, 8.0), (9.0, 5.0, 8.0), (9.0, 3.0, 8.0))
    panels = (Panel("flat", skylight), Panel("slanted", slanted), Panel("soffit", soffit))
    model = kiosk(facades=(Facade("R", panels),))
    plan = plan_kiosk(model, n_views=20).plan
    occlusion = plan.constraints.occlusion == "on"
    seen = seen_by_contract(model, plan.camera, plan.viewpoints, 30.0, occlusion)
    assert len(seen) == plan.coverage.covered
    assert {panel for panel, _ in seen} >= {0, 1}
    assert is_flyable(check_plan(plan, model))


def moved(model: SiteModel, offset: Vec3) -> SiteModel:
    """The site with every coordinate shifted."""
    shift = np.array(offset)

    def point(p: Vec3) -> Vec3:
        x, y, z = (round(float(a + b), 4) for a, b in zip(p, shift, strict=True))
        return x, y, z

    def mesh(m: TriangleMesh) -> TriangleMesh:
        return replace(m, vertices_enu_m=(m.vertices_enu_m + shift).round(4))

    site, airspace = model.site, model.site.airspace
    facades = tuple(
        Facade(f.id, tuple(replace(p, corners_enu_m=tuple(map(point, p.corners_enu_m))) for p in f.panels))  # type: ignore[arg-type]
        for f in site.facades
    )
    zones = tuple(
        replace(
            zone,
            polygon_enu_m=tuple((x + shift[0], y + shift[1]) for x, y in zone.polygon_enu_m),
            floor_m=zone.floor_m + shift[2],
            ceiling_m=zone.ceiling_m + shift[2],
        )
        for zone in airspace.no_fly
    )
    space = replace(
        airspace,
        min_enu_m=point(airspace.min_enu_m),
        max_enu_m=point(airspace.max_enu_m),
        ground_z_m=airspace.ground_z_m + shift[2],
        no_fly=zones,
    )
    obstacles = tuple(
        replace(o, box_enu_m=tuple(map(point, o.box_enu_m or ())))  # type: ignore[arg-type]
        for o in site.obstacles
    )
    there = replace(site, facades=facades, airspace=space, home_enu_m=point(site.home_enu_m), obstacles=obstacles)
    return SiteModel(there, mesh(model.building), tuple(map(mesh, model.obstacles)))


OFFSETS = [(7_000.0, -3_000.0, 400.0), (19_900.0, 19_900.0, 2_000.0), (-19_950.0, 19_950.0, -500.0)]


@functools.cache
def plan_here() -> Plan:
    return plan_kiosk(kiosk(), n_views=12).plan


@pytest.mark.long
@pytest.mark.few(2)
@pytest.mark.parametrize("offset", OFFSETS)
@pytest.mark.parametrize("precision", ["f32", "f64"])
def test_coverage_of_the_same_views_is_the_same_wherever_the_site_lies(offset: Vec3, precision: str) -> None:
    views = viewpoint_arrays(plan_here().viewpoints)
    rng = np.random.default_rng(0)
    many = ViewpointArrays(
        rng.uniform([-40, -40, 3], [40, 0, 40], (4000, 3)), rng.uniform(-1, 1, 4000), rng.uniform(-0.9, 0.4, 4000)
    )
    for these in (views, many):
        there = these._replace(positions_enu_m=these.positions_enu_m + np.array(offset))
        models = [
            CoverageModel(
                panel_frames(panel_corners(site.site)),
                profile("m3e").camera,
                SectionGrid(30.0),
                precision=precision,  # type: ignore[arg-type]
            )
            for site in (kiosk(), moved(kiosk(), offset))
        ]
        here_codes = codes_all_around(models[0], these.positions_enu_m)
        there_codes = codes_all_around(models[1], there.positions_enu_m)
        assert (here_codes != there_codes).mean() < 2e-4
        counts = [exact_coverage(model, view) for model, view in zip(models, (these, there), strict=True)]
        assert np.abs(counts[0] - counts[1]).sum() <= 2 + 2e-4 * counts[0].sum()


@pytest.mark.slow
@pytest.mark.parametrize("offset", OFFSETS[1:])
@pytest.mark.parametrize("precision", ["f32", "f64"])
def test_a_site_at_the_edge_of_the_coordinates_allowed_is_planned_as_well_as_at_the_origin(
    offset: Vec3, precision: str
) -> None:
    far = moved(kiosk(), offset)
    planned = plan_kiosk(far, n_views=12, precision=precision)
    here, there = plan_here(), planned.plan
    assert is_flyable(check_plan(there, far))
    assert there.constraints.occlusion == here.constraints.occlusion
    assert there.coverage.covered == pytest.approx(here.coverage.covered, rel=0.05)
    bounds = there.coverage.reachable_upper_bound, here.coverage.reachable_upper_bound
    assert abs(bounds[0] - bounds[1]) <= 0.02 * bounds[1]
    seen = seen_by_contract(far, there.camera, there.viewpoints, 30.0, occlusion=True)
    assert abs(len(seen) - there.coverage.covered) <= 1


@pytest.mark.long
def test_a_panel_alone_without_any_mesh_is_kept_away_from() -> None:
    model = replace(kiosk(building_mesh=None, obstacles=()), building=empty_mesh(), obstacles=())
    plan = plan_kiosk(model).plan
    assert plan.coverage.covered > 0
    assert is_flyable(check_plan(plan, model))


@pytest.mark.slow
def test_a_tower_of_thousands_of_panels_is_planned_and_checked() -> None:
    model = SCENES["tower"]()
    assert model.site.n_panels > 3600
    planned = plan_flight(model, PlanRequest(time_budget_s=240.0))  # a quarter of it where nothing else runs
    coverage = planned.plan.coverage
    assert coverage.total == 36 * model.site.n_panels
    assert coverage.covered >= 0.98 * coverage.reachable_upper_bound
    assert planned.n_undecided < 0.01 * coverage.total
    assert is_flyable(check_plan(planned.plan, model))


@pytest.mark.slow
def test_thousands_of_views_are_routed() -> None:
    model = SCENES["office"]()
    planned = plan_flight(model, PlanRequest(n_views=2500, time_budget_s=20.0))
    assert len(planned.plan.viewpoints) > 1000
    assert is_flyable(check_plan(planned.plan, model))
    assert sum(planned.seconds.values()) < 90.0

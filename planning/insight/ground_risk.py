"""Ground risk by SORA 2.5: flight geography, contingency volume, ground-risk buffer and ground risk class of a plan.

Sizes follow the guidance of the German authority for multirotors (`LBA`): what the aircraft may stray (S), then how far
it flies before the pilot reacts and brakes (contingency), then how far it falls with its motors off (buffer). Its sum
is extended where it would not hold: an aircraft that still climbs when the motors stop, and one that the wind carries.
With both, the buffer holds for every fall that begins inside the contingency volume with at most the stated speeds, for
any drag up to the stated one (`falling.py`).

Over terrain each place has its own height. A body that falls from z over a place has reached the ground by the time it
is as low as the lowest ground within its way, so that with R(H) the buffer for the height H, the disc about the place
holds its way where R >= R(z - lowest ground in the disc); `_buffer_by_place` finds such an R for each.

Offsets in the plane circumscribe: every polygon holds the exact one, and is wider by at most the arc tolerance. Nothing
here is legal advice: what comes out is a filled draft that the operator has to check.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from planning.aircraft.catalogue import Body, profiles
from planning.base.errors import InfeasibleError, InputError
from planning.base.findings import Finding, Severity
from planning.base.messages import joined, say
from planning.geo.height_field import HeightField
from planning.insight.falling import drag_per_m, fall_s, longest_fall_s, reach_m
from planning.insight.ground_risk_class import PeopleBand, band_of, ground_risk_tables, risk_classes
from planning.insight.ground_risk_request import GroundRiskRequest
from planning.insight.population import People, open_population, people_below
from planning.plan import Plan
from planning.site.ground import Ground, ground_of
from planning.site.records import Site

if TYPE_CHECKING:
    from shapely import Geometry, Polygon

GRAVITY_M_S2 = 9.81
"""In the sums of the guidance, so that its own examples come out."""

LBA = "LBA guidance 1.7"
SORA = "SORA 2.5, step 8"

DOCUMENTS = (
    "LBA guidance 1.7: Luftfahrt-Bundesamt, Guidance for Dimensioning of Flight Geography, Contingency Volume and "
    "Ground Risk Buffer, revision 1.7, 26 November 2024",
    "SORA 2.5: JAR-DEL-SRM-SORA-MB-2.5, taken over in AMC1 Article 11 of (EU) 2019/947, ED Decision 2025/018/R",
)
"""What the short names of sources stand for."""

WIDTH_IN_DIMENSIONS = 3.0
"""Narrowest and lowest flight geography, in characteristic dimensions (`LBA`)."""

CLIMB_SHARE = math.sqrt(0.5)
"""Of the speed that goes upwards before the pilot reacts: a path at 45 degrees (`LBA`, which rounds it to 0.7)."""

BARO_ERROR_M, GNSS_HEIGHT_ERROR_M = 1.0, 4.0
"""Error of the height, by how it is measured (`LBA`)."""

ADJACENT_S, ADJACENT_LEAST_M, ADJACENT_MOST_M = 180.0, 5_000.0, 35_000.0
"""Adjacent area: flown in 3 minutes, at least 5 and at most 35 km (SORA 2.5, step 8)."""

HIGHEST_M = 120.0
"""Above it other rules of the air hold in most places (EU 2019/947, UAS.OPEN.010)."""

# Quantities: each number with where it comes from.


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number of the assessment.

    Parameters
    ----------
    formula
        In symbols of other quantities; "" for what was stated or looked up.
    source
        Document, maker or person that the number or formula is from.
    is_assumed
        Nobody stated it and no document gives it for this aircraft.
    """

    symbol: str
    name: str
    value: float
    unit: str
    formula: str
    source: str
    is_assumed: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class GroundRisk:
    """The assessment of a plan.

    Parameters
    ----------
    quantities
        All numbers, in the order in which they follow from each other; `value_of` finds one by its symbol.
    geography, contingency, buffer
        Areas in ENU metres, each holding the one before: flight geography, with the contingency volume around it, and
        with the ground-risk buffer around that.
    geography_top_m, contingency_top_m
        Above the ground, in the site's level.
    ground_z_m
        Height of the ground in the local frame.
    band
        None where nobody stated how many people there are.
    intrinsic_class, final_class
        Ground risk class before and after mitigations; None where it is not known, or beyond SORA.
    people
        What a population raster says of the buffer; None without one. It makes the band where nobody stated people.
    ground
        What lies below; with terrain, the buffer is as wide as the height above it asks for at each place.
    how_intrinsic, how_final
        How the classes came about: what went into which table; "" where there is no class.
    """

    request: GroundRiskRequest
    body: Body
    quantities: tuple[Quantity, ...]
    core: Geometry
    geography: Polygon
    contingency: Polygon
    buffer: Polygon
    ground_z_m: float
    band: PeopleBand | None
    intrinsic_class: int | None
    final_class: int | None
    findings: tuple[Finding, ...]
    people: People | None = None
    ground: Ground = field(default_factory=lambda: Ground(0.0))
    how_intrinsic: str = ""
    how_final: str = ""

    def value_of(self, symbol: str) -> float:
        """One of the numbers.

        Raises
        ------
        KeyError
            There is none of this symbol.
        """
        for each in self.quantities:
            if each.symbol == symbol:
                return each.value
        raise KeyError(symbol)

    @property
    def geography_top_m(self) -> float:
        """Height of the flight geography above the ground."""
        return self.value_of("H_FG")

    @property
    def contingency_top_m(self) -> float:
        """Height of the contingency volume above the ground."""
        return self.value_of("H_CV")

    @property
    def people_allowed(self) -> str:
        """Whether people who are not involved may be inside the buffer, for the pilot."""
        if self.band is None:
            return say("not stated how many: keep everybody out who is not involved")
        if self.band.word == "controlled":
            return say("nobody who is not involved (controlled ground area)")
        if self.band.below_per_km2 == math.inf:
            return say("an assembly of people")
        most = self.band.below_per_km2 * self.buffer.area / 1e6
        return say("fewer than {:g} per square kilometre, {:.1f} in the whole area", self.band.below_per_km2, most)


# Areas.


def grown(core: Geometry, by_m: float, arc_tolerance_m: float) -> Polygon:
    """Everything within `by_m` of a geometry, and at most `arc_tolerance_m` more.

    GEOS puts the corners of its arcs on the circle, so that the chords between them lie inside. The circle is widened
    until the chords touch the wanted one. A step of an arc is up to 1.5 times what was asked for, since it divides the
    angle by a number that it rounds. Parts are grown one by one and then united: of a line that crosses itself GEOS
    3.14 loses up to a seventh of the area.
    """
    import shapely

    if by_m <= 0.0:
        return core
    # cos(x) >= 1 / (1 + tolerance / radius) for half a step x.
    half_step = math.acos(1.0 / (1.0 + arc_tolerance_m / by_m))
    per_quarter = max(2, math.ceil(0.75 * (math.pi / 2.0) / half_step))
    half_step = 0.75 * (math.pi / 2.0) / per_quarter
    grown_parts = shapely.buffer(shapely.get_parts(core), by_m / math.cos(half_step), quad_segs=per_quarter)
    return shapely.union_all(grown_parts)


def path_geometry(plan: Plan, request: GroundRiskRequest) -> Geometry:
    """Hull of all paths seen from above, or all their legs.

    Raises
    ------
    InfeasibleError
        No sortie has a path.
    """
    import shapely

    paths = [np.array(sortie.path_enu_m, np.float64)[:, :2] for sortie in plan.sorties if sortie.path_enu_m]
    if not paths:
        raise InfeasibleError.say("the plan has no sorties, so there is nothing that could fall; plan a flight first")
    if request.geography == "hull":
        return shapely.convex_hull(shapely.multipoints(np.concatenate(paths)))
    legs = np.concatenate(
        [np.stack([path[:-1], path[1:]], axis=1) if len(path) > 1 else path[None, [0, 0]] for path in paths]
    )
    # A leg straight up is a point from above.
    goes = (legs[:, 0] != legs[:, 1]).any(axis=1)
    points = np.unique(legs[~goes, 0], axis=0)
    return shapely.geometrycollections([*shapely.linestrings(legs[goes]), *shapely.points(points)])


# The assessment.


def assess_ground_risk(
    plan: Plan,
    site: Site,
    request: GroundRiskRequest | None = None,
    return_height_m: float | None = None,
) -> GroundRisk:
    """Volumes and ground risk class of a plan's flown paths.

    Parameters
    ----------
    return_height_m
        Above take-off, where it returns home higher than its paths.

    Raises
    ------
    InfeasibleError
        The plan has no sorties, the wind is more than the aircraft may fly in, or the ground falls away without end.
    InputError
        Something of the aircraft is neither known nor stated; the message lists all of that. The raster cannot be read.
    """
    request = request or GroundRiskRequest()
    body = _body(plan, request)
    wind_m_s = _wind(plan, request)
    core = path_geometry(plan, request)
    ground_z_m, is_known = _lowest_ground(site, core)
    for _ in range(GROUND_ROUNDS):
        top_m = _top_m(plan, site, return_height_m, ground_z_m)
        quantities = tuple(_quantities(plan, request, body, wind_m_s, top_m))
        value = {each.symbol: each.value for each in quantities}
        geography, contingency, buffer = _areas(core, value, request.arc_tolerance_m)
        # Lower ground makes the buffer wider, and a wider buffer may reach lower ground.
        lower_z_m, is_known = _lowest_ground(site, buffer)
        if lower_z_m >= ground_z_m:
            break
        ground_z_m = lower_z_m
    else:
        raise InfeasibleError.say("the ground falls away as far as the buffer is widened; limit speed or wind")
    ground = ground_of(site)
    narrowest_m = value["S_GRB"]
    if ground.terrain is not None:

        def width_m(height_m: float) -> float:
            numbers = _buffer(request, body, wind_m_s, plan.aircraft.max_ascent_m_s, height_m)
            return next(each.value for each in numbers if each.symbol == "S_GRB")

        buffer, narrowest_m = _buffer_by_place(
            contingency, ground.terrain.lower, ground_z_m + value["H_CV"], value, width_m, request.arc_tolerance_m
        )
        quantities = (*quantities, *_terrain_quantities(ground, ground_z_m, geography, value, narrowest_m))
        value = {each.symbol: each.value for each in quantities}
    people = None
    if request.population_raster is not None:
        raster = open_population(Path(request.population_raster), request.population_counts)
        people = people_below(raster, buffer, site.origin)
        quantities = (*quantities, *_grid_quantities(_above_place_m(value)))
    band = None if request.population is None else band_of(request.population)
    if band is None and people is not None and people.most_per_km2 is not None and people.unknown <= 0.0:
        band = band_of(f"{people.most_per_km2}")
    if people is not None:
        quantities = (*quantities, *_people_quantities(people))
    known = known_body(plan)
    # A mode that limits the speed lasts only as long as the aircraft obeys (AMC1 Article 11, S.4.2.4 (b)).
    speed_m_s = max(body.full_speed_m_s, 0.0 if known is None else known.full_speed_m_s)
    column = ground_risk_tables().column_of(body.characteristic_dimension_m, speed_m_s)
    classes = None if band is None or column is None else risk_classes(band, column, body, speed_m_s, request)
    intrinsic, final = (None, None) if classes is None else (classes.intrinsic, classes.final)
    return GroundRisk(
        request=request,
        body=body,
        quantities=quantities,
        core=core,
        geography=geography,
        contingency=contingency,
        buffer=buffer,
        ground_z_m=ground_z_m,
        band=band,
        intrinsic_class=intrinsic,
        final_class=final,
        how_intrinsic="" if classes is None else classes.how_intrinsic,
        how_final="" if classes is None else classes.how_final,
        findings=(
            *_findings(request, plan, value, band, column, intrinsic, final),
            *_ground_findings(value, is_known),
            *_zone_findings(site, contingency, buffer),
            *(() if people is None else _people_findings(people, request.population, buffer, value)),
        ),
        people=people,
        ground=ground,
    )


def known_body(plan: Plan) -> Body | None:
    """What the plan's profile says of the aircraft's body; None where it has no profile, or that says nothing."""
    profile = profiles().get(plan.profile)
    return None if profile is None else profile.body


def usual_wind_m_s(plan: Plan) -> float:
    """The plan's wind; the strongest that the aircraft may fly in where the plan expects none."""
    return plan.rules.wind_m_s or plan.aircraft.max_wind_m_s


def _body(plan: Plan, request: GroundRiskRequest) -> Body:
    """The aircraft's body, with what was stated put over what its profile says."""
    known = known_body(plan)
    stated = {
        say("largest dimension"): request.dimension_m,
        say("take-off mass"): request.mass_kg,
        say("full speed through the air"): request.speed_m_s,
        say("braking tilt"): request.tilt_deg,
    }
    missing = [name for name, value in stated.items() if value is None]
    if known is None and missing:
        raise InputError.say(
            "of {} it is not known how large, heavy and fast it is; state {}, or 'body' in a profile of your own",
            plan.aircraft.name,
            joined(", ", missing),
        )
    usual = (
        (0.0, 0.0, 0.0, 0.0)
        if known is None
        else (
            known.characteristic_dimension_m,
            known.max_takeoff_mass_kg,
            known.full_speed_m_s,
            known.braking_tilt_deg,
        )
    )
    dimension, mass, speed, tilt = (
        own if value is None else value for own, value in zip(usual, stated.values(), strict=True)
    )
    return Body(dimension, mass, speed, tilt, "" if known is None else known.source)


def _wind(plan: Plan, request: GroundRiskRequest) -> float:
    most_m_s = plan.aircraft.max_wind_m_s
    wind_m_s = request.wind_m_s
    if wind_m_s is None:
        wind_m_s = usual_wind_m_s(plan)
    if wind_m_s > most_m_s:
        raise InfeasibleError.say(
            "{} may fly in wind of up to {:g} m/s, but {:g} m/s are stated; wait for less, or take another aircraft",
            plan.aircraft.name,
            most_m_s,
            wind_m_s,
        )
    return wind_m_s


def _areas(core: Geometry, value: dict[str, float], tolerance_m: float) -> tuple[Polygon, Polygon, Polygon]:
    """Flight geography, contingency volume and buffer, each with those before it."""
    import shapely

    geography = grown(core, value["S_FG"], tolerance_m)
    stray_m = value["S_FG"] + value["S_CV"]
    # A ring narrower than the tolerance could lie inside the corners of the one before.
    contingency = shapely.union(grown(core, stray_m, tolerance_m), geography)
    return geography, contingency, shapely.union(grown(core, stray_m + value["S_GRB"], tolerance_m), contingency)


TILES = 32
"""Along the longer side of the contingency volume: each has one width of buffer."""

WIDTHS = 24
"""Heights for which the width is computed, evenly between the least and the greatest: each place takes the next."""


def _buffer_by_place(
    contingency: Polygon,
    lower: HeightField,
    top_z_m: float,
    value: dict[str, float],
    width_m: Callable[[float], float],
    arc_tolerance_m: float,
) -> tuple[Polygon, float]:
    """The buffer over terrain, and how wide it is where it is narrowest.

    Every tile of the contingency volume is grown by a width that holds every fall from it, which is never more than the
    one for the lowest ground of all, `value["S_GRB"]`; that is taken where a part of the ground is not known.

    Parameters
    ----------
    top_z_m
        Of the contingency volume, ENU z.
    width_m
        Of the buffer by the height above the ground; grows with it.
    """
    import shapely

    known = lower.z_m[np.isfinite(lower.z_m)]
    least_m = top_z_m - float(known.max(initial=-math.inf))
    low, high = np.array(contingency.bounds).reshape(2, 2)
    heights_m = np.linspace(min(max(0.0, least_m), value["H_CV"]), value["H_CV"], WIDTHS)
    widths_m = np.maximum.accumulate([width_m(float(each)) for each in heights_m])
    side_m = max(float((high - low).max()) / TILES, arc_tolerance_m)
    columns, rows = np.maximum(np.ceil((high - low) / side_m).astype(int), 1)
    x, y = (
        grid.ravel() for grid in np.meshgrid(low[0] + side_m * np.arange(columns), low[1] + side_m * np.arange(rows))
    )
    tiles = shapely.intersection(shapely.box(x, y, x + side_m, y + side_m), contingency)
    by_width: dict[int, list[Geometry]] = {}
    for tile in tiles[~shapely.is_empty(tiles)]:
        number = 0
        west_south, east_north = np.array(tile.bounds).reshape(2, 2)
        while number < WIDTHS - 1:
            below = lower.part_m(west_south - widths_m[number], east_north + widths_m[number])
            needed = WIDTHS - 1
            if np.isfinite(below).all():
                needed = int(np.searchsorted(heights_m, top_z_m - float(below.min())))
            if needed <= number:
                break
            number = min(needed, WIDTHS - 1)
        by_width.setdefault(number, []).append(tile)
    grown_tiles = [
        grown(shapely.union_all(own), float(widths_m[number]), arc_tolerance_m) for number, own in by_width.items()
    ]
    return shapely.union_all([*grown_tiles, contingency]), float(widths_m[min(by_width)])


def _terrain_quantities(
    ground: Ground, ground_z_m: float, geography: Polygon, value: dict[str, float], narrowest_m: float
) -> Iterator[Quantity]:
    """What is otherwise at places where the ground lies higher."""
    assert ground.terrain is not None
    low, high = np.array(geography.bounds).reshape(2, 2)
    below = ground.terrain.lower.part_m(low, high)
    source = say("terrain of the site")
    if np.isfinite(below).all():
        above_m = value["H_FG"] + ground_z_m - float(below.min())
        name, formula = (
            say("top of the flight geography above the ground below it"),
            "H_FG, less how much higher it lies",
        )
        yield Quantity("H_AGL", name, above_m, "m", formula, source)
    name = say("ground-risk buffer, where the ground is highest")
    yield Quantity("S_GRB-", name, narrowest_m, "m", "S_GRB, by the height at each place", source)


GROUND_ROUNDS = 50
"""Of looking for the lowest ground; two or three are usual."""


def _lowest_ground(site: Site, area: Geometry) -> tuple[float, bool]:
    """Lowest ground below the box around an area, ENU z, and whether all of it is known; the level ground else."""
    ground, (west, south, east, north) = ground_of(site), area.bounds
    if ground.terrain is None:
        return ground.level_z_m, True
    lower = ground.terrain.lower.part_m(np.array([west, south, 0.0]), np.array([east, north, 0.0]))
    known = lower[np.isfinite(lower)]
    return float(known.min()) if len(known) else ground.level_z_m, len(known) == lower.size


def _top_m(plan: Plan, site: Site, return_height_m: float | None, ground_z_m: float) -> float:
    """Highest point of paths and return above the ground."""
    highest_z = max(point[2] for sortie in plan.sorties for point in sortie.path_enu_m)
    if return_height_m is not None:
        home = plan.home_enu_m or site.home_enu_m
        highest_z = max(highest_z, home[2] + return_height_m)
    return max(0.0, highest_z - ground_z_m)


def _quantities(
    plan: Plan, request: GroundRiskRequest, body: Body, wind_m_s: float, top_m: float
) -> Iterator[Quantity]:
    """All numbers, in order; see the module for the sums."""
    pilot, maker = say("stated by the pilot"), say("profile '{}'", plan.profile)
    aircraft = plan.aircraft

    def of_body(value: float | None) -> str:
        return maker if value is None else pilot

    dimension_m, speed_m_s = body.characteristic_dimension_m, body.full_speed_m_s
    tilt_deg, climb_m_s = body.braking_tilt_deg, aircraft.max_ascent_m_s
    yield Quantity("CD", say("largest dimension"), dimension_m, "m", "", of_body(request.dimension_m))
    yield Quantity("m", say("take-off mass"), body.max_takeoff_mass_kg, "kg", "", of_body(request.mass_kg))
    yield Quantity("v", say("full speed through the air"), speed_m_s, "m/s", "", of_body(request.speed_m_s))
    if request.wind_m_s is not None:
        wind_source = pilot
    else:
        wind_source = say("of the plan") if plan.rules.wind_m_s else say("strongest that the aircraft may fly in")
    yield Quantity("w", say("wind, from any side"), wind_m_s, "m/s", "", wind_source)
    ground_m_s = speed_m_s + wind_m_s
    yield Quantity("V_0", say("full speed over the ground"), ground_m_s, "m/s", "v + w", say("downwind, full speed"))
    yield Quantity("c", say("fastest climb"), climb_m_s, "m/s", "", say("of the aircraft in the plan"))
    yield Quantity("θ", say("braking tilt"), tilt_deg, "deg", "", of_body(request.tilt_deg))
    is_usual = request.reaction_s == GroundRiskRequest().reaction_s
    yield Quantity("t_R", say("reaction"), request.reaction_s, "s", "", LBA if is_usual else pilot)
    height_m = yield from _geography(dimension_m, top_m)
    yield from _contingency_aside(request, ground_m_s, tilt_deg)
    contingency_m = yield from _contingency_above(request, ground_m_s, climb_m_s, height_m)
    yield from _buffer(request, body, wind_m_s, climb_m_s, contingency_m)
    adjacent_m = min(max(ADJACENT_S * ground_m_s, ADJACENT_LEAST_M), ADJACENT_MOST_M)
    formula = "min(35 km, max(5 km, 180 s · V_0))"
    yield Quantity("S_AA", say("adjacent area, from the contingency volume on"), adjacent_m, "m", formula, SORA)


def _geography(dimension_m: float, top_m: float) -> Generator[Quantity, None, float]:
    """Half width and top of the flight geography; the generator's value is the top."""
    half_m = 0.5 * WIDTH_IN_DIMENSIONS * dimension_m
    yield Quantity("S_FG", say("flight geography, to each side of the paths"), half_m, "m", "1.5 CD", LBA)
    yield Quantity("H_top", say("highest point of paths and return, above ground"), top_m, "m", "", say("of the plan"))
    height_m = max(WIDTH_IN_DIMENSIONS * dimension_m, top_m + half_m)
    yield Quantity("H_FG", say("top of the flight geography"), height_m, "m", "max(3 CD, H_top + 1.5 CD)", LBA)
    return height_m


def _contingency_aside(request: GroundRiskRequest, ground_m_s: float, tilt_deg: float) -> Iterator[Quantity]:
    usual, pilot = GroundRiskRequest(), say("stated by the pilot")

    def source(name: str) -> str:
        return LBA if getattr(request, name) == getattr(usual, name) else pilot

    yield Quantity("S_GPS", say("GNSS error"), request.gnss_error_m, "m", "", source("gnss_error_m"))
    yield Quantity("S_Pos", say("position hold error"), request.hold_error_m, "m", "", source("hold_error_m"))
    yield Quantity("S_K", say("map error"), request.map_error_m, "m", "", source("map_error_m"))
    reaction_m = ground_m_s * request.reaction_s
    yield Quantity("S_RZ", say("flown before the pilot acts"), reaction_m, "m", "V_0 · t_R", LBA)
    brake_m = 0.5 * ground_m_s**2 / (GRAVITY_M_S2 * math.tan(math.radians(tilt_deg)))
    yield Quantity("S_CM", say("way to brake"), brake_m, "m", "V_0² / (2 g tan θ)", LBA)
    total_m = request.gnss_error_m + request.hold_error_m + request.map_error_m + reaction_m + brake_m
    formula = "S_GPS + S_Pos + S_K + S_RZ + S_CM"
    yield Quantity("S_CV", say("contingency volume, to each side"), total_m, "m", formula, LBA)


def _contingency_above(
    request: GroundRiskRequest, ground_m_s: float, climb_m_s: float, geography_m: float
) -> Generator[Quantity, None, float]:
    """Heights; the generator's value is the top of the contingency volume."""
    error_m = BARO_ERROR_M if request.height_by == "barometer" else GNSS_HEIGHT_ERROR_M
    yield Quantity("H_baro", say("error of the height"), error_m, "m", "", LBA)
    reaction_m = max(CLIMB_SHARE * ground_m_s, climb_m_s) * request.reaction_s
    name = say("climbed before the pilot acts")
    yield Quantity("H_RZ", name, reaction_m, "m", "max(V_0 sin 45°, c) · t_R", LBA)
    momentum_m = 0.5 * ground_m_s**2 / GRAVITY_M_S2
    yield Quantity("H_CM", say("climbed by what momentum is left"), momentum_m, "m", "V_0² / (2 g)", LBA)
    top_m = geography_m + error_m + reaction_m + momentum_m
    formula = "H_FG + H_baro + H_RZ + H_CM"
    yield Quantity("H_CV", say("top of the contingency volume"), top_m, "m", formula, LBA)
    return top_m


def _buffer(
    request: GroundRiskRequest, body: Body, wind_m_s: float, climb_m_s: float, top_m: float
) -> Iterator[Quantity]:
    ours = say("sum of this program, see the guide")
    half_m, speed_m_s = 0.5 * body.characteristic_dimension_m, body.full_speed_m_s
    ground_m_s = speed_m_s + wind_m_s
    tables = ground_risk_tables()
    column = tables.column_of(body.characteristic_dimension_m, speed_m_s)
    area_m2 = tables.columns[-1 if column is None else column].frontal_area_m2
    drag_m2 = tables.drag_coefficient * area_m2
    per_m = drag_per_m(body.max_takeoff_mass_kg, drag_m2)
    fall_m = ground_m_s * fall_s(top_m, 0.0, GRAVITY_M_S2)
    more_m = max(0.0, reach_m(top_m, climb_m_s, speed_m_s, wind_m_s, per_m) - fall_m)
    slow_s = longest_fall_s(top_m, climb_m_s, speed_m_s, per_m)
    name = say("drag area when it falls, at most")
    yield Quantity("C_D A", name, drag_m2, "m²", "", tables.drag_source, is_assumed=True)
    formula = "1.225 kg/m³ · C_D A / (2 m)"
    yield Quantity("k", say("drag over the square of the speed, at most"), per_m, "1/m", formula, ours)
    formula = "(c + √(c² + 2 g H_CV)) / g, g = 9.78 m/s²"
    yield Quantity("T_0", say("fall without drag"), fall_s(top_m, climb_m_s), "s", formula, ours)
    yield Quantity("T", say("longest fall with drag"), slow_s, "s", "z(T) = H_CV", ours)
    yield Quantity("S_fall", say("fall from level flight"), fall_m, "m", "V_0 √(2 H_CV / g)", LBA)
    formula = "max over drags of min(v T_0, ln(1 + k v T) / k) + w T, less S_fall"
    yield Quantity("S_more", say("more, where it still climbs or the wind carries it"), more_m, "m", formula, ours)
    by_fall_m = fall_m + more_m + half_m
    if request.buffer == "one-to-one":
        name, formula = say("ground-risk buffer, 1:1"), "H_CV + 0.5 CD"
        yield Quantity("S_ball", say("as far as it falls"), by_fall_m, "m", "S_fall + S_more + 0.5 CD", ours)
        yield Quantity("S_GRB", name, top_m + half_m, "m", formula, LBA)
        return
    formula = "S_fall + S_more + 0.5 CD"
    yield Quantity("S_GRB", say("ground-risk buffer, to each side"), by_fall_m, "m", formula, ours)


HIGHEST_CLASS = 7
"""Above it an operation is not in the specific category (SORA 2.5, step 3)."""


def _findings(
    request: GroundRiskRequest,
    plan: Plan,
    value: dict[str, float],
    band: PeopleBand | None,
    column: int | None,
    intrinsic: int | None,
    final: int | None,
) -> Iterator[Finding]:
    """What the operator has to decide or check."""

    def found(severity: Severity, code: str, message: str) -> Finding:
        return Finding(severity, code, message)

    if band is None:
        text = say("state how many people are below; without that there is no ground risk class")
        yield found(Severity.WARNING, "sora-population", text)
    elif column is None:
        text = say("the aircraft is larger or faster than SORA's table goes; ask the authority")
        yield found(Severity.ERROR, "sora-class", text)
    elif intrinsic is None or (final is not None and final > HIGHEST_CLASS):
        text = say("beyond the specific category with these people below; fly elsewhere, or keep people out")
        yield found(Severity.ERROR, "sora-class", text)
    if value["w"] == 0.0:
        text = say("sized for calm air: any wind carries a falling aircraft beyond the buffer")
        yield found(Severity.WARNING, "sora-wind", text)
    if "S_ball" in value and value["S_ball"] > value["S_GRB"]:
        text = say(
            "1:1 is not enough: it can fall {:.1f} m far, the buffer is {:.1f} m", value["S_ball"], value["S_GRB"]
        )
        yield found(Severity.WARNING, "sora-one-to-one", text)
    if _above_place_m(value) > HIGHEST_M:
        text = say(
            "the flight geography reaches {:.1f} m above ground; above {:g} m other rules hold",
            _above_place_m(value),
            HIGHEST_M,
        )
        yield found(Severity.WARNING, "sora-height", text)
    if request.sheltering != "none":
        text = say("M1(A) needs buildings that hold the aircraft off: glass roofs and facades may not")
        yield found(Severity.WARNING, "sora-glass", text)
    if request.geography == "paths":
        text = say("a straight return home may leave the paths; set hover or land for lost links, or take the hull")
        yield found(Severity.NOTE, "sora-return", text)
    slow_m_s = min(plan.aircraft.max_speed_m_s, plan.rules.max_speed_m_s or math.inf)
    if slow_m_s < value["v"] and request.speed_m_s is None:
        text = say(
            "sized for {:g} m/s; where a mode limits it to the plan's {:g} m/s, state that as full speed",
            value["v"],
            slow_m_s,
        )
        yield found(Severity.NOTE, "sora-speed", text)


def _above_place_m(value: dict[str, float]) -> float:
    """How far the flight geography reaches above the ground below it."""
    return value.get("H_AGL", value["H_FG"])


def _ground_findings(value: dict[str, float], is_known: bool) -> Iterator[Finding]:
    """What heights count from."""
    if not is_known:
        text = say("the terrain has no heights for a part of the buffer: what lies lower there is not counted")
        yield Finding(Severity.WARNING, "sora-terrain", text)
    if "S_GRB-" not in value:
        text = say("heights count from the lowest ground in the buffer, as if all of it lay as low")
    else:
        text = say(
            "the buffer follows the terrain: {:.1f} m where the ground is highest, {:.1f} m where it is lowest; other "
            "heights count from the lowest ground in it",
            value["S_GRB-"],
            value["S_GRB"],
        )
    yield Finding(Severity.NOTE, "sora-ground", text)


def raster_text(people: People) -> str:
    """A raster by its file and product, and what its values count."""
    counted = say("people in a cell") if people.counts == "cell" else say("people per square kilometre")
    by = say("as stated") if people.is_stated else say("as its name says")
    return say("'{}' ({}{}, {})", people.file, f"{people.product}, " if people.product else "", counted, by)


def _grid_quantities(above_m: float) -> Iterator[Quantity]:
    """Cells that SORA suggests for people below, by the flight height above terrain; none above its first rows."""
    tables = ground_risk_tables()
    side_m = next((row.side_m for row in tables.grids if above_m <= row.height_m), None)
    if side_m is not None:
        yield Quantity("L_grid", say("cells of people that SORA suggests"), side_m, "m", "by H_AGL", tables.grid_source)


def _people_quantities(people: People) -> Iterator[Quantity]:
    source = say("raster {}, cells of {:.0f} m", raster_text(people), people.cell_m)
    if people.most_per_km2 is not None and people.mean_per_km2 is not None:
        yield Quantity("D_max", say("most people in a cell below the buffer"), people.most_per_km2, "/km²", "", source)
        yield Quantity("D_mean", say("people below the buffer, in the mean"), people.mean_per_km2, "/km²", "", source)
    yield Quantity(
        "D_?", say("part of the buffer of which the raster knows nothing"), 100.0 * people.unknown, "%", "", source
    )


GRID_SLACK = 1.25
"""Cells of 3 or 9 arc seconds are as wide as named at some latitude only."""

MOST_PER_KM2 = 1e6
"""No place has more residents: the densest blocks of Hong Kong and Dhaka have some 200 000."""


def _people_findings(people: People, stated: str | None, buffer: Polygon, value: dict[str, float]) -> Iterator[Finding]:
    """What a raster says, against what was stated; what it does not know is not nobody."""
    code, most = "sora-raster", people.most_per_km2
    if people.unknown > 0.0:
        text = say(
            "of {:.0f} % of the buffer the raster has no number, which does not mean nobody: state how many people "
            "are below",
            max(1.0, 100.0 * people.unknown),
        )
        yield Finding(Severity.WARNING, code, text, people.file, 100.0 * people.unknown, 0.0, "%")
    if most is None or people.mean_per_km2 is None:
        return
    if most > MOST_PER_KM2:
        text = say("{:.3g} people per square kilometre live nowhere: does it count people per km² or in a cell?", most)
        yield Finding(Severity.ERROR, code, text, people.file, most, MOST_PER_KM2, "/km²")
    word = band_of(f"{most}").word
    if stated is None:
        text = say(
            "people are those of the raster: {:.0f} per square kilometre in its fullest cell ('{}'), {:.0f} in the "
            "mean; it counts who lives there, so state more where people work, shop or gather",
            most,
            word,
            people.mean_per_km2,
        )
        yield Finding(Severity.NOTE, code, text, people.file, most, None, "/km²")
    elif stated == "controlled":
        text = say(
            "the raster has {:.0f} people per square kilometre in its fullest cell: see that all of them stay out", most
        )
        yield Finding(Severity.NOTE, code, text, people.file, most, None, "/km²")
    elif most >= (band := band_of(stated)).below_per_km2:
        text = say(
            "the raster has {:.0f} people per square kilometre in its fullest cell ('{}'), more than the '{}' stated",
            most,
            word,
            stated,
        )
        yield Finding(Severity.WARNING, code, text, people.file, most, band.below_per_km2, "/km²")
    else:
        text = say("the raster has no more people than stated: {:.0f} per square kilometre in its fullest cell", most)
        yield Finding(Severity.OK, code, text, people.file, most, band.below_per_km2, "/km²")
    for grid in _grid_quantities(_above_place_m(value)):
        if people.cell_m > GRID_SLACK * grid.value:
            text = say(
                "cells of {:.0f} m are coarser than the {:.0f} m that SORA suggests up to this height; crowds in them "
                "are evened out",
                people.cell_m,
                grid.value,
            )
            yield Finding(Severity.NOTE, code, text, people.file, people.cell_m, grid.value, "m")
    if people.cell_m**2 > buffer.area:
        text = say(
            "a cell of the raster ({:.0f} m) is larger than the whole buffer, and evens out crowds in it", people.cell_m
        )
        yield Finding(Severity.NOTE, code, text, people.file)


def _zone_findings(site: Site, contingency: Polygon, buffer: Polygon) -> Iterator[Finding]:
    """No-fly zones of the site that the volumes reach into."""
    import shapely

    for zone in site.airspace.no_fly:
        area = shapely.polygons(zone.polygon_enu_m)
        if shapely.intersects(area, contingency):
            text = say("the contingency volume reaches into the no-fly zone '{}'", zone.id)
            yield Finding(Severity.WARNING, "sora-no-fly", text, zone.id)
        elif shapely.intersects(area, buffer):
            text = say("the ground-risk buffer reaches into the no-fly zone '{}'", zone.id)
            yield Finding(Severity.NOTE, "sora-no-fly", text, zone.id)


def source_texts(risk: GroundRisk) -> tuple[str, ...]:
    """Where the numbers are from, in full."""
    own = (say("profile: {}", risk.body.source),) if risk.body.source else ()
    text = say(
        "formulas were taken from public implementations that agree, and give the distances that German authorities "
        "publish (STS-BOS 1.0, tables 1 and 2); classes, mitigations and cells of people are those of AMC1 Article 11, "
        "tables 1, 4 and 5; compare them with the documents"
    )
    return (*DOCUMENTS, text, *own)


OUT_OF_SCOPE = (
    say("air risk class (ARC) and SAIL"),
    say("tactical mitigations and safety objectives (OSO)"),
    say("containment, and people in the adjacent area"),
)
"""Steps of SORA that nothing here says anything of."""


def scope_text() -> str:
    """What is not assessed, in one line."""
    return say("not assessed: {}", joined("; ", OUT_OF_SCOPE))

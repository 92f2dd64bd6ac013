"""Where verdicts change: for each claim the exact number at which it is lost, found by halving.

A verifier with another slack, sign or constant loses its claims elsewhere, by the last digits at least. That tells
mutants apart which tampered files seldom reach.
"""

from __future__ import annotations

import copy
import itertools
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from random import Random
from types import ModuleType
from typing import Any

from tests.planning.proof.verifiers import PLAN, PROOF, SITE

MOST_HALVINGS = 100
"""A border at zero is not looked for to its last digit."""

Verdict = Callable[[float], object]

Vec = tuple[float, ...]


def border(verdict: Verdict, low: float, high: float) -> tuple[object, object, float]:
    """Verdicts at both ends, and the last number with the first of them."""
    first, last = verdict(low), verdict(high)
    if first == last:
        return first, last, low
    for _ in range(MOST_HALVINGS):
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        if verdict(middle) == first:
            low = middle
        else:
            high = middle
    return first, last, low


class Probe:
    """The hut in one verifier, or in a mutant of it."""

    def __init__(self, module: ModuleType, folder: Path) -> None:
        self.module, self.folder = module, folder
        self.site, self.plan, self.proof = (json.loads((folder / name).read_bytes()) for name in (SITE, PLAN, PROOF))

    def case(self, **changed: Any) -> Any:
        """The case, with other records in place of `site`, `plan` or `proof`."""
        records = [changed.get(name, getattr(self, name)) for name in ("site", "plan", "proof")]
        return self.module.Case(self.folder, [json.dumps(each).encode() for each in records])

    def said(self, prove: Callable[[], Any]) -> object:
        """What becomes of a question: an answer, a verdict, or an error."""
        try:
            found = prove()
        except self.module.Refused as refused:
            return refused.verdict
        except Exception as error:  # which error it is, is the answer
            return type(error).__name__
        return "proved" if isinstance(found, str) else found

    def refusal(self, prove: Callable[[], Any]) -> str:
        """The words with which a question is refused, or the error in which it ends."""
        try:
            prove()
        except self.module.Refused as refused:
            return str(refused)
        except Exception as error:  # which error it is, is the answer
            return type(error).__name__
        return ""

    def with_number(self, name: str, path: Sequence[Any], value: Any) -> dict[str, Any]:
        """One of the three records with another number at a place."""
        record = copy.deepcopy(getattr(self, name))
        parent = record
        for key in path[:-1]:
            parent = parent[key]
        parent[path[-1]] = value
        return {name: record}


Section = Callable[[Probe], Iterator[Any]]


def _of_paths(probe: Probe) -> Iterator[Any]:
    """Paths that begin, end or pass beside where they should."""
    module = probe.module
    for axis in range(3):
        moved = [0.0, 0.0, 0.0]

        def same(x: float, axis: int = axis, moved: list[float] = moved) -> bool:
            moved[axis] = x
            return bool(module.is_same(tuple(moved), (0.0, 0.0, 0.0)))

        yield border(same, 0.0, 1.0)
        yield border(same, 0.0, -1.0)
    case = probe.case()
    for vertex, axis in [(v, a) for v in (0, 1, -2, -1, 2, 3) for a in range(3)]:
        kept = case.paths[0][vertex]

        def path(x: float, vertex: int = vertex, axis: int = axis, kept: Any = kept) -> object:
            case.paths[0][vertex] = (*kept[:axis], kept[axis] + x, *kept[axis + 1 :])
            return probe.said(case.sorties_), probe.said(lambda: case.photos_of(0))

        yield border(path, 0.0, 20.0)
        yield border(path, 0.0, -20.0)
        case.paths[0][vertex] = kept


def _of_limits(probe: Probe) -> Iterator[Any]:
    """Distances, the airspace, the ground, and the return."""
    case = probe.case()
    for name in ("near_m",):
        kept = getattr(case, name)
        yield border(lambda x, name=name: setattr(case, name, x) or probe.said(case.distance), 0.01, 12.0)
        setattr(case, name, kept)
    for name, sign in (("low", 1.0), ("high", -1.0)):
        for axis in range(3):
            kept = getattr(case, name)

            def box(x: float, name: str = name, axis: int = axis, kept: Any = kept) -> object:
                setattr(case, name, (*kept[:axis], kept[axis] + x, *kept[axis + 1 :]))
                return probe.said(case.airspace)

            yield border(box, 0.0, sign * 40.0)
            # Where it is false, and no more in doubt.
            lost = border(box, 0.0, sign * 40.0)[2]
            yield box(lost + sign * 1e-7), box(lost + sign * 1.9e-7), box(lost + sign * 2.5e-7), box(lost + sign * 4e-7)
            setattr(case, name, kept)
    legs = list(case.legs)
    for low in (-30.0, 3.0):
        case.low = (*case.low[:2], low)
        for k in (0, len(legs) - 1):
            s, n, a, b = legs[k]

            def sunk(x: float, k: int = k, leg: Any = (s, n, a, b)) -> object:
                case.legs = [*legs[:k], (leg[0], leg[1], *((*p[:2], p[2] + x) for p in leg[2:])), *legs[k + 1 :]]
                return probe.said(case.airspace)

            yield border(sunk, 0.0, -40.0)
    case = probe.case()
    for key, ranges in {
        "return_kept_m": ((3.0, 0.0), (3.0, 9.0)),
        "return_height_m": ((18.0, 90.0), (18.0, -1.0)),
    }.items():
        for low, high in ranges:
            yield border(lambda x, key=key: case.proof.update({key: x}) or probe.said(case.return_), low, high)
        case.proof[key] = probe.proof[key]
    yield border(lambda x: probe.said(lambda: case.return_(x)), 18.0, 90.0)
    yield border(lambda x: probe.said(lambda: case.return_(x)), 18.0, 0.0)
    for axis in range(3):
        ends = case.proof["outside"][-1]
        kept_end = ends[axis]
        for far in (-200.0, 200.0):
            yield border(
                lambda x, axis=axis, ends=ends: (
                    ends.__setitem__(axis, x) or probe.said(lambda: case._leaves(case.solids))
                ),
                kept_end,
                far,
            )
        ends[axis] = kept_end
    yield from _of_volumes(probe)


def _of_volumes(probe: Probe) -> Iterator[Any]:
    """No-fly volumes that come nearer, and triangles of every kind of place."""
    random, module, case = Random(3), probe.module, probe.case()
    for s, k, a, b in case.legs:
        by = [case.directions[int(n)] for n in probe.proof["legs"][s][k]]
        yield border(lambda gap, a=a, b=b, by=by: case.solids.clear([a, b], by, gap), 0.0, 50.0)
        beside = [case.directions[int(n)] for n in probe.proof["no_fly"][s][k]]
        yield border(lambda gap, a=a, b=b, by=beside: case.no_fly.clear([a, b], by, gap), 0.0, 50.0)
    for height in (3e-4, 4.99e-4, 5.01e-4, 6e-4, 9e-4, 1.1e-3, 1.5e-3):
        for a, b, c in itertools.permutations([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.5, height, 0.0)]):
            yield module.distance((0.5, height / 3.0, 0.0), (a, b, c)), module.distance((0.4, 0.0, 1.0), (a, b, c))
    shapes = [[tuple(random.uniform(-9.0, 9.0) for _ in range(3)) for _ in range(3)] for _ in range(12)]
    for shape in (*shapes, [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1e-4, 0.0)], [(0.0, 0.0, 0.0)] * 3):
        for _ in range(4):
            p = tuple(random.uniform(-9.0, 9.0) for _ in range(3))
            yield module.distance(p, tuple(shape)), module.distance((p[0], p[1], 0.0), tuple(shape))


AIRCRAFT: tuple[Mapping[str, Any], ...] = (
    {},
    {"max_jerk_m_s3": None},
    {"max_jerk_m_s3": 0.05, "max_acceleration_m_s2": 6.0},
    {"max_yaw_rate_deg_s": 2.0, "max_gimbal_rate_deg_s": 90.0},
    {"max_yaw_rate_deg_s": 90.0, "max_gimbal_rate_deg_s": 1.0},
    {"max_ascent_m_s": 0.3, "max_descent_m_s": 0.2, "min_photo_interval_s": 9.0},
    {"max_speed_m_s": 1.0, "max_wind_m_s": 5.0},
)
RULES: tuple[Mapping[str, Any], ...] = (
    {},
    {"wind_m_s": 0.5, "max_speed_m_s": 2.0, "settle_s": 4.0, "photo_s": 0.25},
    {"battery_reserve": 0.4, "takeoff_landing_s": 11.0, "max_speed_m_s": 0.25},
)


def _of_batteries(probe: Probe) -> Iterator[Any]:
    """How long a battery has to last, for aircraft and rules of all kinds, and with what is usual left out."""
    case = probe.case()
    for aircraft in AIRCRAFT:
        for rules in RULES:
            case.plan = {**probe.plan, "aircraft": {**probe.plan["aircraft"], **aircraft}}
            case.plan["rules"] = {**probe.plan["rules"], **rules}
            yield _endurance(probe, case)
    for record in ("aircraft", "rules"):
        for name in probe.plan[record]:
            case.plan = {**probe.plan, record: {key: x for key, x in probe.plan[record].items() if key != name}}
            case.plan = json.loads(json.dumps(case.plan), parse_int=float)
            yield name, _endurance(probe, case)
    case.plan = json.loads(json.dumps(probe.plan), parse_int=float)
    case.sorties[0]["duration_s"] = 1.0
    yield border(lambda x: case.sorties[0].update(duration_s=x) or probe.said(case.battery), 1.0, 1e5)
    for k in range(len(case.views)):
        view = case.views[k]
        for heading, pitch in ((179.0, 0.0), (-179.0, -90.0), (0.0, 35.0)):
            case.by_id = {**{each[0]: each for each in case.views}, view[0]: (*view[:2], heading, pitch)}
            yield _endurance(probe, case)


def _endurance(probe: Probe, case: Any) -> object:
    case.plan = json.loads(json.dumps(case.plan), parse_int=float)
    case.sorties[0]["duration_s"] = 0.0

    def lasts(x: float) -> object:
        case.plan["aircraft"]["endurance_s"] = x
        return probe.said(case.battery)

    proved = border(lambda x: lasts(x) == "proved", 0.0, 1e5)
    return proved, border(lambda x: lasts(x) == "false", 0.0, 1e5)


def _of_level_ground(probe: Probe) -> Iterator[Any]:
    """What counts as the ground where the proof says that the terrain is level, and how level it must be."""
    import base64
    import struct
    import zlib

    heights = [(-300, 0, 200, 450)[k % 4] for k in range(144)]
    text = base64.b64encode(zlib.compress(struct.pack("<144i", *heights))).decode()
    grid = {"west_south_m": [-29.0, -29.0], "step_m": 5.0, "columns": 12, "rows": 12, "accuracy_m": 0.01}

    def case(within: float | None, ground_z_m: float = 0.0, use: str = "auto", west_m: float = -29.0) -> Any:
        """A case whose airspace, paths and boxes are above that terrain."""
        site, proof = copy.deepcopy(probe.site), {**probe.proof, "level_within_m": within}
        site["airspace"]["ground_z_m"] = ground_z_m
        site["terrain"] = {**grid, "upper": text, "use": use, "west_south_m": [west_m, -29.0]}
        return probe.case(site=site, proof=proof)

    for use in ("auto", "on", "off"):
        for within in (None, 0.3, 0.5, 0.6):
            yield probe.said(lambda u=use, w=within: (case(w, use=u).terrain is None, case(w, use=u).low))
            yield probe.said(lambda u=use, w=within: (case(w, use=u).ground, case(w, use=u).airspace()))
    for low, high in ((0.0, 0.505), (0.505, 0.6)):
        yield border(lambda w: probe.said(lambda: case(w).terrain is None), low, high)
    for far in (-1.0, 1.0):
        yield border(lambda z: probe.said(lambda: case(0.5, ground_z_m=z).terrain is None), 0.0, far)
    yield border(lambda west: probe.said(lambda: case(0.5, west_m=west).terrain is None), -29.0, 0.0)
    above, level = case(None), case(0.5)

    def kept(height: float) -> object:
        above.height_m = height
        return probe.said(above.airspace)

    yield border(kept, 4.0, 9.0)
    above.height_m, ceiling = level.height_m, max(p[2] for path in above.paths for p in path)
    above.high = (*above.high[:2], ceiling)
    yield probe.said(above.airspace)
    shown = case(None)
    shown.proof["boxes"], shown.plan["coverage"]["reachable_upper_bound"] = [], float(len(shown.panes) * shown.n)
    for shown.height_m in (5.0, 8.0, 11.0, 14.0):  # fewer and fewer places that are shown are high enough
        yield probe.said(lambda: (shown.reachable(),))
    for each in (above, level):
        each.low, each.high = (-20.0, -20.0, 3.0), (18.0, 16.0, 25.0)

        def excluded(top: float, of: Any = each) -> object:
            of.high = (*of.high[:2], top)
            return probe.said(lambda: of._exclude(0, "t"))

        yield border(excluded, 3.1, 9.0)


def _of_terrain(probe: Probe) -> Iterator[Any]:
    """Heights above a rough ground."""
    import base64
    import struct
    import zlib

    random, module = Random(5), probe.module
    heights = [random.randint(-9000, 9000) for _ in range(20)]

    def record(packed: bytes, **facts: Any) -> dict[str, Any]:
        text = base64.b64encode(packed).decode()
        found = {
            "west_south_m": [-3.0, 2.0],
            "step_m": 2.5,
            "columns": 5.0,
            "rows": 4.0,
            "upper": text,
            "accuracy_m": 0.5,
        }
        return {**found, **facts}

    packed = zlib.compress(struct.pack("<20i", *heights))
    terrain = module.Terrain(record(packed))
    yield terrain.z
    legs = [
        [(random.uniform(-3.0, 7.0), random.uniform(2.0, 9.5), random.uniform(0.0, 20.0)) for _ in range(2)]
        for _ in range(30)
    ]
    legs += [
        [(-3.0, 2.0, 9.0), (7.0, 9.5, 9.0)],
        [(-3.0, 2.0, 9.0), (7.0, 2.0, 3.0)],
        [(1.0, 4.0, 9.0), (1.0, 4.0, 3.0)],
    ]
    legs += [[(7.0, 2.0, 9.0), (7.0, 9.5, 3.0)], [(-3.0, 9.5, 9.0), (7.0, 9.5, 3.0)]]
    for a, b in legs:
        yield terrain.clearance(a, b)
        yield terrain.nodes(
            [min(p, q) for p, q in zip(a, b, strict=True)], [max(p, q) for p, q in zip(a, b, strict=True)]
        )
    for low, high in (
        ((-3.1, 2.0), (7.0, 9.5)),
        ((-3.0, 1.9), (7.0, 9.5)),
        ((-3.0, 2.0), (7.1, 9.6)),
        ((9.0, 9.0),) * 2,
    ):
        yield terrain.nodes(low, high)
    for axis, far in [(axis, far) for axis in range(2) for far in (-50.0, 50.0)]:
        a = (1.0, 4.0, 9.0)

        def leaves(x: float, axis: int = axis, a: Any = a) -> bool:
            return probe.said(lambda: terrain.clearance(a, (*a[:axis], a[axis] + x, *a[axis + 1 :]))) == "not proved"

        yield border(leaves, 0.0, far)
    spoilt = record(packed)
    spoilt["upper"] = f"{spoilt['upper'][:8]}!{spoilt['upper'][8:]}"
    yield probe.said(lambda: module.Terrain(spoilt).z)
    unknown = zlib.compress(struct.pack("<20i", *heights[:19], -(2**31)))
    few = zlib.compress(struct.pack("<4i", *heights[:4]))
    for packed_again, facts in (
        (unknown, {}),
        (zlib.compress(struct.pack("<20i", *heights[:19], -(2**31) + 1)), {}),
        (packed[:-1], {}),
        (packed, {"rows": 3.0}),
        (packed, {"rows": 1.0, "columns": 20.0}),
        (packed, {"columns": 1.0, "rows": 20.0}),
        (packed, {"columns": 99_999.0}),
        (packed, {"columns": 100_000.0}),
        (zlib.compress(bytes(16_399_836)), {"columns": 99_999.0, "rows": 41.0}),
        (few, {"columns": 2.0, "rows": 2.0}),
        *((packed, {"step_m": step}) for step in (0.01, 0.0099, 1e4, 10000.5)),
        *((packed, {"accuracy_m": value}) for value in (0.0, -1e-9, 1e4, 10000.5)),
    ):
        again = record(packed_again, **facts)
        yield probe.refusal(lambda r=again: module.Terrain(r))
        yield facts, probe.said(lambda r=again: module.Terrain(r).z), probe.said(lambda r=again: module.Terrain(r).size)


LIMITED: tuple[tuple[str, tuple[Any, ...], tuple[float, ...]], ...] = (
    ("plan", ("constraints", "min_distance_m"), (0.01, 1e4)),
    ("plan", ("constraints", "max_distance_m"), (0.01, 1e5)),
    ("plan", ("constraints", "section_step_deg"), (0.9, 1.0, 90.0)),
    ("plan", ("constraints", "min_height_above_ground_m"), (0.0, 20.0, 22.0)),
    ("plan", ("camera", "focal_length_mm"), (0.01, 0.0865, 1e6)),
    ("plan", ("camera", "sensor_width_mm"), (0.01, 2458.0, 1e6)),
    ("plan", ("camera", "sensor_height_mm"), (0.01, 2458.0)),
    ("plan", ("camera", "gimbal_pitch_deg", 0), (-180.0, 35.0)),
    ("plan", ("camera", "gimbal_pitch_deg", 1), (-90.0, 180.0)),
    ("plan", ("viewpoints", 0, "heading_deg"), (-360.0, 360.0)),
    ("plan", ("viewpoints", 0, "position_enu_m", 0), (-1e5, 1e5)),
    ("plan", ("rules", "at_once"), (1.0,)),
    *(
        ("plan", ("aircraft", name), (0.01, 1e6))
        for name in ("max_ascent_m_s", "max_descent_m_s", "max_yaw_rate_deg_s")
    ),
    *(("plan", ("aircraft", name), (0.01, 1e6)) for name in ("max_gimbal_rate_deg_s", "max_wind_m_s", "max_speed_m_s")),
    *(("plan", ("aircraft", name), (0.01, 1e6)) for name in ("max_acceleration_m_s2", "max_jerk_m_s3")),
    *(("plan", ("rules", name), (0.0, 1.0, 12.0, 15.0)) for name in ("wind_m_s", "settle_s", "photo_s")),
    *(
        ("plan", ("rules", name), (0.0, 0.01, 1.0))
        for name in ("battery_reserve", "takeoff_landing_s", "max_speed_m_s")
    ),
    *(("site", ("airspace", "min_enu_m", axis), (-1e5, 25.0, 20.0, 18.0)) for axis in range(3)),
    *(("site", ("airspace", "no_fly", 0, name), (-1e6, 1e6)) for name in ("floor_m", "ceiling_m")),
    ("site", ("origin", "lat_deg"), (-90.0, 90.0)),
    ("site", ("origin", "lon_deg"), (-360.0, 360.0)),
    ("site", ("origin", "ellipsoid_height_m"), (-1e4, 1e4)),
    *(("proof", ("directions", 0, axis), (-1.0, 1.0)) for axis in range(3)),
    ("proof", ("seen", 0), (-1.0, 0.0, 3.0)),
)
"""Fields, and the limits of what is taken from them."""

STEP = ("constraints", "section_step_deg")

REPLACED: tuple[tuple[str, tuple[Any, ...]], ...] = (
    *(("site", (name,)) for name in ("format", "origin", "facades", "building_mesh", "obstacles", "airspace")),
    *(("site", (name,)) for name in ("home_enu_m", "terrain", "zones")),
    *(("site", ("airspace", name)) for name in ("no_fly", "min_enu_m", "ground_z_m")),
    *(("plan", (name,)) for name in ("format", "camera", "constraints", "viewpoints", "sorties", "aircraft", "rules")),
    *(("plan", (name,)) for name in ("origin", "home_enu_m", "coverage", "site_sha256")),
    *(("plan", ("constraints", name)) for name in ("occlusion", "whole_panel", "max_distance_m")),
    *(("plan", ("sorties", 0, name)) for name in ("viewpoint_ids", "path_enu_m", "in_passing_ids", "start_s")),
    *(("proof", (name,)) for name in ("format", "directions", "legs", "no_fly", "returns", "outside", "meshes")),
    *(("proof", (name,)) for name in ("seen", "sights", "boxes", "witnesses", "patches", "outside_directions")),
    *(("proof", (name,)) for name in ("site", "plan", "return_height_m", "return_kept_m", "level_within_m")),
)
"""Parts that are left out, or something else than they should be."""

ODD: tuple[Any, ...] = (None, [], {}, "", [{}], 0.0)


def beside(limit: float) -> tuple[float, float, float]:
    """A limit, and numbers right above and below it."""
    return limit, limit * (1.0 + 1e-9) + 1e-12, limit * (1.0 - 1e-9) - 1e-12


def changed_parts() -> Iterator[tuple[str, tuple[Any, ...], Any]]:
    """Records, places in them and what is put there: numbers at their limits, odd parts, bodies of all kinds."""
    for name, path, limits in LIMITED:
        yield from ((name, path, value) for limit in limits for value in beside(limit))
    yield from ((name, path, odd) for name, path in REPLACED for odd in ODD)
    yield from (("site", ("obstacles",), [{"id": "it", **body}]) for body in BODIES)


def _of_numbers(probe: Probe) -> Iterator[Any]:
    """What is said of numbers at their limits, and right beside them."""
    claims = ("sorties_", "gimbal", "airspace", "battery", "apart", "coverage")
    for name, path, limits in LIMITED:
        for limit in limits:
            for value in beside(limit):
                changed = probe.with_number(name, path, value)
                found = probe.said(lambda changed=changed: probe.case(**changed))
                asked = [] if isinstance(found, str) else [probe.said(getattr(found, claim)) for claim in claims]
                shown = (
                    [] if isinstance(found, str) else [getattr(found, each) for each in ("near_m", "far_m", "low", "n")]
                )
                yield name, path, value, found if isinstance(found, str) else "read", asked, shown
    of_plan, of_site = ("constraints", "min_height_above_ground_m"), ("airspace", "min_height_above_ground_m")
    for heights in (
        (None, None),
        (6.0, None),
        (None, 7.0),
        (6.0, 7.0),
        (0.0, None),
        (None, 0.0),
        (-1.0, None),
        (None, -1.0),
    ):
        changed = probe.with_number("plan", of_plan, heights[0]) | probe.with_number("site", of_site, heights[1])
        yield probe.said(lambda changed=changed: probe.case(**changed).low)
    for focal_mm in beside(0.01):
        small = {"focal_length_mm": focal_mm, "sensor_width_mm": 0.1, "sensor_height_mm": 0.1}
        plan = {**probe.plan, "camera": {**probe.plan["camera"], **small}}
        yield probe.said(lambda plan=plan: probe.case(plan=plan).half)
    for whole in (30.0, 45.0):  # divisors of 90 degrees, and how far a step may be off
        for high in (whole - 1.0, whole + 1.0):
            yield border(
                lambda step: probe.said(lambda: probe.case(**probe.with_number("plan", STEP, step)).n), whole, high
            )
    for k, (name, path) in enumerate(REPLACED):
        for odd in (None, ODD[1 + k % (len(ODD) - 1)]):
            changed = probe.with_number(name, path, odd)
            found = probe.said(lambda changed=changed: probe.case(**changed))
            claimed = (
                [found] if isinstance(found, str) else [probe.said(partial(c, found)) for _, c in probe.module.CLAIMS]
            )
            yield path, odd, claimed


BODIES: tuple[Mapping[str, Any], ...] = (
    {"mesh": "shop.ply"},
    {"mesh": "shop.ply", "box_enu_m": [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]]},
    {"mesh": "shop.ply", "box_enu_m": []},
    *({"box_enu_m": [[float(k)] * 3 for k in range(n)]} for n in range(4)),
    *({"mesh": name} for name in ("../0/shop.ply", "./shop.ply", "shop..ply", "/shop.ply", "C:shop.ply", "", "x.ply")),
    *({"mesh": name} for name in ("a\\shop.ply", "shop.ply\n", "shop.ply/", ".", "..", "a/../shop.ply")),
    {"box_enu_m": [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]], "mesh ": "shop.ply"},
)


def _of_bodies(probe: Probe) -> Iterator[Any]:
    """What counts as an obstacle, and which files of meshes are opened."""
    for body in BODIES:
        site = copy.deepcopy(probe.site)
        site["obstacles"] = [{"id": "it", **body}]
        yield probe.said(lambda site=site: len(probe.case(site=site).solids.triangles))
        yield probe.refusal(lambda site=site: probe.case(site=site))
    for n in (3, 5):
        site = copy.deepcopy(probe.site)
        corners = site["facades"][0]["panels"][0]["corners_enu_m"]
        site["facades"][0]["panels"][0]["corners_enu_m"] = (2 * corners)[:n]
        yield probe.said(lambda site=site: len(probe.case(site=site).panes))


def _of_sorties(probe: Probe) -> Iterator[Any]:
    """Paths with views at home, at places that are passed twice, and at vertices that share photos."""
    home, up, beside = (0.0, 0.0, 0.0), (0.0, 0.0, 5.0), (3.0, 0.0, 5.0)
    low, least = (0.0, 0.0, 1.99), (0.0, 0.0, 1.999)
    flights: tuple[tuple[Sequence[Vec], Sequence[Vec]], ...] = (
        *(((home, top, home), (top,)) for top in (up, low, least)),
        *(((home, up, home), views) for views in ((home,), (home, home), (home, up), (up, home), (up, up))),
        *(((home, up, beside, up, home), views) for views in ((up,), (up, beside), (beside, up), (up, beside, up))),
        *(((home, up, beside, up, home), views) for views in ((beside, beside), (up, up), (up, up, up), ())),
        *(((home, up, up, beside, beside, up, home), views) for views in ((up, up, beside), (beside, up, up))),
        *((path, (up,)) for path in ((home, up), (home,), (home, home, home), (home, up, up), (up, up, home))),
        *((path, (up,)) for path in ((home, beside, up, home), (home, up, beside, home))),
    )
    case = probe.case()
    case.home = home
    case.plan = {key: value for key, value in probe.plan.items() if key not in ("home_enu_m", "origin")}
    for path, views in flights:
        case.paths, case.views = [list(path)], [(f"v{k}", view, 0.0, 0.0) for k, view in enumerate(views)]
        case.by_id = {view[0]: view for view in case.views}
        for names in ([view[0] for view in case.views], ["v9"]):
            case.sorties, case.flown = [{}], [names]
            yield probe.said(case.sorties_), probe.said(lambda: case.photos_of(0))
    case.sorties, case.flown = [{}, {}], [["v0"], ["v1"]]
    case.paths, case.views = [[home, up, home], [home, low, home]], [("v0", up, 0.0, 0.0), ("v1", low, 0.0, 0.0)]
    case.by_id = {view[0]: view for view in case.views}
    yield probe.said(case.sorties_), probe.said(lambda: case.photos_of(1))


def _of_files(probe: Probe) -> Iterator[Any]:
    """Hashes that are right, wrong, missing, or of other files."""
    import hashlib

    def named(**changed: Any) -> object:
        """What is said of files whose hashes are right but for what is changed."""
        plan, proof = copy.deepcopy(probe.plan), copy.deepcopy(probe.proof)
        plan["site_sha256"] = changed.get("of_site", hashlib.sha256(json.dumps(probe.site).encode()).hexdigest())
        for name, record in (("site", probe.site), ("plan", plan)):
            proof[name]["sha256"] = changed.get(name, hashlib.sha256(json.dumps(record).encode()).hexdigest())
        proof["meshes"] = changed.get("meshes", proof["meshes"])
        return probe.said(probe.case(plan=plan, proof=proof).files)

    mesh = probe.proof["meshes"][0]
    yield named(), named(of_site="0" * 64), named(site="0" * 64), named(plan="0" * 64)
    yield named(meshes=[]), named(meshes=[mesh, {**mesh, "name": "other.ply"}]), named(meshes=[mesh, mesh])
    yield named(meshes=[{**mesh, "sha256": "0" * 64}]), named(meshes=[{**mesh, "name": "other.ply"}])


def _of_ties(probe: Probe) -> Iterator[Any]:
    """Comparisons with both sides the same, and what is false where something else is merely not proved."""
    case = probe.case()
    case.low, case.high, case.home = (-10.0, -10.0, 0.0), (10.0, 10.0, 10.0), (0.0, 0.0, 0.0)
    for low in (1e-7, 0.99e-7, 0.0, -1e-7, -1.01e-7, -0.001, -1e5, -999999.9999999, -1000000.5, -1.5e6):
        for high in (10.0, 10.1):
            for x in (5.0, 0.0, -10.0, 10.0, 10.1):
                case.legs = [(0, 0, (x, 0.0, low), (x, 0.0, high))]
                yield probe.said(case.airspace)
    case = probe.case()
    case.plan["rules"] = {**case.plan["rules"], "battery_reserve": 0.0}
    for stated, yaw in itertools.product((100.0, 100.01, 100.02), (60.0, 0.1)):
        case.plan["aircraft"] = {**case.plan["aircraft"], "endurance_s": 100.0, "max_yaw_rate_deg_s": yaw}
        case.sorties[0]["duration_s"] = stated
        yield probe.said(case.battery)
    path = list(case.paths[0])
    for k, beside in itertools.product(range(len(path)), (0.0, 0.5)):
        case.paths = [[*path[: k + 1], (path[k][0] + beside, *path[k][1:]), *path[k:]]]
        yield _endurance(probe, case)
    case.paths, near_m = [path], case.near_m
    yield border(lambda x: setattr(case, "near_m", x) or probe.said(case.distance) == "false", 4.5, 8.0)
    case.near_m = near_m
    for direction, reached in (((1.0, 0.0, 0.0), 1.0), ((1.0000000000000002, 0.0, 0.0), 1.0), ((0.6, 0.8, 0.0), 0.5)):
        record = probe.with_number("proof", ("directions", 0), list(direction))
        yield reached, probe.said(lambda record=record: probe.case(**record).directions[0])
    solids = probe.module.Solids([((4.0, 0.0, 0.0), (4.0, 1.0, 0.0), (4.0, 0.0, 1.0))])
    point, by = (5.0, 0.0, 0.0), (0.5, 0.0, 0.0)
    yield [solids.clear([point], [by], gap - 1e-7) for gap in (0.5, 0.4999999, 0.5000001)]
    level = probe.module.Solids([((0.5 * (2.5 - 1e-7) * 2.0, 0.0, 0.0),) * 3])
    yield level.clear([(5.0 - 0.0, 0.0, 0.0)], [by], 0.0), level.clear([point], [by], 1e-9)


def _of_ways_outside(probe: Probe) -> Iterator[Any]:
    """Where a way from home must end: beyond the bounds of all triangles, home itself within them."""
    case, home = probe.case(), (5.0, 5.0, 5.0)
    solids = probe.module.Solids([((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)), ((9.0, 9.0, 9.0),) * 3])
    axes = [tuple(0.9 * sign * (axis == k) for k in range(3)) for axis in range(3) for sign in (-1.0, 1.0)]
    slanted = [(a, b, c) for a in (-0.5, 0.5) for b in (-0.5, 0.5) for c in (-0.5, 0.5)]
    case.directions, by = [*axes, *slanted], [float(k) for k in range(14)]
    case.home, case.paths = home, [[home, home]]

    def leaves(*way: Sequence[float], n_directions: int | None = None) -> object:
        n = len(way) - 1 if n_directions is None else n_directions
        case.proof = {**probe.proof, "outside": [list(p) for p in way], "outside_directions": [by] * n}
        return probe.refusal(lambda: case._leaves(solids))

    for axis, far in itertools.product(range(3), (-30.0, 30.0)):
        yield border(lambda x, axis=axis: leaves(home, (*home[:axis], x, *home[axis + 1 :])), far, 5.0)
    yield leaves(), leaves(home), leaves(home, (5.0, 5.0, 12.0), (20.0, 5.0, 12.0)), leaves((5.0, 5.0, 6.0), (5.0,) * 3)
    yield leaves(home, (5.0, 5.0, 12.0), home), leaves(home, (0.5, 0.2, -3.0)), leaves(home, (0.2, 0.2, 1e-8))
    yield leaves(home, (20.0, 5.0, 5.0), n_directions=0), leaves(home, (20.0, 5.0, 5.0), n_directions=2)
    case.paths = [[home, home], [(5.0, 5.0, 5.5), home]]
    yield leaves(home, (20.0, 5.0, 5.0))
    near = probe.case()
    near.legs = [(0, 0, (-40.0, -3.5, 3.0), (40.0, -3.5, 3.0))]
    yield border(lambda x: setattr(near, "near_m", x) or probe.said(near.distance), 0.1, 4.0)
    zone = list(case.no_fly.triangles)

    def shifted(x: float) -> object:
        near.no_fly = probe.module.Solids([tuple((p[0] + x, *p[1:]) for p in triangle) for triangle in zone])
        return probe.said(near.no_fly_)

    near = probe.case()
    yield border(shifted, 0.0, 30.0)
    without = copy.deepcopy(probe.site)
    without["airspace"]["no_fly"] = []
    yield probe.said(probe.case(site=without).no_fly_)
    near.legs = []
    for high in (90.0, -1.0):
        yield border(lambda x: near.proof.update(return_height_m=x) or probe.said(near.return_), 18.0, high)
    craft = {key: value for key, value in near.plan["aircraft"].items() if key != "max_wind_m_s"}
    for wind in (9.9, 10.0, 10.5):
        near.plan = {**near.plan, "aircraft": craft, "rules": {**near.plan["rules"], "wind_m_s": wind}}
        yield probe.said(near.battery)
    near.plan["aircraft"] = {**craft, "max_speed_m_s": 8.0}
    for wind in (7.5, 8.0, 8.5):
        near.plan["rules"] = {**near.plan["rules"], "wind_m_s": wind}
        yield probe.said(near.battery)
    quick = probe.case()  # the gimbal takes longer than turns and photos
    kept = {
        k: v for k, v in quick.plan["aircraft"].items() if k not in ("max_gimbal_rate_deg_s", "min_photo_interval_s")
    }
    quick.plan = {**quick.plan, "aircraft": kept, "rules": {**quick.plan["rules"], "settle_s": 0.1, "photo_s": 0.1}}
    quick.by_id = {v[0]: (*v[:2], 0.0, 35.0 if k % 2 else -90.0) for k, v in enumerate(quick.views)}
    yield _endurance(probe, quick)
    names = quick.plan["sorties"][0]["viewpoint_ids"]
    yield probe.said(lambda: probe.case(**probe.with_number("plan", ("constraints", "occlusion"), "of")).occlusion)
    for sorties in ([{}, {}], [{}, {"start_s": 1.0}], [{"start_s": 0.0}, {"start_s": 1.0}]):
        quick.sorties = sorties
        yield probe.said(quick.apart)
    for odd in ([5.0, *names[1:]], [names[0], *names], [[names[0]]], [None]):
        changed = probe.with_number("plan", ("sorties", 0, "viewpoint_ids"), odd)
        yield probe.said(lambda changed=changed: probe.case(**changed).sorties_())


def _of_returns(probe: Probe) -> Iterator[Any]:
    """Returns of a leg that sinks below their height, before small obstacles around it."""
    case, random = probe.case(), Random(9)
    ways = [tuple(random.gauss(0.0, 1.0) for _ in range(3)) for _ in range(150)]
    case.directions = [tuple(0.999 * x / sum(y * y for y in way) ** 0.5 for x in way) for way in ways]
    every = [float(k) for k in range(len(ways))]
    case.home, case.near_m, case.high = (0.0, 0.0, 0.0), 0.4, (99.0, 99.0, 99.0)
    case.proof = {**probe.proof, "return_kept_m": 0.2, "return_height_m": 5.0, "returns": [[every]]}
    apart = probe.module.Solids([((50.0, 50.0, 50.0),) * 3])
    for ends in (
        ((4.0, 0.0, 9.0), (8.0, 0.0, 3.0)),
        ((8.0, 0.0, 3.0), (4.0, 0.0, 9.0)),
        ((4.0, 3.0, 2.0), (8.0, 0.0, 7.0)),
    ):
        case.legs = [(0, 0, *ends)]
        for x, z in itertools.product((-1.0, 0.0, 2.0, 4.0, 5.0, 6.0, 8.0), (1.0, 3.5, 4.6, 6.0, 8.0, 9.5)):
            small = probe.module.Solids([((x, 0.0, z), (x + 0.1, 0.0, z), (x, 0.0, z + 0.1))])
            case.solids, case.no_fly = small, apart
            yield probe.said(case.return_)
            case.solids, case.no_fly = apart, small
            yield probe.said(case.return_)
    for y in (0.5, 1.0):
        case.no_fly = probe.module.Solids([((4.0, y, 4.0), (4.1, y, 4.0), (4.0, y, 4.1))])
        yield probe.said(case.return_)


SECTIONS: tuple[Section, ...] = (
    _of_files,
    _of_sorties,
    _of_ties,
    _of_ways_outside,
    _of_returns,
    _of_terrain,
    _of_level_ground,
    _of_paths,
    _of_limits,
    _of_batteries,
    _of_numbers,
    _of_bodies,
)

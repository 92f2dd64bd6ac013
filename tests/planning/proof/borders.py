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
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import Any

from tests.planning.proof.verifiers import PLAN, PROOF, SITE

HALVINGS = 52

Verdict = Callable[[float], object]


def border(verdict: Verdict, low: float, high: float) -> tuple[object, object, float]:
    """Verdicts at both ends, and the last number with the first of them."""
    first, last = verdict(low), verdict(high)
    if first == last:
        return first, last, low
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
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

    def with_number(self, name: str, path: Sequence[Any], value: Any) -> dict[str, Any]:
        """One of the three records with another number at a place."""
        record = copy.deepcopy(getattr(self, name))
        parent = record
        for key in path[:-1]:
            parent = parent[key]
        parent[path[-1]] = value
        return {name: record}


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


def _of_views(probe: Probe) -> Iterator[Any]:
    """Places that leave their section, and panels that leave the picture."""
    case = probe.case()
    seen = [(element, int(k)) for element, k in enumerate(probe.proof["seen"]) if k >= 0]
    for element, k in seen:
        name, place, heading, pitch = case.views[k]
        sight = probe.proof["sights"][element]
        for axis, way in [(axis, way) for axis in range(3) for way in (-30.0, 30.0)]:

            def moved(x: float, axis: int = axis, of: Any = (place, element, sight)) -> object:
                p = (*of[0][:axis], of[0][axis] + x, *of[0][axis + 1 :])
                return probe.said(lambda: case.lies_in(p, of[1], of[2]))

            for occlusion in ("on", "off"):
                case.occlusion = occlusion
                yield border(moved, 0.0, way)
            case.occlusion = "on"
        kept = case.far_m
        yield border(
            lambda x, of=(place, element, sight): setattr(case, "far_m", x) or probe.said(lambda: case.lies_in(*of)),
            100.0,
            0.0,
        )
        case.far_m = kept
        for whole in (False, True):
            case.whole = whole
            for turn, way in [(turn, way) for turn in (2, 3) for way in (-80.0, 80.0)]:

                def turned(
                    x: float, turn: int = turn, of: Any = (name, place, heading, pitch), e: int = element
                ) -> object:
                    view = (*of[:turn], of[turn] + x, *of[turn + 1 :])
                    return probe.said(lambda: case.covers(view, e))

                yield border(turned, 0.0, way)
        case.whole = False
        for way in (-1.0, 1.0):
            panel = case.panes[element // case.n]
            behind = tuple(p + way * 30.0 * n for p, n in zip(panel.c, panel.n, strict=True))
            view = (name, behind, heading, pitch)
            yield probe.said(lambda e=element, view=view: case.covers(view, e))
    for half in (0.1, 0.7, 2.0):
        case.half = [half, half]
        yield [case._steepest(pitch) for pitch in (-91.0, -90.0, -60.0, -1e-9, 0.0, 20.0, 35.0, 60.0, 89.0, 90.0, 91.0)]
        yield border(lambda x: case._steepest(x) == 2.0, 0.0, 91.0)
        yield border(lambda x: case._steepest(x) > 0.0, -90.0, 35.0)
    case = probe.case()
    names = ("covered", "total", "reachable_upper_bound")
    for name, by in [(name, by) for name in names for by in (-1.0, 0.0, 1.0)]:
        case.plan["coverage"][name] = probe.plan["coverage"][name] + by
        yield probe.said(case.coverage), probe.said(case.reachable)
        case.plan["coverage"][name] = float(probe.plan["coverage"][name])
    low, high = case.pitches
    for pitch in (-90.0, -20.0, 35.0):
        case.views = [(*view[:3], pitch) for view in case.views]
        yield border(lambda x: setattr(case, "pitches", (x, high)) or probe.said(case.gimbal), -180.0, 36.0)
        yield border(lambda x: setattr(case, "pitches", (low, x)) or probe.said(case.gimbal), 180.0, -91.0)
    case.pitches = (low, high)
    for far in (-400.0, 400.0):
        yield border(
            lambda x: setattr(case, "views", [(*v[:2], x, v[3]) for v in case.views]) or probe.said(case.gimbal),
            0.0,
            far,
        )


def _of_boxes(probe: Probe) -> Iterator[Any]:
    """How large a box may be that is excluded, for each reason; and how large one in a shadow."""
    random, case = Random(7), probe.case()
    low, high = case.low, case.high
    n_triangles, n_patches = len(case.solids.triangles), len(probe.proof["patches"])
    leaves = ["p", "c", *(f"d{k}." for k in range(n_triangles)), *(f"q{k}." for k in range(n_patches))]
    counts = dict.fromkeys("pcdq", 0)
    for _ in range(1500):
        leaf, element = random.choice(leaves), random.randrange(len(case.panes) * case.n)
        centre = [random.uniform(a, b) for a, b in zip(low, high, strict=True)]
        case.far_m = random.choice((1e6, 12.0))
        sizes = [random.uniform(0.2, 1.0) for _ in range(3)]

        def excluded(size: float, of: Any = (leaf, element, centre, sizes)) -> object:
            leaf, element, centre, sizes = of
            case.low = tuple(c - size * s for c, s in zip(centre, sizes, strict=True))
            case.high = tuple(c + size * s for c, s in zip(centre, sizes, strict=True))
            return probe.said(lambda: case._exclude(element, leaf))

        if counts[leaf[0]] < 20 and excluded(1e-6) is None:
            counts[leaf[0]] += 1
            yield leaf, border(excluded, 1e-6, 60.0)
    case.low, case.high = low, high
    for text in ("X", "pp", "", "Xp", "x", "d.", "d1", "q9.", "d99999.", "Xppp", "d12345678."):
        yield text, probe.said(lambda text=text: case._exclude(0, text))
    for element, text in probe.proof["boxes"]:
        yield probe.said(lambda e=element, t=text: case._exclude(e, t))
        yield probe.said(lambda e=element, t=text: case._exclude((e + 1) % case.n, t))
    for patch in ([0.0, 0.0], [4.0, 4.0], [0.0, 1.0], [4.0, 5.0], [4.5], [-1.0], []):
        case.proof["patches"] = [patch]
        case.shadows.clear()
        yield patch, probe.said(lambda: case._is_hidden(0, 0, [(0.0, 0.0, 0.0)] * 8))


def _of_missions(probe: Probe) -> Iterator[Any]:
    """What missions say, and how far they may be off."""
    module, case = probe.module, probe.case()
    for path in sorted(probe.folder.iterdir()):
        if path.suffix not in (".kmz", ".plan", ".waypoints"):
            continue
        mission = module.Mission(path.read_bytes(), path.suffix)
        yield vars(mission)
        kept = copy.deepcopy(vars(mission))

        def flies(prepare: Callable[[float], None], mission: Any = mission) -> Verdict:
            return lambda x: prepare(x) or probe.said(lambda: module.flies(case, mission))

        for k, axis in [(k, axis) for k in (0, -1) for axis in range(3)]:

            def place(x: float, k: int = k, axis: int = axis, kept: Any = kept, mission: Any = mission) -> None:
                mission.places = list(kept["places"])
                p = mission.places[k]
                mission.places[k] = (*p[:axis], p[axis] + x, *p[axis + 1 :])

            for far in (-1.0, 1.0):
                yield border(flies(place), 0.0, far * (1.0 if axis == 2 else 1e-5))
            mission.places = kept["places"]
        for turn in range(3):

            def photo(x: float, turn: int = turn, kept: Any = kept, mission: Any = mission) -> None:
                mission.photos = list(kept["photos"])
                mission.photos[0] = (
                    *mission.photos[0][:turn],
                    mission.photos[0][turn] + x,
                    *mission.photos[0][turn + 1 :],
                )

            for far in (-1.0, 1.0, 360.0):
                yield border(flies(photo), 0.0, far)
            mission.photos = kept["photos"]
        yield border(flies(lambda x, m=mission: setattr(m, "speeds", [0.0, x])), 0.0, 100.0)
        yield border(flies(lambda x, m=mission: setattr(m, "zooms", [x])), 24.0, 200.0)
        yield border(flies(lambda x, m=mission: setattr(m, "zooms", [x])), 24.0, 0.0)
        mission.speeds, mission.zooms = kept["speeds"], kept["zooms"]
        yield border(flies(lambda x, m=mission: setattr(m, "returns", [x, 18.0])), 18.0, 90.0)
        mission.returns = kept["returns"]
        mission.places = kept["places"][:-1]
        yield probe.said(lambda m=mission: module.flies(case, m))
        mission.places, mission.photos = kept["places"], kept["photos"][:-1]
        yield probe.said(lambda m=mission: module.flies(case, m))


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
        (few, {"columns": 2.0, "rows": 2.0}),
        *((packed, {"step_m": step}) for step in (0.01, 0.0099, 1e4, 1.1e4)),
        *((packed, {"accuracy_m": value}) for value in (0.0, -1e-9, 1e4, 1.1e4)),
    ):
        again = record(packed_again, **facts)
        yield facts, probe.said(lambda r=again: module.Terrain(r).z), probe.said(lambda r=again: module.Terrain(r).size)


def _of_folders(probe: Probe) -> Iterator[Any]:
    """Which missions belong to which proof."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        names = [
            "a.kmz",
            "a-2.kmz",
            "a-x.kmz",
            "ab.kmz",
            "a.kmz.mission.proof",
            "plan.proof",
            "a.plan",
            "akmz",
            "a+kmz",
        ]
        for each in (*names, "b.proof", "proof", "-3.proof", "a-2.proof"):
            (folder / each).write_bytes((probe.folder / PROOF).read_bytes())
        yield [[path.name for path in job] for job in probe.module.jobs_of(folder)]


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


def _of_numbers(probe: Probe) -> Iterator[Any]:
    """What is said of numbers at their limits, and right beside them."""
    claims = ("sorties_", "gimbal", "airspace", "battery", "apart", "coverage")
    for name, path, limits in LIMITED:
        for limit in limits:
            for value in (limit, limit * (1.0 + 1e-9) + 1e-12, limit * (1.0 - 1e-9) - 1e-12):
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
    for name, path in (("site", ("terrain",)), ("site", ("zones",)), ("plan", ("rules",)), ("plan", ("origin",))):
        for odd in (None, [], {}, "", [{}], 0.0):
            changed = probe.with_number(name, path, odd)
            found = probe.said(lambda changed=changed: probe.case(**changed))
            claimed = (
                [found] if isinstance(found, str) else [probe.said(partial(c, found)) for _, c in probe.module.CLAIMS]
            )
            yield path, odd, claimed


SECTIONS: tuple[Callable[[Probe], Iterator[Any]], ...] = (
    _of_terrain,
    _of_level_ground,
    _of_paths,
    _of_limits,
    _of_batteries,
    _of_views,
    _of_boxes,
    _of_folders,
    _of_numbers,
    _of_missions,
)
"""What is asked, the quick ones first."""

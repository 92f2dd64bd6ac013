"""Where verdicts on views change: panels, sections, pictures, boxes that are excluded, shadows, and places shown."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from math import cos, inf, nextafter, radians, sin
from random import Random
from typing import Any

from tests.planning.proof.borders import Probe, Section, Vec, border


def _of_panes(probe: Probe) -> Iterator[Any]:
    """Panels by their diagonals: how thin, small, large and tilted they may be."""
    module = probe.module

    def pane(across: Vec, along: Vec) -> Any:
        corners = [tuple(k * x for x in way) for way, k in ((across, -0.5), (along, -0.5), (across, 0.5), (along, 0.5))]
        return probe.said(lambda: vars(module.Pane(corners)))

    def is_pane(across: Vec, along: Vec) -> bool:
        return pane(across, along) != "not proved"

    for p, q in ((1.0, 1.0), (3.0, 0.5), (0.5, 3.0), (0.3, 0.3), (0.02, 40.0), (600.0, 900.0)):
        yield border(lambda lean, p=p, q=q: is_pane((p, 0.0, 0.0), (q * (1.0 - lean), 0.0, q * lean)), 1.0, 0.0)
    for large in (1e3, 1000.5, 1001.0):
        yield is_pane((large, 0.0, 0.0), (0.0, 0.0, 2.0)), is_pane((2.0, 0.0, 0.0), (0.0, 0.0, large))
    yield is_pane((2e-4, 0.0, 0.0), (0.0, 0.0, 1.0)), is_pane((1.99e-4, 0.0, 0.0), (0.0, 0.0, 1.0))
    for low, high in ((0.0, 1e-7), (1e-7, 1e-5)):
        yield border(lambda tilt: is_pane((1.0, 0.0, 0.0), (0.0, 1.0, tilt)), low, high)
    for tilt in (0.0, 1e-12, 0.9e-12, 1.1e-6):
        yield pane((1.0, 0.0, 0.0), (0.0, 1.0, tilt))


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


def _of_shadows(probe: Probe) -> Iterator[Any]:
    """Boxes behind two triangles that share an edge, wound either way, thin, edge on, or partly behind."""
    case, eye = probe.case(), (0.5, -1.0, 0.25)
    case.panes[0].target = eye

    def hidden(patch: Sequence[Sequence[Vec]], centre: Vec, size: float) -> object:
        """Whether a box is in the shadow; places are given as seen from the eye."""
        case.solids.triangles = [tuple(tuple(x + y for x, y in zip(p, eye, strict=True)) for p in t) for t in patch]
        case.proof["patches"] = [[float(k) for k in range(len(patch))]]
        case.shadows.clear()
        signs = itertools.product((-size, size), repeat=3)
        corners = [tuple(a + b + s for a, b, s in zip(centre, eye, each, strict=True)) for each in signs]
        return probe.said(lambda: case._is_hidden(0, 0, corners))

    for wide in (0.25, 1.0, 3.0):
        yield from _of_shadows_of(wide, hidden)


def _of_shadows_of(wide: float, hidden: Callable[[Sequence[Sequence[Vec]], Vec, float], object]) -> Iterator[Any]:
    """Shadows of triangles with a side of twice a width, 2 m before the eye."""
    a, b, c, d = ((x, 2.0, z) for x, z in ((-wide, -wide), (wide, -wide), (wide, 2.0 * wide), (-wide, 2.0 * wide)))
    for one, other in itertools.product(((a, b, c), (a, c, b), (b, c, a)), ((a, c, d), (a, d, c))):
        yield border(partial(hidden, (one, other), (0.0, 6.0, 0.3)), 0.01, 5.0)
    yield border(lambda y: hidden(((a, b, c), (a, d, c)), (0.0, y, 0.0), 1e-3), 4.0, 1.0)
    for single in ((a, b, c), (a, c, b)):
        yield border(partial(hidden, (single,), (2.0 * wide, 6.0, -2.0 * wide)), 0.001, 5.0)
        yield border(lambda y, single=single: hidden((single,), (wide / 3.0, y, 0.0), 1e-3), 4.0, 1.0)
    yield hidden(((a, b, c), (a, b, c)), (0.0, 6.0, 0.0), 0.01), hidden((), (0.0, 6.0, 0.0), 0.01)
    for x in (0.7, 3.0):  # thin: the third corner comes close to the line through the others
        yield border(lambda t, x=x: hidden(((a, b, (x, 2.0, t - wide)),), (0.0, 6.0, -2.9 * wide), 1e-9), 1.0, 0.0)
        yield border(
            lambda t, x=x: hidden(((a, b, (x, 2.0, t - wide)),), (0.0, 6.0, 0.0), 9.0) == "not proved", 1.0, 0.0
        )
    for scale in (0.5, 3e4):  # edge on: the plane comes close to the eye
        edge_on = [(x * scale, z * scale) for x, _, z in (a, b, c)]
        yield border(
            lambda y, ends=edge_on: hidden([[(x, y, z) for x, z in ends]], (0.0, 6.0, 0.0), 9.0) == "not proved",
            1.0,
            0.0,
        )
    yield border(lambda y: hidden(((a, b, c), (a, c, (-wide, y, 2.0 * wide))), (0.0, 9.0, 0.0), 1e-3), 2.0, -1.0)


def _of_sections(probe: Probe) -> Iterator[Any]:
    """Borders of all sections of a pane at the origin, and the picture's edge."""
    case, module = probe.case(), probe.module
    case.panes = [module.Pane([(-1.0, 0.0, -1.0), (1.0, 0.0, -1.0), (1.0, 0.0, 1.0), (-1.0, 0.0, 1.0)])]
    pane, case.occlusion = case.panes[0], "off"
    yield vars(pane)

    def place(theta_deg: float, phi_deg: float, away: float) -> Vec:
        theta, phi = radians(theta_deg), radians(phi_deg)
        parts = (pane.n, cos(theta)), (pane.t, sin(theta) * cos(phi)), (pane.b, sin(theta) * sin(phi))
        return tuple(sum(away * share * axis[k] for axis, share in parts) for k in range(3))

    for case.rings in (1, 2, 3):
        case.n, step = 4 * case.rings**2, 90.0 / case.rings
        for element in range(case.n):
            theta, phi = ((k + 0.5) * step for k in divmod(element, 4 * case.rings))
            for far in (-1.0, 1.0):
                yield border(
                    lambda x, e=element, t=theta, f=phi: case.lies_in(place(t + x, f, 8.0), e, []), 0.0, far * step
                )
                yield border(
                    lambda x, e=element, t=theta, f=phi: case.lies_in(place(t, f + x, 8.0), e, []), 0.0, far * step
                )
    case.rings, case.n = 2, 16
    case.proof = {key: value for key, value in case.proof.items() if key != "sights"}
    for half in ([1.0, 2e-7], [1.0, 1.99e-7], [1.0, 0.5], [0.301, 1.0], [0.3, 1.0]):
        case.half = half
        yield case.covers(("v", (0.3, -1.0, 1e-7), 0.0, 0.0), 0), case.covers(("v", (0.3, -1.0, 0.99e-7), 0.0, 0.0), 0)
        yield case.covers(("v", (0.3, 1.0, 1e-7), 0.0, 0.0), 0), case.covers(("v", (0.3, 1.0, 0.1), 180.0, 0.0), 0)
    for case.steepest in ([0.5, 0.7], [2.0, 0.25], [0.0, 2.0]):
        for turn in range(0, 360, 50):
            way = sin(radians(turn)), cos(radians(turn))

            def excluded(rise: float, way: tuple[float, float] = way) -> object:
                centre = (5.0 * way[0] * (1.0 - abs(rise)), 5.0 * way[1] * (1.0 - abs(rise)), 5.0 * rise)
                case.low, case.high = (tuple(x + s for x in centre) for s in (-1e-3, 1e-3))
                return probe.said(lambda: case._exclude(0, "c"))

            yield border(excluded, 1.0, 0.0), border(excluded, -1.0, 0.0)
    for element, y in itertools.product((0, 8, 15), (-4.0, 4.0)):
        case.low, case.high = (-1.0, y - 1.0, -1.0), (1.0, y + 1.0, 1.0)
        yield [probe.said(lambda leaf=leaf, e=element: case._exclude(e, leaf)) for leaf in ("p", "c", "Xpp", "Xcp")]


def _of_witnesses(probe: Probe) -> Iterator[Any]:
    """Places that are shown, right at the airspace's borders and beyond, and above terrain."""
    case = probe.case()
    case.proof["boxes"], case.plan["coverage"]["reachable_upper_bound"] = [], float(len(case.panes) * case.n)
    low, high, witnesses = case.low, case.high, list(case.proof["witnesses"])

    def shown() -> object:
        return probe.said(lambda: (case.reachable().rpartition("(")[2],))

    yield shown()
    for witness in witnesses[:2]:
        case.proof["witnesses"] = [witness]
        for axis, x in enumerate(witness[1:4]):
            for end in (x, nextafter(x, inf), nextafter(x, -inf)):
                case.low = (*low[:axis], end, *low[axis + 1 :])
                yield shown()
            case.low = low
            for end in (x, nextafter(x, inf), nextafter(x, -inf)):
                case.high = (*high[:axis], end, *high[axis + 1 :])
                yield shown()
            case.high = high
        case.terrain = _Flat(0.0)
        yield border(lambda h: setattr(case, "height_m", h) or shown(), 0.0, 30.0)
        case.terrain = None
    for bound in (-1.0, 0.0, 0.5, float(len(case.panes) * case.n) - 0.5):
        case.plan["coverage"]["reachable_upper_bound"] = bound
        yield probe.said(case.reachable)
    views = case.views
    for n_views in range(4):
        case.views = views[:n_views]
        yield probe.said(case.reachable)
    case.views = views
    for covered in (-1.0, nextafter(0.0, -inf), 0.0, nextafter(0.0, inf)):
        case.plan["coverage"]["covered"] = covered
        yield probe.said(case.coverage)
    case.plan["coverage"]["covered"] = float(probe.plan["coverage"]["covered"])
    for seen in ([], probe.proof["seen"][:-1], [*probe.proof["seen"], -1.0], [*probe.proof["seen"], 0.0]):
        case.proof["seen"] = [float(k) for k in seen]
        yield probe.said(case.coverage)


class _Flat:
    """Level terrain."""

    def __init__(self, z: float) -> None:
        self.z = [z]

    def clearance(self, a: Vec, b: Vec) -> float:
        return min(a[2], b[2]) - self.z[0]


SECTIONS: tuple[Section, ...] = (
    _of_panes,
    _of_sections,
    _of_witnesses,
    _of_shadows,
    _of_views,
    _of_boxes,
)

"""Plans made by hand for the tests of missions: a column above home, views in between, pass-through vertices."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from pathlib import Path

from hypothesis import strategies as st

from missions.formats.options import DEFAULT_OPTIONS, ExportOptions
from missions.formats.registry import encode, write_files
from planning.aircraft.catalogue import profile
from planning.geo.frames import Origin, Vec3
from planning.parameters import Constraints, FlightRules
from planning.plan import Coverage, Plan, Sortie, Viewpoint

HOME: Vec3 = (3.0, -40.0, 1.5)
HONG_KONG = Origin(22.3372, 114.2636, 62.0)

ORIGINS = (
    HONG_KONG,
    Origin(52.0, 5.0, 45.0),
    Origin(-33.9, 151.2, 30.0),
    Origin(-16.5, 180.0, 55.0),  # on the antimeridian: the site lies on both sides of it
    Origin(51.9, -179.9999, 10.0),
    Origin(75.0, 25.0, 40.0),
    Origin(31.5, 35.5, -395.0),  # the shore of the Dead Sea
    Origin(0.0, 0.0001, 20.0),
)


def sortie_path(
    views: Sequence[Viewpoint], passes: dict[int, Vec3], home: Vec3 = HOME, top_m: float = 20.0
) -> list[Vec3]:
    """Home, the column above it, views in order (each after the pass-through vertex of its index), and back."""
    top = (home[0], home[1], home[2] + top_m)
    path = [home, top]
    for index, view in enumerate(views):
        path += [passes[index]] if index in passes else []
        path.append(view.position_enu_m)
    return [*path, top, home]


def make_plan(
    sorties: Sequence[tuple[Sequence[Viewpoint], dict[int, Vec3]]],
    origin: Origin | None = HONG_KONG,
    profile_name: str = "m3e",
    rules: FlightRules | None = None,
    home: Vec3 = HOME,
) -> Plan:
    """Plan with the given views and pass-through vertices by sortie."""
    chosen = profile(profile_name)
    made = []
    for views, passes in sorties:
        path = sortie_path(views, passes, home)
        length_m = sum(math.dist(a, b) for a, b in itertools.pairwise(path))
        made.append(Sortie(tuple(v.id for v in views), tuple(path), length_m, 60.0 + length_m / 3.0))
    return Plan(
        site="office",
        site_sha256="",
        method="greedy",
        seed=0,
        camera=chosen.camera,
        aircraft=chosen.aircraft,
        constraints=Constraints(),
        viewpoints=tuple(view for views, _ in sorties for view in views),
        sorties=tuple(made),
        coverage=Coverage(0, 0, 0),
        origin=origin,
        home_enu_m=home,
        rules=rules or FlightRules(),
        profile=profile_name,
    )


def ring(n: int, radius_m: float = 25.0, first: int = 0, height_m: float = 22.0) -> list[Viewpoint]:
    """Views on a circle around the origin that look inwards, with pitches from -30 to 20 deg."""
    views = []
    for i in range(n):
        angle = 2.0 * math.pi * i / n
        position = (radius_m * math.sin(angle), radius_m * math.cos(angle), height_m + i % 3)
        heading = math.degrees(angle) + 180.0
        views.append(
            Viewpoint(f"v{first + i:04d}", position, (heading + 180.0) % 360.0 - 180.0, -30.0 + 50.0 * (i / n))
        )
    return views


def example_plan(profile_name: str = "m3e", rules: FlightRules | None = None) -> Plan:
    """Two sorties of six and four views, with a pass-through vertex in the first."""
    first, second = ring(6), ring(4, radius_m=32.0, first=6, height_m=30.0)
    passes = {2: (30.0, -30.0, 27.0)}
    return make_plan([(first, passes), (second, {})], profile_name=profile_name, rules=rules)


def _coordinate(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high, allow_nan=False).map(lambda value: round(value, 3))


@st.composite
def plans(draw: st.DrawFn, profile_name: str = "m3e") -> Plan:
    """Plans of one to three sorties anywhere on the globe, with views and pass-through vertices in any order."""
    origin = draw(st.sampled_from(ORIGINS))
    low, high = profile(profile_name).camera.gimbal_pitch_deg
    sorties = []
    ids = itertools.count()
    for _ in range(draw(st.integers(1, 3))):
        views = []
        for _ in range(draw(st.integers(1, 6))):
            position = (draw(_coordinate(-80, 80)), draw(_coordinate(-80, 80)), draw(_coordinate(5, 90)))
            heading, pitch = draw(_coordinate(-179.9, 180)), draw(_coordinate(low, high))
            views.append(Viewpoint(f"v{next(ids):04d}", position, heading, pitch))
        passed = draw(
            st.dictionaries(st.integers(0, len(views) - 1), st.tuples(*[_coordinate(20, 90)] * 3), max_size=2)
        )
        sorties.append((views, passed))
    rules = FlightRules(
        settle_s=draw(st.sampled_from((0.0, 1.0, 2.0, 3.5))),
        photo_s=draw(st.sampled_from((0.0, 1.0, 2.5))),
        turn_in_flight=draw(st.booleans()),
        max_speed_m_s=draw(st.sampled_from((None, 3.0))),
    )
    return make_plan(sorties, origin, profile_name, rules)


def export(
    plan: Plan,
    origin: Origin | None,
    home_enu_m: Vec3 | None,
    file_format: str,
    path: Path,
    options: ExportOptions = DEFAULT_OPTIONS,
) -> tuple[Path, ...]:
    """Write a plan as mission files, all of them or none.

    The first sortie gets exactly `path`, the next ones `<stem>-2<suffix>` and so on; KML and CSV hold all sorties.

    Parameters
    ----------
    origin, home_enu_m
        Of the site, for plans that do not carry them.

    Returns
    -------
    paths
        The files written.

    Raises
    ------
    InputError
        Something is missing from the plan, or the folder cannot be written.
    MissionError
        The plan cannot be flown as it stands, or not with this format; nothing is written.
    """
    return write_files(encode(plan, origin, home_enu_m, file_format, options), path)

"""Plans that are paths alone, for the tests of ground risk: nothing of them but where they fly counts."""

from __future__ import annotations

from planning.aircraft.catalogue import profile
from planning.geo.frames import Vec3
from planning.parameters import Constraints
from planning.plan import Coverage, Plan, Sortie
from planning.site.bundled import ORIGIN
from planning.site.records import Airspace, Site

Path = tuple[Vec3, ...]

ROUND = ((0.0, 0.0, 0.0), (0.0, 0.0, 40.0), (60.0, 0.0, 40.0), (60.0, 30.0, 25.0), (0.0, 0.0, 40.0), (0.0, 0.0, 0.0))
BENT = ((0.0, 0.0, 20.0), (100.0, 0.0, 20.0), (100.0, 5.0, 20.0), (5.0, 5.0, 20.0), (5.0, 100.0, 20.0))


def flown(*paths: Path, profile_id: str = "m3e") -> Plan:
    own = profile(profile_id)
    return Plan(
        "place", "", "greedy", 0, own.camera, own.aircraft, Constraints(), (),
        tuple(Sortie((), path, 0.0, 0.0) for path in paths), Coverage(0, 0, 0), profile=profile_id,
    )  # fmt: skip


def place(ground_z_m: float = 0.0) -> Site:
    space = Airspace((-1e4, -1e4, ground_z_m), (1e4, 1e4, 1e3), ground_z_m)
    return Site(
        name="place", origin=ORIGIN, facades=(), airspace=space, home_enu_m=(0.0, 0.0, ground_z_m), is_bare=True
    )

"""The claims of a proof, judged one by one on the files as they are.

A claim about files that cannot be read, or that lack what it speaks of, is False: there is nothing it could be true of.
None says that the judge cannot tell. For `reachable` and `return`, whose claims speak of infinitely many places, the
judge looks for places that contradict them, and never says True.
"""

from __future__ import annotations

import hashlib
import io
import itertools
import json
import math
import re
import zipfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any
from xml.etree import ElementTree

import mpmath

from tests.planning.proof.exact import (
    Enclosure,
    Point,
    Triangle,
    dot,
    fractions,
    minus,
    pi,
    sine_cosine,
)
from tests.planning.proof.judge import (
    Json,
    Scene,
    UndecidedError,
    enters_no_fly,
    in_picture,
    is_in_solid,
    keeps,
    least_above,
    legs,
    line_is_free,
    most_covered,
    rest_to_rest_s,
    ring_and_sector,
    upper_heights,
)

Files = Mapping[str, bytes]
"""Contents by name: of the site `site.json`, of the plan `plan.json`, of the proof `plan.proof`; meshes, missions."""

HOME_M = Fraction(1, 1000)
"""How far from home, in each coordinate, a path may begin and end, and vertices may be off their viewpoints."""


ENDS = ("min_enu_m", "max_enu_m")


class MeaninglessError(Exception):
    """A file cannot be read, or lacks what a claim speaks of."""


def _without_doubles(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) != len(pairs):
        raise MeaninglessError("a key occurs twice")
    return found


def read_json(content: bytes) -> Any:
    """A JSON file."""
    return json.loads(content.decode(), object_pairs_hook=_without_doubles)


def number(value: Any) -> Fraction:
    """A finite number of a file."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise MeaninglessError(f"{value!r} is no number")
    return Fraction(float(value))


def optional(fields: Json, name: str) -> Any:
    """A field, None where it is absent."""
    return fields.get(name)


@dataclass(slots=True)
class Case:
    """Files to be judged, read when they are asked for.

    Parameters
    ----------
    places
        For `reachable`: element and position that might be seen from, such as the planner's own witnesses.
    """

    files: Files
    places: Sequence[tuple[int, Point]] = ()
    _read: dict[str, Any] = field(default_factory=dict)

    def json(self, name: str) -> Any:
        """A JSON file."""
        if name not in self._read:
            self._read[name] = read_json(self.files[name])
        return self._read[name]

    @property
    def site(self) -> Any:
        return self.json("site.json")

    @property
    def plan(self) -> Any:
        return self.json("plan.json")

    @property
    def scene(self) -> Scene:
        """The site with its meshes."""
        if "scene" not in self._read:
            site = self.site
            _check_numbers(site)
            names = [site.get("building_mesh"), *(obstacle.get("mesh") for obstacle in (site.get("obstacles") or ()))]
            meshes = {name: triangles_of(self.files[name], name) for name in names if name is not None}
            self._read["scene"] = Scene(site, meshes)
        return self._read["scene"]  # type: ignore[no-any-return]

    @property
    def paths(self) -> list[list[Point]]:
        """Paths of all sorties."""
        return [[_point(p) for p in sortie["path_enu_m"]] for sortie in self.plan["sorties"]]

    @property
    def home(self) -> Point:
        return _point(self.site["home_enu_m"])

    @property
    def min_distance(self) -> Fraction:
        """Distance to be kept."""
        return number(self.plan["constraints"]["min_distance_m"])


def _check_numbers(value: Any) -> None:
    if isinstance(value, dict):
        for each in value.values():
            _check_numbers(each)
    elif isinstance(value, list):
        for each in value:
            _check_numbers(each)
    elif isinstance(value, float) and not math.isfinite(value):
        raise MeaninglessError("a number is not finite")


def _point(values: Any) -> Point:
    x, y, z = (float(number(value)) for value in values)
    return x, y, z


def triangles_of(content: bytes, name: str) -> tuple[Triangle, ...]:
    """Triangles of a mesh file."""
    import trimesh

    mesh = trimesh.load_mesh(io.BytesIO(content), file_type=name.rsplit(".", 1)[-1], process=False)
    return tuple(tuple(tuple(float(x) for x in mesh.vertices[k]) for k in face) for face in mesh.faces)  # type: ignore[misc]


# The claims.


def files(case: Case) -> bool:
    """The plan was made for the site, and the proof for both and for the meshes."""
    proof = case.json("plan.proof")
    hashes = {name: hashlib.sha256(content).hexdigest() for name, content in case.files.items()}
    named = [(entry["name"], entry["sha256"]) for entry in proof["meshes"]]
    of_site = [
        case.site.get("building_mesh"),
        *(obstacle.get("mesh") for obstacle in (case.site.get("obstacles") or ())),
    ]
    return (
        proof["site"]["sha256"] == case.plan["site_sha256"] == hashes["site.json"]
        and proof["plan"]["sha256"] == hashes["plan.json"]
        and all(hashes.get(name) == digest for name, digest in named)
        and {name for name in of_site if name is not None} == {name for name, _ in named}
    )


def sorties(case: Case) -> bool:
    """Each viewpoint once, on its path and in order; paths run from home to home."""
    plan, home = case.plan, fractions(case.home)
    by_id = {view["id"]: fractions(_point(view["position_enu_m"])) for view in plan["viewpoints"]}
    flown = [name for sortie in plan["sorties"] for name in sortie["viewpoint_ids"]]
    if not by_id or len(by_id) != len(plan["viewpoints"]) or sorted(flown) != sorted(by_id):
        return False
    if any(sortie.get("in_passing_ids") for sortie in plan["sorties"]):
        return False
    for sortie, path in zip(plan["sorties"], case.paths, strict=True):
        vertices = [fractions(vertex) for vertex in path]
        if len(vertices) < 3 or not (_same(vertices[0], home) and _same(vertices[-1], home)):
            return False
        at = 0
        for name in sortie["viewpoint_ids"]:
            while at < len(vertices) and not _same(vertices[at], by_id[name]):
                at += 1
            if at == len(vertices):
                return False
    stated = plan.get("home_enu_m"), plan.get("origin")
    return all(a is None or a == b for a, b in zip(stated, (case.site["home_enu_m"], case.site["origin"]), strict=True))


def _same(a: Any, b: Any, within: Fraction = HOME_M + Fraction(1, 10**6)) -> bool:
    return all(abs(x - y) <= within for x, y in zip(a, b, strict=True))


def gimbal(case: Case) -> bool:
    """Pitches within the gimbal's range, headings in (-180, 180]."""
    low, high = (number(value) for value in case.plan["camera"]["gimbal_pitch_deg"])
    return (low >= -180 and high <= 90) and all(
        low <= number(view["gimbal_pitch_deg"]) <= high and -180 < number(view["heading_deg"]) <= 180
        for view in case.plan["viewpoints"]
    )


def floor_z(case: Case) -> Fraction:
    """Lowest height of flights beside the column."""
    airspace, lowest = case.site["airspace"], lowest_height(case)
    terrain = case.scene.terrain
    if terrain is None or level_within(case) is not None:
        return max(number(airspace["min_enu_m"][2]), number(airspace["ground_z_m"]) + lowest)
    known = [height for row in upper_heights(terrain) for height in row if height is not None]
    return max(number(airspace["min_enu_m"][2]), min(known) + lowest)


def level_within(case: Case) -> Fraction | None:
    """How far the proof says that the terrain departs from level ground; None where heights count from the terrain."""
    stated = case.json("plan.proof").get("level_within_m")
    return None if stated is None else number(stated)


def is_level(case: Case, within: Fraction) -> bool:
    """Whether the upper bound of the ground is known and as level as stated below the whole airspace."""
    airspace, terrain = case.site["airspace"], case.scene.terrain or {}
    z, level, step = upper_heights(terrain), number(airspace["ground_z_m"]), Fraction(terrain["step_m"])
    spans = []
    for k, n in enumerate((len(z[0]), len(z))):
        low, high = ((number(airspace[name][k]) - number(terrain["west_south_m"][k])) / step for name in ENDS)
        if low < 0 or high > n - 1:
            return False
        spans.append(slice(math.floor(low), math.ceil(high) + 1))
    nodes = [height for row in z[spans[1]] for height in row[spans[0]]]
    return terrain.get("use", "auto") == "auto" and all(h is not None and abs(h - level) <= within for h in nodes)


def lowest_height(case: Case) -> Fraction:
    """That flights keep above the ground."""
    of_plan = case.plan["constraints"].get("min_height_above_ground_m")
    wanted = (of_plan, case.site["airspace"].get("min_height_above_ground_m"), 5)
    return next(number(value) for value in wanted if value is not None)


def airspace(case: Case) -> bool:
    """Paths in the box and above the lowest height, but for the column."""
    low, high = (fractions(_point(case.site["airspace"][name])) for name in ENDS)
    home, floor, within = fractions(case.home), floor_z(case), level_within(case)
    if case.scene.terrain is not None and within is not None and not is_level(case, within):
        return False
    for path in case.paths:
        vertices = [fractions(vertex) for vertex in path]
        in_column = [_same(vertex[:2], home[:2]) for vertex in vertices]
        for k, vertex in enumerate(vertices):
            if not all(low[i] <= vertex[i] <= high[i] for i in range(2)) or vertex[2] > high[2]:
                return False
            neighbours = [j for j in (k - 1, k + 1) if 0 <= j < len(vertices)]
            beside = not in_column[k] or any(not in_column[j] for j in neighbours)
            if vertex[2] < (floor if beside else min(home[2], floor)) - (0 if beside else HOME_M):
                return False
        if case.scene.terrain is not None and within is None:
            for k, (a, b) in enumerate(legs(path)):
                above = None if in_column[k] and in_column[k + 1] else least_above(case.scene.terrain, a, b)
                if not (in_column[k] and in_column[k + 1]) and (above is None or above < lowest_height(case)):
                    return False
    return True


def column(case: Case) -> bool:
    """The second and the last but one vertex straight above home, 2 m or more."""
    home = fractions(case.home)
    second = [fractions(path[k]) for path in case.paths for k in (1, -2)]
    return all(_same(p[:2], home[:2]) and p[2] >= home[2] + 2 - 2 * HOME_M for p in second)


def distance(case: Case) -> bool:
    """Every leg keeps the minimum distance from everything solid and lies in no closed part."""
    return case.min_distance > 0 and all(
        keeps(case.scene, a, b, case.min_distance) and not is_in_solid(case.scene, a)
        for path in case.paths
        for a, b in legs(path)
    )


def no_fly(case: Case) -> bool:
    """No leg touches a no-fly volume of the site."""
    return not any(enters_no_fly(case.scene, a, b) for path in case.paths for a, b in legs(path))


def zones(case: Case) -> bool:
    """There are no files of geo-zones."""
    return not case.site.get("zones")


def return_home(case: Case) -> bool | None:
    """From places of each leg straight up, level to above home, and down: looked at from five places of each."""
    height = number(case.json("plan.proof")["return_height_m"])
    home = fractions(case.home)
    top = home[2] + height
    needed = number(case.json("plan.proof")["return_kept_m"])
    if height < 0 or top > number(case.site["airspace"]["max_enu_m"][2]):
        return False
    if needed <= 0:
        return None
    for path in case.paths:
        for a, b in legs(path):
            p, q = fractions(a), fractions(b)
            for t in (Fraction(0), Fraction(1, 4), Fraction(1, 2), Fraction(3, 4), Fraction(1)):
                x, y, z = (p[i] + t * (q[i] - p[i]) for i in range(3))
                level = max(z, top)
                corners = ((x, y, z), (x, y, level), (home[0], home[1], level), home)
                for start, end in itertools.pairwise(corners):
                    # Rounded to binary64: off by less than the tolerance.
                    if not keeps(case.scene, _rounded(start), _rounded(end), needed - Fraction(1, 10**9)):
                        return False
    return None


def _rounded(p: Sequence[Any]) -> Point:
    x, y, z = (float(value) for value in p)
    return x, y, z


def duration_s(case: Case, sortie: Json) -> Enclosure:
    """Duration of a sortie that stops at each vertex, take-off and landing included (planning/motion/timing.py)."""
    plan = case.plan
    aircraft, rules = plan["aircraft"], plan.get("rules", {})

    def rule(name: str, default: float) -> Fraction:
        return number(rules[name]) if name in rules else Fraction(default)

    wind, top = rule("wind_m_s", 0.0), rules.get("max_speed_m_s")
    jerk = aircraft.get("max_jerk_m_s3")
    across = number(aircraft["max_speed_m_s"]) - wind
    up, down = number(aircraft.get("max_ascent_m_s", 4.0)), number(aircraft.get("max_descent_m_s", 3.0))
    if top is not None:
        across, up, down = (min(value, number(top)) for value in (across, up, down))
    yaw, tilt = (number(aircraft.get(f"max_{name}_rate_deg_s", 60.0)) for name in ("yaw", "gimbal"))
    acceleration = number(aircraft.get("max_acceleration_m_s2", 2.5))
    if min(across, up, down, yaw, tilt, acceleration) <= 0 or wind >= number(aircraft.get("max_wind_m_s", 10.0)):
        raise MeaninglessError("nothing can fly")
    stop = max(rule("settle_s", 2.0) + rule("photo_s", 1.0), number(aircraft.get("min_photo_interval_s", 0.7)))
    total = Enclosure.of(rule("takeoff_landing_s", 30.0))
    path = [fractions(_point(vertex)) for vertex in sortie["path_enu_m"]]
    views = {view["id"]: view for view in plan["viewpoints"]}
    heading, pitch = None, Fraction(0)
    turns: list[Fraction] = []
    for name in sortie["viewpoint_ids"]:
        view = views[name]
        to, tilted = number(view["heading_deg"]), number(view["gimbal_pitch_deg"])
        turned = Fraction(180) if heading is None else abs((to - heading + 180) % 360 - 180)
        turns.append(max(turned / yaw, abs(tilted - pitch) / tilt))
        heading, pitch = to, tilted
    for p, q in itertools.pairwise(path):
        d = minus(q, p)
        flat, length = Enclosure.of(Fraction(d[0] ** 2 + d[1] ** 2)).root(), Enclosure.of(Fraction(dot(d, d))).root()
        slowness = (flat / across).most(Enclosure.of(abs(Fraction(d[2])) / (up if d[2] > 0 else down)))
        if slowness.low <= 0:
            continue
        leg = rest_to_rest_s(length, length / slowness, acceleration, None if jerk is None else number(jerk))
        total += leg
    # Turning in flight takes at least no time of its own.
    in_flight = bool(rules.get("turn_in_flight", False))
    for turn in turns:
        total += stop + (0 if in_flight else turn)
    return total


def battery(case: Case) -> bool:
    """Sorties, stopping at each vertex, end with the reserve."""
    plan = case.plan
    reserve = plan.get("rules", {}).get("battery_reserve", 0.25)
    usable = number(plan["aircraft"]["endurance_s"]) * (1 - number(reserve)) + Fraction(1, 100)
    if not 0 <= number(reserve) < 1:
        return False
    return all(
        duration_s(case, sortie).low <= usable + usable / 10**9 and number(sortie["duration_s"]) <= usable
        for sortie in plan["sorties"]
    )


def apart(case: Case) -> bool:
    """One aircraft at a time."""
    return case.plan.get("rules", {}).get("at_once", 1) == 1 and not any(
        sortie.get("start_s") is not None for sortie in case.plan["sorties"]
    )


def _check_sections(case: Case) -> None:
    step = number(case.plan["constraints"]["section_step_deg"])
    if not 1 <= step <= 90 or abs(90 / step - round(90 / step)) > Fraction(1, 10**9):
        raise MeaninglessError("the step divides no right angle")
    camera = case.plan["camera"]
    if min(number(camera[name]) for name in ("sensor_width_mm", "sensor_height_mm", "focal_length_mm")) <= 0:
        raise MeaninglessError("no camera")
    if case.plan["constraints"]["occlusion"] not in ("on", "off"):
        raise MeaninglessError("occlusion is not decided")
    if min((dot(panel.normal, panel.normal) for panel in case.scene.panels), default=0) == 0:
        raise MeaninglessError("a panel without a normal")


def n_sections(case: Case) -> int:
    """Sections of one panel."""
    return 4 * round(90 / number(case.plan["constraints"]["section_step_deg"])) ** 2


def coverage(case: Case) -> bool:
    """At least so many sections of exactly so many are covered."""
    _check_sections(case)
    stated = case.plan["coverage"]
    if number(stated["total"]) != len(case.scene.panels) * n_sections(case):
        return False
    covered = number(stated["covered"])
    return covered >= 0 and most_covered(case.scene, case.plan) >= covered


def reachable(case: Case) -> bool | None:
    """At most so many sections can be covered: False where more places are found that see one each."""
    _check_sections(case)
    low, high = (number(value) for value in case.plan["camera"]["gimbal_pitch_deg"])
    if not (-180 <= low <= high <= 90):
        return False
    bound = number(case.plan["coverage"]["reachable_upper_bound"])
    needed = math.ceil(bound) + 1
    found = set()
    for element, place in case.places:
        if element not in found and can_see(case, element, place):
            found.add(element)
            if len(found) >= needed:
                return False
    return None


def can_see(case: Case, element: int, place: Point) -> bool:
    """Whether a place in the airspace keeps its distance and, with some heading and pitch, covers a section."""
    scene, plan = case.scene, case.plan
    at = fractions(place)
    low, high = (fractions(_point(case.site["airspace"][name])) for name in ("min_enu_m", "max_enu_m"))
    if not all(low[k] <= at[k] <= high[k] for k in range(3)) or at[2] < floor_z(case):
        return False
    if scene.terrain is not None and level_within(case) is None:
        above = least_above(scene.terrain, place, place)
        if above is None or above < lowest_height(case):
            return False
    panel_index, section = divmod(element, n_sections(case))
    if panel_index >= len(scene.panels):
        return False
    panel = scene.panels[panel_index]
    step = number(plan["constraints"]["section_step_deg"])
    try:
        pair = ring_and_sector(panel, at, step)
        if pair is None or pair[0] * 4 * round(90 / step) + pair[1] != section:
            return False
    except UndecidedError:
        return False
    farthest = plan["constraints"].get("max_distance_m")
    d = minus(panel.centroid, at)
    if farthest is not None and dot(d, d) > number(farthest) ** 2:
        return False
    if not any(_may_be_seen(case, panel, place, pitch) for pitch in _pitches(case, d)):
        return False
    if not keeps(scene, place, place, case.min_distance):
        return False
    return plan["constraints"]["occlusion"] != "on" or line_is_free(scene, panel, at) is True


def _pitches(case: Case, d: Any) -> Iterator[float]:
    """Gimbal pitches to try: towards the panel, as far as the gimbal goes."""
    low, high = (float(number(value)) for value in case.plan["camera"]["gimbal_pitch_deg"])
    aimed = math.degrees(math.atan2(float(d[2]), math.hypot(float(d[0]), float(d[1]))))
    yield min(max(aimed, low), high)


def _may_be_seen(case: Case, panel: Any, place: Point, pitch: float) -> bool:
    """Whether a view with this pitch that turns towards the panel has it in its picture."""
    d = minus(panel.centroid, fractions(place))
    heading = math.degrees(math.atan2(float(d[0]), float(d[1])))
    view = {"position_enu_m": place, "heading_deg": heading, "gimbal_pitch_deg": pitch}
    points = [panel.centroid]
    if case.plan["constraints"].get("whole_panel"):
        points += [fractions(corner) for corner in panel.corners]
    return all(in_picture(case.plan["camera"], view, point) is True for point in points)


CLAIMS: dict[str, Callable[[Case], bool | None]] = {
    "files": files,
    "sorties": sorties,
    "gimbal": gimbal,
    "airspace": airspace,
    "column": column,
    "distance": distance,
    "no-fly": no_fly,
    "zones": zones,
    "return": return_home,
    "battery": battery,
    "apart": apart,
    "coverage": coverage,
    "reachable": reachable,
}


def judged(case: Case, claim: str) -> bool | None:
    """What is true of a claim.

    Whatever is wrong with the files makes a claim False that needs them.
    """
    if claim.startswith("mission "):
        from tests.planning.proof.missions import mission

        judge: Callable[[Case], bool | None] = lambda of: mission(of, claim.removeprefix("mission "))  # noqa: E731
    elif claim == "missions":
        from tests.planning.proof.missions import missions as judge
    else:
        judge = CLAIMS[claim]
    try:
        return judge(case)
    except UndecidedError:
        return None
    except Exception:  # a damaged file breaks readers in ways without number
        return False


_ = (re, zipfile, ElementTree, mpmath, pi, sine_cosine)

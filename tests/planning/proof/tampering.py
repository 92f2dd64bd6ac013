"""Tampered sites, plans, proofs and missions: what an error, a careless edit or an attacker would make of them.

A tampering changes files; `sealed` then makes all hashes right again, as anybody can who tampers, so that nothing but
the claims themselves is in its way. `grazing` ones set a limit to the value that is measured, give or take next to
nothing: there a claim is lost or kept by rounding alone.
"""

from __future__ import annotations

import copy
import hashlib
import io
import json
import math
import re
import struct
import zipfile
from collections.abc import Callable, Iterator
from random import Random
from typing import Any

from tests.planning.proof.claims import Case, Files, duration_s
from tests.planning.proof.exact import segment_triangle_d2
from tests.planning.proof.judge import legs

Tampering = Callable[[Random, dict[str, bytes]], None]

TAMPERINGS: dict[str, Tampering] = {}
"""By kind; each changes the files in place."""

JSON_FILES = ("site.json", "plan.json", "plan.proof")


def kind(name: str) -> Callable[[Tampering], Tampering]:
    """Register a kind of tampering."""

    def register(tampering: Tampering) -> Tampering:
        TAMPERINGS[name] = tampering
        return tampering

    return register


def tampered(random: Random, files: Files, name: str) -> dict[str, bytes]:
    """Files after a tampering of a kind, mostly with hashes that fit again."""
    changed = dict(files)
    TAMPERINGS[name](random, changed)
    return sealed(changed) if random.random() < 0.9 else changed


def sealed(files: Files) -> dict[str, bytes]:
    """The same files with all hashes right, as far as they can be read."""
    changed = dict(files)
    try:
        digest = hashlib.sha256(changed["site.json"]).hexdigest()
        # Texts are replaced, not rewritten: what is odd about a file must stay odd.
        plan = re.sub(
            rb'"site_sha256": *"[0-9a-f]*"', b'"site_sha256": "' + digest.encode() + b'"', changed["plan.json"]
        )
        changed["plan.json"] = plan
        proof = json.loads(changed["plan.proof"])
        proof["site"]["sha256"] = digest
        proof["plan"]["sha256"] = hashlib.sha256(plan).hexdigest()
        for entry in proof["meshes"]:
            if entry["name"] in changed:
                entry["sha256"] = hashlib.sha256(changed[entry["name"]]).hexdigest()
        changed["plan.proof"] = dumped(proof)
    except (ValueError, KeyError, TypeError, RecursionError):
        pass
    return changed


def dumped(content: Any) -> bytes:
    """JSON as Python writes it, NaN and Infinity included."""
    return json.dumps(content).encode()


def amount(random: Random) -> float:
    """A length from a nanometre to 10 m, of either sign, m."""
    return float(random.choice((-1, 1)) * 10.0 ** random.uniform(-9.0, 1.0))


def next_to_nothing(random: Random) -> float:
    """A relative or absolute change that rounding could hide."""
    return float(random.choice((-1, 1)) * 10.0 ** random.uniform(-16.0, -5.0))


# Everywhere in a JSON file.

ODD: tuple[Any, ...] = (
    math.nan,
    math.inf,
    -math.inf,
    1e308,
    -1e308,
    1e-308,
    5e-324,
    1e16,
    -1.0,
    0,
    -0.0,
    10**400,
    2**53 + 1,
    True,
    False,
    None,
    "",
    "1",
    "NaN",
    [],
    {},
    [[[]]],
    "\ud800",
    "__proto__",
    "constructor",
)


def places(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Paths of all values in a JSON file."""
    if path:
        yield path
    children = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, child in children:
        yield from places(child, (*path, key))


def _parent(content: Any, path: tuple[Any, ...]) -> Any:
    for key in path[:-1]:
        content = content[key]
    return content


def _somewhere(random: Random, content: Any) -> tuple[Any, ...]:
    """A path that is as likely to be near the top as deep down."""
    value, path = content, ()
    while isinstance(value, (dict, list)) and value:
        key = random.choice(list(value) if isinstance(value, dict) else range(len(value)))
        path, value = (*path, key), value[key]
        if random.random() < 0.15:
            break
    return path


def _edit(files: dict[str, bytes], name: str, change: Callable[[Any], None]) -> None:
    content = json.loads(files[name])
    change(content)
    files[name] = dumped(content)


@kind("odd values")
def odd_value(random: Random, files: dict[str, bytes]) -> None:
    """NaN, Infinity, 1e308, 1e-308, other types."""
    name = random.choice(JSON_FILES)

    def change(content: Any) -> None:
        path = _somewhere(random, content)
        _parent(content, path)[path[-1]] = random.choice(ODD)

    _edit(files, name, change)


@kind("numbers scaled")
def scaled_number(random: Random, files: dict[str, bytes]) -> None:
    """A number times a factor, or moved."""
    name = random.choice(JSON_FILES)

    def change(content: Any) -> None:
        for _ in range(20):
            path = _somewhere(random, content)
            value = _parent(content, path)[path[-1]]
            if isinstance(value, (int, float)) and not isinstance(value, bool):
                factor = random.choice((1 + next_to_nothing(random), 0.5, 2.0, -1.0, 1e3, 1e-3))
                _parent(content, path)[path[-1]] = random.choice((value * factor, value + amount(random)))
                return

    _edit(files, name, change)


@kind("parts missing, doubled or swapped")
def structure(random: Random, files: dict[str, bytes]) -> None:
    """A key or an entry that is missing, is there twice, or changes places with another."""
    name = random.choice(JSON_FILES)

    def change(content: Any) -> None:
        path = _somewhere(random, content)
        parent = _parent(content, path)
        what = random.choice(("drop", "double", "swap"))
        if what == "drop":
            del parent[path[-1]]
        elif isinstance(parent, list) and what == "double":
            parent.insert(path[-1], copy.deepcopy(parent[path[-1]]))
        elif isinstance(parent, list):
            other = random.randrange(len(parent))
            parent[path[-1]], parent[other] = parent[other], parent[path[-1]]
        else:
            parent[f"{path[-1]} "] = parent.pop(path[-1])

    _edit(files, name, change)


@kind("doubled keys")
def doubled_key(random: Random, files: dict[str, bytes]) -> None:
    """A key twice, with values that readers choose from differently."""
    name = random.choice(JSON_FILES)
    text = files[name].decode()
    found = random.choice(list(re.finditer(r'"[a-z_]+": *(-?[0-9.]+|"[^"]*")', text)))
    files[name] = (text[: found.start()] + found.group() + ", " + text[found.start() :]).encode()


@kind("damaged bytes")
def damaged(random: Random, files: dict[str, bytes]) -> None:
    """Cut off, emptied, a flipped bit, a byte order mark, something behind the end."""
    name = random.choice(list(files))
    content = bytearray(files[name])
    how = random.randrange(6)
    if how == 0:
        del content[random.randrange(len(content)) :]
    elif how == 1:
        content.clear()
    elif how == 2:
        content[random.randrange(len(content))] ^= 1 << random.randrange(8)
    elif how == 3:
        content[:0] = b"\xef\xbb\xbf"
    elif how == 4:
        content += random.choice((b"\0", b" x", b"{}", b"\n\n", b"]"))
    else:
        start = random.randrange(len(content))
        content[start : start + random.randrange(1, 20)] = bytes(random.randrange(256) for _ in range(3))
    files[name] = bytes(content)


@kind("nested deeply")
def nested(random: Random, files: dict[str, bytes]) -> None:
    """Brackets in brackets."""
    name = random.choice(JSON_FILES)
    depth = random.choice((50, 500, 2000, 100_000))
    files[name] = files[name].rstrip()[:-1] + b', "more": ' + b"[" * depth + b"]" * depth + b"}"


# The site.


def _panels(site: Any) -> list[Any]:
    return [panel for facade in site["facades"] for panel in facade["panels"]]


@kind("site: a corner moved")
def corner(random: Random, files: dict[str, bytes]) -> None:
    """A corner of a panel somewhere else."""
    _edit(
        files,
        "site.json",
        lambda site: _move(random, random.choice(random.choice(_panels(site))["corners_enu_m"])),
    )


def _move(random: Random, point: list[float]) -> None:
    axis = random.randrange(len(point))
    point[axis] += amount(random)


@kind("site: panels swapped, turned or flattened")
def panels(random: Random, files: dict[str, bytes]) -> None:
    """Panels that change places, look inwards, or have no width."""

    def change(site: Any) -> None:
        one, other = random.choice(_panels(site)), random.choice(_panels(site))
        how = random.randrange(4)
        if how == 0:
            one["corners_enu_m"], other["corners_enu_m"] = other["corners_enu_m"], one["corners_enu_m"]
        elif how == 1:
            one["corners_enu_m"].reverse()
        elif how == 2:
            one["corners_enu_m"][1] = [x + next_to_nothing(random) for x in one["corners_enu_m"][0]]
            one["corners_enu_m"][2] = [x + next_to_nothing(random) for x in one["corners_enu_m"][3]]
        else:
            a, b, c, _ = one["corners_enu_m"]
            one["corners_enu_m"][3] = [a[k] + c[k] - b[k] + amount(random) for k in range(3)]

    _edit(files, "site.json", change)


@kind("site: obstacles moved, grown or added")
def obstacles(random: Random, files: dict[str, bytes]) -> None:
    """A box elsewhere, larger, or new, also around a place that is flown to."""
    at = random.choice(json.loads(files["plan.json"])["viewpoints"])["position_enu_m"]

    def change(site: Any) -> None:
        boxes = [each for each in site["obstacles"] if each.get("box_enu_m")]
        how = random.randrange(3)
        if how == 0 and boxes:
            _move(random, random.choice(random.choice(boxes)["box_enu_m"]))
        elif how == 1 and boxes:
            box = random.choice(boxes)["box_enu_m"]
            size = abs(amount(random))
            box[0], box[1] = [x - size for x in box[0]], [x + size for x in box[1]]
        else:
            size, shift = abs(amount(random)) * 3, [amount(random) for _ in range(3)]
            low = [x + s - size for x, s in zip(at, shift, strict=True)]
            high = [x + s + size for x, s in zip(at, shift, strict=True)]
            site["obstacles"].append({"id": "new", "box_enu_m": [low, high]})

    _edit(files, "site.json", change)


@kind("site: borders, ground and home moved")
def borders(random: Random, files: dict[str, bytes]) -> None:
    """The airspace, the ground below it, home."""

    def change(site: Any) -> None:
        how = random.randrange(3)
        if how == 0:
            _move(random, site["airspace"][random.choice(("min_enu_m", "max_enu_m"))])
        elif how == 1:
            site["airspace"]["ground_z_m"] += amount(random)
        else:
            _move(random, site["home_enu_m"])

    _edit(files, "site.json", change)


@kind("site: no-fly volumes moved or added")
def no_fly(random: Random, files: dict[str, bytes]) -> None:
    """A volume elsewhere, or around a place that is flown to."""
    path = random.choice(json.loads(files["plan.json"])["sorties"])["path_enu_m"]
    x, y, z = random.choice(path)

    def change(site: Any) -> None:
        zones = site["airspace"]["no_fly"]
        if zones and random.random() < 0.5:
            _move(random, random.choice(random.choice(zones)["polygon_enu_m"]))
            return
        size, (dx, dy) = abs(amount(random)) * 2, (amount(random), amount(random))
        polygon = [[x + dx + a * size, y + dy + b * size] for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        if random.random() < 0.3:
            polygon.insert(2, [x + dx, y + dy])
        zones.append({"id": "new", "polygon_enu_m": polygon, "floor_m": z + amount(random) - 1, "ceiling_m": z + 2})

    _edit(files, "site.json", change)


@kind("site: a mesh damaged or renamed")
def mesh(random: Random, files: dict[str, bytes]) -> None:
    """Vertices of the building moved, triangles turned, or another name for its file."""
    name = json.loads(files["site.json"]).get("building_mesh")
    if name is None:
        return
    if random.random() < 0.3:
        other = random.choice(
            ("../x.ply", "/etc/passwd", "x.ply", "a\\b.ply", "C:x.ply", "", ".", "x.obj", "x\0.ply", "a//b")
        )
        _edit(files, "site.json", lambda site: site.update(building_mesh=other))
        return
    content = bytearray(files[name])
    start = content.index(b"end_header\n") + 11
    at = random.randrange(start, len(content) - 4)
    value = random.choice((math.nan, math.inf, 1e30, 0.0, 1e-40, amount(random), 3.5))
    if random.random() < 0.5:
        at = start + 4 * random.randrange((len(content) - start) // 4)
    struct.pack_into("<f", content, min(at, len(content) - 4), value)
    files[name] = bytes(content)


@kind("site: the header of a mesh changed")
def mesh_header(random: Random, files: dict[str, bytes]) -> None:
    """Other counts, types, formats and names in the header of the building's mesh."""
    name = json.loads(files["site.json"]).get("building_mesh")
    if name is None:
        return
    end = files[name].index(b"end_header\n") + 11
    lines = files[name][:end].decode().split("\n")
    k = random.randrange(len(lines))
    words = lines[k].split(" ")
    words[random.randrange(len(words))] = random.choice(
        (
            "-1",
            "0",
            "1",
            "7",
            "99999999999",
            "1e9",
            "double",
            "foo",
            "list",
            "ascii",
            "binary_big_endian",
            "x",
            "vertex",
            "",
            "\xb2",
        )
    )
    lines[k] = " ".join(words)
    if random.random() < 0.2:
        lines.insert(random.randrange(1, len(lines)), random.choice(lines))
    if random.random() < 0.1:
        del lines[random.randrange(len(lines))]
    files[name] = "\n".join(lines).encode() + files[name][end:]


# The plan.


@kind("plan: a view moved")
def view(random: Random, files: dict[str, bytes]) -> None:
    """A view elsewhere, with the path or without."""

    def change(plan: Any) -> None:
        chosen = random.choice(plan["viewpoints"])
        old = list(chosen["position_enu_m"])
        _move(random, chosen["position_enu_m"])
        if random.random() < 0.7:
            _carry(plan, old, chosen["position_enu_m"])

    _edit(files, "plan.json", change)


def _carry(plan: Any, old: list[float], new: list[float]) -> None:
    for sortie in plan["sorties"]:
        sortie["path_enu_m"] = [list(new) if math.dist(p, old) < 1e-3 else p for p in sortie["path_enu_m"]]


@kind("plan: angles changed")
def angles(random: Random, files: dict[str, bytes]) -> None:
    """Heading or pitch of a view."""

    def change(plan: Any) -> None:
        chosen = random.choice(plan["viewpoints"])
        name = random.choice(("heading_deg", "gimbal_pitch_deg"))
        chosen[name] = random.choice(
            (chosen[name] + amount(random), chosen[name] + 360.0, -chosen[name], 180.0, -180.0)
        )

    _edit(files, "plan.json", change)


@kind("plan: a vertex moved, left out or swapped")
def vertex(random: Random, files: dict[str, bytes]) -> None:
    """Legs cut short, led elsewhere, or flown in another order."""

    def change(plan: Any) -> None:
        sortie = random.choice(plan["sorties"])
        path = sortie["path_enu_m"]
        k = random.randrange(len(path))
        how = random.randrange(5)
        if how == 0:
            _move(random, path[k])
        elif how == 1:
            del path[k]
        elif how == 2:
            j = random.randrange(len(path))
            path[j], path[k] = path[k], path[j]
        elif how == 3:
            path.insert(k, [random.uniform(-30, 30) for _ in range(3)])
        else:
            random.shuffle(sortie["viewpoint_ids"])

    _edit(files, "plan.json", change)


@kind("plan: limits weakened or tightened")
def limits(random: Random, files: dict[str, bytes]) -> None:
    """Distances, heights, steps, the camera, the battery and the rules."""

    def change(plan: Any) -> None:
        choices = [
            ("constraints", "min_distance_m", (0.0, 1e-9, 0.5, 5.0, 9.0, 11.0, -1.0)),
            ("constraints", "section_step_deg", (15.0, 45.0, 90.0, 7.0, 0.0, 30.000001)),
            ("constraints", "occlusion", ("on", "off", "auto", "")),
            ("constraints", "whole_panel", (True, False, None)),
            ("constraints", "max_distance_m", (None, 12.0, 15.0, 1e9, 0.0)),
            ("constraints", "min_height_above_ground_m", (None, 0.0, 3.0, 6.0, -5.0)),
            ("camera", "focal_length_mm", (1e-6, 5.0, 12.29, 50.0, 0.0, -12.0)),
            ("camera", "sensor_width_mm", (1e6, 5.0, 17.3, 36.0, -17.3)),
            ("camera", "gimbal_pitch_deg", ([35, -90], [-10, 10], [0, 0], [-180, 90], [-90, 200])),
            ("aircraft", "endurance_s", (60.0, 100.0, 1e6, -1.0, 0.0)),
            ("aircraft", "max_speed_m_s", (0.1, 1.0, 1e6, 0.0, -1.0)),
            ("aircraft", "max_acceleration_m_s2", (0.01, 100.0, -1.0, 0.0)),
            ("aircraft", "max_jerk_m_s3", (None, 0.5, 4.0, 1e6, 0.0, -1.0)),
            ("aircraft", "max_yaw_rate_deg_s", (0.5, 1e6, 0.0, -60.0)),
            ("rules", "battery_reserve", (0.0, 0.9, 0.999, 1.0, -1.0, 2.0)),
            ("rules", "settle_s", (-100.0, 0.0, 300.0)),
            ("rules", "takeoff_landing_s", (-1000.0, 0.0, 5000.0)),
            ("rules", "wind_m_s", (-5.0, 5.0, 11.9, 12.0, 15.0, 20.0)),
            ("rules", "max_speed_m_s", (0.1, 5.0, -1.0, 0.0)),
            ("rules", "at_once", (2, 0, 1)),
            ("coverage", "covered", (0, -1, 1, 10_000, 1e9)),
        ]
        record, name, values = random.choice(choices)
        plan[record][name] = random.choice(values)

    _edit(files, "plan.json", change)


@kind("plan: more is stated than there is")
def stated(random: Random, files: dict[str, bytes]) -> None:
    """Coverage, bounds, lengths and durations."""

    def change(plan: Any) -> None:
        coverage, by = plan["coverage"], random.choice((1, 1, 1, 2, 5, 50))
        how = random.randrange(5)
        if how == 0:
            coverage["covered"] += by
        elif how == 1:
            coverage["reachable_upper_bound"] -= by
        elif how == 2:
            coverage["total"] += random.choice((-1, 1)) * by
        elif how == 3:
            random.choice(plan["sorties"])["duration_s"] *= random.choice((0.1, 0.5, 0.95, 1.5, 10.0, 100.0))
        else:
            random.choice(plan["sorties"])["length_m"] *= random.choice((0.5, 0.995, 2.0))

    _edit(files, "plan.json", change)


@kind("plan: sorties and names mixed up")
def names(random: Random, files: dict[str, bytes]) -> None:
    """A name twice, a view in two sorties or in none, a path that is not there."""

    def change(plan: Any) -> None:
        sortie, how = random.choice(plan["sorties"]), random.randrange(6)
        if how == 0:
            random.choice(plan["viewpoints"])["id"] = plan["viewpoints"][0]["id"]
        elif how == 1:
            sortie["viewpoint_ids"].append(random.choice(plan["viewpoints"])["id"])
        elif how == 2:
            del sortie["viewpoint_ids"][random.randrange(len(sortie["viewpoint_ids"]))]
        elif how == 3:
            plan["sorties"].append(copy.deepcopy(sortie))
        elif how == 4:
            sortie["path_enu_m"] = []
        else:
            sortie["in_passing_ids"] = [sortie["viewpoint_ids"][0]]

    _edit(files, "plan.json", change)


# The proof.


@kind("proof: false witnesses")
def witnesses(random: Random, files: dict[str, bytes]) -> None:
    """Sections that are said to be seen by other views, or from other places."""

    def change(proof: Any) -> None:
        n_views = len(json.loads(files["plan.json"])["viewpoints"])
        seen = proof["seen"]
        for _ in range(random.choice((1, 1, 5, len(seen)))):
            seen[random.randrange(len(seen))] = random.choice((-1, random.randrange(n_views), n_views, -2, 0.5))
        if proof.get("witnesses") and random.random() < 0.3:
            chosen = random.choice(proof["witnesses"])
            chosen[random.randrange(4)] += random.choice((1, amount(random)))

    _edit(files, "plan.proof", change)
    if random.random() < 0.5:
        _edit(files, "plan.json", lambda plan: plan["coverage"].update(covered=plan["coverage"]["covered"] + 1))


@kind("proof: false directions")
def directions(random: Random, files: dict[str, bytes]) -> None:
    """Directions that are turned, too long, or those of other legs."""

    def change(proof: Any) -> None:
        how = random.randrange(4)
        if how == 0:
            _move(random, random.choice(proof["directions"]))
        elif how == 1:
            factor = random.choice((1.1, 2.0, 1e3, -1.0, 1 + 1e-9))
            proof["directions"] = [[factor * x for x in n] for n in proof["directions"]]
        elif how == 2:
            random.shuffle(proof["directions"])
        else:
            legs_of = random.choice(proof[random.choice(("legs", "no_fly", "returns"))])
            legs_of[random.randrange(len(legs_of))] = random.choice(legs_of)

    _edit(files, "plan.proof", change)


@kind("proof: boxes that exclude too much")
def boxes(random: Random, files: dict[str, bytes]) -> None:
    """Trees of other sections, other leaves, other patches, and a bound that they would carry."""

    def change(proof: Any) -> None:
        trees, patches = proof["boxes"], proof["patches"]
        how = random.randrange(6)
        if how == 0 and trees:
            random.choice(trees)[0] = random.randrange(len(proof["seen"]))
        elif how == 1 and trees:
            chosen = random.choice(trees)
            letters = list(chosen[1])
            letters[random.randrange(len(letters))] = random.choice("XYZnlhoigGfdq0123456789.")
            chosen[1] = "".join(letters)
        elif how == 2 and trees:
            trees.append([random.randrange(len(proof["seen"])), random.choice(trees)[1]])
        elif how == 3 and patches:
            patch = random.choice(patches)
            patch.insert(0, random.choice((patch[0], random.randrange(40), -1, 1.5)))
        elif how == 4 and patches:
            random.choice(patches).clear()
        else:
            leaf = random.choice(("n", "l", "h", "o", "i", "g", "G", "f", "d0.", "q0.", "d1.", ""))
            trees.append([random.randrange(len(proof["seen"])), leaf])

    _edit(files, "plan.proof", change)
    by = random.choice((1, 1, 2, 20))
    _edit(
        files,
        "plan.json",
        lambda plan: plan["coverage"].update(reachable_upper_bound=plan["coverage"]["reachable_upper_bound"] - by),
    )


@kind("proof: another way home")
def way_home(random: Random, files: dict[str, bytes]) -> None:
    """Heights of return, and the line that leads out of everything."""

    def change(proof: Any) -> None:
        how = random.randrange(4)
        if how == 0:
            proof["return_height_m"] = random.choice((0.0, 2.0, 5.0, 8.0, 12.0, 40.0, 1e5, -5.0))
        elif how == 1 and proof["outside"]:
            _move(random, random.choice(proof["outside"]))
        elif how == 2:
            proof["outside"] = proof["outside"][: random.randrange(len(proof["outside"]) + 1)]
        else:
            proof["outside"] = [[random.uniform(-50, 50) for _ in range(3)]]

    _edit(files, "plan.proof", change)


# Limits that are set to what is measured.


@kind("grazing: the distance")
def graze_distance(random: Random, files: dict[str, bytes]) -> None:
    """The minimum distance is the distance of the nearest leg."""
    case = Case(files)
    triangles = case.scene.triangles
    nearest = min(segment_triangle_d2(a, b, t) for path in case.paths for a, b in legs(path) for t in triangles)
    value = math.sqrt(nearest) + random.choice((0.0, next_to_nothing(random), 1e-6, 1e-7, -1e-7))
    _edit(files, "plan.json", lambda plan: plan["constraints"].update(min_distance_m=value))


@kind("grazing: borders")
def graze_borders(random: Random, files: dict[str, bytes]) -> None:
    """The airspace, or the least height, ends where a path does."""
    plan = json.loads(files["plan.json"])
    points = [point for sortie in plan["sorties"] for point in sortie["path_enu_m"][1:-1]]
    axis, by, side = random.randrange(3), random.choice((0.0, next_to_nothing(random), 1e-7)), random.choice((min, max))
    lowest_z, end = min(point[2] for point in points), side(point[axis] for point in points)

    def change(site: Any) -> None:
        air = site["airspace"]
        if random.random() < 0.4:
            lowest = air.get("min_height_above_ground_m") or plan["constraints"].get("min_height_above_ground_m") or 5.0
            air["ground_z_m"] = lowest_z - lowest + by
        else:
            air["min_enu_m" if side is min else "max_enu_m"][axis] = end + by

    _edit(files, "site.json", change)


@kind("grazing: no-fly volumes")
def graze_no_fly(random: Random, files: dict[str, bytes]) -> None:
    """A wall, floor or cap runs through a place that is flown to, or beside it."""
    path = random.choice(json.loads(files["plan.json"])["sorties"])["path_enu_m"]
    x, y, z = random.choice(path)
    by = random.choice((0.0, next_to_nothing(random), 1e-3, 5e-4))
    side = random.randrange(3)
    if side == 0:
        polygon, low, high = [[x + by, y - 5], [x + by + 9, y - 5], [x + by + 9, y + 5], [x + by, y + 5]], z - 5, z + 5
    elif side == 1:
        polygon, low, high = [[x - 5, y + by], [x + 5, y + by], [x, y + by + 9]], z - 5, z + 5
    else:
        polygon, low, high = [[x - 5, y - 5], [x + 5, y - 5], [x + 5, y + 5], [x - 5, y + 5]], z + by, z + by + 3
    zone = {"id": "near", "polygon_enu_m": polygon, "floor_m": low, "ceiling_m": high}
    _edit(files, "site.json", lambda site: site["airspace"]["no_fly"].append(zone))


@kind("grazing: the battery")
def graze_battery(random: Random, files: dict[str, bytes]) -> None:
    """The battery lasts as long as the longest sortie."""
    case = Case(files)
    longest = max(float(duration_s(case, sortie).low) for sortie in case.plan["sorties"])
    by = random.choice((0.0, -0.01, next_to_nothing(random), -0.01 + next_to_nothing(random), -1e-7))

    def change(plan: Any) -> None:
        plan["aircraft"]["endurance_s"] = (longest + by) / (1.0 - plan["rules"]["battery_reserve"])

    _edit(files, "plan.json", change)


@kind("grazing: a view on a border")
def graze_view(random: Random, files: dict[str, bytes]) -> None:
    """A view turns until a panel is at the border of its picture, or moves to the border of a section."""
    site = json.loads(files["site.json"])
    corners = random.choice(_panels(site))["corners_enu_m"]
    centroid = [sum(c[k] for c in corners) / 4.0 for k in range(3)]

    def change(plan: Any) -> None:
        chosen, camera = random.choice(plan["viewpoints"]), plan["camera"]
        old = list(chosen["position_enu_m"])
        d = [c - p for c, p in zip(centroid, old, strict=True)]
        by = random.choice((0.0, next_to_nothing(random)))
        half = math.atan(camera["sensor_width_mm"] / (2.0 * camera["focal_length_mm"]))
        how = random.randrange(3)
        if how == 0:
            chosen["gimbal_pitch_deg"] = 0.0
            aimed = math.degrees(math.atan2(d[0], d[1]) + random.choice((-1, 1)) * half)
            chosen["heading_deg"] = (aimed + by + 180.0) % 360.0 - 180.0
        elif how == 1:
            chosen["position_enu_m"][0] = centroid[0] + by
            _carry(plan, old, chosen["position_enu_m"])
        else:
            plan["constraints"]["max_distance_m"] = math.dist(centroid, old) + by

    _edit(files, "plan.json", change)


@kind("grazing: far from the origin")
def graze_far(random: Random, files: dict[str, bytes]) -> None:
    """All of it nearly as far away as coordinates may be, and a limit that is measured there."""
    shift = [random.choice((-1, 1)) * random.uniform(1e3, 9e4) for _ in range(2)]
    for name in JSON_FILES:
        content = json.loads(files[name])
        for path in list(places(content)):
            _shift(content, path, shift)
        files[name] = dumped(content)
    mesh_name = json.loads(files["site.json"]).get("building_mesh")
    if mesh_name is not None:
        files[mesh_name] = _shifted_mesh(files[mesh_name], shift)
    random.choice((graze_distance, graze_borders, graze_no_fly, graze_view))(random, files)


def _shift(content: Any, path: tuple[Any, ...], shift: list[float]) -> None:
    """Move what stands at a path, if it is the first or second coordinate of a place."""
    kinds = [key for key in path if isinstance(key, str)]
    value, axis = _parent(content, path)[path[-1]], path[-1]
    if not isinstance(value, float) or not isinstance(axis, int):
        return
    if kinds[-1].endswith("_enu_m") or kinds == ["outside"]:
        if axis < 2:
            _parent(content, path)[axis] = value + shift[axis]
    elif kinds == ["witnesses"] and len(path) == 3 and axis in (1, 2):
        _parent(content, path)[axis] = value + shift[axis - 1]


def _shifted_mesh(content: bytes, shift: list[float]) -> bytes:
    start = content.index(b"end_header\n") + 11
    n_vertices = int(re.search(rb"element vertex ([0-9]+)", content)[1])  # type: ignore[index]
    moved = bytearray(content)
    for k in range(n_vertices):
        x, y, z = struct.unpack_from("<3f", content, start + 12 * k)
        struct.pack_into("<3f", moved, start + 12 * k, x + shift[0], y + shift[1], z)
    return bytes(moved)


# Missions.


def _missions(files: Files, *endings: str) -> list[str]:
    return [name for name in files if name.endswith(endings)]


def _rewrite_kmz(content: bytes, change: Callable[[str, str], str]) -> bytes:
    source, target = zipfile.ZipFile(io.BytesIO(content)), io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in source.namelist():
            archive.writestr(name, change(name, source.read(name).decode()))
    return target.getvalue()


def _metres(random: Random) -> float:
    return random.choice((amount(random), random.choice((-1, 1)) * 0.01 * (1 + next_to_nothing(random))))


@kind("mission: a waypoint moved")
def waypoint(random: Random, files: dict[str, bytes]) -> None:
    """By a nanometre to 10 m, or by about the tolerance."""
    name = random.choice(_missions(files, ".kmz", ".plan", ".waypoints"))
    metres, axis = _metres(random), random.randrange(3)
    degrees = metres / (111_000.0 if axis == 0 else 103_000.0)
    if name.endswith(".kmz"):
        which = random.randrange(1000)

        def change(member: str, text: str) -> str:
            if axis == 2:
                found = list(re.finditer(r"<wpml:(executeHeight|height|ellipsoidHeight)>([^<]*)<", text))
                if member.endswith("kml") or not found:
                    return text
                one = found[which % len(found)]
                return text[: one.start(2)] + repr(float(one.group(2)) + metres) + text[one.end(2) :]
            found = list(re.finditer(r"<coordinates>([^,]*),([^<]*)<", text))
            one = found[which % len(found)]
            group = 2 if axis == 0 else 1
            return text[: one.start(group)] + repr(float(one.group(group)) + degrees) + text[one.end(group) :]

        files[name] = _rewrite_kmz(files[name], change)
    elif name.endswith(".plan"):

        def edit(content: Any) -> None:
            item = random.choice([each for each in content["mission"]["items"] if each["frame"] == 3])
            item["params"][4 + axis] += metres if axis == 2 else degrees
            if axis == 2 and "Altitude" in item:
                item["Altitude"] = item["params"][6]

        _edit(files, name, edit)
    else:
        lines = files[name].decode().split("\n")
        k = random.choice([k for k, line in enumerate(lines) if k > 1 and line.split("\t")[2:3] == ["3"]])
        fields = lines[k].split("\t")
        fields[8 + axis] = repr(float(fields[8 + axis]) + (metres if axis == 2 else degrees))
        lines[k] = "\t".join(fields)
        files[name] = "\n".join(lines).encode()


@kind("mission: what is done on the way changed")
def actions(random: Random, files: dict[str, bytes]) -> None:
    """Angles, modes, commands and frames; parts left out, doubled or swapped."""
    name = random.choice(_missions(files, ".kmz", ".plan", ".waypoints"))
    seed = random.randrange(10**9)
    if name.endswith(".kmz"):
        only = random.choice(("template.kml", "waylines.wpml", "l"))
        files[name] = _rewrite_kmz(
            files[name], lambda member, text: _changed_xml(Random(seed), text) if member.endswith(only) else text
        )
    elif name.endswith(".plan"):

        def edit(content: Any) -> None:
            items = content["mission"]["items"]
            k, how = random.randrange(len(items)), random.randrange(6)
            if how == 0:
                del items[k]
            elif how == 1:
                j = random.randrange(len(items))
                items[j], items[k] = items[k], items[j]
            elif how == 2:
                items[k]["command"] = random.choice(
                    (16, 17, 18, 19, 20, 21, 22, 82, 92, 93, 112, 115, 177, 178, 206, 2001)
                )
            elif how == 3:
                items[k]["frame"] = random.choice((0, 1, 2, 3, 5, 6, 8, 10, 11))
            elif how == 4:
                items[k]["params"][random.randrange(7)] = random.choice((None, 0.0, 1.0, -1.0, 90.0, 1e308, True, "1"))
            else:
                path = _somewhere(random, content)
                _parent(content, path)[path[-1]] = random.choice(ODD)

        _edit(files, name, edit)
    else:
        lines = files[name].decode().split("\n")
        k, how = random.randrange(len(lines) - 1), random.randrange(4)
        if how == 0:
            del lines[k]
        elif how == 1:
            j = random.randrange(len(lines) - 1)
            lines[j], lines[k] = lines[k], lines[j]
        elif how == 2:
            fields = re.split(r"\t", lines[k])
            j = random.randrange(len(fields))
            fields[j] = random.choice(
                ("0", "1", "-1", "nan", "inf", "1e400", "1_0", "16", "17", "177", "10", "\u0663", "", " 1", "0x10")
            )
            lines[k] = "\t".join(fields)
        else:
            lines[k] = lines[k].replace("\t", random.choice((" ", "\x0b", "\u2003", ",", "\t\t")))
        files[name] = "\n".join(lines).encode()


def _changed_xml(random: Random, text: str) -> str:
    how = random.randrange(9)
    tags = list(re.finditer(r"<([A-Za-z:]+)>([^<]*)</\1>", text))
    one, other = random.choice(tags), random.choice(tags)
    if how == 0:
        value = random.choice(
            (
                "0",
                "1",
                "-1",
                "90",
                "nan",
                "1e400",
                "",
                "x",
                "goHome",
                "noAction",
                "pointToPoint",
                "coordinateTurn",
                "WGS84",
            )
        )
        return text[: one.start(2)] + value + text[one.end(2) :]
    if how == 1:
        return text[: one.start()] + text[one.end() :]
    if how == 2:
        return text[: one.end()] + one.group() + text[one.end() :]
    if how == 3:
        return text[: one.start(2)] + other.group(2) + text[one.end(2) :]
    if how == 4:
        angles = list(re.finditer(r"<wpml:(aircraftHeading|gimbalPitchRotateAngle)>([^<]*)<", text))
        one = random.choice(angles) if angles else one
        changed = (
            repr(float(one.group(2)) + random.choice((amount(random), 0.01 * (1 + next_to_nothing(random)))))
            if angles
            else ""
        )
        return text[: one.start(2)] + changed + text[one.end(2) :]
    if how == 5:
        entity = '<!DOCTYPE kml [<!ENTITY x "0"><!ENTITY y "&x;&x;&x;">]>'
        return text.replace("?>", "?>" + entity, 1).replace(f">{one.group(2)}<", ">&y;<", 1)
    if how == 6:
        return (
            text[: one.start()]
            + random.choice(("<!-- x -->", "<![CDATA[x]]>", "<?x y?>", "&amp;", "&#48;", "x"))
            + text[one.start() :]
        )
    if how == 7:
        marks = list(re.finditer(r"(?s)\s*<Placemark>.*?</Placemark>", text))
        mark = random.choice(marks)
        again = random.choice(("", mark.group() * 2, random.choice(marks).group()))
        return text[: mark.start()] + again + text[mark.end() :]
    return text[: random.randrange(len(text))]


@kind("mission: archives damaged or doubled")
def archive(random: Random, files: dict[str, bytes]) -> None:
    """Members twice, cut off, with other sizes, or with another file behind or before."""
    found = _missions(files, ".kmz")
    if not found:
        return
    name = random.choice(found)
    content, how = files[name], random.randrange(5)
    if how == 0:
        target = io.BytesIO(content)
        import warnings

        with warnings.catch_warnings(), zipfile.ZipFile(target, "a") as more:
            warnings.simplefilter("ignore")
            member = random.choice(("wpmz/waylines.wpml", "wpmz/other.kml", "../x", "wpmz/res/a.jpg"))
            more.writestr(member, zipfile.ZipFile(io.BytesIO(content)).read("wpmz/waylines.wpml"))
        files[name] = target.getvalue()
    elif how == 1:
        files[name] = content[: random.randrange(len(content))]
    elif how == 2:
        changed = bytearray(content)
        at = random.choice((content.index(b"PK\1\2"), content.index(b"PK\5\6"), 0)) + random.randrange(30)
        changed[min(at, len(changed) - 1)] ^= 1 << random.randrange(8)
        files[name] = bytes(changed)
    elif how == 3:
        files[name] = random.choice((b"x", b"PK\5\6" + bytes(18))) + content
    else:
        files[name] = content + random.choice((b"x", content))


@kind("mission: left out, doubled or renamed")
def set_of_missions(random: Random, files: dict[str, bytes]) -> None:
    """One file fewer, one twice, one under another ending."""
    name = random.choice(_missions(files, ".kmz", ".plan", ".waypoints"))
    how = random.randrange(3)
    if how == 0:
        del files[name]
    elif how == 1:
        stem, ending = name.rsplit(".", 1)
        files[f"{stem}-again.{ending}"] = files[name]
    else:
        files[f"{name.rsplit('.', 1)[0]}-x.{random.choice(('kmz', 'plan', 'waypoints', 'txt', 'kml'))}"] = files.pop(
            name
        )


def of_kinds(random: Random, n: int) -> Iterator[str]:
    """Kinds of n tamperings: all of them in turn, in any order."""
    found = list(TAMPERINGS)
    for k in range(n):
        if k % len(found) == 0:
            random.shuffle(found)
        yield found[k % len(found)]

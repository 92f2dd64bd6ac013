"""Tampered sites, plans, proofs and missions: what an error, a careless edit or an attacker would make of them.

A tampering changes files; `sealed` then makes all hashes right again, as anybody can who tampers, so that nothing but
the claims themselves is in its way. `grazing` ones set a limit to the value that is measured, give or take next to
nothing: there a claim is lost or kept by rounding alone.
"""

from __future__ import annotations

import base64
import copy
import json
import math
import re
import struct
import zlib
from collections.abc import Iterator
from random import Random
from typing import Any

from tests.planning.proof import tampering_missions
from tests.planning.proof.claims import Case, duration_s
from tests.planning.proof.exact import segment_triangle_d2
from tests.planning.proof.judge import legs
from tests.planning.proof.tamper import (
    JSON_FILES,
    ODD,
    TAMPERINGS,
    amount,
    dumped,
    edit,
    kind,
    next_to_nothing,
    parent_of,
    places,
    sealed,
    somewhere,
    tampered,
)

__all__ = ["TAMPERINGS", "of_kinds", "sealed", "tampered", "tampering_missions"]

# Everywhere in a JSON file.


@kind("odd values")
def odd_value(random: Random, files: dict[str, bytes]) -> None:
    """NaN, Infinity, 1e308, 1e-308, other types."""
    name = random.choice(JSON_FILES)

    def change(content: Any) -> None:
        path = somewhere(random, content)
        parent_of(content, path)[path[-1]] = random.choice(ODD)

    edit(files, name, change)


@kind("numbers scaled")
def scaled_number(random: Random, files: dict[str, bytes]) -> None:
    """A number times a factor, or moved."""
    name = random.choice(JSON_FILES)

    def change(content: Any) -> None:
        for _ in range(20):
            path = somewhere(random, content)
            value = parent_of(content, path)[path[-1]]
            if isinstance(value, (int, float)) and not isinstance(value, bool):
                factor = random.choice((1 + next_to_nothing(random), 0.5, 2.0, -1.0, 1e3, 1e-3))
                parent_of(content, path)[path[-1]] = random.choice((value * factor, value + amount(random)))
                return

    edit(files, name, change)


@kind("parts missing, doubled or swapped")
def structure(random: Random, files: dict[str, bytes]) -> None:
    """A key or an entry that is missing, is there twice, or changes places with another."""
    name = random.choice(JSON_FILES)

    def change(content: Any) -> None:
        path = somewhere(random, content)
        parent = parent_of(content, path)
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

    edit(files, name, change)


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
    edit(
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

    edit(files, "site.json", change)


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

    edit(files, "site.json", change)


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

    edit(files, "site.json", change)


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

    edit(files, "site.json", change)


@kind("site: terrain below, as high as flights allow")
def terrain(random: Random, files: dict[str, bytes]) -> None:
    """Heights that the paths keep by next to nothing, or miss; with holes, too few nodes, or other steps."""
    paths = [sortie["path_enu_m"] for sortie in json.loads(files["plan.json"])["sorties"]]
    lowest = json.loads(files["plan.json"])["constraints"].get("min_height_above_ground_m") or 5.0
    shape, step, by = (12, 12), 5.0, random.choice((-0.5, -0.1, -0.002, 0.0, 0.001, 0.3))
    heights = [random.uniform(-2.0, 0.2) for _ in range(shape[0] * shape[1])]
    for x, y, z in random.choice(paths)[1:-1]:
        column, row = min(max(int((x + 29.0) / step), 0), 10), min(max(int((y + 29.0) / step), 0), 10)
        for node in (12 * row + column, 12 * row + column + 1, 12 * row + column + 12, 12 * row + column + 13):
            if random.random() < 0.5:
                heights[node] = z - lowest + by
    packed = struct.pack("<144i", *(round(1000.0 * height) for height in heights))
    if random.random() < 0.2:
        at = 4 * random.randrange(144)
        packed = packed[:at] + random.choice((b"\0\0\0\x80", b"", b"\0\0\0\x7f")) + packed[at + 4 :]
    text = base64.b64encode(zlib.compress(packed)).decode()
    record = {"west_south_m": [-29.0, -29.0], "step_m": step, "columns": 12, "rows": 12, "upper": text}
    record |= {"ground": text, "lower": text, "accuracy_m": random.choice((0.0, 0.0, 0.1)), "use": "auto"}
    if random.random() < 0.2:
        name, value = random.choice(
            (("use", "off"), ("rows", 11), ("columns", 24), ("step_m", 2.0), ("accuracy_m", -1.0))
        )
        record[name] = value
    edit(files, "site.json", lambda site: site.update(terrain=record))
    if random.random() < 0.3:  # as level as the proof says, nearly, or not at all
        within = random.choice((0.3, 0.5, 0.51, 0.52, 2.0))
        level = [
            random.choice((-1, 1)) * round(1000.0 * within * random.choice((0.0, 0.9, 0.999, 1.0))) for _ in heights
        ]
        level[random.randrange(144)] += random.choice((0, 0, 1, -1, 300))
        record["upper"] = base64.b64encode(zlib.compress(struct.pack("<144i", *level))).decode()
        edit(files, "site.json", lambda site: site.update(terrain=record))
        edit(files, "plan.proof", lambda proof: proof.update(level_within_m=within))


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
        edit(files, "site.json", lambda site: site.update(building_mesh=other))
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

    edit(files, "plan.json", change)


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

    edit(files, "plan.json", change)


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

    edit(files, "plan.json", change)


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

    edit(files, "plan.json", change)


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

    edit(files, "plan.json", change)


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

    edit(files, "plan.json", change)


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

    edit(files, "plan.proof", change)
    if random.random() < 0.5:
        edit(files, "plan.json", lambda plan: plan["coverage"].update(covered=plan["coverage"]["covered"] + 1))


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

    edit(files, "plan.proof", change)


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
            letters[random.randrange(len(letters))] = random.choice("XYZpctdq0123456789.")
            chosen[1] = "".join(letters)
        elif how == 2 and trees:
            trees.append([random.randrange(len(proof["seen"])), random.choice(trees)[1]])
        elif how == 3 and patches:
            patch = random.choice(patches)
            patch.insert(0, random.choice((patch[0], random.randrange(40), -1, 1.5)))
        elif how == 4 and patches:
            random.choice(patches).clear()
        else:
            leaf = random.choice(("p", "c", "t", "d0.", "q0.", "d1.", "Xpp", ""))
            trees.append([random.randrange(len(proof["seen"])), leaf])

    edit(files, "plan.proof", change)
    by = random.choice((1, 1, 2, 20))
    edit(
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

    edit(files, "plan.proof", change)


# Limits that are set to what is measured.


@kind("grazing: the distance")
def graze_distance(random: Random, files: dict[str, bytes]) -> None:
    """The minimum distance is the distance of the nearest leg."""
    case = Case(files)
    triangles = case.scene.triangles
    nearest = min(segment_triangle_d2(a, b, t) for path in case.paths for a, b in legs(path) for t in triangles)
    value = math.sqrt(nearest) + random.choice((0.0, next_to_nothing(random), 1e-6, 1e-7, -1e-7))
    edit(files, "plan.json", lambda plan: plan["constraints"].update(min_distance_m=value))


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

    edit(files, "site.json", change)


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
    edit(files, "site.json", lambda site: site["airspace"]["no_fly"].append(zone))


@kind("grazing: the battery")
def graze_battery(random: Random, files: dict[str, bytes]) -> None:
    """The battery lasts as long as the longest sortie."""
    case = Case(files)
    longest = max(float(duration_s(case, sortie).low) for sortie in case.plan["sorties"])
    by = random.choice((0.0, -0.01, next_to_nothing(random), -0.01 + next_to_nothing(random), -1e-7))

    def change(plan: Any) -> None:
        plan["aircraft"]["endurance_s"] = (longest + by) / (1.0 - plan["rules"]["battery_reserve"])

    edit(files, "plan.json", change)


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

    edit(files, "plan.json", change)


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
    value, axis = parent_of(content, path)[path[-1]], path[-1]
    if not isinstance(value, float) or not isinstance(axis, int):
        return
    if kinds[-1].endswith("_enu_m") or kinds == ["outside"]:
        if axis < 2:
            parent_of(content, path)[axis] = value + shift[axis]
    elif kinds == ["witnesses"] and len(path) == 3 and axis in (1, 2):
        parent_of(content, path)[axis] = value + shift[axis - 1]


def _shifted_mesh(content: bytes, shift: list[float]) -> bytes:
    start = content.index(b"end_header\n") + 11
    n_vertices = int(re.search(rb"element vertex ([0-9]+)", content)[1])  # type: ignore[index]
    moved = bytearray(content)
    for k in range(n_vertices):
        x, y, z = struct.unpack_from("<3f", content, start + 12 * k)
        struct.pack_into("<3f", moved, start + 12 * k, x + shift[0], y + shift[1], z)
    return bytes(moved)


def of_kinds(random: Random, n: int) -> Iterator[str]:
    """Kinds of n tamperings: all of them in turn, in any order."""
    found = list(TAMPERINGS)
    for k in range(n):
        if k % len(found) == 0:
            random.shuffle(found)
        yield found[k % len(found)]

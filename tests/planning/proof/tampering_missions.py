"""Tampered missions: waypoints moved, actions and modes changed, archives damaged, files left out or doubled."""

from __future__ import annotations

import io
import re
import warnings
import zipfile
from collections.abc import Callable
from random import Random
from typing import Any

from tests.planning.proof.claims import Files
from tests.planning.proof.tamper import ODD, amount, edit, kind, next_to_nothing, parent_of, somewhere


def _missions(files: Files, *endings: str) -> list[str]:
    return [name for name in files if name.endswith(endings)]


def _rewrite_kmz(content: bytes, change: Callable[[str, str], str]) -> bytes:
    """Members changed in an archive that is as before otherwise: it is their texts that are to be looked at."""
    source, target = zipfile.ZipFile(io.BytesIO(content)), io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for old in source.infolist():
            member = zipfile.ZipInfo(old.filename, old.date_time)
            member.compress_type, member.create_system, member.external_attr = zipfile.ZIP_DEFLATED, 3, 0o644 << 16
            archive.writestr(member, change(old.filename, source.read(old).decode()))
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

        def change_plan(content: Any) -> None:
            item = random.choice([each for each in content["mission"]["items"] if each["frame"] == 3])
            item["params"][4 + axis] += metres if axis == 2 else degrees
            if axis == 2 and "Altitude" in item:
                item["Altitude"] = item["params"][6]

        edit(files, name, change_plan)
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

        def change_plan(content: Any) -> None:
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
                path = somewhere(random, content)
                parent_of(content, path)[path[-1]] = random.choice(ODD)

        edit(files, name, change_plan)
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

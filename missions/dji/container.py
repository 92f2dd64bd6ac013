"""Where the two parts of a DJI mission lie: in the folder wpmz of a KMZ, or side by side in an unpacked folder."""

from __future__ import annotations

import io
from dataclasses import dataclass
from pathlib import Path

from missions.dji.wpml import WpmlDocument, parse_wpml
from missions.mission.safe_files import open_archive, read_limited, read_member
from planning.base.errors import MissionError
from planning.base.messages import about, say

TEMPLATE, WAYLINES = "template.kml", "waylines.wpml"


@dataclass(frozen=True, slots=True)
class DjiParts:
    """The parts of a mission; without a template only some programs open it."""

    waylines: WpmlDocument
    template: WpmlDocument | None


def load_parts(path: Path) -> DjiParts:
    """Parts of a mission from a KMZ, from a folder that holds them (or their folder wpmz), or from one of the two.

    Raises
    ------
    InputError
        The file or folder is missing or unreadable.
    MissionError
        It is no DJI mission, has another layout than DJI's programs find, or is hostile.
    """
    if path.is_dir() or path.name in (TEMPLATE, WAYLINES):
        return _from_folder(path if path.is_dir() else path.parent)
    return _from_archive(path, str(path))


def parts_of_kmz(content: bytes) -> DjiParts:
    """Parts of a KMZ that is not in a file yet."""
    return _from_archive(io.BytesIO(content), "KMZ")


def _from_archive(source: Path | io.BytesIO, label: str) -> DjiParts:
    archive, members = open_archive(source, label)
    with archive:
        waylines = members.get(f"wpmz/{WAYLINES}")
        if waylines is None:
            raise MissionError(about(label, _what_is_there(set(members))))
        template = members.get(f"wpmz/{TEMPLATE}")
        inside = f"{label}: wpmz/"
        return DjiParts(
            parse_wpml(read_member(archive, waylines, label), inside + WAYLINES),
            None if template is None else parse_wpml(read_member(archive, template, label), inside + TEMPLATE),
        )


def _from_folder(folder: Path) -> DjiParts:
    inner = folder / "wpmz"
    folder = inner if inner.is_dir() else folder
    if not (folder / WAYLINES).is_file():
        raise MissionError(say("expected the {} of an unpacked DJI mission, there is none", WAYLINES, place=folder))
    template = folder / TEMPLATE
    return DjiParts(
        parse_wpml(read_limited(folder / WAYLINES), str(folder / WAYLINES)),
        parse_wpml(read_limited(template), str(template)) if template.is_file() else None,
    )


def _what_is_there(names: set[str]) -> str:
    """Why an archive without wpmz/waylines.wpml is no mission, from what it holds instead."""
    at_root = sorted(names & {TEMPLATE, WAYLINES})
    elsewhere = sorted(name for name in names if name.endswith(("/" + TEMPLATE, "/" + WAYLINES)))
    if at_root:
        return say(
            "{} at the top of the archive, where no DJI program looks; expected both in its folder wpmz; "
            "pack it again with that folder",
            " and ".join(at_root),
        )
    if f"wpmz/{TEMPLATE}" in names:
        return say(
            "has a template but no waylines, so what would be flown is not in it; open and save it in DJI Pilot 2"
        )
    if elsewhere:
        return say("has {}; expected wpmz/{} at the top of the archive; pack it again", elsewhere[0], WAYLINES)
    return say("no DJI mission; expected wpmz/{}, found {}", WAYLINES, ", ".join(sorted(names)[:3]) or "nothing")

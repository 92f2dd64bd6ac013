"""Use cases around the geo-zones of a site: add files, take them away, permit and answer, list what applies.

A file is taken over as it is, beside the site file, under its SHA-256. Permissions and answers belong to one state of a
file: a new state of it begins without any. A permission opens a zone to flights. The answer that what cannot be read of
a zone is not here leaves closed what can be read of it.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import date, datetime
from pathlib import Path, PurePath
from typing import Any

from groundstation.services.project.input_files import read_input_site
from groundstation.services.project.site import file_stem, is_plain
from groundstation.services.site.edits import input_checked, with_site
from planning.base.errors import InputError
from planning.base.files import read_input_file, real_path
from planning.base.json_file import check_output, write_together
from planning.base.messages import glue, say
from planning.base.progress import QUIET, Monitor
from planning.checks.zones import answer_text, source_text, zone_text
from planning.site.file import site_bytes
from planning.site.records import SiteModel
from planning.site.zones.keep_out import NearZone, at_time, known_files, near_zones, site_zones
from planning.site.zones.reading import ZONES_FILE, known_zones
from planning.site.zones.records import SiteZones, Zone, ZoneFile, ZoneSet
from planning.site.zones.times import State

LISTED_WINDOW_S = 3600.0
"""Time after take-off in which listed zones are looked at: nothing is known of the flight yet."""

OPEN_ZONE = say(
    "where it lies is an open question: no flight is ready until somebody says that it is not here (--not-here), or "
    "permits it (--permit)"
)
"""What becomes of a zone whose place the file does not say for sure."""


@dataclass(frozen=True, slots=True, eq=False)
class AddedZones:
    """A site with more files of zones.

    Parameters
    ----------
    notes
        What is worth knowing: permissions and answers that ended with the state of a file that they belonged to.
    """

    model: SiteModel
    notes: tuple[str, ...]


def add_zones(model: SiteModel, paths: Sequence[Path], today: date, monitor: Monitor = QUIET) -> AddedZones:
    """The site with files of zones, each under its own name; one of the same name is replaced.

    Raises
    ------
    InputError
        A file cannot be read whole, is of no known format, or holds no zone; nothing is added then.
    """
    notes: list[str] = []
    for number, path in enumerate(paths):
        monitor.report(say("reading geo-zones"), number, len(paths))
        content = read_input_file(path, ZONES_FILE)
        read = known_zones(content, path)
        if isinstance(read, InputError):
            raise read
        name = path.name if is_plain(path.name) else f"{file_stem(path.stem) or 'zones'}{path.suffix}"
        model = _with_file(model, name, content, today, notes)
    return AddedZones(model, tuple(notes))


def _with_file(model: SiteModel, name: str, content: bytes, today: date, notes: list[str]) -> SiteModel:
    sha256 = hashlib.sha256(content).hexdigest()
    before = next((source for source in model.site.zones if PurePath(source.file).name == name), None)
    source = ZoneFile(name if before is None else before.file, sha256, today.isoformat())
    if before is not None and before.sha256 == sha256:
        source = replace(source, permitted=before.permitted, not_here=before.not_here)
    elif before is not None and (ended := dict.fromkeys((*before.permitted, *before.not_here))):
        stated = ", ".join(f"'{zone_id}'" for zone_id in ended)
        text = say("permissions and answers of the old state of '{}' have ended, state them again: {}", name, stated)
        notes.append(text)
    return _with_sources(model, source, before, site_zones(source, content))


def _with_sources(model: SiteModel, source: ZoneFile, before: ZoneFile | None, found: SiteZones) -> SiteModel:
    if before is None:
        sources = (*model.site.zones, source)
    else:
        sources = tuple(source if each == before else each for each in model.site.zones)
    zones = (*(each for each in model.zones if each.source != before), found)
    with input_checked():
        site = replace(model.site, zones=sources)
    return replace(with_site(model, site), zones=zones)


def remove_zones(model: SiteModel, name: str) -> SiteModel:
    """The site without one of its files of zones.

    Raises
    ------
    InputError
        It has none of that name.
    """
    kept = tuple(source for source in model.site.zones if name not in (source.file, PurePath(source.file).name))
    if len(kept) == len(model.site.zones):
        known = ", ".join(source.file for source in model.site.zones) or say("none")
        raise InputError.say("the site has no file of geo-zones '{}'; it has: {}", name, known)
    zones = tuple(each for each in model.zones if each.source in kept)
    return replace(with_site(model, replace(model.site, zones=kept)), zones=zones)


def permit(model: SiteModel, zone_id: str, reference: str, file: str = "") -> SiteModel:
    """The site with the pilot's authorisation for a zone; an empty reference takes it back.

    A zone that several files hold in the same way, as those of neighbouring map sheets do, is permitted in all.

    Parameters
    ----------
    zone_id
        Or "FILE/ZONE".
    file
        In which the zone is, where several have another one of that identifier.

    Raises
    ------
    InputError
        No file of the site has such a zone, or several have.
    """
    for before, zone in _of_zone(model, zone_id, file):
        source = replace(before, permitted=_with_reference(before.permitted, zone.id, reference))
        model = _with_source(model, before, source)
    return model


def not_here(model: SiteModel, zone_id: str, reference: str, file: str = "") -> SiteModel:
    """The site with who says that what cannot be read of a zone's place is not here; empty takes it back.

    Parameters and further errors as `permit`.

    Raises
    ------
    InputError
        The file leaves nothing open of where the zone lies.
    """
    of_zone = _of_zone(model, zone_id, file)
    sources = [source for source, _ in of_zone]
    unsure = {each.local.zone for each in near_zones(model) if each.source in sources and each.local.is_unsure}
    if reference.strip() and not any(zone in unsure or zone.place_questions for _, zone in of_zone):
        raise InputError.say(
            "zone '{}' leaves nothing open about where it lies, so there is nothing to answer; if flights may enter "
            "it, state the authorisation (--permit)",
            of_zone[0][1].id,
        )
    for before, zone in of_zone:
        source = replace(before, not_here=_with_reference(before.not_here, zone.id, reference))
        model = _with_source(model, before, source)
    return model


def _of_zone(model: SiteModel, zone_id: str, file: str) -> list[tuple[ZoneFile, Zone]]:
    """Files that hold a zone, and the zone as each has it: the same; parameters and errors as `permit`."""
    named = next((source.file for source in model.site.zones if zone_id.startswith(f"{source.file}/")), "")
    if named and not file:
        file, zone_id = named, zone_id.removeprefix(f"{named}/")
    of_zone = [
        (known.source, zone)
        for known in known_files(model)
        if known.content is not None and file in ("", known.source.file)
        for zone in known.content.zones
        if zone.id == zone_id
    ]
    if not of_zone:
        near = ", ".join(f"'{each.local.zone.id}'" for each in near_zones(model)) or say("none")
        raise InputError.say("there is no zone '{}' in the site's files; those near it are: {}", zone_id, near)
    if any(zone != of_zone[0][1] for _, zone in of_zone):
        files = ", ".join(source.file for source, _ in of_zone)
        raise InputError.say("zone '{}' differs between files ({}); name one as FILE/ZONE", zone_id, files)
    return of_zone


def _with_reference(stated: Mapping[str, str], zone_id: str, reference: str) -> dict[str, str]:
    others = {key: value for key, value in stated.items() if key != zone_id}
    return {**others, zone_id: reference.strip()} if reference.strip() else others


def _with_source(model: SiteModel, before: ZoneFile, source: ZoneFile) -> SiteModel:
    found = next(each for each in model.zones if each.source == before)
    return _with_sources(model, source, before, replace(found, source=source))


def write_zones(path: Path, model: SiteModel) -> SiteModel:
    """Write a site file and its files of zones beside it, all or none; returns the site as it is in the files.

    Raises
    ------
    InputError
        A name is taken by another file, or something cannot be written.
    """
    folder = path.parent
    new: dict[Path, bytes] = {}
    for each in model.zones:
        target = folder / each.source.file
        if not each.content or each.problem:
            continue
        if target.exists() and read_input_file(target, ZONES_FILE) != each.content:
            old = {source.file for source in read_input_site(path).site.zones} if path.exists() else set()
            if each.source.file not in old:
                raise InputError.say("there is another file of that name beside the site; rename one", place=target)
        if not target.exists() or read_input_file(target, ZONES_FILE) != each.content:
            new[target] = each.content
    content = site_bytes(model.site)
    write_together({path: content, **new})
    return replace(model, sha256=hashlib.sha256(content).hexdigest())


def zones_of_site(
    site_path: Path,
    paths: Sequence[Path] = (),
    *,
    out: Path | None = None,
    permissions: Mapping[str, str] | None = None,
    answers: Mapping[str, str] | None = None,
    removed: Iterable[str] = (),
    today: date,
    monitor: Monitor = QUIET,
) -> AddedZones:
    """A site file with its zones, changed and written where anything of it changes.

    Parameters
    ----------
    permissions, answers
        References by zone: see `permit`, `not_here`.

    Raises
    ------
    InputError
        As the edits, or `out` lies in another folder than the site, whose meshes it names.
    """
    target = site_path if out is None else out
    if real_path(target.parent) != real_path(site_path.parent):
        raise InputError.say("expected a file in the folder of the site, since it names meshes there", place=target)
    before = read_input_site(site_path)
    added = add_zones(before, paths, today, monitor)
    model = added.model
    for name in removed:
        model = remove_zones(model, name)
    for zone_id, reference in (permissions or {}).items():
        model = permit(model, zone_id, reference)
    for zone_id, reference in (answers or {}).items():
        model = not_here(model, zone_id, reference)
    if model is not before or out is not None:
        check_output(target)
        model = write_zones(target, model)
    return AddedZones(model, added.notes)


@dataclass(frozen=True, slots=True)
class ZoneRow:
    """A zone near a site, for a list.

    Parameters
    ----------
    what
        Name, restriction, reasons and heights, in words.
    distance_m
        Horizontally from the airspace box; infinite where nobody knows.
    is_open
        Whether it is not known for sure where it lies, and nobody has answered: no flight is ready until then.
    permitted, not_here
        References of the authorisation, and of who says that what cannot be read of it is not here; empty for none.
    """

    id: str
    file: str
    what: str
    distance_m: float
    is_kept: bool
    is_open: bool
    state: str
    permitted: str
    not_here: str
    questions: tuple[str, ...]


def zone_rows(model: SiteModel, at: datetime | None = None) -> tuple[ZoneRow, ...]:
    """Zones near a site, the nearest first; `at` is a take-off."""
    rows = [_row(near) for near in near_zones(at_time(model, at, LISTED_WINDOW_S))]
    return tuple(sorted(rows, key=lambda row: row.distance_m))


def _row(near: NearZone) -> ZoneRow:
    zone, local = near.local.zone, near.local
    return ZoneRow(
        zone.id,
        near.source.file,
        zone_text(near),
        local.distance_m,
        near.is_kept,
        bool(near.open_places),
        near.state.value,
        near.permitted,
        near.not_here,
        local.all_questions,
    )


def zones_summary(model: SiteModel, at: datetime | None = None) -> dict[str, Any]:
    """Files and near zones of a site as JSON."""
    files = [
        {
            "file": known.source.file,
            "sha256": known.source.sha256,
            "imported": known.source.imported,
            "problem": known.problem,
            **({} if known.content is None else _content_summary(known.content)),
        }
        for known in known_files(model)
    ]
    rows = [
        {field: getattr(row, field) for field in ZoneRow.__slots__}
        | {"distance_m": row.distance_m if math.isfinite(row.distance_m) else None}
        for row in zone_rows(model, at)
    ]
    return {"files": files, "zones": rows}


def _content_summary(content: ZoneSet) -> dict[str, Any]:
    issued = content.issued
    return {
        "format": content.format,
        "publisher": content.publisher,
        "issued": None if issued is None else issued.isoformat(),
        "zones": len(content.zones),
    }


def zone_facts(near: NearZone) -> tuple[str, ...]:
    """What the window says of a zone, line by line."""
    zone = near.local.zone
    lines = [zone_text(near), *(text for text in (zone.conditions, zone.message) if text)]
    lines.append(_kept_text(near))
    if near.state is not State.APPLIES:
        lines.append(say("it applies at some times only"))
    for authority in zone.authorities:
        told = ", ".join(
            text for text in (authority.name, authority.contact, authority.purpose, authority.interval_before) if text
        )
        lines.append(say("authority: {}", told))
    return (*lines, *(say("question: {}", question) for question in near.local.all_questions))


def _kept_text(near: NearZone) -> str:
    """Whether plans keep out of a zone, and who says what of it."""
    if near.permitted:
        return say("permitted by '{}': plans may enter all of it", near.permitted)
    if near.open_places:
        return OPEN_ZONE
    kept = say("plans keep out of it") if near.is_kept else say("plans need not keep out of it")
    if not near.not_here:
        return kept
    return glue(kept if near.local.volumes else say("its place is not known"), "; ", answer_text(near))


def zone_lines(near: NearZone, model: SiteModel) -> tuple[str, ...]:
    """What a view says of a zone under the pointer: what it is, where it counts here, whether flights keep out."""
    zone, home_z_m = near.local.zone, model.site.home_enu_m[2]
    lines = [zone_text(near)]
    floor_m = min((each.floor_m for each in near.local.volumes), default=-math.inf)
    ceiling_m = max((each.ceiling_m for each in near.local.volumes), default=math.inf)
    if math.isfinite(floor_m) and math.isfinite(ceiling_m):
        lines.append(say("from {:.0f} m to {:.0f} m above home", floor_m - home_z_m, ceiling_m - home_z_m))
    elif math.isfinite(ceiling_m):
        lines.append(say("from the ground to {:.0f} m above home", ceiling_m - home_z_m))
    elif math.isfinite(floor_m):
        lines.append(say("from {:.0f} m above home upwards", floor_m - home_z_m))
    else:
        lines.append(say("from the ground upwards"))
    lines += [zone.message] if zone.message else []
    is_quiet = near.state is State.NOT_THEN and not near.permitted
    lines.append(say("it does not apply at the planned time") if is_quiet else _kept_text(near))
    return tuple(lines)


def file_lines(model: SiteModel) -> tuple[str, ...]:
    """A line for each file of zones of a site."""
    lines = []
    for known in known_files(model):
        n = 0 if known.content is None else len(known.content.zones)
        lines.append(say("{}: {}", source_text(known), known.problem or say("zones: {}", n)))
    return tuple(lines)

"""The pre-flight rule about geo-zones: what applies near the flight, from which source, and how near the path comes.

What is not known is a finding of its own. A zone counts as clear only where its conservative volume is.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from datetime import UTC, datetime, timedelta
from typing import Any

import numpy as np

from planning.base.findings import Finding, Severity
from planning.base.messages import glue, joined, say
from planning.checks.case import ROUNDING_M, Case
from planning.geo.mesh import join
from planning.geo.solids import Solids
from planning.site.records import SiteModel
from planning.site.zones.keep_out import KnownFile, NearZone, known_files, near_zones
from planning.site.zones.local import COUNTRY_M, REACH_M, LocalVolume, LocalZone, prisms
from planning.site.zones.records import RESTRICTIONS, HeightAbove, Restriction, Zone
from planning.site.zones.times import State

NEAR_MISS_M = 30.0
"""Paths that pass a zone nearer are spoken of: GNSS, wind and a zone's own drawing are off by some metres each."""

OLD = timedelta(days=30)
"""Sources older than this are spoken of: aeronautical information changes every 28 days (AIRAC)."""


def geo_zones(case: Case) -> Iterator[Finding]:
    """The flight stays out of the geo-zones that apply, but for those that the pilot may enter."""
    model = case.site_model
    for known in known_files(model):
        yield from _source(known)
    for near in near_zones(model):
        yield from _zone(near, case)


def source_text(known: KnownFile) -> str:
    """Name, format, publisher and date of a file, for the pilot."""
    if known.content is None:
        return say("'{}', added on {}", known.source.file, known.source.imported)
    parts = [known.content.format, *([known.content.publisher] if known.content.publisher else [])]
    if known.content.issued is not None:
        parts.append(say("issued {}", f"{known.content.issued:%Y-%m-%d}"))
    parts.append(say("added on {}", known.source.imported))
    return glue(f"'{known.source.file}' (", joined(", ", parts), ")")


def _source(known: KnownFile) -> Iterator[Finding]:
    code, place = "zones-file", known.source.file
    if known.content is None or known.local is None:
        text = say("no zone of {} counts as clear: {}", source_text(known), known.problem)
        yield Finding(Severity.ERROR, code, text, place)
        return
    text = say(
        "{}: zones {}, within {:.0f} m of the airspace {}; SHA-256 {}",
        source_text(known),
        len(known.content.zones),
        REACH_M,
        sum(bool(local.volumes) for local in known.local.near),
        known.source.sha256[:12],
    )
    yield Finding(Severity.OK, code, text, place)
    for question in known.content.questions:
        yield Finding(Severity.WARNING, "zones-question", question, place)
    if COUNTRY_M < known.local.nearest_m < math.inf:
        away_km = known.local.nearest_m / 1000.0
        text = (
            say("its zones lie here only if latitude and longitude are exchanged; ask its publisher which is which")
            if known.local.is_swapped
            else say("its nearest zone is {:.0f} km away; is this the file for this place?", away_km)
        )
        yield Finding(Severity.WARNING, "zones-far", text, place, known.local.nearest_m, COUNTRY_M, "m")


def source_ages(model: SiteModel, now: datetime) -> Iterator[Finding]:
    """Whether there are files of zones of a site, and they hold and are not too old at a time, which has its zone."""
    if not model.site.zones:
        text = say("the site has no geo-zones, so which apply here is not looked at")
        yield Finding(Severity.NOTE, "zones", text)
    for known in known_files(model):
        if known.content is None:
            continue
        place, content = known.source.file, known.content
        since = content.issued or known.source.imported_at
        age = now.astimezone(UTC) - since
        if age > OLD:
            text = say(
                "this source is {} days old, and zones change every month: take its present state, and add it again",
                age.days,
            )
            yield Finding(Severity.WARNING, "zones-old", text, place)
        if content.valid_to is not None and now > content.valid_to:
            text = say("this source ended on {}: take its present state", f"{content.valid_to:%Y-%m-%d %H:%M} UTC")
            yield Finding(Severity.WARNING, "zones-old", text, place)
        if content.valid_from is not None and now < content.valid_from:
            text = say("this source begins on {} only", f"{content.valid_from:%Y-%m-%d %H:%M} UTC")
            yield Finding(Severity.WARNING, "zones-old", text, place)


def zone_text(near: NearZone) -> str:
    """What a zone is: name, restriction, reasons and heights."""
    zone = near.local.zone
    reasons = f" ({', '.join(zone.reasons)})" if zone.reasons else ""
    heights = dict.fromkeys(f"{volume.lower.written} - {volume.upper.written}" for volume in zone.volumes)
    return glue(f"{zone.name}: ", RESTRICTIONS[zone.restriction], reasons, f", {', '.join(heights)}" if heights else "")


def open_zone(near: NearZone, open_places: Sequence[str]) -> str:
    """What is open about the place of a zone, from which file, and what to do about it."""
    return say(
        "{}: where it lies cannot be read for sure in '{}': {}. So nobody can say that flights stay out of it. Look it "
        "up, or ask {}; then add the corrected file, or state who says that it is not here (--not-here): flights keep "
        "out of what can be read of it all the same. A permission (--permit) opens all of it",
        zone_text(near),
        near.source.file,
        joined("; ", open_places),
        _authority(near.local.zone),
    )


def _authority(zone: Zone) -> str:
    return next((each.name for each in zone.authorities if each.name), say("its authority"))


def _zone(near: NearZone, case: Case) -> Iterator[Finding]:
    zone, local = near.local.zone, near.local
    what, unsure = zone_text(near), _unsure_places(near, case)
    away_m, place = path_distance_m(local, case)
    if zone.restriction is Restriction.NONE:
        yield Finding(Severity.NOTE, "zone", say("{}: it restricts nothing", what), zone.id)
    elif near.state is State.NOT_THEN:
        yield Finding(Severity.NOTE, "zone", say("{}: it does not apply at the planned time", what), zone.id)
    elif near.permitted and away_m > ROUNDING_M and (unsure or not local.volumes):
        text = say("{}: where it lies is not sure; the authorisation '{}' opens all of it", what, near.permitted)
        if local.volumes:
            other = say("if it only says that the zone is not here, state it so instead (--not-here)")
            text = glue(text, "; ", other)
        yield Finding(Severity.NOTE, "zone", text, zone.id)
    elif near.not_here and not local.volumes:
        text = say("{}: where it lies is not sure; it is not here according to '{}'", what, near.not_here)
        yield Finding(Severity.NOTE, "zone", text, zone.id)
    elif unsure and not near.not_here and away_m > ROUNDING_M:
        yield Finding(Severity.ERROR, "zone-question", open_zone(near, unsure), zone.id)
    elif local.volumes:
        yield _distance(near, case, what, away_m, place, unsure)
    else:
        text = say(
            "{}: it lies some {:.0f} m away, but how far it reaches is not known: {}; look it up",
            what,
            local.distance_m,
            joined("; ", zone.width_questions),
        )
        yield Finding(Severity.WARNING, "zone-question", text, zone.id)


def answer_text(near: NearZone) -> str:
    """What somebody says of the place of a zone that cannot be read for sure."""
    return say("what cannot be read of it is not here according to '{}'", near.not_here)


def _unsure_places(near: NearZone, case: Case) -> tuple[str, ...]:
    """What is open of a zone's place, answered or not; outlines that cross themselves with the path in their hull."""
    local = near.local
    if local.doubtful is not None and any(map(local.doubtful.intersects, _tracks(case))):
        return (*local.open_places, *local.questions)
    return local.open_places


def _tracks(case: Case) -> list[Any]:
    """Paths from above, shapely; the viewpoints where there is no path."""
    import shapely

    if not case.plan.sorties:
        return [shapely.Point(viewpoint.position_enu_m[:2]) for viewpoint in case.plan.viewpoints]
    return [shapely.LineString(path[:, :2]) for _, _, path in case.sorties()]


def _distance(near: NearZone, case: Case, what: str, away_m: float, place: str, unsure: Sequence[str]) -> Finding:
    """How far the path stays away from a zone that applies, or may."""
    zone, local = near.local.zone, near.local
    where = glue(zone.id, ", ", place) if place and away_m <= 0.0 else zone.id
    questions = [*zone.questions, *dict.fromkeys((*unsure, *local.questions))]
    answers = [answer_text(near)] if unsure and near.not_here else []
    if near.state is State.UNDECIDED:
        questions.append(
            say("when it applies cannot be read")
            if zone.periods is None or case.site_model.zones_at is not None
            else say("it applies at some times only, and no time is planned (--at)")
        )
    if math.isinf(away_m):
        text = say("{}: there is no path yet, so how near it comes is not known", what)
        return Finding(Severity.NOTE, "zone", joined("; ", [text, *answers]), where)
    if away_m > ROUNDING_M:
        below, crossed = _crossed(local, case)
        severity = Severity.NOTE if away_m < NEAR_MISS_M or below or answers else Severity.OK
        text = say("{}: the path stays out of it, {:.1f} m away", what, away_m)
        text = joined("; ", [text, *answers])
        if below:
            text = glue(text, "; ", say("all of it lies below the ground here: is its upper limit right?"))
        if counted := _counted_from(crossed, case):
            text = glue(text, "; ", counted)
        return Finding(severity, "zone", text, where, away_m, 0.0, "m")
    if near.permitted:
        text = say("{}: the path runs inside, by the authorisation '{}'", what, near.permitted)
        return Finding(Severity.NOTE, "zone", joined("; ", [text, *questions]), where, away_m, 0.0, "m")
    entered = say("{}: the path enters it", what)
    advice = say("plan again, or ask {} and state the authorisation (--permit)", _authority(zone))
    text = joined("; ", [entered, *questions, *answers, advice])
    return Finding(Severity.ERROR, "zone", text, where, away_m, 0.0, "m")


def path_distance_m(local: LocalZone, case: Case) -> tuple[float, str]:
    """Least distance between a flight's paths and a zone, 0 inside or where they meet; and where that is.

    Without a path the viewpoints count; infinite without any, and where nobody knows of any place of the zone. Zones
    more than `REACH_M` above or below the airspace are away by height.
    """
    volumes = prisms(local, case.site_model.site.airspace)
    best_m, where = np.inf, ""
    if not volumes:
        points = [path for _, _, path in case.sorties()] or [np.array([v.position_enu_m for v in case.plan.viewpoints])]
        heights_m = np.concatenate([each.reshape(-1, 3)[:, 2] for each in points])
        for each in local.volumes if len(heights_m) else ():
            gap_m = max(each.floor_m - float(heights_m.max()), float(heights_m.min()) - each.ceiling_m, 0.0)
            best_m = min(best_m, gap_m)
        return best_m, where
    solids = Solids.of(join([volume.prism() for volume in volumes]).corners_enu_m)
    for place, _, path in case.sorties():
        legs_m = solids.segment_distances_m(path[:-1], path[1:])
        legs_m = np.where((solids.clearance_m(path) < 0.0)[:-1], 0.0, legs_m)
        nearest = int(np.argmin(legs_m))
        if legs_m[nearest] < best_m:
            best_m, where = float(legs_m[nearest]), say("{}, leg {}", place, nearest + 1)
    if not case.plan.sorties:
        for viewpoint in case.plan.viewpoints:
            clearance_m = max(0.0, float(solids.clearance_m(np.array([viewpoint.position_enu_m]))[0]))
            if clearance_m < best_m:
                best_m, where = clearance_m, viewpoint.id
    return best_m, where


def _crossed(local: LocalZone, case: Case) -> tuple[bool, list[LocalVolume]]:
    """Volumes above or below the path, and whether all of these end below the ground that is known there."""
    tracks, site = _tracks(case), case.site_model.site
    crossed = [each for each in local.volumes if any(each.area.intersects(track) for track in tracks)]
    lowest_m = case.space.ground.range_m(np.array(site.airspace.min_enu_m), np.array(site.airspace.max_enu_m))[0]
    return bool(crossed) and all(each.ceiling_m < lowest_m for each in crossed), crossed


def _counted_from(crossed: Sequence[LocalVolume], case: Case) -> str:
    """What the heights of volumes are counted from that the path is clear of by its height alone; else empty."""
    limits = [limit for each in crossed for limit in (each.volume.lower, each.volume.upper)]
    above = {limit.above for limit in limits if limit.value_m}
    words = []
    if HeightAbove.GROUND in above and case.space.ground.terrain is None:
        level_m = case.site_model.site.airspace.ground_z_m
        words.append(
            say("heights above ground count from the site's ground: are {:g} m its height all around?", level_m)
        )
    if HeightAbove.FLIGHT_LEVEL in above:
        words.append(say("flight levels count as low as 930 hPa and -50 degrees bring them"))
    return joined("; ", words) if words else ""

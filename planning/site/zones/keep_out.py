"""What a site's files of geo-zones mean for its flights: which zones count, and the volumes that all flights avoid."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from functools import lru_cache
from pathlib import Path

from planning.base.errors import InputError
from planning.base.files import read_input_file
from planning.base.messages import say, without_place
from planning.geo.frames import Origin
from planning.site.ground import Ground, ground_of
from planning.site.records import Airspace, NoFlyZone, SiteModel
from planning.site.terrain import Terrain, surfaces
from planning.site.zones.local import LocalZone, LocalZones, local_zones, prisms
from planning.site.zones.reading import ZONES_FILE, known_zones
from planning.site.zones.records import Restriction, SiteZones, TimeWindow, ZoneFile, ZoneSet
from planning.site.zones.times import State, state_of


def read_site_zones(folder: Path, source: ZoneFile) -> SiteZones:
    """A file of zones of a site whose file lies in `folder`: what cannot be had is a problem, no error."""
    try:
        content = read_input_file(folder / source.file, ZONES_FILE)
    except InputError as error:
        return SiteZones(source, b"", without_place(str(error), folder / source.file))
    return site_zones(source, content)


def site_zones(source: ZoneFile, content: bytes) -> SiteZones:
    """A file of zones with its content, as the site means it or with the problem that it is another."""
    if hashlib.sha256(content).hexdigest() != source.sha256:
        changed = say("has changed since it was added on {}; look at it, and add it again", source.imported)
        return SiteZones(source, content, changed)
    found = known_zones(content, Path(source.file))
    problem = without_place(str(found), source.file) if isinstance(found, InputError) else ""
    return SiteZones(source, content, problem)


@dataclass(frozen=True, slots=True, eq=False)
class KnownFile:
    """What a site knows from one of its files; both None where the file cannot be used."""

    source: ZoneFile
    problem: str
    content: ZoneSet | None = None
    local: LocalZones | None = None


def known_files(model: SiteModel) -> tuple[KnownFile, ...]:
    """All files of zones of a site, in its order."""
    by_source = {each.source: each for each in model.zones}
    found = []
    for source in model.site.zones:
        each = by_source.get(source)
        if each is None or each.problem:
            problem = say("has not been read") if each is None else each.problem
            found.append(KnownFile(source, problem))
            continue
        site = model.site
        held_to = site.terrain if ground_of(site).terrain is not None else None
        content, local = _local(each, site.origin, site.airspace, held_to)
        found.append(KnownFile(source, "", content, local))
    return tuple(found)


@lru_cache(maxsize=32)
def _local(zones: SiteZones, origin: Origin, airspace: Airspace, terrain: Terrain | None) -> tuple[ZoneSet, LocalZones]:
    found = known_zones(zones.content, Path(zones.source.file))
    if isinstance(found, InputError):  # `site_zones` has named it as a problem
        raise found
    ground = Ground(airspace.ground_z_m, None if terrain is None else surfaces(terrain))
    return found, local_zones(found, origin, airspace, ground)


@dataclass(frozen=True, slots=True, eq=False)
class NearZone:
    """A zone near a site, and what becomes of it.

    Parameters
    ----------
    permitted
        Reference of the pilot's authorisation; empty for none.
    not_here
        Who says that what cannot be read of its place is not here; empty for nobody.
    state
        Whether it applies in the time of the flight.
    """

    source: ZoneFile
    local: LocalZone
    permitted: str
    not_here: str
    state: State

    @property
    def key(self) -> str:
        """File and identifier: unique on a site."""
        return f"{self.source.file}/{self.local.zone.id}"

    @property
    def is_kept(self) -> bool:
        """Whether flights keep out of it."""
        return not self.permitted and self.is_restricting

    @property
    def open_places(self) -> tuple[str, ...]:
        """What keeps anybody from saying that flights stay out of it, until the pilot answers or has a permission."""
        return self.local.open_places if self.is_kept and not self.not_here else ()

    @property
    def is_restricting(self) -> bool:
        """Whether it restricts anything in the time of the flight."""
        return self.state.counts and self.local.zone.restriction is not Restriction.NONE


def near_zones(model: SiteModel) -> Iterator[NearZone]:
    """Zones near a site, of all files that can be used, in the time that `model.zones_at` says."""
    origin = model.site.origin
    for known in known_files(model):
        permitted, not_here = known.source.permitted, known.source.not_here
        for local in known.local.near if known.local is not None else ():
            state = state_of(local.zone, model.zones_at, origin.lat_deg, origin.lon_deg)
            zone_id = local.zone.id
            yield NearZone(known.source, local, permitted.get(zone_id, ""), not_here.get(zone_id, ""), state)


AROUND = timedelta(minutes=15)
"""Added before and after a flight: flights begin late, and zones are asked for by the quarter of an hour."""


def at_time(model: SiteModel, at: datetime | None, duration_s: float) -> SiteModel:
    """The site with its zones as they are in the time of a flight.

    Parameters
    ----------
    at
        Take-off, with its time zone; None where it is not known.
    duration_s
        Of the whole flight, pauses included.
    """
    if at is None or not model.site.zones:
        return model if model.zones_at is None else replace(model, zones_at=None)
    return replace(model, zones_at=TimeWindow(at - AROUND, at + timedelta(seconds=duration_s) + AROUND))


def no_fly_volumes(model: SiteModel) -> tuple[NoFlyZone, ...]:
    """All volumes that flights avoid: the site's own, then those of the geo-zones that count."""
    own = model.site.airspace.no_fly
    if not model.site.zones:
        return own
    kept = (near.local for near in near_zones(model) if near.is_kept)
    return (*own, *(prism for local in kept for prism in prisms(local, model.site.airspace)))

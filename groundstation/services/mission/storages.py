"""Storages that mission files are sent to: cards and remote controllers, found among what is mounted, known by folders.

A remote controller that is connected by USB shows its storage by MTP. Linux mounts that below gvfs; Windows and macOS
give it no path, so there a card, or a program that mounts it, is needed.

DJI Pilot 2 lets the pilot pick a KMZ file from any folder. DJI Fly has no import: it reads routes that it made itself,
`Android/data/dji.go.v5/files/waypoint/ID/ID.kmz`, with pictures in `waypoint/map_preview/ID/` (as the documentation of
HOT's Drone TM and several open tools have it; DJI documents neither). FlightHub 2 takes files from any folder by its
web page.
"""

from __future__ import annotations

import os
import re
import shutil
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from missions.formats.registry import read_missions
from planning.base.errors import GroundStationError, InputError

FLY_ROUTES = Path("Android/data/dji.go.v5/files/waypoint")
"""Where DJI Fly keeps its routes, in the storage of a remote controller or telephone."""

PILOT_FOLDERS = (Path("DJI/com.dji.industry.pilot"), Path("Android/data/com.dji.industry.pilot"))
"""What DJI Pilot 2 makes in the storage of its remote controller."""

FLIGHTHUB_FOLDER = "waylines"

_ROUTE_ID = re.compile(r"[0-9A-Fa-f]{8}(-[0-9A-Fa-f]{4}){3}-[0-9A-Fa-f]{12}")

GVFS = ("gvfs", "mtp:host=")

MAX_ROUTES = 500
"""DJI Fly's list is shorter; more folders than this are not looked at."""


class App(StrEnum):
    """Who is to read the files."""

    PILOT2 = "pilot2"
    DJI_FLY = "dji-fly"
    FLIGHTHUB = "flighthub"


@dataclass(frozen=True, slots=True)
class Route:
    """A route that DJI Fly has made.

    Parameters
    ----------
    id
        Name of its folder and of the file in it.
    modified_s
        When the file was changed, seconds since 1970 UTC.
    n_waypoints
        None where the file cannot be read.
    """

    id: str
    path: Path
    modified_s: float
    n_waypoints: int | None


@dataclass(frozen=True, slots=True)
class Storage:
    """Where files can be sent.

    Parameters
    ----------
    root
        Of the card, the controller's storage, or the folder that was named.
    folder
        Where the files of `app` belong; it may have to be made.
    routes
        Of DJI Fly, the newest first; one of them is replaced for each sortie.
    free_bytes
        None where the system does not tell, as for some devices by MTP.
    is_aircraft_card
        It looks like the card of a camera, which no remote controller reads.
    """

    root: Path
    app: App
    folder: Path
    routes: tuple[Route, ...] = ()
    free_bytes: int | None = None
    is_aircraft_card: bool = False

    @property
    def name(self) -> str:
        """What the system calls it."""
        if self.is_mtp:
            device = next(part for part in self.root.parts if part.startswith(GVFS[1])).removeprefix(GVFS[1])
            return device.replace("_", " ") if self.root.name.startswith(GVFS[1]) else f"{device} {self.root.name}"
        return self.root.name or str(self.root)

    @property
    def is_mtp(self) -> bool:
        """Whether it is reached by MTP through gvfs, which knows neither renaming over a file nor syncing."""
        parts = self.root.parts
        return GVFS[0] in parts and any(part.startswith(GVFS[1]) for part in parts)


def find_storages(
    volumes: Callable[[], Iterator[Path]] | None = None,
) -> tuple[Storage, ...]:
    """What is mounted that mission files can be sent to, remote controllers first.

    Parameters
    ----------
    volumes
        Where to look; None for what this system mounts.
    """
    found = []
    for root in (volumes or mounted_volumes)():
        # A device that was just pulled out fails in whatever is asked of it.
        try:
            found.append(storage_at(root))
        except (InputError, OSError):
            continue
    return tuple(sorted(found, key=lambda each: (each.app is not App.DJI_FLY, not _has_pilot(each.root), each.name)))


def mounted_volumes(
    platform: str = sys.platform, top: Path = Path("/"), is_mounted: Callable[[Path], bool] = os.path.ismount
) -> Iterator[Path]:
    """Roots of removable volumes and of storages of MTP devices.

    Parameters
    ----------
    top
        Of the file system.
    is_mounted
        Whether something is mounted at a folder; on Windows, whether there is such a drive.
    """
    if platform == "win32":
        # A: and B: are floppy drives, C: is the system's.
        yield from (drive for letter in "DEFGHIJKLMNOPQRSTUVWXYZ" if is_mounted(drive := top / f"{letter}:/"))
        return
    if platform == "darwin":
        yield from (path for path in _folders(top / "Volumes") if is_mounted(path))
        return
    for place in ("media", "run/media", "mnt"):
        for path in _folders(top / place):
            yield from (each for each in (path, *_folders(path)) if is_mounted(each))
    owner = getattr(os, "getuid", lambda: 0)()
    for device in _folders(top / f"run/user/{owner}" / GVFS[0]):
        if device.name.startswith(GVFS[1]):
            yield from _folders(device)


def _folders(path: Path) -> tuple[Path, ...]:
    """Folders in a folder, by name; none where it cannot be read."""
    try:
        return tuple(sorted(each for each in path.iterdir() if not each.name.startswith(".") and each.is_dir()))
    except OSError:
        return ()


def storage_at(path: Path, app: App | None = None) -> Storage:
    """What a folder, a card or a controller's storage is to an app.

    Parameters
    ----------
    app
        None to know it by the folders in it: DJI Fly by its routes, anything else is for DJI Pilot 2.

    Raises
    ------
    InputError
        There is no such folder, or DJI Fly has no routes there.
    """
    if not path.is_dir():
        raise InputError.say("there is no such folder or device; connect it and look again", place=path)
    root, fly = _fly_routes(path)
    if app is None:
        app = App.PILOT2 if fly is None else App.DJI_FLY
    if app is App.DJI_FLY:
        if fly is None:
            raise InputError.say(
                "has no routes of DJI Fly (expected the folder {}); make one route in DJI Fly and save it, then "
                "connect the remote controller again",
                FLY_ROUTES,
                place=path,
            )
        return Storage(root, app, fly, _routes(fly), _free_bytes(path))
    folder = path / FLIGHTHUB_FOLDER if app is App.FLIGHTHUB and path.name != FLIGHTHUB_FOLDER else path
    is_camera = (path / "DCIM").is_dir() and not (path / "Android").is_dir() and not _has_pilot(path)
    return Storage(path, app, folder, (), _free_bytes(path), is_camera and app is App.PILOT2)


def _fly_routes(path: Path) -> tuple[Path, Path | None]:
    """Root of the storage that has DJI Fly's routes, and their folder: here, in a storage of this device, or above."""
    for root in (path, *_folders(path)):
        if (root / FLY_ROUTES).is_dir():
            return root, root / FLY_ROUTES
    # Somebody who names the folder itself, or the folder of one route.
    for above in (path, path.parent):
        if above.parts[-len(FLY_ROUTES.parts) :] == FLY_ROUTES.parts:
            return above.parents[len(FLY_ROUTES.parts) - 1], above
    return path, None


def _routes(folder: Path) -> tuple[Route, ...]:
    found = []
    for each in _folders(folder)[:MAX_ROUTES]:
        path = each / f"{each.name}.kmz"
        if _ROUTE_ID.fullmatch(each.name) and path.is_file():
            found.append(Route(each.name, path, path.stat().st_mtime, _n_waypoints(path)))
    return tuple(sorted(found, key=lambda route: (-route.modified_s, route.id)))


def _n_waypoints(path: Path) -> int | None:
    try:
        return sum(len(mission.waypoints) for mission in read_missions(path))
    except GroundStationError:
        return None


def _has_pilot(root: Path) -> bool:
    return any((root / folder).is_dir() for folder in PILOT_FOLDERS)


def _free_bytes(path: Path) -> int | None:
    try:
        usage = shutil.disk_usage(path)
    except OSError:
        return None
    return usage.free if usage.total > 0 else None

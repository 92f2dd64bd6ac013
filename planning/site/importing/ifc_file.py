"""IFC 2x3 and IFC 4 models: windows and glazed plates become panes, all building elements the mesh."""

from __future__ import annotations

import json
import math
import os
import queue
import re
import subprocess
import sys
import tempfile
import threading
from dataclasses import dataclass, replace
from pathlib import Path
from typing import IO, NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.json_file import encoded
from planning.base.messages import packed, say, unpacked
from planning.base.progress import Monitor
from planning.base.step_physical_file import check_ends
from planning.geo.crs import CrsConversion, HeightReference, crs_conversion, horizontal_part, parse_crs
from planning.geo.enu import Geodetic
from planning.geo.frames import Origin
from planning.geo.geoid import ellipsoid_from_amsl_m, undulation_m
from planning.geo.mesh import empty_mesh, from_corners
from planning.site.importing.ground import StatedGround, place_on_ground, stated_ground
from planning.site.importing.ifc_content import IfcContent, MapParameters, SitePlace, extract
from planning.site.importing.options import ImportOptions
from planning.site.importing.placement import Georeference, LocalFrame, place
from planning.site.importing.source import HOW_TO_GET_PANELS, SourceModel, SourceWindow

Array = NDArray[np.float64]


# Where an IFC model is on earth: on the map of its map conversion, or around the place of its site.

SCALE_TOLERANCE = 0.01
"""A map scale is within 0.1 % of 1; what is further off is a change of units."""


@dataclass(frozen=True, slots=True)
class MapFrame:
    """Model coordinates in metres, turned, scaled and shifted onto a map.

    Parameters
    ----------
    conversion
        Of the map's coordinates.
    shift
        Map coordinates of the model's zero, in the map system's units.
    units_per_m
        Map units per metre of the model, horizontally and vertically.
    turn_rad
        Direction of the model's x axis on the map, counter-clockwise from east.
    notes
        See `Georeference`.
    """

    conversion: CrsConversion
    shift: tuple[float, float, float]
    units_per_m: tuple[float, float]
    turn_rad: float
    notes: tuple[str, ...]

    def geodetic(self, coordinates: Array) -> Geodetic:
        """WGS 84 positions of model coordinates, shape (n, 3), metres."""
        cos, sin = math.cos(self.turn_rad), math.sin(self.turn_rad)
        map_from_model = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
        scale = np.array([self.units_per_m[0], self.units_per_m[0], self.units_per_m[1]])
        return self.conversion.geodetic(coordinates @ map_from_model.T * scale + np.array(self.shift))


def ifc_georeference(content: IfcContent, options: ImportOptions) -> Georeference | None:
    """Georeference of an IFC model; None where the file has none, or the user says where it is.

    A map conversion that makes no sense gives way to the place of the site. `--crs` names the map of a map conversion;
    without one it is the system of the model's own coordinates.

    Raises
    ------
    InputError
        The map conversion makes no sense, and there is no other place to fall back on.
    """
    if options.origin is not None or (options.crs is not None and content.map is None):
        return None
    if content.map is None:
        return None if content.site is None else _site_frame(content.site, content.north_rad)
    try:
        return _map_frame(content.map, content.unit_m, options)
    except InputError as error:
        if content.site is None or options.crs is not None:
            raise
        note = say("the map conversion is left aside ({})", error)
        return _site_frame(content.site, content.north_rad, (note,))


def _map_frame(found: MapParameters, unit_m: float, options: ImportOptions) -> MapFrame:
    """Frame on the map of the file, or on the one the user names."""
    name = options.crs or found.crs
    if name is None:
        raise InputError.say("the map conversion names no coordinate reference system; give it with --crs EPSG:CODE")
    vertical_code = re.search(r"(?i)epsg\D*(\d+)", found.vertical or "")
    if options.crs is None and vertical_code and not parse_crs(name).is_compound:
        name = f"{name}+{vertical_code[1]}"
    reference: HeightReference = options.height_reference
    if reference == "auto" and re.search(r"(?i)ellipsoid", found.vertical or ""):
        reference = "ellipsoid"
    axis_unit_m = horizontal_part(parse_crs(name)).axis_info[0].unit_conversion_factor
    # The unit of the map's numbers is often left out: then it is the system's own, or the drawing's, whichever fits.
    units_m = [axis_unit_m, unit_m] if found.map_unit_m is None else [found.map_unit_m]
    for map_unit_m in units_m:
        east, north = found.eastings * map_unit_m / axis_unit_m, found.northings * map_unit_m / axis_unit_m
        try:
            conversion = crs_conversion(name, np.array([[east, north, 0.0]]), "xy", reference)
            break
        except InputError:
            if map_unit_m == units_m[-1]:
                raise
    scale, note = _true_scale(found.scale, map_unit_m / unit_m)
    scale_z, _ = _true_scale(found.scale_z, map_unit_m / unit_m)
    height_unit_m = conversion.height_unit_m
    return MapFrame(
        conversion=conversion,
        shift=(east, north, found.height * map_unit_m / height_unit_m),
        units_per_m=(scale / axis_unit_m, scale_z / height_unit_m),
        turn_rad=math.atan2(found.ordinate, found.abscissa),
        notes=(say("place and rotation from IfcMapConversion"), *note, *conversion.notes),
    )


def _true_scale(stated_scale: float, map_unit_per_file_unit: float) -> tuple[float, tuple[str, ...]]:
    """Scale of the map, near 1, from one that may also hold the change of units."""
    true = stated_scale * map_unit_per_file_unit
    if abs(true - 1.0) <= SCALE_TOLERANCE:
        return true, ()
    if abs(stated_scale - 1.0) <= SCALE_TOLERANCE:
        return stated_scale, (say("the scale of IfcMapConversion leaves out the change of units, which is put right"),)
    raise InputError.say(
        "IfcMapConversion has the scale {:g}, which is neither near 1 nor the change of units ({:g}); "
        "give the place with --origin",
        stated_scale,
        1.0 / map_unit_per_file_unit,
    )


def _site_frame(site: SitePlace, north_rad: float, notes: tuple[str, ...] = ()) -> LocalFrame:
    """Frame around the place of the site."""
    height_m = float(ellipsoid_from_amsl_m(site.lat_deg, site.lon_deg, site.altitude_amsl_m))
    geoid_m = float(undulation_m(site.lat_deg, site.lon_deg))
    notes += (
        say(
            "place from latitude and longitude of IfcSite, which is often just the city that the BIM program "
            "assumes: check it, or give --origin"
        ),
        say(
            "elevation of IfcSite ({:g} m) is above sea level; EGM96, here {:.1f} m above the ellipsoid, "
            "makes it ellipsoidal, to about 1 m",
            site.altitude_amsl_m,
            geoid_m,
        ),
        say(
            "true north is {:g} degrees counter-clockwise from the model's y axis",
            round(math.degrees(north_rad), 2) + 0.0,
        ),
    )
    origin = Origin(site.lat_deg, site.lon_deg, height_m)
    return LocalFrame(origin, site.zero_m, north_rad, notes, place_from="ifc-site")


# IfcOpenShell in a process of its own: a hostile file may crash it, but not the ground station.
#
# `read_in_worker` starts `python -m planning.site.importing.ifc_file FILE DEFLECTION THREADS FOLDER [ELEMENT ...]`,
# which
# leaves `content.json` and `triangles.npy` in the folder and prints one JSON line per step. With 0 threads it takes
# one
# element after the other and leaves out those that are named, which earlier runs have died of. Whatever IfcOpenShell
# prints stays in that process.

POLL_S = 0.2
"""Time between two looks at whether the user has cancelled."""

MAX_FATAL = 5
"""Elements that may be left out because the kernel dies of them; each costs another run."""

EXIT_REFUSED = 3


def read_in_worker(path: Path, deflection_m: float, monitor: Monitor) -> tuple[IfcContent, NDArray[np.float64]]:
    """Content of an IFC file and its triangles, see `extract`.

    Raises
    ------
    InputError
        The file is wrong, or so broken that the geometry kernel died of it.
    """
    from planning.base.jit import n_threads  # not at the top: the worker needs no compiler

    inherited, root = os.environ.get("PYTHONPATH"), Path(__file__).resolve().parents[3]
    environment = {**os.environ, "PYTHONPATH": f"{root}{os.pathsep}{inherited}" if inherited else str(root)}
    # -P: modules that lie about in the current folder are not ours.
    command = [sys.executable, "-P", "-m", "planning.site.importing.ifc_file", str(path), str(deflection_m)]
    fatal: list[str] = []
    with tempfile.TemporaryDirectory(prefix="reflight-ifc-") as folder:
        run = _run([*command, str(n_threads()), folder], environment, monitor)
        # Then one element after the other tells which of them the kernel dies of.
        while run.is_dead and len(fatal) <= MAX_FATAL:
            run = _run([*command, "0", folder, *fatal], environment, monitor)
            if not run.is_dead or run.element is None or run.element in fatal:
                break
            fatal.append(run.element)
        if run.refusal is not None:
            raise InputError(run.refusal)
        if run.is_dead:
            raise InputError.say(
                "the geometry kernel crashed on this IFC file (status {}), so something in it goes in circles or "
                "beyond all bounds; open and export it again in a BIM program",
                run.status,
                place=path,
            )
        content = msgspec.json.decode((Path(folder) / "content.json").read_bytes(), type=IfcContent)
        notes = tuple(unpacked(json.loads(note)) for note in content.notes)
        return replace(content, notes=notes), np.load(Path(folder) / "triangles.npy")


class _Run(NamedTuple):
    """How a worker ended: its status, why it refused the file, and the last element that it announced."""

    status: int
    refusal: str | None
    element: str | None

    @property
    def is_dead(self) -> bool:
        """Whether the kernel took the process down."""
        return self.refusal is None and self.status != 0


def _run(command: list[str], environment: dict[str, str], monitor: Monitor) -> _Run:
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL, env=environment
    )
    try:
        refusal, element = _follow(process, monitor)
    except BaseException:
        process.kill()
        raise
    finally:
        process.wait()
        if process.stdout is not None:
            process.stdout.close()
    return _Run(process.returncode, refusal, element)


def _follow(process: subprocess.Popen[bytes], monitor: Monitor) -> tuple[str | None, str | None]:
    """Pass on the worker's progress until it ends; returns why it refused the file, and the last element it took."""
    assert process.stdout is not None
    lines: queue.Queue[bytes | None] = queue.Queue()
    reader = threading.Thread(target=_read_lines, args=(process.stdout, lines), daemon=True)
    reader.start()
    done, refusal, element = 0, None, None
    while True:
        try:
            line = lines.get(timeout=POLL_S)
        except queue.Empty:
            monitor.report(say("building geometry"), done, 100)
            continue
        if line is None:
            reader.join()
            return refusal, element
        message = json.loads(line)
        done, refusal = message.get("done", done), unpacked(message["refused"]) if "refused" in message else refusal
        element = message.get("element", element)
        monitor.report(say("building geometry"), done, 100)


def _read_lines(stream: IO[bytes], lines: queue.Queue[bytes | None]) -> None:
    for line in stream:
        lines.put(line)
    lines.put(None)


def main(arguments: list[str]) -> int:
    """Read one file, as the worker process."""
    path, deflection_m, threads, folder = Path(arguments[0]), float(arguments[1]), int(arguments[2]), Path(arguments[3])
    fatal = arguments[4:]
    # IfcOpenShell may print: only what is said here shall reach the pipe.
    channel = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)

    def say(message: dict[str, object]) -> None:
        channel.write(json.dumps(message) + "\n")
        channel.flush()

    try:
        announce = None if threads else lambda guid: say({"element": guid})
        content, triangles = extract(path, deflection_m, threads, lambda done: say({"done": done}), fatal, announce)
    except InputError as error:
        say({"refused": packed(str(error))})
        return EXIT_REFUSED
    notes = tuple(json.dumps(packed(note)) for note in content.notes)
    (folder / "content.json").write_bytes(encoded(replace(content, notes=notes)))
    np.save(folder / "triangles.npy", triangles)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))


def read_ifc(path: Path, options: ImportOptions, monitor: Monitor) -> SourceModel:
    """Model of the building in an IFC file.

    Raises
    ------
    InputError
        The file is no IFC file, is cut off or broken, the deflection is not positive, or see `ifc_source`.
    """
    check_ends(path)
    if not options.deflection_m > 0.0:
        raise InputError.say("--deflection {:g}: expected a positive length in metres", options.deflection_m)
    return ifc_source(path, *read_in_worker(path, options.deflection_m, monitor), options)


def ifc_source(path: Path, content: IfcContent, triangles: Array, options: ImportOptions) -> SourceModel:
    """Model from what was read of an IFC file, see `extract`.

    Raises
    ------
    InputError
        There is no geometry or no glass, or the place is not known.
    """
    if len(triangles) == 0:
        raise InputError.say(
            "no building element in this file has geometry; export the building again, with the bodies of its walls "
            "and windows",
            place=path,
        )
    if options.panels_required and not content.pane_ids and not options.panel_grids:
        raise InputError.say(
            "there is neither a window nor a glazed plate with geometry; {}", HOW_TO_GET_PANELS, place=path
        )
    points = triangles.reshape(-1, 3)
    georeference = ifc_georeference(content, options)
    # Where there is a map conversion, --crs has served to name its map.
    rest = options if georeference is None else replace(options, crs=None)
    # The site's zero is the ground where the building reaches below it: a cellar, foundations.
    ground_z = content.site_z_m
    if ground_z is not None and not points[:, 2].min() < ground_z < points[:, 2].max():
        ground_z = None
    stated = stated_ground(options)
    if stated is None and ground_z is not None:
        stated = StatedGround(
            ground_z, say("ground: z = {:.2f} of the model, the zero of IfcSite (--ground names another)", ground_z)
        )
    stands = place_on_ground(
        points,
        np.arange(len(points)).reshape(-1, 3),
        stated,
        lambda near, z: place(georeference, near, z, rest, content.north_rad),
    )
    placement = stands.placement
    panes = zip(content.pane_ids, content.outlines, content.thicknesses_m, content.are_oriented, strict=True)
    return SourceModel(
        name=content.name,
        windows=tuple(
            SourceWindow(guid, placement.enu(np.array(ring)), thickness_m, is_oriented)
            for guid, ring, thickness_m, is_oriented in panes
        ),
        building=from_corners(stands.vertices_enu_m.reshape(-1, 3, 3)[stands.is_kept]),
        neighbours=empty_mesh(),
        placement=placement,
        repeats_panes=True,
        notes=(*placement.georeference.notes, *content.notes, *stands.notes),
        terrain=stands.terrain,
        question=stands.question,
    )

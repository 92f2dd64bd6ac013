"""`site import`: a building model to a site file; `site terrain`: its ground; `site zones`: geo-zones about it.

`site tilts`: how far its panes lean.
"""

from __future__ import annotations

import argparse
import math
import re
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from groundstation.cli.console import counted, named_like, print_json, print_next, run_job, show, tell, worded
from groundstation.cli.options import (
    add_flight,
    add_place_and_content,
    add_time,
    import_options,
    json_file,
    number,
    planned_time,
    point,
)
from planning.base.errors import InputError
from planning.base.messages import glue, say

if TYPE_CHECKING:
    from planning.site.importing.options import PanelGrid
    from planning.site.records import Site

Number3 = tuple[float, float, float]

MAX_LISTED = 12
"""Facades listed one by one."""

EPILOG = """examples:
  site import office.ifc -o office.site.json
  site import block.gml -o block.site.json --building BLDG_0003
  site import tower.obj -o tower.site.json --origin 22.3372,114.2636,62 \\
      --panel-grid '-18,0,0 18,0,0 -18,0,42' --rows 14 --columns 20 --gap 0.1
  site import coarse.obj -o tower.site.json --origin 22.3372,114.2636,62 --without-panels
"""

TERRAIN_EPILOG = """examples:
  site terrain office.site.json dtm.tif --vertical egm96 -o hill.site.json
  site terrain office.site.json dtm.tif --surface dsm.tif --vertical EPSG:7837 -o hill.site.json
  site terrain office.site.json copernicus/ -o hill.site.json
"""

ZONES_EPILOG = """examples:
  site zones office.site.json uas-zones.json
  site zones office.site.json --at 2026-12-01T10:00+01:00
  site zones office.site.json --permit "CTR7=authorisation 4711 of 2026-11-30"
"""


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser("site", help="make a site file from a building model")
    actions = parser.add_subparsers(title="actions", metavar="ACTION", required=True)
    command = actions.add_parser(
        "import",
        help="import IFC, CityGML, CityJSON, OBJ, PLY, GLB or STL",
        description="Make a site from a building model. Windows become panels; a mesh needs --panel-grid, or\n"
        "--without-panels where photos will show them.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    command.set_defaults(run=run)
    # Coordinates south of the equator start with a minus; argparse would take "-33.8,151.2,5" for an option.
    command._negative_number_matcher = re.compile(r"-[\d.]")
    add = command.add_argument
    add("file", type=Path, metavar="FILE", help="the model: .ifc, .gml, .xml, .json, .obj, .ply, .glb or .stl")
    add("-o", "--out", type=json_file, required=True, metavar="SITE", help="site file to write; meshes go beside it")
    add("--name", help="name of the site (default: the building's, else the file's)")
    add("--json", action="store_true", help="print one JSON object instead of text")
    add_place_and_content(command)
    _add_panels(command)
    add_flight(command)
    _add_terrain(actions)
    _add_zones(actions)
    _add_tilts(actions)


def _add_terrain(actions: Any) -> None:
    command = actions.add_parser(
        "terrain",
        help="attach the ground from GeoTIFF, or from tiles of Copernicus DEM or SRTM",
        description="Attach terrain to a site. Heights above the ground then count from it, home is put on it, and\n"
        "where it has no heights nothing is planned. With a surface model, trees and neighbours become obstacles.",
        epilog=TERRAIN_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    command.set_defaults(run=run_terrain)
    command._negative_number_matcher = re.compile(r"-[\d.]")
    add = command.add_argument
    add("site", type=Path, metavar="SITE", help="site file")
    add("files", type=Path, nargs="*", metavar="FILE", help="heights of the ground: .tif, .hgt, or folders of them")
    add("-o", "--out", type=json_file, required=True, metavar="SITE", help="site file to write; obstacles go beside it")
    add("--surface", type=Path, nargs="+", default=[], metavar="FILE", help="the same with roofs and trees in it")
    add("--vertical", metavar="SYSTEM", help="heights are above: ellipsoid, egm96, egm2008, or a code as EPSG:7837")
    add("--geoid", type=Path, metavar="FILE", help="grid of the geoid below sea level's heights: .pgm, .gtx or .tif")
    add("--height-unit", choices=("auto", "m", "ft", "us-ft"), default="auto", help="of the heights (default auto)")
    add("--crs", help="coordinate reference system of the files, where they name none or a wrong one")
    add("--resolution", type=number, metavar="M", help="step of the grid (default: half that of the files)")
    add(
        "--accuracy",
        type=number,
        metavar="M",
        help="kept on top: how far the ground may lie off the files' heights (default: by product, else 0.6 or 9 m)",
    )
    add("--shift", type=_shift, default=0.0, metavar="M|home", help="added to all heights; home: to reach home")
    add("--taller-than", type=number, default=2.0, metavar="M", help="of what is an obstacle (default 2 m)")
    add(
        "--use",
        choices=("auto", "on", "off"),
        default="auto",
        help="hold flights to the terrain: where it departs from level ground (auto), always, or never",
    )
    add("--remove", action="store_true", help="take the terrain, and the obstacles that came with it, off the site")
    add("--json", action="store_true", help="print one JSON object instead of text")


def _shift(text: str) -> float | str:
    return text if text == "home" else number(text)


def _add_zones(actions: Any) -> None:
    command = actions.add_parser(
        "zones",
        help="add files of geo-zones to a site, and list those near it",
        description="Files of authorities (ED-269, ED-318, GeoJSON, KML, AIXM, OpenAir) are put beside the site file.\n"
        "Plans keep out of zones that prohibit or restrict flights, unless you state what permits them.",
        epilog=ZONES_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    command.set_defaults(run=run_zones)
    add = command.add_argument
    add("site", type=Path, metavar="SITE", help="site file; it is changed where anything is added or stated")
    add("files", type=Path, nargs="*", metavar="FILE", help="files of geo-zones; one of the same name is replaced")
    add("-o", "--out", type=json_file, metavar="SITE", help="write another site file beside it instead")
    add(
        "--permit",
        action="append",
        default=[],
        metavar="ZONE=REFERENCE",
        help="your authorisation for a zone: plans may enter all of it; empty takes it back",
    )
    add(
        "--not-here",
        action="append",
        default=[],
        metavar="ZONE=REFERENCE",
        help="who says that what cannot be read of a zone is not here; plans keep out of the rest; empty takes it back",
    )
    add("--remove", action="append", default=[], metavar="FILE", help="take a file of zones from the site")
    add_time(command)
    add("--json", action="store_true", help="print one JSON object instead of text")


def _add_tilts(actions: Any) -> None:
    command = actions.add_parser(
        "tilts",
        help="take measured tilts of panes over from a table",
        description="Panes lean from the planes of their corners, and mirror the sun elsewhere then. The table is CSV\n"
        "with the columns panel,right_deg,up_deg: how far a pane's normal leans to the right, seen from outside, and\n"
        "upwards. 'sun' and the checks of the sun take them into account.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    command.set_defaults(run=run_tilts)
    add = command.add_argument
    add("site", type=Path, metavar="SITE", help="site file")
    add("table", type=Path, nargs="?", metavar="TABLE", help="the table, .csv")
    add("-o", "--out", type=json_file, required=True, metavar="SITE", help="site file to write; meshes go beside it")
    add("--remove", action="store_true", help="take all tilts off the site")


def run_tilts(options: argparse.Namespace) -> int:
    """Write a site with tilts; returns the exit status."""
    from groundstation.services.project.input_files import read_input_site
    from groundstation.services.project.project_file import check_not_index
    from groundstation.services.site.tilts import read_tilts, tilts_text, write_tilted
    from planning.base.json_file import check_output

    check_not_index(options.out)
    check_output(options.out, [options.site, *([options.table] if options.table else [])])
    if options.remove == (options.table is not None):
        raise InputError.say("expected a table of tilts, or --remove, and not both")
    model = read_input_site(options.site)
    tilts = None if options.table is None else read_tilts(options.table)
    tilted = write_tilted(model, options.site, tilts, options.out)
    tell("site '{}'", tilted.site.name, place=options.out)
    show(tilts_text(tilted))
    return 0


def run_zones(options: argparse.Namespace) -> int:
    """Add, state and list geo-zones; returns the exit status."""
    from datetime import date

    from groundstation.services.site.zones import OPEN_ZONE, file_lines, zone_rows, zones_of_site, zones_summary

    stated: dict[str, dict[str, str]] = {"--permit": {}, "--not-here": {}}
    for option, texts in (("--permit", options.permit), ("--not-here", options.not_here)):
        for text in texts:
            zone_id, equals, reference = text.partition("=")
            if not equals or not zone_id:
                raise InputError(say("expected ZONE=REFERENCE, got '{}'", text, place=option))
            stated[option][zone_id] = reference
    at = planned_time(options)
    done = run_job(
        "site zones",
        lambda context: zones_of_site(
            options.site,
            options.files,
            out=options.out,
            permissions=stated["--permit"],
            answers=stated["--not-here"],
            removed=options.remove,
            today=date.today(),
            monitor=context,
        ),
    )
    if options.json:
        print_json({**zones_summary(done.model, at), "notes": done.notes})
        return 0
    for line in file_lines(done.model):
        show(line)
    rows = zone_rows(done.model, at)
    for row in rows:
        kept = say("kept out of") if row.is_kept else say("not kept out of")
        if row.is_open:
            kept = OPEN_ZONE
        elif row.permitted:
            kept = say("permitted by '{}'", row.permitted)
        elif row.not_here:
            answer = say("what cannot be read of it is not here according to '{}'", row.not_here)
            kept = glue(kept, "; ", answer)
        away = say("{:.0f} m from the airspace", row.distance_m)
        if not math.isfinite(row.distance_m):
            away = say("its place is not known")
        tell("  {} [{}]: {}; {}; {}", row.id, row.file, row.what, away, kept)
        for question in row.questions:
            tell("    question: {}", question)
    if not done.model.site.zones:
        tell("no geo-zones are known here; add files of your authority: 'site zones SITE FILE'")
    elif not rows:
        tell("no zone of these files is near the site")
    for note in done.notes:
        tell("note: {}", note, file=sys.stderr)
    return 0


def _add_panels(command: argparse.ArgumentParser) -> None:
    grid = command.add_argument_group("panels that you state").add_argument
    grid(
        "--panel-grid",
        type=_triple,
        action="append",
        metavar="'E,N,U E,N,U E,N,U'",
        help="lower left, lower right and upper left corner of a facade, seen from outside; may be repeated",
    )
    grid("--rows", type=int, action="append", metavar="N", help="panels upwards, once for all grids or one for each")
    grid("--columns", type=int, action="append", metavar="N", help="panels side by side, likewise")
    grid("--gap", type=number, default=0.0, metavar="M", help="width of the mullions between panels (default 0)")
    grid("--grid-tolerance", type=number, default=2.0, metavar="M", help="allowed distance from the mesh (default 2 m)")
    grid(
        "--without-panels",
        action="store_true",
        help="make a site also where there is no panel yet; 'panels' finds them in photos",
    )


def _triple(text: str) -> tuple[Number3, Number3, Number3]:
    points = text.split()
    if len(points) != 3:
        raise argparse.ArgumentTypeError(worded(say("expected three points with blanks between them, got '{}'", text)))
    return point(points[0]), point(points[1]), point(points[2])


def run(options: argparse.Namespace) -> int:
    """Import a site; returns the exit status."""
    from groundstation.services.project.input_files import FileKind, expecting
    from groundstation.services.project.project_file import check_not_index
    from planning.base.json_file import check_output
    from planning.site.importing.importer import import_site, write_imported_site

    check_not_index(options.out)
    check_output(options.out, [options.file])
    started = time.perf_counter()
    wanted = replace(
        import_options(options),
        panel_grids=_grids(options),
        grid_tolerance_m=options.grid_tolerance,
        panels_required=not options.without_panels,
    )
    with expecting(FileKind.BUILDING, options.file):
        imported = run_job("site import", lambda context: import_site(options.file, wanted, context))
    model = write_imported_site(options.out, imported, options.file)
    seconds = time.perf_counter() - started
    site = model.site
    if options.json:
        content = {
            "site": str(options.out),
            "name": site.name,
            "panels": site.n_panels,
            "facades": [{"id": facade.id, "panels": len(facade.panels)} for facade in site.facades],
            "building_mesh": site.building_mesh,
            "triangles": len(model.building.triangles),
            "origin": {
                "lat_deg": site.origin.lat_deg,
                "lon_deg": site.origin.lon_deg,
                "ellipsoid_height_m": site.origin.ellipsoid_height_m,
            },
            "home_enu_m": site.home_enu_m,
            "notes": imported.notes,
            "sha256": model.sha256,
            "seconds": round(seconds, 3),
        }
        print_json(content)
        return 0
    _print_site(site, options.out)
    for note in imported.notes:
        tell("note: {}", note, file=sys.stderr)
    _print_next_step(site, options.out)
    return 0


def _print_site(site: Site, out: Path) -> None:

    origin, n_facades = site.origin, len(site.facades)
    listed = ", ".join(f"{facade.id} {len(facade.panels)}" for facade in site.facades[:MAX_LISTED])
    more = say(", {} smaller ones", n_facades - MAX_LISTED) if n_facades > MAX_LISTED else ""
    on_facades = say("{} on {}: {}{}", counted(site.n_panels, "panel"), counted(n_facades, "facade"), listed, more)
    tell("site '{}', {}", site.name, on_facades if site.n_panels else say("the building without panels"), place=out)
    tell(
        "origin {:.7f}, {:.7f}, {:.2f} m above the ellipsoid", origin.lat_deg, origin.lon_deg, origin.ellipsoid_height_m
    )


def _print_next_step(site: Site, out: Path) -> None:

    if site.n_panels:
        print_next("plan", out, "-o", named_like(out, ".plan.json"))
    else:
        print_next("panels", "PHOTOS", out, "-o", named_like(out, ".panels.site.json"))


def _grids(options: argparse.Namespace) -> tuple[PanelGrid, ...]:
    """One grid for each --panel-grid, with its own rows and columns or those that all share."""
    from planning.site.importing.options import PanelGrid

    corners = options.panel_grid or []
    counts = []
    for name, values in (("--rows", options.rows or []), ("--columns", options.columns or [])):
        if corners and len(values) not in (1, len(corners)):
            raise InputError(
                say(
                    "expected it once, or once for each of {} --panel-grid, got {}",
                    len(corners),
                    len(values),
                    place=name,
                )
            )
        if values and not corners:
            raise InputError(say("{} goes with --panel-grid, which is missing", name))
        counts.append(values * len(corners) if len(values) == 1 else values)
    return tuple(PanelGrid(c, rows, columns, options.gap) for c, rows, columns in zip(corners, *counts, strict=True))


def run_terrain(options: argparse.Namespace) -> int:
    """Attach terrain to a site; returns the exit status."""
    from groundstation.services.project.input_files import read_input_site
    from groundstation.services.project.project_file import check_not_index
    from groundstation.services.site.terrain import attached_facts, terrain_attached, terrain_removed, terrain_summary
    from planning.base.json_file import check_output
    from planning.site.importing.attach_terrain import TerrainRequest
    from planning.site.importing.elevation import HeightOptions

    check_not_index(options.out)
    geoid = [] if options.geoid is None else [options.geoid]
    check_output(options.out, [options.site, *options.files, *options.surface, *geoid])
    if options.remove == bool(options.files):
        raise InputError.say("expected files of heights, or --remove, and not both")
    model = read_input_site(options.site)
    if options.remove:
        terrain_removed(model, options.site, options.out)
        tell("site '{}' without terrain", model.site.name, place=options.out)
        return 0
    try:
        request = TerrainRequest(
            ground=tuple(options.files),
            surface=tuple(options.surface),
            options=HeightOptions(options.crs, options.vertical, options.height_unit, options.geoid),
            step_m=options.resolution,
            accuracy_m=options.accuracy,
            shift_m=options.shift,
            taller_than_m=options.taller_than,
            use=options.use,
        )
    except ValueError as error:
        raise InputError(str(error)) from error
    started = time.perf_counter()
    attached = run_job(
        "site terrain", lambda context: terrain_attached(model, options.site, request, options.out, context)
    )
    found = terrain_summary(attached, time.perf_counter() - started)
    if options.json:
        print_json({"site": str(options.out), **found})
        return 0
    tell("site '{}'", attached.model.site.name, place=options.out)
    for fact in attached_facts(attached):
        show(fact)
    for note in attached.notes:
        tell("note: {}", note, file=sys.stderr)
    _print_next_step(attached.model.site, options.out)
    return 0

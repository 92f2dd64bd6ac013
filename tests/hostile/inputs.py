"""Every kind of file that the program reads: one that it wrote itself, or a real one, and the command that reads it."""

from __future__ import annotations

import contextlib
import io
import json
import pickle
import shutil
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from groundstation.cli.main import main
from tests.conftest import SHARED_DATA


@dataclass(frozen=True)
class Input:
    """A file to be damaged, among those of a case.

    Parameters
    ----------
    name
        For reports.
    form
        See `tests.hostile.mutations.BY_KIND`.
    needs
        Files and folders of the workspace that the command needs, copied into the folder of each case.
    target
        The file to be damaged, in that folder.
    command
        Arguments; what it writes goes into the folder `out`.
    reader
        Instead of a command: module:name of a function that takes the path.
    is_quick
        For the fast suite.
    """

    name: str
    form: str
    needs: tuple[str, ...]
    target: str
    command: str = ""
    reader: str = ""
    is_quick: bool = False


def _input(name: str, form: str, target: str, command: str, *needs: str, quick: bool = False) -> Input:
    reader = command if ":" in command and " " not in command else ""
    files = tuple(dict.fromkeys(name.strip("/") for name in (target.split("/", maxsplit=1)[0], *needs)))
    return Input(name, form, files, target, "" if reader else command, reader, quick)


SITE = ("site.json", "wall.ply")
FLYING = (*SITE, "plan.json")
HERE = "tests.hostile.readers"


def written() -> list[Input]:
    """Files that the program writes itself."""
    import_ = "import {0} --site site.json -o out/p.json"
    site = "site import {0} -o out/s.json --origin 22.3,114.2,60 --without-panels"
    zones = "site zones site.json {0}"
    terrain = "site terrain site.json {0} --vertical ellipsoid -o out/s.json"
    render = "render model --views data -o out/r --width 24"
    train = "train data -o out/m --preset smoke --iterations 2 --method 2dgs --settings quick.toml"
    model = ("data/", "model/", "quick.toml")
    return [
        _input("site", "json", "site.json", "check plan.json site.json", *FLYING, quick=True),
        _input("site planned", "json", "site.json", "plan site.json -o out/p.json --views 3 --time-budget 2", *SITE),
        _input("mesh of a site", "binary", "wall.ply", "check plan.json site.json", *FLYING, quick=True),
        _input("plan", "json", "plan.json", "check plan.json site.json", *FLYING, quick=True),
        _input("plan exported", "json", "plan.json", "export plan.json --format dji-kmz -o out/m.kmz", *FLYING),
        _input("plan to wpl", "json", "plan.json", "export plan.json --format mavlink-wpl -o out/m.txt", *FLYING),
        _input("plan briefed", "json", "plan.json", "brief plan.json site.json -o out/b.html", *FLYING),
        _input("site briefed", "json", "site.json", "brief plan.json site.json -o out/b.html", *FLYING),
        _input("KMZ", "zip", "m.kmz", import_.format("m.kmz"), *SITE, quick=True),
        _input("KMZ sent", "zip", "m.kmz", "send m.kmz --to card", "card/"),
        _input("plan sent", "json", "plan.json", "send plan.json --to card --site site.json", "card/", *FLYING),
        _input("log book", "json", "booked/flights/log-book.json", "logbook --project booked", "booked/"),
        _input("QGC plan", "json", "m.plan", import_.format("m.plan"), *SITE, quick=True),
        _input("waypoints", "text", "m.waypoints", import_.format("m.waypoints"), *SITE, quick=True),
        _input("KML", "text", "m.kml", import_.format("m.kml"), *SITE, quick=True),
        _input("CSV of photos", "text", "m.csv", import_.format("m.csv"), *SITE, quick=True),
        _input("flight", "json", "flight.json", "topup flight.json plan.json site.json -o out/p.json --time-budget 1 "
               "--batteries 1", *FLYING),
        _input("flight rendered", "json", "flight.json", "topup flight.json plan.json site.json -o out/p.json --resume",
               *FLYING, quick=True),
        _input("OBJ", "text", "b.obj", site.format("b.obj"), quick=True),
        _input("STL", "binary", "b.stl", site.format("b.stl"), quick=True),
        _input("STL text", "text", "b.ascii.stl", site.format("b.ascii.stl")),
        _input("PLY", "binary", "b.ply", site.format("b.ply"), quick=True),
        _input("PLY text", "text", "b.ascii.ply", site.format("b.ascii.ply")),
        _input("GLB", "header", "b.glb", site.format("b.glb"), quick=True),
        _input("zones of ED-269", "json", "z.ed269.json", zones.format("z.ed269.json"), *SITE, quick=True),
        _input("zones of ED-318", "json", "z.ed318.json", zones.format("z.ed318.json"), *SITE),
        _input("zones of KML", "text", "z.kml", zones.format("z.kml"), *SITE, quick=True),
        _input("zones of OpenAir", "text", "z.openair", zones.format("z.openair"), *SITE, quick=True),
        _input("zones of AIXM", "text", "z.aixm.xml", zones.format("z.aixm.xml"), *SITE),
        _input("heights as GeoTIFF", "binary", "t.tif", terrain.format("t.tif"), *SITE, quick=True),
        _input("surface as GeoTIFF", "header", "dsm.tif", terrain.format("t.tif --surface dsm.tif"), *SITE, "t.tif"),
        _input("heights of SRTM", "binary", "N22E114.hgt", terrain.format("N22E114.hgt"), *SITE),
        _input("site on terrain", "json", "hill.json", "check plan.json hill.json", *FLYING, quick=True),
        _input("CityJSON of ours", "json", "site.city.json", site.format("site.city.json")),
        _input("project", "json", "project/project.json", "project show project", "project/", quick=True),
        _input("project's site", "json", "project/site/site.json", "project show project", "project/"),
        _input("project's plan", "json", "project/plans/plan.plan.json", "project show project", "project/"),
        _input("project's facades", "json", "faced/site/site.facades.json", "project show faced", "faced/"),
        _input("project added to", "json", "project/project.json", "project add project other.json", "project/",
               "other.json"),
        _input("copy of unsaved work", "json", "left/.autosave/autosave.json", f"{HERE}:recovery", "left/"),
        _input("unsaved project", "json", "left/.autosave/project.json", f"{HERE}:recovery", "left/"),
        _input("lock", "json", "project/.lock.json", f"{HERE}:holder", "project/"),
        _input("data set", "json", "data/dataset.json", render, *model),
        _input("data set learned", "json", "data/dataset.json", train, *model),
        _input("captures", "json", "data/scene.json", train, *model),
        _input("cameras", "binary", "data/sparse/0/cameras.bin", train, *model),
        _input("images", "binary", "data/sparse/0/images.bin", train, *model),
        _input("points", "binary", "data/sparse/0/points3D.bin", train, *model),
        _input("photo of a data set", "binary", "data/images/p00.png", train, *model),
        _input("mask of a data set", "binary", "data/masks/p01.png.png", train, *model),
        _input("panels of a data set", "binary", "data/panels/p02.png.png", train, *model),
        _input("normals of a data set", "binary", "data/normals/p03.png.png", train, *model),
        _input("model", "json", "model/model.json", render, *model),
        _input("weights", "header", "model/weights.safetensors", render, *model),
        _input("light", "json", "lit/model.json", "render lit --views data -o out/r --width 24", "lit/", *model),
        _input("checkpoint", "header", "state/checkpoint.safetensors", "train data -o state --preset smoke "
               "--iterations 4 --method 2dgs --settings quick.toml", "state/", *model),
        _input("model exported", "json", "model/model.json", "export model --format ply -o out/m.ply", *model),
        _input("splats to start from", "binary", "model/splats.ply", f"{train} --start model/splats.ply", *model),
        _input("objects", "json", "objects/gsscene.json", "export objects --format gltf -o out/m.glb", "objects/"),
        _input("component", "header", "objects/component.safetensors", "export objects --format spz -o out/m.spz",
               "objects/"),
        _input("objects' records made", "json", "objects/gsscene.json", "records objects list", "objects/"),
        _input("records", "binary", "objects/records.sqlite", "records objects list", "objects/"),
        _input("records searched", "binary", "objects/records.sqlite", "records objects search crack", "objects/"),
        _input("records written", "binary", "objects/records.sqlite", "records objects set A-1 maker=x", "objects/"),
        _input("stored picture", "binary", "picture.png", "records objects add A-1 defect kind=crack severity=3 "
               "found_on=2026-01-02 picture=picture.png", "objects/"),
        _input("table of records", "text", "tables/defects.csv", "records objects import tables", "tables/",
               "objects/"),
        _input("table of attributes", "text", "tables/attributes.csv", "records objects import tables", "tables/",
               "objects/"),
        _input("settings of a training", "toml", "quick.toml", train, *model),
        _input("look", "toml", "look.toml", "scene render site.json --square 1 --width 16 --points 20 -o out/r "
               "--look look.toml", *SITE),
        _input("camera", "toml", "camera.toml", "scene render site.json --square 1 --width 16 --points 20 -o out/r "
               "--camera camera.toml", *SITE),
        _input("photos rendered before", "json", "scene/scene.json", "scene render site.json --square 1 --width 16 "
               "--points 20 -o scene", "scene/", *SITE),
        _input("settings of a search", "toml", "search.toml", "segment photo.png -o out/p.json --parameters "
               "search.toml", "photo.png"),
        _input("settings", "toml", "config/settings.toml", "groundstation.services.settings:read_settings", "config/",
               quick=True),
        _input("flight settings", "toml", "config/flight.toml",
               "groundstation.services.fly.options:read_flight_settings", "config/", quick=True),
        _input("signing key", "text", "config/mavlink-signing-key", f"{HERE}:signer", "config/", quick=True),
        _input("signing time", "text", "config/mavlink-signing-timestamp", f"{HERE}:signer", "config/"),
        _input("map", "binary", "map.mbtiles", f"{HERE}:map_tiles", quick=True),
        _input("map of vectors", "binary", "map.pmtiles", f"{HERE}:map_tiles", quick=True),
        _input("SPZ", "binary", "m.spz", "tests.reconstruction.exports.spz.reading:read_spz"),
        _input("SOG", "zip", "m.sog", "tests.reconstruction.exports.sog.reading:read_sog"),
        _input("LPIPS", "binary", "heads.pth", f"{HERE}:lpips"),
        _input("LPIPS as safetensors", "header", "heads.safetensors", f"{HERE}:lpips"),
        _input("LPIPS out of its package", "binary", "alexnet.ckpt", f"{HERE}:packaged_lpips"),
        _input("TSPLIB", "text", "t.tsp", "route t.tsp --time-budget 0.2", quick=True),
        _input("PNG", "binary", "photo.png", "segment photo.png -o out/p.json"),
        _input("TIFF", "binary", "photo.tif", "segment photo.tif -o out/p.json"),
        _input("BMP", "binary", "photo.bmp", "segment photo.bmp -o out/p.json"),
        _input("transforms.json", "json", "plain/transforms.json", "prepare plain -o out/d", "plain/"),
        _input("points of nerfstudio", "header", "plain/points.ply", "prepare plain -o out/d", "plain/"),
        _input("PNG called JPEG", "binary", "plain/images/a.jpg", "prepare plain -o out/d", "plain/"),
        _input("COCO", "json", "offices/_annotations.coco.json", f"{HERE}:coco", "offices/"),
    ]  # fmt: skip


def real() -> list[Input]:
    """Files of others, where there are some."""
    if not SHARED_DATA.is_dir():
        return []
    missions = (
        ("missions/geoyee_m3d_curtainwall_slope_mapping2d.kmz", "zip"), ("missions/geoyee_m3t_waypoint.kmz", "zip"),
        ("missions/mavsdk_qgroundcontrol_sample.plan", "json"),
        ("missions/px4_multicopter_mission_geofence_avoid.plan", "json"),
        ("missions/qgc_test_MissionPlanner.waypoints", "text"),
        ("missions/traitlab_m3e_pilot2_Waypoint2_rtk/waylines.wpml", "text"),
    )  # fmt: skip
    buildings = (
        ("bim/curtain_wall_small.ifc", "text"), ("buildings/ingolstadt_lod3/4018302.xml", "text"),
        ("buildings/cityjson/delft_1b.json", "json"), ("buildings/cityjson/rotterdam_subset.json", "json"),
        ("glass/wall/wall.obj", "text"), ("buildings/pointclouds/city3d_9.ply", "binary"),
    )  # fmt: skip
    logs = (
        ("logs/pymavlink_test.BIN", "binary"), ("logs/uavlogviewer_vtol.tlog", "binary"),
        ("logs/sample_log_small.ulg", "binary"), ("logs/ardupilot_text_underpowered.log", "text"),
    )  # fmt: skip
    photos = ("M3T_DJI_0001_R.JPG", "XT2.jpg", "XTS.jpg", "Mavic2Pro_L1D-20c_issue-exifr-13.jpg", "H20T_M300.jpg")
    found = [
        _input(f"real {path}", form, Path(path).name, f"import {Path(path).name} --site site.json -o out/p.json", *SITE)
        for path, form in missions
    ]
    found += [
        _input(f"real {path}", form, Path(path).name, f"site import {Path(path).name} -o out/s.json --origin "
               "22.3,114.2,60 --without-panels")
        for path, form in buildings
    ]  # fmt: skip
    found += [
        _input(f"real {path}", form, Path(path).name, f"report plan.json site.json --log {Path(path).name} -o "
               "out/f.json", *FLYING)
        for path, form in logs
    ]  # fmt: skip
    found += [
        _input(f"real {name}", "binary", f"photos/{name}", "photos photos site.json --scale 8", "photos/", *SITE)
        for name in photos
    ]
    wall = ("wall.site.json", "wall.site.ply", "wall/", "colmap/", "grids/")
    found += [
        _input("real COLMAP images", "text", "colmap/images.txt", "photos wall wall.site.json --colmap colmap "
               "--scale 8", *wall),
        _input("real COLMAP cameras", "text", "colmap/cameras.txt", "photos wall wall.site.json --colmap colmap "
               "--scale 8", *wall),
        _input("real posed photo", "binary", "wall/img069.jpg", "prepare wall wall.site.json --colmap colmap -o out/d",
               *wall),
        _input("real photo searched", "binary", "wall/img069.jpg", "segment wall/img069.jpg -o out/p.json", *wall),
    ]  # fmt: skip
    return found


def make_workspace(folder: Path) -> None:
    """Write the files that quick inputs need into a folder."""
    with contextlib.chdir(folder):
        _plans()
        _meshes()
        _pictures_and_tables()
        _settings()


def complete_workspace(folder: Path) -> None:
    """Write all others into it."""
    with contextlib.chdir(folder):
        _models()
        _reflight("scene render site.json --square 1 --width 16 --points 20 -o scene")
        if SHARED_DATA.is_dir():
            _copied()


def _reflight(command: str) -> None:
    said = io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
        status = main(command.split(), lambda _: 99)
    assert status in (0, 1), (command, said.getvalue())
    assert "error: " not in said.getvalue(), command


def _plans() -> None:
    import trimesh

    from groundstation.services.plan.planning import plan_site
    from groundstation.services.project.folder import open_project
    from groundstation.services.project.recovery import Autosave
    from planning.request import PlanRequest
    from planning.site.bundled import write_scene
    from tests.planning.revision.cases import QUICK
    from tests.services.photo_cases import draft_of, site_model

    content = json.loads(write_scene("single-panel", Path()).read_text())
    trimesh.creation.box((5.0, 5.0, 5.0), trimesh.transformations.translation_matrix((90.0, 90.0, 5.0))).export(
        "wall.ply"
    )
    Path("site.json").write_text(json.dumps(content | {"building_mesh": "wall.ply"}))
    plan_site(Path("site.json"), PlanRequest(n_views=6, greedy=QUICK), Path("plan.json"))
    plan_site(Path("site.json"), PlanRequest(n_views=4, greedy=QUICK), Path("other.json"))
    for kind, name in (
        ("dji-kmz", "kmz"),
        ("mavlink-plan", "plan"),
        ("mavlink-wpl", "waypoints"),
        ("kml", "kml"),
        ("csv", "csv"),
    ):
        _reflight(f"export plan.json --format {kind} -o m.{name}")
    _zones()
    _card_and_book()
    _heights()
    _reflight("simulate plan.json site.json -o flight.json --speedup 1000")
    _reflight("project new project --site site.json")
    _reflight("project add project plan.json")
    Path("project/.lock.json").write_text('{"process": 1, "computer": "x", "since": "2026-01-01T00:00:00+00:00"}')
    _facades(draft_of(), site_model())
    _reflight("project new left --site site.json")
    opened = open_project(Path("left"))
    copies = Autosave(Path("left"), _Now(), lambda text: None)
    copies.keep(_changed(opened.document))
    assert Path("left/.autosave/autosave.json").is_file()


def _card_and_book() -> None:
    from groundstation.services.fly.log_book import BookEntry, book_path, enter

    route = Path("card/DJI/com.dji.industry.pilot")
    route.mkdir(parents=True)
    (route / "kept").write_bytes(b"x")
    entry = BookEntry(1.8e9, 1.8e9 + 600.0, "office", 22.3, 114.2, "DJI M3E", "ArduPilot", 1, "B1", 0.4, 6, 6, 10.2)
    enter(entry, [book_path(Path("booked/flights"))])


def _heights() -> None:
    from planning.site.bundled import ORIGIN
    from tests.planning.site.importing.height_files import transform_at, write_heights, write_hgt

    place = {"origin": ORIGIN, "crs": "EPSG:32650", "transform": transform_at(ORIGIN, "EPSG:32650"), "size": (200, 200)}
    packed = {"compress": "deflate", "tiled": True, "blockxsize": 64, "blockysize": 64}
    write_heights(Path("t.tif"), lambda x, y: 0.05 * (x + y), **place, **packed)
    write_heights(Path("dsm.tif"), lambda x, y: 0.05 * (x + y) + 9.0 * (x > 40.0), **place)
    write_hgt(Path(), "N22E114", lambda x, y: 0.05 * (x + y), origin=ORIGIN)
    _reflight("site terrain site.json t.tif --vertical ellipsoid --resolution 5 -o hill.json")


def _zones() -> None:
    from planning.site.bundled import ORIGIN
    from tests.planning.site.zones import zone_files

    ring = zone_files.square(0.0, 0.0, 100.0, ORIGIN)
    for name, content in (
        ("z.ed269.json", zone_files.ed269(zone_files.ed269_feature(zone_files.ed269_volume(zone_files.polygon(ring))))),
        ("z.ed318.json", zone_files.ed318(zone_files.polygon(ring))),
        ("z.kml", zone_files.kml(ring)),
        ("z.openair", zone_files.openair(*zone_files.openair_ring(ring))),
        ("z.aixm.xml", zone_files.aixm(zone_files.aixm_ring(ring))),
    ):
        Path(name).write_bytes(content)


class _Now:
    """An executor that does everything at once."""

    def submit(self, work):
        work()


def _changed(document):
    from dataclasses import replace

    from planning.request import PlanRequest

    return replace(document, request=PlanRequest(n_views=9))


def _facades(draft, model) -> None:
    from groundstation.services.photos.found_panels import with_found_panels
    from groundstation.services.project.document import Document
    from groundstation.services.project.folder import create_project
    from reconstruction.panels.solving.facades_file import found_facades

    found = with_found_panels(model, draft)
    create_project(Path("faced"), Document(found, found_facades=found_facades(draft.found, draft.photos)))


def _meshes() -> None:
    import trimesh

    house = trimesh.creation.box((20.0, 8.0, 12.0))
    for name, options in (
        ("b.obj", {}), ("b.stl", {}), ("b.ply", {}), ("b.glb", {}), ("b.ascii.stl", {"file_type": "stl_ascii"}),
        ("b.ascii.ply", {"file_type": "ply", "encoding": "ascii"}),
    ):  # fmt: skip
        house.export(name, **options)


def _pictures_and_tables() -> None:
    import cv2

    from groundstation.services.map.web_mercator import Tile
    from reconstruction.dataset.records import coloured_ply
    from tests.services.map_files import square, tiles_around, vector_layer, write_map, write_pmtiles

    rng = np.random.default_rng(1)
    picture = np.full((120, 160, 3), 90, np.uint8)
    for row in range(10, 110, 25):
        for column in range(10, 150, 28):
            picture[row : row + 18, column : column + 20] = rng.integers(150, 250, 3)
    for name in ("photo.png", "photo.tif", "photo.bmp", "picture.png"):
        cv2.imwrite(name, picture)
    write_map(Path("map.mbtiles"), tiles_around(22.3, 114.2, (1, 14)))
    layer = vector_layer("water", [(3, square(0, 2048), {"name": "Lake"})])
    tiles = {Tile(1, column, row): layer for column in (0, 1) for row in (0, 1)}
    write_pmtiles(Path("map.pmtiles"), tiles, tile_type=1, leaf_size=2)
    places = "\n".join(f"{n} {rng.integers(0, 1000)} {rng.integers(0, 1000)}" for n in range(1, 31))
    Path("t.tsp").write_text(
        f"NAME : t\nTYPE : TSP\nDIMENSION : 30\nEDGE_WEIGHT_TYPE : EUC_2D\nNODE_COORD_SECTION\n{places}\nEOF\n"
    )
    Path("plain/images").mkdir(parents=True)
    poses = (
        np.eye(4),
        np.array([[1.0, 0.0, 0.0, 0.5], [0.0, 0.0, -1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]]),
    )
    for name in ("a.jpg", "b.png"):
        Path("plain/images", name).write_bytes(Path("photo.png").read_bytes())
    frames = [
        {"file_path": f"images/{name}", "transform_matrix": pose.tolist(), "w": 160, "h": 120}
        for name, pose in zip(("a.jpg", "b.png"), poses, strict=True)
    ]
    lens = {"camera_model": "OPENCV", "fl_x": 150.0, "k1": -0.02, "cx": 79.0, "ply_file_path": "points.ply"}
    Path("plain/transforms.json").write_text(json.dumps({**lens, "frames": frames}))
    Path("plain/points.ply").write_bytes(coloured_ply(rng.uniform(-5.0, 5.0, (50, 3)), np.zeros((50, 3), np.uint8)))
    Path("offices").mkdir()
    cv2.imwrite("offices/a.jpg", picture)
    Path("offices/_annotations.coco.json").write_text(
        '{"categories": [{"id": 1, "name": "window"}], "images": [{"id": 7, "file_name": "a.jpg"}], '
        '"annotations": [{"category_id": 1, "image_id": 7, "segmentation": [[1, 1, 40, 1, 40, 40, 1, 40]]}]}'
    )


def _models() -> None:
    import torch
    from safetensors.torch import save_file

    from tests.reconstruction.metrics.test_lpips import arrays_of, heads_file, random_weights
    from tests.reconstruction.training.synthetic_data_set import write_data_set

    write_data_set(Path("data"), n=8)
    Path("data/scene.json").write_text('{"exposure": 1.0, "captures": {"p00.png": {"exposure": 1.1}}}')
    Path("quick.toml").write_text("n_splats = 150\nmax_splats = 200\n")
    train = "train data --preset smoke --settings quick.toml --method"
    _reflight(f"{train} 2dgs --iterations 4 -o model")
    _reflight(f"{train} 2dgs --iterations 2 --light environment-map -o lit")
    next(Path("model").glob("weights-*")).rename("model/weights.safetensors")
    description = Path("model/model.json")
    description.write_text(_renamed(description.read_text(), "weights-", "weights.safetensors"))
    _checkpoint()
    _reflight("organise model -o objects")
    _reflight("organise lit -o others")
    _reflight("records others make")
    _reflight("records objects make")
    _reflight("records objects set A-1 maker=Glas u-value=1.1")
    _reflight("records objects add A-1 defect kind=crack severity=3 found_on=2026-01-01 note=crack")
    _reflight("records objects export -o tables")
    component = next(Path("objects").glob("A-*.safetensors"))
    scene = Path("objects/gsscene.json")
    scene.write_text(scene.read_text().replace(component.name, "component.safetensors"))
    component.rename("objects/component.safetensors")
    _reflight("export objects --format cityjson -o site.city.json")
    for name in ("m.spz", "m.sog"):
        _reflight(f"export model --format {name[2:]} -o {name}")
    weights = random_weights("alex", 1)
    torch.save(heads_file(weights), "heads.pth")
    Path("alexnet.ckpt").write_bytes(pickle.dumps(arrays_of(weights), protocol=3))
    save_file({name: value.contiguous() for name, value in heads_file(weights).items()}, "heads.safetensors")


def _renamed(text: str, start: str, name: str) -> str:
    import re

    return re.sub(rf'"{start}[^"]*"', f'"{name}"', text)


def _checkpoint() -> None:
    """The state of a training that was stopped."""
    from groundstation.services.reconstruct import training as model_training
    from planning.base.errors import OperationCancelled

    class Stopping:
        left = 3

        def report(self, stage, done, total):
            self.left -= stage == "training"
            if self.left < 0:
                raise OperationCancelled("enough")

    request = model_training.TrainRequest("smoke", "2dgs", iterations=4, settings=Path("quick.toml"))
    with contextlib.suppress(OperationCancelled):
        model_training.train_files(Path("data"), Path("state"), request, monitor=Stopping())
    assert Path("state/checkpoint.safetensors").is_file(), list(Path("state").iterdir())


def _settings() -> None:
    from groundstation.services.fly.options import USUAL
    from groundstation.services.settings import Settings, write_preferences, write_settings
    from missions.mavlink.signing import KeyStore

    write_settings(
        Path("config/settings.toml"), Settings(recent_projects=("/a", "/b"), window_layouts={"800x600": "AA"})
    )
    write_preferences(Path("config/flight.toml"), USUAL)
    store = KeyStore(Path("config").absolute(), may_use_system=False)
    store.save(bytes(range(32)))
    Path("config/mavlink-signing-timestamp").write_text("123456789")
    Path("look.toml").write_text(
        "near = false\ntilt_deg = 0.3\nwall_albedo = [0.5, 0.5, 0.5]\n\n[glass]\ncoating = 0.2\n"
    )
    Path("camera.toml").write_text("shutter_s = 0.001\nspeed_m_s = 2.0\n\n[sensor]\n\n[gimbal]\n")
    Path("search.toml").write_text('long_side_px = 800\nbeta = 12.5\ndetector = "lsd"\n')


def _copied() -> None:
    for path in ("missions", "bim", "buildings/ingolstadt_lod3", "buildings/cityjson", "buildings/pointclouds", "logs"):
        for file in (SHARED_DATA / path).rglob("*"):
            if file.is_file() and file.stat().st_size < 2_000_000 and not Path(file.name).exists():
                shutil.copy(file, file.name)
    for name in ("photos", "wall", "colmap"):
        source = (
            SHARED_DATA / {"photos": "dji/photos", "wall": "glass/wall/photos", "colmap": "glass/wall/colmap"}[name]
        )
        shutil.copytree(source, name)
    for name in ("wall.obj", "wall.site.json", "wall.site.ply"):
        shutil.copy(SHARED_DATA / "glass/wall" / name, name)
    Path("grids").mkdir()

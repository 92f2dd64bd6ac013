"""Panels as windows of a city model: imported again they are the same, anywhere on Earth."""

import json
from dataclasses import replace

import numpy as np
import pytest

from planning.base.errors import InputError, OperationCancelled
from planning.geo.enu import enu_from_geodetic, geodetic_from_enu
from planning.geo.frames import Origin
from planning.geo.geoid import undulation_m
from planning.site.importing.importer import import_site
from planning.site.importing.options import ImportOptions
from reconstruction.exports.cityjson import STEP_M, write_cityjson
from reconstruction.objects.gs_scene import GsElement
from reconstruction.records.entries import global_id_of
from tests.planning.facade_shapes import SHAPES, facades, normal
from tests.reconstruction.exports.hard_scenes import Interrupted
from tests.reconstruction.objects.synthetic_scene import ORIGIN, synthetic_scene

EAST = ((12.0, 3.0, 0.5), (12.0, 5.5, 0.5), (12.0, 5.5, 2.25), (12.0, 3.0, 2.25))


def scene_at(origin=ORIGIN, name="made"):
    """Two facades, to the south and to the east."""
    scene = synthetic_scene(((1, 0, 1), (1,)), 1, name=name)
    south, east, rest = scene.components
    east = replace(east, elements=(replace(east.elements[0], corners_enu_m=EAST),))
    return replace(scene, components=(south, east, rest), origin=origin)


def content_of(path):
    return json.loads(path.read_text("utf-8"))


def apart_m(corners, others):
    """How far the corners of one panel are from the nearest of another's, whichever comes first."""
    return np.linalg.norm(np.array(corners)[:, None] - np.array(others)[None], axis=2).min(axis=1).max()


@pytest.mark.parametrize(
    ("origin", "epsg"),
    [
        (ORIGIN, 32650),
        (Origin(-33.86, 151.21, 30.0), 32756),
        (Origin(51.999, 4.37, 43.0), 32631),
        (Origin(0.0, -180.0, 10.0), 32601),
        (Origin(-0.001, 180.0, 10.0), 32701),
    ],
)
def test_imported_again_panels_are_the_same(tmp_path, origin, epsg):
    scene, path = scene_at(origin), tmp_path / "наш дом.city.json"
    done = write_cityjson(scene, path, {})
    assert (done.epsg, done.n_facades, done.n_panels) == (epsg, 2, 4)
    site = import_site(path, ImportOptions()).model.site
    found = {panel.source_id: panel for panel in site.panels}
    assert len(found) == 4
    for _, element in scene.elements:
        panel = found[element.global_id]
        place = geodetic_from_enu(site.origin, np.array(panel.corners_enu_m))
        assert apart_m(enu_from_geodetic(origin, *place), element.corners_enu_m) < 1e-3


def scene_of(shape):
    """A model of a shape's panes, without Gaussians."""
    scene = synthetic_scene(((),), 0, name=shape)
    template, components, panel = synthetic_scene().components[0], [], 0
    for facade in facades(shape):
        elements = []
        for each in facade.panels:
            global_id = global_id_of(shape, each.id)
            elements.append(GsElement(global_id, each.id, panel, each.corners_enu_m, 0, 0))
            panel += 1
        wall_id = global_id_of(shape, facade.id)
        empty = replace(scene.components[0], elements=tuple(elements))
        components.append(replace(empty, global_id=wall_id, name=facade.id, kind=template.kind))
    return replace(scene, components=tuple(components))


@pytest.mark.few(1)
@pytest.mark.parametrize("shape", SHAPES)
def test_imported_again_panes_face_where_they_did(tmp_path, shape):
    scene = scene_of(shape)
    imported = import_site(write_cityjson(scene, tmp_path / "a.json", {}).path, ImportOptions())
    found = {panel.source_id: panel for panel in imported.model.site.panels}
    assert found.keys() == {element.global_id for _, element in scene.elements}
    for _, element in scene.elements:
        assert normal(found[element.global_id].corners_enu_m) @ normal(element.corners_enu_m) > 0.99
    assert not any("both sides" in note or "turned around" in note for note in imported.notes)


def test_heights_are_above_sea_level_and_vertices_on_a_tenth_of_a_millimetre(tmp_path):
    content = content_of(write_cityjson(scene_at(), tmp_path / "a.json", {}).path)
    scale, shift = content["transform"]["scale"], np.array(content["transform"]["translate"])
    assert scale == [STEP_M] * 3
    vertices = np.array(content["vertices"]) * STEP_M + shift
    assert all(isinstance(each, int) for vertex in content["vertices"] for each in vertex)
    least_m = ORIGIN.ellipsoid_height_m - float(undulation_m(ORIGIN.lat_deg, ORIGIN.lon_deg))
    assert abs(vertices[:, 2].min() - least_m) < 1e-3
    extent = np.array(content["metadata"]["geographicalExtent"])
    np.testing.assert_allclose(extent, [*vertices.min(axis=0), *vertices.max(axis=0)], atol=STEP_M)


def test_windows_belong_to_walls_and_carry_attributes(tmp_path):
    scene = scene_at(name='Haus "7" </script>')
    (wall, window), *_ = scene.elements
    known = {
        scene.global_id: {"owner": "наш"},
        wall.global_id: {"material": "Glas", "parent": "somebody"},
        window.global_id: {"type": "IGU", "U": 1.1, "checked": True, "note": None, "n": 3, "half": "\ud800"},
    }
    content = content_of(write_cityjson(scene, tmp_path / "a.json", known).path)
    building = content["CityObjects"][scene.global_id]
    assert building["attributes"] == {
        "name": 'Haus "7" </script>',
        "heights": "above sea level by EGM96",
        "owner": "наш",
    }
    (geometry,) = building["geometry"]
    surfaces, values = geometry["semantics"]["surfaces"], geometry["semantics"]["values"]
    assert len(values) == len(geometry["boundaries"]) == 4
    assert {surfaces[value]["type"] for value in values} == {"Window"}
    walls = {number: each for number, each in enumerate(surfaces) if each["type"] == "WallSurface"}
    assert [each["name"] for each in walls.values()] == ["A", "B"]
    for number, each in walls.items():
        assert all(surfaces[child]["parent"] == number for child in each["children"])
    found = {each["id"]: each for each in surfaces}
    assert found[wall.global_id]["material"] == "Glas"
    assert found[wall.global_id]["parent_"] == "somebody"
    own = {"type_": "IGU", "U": 1.1, "checked": True, "n": 3, "half": "?"}
    assert own.items() <= found[window.global_id].items()
    assert "note" not in found[window.global_id]


def test_without_a_place_on_earth_coordinates_are_local(tmp_path):
    scene = scene_at(None)
    done = write_cityjson(scene, tmp_path / "a.json", {})
    content = content_of(done.path)
    assert done.epsg is None
    assert "referenceSystem" not in content["metadata"]
    vertices = np.array(content["vertices"]) * STEP_M + np.array(content["transform"]["translate"])
    truth = np.array([element.corners_enu_m for _, element in scene.elements]).reshape(-1, 3)
    assert apart_m(truth, vertices) < STEP_M
    options = ImportOptions(origin=Origin(10.0, 20.0, 30.0))
    assert import_site(done.path, options).model.site.n_panels == 4


@pytest.mark.parametrize(
    ("scene", "attributes", "message"),
    [
        (synthetic_scene(((),), 3), {}, "there are no panels"),
        (scene_at(Origin(84.5, 0.0, 0.0)), {}, r"latitude is 84.5°, and UTM has -80° to 84°"),
        (scene_at(Origin(-81.0, 0.0, 0.0)), {}, r"latitude is -81.0°"),
        (scene_at(), {scene_at().global_id: {"U": float("nan")}}, "attribute 'U': expected finite numbers"),
    ],
)
def test_what_cannot_be_written_is_refused(tmp_path, scene, attributes, message):
    with pytest.raises(InputError, match=message):
        write_cityjson(scene, tmp_path / "a.json", attributes)
    assert not list(tmp_path.iterdir())


def test_corners_that_are_no_numbers_are_refused_and_interrupted_writes_leave_the_old_file(tmp_path):
    path = tmp_path / "a.json"
    write_cityjson(scene_at(), path, {})
    before = path.read_bytes()
    with pytest.raises(OperationCancelled):
        write_cityjson(scene_at(name="other"), path, {}, Interrupted(1))
    scene = scene_at()
    south = scene.components[0]
    broken = replace(south.elements[0], corners_enu_m=((float("inf"), 0.0, 0.0), *EAST[1:]))
    scene = replace(scene, components=(replace(south, elements=(broken, *south.elements[1:])), *scene.components[1:]))
    with pytest.raises(InputError, match="corners that are not finite"):
        write_cityjson(scene, path, {})
    assert path.read_bytes() == before
    assert [each.name for each in tmp_path.iterdir()] == ["a.json"]

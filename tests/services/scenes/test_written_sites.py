"""A site that is written elsewhere keeps its geo-zones: beside photos, beside missions, and with other facades."""

from dataclasses import replace
from pathlib import Path

import pytest

from groundstation.services.mission.proof import _write_open
from groundstation.services.photos.panels import _rewritten
from groundstation.services.scenes.views import as_written
from groundstation.services.site.terrain import written
from planning.base.json_file import write_atomically
from planning.geo.mesh import ply_bytes
from planning.site.file import read_site, site_bytes, write_site
from planning.site.zones.keep_out import near_zones
from tests.planning.site.zones.zone_files import ed269, ed269_feature, ed269_volume, polygon, square, with_zones
from tests.planning.test_zones_of_flights import flight
from tests.slow import slow

SCHOOL = ed269(ed269_feature(ed269_volume(polygon(square(60.0, -60.0, 10.0))), identifier="SCHOOL"))


@pytest.fixture
def found(tmp_path):
    """A site in a folder of its own, with zones in another, as a reader finds it."""
    folder = tmp_path / "site"
    folder.mkdir()
    (tmp_path / "authority").mkdir()
    model = with_zones(SCHOOL, file="../authority/zones.json", SCHOOL="No. 4711")
    model = replace(model, site=replace(model.site, building_mesh="kiosk.ply"))
    (tmp_path / "authority" / "zones.json").write_bytes(SCHOOL)
    (folder / "kiosk.ply").write_bytes(ply_bytes(model.building))
    write_site(folder / "site.json", model.site)
    return read_site(folder / "site.json")


def beside_photos(model, folder):
    files = as_written(model)[1]
    for name, content in files.items():
        write_atomically(folder / name, content)
    return folder / "site.json"


def beside_missions(model, folder):
    return _write_open(flight(), model, folder, "m.kmz.")[0]


def with_other_facades(model, folder):
    source = folder.parents[1] / "site" / "site.json"
    _rewritten(model, source, folder / "found.site.json", model.site.facades, {})
    return folder / "found.site.json"


def with_terrain(model, folder):
    written(model, folder.parents[1] / "site" / "site.json", folder / "new.site.json")
    return folder / "new.site.json"


@pytest.mark.parametrize("write", [beside_photos, slow(beside_missions), with_other_facades, with_terrain])
def test_a_site_that_is_written_elsewhere_keeps_its_zones(found, tmp_path, write):
    folder = tmp_path / "else" / "where"
    folder.mkdir(parents=True)
    (before,) = near_zones(found)
    copy = read_site(write(found, folder))
    (after,) = near_zones(copy)
    assert [each.problem for each in copy.zones] == [""]
    assert (after.local.zone.id, after.permitted) == (before.local.zone.id, "No. 4711")
    assert after.local.zone == before.local.zone


def test_a_copy_of_a_copy_names_its_files_no_longer_than_the_copy(found):
    once, files = as_written(found)
    again, more = as_written(once)
    assert again.site.zones == once.site.zones
    assert set(files) == set(more)
    assert Path(once.site.zones[0].file).name == once.site.zones[0].file == "zones-1-zones.json"


def test_two_files_of_one_name_in_two_folders_stay_two(found):
    other = replace(found.zones[0], source=replace(found.zones[0].source, file="..\\old\\zones.json"), content=b"{}")
    model = replace(
        found, zones=(*found.zones, other), site=replace(found.site, zones=(found.zones[0].source, other.source))
    )
    site, files = as_written(model)[0].site, as_written(model)[1]
    assert [files[each.file] for each in site.zones] == [SCHOOL, b"{}"]


def test_a_file_of_zones_that_is_missing_stays_named_in_a_copy(found, tmp_path):
    lost = replace(found.zones[0], content=b"", problem="missing")
    copy, files = as_written(replace(found, zones=(lost,)))
    assert site_bytes(copy.site) == files["site.json"]
    (tmp_path / "copy").mkdir()
    for name, content in files.items():
        (tmp_path / "copy" / name).write_bytes(content)
    assert read_site(tmp_path / "copy" / "site.json").zones[0].problem

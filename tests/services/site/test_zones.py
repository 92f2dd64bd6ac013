"""Files of geo-zones of a site: added, replaced, taken away, permitted, written, kept by projects."""

from dataclasses import replace
from datetime import UTC, date, datetime

import pytest

from groundstation.services.project.document import Document
from groundstation.services.project.folder import open_project, save_project
from groundstation.services.site.edits import HeightReference, move_home, set_origin
from groundstation.services.site.zones import add_zones, not_here, permit, remove_zones, zone_rows, zones_of_site
from planning.base.errors import InputError
from planning.site.file import read_site, write_site
from planning.site.zones.keep_out import no_fly_volumes
from tests.planning.site.zones.zone_files import ed269, ed269_feature, ed269_volume, polygon, site, square

TODAY = date(2026, 11, 28)

NIGHT = [{"permanent": "NO", "schedule": [{"day": ["ANY"], "startTime": "20:00Z", "endTime": "04:00Z"}]}]

CONTENT = ed269(
    ed269_feature(ed269_volume(polygon(square(0.0, 0.0, 20.0)))),
    ed269_feature(ed269_volume(polygon(square(300.0, 0.0, 20.0))), identifier="Z2", applicability=NIGHT),
)

OTHER = ed269(ed269_feature(ed269_volume(polygon(square(10.0, 0.0, 20.0)))))


@pytest.fixture
def place(tmp_path):
    """A site file, and a file of zones elsewhere."""
    (tmp_path / "site").mkdir()
    (tmp_path / "from").mkdir()
    write_site(tmp_path / "site" / "a.site.json", replace(site().site, building_mesh=None))
    (tmp_path / "from" / "zones.json").write_bytes(CONTENT)
    return tmp_path


def added(place, **wanted):
    return zones_of_site(place / "site" / "a.site.json", [place / "from" / "zones.json"], today=TODAY, **wanted)


def test_a_file_is_put_beside_the_site_and_listed_the_nearest_zone_first(place):
    model = added(place).model
    assert (place / "site" / "zones.json").read_bytes() == CONTENT
    assert read_site(place / "site" / "a.site.json").site == model.site
    rows = zone_rows(model, datetime(2026, 11, 28, 12, tzinfo=UTC))
    assert [(row.id, row.is_kept) for row in rows] == [("Z1", True), ("Z2", False)]
    assert rows[1].distance_m == pytest.approx(180.0, abs=0.5)
    assert [row.is_kept for row in zone_rows(model)] == [True, True]
    before = (place / "site" / "a.site.json").read_bytes()
    zones_of_site(place / "site" / "a.site.json", today=TODAY)
    assert (place / "site" / "a.site.json").read_bytes() == before


def test_permissions_stay_with_the_content_that_they_were_given_for(place):
    model = added(place, permissions={"Z1": "4711"}).model
    assert [row.permitted for row in zone_rows(model)] == ["4711", ""]
    assert len(no_fly_volumes(read_site(place / "site" / "a.site.json"))) == 1
    assert [row.permitted for row in zone_rows(added(place).model)] == ["4711", ""]
    (place / "from" / "zones.json").write_bytes(OTHER)
    again = added(place)
    assert "state them again: 'Z1'" in again.notes[0]
    assert [row.permitted for row in zone_rows(again.model)] == [""]
    assert (place / "site" / "zones.json").read_bytes() == OTHER
    assert len(read_site(place / "site" / "a.site.json").site.zones) == 1


def test_edits_that_cannot_be_are_refused_and_nothing_is_written(place):
    model = added(place).model
    before = (place / "site" / "a.site.json").read_bytes()
    with pytest.raises(InputError, match=r"no zone 'Z9'.*'Z1', 'Z2'"):
        permit(model, "Z9", "x")
    with pytest.raises(InputError, match=r"no file of geo-zones 'b\.json'; it has: zones\.json"):
        remove_zones(model, "b.json")
    (place / "from" / "zones.json").write_bytes(CONTENT[:-9])
    with pytest.raises(InputError, match="JSON"):
        added(place)
    with pytest.raises(InputError, match="in the folder of the site"):
        zones_of_site(place / "site" / "a.site.json", out=place / "b.site.json", today=TODAY)
    assert (place / "site" / "a.site.json").read_bytes() == before
    assert not (place / "b.site.json").exists()


def test_a_strange_file_of_that_name_beside_the_site_is_left_alone(place):
    (place / "site" / "zones.json").write_text("mine")
    with pytest.raises(InputError, match="another file of that name"):
        added(place)
    assert (place / "site" / "zones.json").read_text() == "mine"


def test_a_permission_is_taken_back_and_a_file_taken_away(place):
    model = permit(added(place).model, "Z2", "4711")
    assert not permit(model, "Z2", " ").site.zones[0].permitted
    gone = remove_zones(model, "zones.json")
    assert not gone.site.zones
    assert not gone.zones
    assert no_fly_volumes(gone) == ()


LOST = ed269(
    ed269_feature(ed269_volume(polygon([*square(0.0, 0.0, 20.0)[:4], [None, 47.0], square(0.0, 0.0, 20.0)[4]]))),
    ed269_feature(ed269_volume(polygon(square(300.0, 0.0, 20.0))), identifier="Z2"),
)


def test_an_answer_opens_nothing_that_can_be_read_and_is_kept_with_the_content_that_it_was_given_for(place):
    (place / "from" / "zones.json").write_bytes(LOST)
    model = added(place, answers={"Z1": " Town "}).model
    assert [(row.is_open, row.is_kept, row.not_here, row.permitted) for row in zone_rows(model)] == [
        (False, True, "Town", ""),
        (False, True, "", ""),
    ]
    assert len(no_fly_volumes(read_site(place / "site" / "a.site.json"))) == 2
    assert read_site(place / "site" / "a.site.json").site == model.site
    assert not not_here(model, "Z1", "").site.zones[0].not_here
    both = permit(model, "Z1", "4711").site.zones[0]
    assert (both.permitted, both.not_here) == ({"Z1": "4711"}, {"Z1": "Town"})
    (place / "from" / "zones.json").write_bytes(OTHER)
    again = added(place)
    assert "permissions and answers of the old state of 'zones.json' have ended, state them again: 'Z1'" in again.notes
    assert [row.not_here for row in zone_rows(again.model)] == [""]


def test_a_zone_that_leaves_nothing_open_of_its_place_takes_no_answer(place):
    with pytest.raises(InputError, match=r"zone 'Z2' leaves nothing open about where it lies.*--permit"):
        not_here(added(place).model, "Z2", "Town")


def test_a_zone_on_both_sides_of_a_sheet_s_edge_is_permitted_once_and_different_ones_by_their_file(place):
    first, second = ed269_feature(ed269_volume(polygon(square(0.0, 0.0, 20.0)))), CONTENT
    (place / "from" / "west.json").write_bytes(ed269(first))
    (place / "from" / "east.json").write_bytes(second)
    (place / "from" / "other.json").write_bytes(OTHER)
    model = add_zones(site(), [place / "from" / "west.json", place / "from" / "east.json"], TODAY).model
    assert [row.permitted for row in zone_rows(permit(model, "Z1", "4711")) if row.id == "Z1"] == ["4711", "4711"]
    model = add_zones(model, [place / "from" / "other.json"], TODAY).model
    with pytest.raises(InputError, match="differs between files"):
        permit(model, "Z1", "4711")
    one = permit(model, "other.json/Z1", "4711")
    assert {source.file: dict(source.permitted) for source in one.site.zones} == {
        "west.json": {},
        "east.json": {},
        "other.json": {"Z1": "4711"},
    }


def test_zones_follow_the_site_through_edits(place):
    model = move_home(added(place).model, (0.0, -35.0, 0.0))
    assert len(no_fly_volumes(model)) == 2
    moved = set_origin(model, 47.1, 8.0, 500.0, HeightReference.ELLIPSOID)
    assert [row.id for row in zone_rows(moved)] == []


def test_projects_keep_the_files_and_do_not_write_them_twice(place, tmp_path):
    model = add_zones(site(), [place / "from" / "zones.json"], TODAY).model
    folder = tmp_path / "project"
    document = save_project(folder, Document(site=model))
    assert (folder / "site" / "zones.json").read_bytes() == CONTENT
    opened = open_project(folder).document
    assert opened.site.site.zones == model.site.zones
    assert [row.id for row in zone_rows(opened.site)] == ["Z1", "Z2"]
    (place / "from" / "zones.json").write_bytes(OTHER)
    newer = add_zones(document.site, [place / "from" / "zones.json"], TODAY).model
    save_project(folder, replace(document, site=newer))
    again = open_project(folder).document.site
    assert [row.id for row in zone_rows(again)] == ["Z1"]
    files = sorted(path.name for path in (folder / "site").iterdir())
    assert len([name for name in files if name.startswith("zones")]) == 1
    second = save_project(tmp_path / "copy", Document(site=again))
    assert [row.id for row in zone_rows(second.site)] == ["Z1"]
    assert [row.id for row in zone_rows(open_project(tmp_path / "copy").document.site)] == ["Z1"]

"""Places of findings lead to things in the window."""

from dataclasses import replace

import pytest

from groundstation.services.plan.places import item_of_place
from groundstation.services.project.document import Document, Item, ItemKind, PlanEntry
from planning.checks import check_plan
from tests.missions.plans import example_plan
from tests.planning.plan_cases import kiosk
from tests.planning.site.zones.zone_files import ed269, ed269_feature, ed269_volume, polygon, square, with_zones


@pytest.fixture(scope="module")
def document():
    entry = PlanEntry("plan-1", "Plan", example_plan())
    return Document(site=kiosk(), plans=(entry,), current_plan_id="plan-1")


@pytest.mark.parametrize(
    ("place", "item"),
    [
        ("v0003", Item(ItemKind.VIEWPOINT, "v0003")),
        ("sortie 2", Item(ItemKind.SORTIE, "2")),
        ("sortie 2, leg 5", Item(ItemKind.LEG, "2/5")),
        ("sortie 1, v0004", Item(ItemKind.VIEWPOINT, "v0004")),
        ("home", Item(ItemKind.HOME)),
        ("A-0001", Item(ItemKind.PANEL, "A-0001")),
        ("A", Item(ItemKind.FACADE, "A")),
        ("tree", Item(ItemKind.OBSTACLE, "tree")),
        ("road", Item(ItemKind.NO_FLY, "road")),
        ("no-fly/road", Item(ItemKind.NO_FLY, "road")),
        ("facade/B", Item(ItemKind.FACADE, "B")),
        ("building", Item(ItemKind.BUILDING)),
        ("sortie 1, waypoint 3, group 2, action 0 (rotateYaw)", Item(ItemKind.SORTIE, "1")),
        ("sortie 1, wayline, waypoint 3", Item(ItemKind.SORTIE, "1")),
    ],
)
def test_place_means_the_smallest_thing_that_the_document_has(document, place, item):
    assert item_of_place(place, document) == item


NOWHERE = ("", " ", ",", "/", "no-fly/", "facade/9", "template.kml, waypoint 4", "v9999", "sortie 7", "sortie 0")


@pytest.mark.parametrize("place", NOWHERE)
def test_place_that_names_nothing_in_the_document_means_nothing(document, place):
    assert item_of_place(place, document) is None


def test_leg_beyond_the_path_means_its_sortie(document):
    assert item_of_place("sortie 2, leg 500", document) == Item(ItemKind.SORTIE, "2")


def test_identifier_with_a_comma_is_taken_whole(document):
    entry = document.plans[0]
    odd = replace(entry.plan.viewpoints[0], id="a, b")
    sortie = replace(entry.plan.sorties[0], viewpoint_ids=("a, b",))
    plan = replace(entry.plan, viewpoints=(odd,), sorties=(sortie,))
    changed = document.with_plan(replace(entry, plan=plan))
    assert item_of_place("a, b", changed) == Item(ItemKind.VIEWPOINT, "a, b")


def test_nothing_open_means_nothing():
    assert item_of_place("home", Document()) is None
    assert item_of_place("v0000", Document()) is None


def test_every_place_that_the_checks_name_leads_somewhere(document):
    findings = check_plan(document.current.plan, document.site)
    places = {finding.place for finding in findings if finding.place}
    assert len(places) > 5
    assert all(item_of_place(place, document) is not None for place in places), places


def test_places_of_geo_zones_lead_to_the_zone_and_to_its_file():
    model = with_zones(ed269(ed269_feature(ed269_volume(polygon(square(0.0, 0.0, 50.0))), identifier="CTR 7")))
    document = Document(site=model)
    assert item_of_place("CTR 7", document) == Item(ItemKind.ZONE, "zones.json/CTR 7")
    assert item_of_place("zones.json", document) == Item(ItemKind.ZONE_FILE, "zones.json")
    assert item_of_place("CTR 8", document) is None

"""Is this mission file the plan: round trips are, anything changed is not and is named."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from groundstation.services.mission.compare import Difference, MissionComparison, PhotoComparison, compare_with_plan
from groundstation.services.mission.files import read_mission_files
from missions.mission.export_choices import FileFormat
from planning.base.errors import InputError
from tests.missions.plans import HOME, HONG_KONG, example_plan, export, make_plan, ring

ENDINGS = {
    FileFormat.DJI_KMZ: ".kmz",
    FileFormat.MAVLINK_PLAN: ".plan",
    FileFormat.MAVLINK_WPL: ".waypoints",
    FileFormat.KML: ".kml",
    FileFormat.CSV: ".csv",
}


@pytest.fixture
def read(tmp_path):
    """Export a plan, and read all its files back."""

    def exported(plan, file_format=FileFormat.DJI_KMZ):
        path = tmp_path / f"mission{ENDINGS[file_format]}"
        return read_mission_files(export(plan, HONG_KONG, HOME, file_format, path))

    return exported


def compared(missions, plan):
    return compare_with_plan(missions, plan, HONG_KONG, HOME)


@pytest.mark.parametrize("file_format", list(FileFormat))
def test_what_was_exported_is_the_plan(read, file_format):
    plan = example_plan()
    found = compared(read(plan, file_format), plan)
    assert found.is_the_plan
    assert [photo.viewpoint_id for photo in found.photos] == [i for s in plan.sorties for i in s.viewpoint_ids]
    assert max(photo.distance_m for photo in found.photos) < 0.02
    if file_format is FileFormat.CSV:
        assert found.path_deviation_m is None
    else:
        assert found.path_deviation_m < 0.05


def changed_view(plan, index, **changes):
    """The plan with one viewpoint changed, and its path with it."""
    old = plan.viewpoints[index]
    new = replace(old, **changes)
    views = tuple(new if view is old else view for view in plan.viewpoints)
    sorties = tuple(
        replace(s, path_enu_m=tuple(new.position_enu_m if p == old.position_enu_m else p for p in s.path_enu_m))
        for s in plan.sorties
    )
    return replace(plan, viewpoints=views, sorties=sorties)


def test_a_moved_photo_is_named_with_how_far(read):
    plan = example_plan()
    x, y, z = plan.viewpoints[2].position_enu_m
    found = compared(read(changed_view(plan, 2, position_enu_m=(x + 1.0, y, z))), plan)
    (photo,) = [photo for photo in found.photos if photo.difference is not Difference.SAME]
    assert photo.difference is Difference.CHANGED
    assert photo.viewpoint_id == "v0002"
    assert photo.distance_m == pytest.approx(1.0, abs=0.02)
    assert found.path_deviation_m == pytest.approx(1.0, abs=0.3)
    assert not found.is_the_plan


@pytest.mark.parametrize(("heading_deg", "turned_deg"), [(-175.0, 5.0), (175.0, -5.0)])
def test_a_turn_is_told_the_short_way_round(read, heading_deg, turned_deg):
    plan = changed_view(example_plan(), 0, heading_deg=180.0)
    found = compared(read(changed_view(plan, 0, heading_deg=heading_deg)), plan)
    assert found.photos[0].heading_deg == pytest.approx(turned_deg, abs=0.05)
    assert found.photos[0].difference is Difference.CHANGED


def test_a_missing_sortie_is_missing_photo_by_photo(read):
    plan = example_plan()
    found = compared(read(plan)[:1], plan)
    assert [photo.viewpoint_id for photo in found.photos if photo.difference is Difference.MISSING] == list(
        plan.sorties[1].viewpoint_ids
    )
    assert found.count(Difference.SAME) == 6


def test_photos_that_are_not_planned_are_extra(read):
    plan = make_plan([(ring(4), {})])
    found = compared(read(make_plan([(ring(4), {}), (ring(3, 60.0, 4), {})])), plan)
    assert found.count(Difference.EXTRA) == 3
    assert [photo.file_sortie for photo in found.photos if photo.difference is Difference.EXTRA] == [2, 2, 2]


def test_another_order_is_told_although_every_photo_is_there(read):
    views = ring(6)
    plan = make_plan([(views, {})])
    found = compared(read(make_plan([([views[0], views[3], views[1], views[2], *views[4:]], {})])), plan)
    assert found.count(Difference.SAME) == 6
    assert [photo.viewpoint_id for photo in found.photos if photo.is_out_of_order] == ["v0003"]
    assert found.has_the_photos
    assert not found.is_the_plan


def test_a_path_through_another_place_is_not_the_plan(read):
    views = ring(4)
    plan = make_plan([(views, {})])
    found = compared(read(make_plan([(views, {2: (40.0, 40.0, 30.0)})])), plan)
    assert found.count(Difference.SAME) == 4
    assert found.path_deviation_m > 10.0
    assert not found.is_the_plan


def test_plans_without_photos_are_nothing_to_be(read):
    plan = replace(example_plan(), viewpoints=(), sorties=())
    found = compared(read(example_plan()), plan)
    assert found.count(Difference.EXTRA) == 10
    assert found.path_deviation_m is None
    assert not found.is_the_plan


def test_too_many_photos_are_refused_before_the_memory_is_full(read, monkeypatch):
    monkeypatch.setattr("groundstation.services.mission.compare.MAX_PAIRS", 50)
    with pytest.raises(InputError, match="10 planned photos and 10 in the file"):
        compared(read(example_plan()), example_plan())


@settings(max_examples=30)
@given(st.permutations(range(7)))
def test_photos_out_of_order_are_the_fewest_that_must_go(order):
    """Against trying every subset."""
    from itertools import combinations

    from groundstation.services.mission.compare import _out_of_order

    kept = max(k for k in range(8) for part in combinations(order, k) if list(part) == sorted(part))
    found = _out_of_order(order)
    assert len(found) == 7 - kept
    rest = [value for value in order if value not in found]
    assert rest == sorted(rest)


def test_samples_are_close_together_and_hold_every_vertex():
    from groundstation.services.mission.compare import SAMPLE_M, _samples

    path = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 3.2], [0.0, 0.0, 3.2], [7.1, 0.0, 3.2]])
    samples = _samples(path)
    assert np.linalg.norm(np.diff(samples, axis=0), axis=1).max() <= SAMPLE_M + 1e-9
    for vertex in path:
        assert np.linalg.norm(samples - vertex, axis=1).min() < 1e-9


def test_real_mission_of_dji_pilot_is_compared_on_its_own_site(shared_data):
    missions = read_mission_files([shared_data / "missions" / "djisdk_psdk_m3e_waypoint_v3_test.kmz"])
    from planning.geo.frames import Origin

    first = missions[0].waypoints[0]
    found = compare_with_plan(missions, example_plan(), Origin(first.lat_deg, first.lon_deg, 0.0), HOME)
    assert found.count(Difference.MISSING) == 10
    assert not found.is_the_plan


@pytest.mark.parametrize(
    ("photos", "missing"),
    [
        (((Difference.SAME, 1), (Difference.MISSING, 2), (Difference.MISSING, 3)), (2, 3)),
        (((Difference.SAME, 1), (Difference.MISSING, 1), (Difference.MISSING, 2)), ()),
        (((Difference.SAME, 1), (Difference.CHANGED, 1), (Difference.MISSING, 2)), ()),
        (((Difference.MISSING, 1), (Difference.MISSING, 2)), ()),
        (((Difference.SAME, 1), (Difference.SAME, 2)), ()),
    ],
)
def test_one_file_of_a_plan_with_more_sorties_is_told_from_another_mission(photos, missing):
    compared = tuple(PhotoComparison(difference, "v", sortie, 0, 0) for difference, sortie in photos)
    assert MissionComparison(compared, None, ()).missing_sorties == missing

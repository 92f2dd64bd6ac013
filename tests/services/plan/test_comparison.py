"""Comparing plans that are open, and plan files."""

import json
from dataclasses import replace

import pytest

from groundstation.services.plan.comparison import (
    compare,
    compare_files,
    comparison_summary,
    distinct_titles,
    marked_as_best,
)
from groundstation.services.project.document import PlanEntry
from planning.base.errors import InputError
from planning.geo.frames import Origin
from planning.plan import write_plan
from planning.site.bundled import write_scene
from tests.planning.insight.cases import plan, prepared, scene


def planned():
    return plan("single-panel")


def fewer():
    return replace(planned(), viewpoints=planned().viewpoints[:3], sorties=())


@pytest.mark.slow
def test_open_plans_are_compared_on_the_site_as_it_was_prepared():
    found = compare(scene("single-panel"), [planned(), fewer()], ["all", "some"], prepared("single-panel"))
    again = compare(scene("single-panel"), [planned(), fewer()], ["all", "some"])
    assert found.names == ("all", "some")
    assert [row.values for row in found.rows] == [row.values for row in again.rows]


@pytest.mark.slow
def test_summaries_are_json_and_name_the_better_plan():
    found = compare(scene("single-panel"), [planned(), fewer()], ["all", "some"], prepared("single-panel"))
    summary = json.loads(json.dumps(comparison_summary(found), allow_nan=False))
    assert summary["plans"] == ["all", "some"]
    rows = {(row["code"], row["subject"]): row for row in summary["rows"]}
    assert len(rows) == len(summary["rows"])
    assert rows["views", ""] | {"label": ""} == {
        "code": "views",
        "label": "",
        "unit": "",
        "better": "lower",
        "values": [12.0, 3.0],
        "subject": "",
        "best": [1],
    }
    assert rows["covered", ""]["best"] == [0]
    assert rows["clearance", ""]["values"][1] is None
    assert summary["constraints"]["min_distance_m"] == 5.0


@pytest.mark.long
@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"site": "elsewhere"}, "some: this plan was made for site 'elsewhere', the site here is 'single-panel';"),
        ({"origin": Origin(1.0, 2.0, 3.0)}, "at another origin; compare plans of one site"),
    ],
)
def test_plans_of_another_place_are_refused(changes, message):
    with pytest.raises(InputError, match=message):
        compare(scene("single-panel"), [planned(), replace(fewer(), **changes)], ["all", "some"])


def test_one_plan_alone_is_refused():
    with pytest.raises(InputError, match="expected two plans or more to compare, got 1"):
        compare(scene("single-panel"), [planned()], ["all"])


def test_files_are_named_by_their_names_or_by_paths_where_those_are_alike(tmp_path):
    site = write_scene("single-panel", tmp_path)
    (tmp_path / "old").mkdir()
    paths = [tmp_path / "a.plan.json", tmp_path / "b.json", tmp_path / "old" / "b.json"]
    for path, its_plan in zip(paths, (planned(), fewer(), planned()), strict=True):
        write_plan(path, its_plan)
    assert compare_files(paths[:2], site).names == ("a", "b")
    assert compare_files(paths[1:], site).names == (str(paths[1]), str(paths[2]))
    with pytest.raises(InputError, match="named twice"):
        compare_files([paths[0], paths[0]], site)


def entries(*titles_and_methods):
    return tuple(
        PlanEntry(f"p{number}", title, replace(planned(), method=method))
        for number, (title, method) in enumerate(titles_and_methods)
    )


@pytest.mark.parametrize(
    ("plans", "names"),
    [
        ((("north", "greedy"), ("south", "greedy")), ("north", "south")),
        ((("north", "greedy"), ("north", "imported")), ("north, greedy", "north, imported")),
        (
            (("north", "pso"), ("south", "pso"), ("north", "pso"), ("north", "noto")),
            ("north, pso (1)", "south", "north, pso (2)", "north, noto"),
        ),
    ],
)
def test_plans_of_the_same_title_are_told_apart(plans, names):
    assert distinct_titles(entries(*plans)) == names


@pytest.mark.parametrize(
    ("texts", "best", "marked"),
    [
        (("11:53", "11:54"), (0,), (True, False)),
        (("11:53", "11:53"), (1,), (False, False)),
        (("11:53", "11:53", "11:54"), (1,), (True, True, False)),
        (("3", "-"), (), (False, False)),
    ],
)
def test_no_star_marks_a_difference_that_cannot_be_seen(texts, best, marked):
    assert marked_as_best(texts, best) == marked

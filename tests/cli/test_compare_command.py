"""`compare`: plans side by side as a table, and as JSON."""

import pytest

from planning.site.bundled import write_scene


@pytest.fixture
def fewer(pane, changed):
    """The plan with the first three of its views only, and no sorties."""
    import json

    viewpoints = json.loads((pane / "plan.json").read_text())["viewpoints"][:3]
    without = changed(pane / "plan.json", "sorties", [])
    return changed(without, "viewpoints", viewpoints)


def test_the_table_has_a_column_a_plan_and_stars_at_the_better_values(reflight, pane, fewer):
    done = reflight("compare", pane / "plan.json", fewer, "--site", pane / "site.json")
    assert (done.status, done.err) == (0, "")
    lines = done.out.splitlines()
    assert lines[0].split() == ["plan", fewer.name.removesuffix(".json")]
    rows = {line[:30].split("  ")[0].strip(): line for line in lines[1:]}
    assert rows["views"].split() == ["views", "6", "3*"]
    covered = rows["sections covered"].split()
    assert covered[2].endswith("*")
    assert int(covered[2][:-1]) > int(covered[3])
    assert rows["smallest clearance"].split()[-1] == "-"
    assert "coverage of all plans: 30 degree sections, 10 m minimum distance" in done.out


def test_json_holds_every_row_with_its_values(reflight, pane, fewer):
    done = reflight("compare", pane / "plan.json", fewer, pane / "plan.json", "--site", pane / "site.json", "--json")
    assert "named twice" in done.error
    done = reflight("compare", pane / "plan.json", fewer, "--site", pane / "site.json", "--json")
    assert (done.status, done.err) == (0, "")
    rows = {(row["code"], row["subject"]): row for row in done.json["rows"]}
    assert rows["views", ""]["values"] == [6.0, 3.0]
    assert rows["views", ""]["best"] == [1]
    assert rows["findings", "error"]["values"][0] == 0.0


def test_other_constraints_are_noted(reflight, pane, fewer, changed):
    other = changed(fewer, "constraints", "min_distance_m", 7.5)
    done = reflight("compare", pane / "plan.json", other, "--site", pane / "site.json")
    assert done.status == 0
    assert "was made for other constraints (minimum distance (m) 7.5 instead of 10.0)" in done.out


def test_one_plan_alone_is_wrong_usage(reflight, pane):
    done = reflight("compare", pane / "plan.json", "--site", pane / "site.json")
    assert done.status == 2
    assert "PLAN" in done.err


@pytest.mark.long
def test_files_that_are_no_plan_and_plans_of_another_site_are_refused(reflight, pane, fewer, bad_file, tmp_path):
    assert str(bad_file) in reflight("compare", pane / "plan.json", bad_file, "--site", pane / "site.json").error
    assert str(bad_file) in reflight("compare", pane / "plan.json", fewer, "--site", bad_file).error
    office = write_scene("office", tmp_path)
    error = reflight("compare", pane / "plan.json", fewer, "--site", office).error
    assert "this plan was made for site 'single-panel', the site here is 'office'" in error

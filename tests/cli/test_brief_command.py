"""`brief` writes one page, and refuses what it cannot write."""

import json
import re

import pytest


def test_brief_is_one_html_page_with_its_pictures(reflight, pane, tmp_path):
    out = tmp_path / "brief.html"
    done = reflight("brief", pane / "plan.json", pane / "site.json", "-o", out)
    assert done.status == 0
    assert done.out.strip() == str(out)
    page = out.read_text("utf-8")
    assert page.startswith("<!DOCTYPE html>")
    assert page.count("data:image/svg+xml") == 2
    assert "Flight brief: single-panel" in page


def test_json_says_what_was_written_and_letter_is_a_choice(reflight, pane, tmp_path):
    out = tmp_path / "brief.htm"
    arguments = ("--units", "imperial", "--paper", "a4", "--json")
    done = reflight("brief", pane / "plan.json", pane / "site.json", "-o", out, *arguments)
    assert (done.json["file"], done.json["flyable"]) == (str(out), True)
    assert "size: A4" in out.read_text("utf-8")
    assert " ft" in out.read_text("utf-8")


def test_a_pdf_is_refused_with_the_two_ways_to_get_one(reflight, pane, tmp_path):
    done = reflight("brief", pane / "plan.json", pane / "site.json", "-o", tmp_path / "brief.pdf")
    assert "expected a name that ends in .html" in done.error
    assert "browser" in done.error
    assert not list(tmp_path.iterdir())


def test_bad_plans_and_places_are_refused_and_nothing_is_written(reflight, pane, bad_file, tmp_path):
    out = tmp_path / "brief.html"
    assert str(bad_file) in reflight("brief", bad_file, pane / "site.json", "-o", out).error
    assert not out.exists()
    missing = tmp_path / "none" / "brief.html"
    assert "there is no folder" in reflight("brief", pane / "plan.json", pane / "site.json", "-o", missing).error


def test_a_plan_that_may_not_fly_is_told(reflight, pane, tmp_path):
    plan = json.loads((pane / "plan.json").read_text())
    plan["aircraft"]["endurance_s"] = 10.0
    (tmp_path / "far.json").write_text(json.dumps(plan))
    done = reflight("brief", tmp_path / "far.json", pane / "site.json", "-o", tmp_path / "brief.html")
    assert done.status == 0
    assert "NOT ready to fly" in done.err


def test_ground_risk_stands_in_the_brief_where_something_of_it_is_stated(reflight, pane, tmp_path):
    out = tmp_path / "brief.html"
    stated = ("--population", "controlled", "--wind", "5", "--speed", "5")
    assert reflight("brief", pane / "plan.json", pane / "site.json", "-o", out, *stated).status == 0
    assert "none: controlled ground area" in out.read_text("utf-8")
    wrong = reflight("brief", pane / "plan.json", pane / "site.json", "-o", tmp_path / "x.html", "--population", "few")
    assert "--population: expected one of" in wrong.error


@pytest.mark.parametrize("language", ["en", "de"])
def test_paper_names_no_option_to_type_and_each_sortie_has_its_distance(reflight, pane, tmp_path, language):
    out = tmp_path / "brief.html"
    assert reflight("--language", language, "brief", pane / "plan.json", pane / "site.json", "-o", out).status == 0
    page = re.sub(r'"data:[^"]*"', "", out.read_text("utf-8"))
    assert not re.search(r"(?<![\w-])--[a-z]", page)
    # What was measured of a sortie is found by its name, whatever the language.
    assert not {"not measured", "nicht gemessen"} & set(re.split(r"[<>]", page))

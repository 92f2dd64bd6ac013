"""`site zones`: files of geo-zones beside a site, what applies near it, and what plans and checks make of it."""

import json
import shutil

import pytest

from planning.site.bundled import ORIGIN
from tests.planning.site.zones.zone_files import (
    ed269,
    ed269_feature,
    ed269_volume,
    openair,
    openair_ring,
    polygon,
    square,
)


@pytest.fixture
def place(pane, tmp_path):
    """The pane's site and plan, and a zone over all of it in the evenings."""
    folder = tmp_path / "pane"
    shutil.copytree(pane, folder)
    night = [{"permanent": "NO", "schedule": [{"day": ["ANY"], "startTime": "12:00Z", "endTime": "20:00Z"}]}]
    volume = ed269_volume(polygon(square(0.0, 0.0, 200.0, ORIGIN)))
    (folder / "zones.json").write_bytes(ed269(ed269_feature(volume, applicability=night)))
    return folder


DAY, EVENING = "2026-11-28T03:00+00:00", "2026-11-28T13:00+00:00"


def codes(done):
    return {finding["code"]: finding["severity"] for finding in done.json["findings"]}


def test_zones_are_added_listed_checked_and_permitted(reflight, place):
    site, plan = place / "site.json", place / "plan.json"
    done = reflight("site", "zones", site, place / "zones.json")
    assert done.status == 0
    assert "School: flights prohibited (SENSITIVE), 0 m AGL - 120 m AGL" in done.out
    assert "kept out of" in done.out
    found = reflight("site", "zones", site, "--at", DAY, "--json").json
    assert [zone["is_kept"] for zone in found["zones"]] == [False]
    assert found["files"][0]["zones"] == 1
    checked = {at: reflight("check", plan, site, "--at", at, "--json") for at in (DAY, EVENING)}
    assert codes(checked[DAY])["zone"] == "note"
    assert (codes(checked[EVENING])["zone"], checked[EVENING].status) == ("error", 1)
    assert codes(checked[DAY])["site"] == "ok"
    refused = reflight("plan", site, "-o", place / "b.plan.json", "--views", 2, "--at", EVENING)
    assert refused.status == 1
    assert "geo-zone 'School' (flights prohibited)" in refused.err
    card = place / "CARD"
    card.mkdir()
    not_sent = reflight("send", plan, "--site", site, "--to", card).error
    assert "not sent. NOT ready to fly: " in not_sent
    assert "School: flights prohibited" in not_sent
    assert not list(card.iterdir())
    sent = reflight("send", plan, "--site", site, "--to", card, "--despite-errors")
    assert sent.status == 0
    assert "warning: NOT ready to fly: " in sent.err
    assert len(list(card.iterdir())) == 1
    exported = reflight("export", plan, "--site", site, "--format", "kml", "-o", place / "plan.kml")
    assert "warning: NOT ready to fly: " in exported.err
    assert reflight("site", "zones", site, "--permit", "Z1=4711").status == 0
    assert codes(reflight("check", plan, site, "--at", EVENING, "--json"))["zone"] == "note"
    assert json.loads(site.read_text())["zones"][0]["permitted"] == {"Z1": "4711"}
    assert reflight("site", "zones", site, "--remove", "zones.json").out.startswith("no geo-zones are known here")
    assert "zones" not in json.loads(site.read_text())


def test_a_zone_with_an_unreadable_corner_is_an_open_question_until_it_is_answered(reflight, place):
    site, plan = place / "site.json", place / "plan.json"
    lines = openair_ring(square(0.0, -500.0, 20.0, ORIGIN))
    (place / "zones.txt").write_bytes(openair(*lines[:2], "DP 22:2x:00 N 114:15:00 E", *lines[3:]))
    listed = reflight("site", "zones", site, place / "zones.txt")
    assert (
        "where it lies is an open question: no flight is ready until somebody says that it is not here (--not-here), "
        "or permits it (--permit)"
    ) in listed.out
    assert "question: line 'DP 22:2x:00 N 114:15:00 E' cannot be read" in listed.out
    done = reflight("check", plan, site)
    assert done.status == 1
    assert done.out.splitlines()[-1] == "not ready to fly: see the errors above"
    (told,) = (line for line in done.out.splitlines() if "School" in line)
    assert "where it lies cannot be read for sure in 'zones.txt': line 'DP 22:2x" in told
    listed = reflight("site", "zones", site, "--not-here", "School=Town, by phone, 30 November")
    words = "what cannot be read of it is not here according to 'Town, by phone, 30 November'"
    assert f"; kept out of; {words}" in listed.out
    answered = reflight("check", plan, site)
    assert answered.status == 0
    assert words in answered.out
    assert reflight("site", "zones", site, "--not-here", "School=", "--permit", "School=No. 4711").status == 0
    permitted = reflight("check", plan, site)
    assert permitted.status == 0
    assert "where it lies is not sure; the authorisation 'No. 4711' opens all of it" in permitted.out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("missing.json",), "no such file"),
        (("site.json",), "expected a file of geo-zones"),
        (("--permit", "Z1"), "expected ZONE=REFERENCE, got 'Z1'"),
        (("--permit", "Z1=x"), "no zone 'Z1'"),
        (("--not-here", "=x"), "expected ZONE=REFERENCE, got '=x'"),
        (("--at", "noon"), "expected a time such as"),
    ],
)
def test_what_cannot_be_done_is_said_in_one_line(reflight, place, arguments, words):
    done = reflight("site", "zones", place / "site.json", *(place / a if a.endswith(".json") else a for a in arguments))
    assert done.status == 1
    assert words in done.err
    assert done.err.count("\n") == 1

"""`sun`: light on facades, and take-off times of sorties."""

import json
from datetime import datetime

import numpy as np
import pytest


def test_a_site_alone_tells_its_light(reflight, pane):
    done = reflight("sun", pane / "site.json", "--day", "2026-12-21", "--zone", "Asia/Hong_Kong")
    assert done.status == 0
    sky, facade, *effects = done.out.splitlines()
    # The Hong Kong Observatory's almanac has 06:58 and 17:44.
    assert sky.startswith(
        "sun over 'single-panel' on 2026-12-21 (Asia/Hong_Kong, UTC+08:00): up 06:58-17:44, highest at"
    )
    light = "even light 06:58-17:44; all of it in the sun 06:58-17:44; part of it never"
    assert facade == f"facade 'A' (heading 180): {light}"
    assert effects[0].startswith("sun in panes of facade A: on")


def test_a_plan_is_timed_and_json_has_times_with_their_zone(reflight, pane):
    files = (pane / "plan.json", pane / "site.json")
    arguments = ("--day", "2026-12-21", "--utc-offset", 8, "--from", "09:00", "--until", "16:30")
    text = reflight("sun", *files, *arguments).out
    assert "sortie 1: take off at " in text
    found = reflight("sun", *files, *arguments, "--json").json
    assert found["zone"] == "UTC+08:00"
    (sortie,) = found["sorties"]
    assert sortie["sorties"] == [1]
    at = datetime.fromisoformat(sortie["take_off"])
    assert 9 <= at.hour <= 16
    assert at.utcoffset().total_seconds() == 8 * 3600
    ((first, last),) = sortie["as_good"]
    assert datetime.fromisoformat(first) <= at <= datetime.fromisoformat(last)
    assert found["spoiled"] >= found["least_possible"] >= 0.0
    assert {view["id"] for view in found["views"]} <= {f"v{n:04}" for n in range(6)}
    # The check at the proposed time finds what is promised.
    codes = {f["code"]: f for f in reflight("check", *files, "--at", sortie["take_off"], "--json").json["findings"]}
    spoiled = sum(codes[code]["value"] for code in ("sun-direct", "sun-mirrored") if code in codes)
    assert spoiled == sortie["dazzled"]


def test_polar_night_and_midnight_sun_are_said(reflight, pane, changed):
    north = changed(pane / "site.json", "origin", "lat_deg", 78.0)
    night = reflight("sun", pane / "plan.json", north, "--day", "2026-12-21", "--utc-offset", 1).out
    assert "it does not rise" in night
    assert "no room for it in the light of this day" in night
    assert "sun in panes of facade A: off - the sun does not rise on this day" in night
    day = reflight("sun", north, "--day", "2026-06-21", "--utc-offset", 1).out
    assert "it does not set" in day


def test_a_day_on_which_clocks_change_ends_at_midnight(reflight, pane):
    done = reflight("sun", pane / "site.json", "--day", "2026-03-29", "--zone", "Europe/Berlin", "--json")
    assert done.json["zone"] == "Europe/Berlin, UTC+02:00"
    assert done.json["up"][0][0].startswith("2026-03-29T00:00:00+01:00")


def test_effects_are_overruled(reflight, pane, changed):
    """At noon of that day the sun stands 44 degrees high: a view from below sees it in the pane to the south."""
    x, y, z = np.mean(json.loads((pane / "site.json").read_text())["facades"][0]["panels"][0]["corners_enu_m"], axis=0)
    view = {"id": "v0000", "position_enu_m": [x, y - 8.6, z - 8.4], "heading_deg": 0.0, "gimbal_pitch_deg": 44.2}
    plan = changed(pane / "plan.json", "viewpoints", 0, view)
    arguments = (plan, pane / "site.json", "--day", "2026-12-21", "--utc-offset", 8, "--json")
    on, off = (reflight("sun", *arguments, "--effects", f"sun-in-panes={way}").json for way in ("on", "off"))
    ((first, last),) = next(view["mirrored"] for view in on["views"] if view["id"] == "v0000")
    assert first < "2026-12-21T12:20:53+08:00" < last
    assert not any(view["mirrored"] for view in off["views"])


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (("--day", "tomorrow"), "--day: expected a day such as 2026-06-21, got 'tomorrow'"),
        (("--day", "9999-12-31"), "expected a day before the year 9999"),
        (("--zone", "Mars/Olympus"), "expected a time zone such as Europe/Berlin"),
        (("--zone", "../../etc/passwd"), "expected a time zone such as Europe/Berlin"),
        (("--utc-offset", "25"), "--utc-offset: expected -12 to 14 hours, got 25"),
        (("--from", "half past"), "--from: expected a time of day such as 08:30, got 'half past'"),
        (("--until", "24:01"), "--until: expected a time of day"),
        (("--from", "12:00", "--until", "11:00"), "--from: expected an earlier time than --until 11:00, got 12:00"),
        (("--pause", "-1"), "--pause: expected 0 or more, got -1"),
        (("--shortest", "0"), "--shortest: expected 1 to 600 seconds, got 0"),
        (("--effects", "rain=on"), "names are sun-in-panes, cast-shadows"),
    ],
)
def test_wrong_days_are_refused_in_one_line(reflight, pane, arguments, text):
    assert text in reflight("sun", pane / "site.json", *arguments).error


def test_more_files_than_two_are_refused(reflight, pane):
    assert "got 3 files" in reflight("sun", *[pane / "site.json"] * 3).error


def test_tilts_of_a_table_count(reflight, pane, tmp_path):
    panel = json.loads((pane / "site.json").read_text())["facades"][0]["panels"][0]["id"]
    (tmp_path / "tilts.csv").write_text(f"panel,right_deg,up_deg\n{panel},0,1.5\n")
    out = tmp_path / "tilted.site.json"
    done = reflight("site", "tilts", pane / "site.json", tmp_path / "tilts.csv", "-o", out)
    assert "1 of 1 panes have measured tilts, up to 1.50 degrees" in done.out
    found = reflight("sun", pane / "plan.json", out, "--day", "2026-12-21", "--utc-offset", 8).out
    assert "measured tilts of panes: on - panes are tilted by up to 1.50 degrees (12 min" in found
    codes = {f["code"]: f for f in reflight("check", pane / "plan.json", out, "--json").json["findings"]}
    assert codes["site"]["severity"] == "ok"
    neither = reflight("site", "tilts", pane / "site.json", "-o", tmp_path / "x.site.json")
    assert "expected a table of tilts, or --remove, and not both" in neither.error

"""The main job on a real office, one command after the other: IFC, site, plan, check, mission files, and back."""

import re
from pathlib import Path

import pytest

from groundstation.cli import console
from groundstation.services.messages import translation
from missions.dji.check import check_dji
from missions.dji.wpml import parts_of_kmz
from missions.formats.registry import read_missions
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.check import check_items
from missions.mavlink.plan_json import read_plan_json
from missions.mavlink.wpl import read_wpl
from planning.base.findings import is_flyable
from planning.plan import read_plan

MISSIONS = {
    "dji-kmz": (".kmz", "m3e"),
    "kml": (".kml", "m3e"),
    "csv": (".csv", "m3e"),
    "mavlink-plan": (".plan", "ardupilot"),
    "mavlink-wpl": (".waypoints", "ardupilot"),
}
"""Ending of the file and profile of the plan, by format."""

CHECKS = {
    "dji-kmz": lambda path: check_dji(parts_of_kmz(path.read_bytes())),
    "mavlink-plan": lambda path: tuple(check_items(read_plan_json(path), Autopilot.ARDUPILOT)),
    "mavlink-wpl": lambda path: tuple(check_items(read_wpl(path), Autopilot.ARDUPILOT)),
    "kml": lambda path: read_missions(path)[0].findings,
    "csv": lambda path: read_missions(path)[0].findings,
}
"""The checks of each format; for our own two, what reading finds."""

MOVED = 1
"""Sections: coordinates in missions are rounded to about 0.1 mm, and one on a border may change sides."""


@pytest.fixture
def office(reflight, shared_data, tmp_path):
    """Site file, and plans by profile."""
    site = tmp_path / "office.site.json"
    assert reflight("site", "import", shared_data / "bim" / "office_a.ifc", "-o", site).status == 0
    plans = {}
    for profile in ("m3e", "ardupilot"):
        plans[profile] = tmp_path / f"{profile}.plan.json"
        asked = ("--views", 120, "--objective", "sections", "--profile", profile)
        done = reflight("plan", site, "-o", plans[profile], *asked, "--json")
        assert done.status == 0, done.err
        assert 0.8 < done.json["covered"] / done.json["reachable_upper_bound"] < 0.97
        assert reflight("check", plans[profile], site).status == 0
    return site, plans


@pytest.mark.slow
def test_office_goes_from_ifc_to_every_mission_file_and_back(reflight, office, tmp_path):
    site, plans = office
    for file_format, (ending, profile) in MISSIONS.items():
        original = read_plan(plans[profile])
        mission, back = tmp_path / f"office{ending}", tmp_path / f"back{ending}.json"
        done = reflight("export", plans[profile], "--format", file_format, "-o", mission, "--json")
        assert done.status == 0, done.err
        assert {each["severity"] for each in done.json["findings"]} <= {"note", "ok"}
        files = done.json["files"]
        for file in files:
            assert is_flyable(CHECKS[file_format](Path(file))), file
        done = reflight("import", *files, "--site", site, "-o", back, "--profile", profile, "--json")
        assert done.status == 0, done.err
        assert done.json["views"] == len(original.viewpoints)
        assert abs(done.json["covered"] - original.coverage.covered) <= MOVED


ENGLISH = re.compile(r"\b(the|is|are|of|and|with|from|least|most|it|its|not|there|expected|which|has|views?|left)\b")
NAMES = re.compile(r"'[^']*'|\S*/\S+|--\S+|\S*[_-]\S+|^(weiter|next): .*", re.M)


@pytest.fixture
def german_day(reflight, monkeypatch):
    """Runs commands in German; none of what they say may be left in English, nor a template without a translation."""
    known, untranslated = translation("de"), []

    def translated(text):
        if known(text) == text and ENGLISH.search(NAMES.sub("", text)):
            untranslated.append(text)
        return known(text)

    monkeypatch.setattr(console, "translation", lambda _language: translated)

    def run(*arguments, status=0):
        done = reflight("--language", "de", *arguments)
        assert done.status == status, done.err
        said = done.out + done.err
        english = [line for line in said.splitlines() if ENGLISH.search(NAMES.sub("", line))]
        assert (english, untranslated) == ([], []), arguments[0]
        return done

    return run


@pytest.mark.slow
def test_a_day_in_german_leaves_nothing_in_english(german_day, shared_data, tmp_path):
    site, plan, flight = tmp_path / "office.site.json", tmp_path / "o.plan.json", tmp_path / "o.flight.json"
    done = german_day("site", "import", shared_data / "bim" / "office_a.ifc", "-o", site)
    assert "Scheiben auf" in done.out
    done = german_day("plan", site, "-o", plan, "--views", 12)
    assert "kein Flug kann mehr als" in done.out
    german_day("check", plan, site)
    german_day("export", plan, "--format", "dji-kmz", "-o", tmp_path / "o.kmz")
    german_day("import", tmp_path / "o.kmz", "--site", site, "-o", tmp_path / "back.plan.json")
    german_day("compare", plan, tmp_path / "back.plan.json", "--site", site)
    german_day("brief", plan, site, "-o", tmp_path / "o.html")
    german_day("simulate", plan, site, "-o", flight)
    german_day("topup", flight, plan, site, "-o", tmp_path / "top.plan.json")
    german_day("project", "new", tmp_path / "office", "--site", site)
    german_day("project", "add", tmp_path / "office", plan)
    german_day("project", "show", tmp_path / "office")
    german_day("scene", "list")
    page = NAMES.sub(
        "", re.sub(r"<(style|img|title)[^>]*>[^<]*|<[^>]+>", " ", (tmp_path / "o.html").read_text("utf-8"))
    )
    assert not ENGLISH.search(page), ENGLISH.search(page)


@pytest.mark.parametrize(
    "wrong",
    [
        ("plan",),
        ("plan", "nix.json"),
        ("plan", "nix.json", "-o", "y.json", "--views", "z"),
        ("plan", "nix.json", "-o", "y.json", "--method", "best"),
        ("plan", "nix.json", "-o", "y.json", "--min-distance", "-3"),
        ("tradeoff", "plan", "nix.json", "-o", "y", "--steps", "a,b"),
        ("signing", "give"),
        ("topup", "f.json", "p.json", "s.json", "-o", "y.json", "--battery", "7"),
        ("check", "nix.json", "nix.json", "--at", "noon"),
        ("render", "nix", "--views", "nix", "-o", "y", "--layers", "best"),
        ("--site", "nix.json"),
    ],
)
def test_wrong_usage_and_input_are_told_in_german(reflight, wrong):
    done = reflight("--language", "de", *wrong)
    assert done.status != 0
    told = NAMES.sub("", done.err.splitlines()[-1])
    assert not ENGLISH.search(told), told
    assert done.err.startswith(("Fehler: ", "Aufruf: "))

"""The main job on a real office, one command after the other: IFC, site, plan, check, mission files, and back."""

from pathlib import Path

import pytest

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
        done = reflight("plan", site, "-o", plans[profile], "--views", 120, "--profile", profile, "--json")
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
        assert done.json["findings"] == []
        files = done.json["files"]
        for file in files:
            assert is_flyable(CHECKS[file_format](Path(file))), file
        done = reflight("import", *files, "--site", site, "-o", back, "--profile", profile, "--json")
        assert done.status == 0, done.err
        assert done.json["views"] == len(original.viewpoints)
        assert abs(done.json["covered"] - original.coverage.covered) <= MOVED

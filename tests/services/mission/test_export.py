"""Use cases around mission files: the right site for a plan, sorties an autopilot can keep, missions back to plans."""

from dataclasses import replace

import pytest

from groundstation.services.mission.export import export_plan, find_site, import_missions
from groundstation.services.plan.planning import plan_site
from groundstation.services.project.document import Document
from groundstation.services.project.folder import create_project
from missions.formats.options import ExportOptions
from missions.formats.registry import FORMATS, read_missions
from missions.mavlink.autopilots import Autopilot
from missions.mission.export_choices import FileFormat
from planning.base.errors import InputError
from planning.plan import read_plan
from planning.request import PlanRequest
from planning.site.bundled import SCENES, write_scene
from planning.site.file import read_site, write_site
from tests.planning.revision.cases import QUICK


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Folder with two sites and a plan for one of them."""
    folder = tmp_path_factory.mktemp("roof")
    write_scene("single-panel", folder)
    plan_site(write_scene("roof", folder), PlanRequest(n_views=12, greedy=QUICK), folder / "roof.plan.json")
    return folder


def test_the_site_of_a_plan_is_known_by_its_checksum(folder, tmp_path):
    plan_path = folder / "roof.plan.json"
    plan = read_plan(plan_path)
    assert find_site(plan, plan_path).site.name == "roof"
    assert find_site(plan, tmp_path / "elsewhere.json") is None
    assert find_site(plan, tmp_path / "elsewhere.json", folder / "roof.site.json").sha256 == plan.site_sha256


def test_a_site_at_another_place_is_refused(folder, tmp_path):
    site = SCENES["roof"]().site
    write_site(tmp_path / "moved.json", replace(site, building_mesh=None, origin=replace(site.origin, lat_deg=1.0)))
    plan_path = folder / "roof.plan.json"
    with pytest.raises(InputError, match="is not the one of the plan"):
        find_site(read_plan(plan_path), plan_path, tmp_path / "moved.json")


def test_every_format_has_an_ending():
    assert set(FORMATS) == set(FileFormat)


def test_sorties_that_an_autopilot_cannot_keep_are_shared_out_anew(folder, tmp_path, monkeypatch):
    monkeypatch.setattr("missions.mavlink.items.photos_that_fit", lambda _autopilot: 5)
    options = ExportOptions(autopilot=Autopilot.ARDUPILOT)
    paths, findings = export_plan(
        folder / "roof.plan.json", FileFormat.MAVLINK_PLAN, tmp_path / "m.plan", None, options
    )
    counts = [mission.n_photos for path in paths for mission in read_missions(path)]
    assert sum(counts) == 12
    assert max(counts) <= 5
    (finding,) = (finding for finding in findings if finding.code == "item-limit")
    assert (finding.value, finding.limit) == (12.0, 5.0)


@pytest.mark.few(2)
@pytest.mark.parametrize("file_format", list(FileFormat))
def test_a_mission_that_comes_back_covers_what_the_plan_covers(folder, tmp_path, file_format):
    plan, site = read_plan(folder / "roof.plan.json"), folder / "roof.site.json"
    paths, findings = export_plan(
        folder / "roof.plan.json", file_format, tmp_path / f"m{FORMATS[file_format].endings[0]}"
    )
    assert not [finding for finding in findings if finding.code in ("file-name", "not-ready", "site-changed")]
    back, _, _ = import_missions(paths, site, tmp_path / "back.json")
    assert read_plan(tmp_path / "back.json") == back
    assert back.coverage.total == plan.coverage.total
    # Missions hold angles to 0.01 degrees: a centroid on the edge of a picture may fall out of it or into it.
    assert abs(back.coverage.covered - plan.coverage.covered) <= 2
    assert back.site_sha256 == plan.site_sha256
    assert back.method == "imported"


def test_nothing_is_written_when_a_mission_is_refused(folder, tmp_path):
    file = tmp_path / "m.kmz"
    file.write_bytes(b"PK\x03\x04 no archive")
    with pytest.raises(Exception, match="damaged or no zip archive"):
        import_missions([file], folder / "roof.site.json", tmp_path / "back.json")
    with pytest.raises(InputError, match="named twice"):
        import_missions([file, tmp_path / "." / "m.kmz"], folder / "roof.site.json", tmp_path / "back.json")
    assert list(tmp_path.iterdir()) == [file]


def test_a_mission_never_takes_the_place_of_the_index_of_a_project(folder, tmp_path):
    create_project(tmp_path / "roof", Document(read_site(folder / "roof.site.json")))
    index = tmp_path / "roof" / "project.json"
    before = index.read_bytes()
    for file_format in FileFormat:
        with pytest.raises(InputError, match="holds a project together"):
            export_plan(folder / "roof.plan.json", file_format, index)
    assert index.read_bytes() == before

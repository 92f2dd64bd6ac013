"""`project`: make, show, fill and migrate project folders; the other commands work on the files inside."""

import json
import shutil

import pytest

from groundstation.services.project.folder import open_project
from groundstation.services.project.lock import lock_project
from groundstation.services.project.recovery import Autosave
from planning.request import PlanRequest
from planning.site.bundled import write_scene
from tests.services.project.test_autosave import AtOnce, edited
from tests.services.project.test_folder import files_of


@pytest.fixture
def project(reflight, pane, tmp_path):
    """A project with the smallest site and a plan."""
    folder = tmp_path / "my building"
    assert reflight("project", "new", folder, "--site", pane / "site.json", "--name", "Büro").status == 0
    assert reflight("project", "add", folder, pane / "plan.json").status == 0
    return folder


def test_a_project_is_made_filled_and_shown_and_its_files_serve_the_other_commands(reflight, project, pane):
    done = reflight("project", "show", project)
    assert done.status == 0
    assert done.err == ""
    lines = done.out.splitlines()
    assert lines[:3] == ["project: Büro", "site:    single-panel, 1 panel (site/site.json)", "plans:   1"]
    assert lines[3].startswith("  plan: 6 views, ")
    assert lines[3].endswith("(greedy, plans/plan.plan.json)")
    plan_path, site_path = project / "plans" / "plan.plan.json", project / "site" / "site.json"
    assert reflight("check", plan_path, site_path).status == 0
    assert reflight("export", plan_path, "--format", "csv", "-o", project / "missions" / "m.csv").status == 0
    assert site_path.read_bytes() == (pane / "site.json").read_bytes()
    assert plan_path.read_bytes() == (pane / "plan.json").read_bytes()


def test_new_says_what_to_type_next(reflight, pane, tmp_path):
    done = reflight("project", "new", tmp_path / "p", "--site", pane / "site.json")
    assert done.status == 0
    assert done.err.startswith("next: app.py plan ")
    assert "project: p\n" in done.out


def test_show_prints_json(reflight, project):
    done = reflight("project", "show", project / "project.json", "--json")
    assert (done.status, done.err) == (0, "")
    content = done.json
    assert (content["name"], content["version"], content["unsaved_work"]) == ("Büro", 2, None)
    assert content["site"]["panels"] == 1
    assert content["site"]["sha256"] == open_project(project).document.site.sha256
    (entry,) = content["plans"]
    assert (entry["id"], entry["views"], entry["is_current"]) == ("plan", 6, True)
    assert entry["covered"] <= entry["reachable_upper_bound"]


def test_show_tells_of_unsaved_work_and_of_damage(reflight, project):
    opened = open_project(project)
    Autosave(project, AtOnce(), pytest.fail).keep(edited(opened.document, 9))
    assert (
        "unsaved: plan 'plan*' was changed; open the project in the window" in reflight("project", "show", project).out
    )
    assert reflight("project", "show", project, "--json").json["unsaved_work"] == ["plan 'plan*' was changed"]
    (project / ".autosave" / "autosave.json").write_text("{")
    assert "this copy of unsaved work is damaged" in reflight("project", "show", project).out
    (project / "plans" / "plan.plan.json").write_text("{")
    done = reflight("project", "show", project)
    assert done.status == 0
    assert "warning: " in done.err
    assert "the plan 'plan' was left out" in done.err


def test_a_project_without_site_is_shown(reflight, tmp_path):
    (tmp_path / "project.json").write_text('{"format": "reflight-project/2"}')
    assert "site:    none yet\nplans:   0\n" in reflight("project", "show", tmp_path).out
    assert reflight("project", "show", tmp_path, "--json").json["site"] is None


def test_files_that_are_no_site_or_plan_are_refused(reflight, project, changed, pane, tmp_path, bad_file):
    assert str(bad_file) in reflight("project", "new", tmp_path / "q", "--site", bad_file).error
    assert not (tmp_path / "q").exists()
    another = changed(pane / "plan.json", "seed", 3)
    assert str(bad_file) in reflight("project", "add", project, another, bad_file).error
    assert len(open_project(project).document.plans) == 1


def test_refusals_say_what_and_where(reflight, project, pane, tmp_path):
    assert "there is a project here already" in reflight("project", "new", project, "--site", pane / "site.json").error
    before = files_of(project)
    assert "holds this plan already, as 'plan'" in reflight("project", "add", project, pane / "plan.json").error
    assert "found nothing of that name" in reflight("project", "show", tmp_path / "missing").error
    assert "found nothing of that name" in reflight("project", "add", tmp_path / "missing", pane / "plan.json").error
    assert "found nothing of that name" in reflight("project", "migrate", tmp_path / "missing").error
    unchanged = {name: value for name, value in files_of(project).items() if not name.startswith(".lock")}
    assert unchanged == {name: value for name, value in before.items() if not name.startswith(".lock")}


@pytest.mark.parametrize("arguments", [("add", "plan.json"), ("migrate",)])
def test_a_folder_without_project_stays_as_it_is(reflight, pane, tmp_path, arguments):
    action, *plans = arguments
    done = reflight("project", action, tmp_path, *(pane / name for name in plans))
    assert "there is no project in this folder" in done.error
    assert list(tmp_path.iterdir()) == []


def test_a_project_that_is_open_elsewhere_is_not_changed(reflight, project, pane):
    with lock_project(project):
        assert "is open in another Reflight" in reflight("project", "add", project, pane / "plan.json").error
        assert "is open in another Reflight" in reflight("project", "migrate", project).error
        assert reflight("project", "show", project).status == 0


def test_loose_files_are_migrated_once(reflight, pane, tmp_path):
    folder = tmp_path / "loose"
    shutil.copytree(pane, folder)
    before = files_of(folder)
    done = reflight("project", "show", folder)
    assert "note: " in done.err
    assert "there is no project.json here" in done.err
    assert done.err.splitlines()[-1].startswith("next: app.py project migrate ")
    assert files_of(folder) == before
    assert "now in format 'reflight-project/2'" in reflight("project", "migrate", folder).out
    assert json.loads((folder / "project.json").read_text())["site"] == "site/site.json"
    after = files_of(folder)
    assert "nothing to do" in reflight("project", "migrate", folder).out
    assert files_of(folder).keys() == after.keys()
    assert files_of(folder)["project.json"] == after["project.json"]


def test_a_plan_for_another_site_is_added_with_a_warning(reflight, project, pane, changed):
    other = changed(pane / "plan.json", "site_sha256", "0" * 64)
    done = reflight("project", "add", project, other)
    assert done.status == 0
    assert "warning: " in done.err
    assert "made for another state of the site, or for another site" in done.err


@pytest.mark.parametrize("arguments", [(), ("new",), ("new", "x"), ("add", "x"), ("show",), ("build", "x")])
def test_wrong_usage_has_status_2(reflight, arguments):
    done = reflight("project", *arguments)
    assert done.status == 2
    assert "usage: app.py project" in done.err


def test_a_request_is_kept_with_its_plan(project):
    entry = open_project(project).document.current
    assert entry.request is None
    assert open_project(project).document.request == PlanRequest()


@pytest.mark.slow
def test_no_command_writes_over_what_holds_a_project_together(reflight, tmp_path):
    site = write_scene("single-panel", tmp_path)
    assert reflight("project", "new", tmp_path / "p", "--site", site).status == 0
    index = tmp_path / "p" / "project.json"
    before = index.read_bytes()
    plan = tmp_path / "a.plan.json"
    assert reflight("plan", site, "-o", plan, "--views", 2, "--time-budget", 2).status == 0
    csv = tmp_path / "a.csv"
    assert reflight("export", plan, "--site", site, "--format", "csv", "-o", csv).status == 0
    for arguments in (
        ("plan", site, "--views", 2),
        ("import", csv, "--site", site),
        ("site", "import", csv),
        ("export", plan, "--format", "csv", "--site", site),
    ):
        done = reflight(*arguments, "-o", index)
        assert done.status == 1
        assert "holds a project together" in done.err
        assert index.read_bytes() == before

"""Older projects: each step for itself, all of them together, and nothing of the user's lost."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.services.project.folder import open_project, save_project
from groundstation.services.project.migration import (
    MIGRATIONS,
    VERSION,
    from_loose_files,
    migrate,
    name_plans,
    title_of,
)
from groundstation.services.project.project_file import ProjectRecord
from planning.base.errors import InputError
from planning.base.json_file import to_record
from planning.checks import check_plan
from planning.plan import read_plan, write_plan
from planning.site.bundled import write_scene
from planning.site.file import read_site
from tests.services.project.test_folder import change_json, files_of
from tests.services.project_cases import is_same, plan

LOOSE = {
    "office.site.json": "reflight-site/1",
    "b.plan.json": "reflight-plan/1",
    "a.plan.json": "reflight-plan/1",
    "settings.json": "",
}


def loose_folder(folder):
    """A folder as the command line leaves it; the site file is written in a way of its own."""
    folder.mkdir()
    site_path = write_scene("roof", folder)
    site_path.write_text(json.dumps({**json.loads(site_path.read_text()), "customer": "ACME"}))
    sha256 = read_site(site_path).sha256
    for number, name in enumerate(["north", "south"]):
        write_plan(folder / f"{name}.plan.json", plan(seed=number, site_sha256=sha256))
    change_json(folder / "north.plan.json", "viewpoints", 0, "colour", "red")
    (folder / "north.kmz").write_bytes(b"a mission")
    (folder / "other.json").write_text("[1, 2]")
    return folder


def early_project(folder):
    """A folder of version 1 over the same files."""
    loose_folder(folder)
    content = {
        "format": "reflight-project/1",
        "name": "early",
        "site": "roof.site.json",
        "plans": ["south.plan.json", "north.plan.json"],
        "customer": "ACME",
    }
    (folder / "project.json").write_text(json.dumps(content))
    return folder


def test_loose_files_become_version_1():
    assert from_loose_files({}, LOOSE) == {
        "format": "reflight-project/1",
        "site": "office.site.json",
        "plans": ["a.plan.json", "b.plan.json"],
    }


@pytest.mark.parametrize(
    ("listing", "message"),
    [
        ({}, "there is no project in this folder"),
        ({"a.plan.json": "reflight-plan/1"}, "there is no project in this folder"),
        ({"a.json": "reflight-site/1", "b.json": "reflight-site/1"}, r"found 2 \(a.json, b.json\)"),
    ],
)
def test_loose_files_without_just_one_site_are_refused(listing, message):
    with pytest.raises(InputError, match=message):
        from_loose_files({}, listing)


def test_version_1_gets_identifiers_and_titles():
    content = {"format": "reflight-project/1", "site": "site.json", "plans": ["x/a.plan.json", "a.plan.json"], "k": 1}
    kept = dict(content)
    assert name_plans(content, {}) == {
        "format": "reflight-project/2",
        "site": "site.json",
        "plans": [
            {"id": "a", "title": "a", "file": "x/a.plan.json"},
            {"id": "a-2", "title": "a", "file": "a.plan.json"},
        ],
        "current_plan_id": "a-2",
        "k": 1,
    }
    assert content == kept


@pytest.mark.parametrize("plans", ["a.plan.json", [1], {}, [None]])
def test_version_1_with_other_plans_is_refused(plans):
    with pytest.raises(InputError, match="plans: expected a list of file names"):
        name_plans({"plans": plans}, {})


def test_the_chain_is_its_steps_one_after_the_other(tmp_path):
    assert len(MIGRATIONS) == VERSION == 2
    content = migrate({}, 0, LOOSE)
    assert content == name_plans(from_loose_files({}, LOOSE), LOOSE)
    assert migrate(content, VERSION, {}) == content
    record = to_record(content, ProjectRecord, tmp_path)
    assert [(entry.id, entry.file) for entry in record.plans] == [("a", "a.plan.json"), ("b", "b.plan.json")]


@given(files=st.lists(st.text(max_size=8).map(lambda text: f"{text}.plan.json"), max_size=8))
def test_identifiers_are_unique_and_no_plan_is_lost(files):
    content = name_plans({"plans": files}, {})
    assert [entry["file"] for entry in content["plans"]] == files
    assert len({entry["id"] for entry in content["plans"]}) == len(files)
    assert all(entry["id"] for entry in content["plans"])


@pytest.mark.parametrize(
    ("file", "title"), [("plans/a.b.plan.json", "a.b"), ("x\\y.json", "y"), (".plan.json", "plan"), ("", "plan")]
)
def test_titles_are_file_names_without_their_endings(file, title):
    assert title_of(file) == title


@pytest.mark.parametrize(("make", "version", "current"), [(loose_folder, 0, "south"), (early_project, 1, "north")])
def test_an_older_project_opens_untouched_and_becomes_a_new_one_when_saved(tmp_path, make, version, current):
    folder = make(tmp_path / "p")
    before = files_of(folder)
    opened = open_project(folder)
    assert files_of(folder) == before
    assert opened.version == version
    assert len(opened.notes) == 1
    assert opened.document.current_plan_id == current
    assert {entry.id: entry.title for entry in opened.document.plans} == {"north": "north", "south": "south"}

    written = save_project(folder, opened.document)
    after = files_of(folder)
    kept = {name: value for name, value in before.items() if name != "project.json"}
    assert {name: after[name] for name in kept} == kept
    again = open_project(folder)
    assert (again.version, again.notes) == (2, ())
    assert is_same(again.document, opened.document)
    assert again.record.site == "site/site.json"
    # Byte for byte: plans know their site, and nothing that others wrote into the files is lost.
    assert written.site.sha256 == opened.document.site.sha256
    assert (folder / "site" / "site.json").read_bytes() == before["roof.site.json"][0]
    assert (folder / "plans" / "north.plan.json").read_bytes() == before["north.plan.json"][0]
    for entry in again.document.plans:
        assert "site-changed" not in {finding.code for finding in check_plan(entry.plan, again.document.site)}

    without = again.document.without_plan("south")
    save_project(folder, without)
    assert not (folder / "plans" / "south.plan.json").exists()
    assert read_plan(folder / "south.plan.json") == opened.document.entry("south").plan


def test_the_old_project_file_and_what_it_said_are_kept(tmp_path):
    folder = early_project(tmp_path / "p")
    old = (folder / "project.json").read_bytes()
    (folder / "project.v1.json").write_text("the user's own")
    save_project(folder, open_project(folder).document)
    assert (folder / "project.v1-2.json").read_bytes() == old
    assert (folder / "project.v1.json").read_text() == "the user's own"
    content = json.loads((folder / "project.json").read_text())
    assert (content["customer"], content["name"]) == ("ACME", "early")
    save_project(folder, open_project(folder).document)
    assert len(list(folder.glob("project.v1*"))) == 2


def test_an_early_project_that_names_a_plan_twice_is_refused(tmp_path):
    folder = early_project(tmp_path / "p")
    change_json(folder / "project.json", "plans", ["south.plan.json", "south.plan.json"])
    with pytest.raises(InputError, match=r"project.json: plans: the file 'south.plan.json' occurs twice"):
        open_project(folder)


def test_a_damaged_plan_among_loose_files_is_told(tmp_path):
    folder = loose_folder(tmp_path / "p")
    (folder / "south.plan.json").write_text("{")
    opened = open_project(folder)
    assert [entry.id for entry in opened.document.plans] == ["north"]
    assert [note.code for note in opened.notes] == ["loose-files", "plan-left-out"]


def test_a_damaged_site_among_loose_files_is_refused(tmp_path):
    folder = loose_folder(tmp_path / "p")
    (folder / "roof.site.json").write_text("{")
    with pytest.raises(InputError, match=r"roof\.site\.json: not valid JSON"):
        open_project(folder)

"""Projects: what is saved comes back, files stay while nothing changes, damage is told and does not spread."""

import json
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from groundstation.services.project.document import Document, PlanEntry
from groundstation.services.project.folder import add_plans, create_project, open_project, save_project
from groundstation.services.project.project_file import FOLDERS, is_project, project_name
from planning.base.errors import InputError
from planning.checks import check_plan
from planning.geo.mesh import TriangleMesh, box_mesh, read_mesh
from planning.plan import read_plan, write_plan
from planning.request import PlanRequest
from planning.site.bundled import SCENES, write_scene
from planning.site.file import read_site
from planning.site.ground import ground_of
from planning.site.importing.importer import import_site, write_imported_site
from planning.site.importing.options import ImportOptions
from planning.site.records import Obstacle
from tests.planning.site.test_terrain import hill_site, slope
from tests.services.project_cases import SITES, document, documents, edited, is_same, plan, small_disk

ROOT = Path(__file__).resolve().parents[3]


def files_of(folder):
    """Name, content and time of every file."""
    return {
        path.relative_to(folder).as_posix(): (path.read_bytes(), path.stat().st_mtime_ns)
        for path in folder.rglob("*")
        if path.is_file()
    }


def names_of(folder):
    return sorted(files_of(folder))


def change_json(path, *path_and_value):
    """Set a value in a JSON file; `...` takes the key out."""
    *keys, last, value = path_and_value
    content = json.loads(path.read_text())
    place = content
    for key in keys:
        place = place[key]
    if value is ...:
        del place[last]
    else:
        place[last] = value
    path.write_text(json.dumps(content))


@pytest.fixture
def project(tmp_path):
    """A project with a site with mesh and two plans; the document as it was written."""
    folder = tmp_path / "my-building"
    return folder, create_project(folder, document("roof", 2))


@pytest.mark.long
@settings(max_examples=60)
@given(made=documents(), name=st.text(max_size=10))
def test_any_document_survives_saving_and_opening(tmp_path_factory, made, name):
    folder = tmp_path_factory.mktemp("any") / "p"
    written = create_project(folder, made, name=name)
    opened = open_project(folder)
    assert is_same(written, made)
    assert is_same(opened.document, made)
    assert opened.name == (name or "p")
    assert opened.notes == ()
    before = files_of(folder)
    assert save_project(folder, opened.document) is opened.document
    assert files_of(folder) == before


@pytest.mark.slow
@settings(max_examples=25)
@given(states=st.lists(documents(), min_size=2, max_size=4))
def test_a_project_holds_the_last_of_many_states_and_nothing_else(tmp_path_factory, states):
    folder = tmp_path_factory.mktemp("any") / "p"
    create_project(folder, states[0], name="kept")
    for state in states[1:]:
        save_project(folder, state)
        opened = open_project(folder)
        assert is_same(opened.document, state)
        assert opened.name == "kept"
    site = opened.document.site
    meshes = 0 if site is None else (site.site.building_mesh is not None)
    assert len(list((folder / "plans").iterdir())) == len(states[-1].plans)
    assert len(list((folder / "site").iterdir())) == (site is not None) + meshes


def test_a_new_project_has_its_folders_and_ordinary_files(project):
    folder, written = project
    assert {path.name for path in folder.iterdir()} == {"project.json", *FOLDERS}
    assert names_of(folder) == [
        "plans/plan-1.plan.json",
        "plans/plan-2.plan.json",
        "project.json",
        "site/roof.ply",
        "site/site.json",
    ]
    assert read_plan(folder / "plans" / "plan-2.plan.json") == written.current.plan
    site = read_site(folder / "site" / "site.json")
    assert site.sha256 == written.site.sha256
    assert site.site == written.site.site
    assert json.loads((folder / "project.json").read_text())["format"] == "reflight-project/2"
    assert is_project(folder)
    assert is_project(folder / "project.json")
    assert not is_project(folder / "site")
    assert project_name(folder / "project.json") == "my-building"
    assert is_same(open_project(folder / "project.json").document, written)


def test_saving_writes_only_what_has_changed_and_keeps_names(project):
    folder, written = project
    before = files_of(folder)
    save_project(folder, edited(written, 9))
    after = files_of(folder)
    assert list(after) == list(before)
    assert {name for name in after if after[name] != before[name]} == {"plans/plan-2.plan.json", "project.json"}


def test_a_removed_plan_takes_its_file_along(project):
    folder, written = project
    (folder / "plans" / "notes.txt").write_text("mine")
    save_project(folder, written.without_plan("plan-2"))
    assert names_of(folder / "plans") == ["notes.txt", "plan-1.plan.json"]


def test_a_changed_mesh_gets_a_new_name_and_going_back_gives_the_old_file_again(project):
    folder, written = project
    site = written.site
    grown = replace(site, building=box_mesh(np.array([-13.0, -8.0, 0.0]), np.array([12.0, 8.0, 12.0])))
    changed = save_project(folder, replace(written, site=grown))
    assert changed.site.sha256 != site.sha256
    assert len(names_of(folder / "site")) == 2
    assert is_same(open_project(folder).document, replace(written, site=grown))
    save_project(folder, changed)
    back = save_project(folder, written)
    assert back.site.sha256 == site.sha256
    assert names_of(folder / "site") == ["roof.ply", "site.json"]


def test_meshes_that_want_one_name_get_two(tmp_path):
    boxes = [box_mesh(np.full(3, -20.0 - i), np.full(3, -10.0)) for i in range(3)]
    names = ["a/crane.ply", "b/crane.ply", "..\\crane.obj"]
    obstacles = tuple(Obstacle(f"o{i}", mesh=name) for i, name in enumerate(names))
    site = SITES["roof"]
    site = replace(site, site=replace(site.site, obstacles=obstacles), obstacles=(boxes[0], boxes[1], boxes[0]))
    written = create_project(tmp_path / "p", Document(site))
    first, second, third = (obstacle.mesh for obstacle in written.site.site.obstacles)
    assert first == third == "crane.ply"
    assert second.startswith("crane-")
    assert is_same(open_project(tmp_path / "p").document, Document(site))


def test_the_document_that_was_written_has_coordinates_as_the_files_have_them(tmp_path):
    site = SITES["library"]
    written = create_project(tmp_path / "p", Document(site)).site
    on_disk = read_mesh(tmp_path / "p" / "site" / "library.ply")
    assert (written.building.vertices_enu_m == on_disk.vertices_enu_m).all()
    error_m = np.abs(on_disk.vertices_enu_m - site.building.vertices_enu_m).max()
    assert 0.0 < error_m < 4e-6


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig"])
def test_plans_still_know_a_site_that_another_program_wrote(tmp_path, encoding):
    source = write_scene("roof", tmp_path)
    content = json.loads(source.read_text())
    content["customer"] = "Büro, unknown to us"
    source.write_text(json.dumps(content, ensure_ascii=False), encoding)
    site = read_site(source)
    made = Document(site).with_plan(PlanEntry("a", "a", plan(site_sha256=site.sha256)))
    folder = tmp_path / "p"
    written = create_project(folder, made, site_source=source)
    assert written.site is site
    assert (folder / "site" / "site.json").read_bytes() == source.read_bytes()
    again = save_project(folder, edited(written, 7))
    assert again.site.sha256 == site.sha256 == read_site(folder / "site" / "site.json").sha256
    assert "site-changed" not in {finding.code for finding in check_plan(again.current.plan, again.site)}


def test_fields_that_are_not_known_yet_stay(project):
    folder, _ = project
    plan_path, index = folder / "plans" / "plan-1.plan.json", folder / "project.json"
    change_json(plan_path, "viewpoints", 0, "colour", "red")
    change_json(index, "weather", "dry")
    change_json(index, "plans", 0, "pilot", "Ada")
    opened = open_project(folder)
    assert [note.code for note in opened.notes] == ["plan-changed"]
    save_project(folder, edited(opened.document, 9))
    assert json.loads(plan_path.read_text())["viewpoints"][0]["colour"] == "red"
    content = json.loads(index.read_text())
    assert (content["weather"], content["plans"][0]["pilot"]) == ("dry", "Ada")


def test_files_that_another_program_has_changed_meanwhile_are_not_written_over(project):
    folder, written = project
    others = plan(seed=77)
    write_plan(folder / "plans" / "plan-1.plan.json", others)
    change_json(folder / "site" / "site.json", "home_enu_m", [0.0, -33.0, 0.0])
    theirs = (folder / "site" / "site.json").read_bytes()
    save_project(folder, written)
    assert is_same(open_project(folder).document, written)
    assert read_plan(folder / "plans" / "plan-1.plan.json") == others
    assert (folder / "site" / "site.json").read_bytes() == theirs
    names = names_of(folder)
    assert "plans/plan-1-2.plan.json" in names
    assert "site/site-2.json" in names
    save_project(folder, edited(written, 4))
    assert names_of(folder) == names


def test_what_was_asked_goes_with_the_plan_it_was_asked_for(project):
    folder, _ = project
    write_plan(folder / "plans" / "plan-1.plan.json", plan(seed=77))
    opened = open_project(folder)
    entry = opened.document.entry("plan-1")
    assert (entry.plan.seed, entry.request) == (77, None)
    assert opened.document.entry("plan-2").request == PlanRequest(n_views=2)
    assert "another program has changed the plan 'Plan 1'" in opened.notes[0].message


@pytest.mark.parametrize("damage", [b"", b"{", b"[]", b'{"format": "reflight-plan/1"}', None])
def test_a_damaged_plan_is_left_out_with_a_note_and_never_written_over(project, damage):
    folder, _ = project
    path = folder / "plans" / "plan-2.plan.json"
    path.unlink() if damage is None else path.write_bytes(damage)
    opened = open_project(folder)
    assert [entry.id for entry in opened.document.plans] == ["plan-1"]
    assert opened.document.current_plan_id == "plan-1"
    (note,) = opened.notes
    assert note.code == "plan-left-out"
    assert str(path) in note.message
    again = opened.document.with_plan(PlanEntry("plan-2", "new", plan(seed=5)))
    save_project(folder, again)
    assert damage is None or path.read_bytes() == damage
    assert is_same(open_project(folder).document, again)


@pytest.mark.parametrize("name", ["site.json", "roof.ply"])
def test_a_project_with_a_damaged_site_says_what_to_do(project, name):
    folder, _ = project
    for damaged in (lambda path: path.write_bytes(b"{"), lambda path: path.unlink()):
        damaged(folder / "site" / name)
        with pytest.raises(InputError, match=rf"{name}.*put the file back from a copy"):
            open_project(folder)


def test_a_request_that_cannot_be_read_does_not_take_the_plan_along(project):
    folder, _ = project
    change_json(folder / "project.json", "plans", 0, "request", "n_views", -3)
    change_json(folder / "project.json", "request", "seed", "many")
    opened = open_project(folder)
    assert len(opened.document.plans) == 2
    assert opened.document.plans[0].request is None
    assert opened.document.request == PlanRequest()
    assert [note.code for note in opened.notes] == ["request-left-out"] * 2
    assert "views: expected 1 to 20000, got -3" in opened.notes[0].message


@pytest.mark.parametrize(
    ("path_and_value", "message"),
    [
        (("format", "reflight-project/3"), "a newer Reflight wrote this project"),
        (("format", "reflight-project/123456"), "a newer Reflight wrote this project"),
        (("format", "reflight-site/1"), "expected 'reflight-project/2', got 'reflight-site/1'"),
        (("format", ...), "expected 'reflight-project/2', got none"),
        (("format", "reflight-project/0"), "got 'reflight-project/0'"),
        (("plans", 0, "file", "../../etc/passwd"), r"plans\[0\].file: expected the path of a file in the project's"),
        (("plans", 0, "file", "/etc/passwd"), "expected the path of a file in the project's folder"),
        (("plans", 0, "file", "C:\\x.json"), "expected the path of a file in the project's folder"),
        (("plans", 0, "file", "plans/./x.json"), "expected the path of a file in the project's folder"),
        (("plans", 0, "file", "x\0.json"), "expected the path of a file in the project's folder"),
        (("plans", 0, "file", ""), "expected the path of a file in the project's folder"),
        (("plans", 0, "file", "x" * 300), "expected the path of a file in the project's folder"),
        (("site", "../site.json"), "site: expected the path of a file in the project's folder"),
        (("plans", 0, "id", "plan-2"), "the id 'plan-2' occurs twice"),
        (("plans", 0, "file", "plans/Plan-2.plan.json"), "the file 'plans/plan-2.plan.json' occurs twice"),
        (("plans", 0, "id", ""), "id: expected a name, got an empty text"),
        (("plans", 0, "file", 3), "expected text, got whole number"),
        (("plans", 0, "file", ...), "missing required field 'file'"),
        (("plans", {}), "plans: expected list, got object"),
        (("name", None), "name: expected text, got nothing"),
    ],
)
def test_a_wrong_project_file_is_refused_with_the_field(project, path_and_value, message):
    folder, written = project
    change_json(folder / "project.json", *path_and_value)
    before = files_of(folder)
    with pytest.raises(InputError, match=message) as caught:
        open_project(folder)
    assert str(folder / "project.json") in str(caught.value)
    with pytest.raises(InputError, match=message):
        save_project(folder, written)
    assert files_of(folder) == before


@pytest.mark.parametrize("content", [b"", b"{", b"[]", b"null", b"\xff\xfe", b'{"format": NaN}', b"[" * 100_000])
def test_a_project_file_that_is_none_is_refused(project, content):
    folder, _ = project
    (folder / "project.json").write_bytes(content)
    with pytest.raises(InputError, match=r"project\.json"):
        open_project(folder)


def test_a_folder_without_project_is_refused_with_what_to_do(tmp_path):
    with pytest.raises(InputError, match=r"there is no project in this folder.*'project new' makes"):
        open_project(tmp_path)
    with pytest.raises(InputError, match="found nothing of that name"):
        open_project(tmp_path / "missing")
    (tmp_path / "plan.json").write_text("{}")
    with pytest.raises(InputError, match="found a file"):
        open_project(tmp_path / "plan.json")


def test_a_new_project_is_never_made_over_another_or_over_a_file(project, tmp_path):
    folder, written = project
    before = files_of(folder)
    with pytest.raises(InputError, match="there is a project here already"):
        create_project(folder, written)
    assert files_of(folder) == before
    (tmp_path / "file").write_text("mine")
    with pytest.raises(InputError, match="found a file"):
        create_project(tmp_path / "file", written)
    with pytest.raises(InputError, match="file"):
        create_project(tmp_path / "file" / "below", written)


def test_files_that_lie_in_the_folder_already_stay_untouched(tmp_path):
    mine = tmp_path / "site" / "site.json", tmp_path / "site" / "roof.ply", tmp_path / "plans" / "plan-1.plan.json"
    for path in mine:
        path.parent.mkdir(exist_ok=True)
        path.write_text("mine")
    made = document("roof", 1)
    create_project(tmp_path, made)
    assert [path.read_text() for path in mine] == ["mine"] * 3
    assert is_same(open_project(tmp_path).document, made)


def test_a_project_that_cannot_be_written_leaves_no_folder_behind(tmp_path, monkeypatch):
    monkeypatch.setattr("groundstation.services.project.store.write_atomically", lambda *_: no_room())
    with pytest.raises(InputError, match="no room"):
        create_project(tmp_path / "a" / "b", document())
    assert list((tmp_path / "a").iterdir()) == []


def no_room():
    raise InputError("no room")


def test_numbers_that_json_cannot_hold_are_refused_before_anything_is_written(project):
    folder, written = project
    before = files_of(folder)
    entry = written.plans[0]
    far = replace(entry.plan.constraints, max_distance_m=float("inf"))
    for wrong in (
        replace(written, request=PlanRequest(time_budget_s=float("inf"))),
        written.with_plan(replace(entry, bound_for_views=float("nan"))),
        written.with_plan(replace(entry, plan=replace(entry.plan, constraints=far))),
    ):
        with pytest.raises(InputError, match="NaN or infinite"):
            save_project(folder, wrong)
    assert files_of(folder) == before


def test_an_obstacle_without_triangles_is_a_wrong_call(tmp_path):
    site = SITES["roof"]
    empty = TriangleMesh(np.zeros((0, 3)), np.zeros((0, 3), np.int64))
    site = replace(site, site=replace(site.site, obstacles=(Obstacle("o", mesh="o.ply"),)), obstacles=(empty,))
    with pytest.raises(ValueError, match="expected obstacles with triangles"):
        create_project(tmp_path / "p", Document(site))
    assert not (tmp_path / "p").exists()


def test_a_folder_that_cannot_be_written_can_be_opened_and_says_so(tmp_path):
    with small_disk(tmp_path / "disk", 2000) as disk:
        if disk is None:
            pytest.skip("no file system can be mounted here")
        folder = disk / "p"
        written = create_project(folder, document())
        subprocess.run(["mount", "-o", "remount,ro", str(disk)], check=True)
        opened = open_project(folder)
        assert [note.code for note in opened.notes] == ["read-only"]
        assert is_same(opened.document, written)
        with pytest.raises(InputError, match="cannot be written \\(Read-only file system\\)"):
            save_project(folder, edited(written, 3))
        with pytest.raises(InputError, match="Read-only file system"):
            create_project(disk / "q", written)


def test_plans_are_added_under_free_names_and_only_once(tmp_path):
    for name, seed in (("south.plan.json", 1), ("other/south.plan.json", 2), (".plan.json", 3)):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        write_plan(tmp_path / name, plan(seed=seed, site_sha256="0" * 64))
    paths = [tmp_path / "south.plan.json", tmp_path / "other" / "south.plan.json", tmp_path / ".plan.json"]
    made, notes = add_plans(Document(SITES["roof"]), paths)
    assert [entry.id for entry in made.plans] == ["south", "south-2", "plan"]
    assert [note.code for note in notes] == ["site-changed"] * 3
    with pytest.raises(InputError, match="holds this plan already, as 'south'"):
        add_plans(made, paths[:1])


def test_identifiers_that_differ_only_in_case_get_files_that_differ_in_more(tmp_path):
    made = Document()
    for number, plan_id in enumerate(["A", "a", "Ä", "../x", "plan-2"]):
        made = made.with_plan(PlanEntry(plan_id, plan_id, plan(seed=number)))
    create_project(tmp_path / "p", made)
    names = [name.casefold() for name in names_of(tmp_path / "p" / "plans")]
    assert len(set(names)) == 5
    assert is_same(open_project(tmp_path / "p").document, made)


@pytest.mark.slow
def test_a_tower_saves_in_well_under_a_second_when_only_a_plan_has_changed(tmp_path):
    folder = tmp_path / "p"
    tower = Document(SCENES["tower"]()).with_plan(PlanEntry("plan-1", "560", plan(n_views=560)))
    written = create_project(folder, tower)
    seconds = []
    for seed in range(3):
        changed = edited(written, seed + 1)
        started = time.perf_counter()
        save_project(folder, changed)
        seconds.append(time.perf_counter() - started)
    assert min(seconds) < 0.5, seconds
    assert is_same(open_project(folder).document, changed)


def test_a_real_building_survives_as_a_project(shared_data, tmp_path):
    source = next((shared_data / "buildings" / "ingolstadt_lod3").glob("*4018270*"))
    imported = import_site(source, ImportOptions())
    unsaved = Document(imported.model)
    written = create_project(tmp_path / "a", unsaved)
    assert is_same(open_project(tmp_path / "a").document, unsaved)
    site_path = tmp_path / "b.site.json"
    model = write_imported_site(site_path, imported, source)
    kept = create_project(tmp_path / "b", Document(read_site(site_path)))
    assert kept.site.sha256 == model.sha256
    assert written.site.site.n_panels == model.site.n_panels


SAVER = """
import sys
from dataclasses import replace
from pathlib import Path
import numpy as np
from groundstation.services.project.folder import open_project, save_project
from planning.geo.mesh import box_mesh
from tests.services.project_cases import edited
folder = Path(sys.argv[1])
document = open_project(folder).document
print("ready", flush=True)
for number in range(10**6):
    building = box_mesh(np.array([-13.0 - number % 5, -8.0, 0.0]), np.array([12.0, 8.0, 12.0]))
    document = replace(document, site=replace(document.site, building=building))
    document = save_project(folder, edited(document, number % 9))
"""


@pytest.mark.slow
def test_a_project_that_another_process_saves_all_the_time_is_read_whole(tmp_path):
    folder = tmp_path / "p"
    create_project(folder, document("roof", 2))
    saver = subprocess.Popen([sys.executable, "-c", SAVER, str(folder)], stdout=subprocess.PIPE, cwd=ROOT)
    try:
        assert saver.stdout.readline() == b"ready\n"
        widths = set()
        for _ in range(60):
            opened = open_project(folder)
            assert [note.code for note in opened.notes] == []
            assert len(opened.document.plans) == 2
            widths.add(float(opened.document.site.building.vertices_enu_m[:, 0].min()))
        assert saver.poll() is None
        assert len(widths) > 1
    finally:
        saver.kill()
        saver.communicate()


def test_terrain_and_its_obstacles_come_back_with_the_project(tmp_path):
    model = hill_site(slope)
    mesh = box_mesh(np.array([10.0, 20.0, 0.0]), np.array([14.0, 24.0, 12.0]))
    site = replace(model.site, obstacles=(*model.site.obstacles, Obstacle("surface", mesh="hill.surface.ply")))
    model = replace(model, site=site, obstacles=(*model.obstacles, mesh))
    create_project(tmp_path / "hill", Document(model))
    found = open_project(tmp_path / "hill").document.site
    assert found.site.terrain == model.site.terrain
    assert found.obstacles[-1].vertices_enu_m.tolist() == mesh.vertices_enu_m.tolist()
    assert ground_of(found.site).terrain is not None
    written = files_of(tmp_path / "hill")
    save_project(tmp_path / "hill", open_project(tmp_path / "hill").document)
    assert written["site/site.json"] == files_of(tmp_path / "hill")["site/site.json"]

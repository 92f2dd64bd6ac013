"""Copies of unsaved work: written beside the project, told about once when they fail, found after a crash."""

import json
import os
import subprocess
import sys
import threading
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from groundstation.services.project.document import Document, PlanEntry
from groundstation.services.project.folder import create_project, open_project, save_project
from groundstation.services.project.lock import LOCK_FILE, Holder, lock_project
from groundstation.services.project.recovery import (
    AUTOSAVE_FOLDER,
    DAMAGED_FOLDER,
    HEADER_FILE,
    UNSAVED_FOLDER,
    Autosave,
    clear_copy,
    discard_recovery,
    find_recovery,
    find_unsaved,
    lock_unsaved_folder,
    recover,
    remove_unsaved_folder,
)
from planning.base.errors import InputError
from planning.request import PlanRequest
from planning.site.bundled import write_scene
from planning.site.file import read_site
from tests.services.project.test_folder import files_of
from tests.services.project_cases import (
    SITES,
    Crash,
    document,
    documents,
    edited,
    failing_disk,
    is_same,
    plan,
    small_disk,
)

ROOT = Path(__file__).resolve().parents[3]

NOON = datetime(2026, 5, 1, 12, 0, tzinfo=UTC)


class AtOnce:
    """An executor that runs everything where it is called."""

    def submit(self, function, *arguments):
        future = Future()
        future.set_result(function(*arguments))
        return future


class Later(AtOnce):
    """An executor that runs when it is told to."""

    def __init__(self):
        self.waiting = []

    def submit(self, function, *arguments):
        self.waiting.append((function, arguments))

    def run(self):
        for function, arguments in self.waiting:
            function(*arguments)
        self.waiting.clear()


@pytest.fixture
def project(tmp_path):
    folder = tmp_path / "p"
    return folder, create_project(folder, document("roof", 2), name="My building")


@pytest.fixture
def data(tmp_path, monkeypatch):
    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path / "config"))
    return tmp_path / "config" / "data"


def autosave(folder, told=None, executor=None):
    report = pytest.fail if told is None else told.append
    return Autosave(folder, AtOnce() if executor is None else executor, report, lambda: NOON)


def test_unsaved_work_is_found_again_and_says_what_is_different(project):
    folder, saved = project
    before = files_of(folder)
    site = replace(saved.site, site=replace(saved.site.site, home_enu_m=(0.0, -31.0, 0.0)))
    work = edited(replace(saved, site=site).without_plan("plan-1"), 9).with_plan(PlanEntry("x", "X", plan()))
    work = replace(work, request=PlanRequest(n_views=7))
    autosave(folder).keep(work)
    assert {name: value for name, value in files_of(folder).items() if AUTOSAVE_FOLDER not in name} == before
    found = find_recovery(folder)
    assert found.saved_at == NOON
    assert found.is_of_saved_state
    assert found.changes == (
        "the site",
        "plan 'Plan 2*' was changed",
        "plan 'X' is new",
        "plan 'Plan 1' was removed",
        "what is asked of the next plan",
    )
    opened = recover(found)
    assert is_same(opened.document, work)
    assert (opened.folder, opened.name) == (folder, "My building")
    discard_recovery(found)
    assert find_recovery(folder) is None
    after = files_of(folder)
    assert {name: value for name, value in after.items() if name != LOCK_FILE} == before


def test_there_is_nothing_to_recover_without_unsaved_work(project):
    folder, saved = project
    assert find_recovery(folder) is None
    keeper = autosave(folder)
    keeper.keep(saved)
    assert find_recovery(folder) is None  # it differs in nothing
    keeper.keep(edited(saved, 9))
    assert find_recovery(folder) is not None
    keeper.discard()
    assert not (folder / AUTOSAVE_FOLDER).exists()
    assert find_recovery(folder) is None


def test_a_save_that_the_copy_outlives_leaves_nothing_to_recover(project):
    folder, saved = project
    work = edited(saved, 9)
    autosave(folder).keep(work)
    save_project(folder, work)  # and the program ends before it removes the copy
    assert find_recovery(folder) is None


def test_a_copy_of_a_project_that_was_saved_since_says_so(project):
    folder, saved = project
    autosave(folder).keep(edited(saved, 9))
    save_project(folder, edited(saved, 8))
    assert not find_recovery(folder).is_of_saved_state


def test_the_copy_of_a_running_reflight_is_its_own(project, monkeypatch):
    folder, saved = project
    with lock_project(folder):
        autosave(folder).keep(edited(saved, 9))
        assert find_recovery(folder) is not None  # this very program has it open
        monkeypatch.setattr(Holder, "is_this_process", property(lambda _: False))
        assert find_recovery(folder) is None
    assert find_recovery(folder) is not None


def test_plans_in_a_copy_still_know_a_site_that_another_program_wrote(tmp_path):
    source = write_scene("roof", tmp_path)
    source.write_text(json.dumps(json.loads(source.read_text())))
    site = read_site(source)
    folder = tmp_path / "p"
    made = Document(site).with_plan(PlanEntry("a", "a", plan(site_sha256=site.sha256)))
    saved = create_project(folder, made, site_source=source)
    autosave(folder).keep(edited(saved, 9))
    found = find_recovery(folder)
    assert found.changes == ("plan 'a*' was changed",)
    assert recover(found).document.site.sha256 == site.sha256


@pytest.mark.parametrize(
    ("name", "content"),
    [
        (HEADER_FILE, b"{"),
        (
            HEADER_FILE,
            b'{"format": "reflight-autosave/9", "based_on": "", "saved_at": "", "process": 1, "computer": ""}',
        ),
        (HEADER_FILE, b'{"based_on": "", "saved_at": "noon", "process": 1, "computer": ""}'),
        ("project.json", b"[]"),
        ("site/site.json", b""),
        ("site/roof.ply", b"ply"),
    ],
)
def test_a_damaged_copy_is_told_kept_aside_and_never_in_the_way(project, name, content):
    folder, saved = project
    autosave(folder).keep(edited(saved, 9))
    (folder / AUTOSAVE_FOLDER / name).write_bytes(content)
    found = find_recovery(folder)
    assert found.copy is None
    assert name.rpartition("/")[2] in found.problem
    assert "damaged" in found.problem
    with pytest.raises(InputError, match="damaged and cannot be taken over"):
        recover(found)
    assert is_same(open_project(folder).document, saved)
    (folder / DAMAGED_FOLDER).mkdir()
    (folder / DAMAGED_FOLDER / "older").write_text("")
    discard_recovery(found)
    assert find_recovery(folder) is None
    assert (folder / DAMAGED_FOLDER / name).read_bytes() == content
    assert not (folder / DAMAGED_FOLDER / "older").exists()


def test_a_copy_with_one_damaged_plan_gives_the_others_with_a_note(project):
    folder, saved = project
    autosave(folder).keep(edited(saved, 9))
    (folder / AUTOSAVE_FOLDER / "plans" / "plan-1.plan.json").write_text("{")
    found = find_recovery(folder)
    assert found.changes == ("plan 'Plan 2*' was changed",)
    opened = recover(found)
    assert [entry.id for entry in opened.document.plans] == ["plan-2"]
    assert [note.code for note in opened.notes] == ["plan-left-out"]


def test_work_is_found_although_its_project_is_damaged(project):
    folder, saved = project
    work = edited(saved, 9)
    autosave(folder).keep(work)
    (folder / "site" / "site.json").write_text("{")
    found = find_recovery(folder)
    assert "the project that was saved cannot be opened" in found.changes[0]
    assert is_same(recover(found).document, work)


def test_work_that_never_had_a_project_is_found_when_its_window_is_gone(data):
    place = lock_unsaved_folder()
    assert data in place.folder.parents
    work = Document(SITES["roof"]).with_plan(PlanEntry("x", "X", plan()))
    keeper = autosave(place.folder)
    keeper.keep(Document())
    assert find_unsaved() == ()  # an empty window is nothing to recover
    keeper.keep(work)
    place.release()
    (found,) = find_unsaved()
    assert is_same(recover(found).document, work)
    assert (data / "unsaved" / "a file").write_text("") == 0
    discard_recovery(found)
    assert find_unsaved() == ()
    assert not place.folder.exists()
    place = lock_unsaved_folder()
    remove_unsaved_folder(place)
    assert not place.folder.exists()


def test_a_place_that_cannot_be_made_is_told(data):
    data.parent.mkdir()
    data.write_text("a file")
    with pytest.raises(InputError, match="cannot be written"):
        lock_unsaved_folder()


def test_of_many_documents_that_wait_only_the_last_is_written(project, monkeypatch):
    folder, saved = project
    written = []

    def note(place, made, **options):
        written.append(made)
        return save_project(place, made, **options)

    monkeypatch.setattr("groundstation.services.project.recovery.save_project", note)
    executor = Later()
    keeper = autosave(folder, executor=executor)
    works = [edited(saved, seed) for seed in range(1, 5)]
    for work in works:
        keeper.keep(work)
    assert len(executor.waiting) == 1
    executor.run()
    keeper.keep(works[-1])
    assert executor.waiting == []
    keeper.keep(saved)
    executor.run()
    assert written == [works[-1], saved]


def test_a_discarded_copy_stays_away_although_one_was_waiting(project):
    folder, saved = project
    executor = Later()
    keeper = autosave(folder, executor=executor)
    keeper.keep(edited(saved, 9))
    keeper.discard()
    executor.run()
    assert find_recovery(folder) is None
    keeper.keep(edited(saved, 8))
    executor.run()
    assert find_recovery(folder) is not None


def test_discarding_waits_for_a_copy_that_is_being_written(project, monkeypatch):
    folder, saved = project
    begun, go_on = threading.Event(), threading.Event()

    def slow(*arguments, **options):
        begun.set()
        assert go_on.wait(120.0)
        return save_project(*arguments, **options)

    monkeypatch.setattr("groundstation.services.project.recovery.save_project", slow)
    with ThreadPoolExecutor(2) as executor:
        keeper = autosave(folder, executor=executor)
        keeper.keep(edited(saved, 9))
        assert begun.wait(120.0)
        discarding = executor.submit(keeper.discard)
        go_on.set()
        discarding.result(120.0)
        assert not (folder / AUTOSAVE_FOLDER).exists()


def test_a_full_disk_is_told_once_and_loses_nothing(project):
    folder, saved = project
    told = []
    keeper = autosave(folder, told)
    works = [edited(saved, seed) for seed in range(1, 5)]
    keeper.keep(works[0])
    for work in works[1:3]:
        with failing_disk(4):
            keeper.keep(work)
    (message,) = told
    assert "No space left on device" in message
    assert "Nothing is lost while this window is open; make room or save the project in another folder" in message
    assert is_same(recover(find_recovery(folder)).document, works[0])
    keeper.keep(works[2])  # the same document once more, now that there is room
    assert is_same(recover(find_recovery(folder)).document, works[2])
    with failing_disk(4):
        keeper.keep(works[3])
    assert len(told) == 2


def test_a_mistake_of_ours_is_told_as_well(project, monkeypatch):
    folder, saved = project
    monkeypatch.setattr("groundstation.services.project.recovery.save_project", lambda *_, **__: 1 // 0)
    told = []
    keeper = autosave(folder, told)
    keeper.keep(saved)
    keeper.keep(edited(saved, 1))
    assert len(told) == 1
    assert "ZeroDivisionError" in told[0]


def test_a_folder_that_cannot_be_written_is_told_once(tmp_path):
    with small_disk(tmp_path / "disk", 2000) as disk:
        if disk is None:
            pytest.skip("no file system can be mounted here")
        folder = disk / "p"
        saved = create_project(folder, document())
        subprocess.run(["mount", "-o", "remount,ro", str(disk)], check=True)
        told = []
        keeper = autosave(folder, told)
        for seed in range(1, 4):
            keeper.keep(edited(saved, seed))
        (message,) = told
        assert "Read-only file system" in message
        keeper.discard()
        with pytest.raises(InputError, match="cannot be locked for editing"):
            lock_project(folder)


@pytest.mark.slow
@settings(max_examples=25)
@given(works=st.lists(st.tuples(documents(), st.none() | st.integers(0, 40)), min_size=1, max_size=4))
def test_after_a_crash_at_any_write_a_whole_copy_is_found(tmp_path_factory, works):
    folder = tmp_path_factory.mktemp("any") / "p"
    saved = create_project(folder, document("kiosk", 1))
    possible = [saved]
    for work, at in works:
        keeper = autosave(folder, [])
        try:
            if at is None:
                keeper.keep(work)
            else:
                with failing_disk(at, crash=True):
                    keeper.keep(work)
        except Crash:
            possible.append(work)
        else:
            possible = [work]
        found = find_recovery(folder)
        state = saved if found is None else recover(found).document
        assert any(_is_same_work(state, one) for one in possible)
    assert is_same(open_project(folder).document, saved)


def _is_same_work(one, other):
    """The same but for which plan is shown, which is nothing to recover."""
    plain = [Document(made.site, made.plans, "", made.request) for made in (one, other)]
    return is_same(*plain)


OTHER = """
import sys
from dataclasses import replace
from pathlib import Path
from groundstation.services.project.recovery import Autosave
from groundstation.services.project.folder import open_project
from groundstation.services.project.lock import lock_project
from planning.request import PlanRequest
class AtOnce:
    def submit(self, function):
        function()
folder = Path(sys.argv[1])
document = open_project(folder).document
print("ready", flush=True)
number = 1
while True:
    copies = Autosave(folder, AtOnce(), print)
    for ends in (False, True):
        with lock_project(folder):
            number += 1
            copies.keep(replace(document, request=PlanRequest(n_views=number)))
            if ends:
                copies.discard()
        for _ in range(number % 7):
            open_project(folder)
"""


@pytest.mark.slow
def test_the_copy_of_another_reflight_is_never_taken_for_a_damaged_one(project):
    folder, _ = project
    other = subprocess.Popen([sys.executable, "-c", OTHER, str(folder)], stdout=subprocess.PIPE, cwd=ROOT)
    try:
        assert other.stdout.readline() == b"ready\n"
        for _ in range(40):
            found = find_recovery(folder)
            assert found is None or not found.problem, found.problem
        assert other.poll() is None
    finally:
        other.kill()
        other.communicate()


def test_a_copy_that_was_only_half_cleared_away_is_none(project):
    folder, saved = project
    autosave(folder).keep(edited(saved, 9))
    place = folder / AUTOSAVE_FOLDER
    clear_copy(place)
    assert not place.exists()
    autosave(folder).keep(edited(saved, 9))
    (place / HEADER_FILE).unlink()
    (place / "project.json").unlink()
    assert find_recovery(folder) is None
    autosave(folder).keep(edited(saved, 11))
    assert find_recovery(folder).problem == ""


def test_places_that_a_killed_reflight_left_without_a_copy_are_cleared_away(data):
    left = data / UNSAVED_FOLDER / "left"
    (left / AUTOSAVE_FOLDER / "site").mkdir(parents=True)
    new, damaged, held = (data / UNSAVED_FOLDER / name for name in ("new", "damaged", "held"))
    for place in (new, damaged, held):
        place.mkdir()
    (damaged / DAMAGED_FOLDER).mkdir()
    with lock_project(held):
        for place in (left, damaged, held):
            os.utime(place, (0, 0))
        assert find_unsaved() == ()
    assert not left.exists()
    assert all(place.is_dir() for place in (new, damaged, held))

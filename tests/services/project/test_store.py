"""A disk that fails or a process that ends at any one write leaves the old project or the new one, whole."""

import os
import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from groundstation.services.project.document import PlanEntry
from groundstation.services.project.folder import create_project, open_project, save_project
from groundstation.services.project.store import current_path, digest, finish_interrupted_save, replace_together
from planning.base.errors import InputError
from planning.geo.mesh import box_mesh
from tests.services.project_cases import Crash, document, documents, edited, failing_disk, is_same, plan, small_disk


def old_document():
    return document("roof", 3)


def new_document(old):
    """Everything is different: the site and its mesh, one plan changed, one removed, one new."""
    site = old.site
    building = box_mesh(np.array([-13.0, -8.0, 0.0]), np.array([12.0, 8.0, 12.0]))
    site = replace(site, site=replace(site.site, home_enu_m=(0.0, -31.0, 0.0)), building=building)
    changed = edited(replace(old, site=site).without_plan("plan-1"), 9)
    return changed.with_plan(PlanEntry("plan-4", "new", plan(seed=4)))


ALL_NAMES = {*(f"plans/plan-{number}.plan.json" for number in range(1, 5)), "project.json", "site/site.json"}
ALL_NAMES |= {"site/roof.ply", "site/roof-DIGEST.ply"}


def names_of(folder):
    return {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}


def n_writes(tmp_path):
    """How many writes the save from the old to the new document takes."""
    old = create_project(tmp_path / "counted", old_document())
    with failing_disk(10**6) as tried:
        save_project(tmp_path / "counted", new_document(old))
    return len(tried)


@pytest.mark.long
def test_every_single_write_may_fail(tmp_path):
    count, outcomes = n_writes(tmp_path), set()
    assert count > 30
    for at in range(count):
        folder = tmp_path / str(at)
        old = create_project(folder, old_document())
        new = new_document(old)
        with failing_disk(at):
            outcome = is_saved(folder, new)
        outcomes.add(outcome)
        opened = open_project(folder)
        assert opened.notes == ()
        assert is_same(opened.document, new if outcome else old), at
        save_project(folder, new)
        assert is_same(open_project(folder).document, new), at
        leftovers = [path.name for path in folder.rglob("*.saving")]
        assert leftovers == []
    assert outcomes == {False, True}


@pytest.mark.slow
def test_the_process_may_end_at_every_single_write(tmp_path):
    count, outcomes = n_writes(tmp_path), []
    for at in range(count):
        folder = tmp_path / str(at)
        old = create_project(folder, old_document())
        new = new_document(old)
        with failing_disk(at, crash=True), pytest.raises(Crash):
            save_project(folder, new)
        opened = open_project(folder)
        assert opened.notes == ()
        outcomes.append(is_same(opened.document, new))
        assert outcomes[-1] or is_same(opened.document, old), at
        save_project(folder, new)
        assert is_same(open_project(folder).document, new)
        save_project(folder, edited(new, 11))
        # Old files of a save that ended before it could remove them may stay behind, nothing of the new ones.
        assert {re.sub(r"-[0-9a-f]{12}\.", "-DIGEST.", name) for name in names_of(folder)} <= ALL_NAMES
    assert outcomes == sorted(outcomes)
    assert set(outcomes) == {False, True}


@pytest.mark.slow
@settings(max_examples=40)
@given(
    steps=st.lists(
        st.tuples(documents(), st.none() | st.integers(0, 40), st.booleans()),
        min_size=1,
        max_size=5,
    )
)
def test_any_sequence_of_saves_that_succeed_fail_or_crash_holds_a_whole_project(tmp_path_factory, steps):
    folder = tmp_path_factory.mktemp("any") / "p"
    saved = create_project(folder, old_document())
    for made, at, crash in steps:
        possible = [made]
        try:
            if at is None:
                save_project(folder, made)
            else:
                with failing_disk(at, crash=crash):
                    save_project(folder, made)
        except InputError:
            possible = [saved]
        except Crash:
            possible = [saved, made]
        opened = open_project(folder)
        saved = next((state for state in possible if is_same(opened.document, state)), None)
        assert saved is not None
        assert opened.notes == ()


@pytest.mark.slow
def test_a_disk_may_be_full_to_any_degree(tmp_path):
    with small_disk(tmp_path / "disk", 400) as disk:
        if disk is None:
            pytest.skip("no file system can be mounted here")
        outcomes = set()
        for free_kib in range(0, 120, 4):
            folder, filler = disk / f"p{free_kib}", disk / "filler"
            old = create_project(folder, old_document())
            new = new_document(old)
            fill(filler, free_kib)
            outcome = is_saved(folder, new)
            outcomes.add(outcome)
            assert is_same(open_project(folder).document, new if outcome else old)
            filler.unlink()
            for path in sorted(folder.rglob("*"), reverse=True):
                path.rmdir() if path.is_dir() else path.unlink()
            folder.rmdir()
        assert outcomes == {False, True}


def fill(path, free_kib):
    """Fill a disk but for some KiB."""
    disk = os.statvfs(path.parent)
    path.write_bytes(bytes(disk.f_bavail * disk.f_frsize - 1024 * free_kib))


def is_saved(folder, new):
    """Save; whether that went well, or there was no room."""
    try:
        save_project(folder, new)
    except InputError as error:
        if "No space left on device" not in str(error):
            raise
        return False
    return True


def test_what_is_still_beside_its_place_is_read_only_with_the_right_checksum(tmp_path):
    (tmp_path / "a.json").write_bytes(b"old")
    (tmp_path / "a.json.saving").write_bytes(b"new")
    assert current_path(tmp_path, "a.json", digest(b"old")).name == "a.json"
    assert current_path(tmp_path, "a.json", "").name == "a.json"
    assert current_path(tmp_path, "a.json", digest(b"new")).name == "a.json.saving"
    finish_interrupted_save(tmp_path, {"a.json": digest(b"old")})
    assert (tmp_path / "a.json").read_bytes() == b"old"
    finish_interrupted_save(tmp_path, {"a.json": digest(b"new")})
    assert (tmp_path / "a.json").read_bytes() == b"new"
    assert [path.name for path in tmp_path.iterdir()] == ["a.json"]


def test_a_mesh_that_changes_often_keeps_a_short_name(tmp_path):
    made = create_project(tmp_path / "p", document())
    for number in range(4):
        building = box_mesh(np.array([-13.0 - number, -8.0, 0.0]), np.array([12.0, 8.0, 12.0]))
        made = save_project(tmp_path / "p", replace(made, site=replace(made.site, building=building)))
        (name,) = names_of(tmp_path / "p" / "site") - {"site.json"}
        assert re.fullmatch(r"roof(-[0-9a-f]{12})?\.ply", name)


def test_only_what_saves_have_left_behind_is_cleared_away(tmp_path):
    folder = tmp_path / "p"
    made = create_project(folder, document())
    ours = ["site/roof-0a041a706b5f.ply", "site/.roof.ply.ab12cd34", "plans/x.saving", "plans/.x.saving.ab12cd34"]
    mine = [
        "site/roof-000000000000.ply",
        "site/tree.ply",
        "plans/x.plan.json",
        ".hidden",
        "plans/.y.plan.json.ab12cd34",
    ]
    for name in (*ours, *mine):
        (folder / name).write_bytes(b"0123")
    (folder / ours[0]).rename(folder / f"site/roof-{digest(b'0123')[:12]}.ply")
    save_project(folder, edited(made, 5))
    assert names_of(folder) == {"project.json", "site/site.json", "site/roof.ply", "plans/plan-1.plan.json", *mine}


def test_a_failure_leaves_nothing_of_the_new_files(tmp_path):
    with pytest.raises(InputError, match="there is no folder"):
        replace_together(tmp_path, {"a.json": b"1", "missing/b.json": b"2"}, b"{}", {"mesh.ply": b"3"})
    assert list(tmp_path.iterdir()) == []

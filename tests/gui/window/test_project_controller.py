"""Projects in the window: saved, opened, recovered; damaged ones, read-only folders and full disks are survived."""

import os
import shutil
import subprocess
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import pytest
from PySide6.QtWidgets import QLabel, QLineEdit

from groundstation.services.jobs.runner import JobState
from groundstation.services.project.document import PlanEntry
from groundstation.services.project.folder import open_project
from planning.base.errors import InputError
from planning.planner import plan_flight
from planning.request import PlanRequest
from planning.site.bundled import roof
from reconstruction.objects.store import write_scene
from tests.gui.driving import (
    accept_button,
    choose,
    click_on,
    clicked,
    close_controller,
    escape,
    press,
    shut,
    trigger,
    turn_until,
    turn_until_idle,
    type_into,
)
from tests.planning.revision.cases import QUICK
from tests.reconstruction.objects.synthetic_scene import synthetic_scene
from tests.services.project_cases import small_disk


@pytest.fixture
def make_controller(application, worker, tmp_path, monkeypatch):
    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path / "config"))
    from groundstation.gui.window.project_controller import ProjectController

    controllers = []

    def make():
        controller = ProjectController(application, worker=worker)
        controller.show()
        turn_until(application, lambda: controller.window.shared_view.scene() is not None)
        controllers.append(controller)
        return controller

    def end(controller):
        close_controller(controller)
        controllers.remove(controller)

    make.end = end
    yield make
    for controller in list(controllers):
        end(controller)


@pytest.fixture(scope="module")
def entry():
    return PlanEntry("plan-1", "First", plan_flight(roof(), PlanRequest(n_views=4, greedy=QUICK)).plan)


def with_site(application, controller):
    controller.window.tab("site").left.opener.open_bundled("roof")
    turn_until_idle(application, controller)


@pytest.mark.long
def test_a_project_is_saved_and_opened_again(application, make_controller, entry, tmp_path):
    controller = make_controller()
    assert "Begin with a site" in controller.window.tab("site").left.start.findChild(QLabel).text()
    with_site(application, controller)
    controller.context.change("Plan", controller.context.document.with_plan(entry))
    assert controller.window.isWindowModified()
    with clicked(choose(tmp_path / "my roof")):
        controller.save()
    turn_until_idle(application, controller)
    assert not controller.window.isWindowModified()
    assert controller.window.windowTitle() == "my roof[*] - Reflight"
    assert "Saved in" in controller.window.messages.texts()
    controller.context.session.undo()
    assert controller.window.isWindowModified()
    with clicked(choose(tmp_path / "my roof"), "Discard"):
        trigger(controller.window, "Open project ...")
    turn_until_idle(application, controller)
    assert [found.title for found in controller.context.document.plans] == ["First"], controller.window.messages.texts()
    assert controller.context.document.current.plan == entry.plan
    assert controller.settings().recent_projects == (str(tmp_path / "my roof"),)


@pytest.mark.slow
def test_leaving_unsaved_work_asks_first(application, make_controller, tmp_path):
    controller = make_controller()
    with_site(application, controller)
    for no in ("Cancel", escape, shut):
        with clicked(no) as asked:
            trigger(controller.window, "New project")
        assert "This project has changes that are not saved" in asked[0]
        assert controller.context.document.site is not None
        with clicked(no):
            assert not controller.window.close()
    with clicked("Save", escape):
        trigger(controller.window, "New project")
    assert controller.context.document.site is not None, "no folder was named: nothing is saved, nothing is lost"
    with clicked("Save", choose(tmp_path / "kept")):
        trigger(controller.window, "New project")
    turn_until_idle(application, controller)
    assert controller.context.document.site is None
    assert open_project(tmp_path / "kept").document.site.site.name == "roof"


@pytest.mark.long
def test_the_folder_of_a_model_opens_on_its_tab_and_the_project_stays(application, make_controller, tmp_path):
    from groundstation.gui.model.model_controller import ModelController

    folder = tmp_path / "Gebäude Süd.gsscene"
    write_scene(synthetic_scene(((3, 2), (2, 1))), folder)
    controller = make_controller()
    with_site(application, controller)
    controller.open_path(folder)
    turn_until(application, lambda: ModelController.of(controller.context).card is not None)
    turn_until(application, lambda: controller.window.shown_tab() == "model")
    assert ModelController.of(controller.context).card.folder.name == folder.name
    assert controller.context.document.site.site.name == "roof"
    assert "Error" not in controller.window.messages.texts()


@pytest.mark.long
def test_a_damaged_project_is_refused_and_what_is_open_stays(application, make_controller, tmp_path):
    controller = make_controller()
    with_site(application, controller)
    bad = tmp_path / "bad"
    bad.mkdir()
    (bad / "project.json").write_text('{"format": "reflight-project/2", "plans": [')
    with clicked("Discard"):
        controller.open_folder(bad)
    turn_until_idle(application, controller)
    assert "project.json" in controller.window.messages.texts()
    assert "Error" in controller.window.messages.texts()
    assert controller.context.document.site.site.name == "roof"
    controller.open_recent(str(tmp_path / "gone"))
    assert "not there any more" in controller.window.messages.texts()


@pytest.mark.long
def test_a_full_disk_leaves_the_work_in_the_window(application, make_controller, entry, tmp_path, monkeypatch):
    controller = make_controller()
    with_site(application, controller)
    controller.save_in(tmp_path / "project")
    turn_until_idle(application, controller)
    controller.context.change("Plan", controller.context.document.with_plan(entry))

    def full(_path, _content):
        raise InputError("plan-1.plan.json: cannot be written (No space left on device)")

    with monkeypatch.context() as patch:
        patch.setattr("groundstation.services.project.store.write_atomically", full)
        controller.save()
        turn_until_idle(application, controller)
    assert "No space left on device" in controller.window.messages.texts()
    assert controller.window.isWindowModified()
    assert open_project(tmp_path / "project").document.plans == ()
    controller.save()
    turn_until_idle(application, controller)
    assert len(open_project(tmp_path / "project").document.plans) == 1


@contextmanager
def not_writable(folder):
    """A folder that nobody can write to: by its mode, or for root, who may write all the same, by its file system."""
    if os.geteuid() != 0:
        folder.chmod(0o555)
        yield
        folder.chmod(0o755)
        return
    with small_disk(folder.parent / "disk", 4096) as disk:
        if disk is None:
            pytest.skip("no file system can be mounted here")
        shutil.copytree(folder, disk / "project")
        subprocess.run(["mount", "-o", "remount,ro", str(disk)], check=True)
        folder.rename(folder.with_name("elsewhere"))
        folder.symlink_to(disk / "project")
        yield


@pytest.mark.slow
def test_a_read_only_project_opens_and_is_saved_elsewhere(application, make_controller, entry, tmp_path):
    controller = make_controller()
    with_site(application, controller)
    folder = tmp_path / "project"
    controller.save_in(folder)
    turn_until_idle(application, controller)
    controller.new_project()
    with not_writable(folder):
        controller.open_folder(folder)
        turn_until_idle(application, controller)
        assert "cannot be locked for editing" in controller.window.messages.texts()
        assert controller.context.document.site.site.name == "roof"
        controller.context.change("Plan", controller.context.document.with_plan(entry))
        controller.autosave_now()
        with clicked(choose(tmp_path / "copy")):
            controller.save()
        turn_until_idle(application, controller)
        assert not controller.window.isWindowModified()
    assert len(open_project(tmp_path / "copy").document.plans) == 1


@pytest.mark.slow
def test_unsaved_work_is_offered_after_a_crash(application, make_controller, entry, tmp_path):
    controller = make_controller()
    with_site(application, controller)
    folder = tmp_path / "project"
    controller.save_in(folder)
    turn_until_idle(application, controller)
    controller.context.change("Plan", controller.context.document.with_plan(entry))
    controller.autosave_now()
    turn_until(application, lambda: (folder / ".autosave" / "autosave.json").exists())
    # What a crash leaves: the folder as it is now, and no process that has it open.
    shutil.copytree(folder, tmp_path / "crashed", ignore=shutil.ignore_patterns(".lock*"))
    with clicked("Discard", "Restore") as asked:
        controller.open_folder(tmp_path / "crashed")
    turn_until_idle(application, controller)
    assert "plan 'First' is new" in asked[-1]
    assert [found.title for found in controller.context.document.plans] == ["First"]
    assert controller.window.isWindowModified(), "it is still not saved"
    controller.save()
    turn_until_idle(application, controller)
    assert not (tmp_path / "crashed" / ".autosave").exists()
    assert len(open_project(tmp_path / "crashed").document.plans) == 1


def crashed(application, make_controller, tmp_path):
    """A folder of a project with a copy of unsaved work, and a window in which nothing is open."""
    controller = make_controller()
    with_site(application, controller)
    controller.save_in(tmp_path / "project")
    turn_until_idle(application, controller)
    controller.context.change("Rename", replace(controller.context.document, request=PlanRequest(n_views=9)))
    controller.autosave_now()
    turn_until(application, lambda: (tmp_path / "project" / ".autosave" / "autosave.json").exists())
    shutil.copytree(tmp_path / "project", tmp_path / "crashed", ignore=shutil.ignore_patterns(".lock*"))
    make_controller.end(controller)
    return tmp_path / "crashed", make_controller()


@pytest.mark.slow
def test_unsaved_work_that_is_not_decided_about_is_offered_again(application, make_controller, tmp_path):
    folder, controller = crashed(application, make_controller, tmp_path)
    for later in ("Decide later", escape, shut):
        with clicked(later):
            controller.open_folder(folder)
        turn_until_idle(application, controller)
        assert controller.context.document.request.n_views is None
        assert (folder / ".autosave").exists()
    with clicked("Delete the copy"):
        controller.open_folder(folder)
    turn_until_idle(application, controller)
    assert not (folder / ".autosave").exists()
    controller.open_folder(folder)
    turn_until_idle(application, controller)
    assert controller.context.document.request.n_views is None


@pytest.mark.slow
def test_save_as_proposes_a_name_that_is_free(application, make_controller, tmp_path, monkeypatch):
    monkeypatch.setattr(Path, "home", lambda: tmp_path)
    (tmp_path / "roof").mkdir()
    controller = make_controller()
    with_site(application, controller)
    seen = []

    def accept(dialog):
        line = dialog.findChild(QLineEdit, "fileNameEdit")
        seen.append((dialog.directory().absolutePath(), line.text()))
        press("Save")(dialog)

    with clicked(accept):
        trigger(controller.window, "Save as ...")
    turn_until_idle(application, controller)
    assert seen == [(str(tmp_path), "roof 2")]
    assert open_project(tmp_path / "roof 2").document.site.site.name == "roof"
    with clicked(accept):
        trigger(controller.window, "Save as ...")
    turn_until_idle(application, controller)
    assert seen[-1] == (str(tmp_path), "roof 3")


@pytest.mark.slow
def test_a_folder_that_is_there_is_gone_into_and_the_name_stays(application, make_controller, tmp_path):
    (tmp_path / "here").mkdir()
    controller = make_controller()
    with_site(application, controller)

    def into(dialog):
        line, there = dialog.findChild(QLineEdit, "fileNameEdit"), tmp_path / "here"

        def is_typed():
            # While it reads its folder, Qt's dialog forgets what was typed.
            if line.text() != str(there):
                type_into(line, str(there))
                return False
            return accept_button(dialog).isEnabled()

        turn_until(application, is_typed)
        click_on(dialog, accept_button(dialog))
        turn_until(application, lambda: dialog.directory().absolutePath() == str(there))
        assert dialog.isVisible()
        turn_until(application, lambda: line.text() == "roof" and accept_button(dialog).isEnabled())
        click_on(dialog, accept_button(dialog))

    with clicked(into):
        trigger(controller.window, "Save as ...")
    turn_until_idle(application, controller)
    assert open_project(tmp_path / "here" / "roof").document.site.site.name == "roof"


@pytest.mark.parametrize(
    ("text", "name"), [("Haus 3/4: Nord", "Haus 3-4- Nord"), ("..", "-"), ("a" * 300, "a" * 80), ("Rö\\of", "Rö-of")]
)
def test_names_of_sites_become_names_that_every_system_takes(text, name):
    from groundstation.gui.widgets.questions import file_name

    assert file_name(text) == name


@pytest.mark.slow
def test_work_without_a_project_survives_a_crash_too(application, make_controller, tmp_path):
    first = make_controller()
    with_site(application, first)
    first.autosave_now()
    place = first.project_session.place()
    turn_until(application, lambda: (place / ".autosave" / "autosave.json").exists())
    shutil.copytree(place, place.with_name("crashed"), ignore=shutil.ignore_patterns(".lock*"))
    make_controller.end(first)
    assert not place.exists(), "an orderly end leaves nothing behind"
    with clicked("Restore") as asked:
        second = make_controller()
    turn_until_idle(application, second)
    assert second.context.document.site.site.name == "roof"
    assert "Nothing is lost" in asked[0]
    assert "it was never saved as a project" in asked[0]
    assert "What was saved" not in asked[0], "nothing was"
    assert "cannot" not in asked[0]
    assert "Your work is back. It is not saved yet" in second.window.messages.texts()


@pytest.mark.slow
def test_a_second_window_on_one_project_is_told(application, make_controller, tmp_path):
    first = make_controller()
    with_site(application, first)
    first.save_in(tmp_path / "project")
    turn_until_idle(application, first)
    second = make_controller()
    second.open_folder(tmp_path / "project")
    turn_until_idle(application, second)
    assert "open in another Reflight" in second.window.messages.texts()
    assert second.context.document.site is not None
    assert any("another Reflight" in message.text for message in second.window.messages.standing())
    second.save_in(tmp_path / "copy")
    turn_until_idle(application, second)
    assert not second.window.messages.standing(), "the copy is open nowhere else"


@pytest.mark.slow
def test_closing_while_a_plan_runs_cancels_it_and_loses_nothing(application, make_controller, tmp_path):
    controller = make_controller()
    with_site(application, controller)
    controller.save_in(tmp_path / "project")
    turn_until_idle(application, controller)
    controller.window.show_tab("plan")
    controller.window.tab("plan").controller.set_request(PlanRequest(n_views=25, time_budget_s=60.0))
    controller.window.tab("plan").controller.plan()
    turn_until(application, lambda: any(job.state is JobState.RUNNING for job in controller.context.jobs()))
    jobs = controller.context.jobs()
    assert controller.window.close()
    assert all(job.wait(120.0) for job in jobs)
    assert open_project(tmp_path / "project").document.site.site.name == "roof"


@pytest.mark.slow
def test_damaged_settings_are_told_kept_aside_and_the_window_opens_as_at_first(application, make_controller, tmp_path):
    config = tmp_path / "config"
    config.mkdir()
    damaged = {
        "settings": b'theme = "drak"\n', "flight": b"a = " + b"[" * 100_000, "connection": b"a." * 100_000 + b"a = 1",
    }  # fmt: skip
    for name, content in damaged.items():
        (config / f"{name}.toml").write_bytes(content)
    controller = make_controller()
    controller.window.show_tab("fly")
    turn_until_idle(application, controller)
    turn_until(application, lambda: "connection.damaged.toml" in controller.window.messages.texts())
    said = controller.window.messages.texts()
    assert "drak" in said
    for name, content in damaged.items():
        assert f"{name}.damaged.toml" in said
        assert (config / f"{name}.damaged.toml").read_bytes() == content
    controller.choose(text_scale=1.15)
    assert "text_scale = 1.15" in (config / "settings.toml").read_text()
    controller.choose(text_scale=1.0)


@pytest.mark.slow
def test_the_layout_is_remembered(application, make_controller):
    first = make_controller()
    first.window._around.setSizes([500, 700])
    turn_until_idle(application, first)
    width = first.window._around.sizes()[0]
    make_controller.end(first)
    second = make_controller()
    turn_until_idle(application, second)
    assert second.window._around.sizes()[0] == pytest.approx(width, abs=3)


@pytest.mark.slow
def test_work_that_was_thrown_away_is_not_offered_again(application, make_controller, entry, tmp_path):
    controller = make_controller()
    with_site(application, controller)
    folder = tmp_path / "project"
    controller.save_in(folder)
    turn_until_idle(application, controller)
    controller.context.change("Plan", controller.context.document.with_plan(entry))
    controller.autosave_now()
    turn_until(application, lambda: (folder / ".autosave" / "autosave.json").exists())
    with clicked("Discard") as asked:
        controller.open_folder(folder)
    turn_until_idle(application, controller)
    assert asked[-1].startswith("Unsaved changes")
    assert controller.context.document.plans == ()
    assert not controller.window.isWindowModified()

"""A keeper locks one project at a time and copies what is not saved; what it lets go of leaves nothing behind."""

import pytest

from groundstation.services.project.document import Document
from groundstation.services.project.folder import create_project
from groundstation.services.project.lock import lock_holder
from groundstation.services.project.session import ProjectSession, Session
from planning.base.errors import InputError
from tests.services.project_cases import document


@pytest.fixture
def project_session(tmp_path, monkeypatch):
    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path / "config"))
    told = []
    project_session = ProjectSession(told.append)
    yield project_session
    project_session.close()
    assert told == []


def written(project_session):
    """Wait until the copies asked for are on disk."""
    project_session._writer.submit(lambda: None).result()


def test_a_project_is_locked_while_it_is_held_and_free_afterwards(project_session, tmp_path):
    create_project(tmp_path / "a", document())
    create_project(tmp_path / "b", document())
    taken = project_session.opening_job(tmp_path / "a")()
    project_session.switch_to(taken.lock)
    assert project_session.may_save
    assert lock_holder(tmp_path / "a").is_this_process
    again = project_session.opening_job(tmp_path / "a")()
    assert again.lock is taken.lock, "one's own lock is no obstacle"
    project_session.switch_to(project_session.opening_job(tmp_path / "b")().lock)
    assert lock_holder(tmp_path / "a") is None
    project_session.switch_to(None)
    assert lock_holder(tmp_path / "b") is None
    assert not project_session.may_save


def test_a_project_that_cannot_be_read_is_not_left_locked(project_session, tmp_path):
    (tmp_path / "bad").mkdir()
    (tmp_path / "bad" / "project.json").write_text("{")
    with pytest.raises(InputError):
        project_session.opening_job(tmp_path / "bad")()
    assert lock_holder(tmp_path / "bad") is None


def test_a_project_of_another_window_is_read_without_a_lock(project_session, tmp_path):
    create_project(tmp_path / "a", document())
    other = ProjectSession(pytest.fail)
    other.switch_to(other.opening_job(tmp_path / "a")().lock)
    taken = project_session.opening_job(tmp_path / "a")()
    assert taken.lock is None
    assert "open in another Reflight" in taken.problem
    other.close()


def test_only_unsaved_work_is_copied_and_the_copy_goes_with_the_save(project_session, tmp_path):
    folder = tmp_path / "a"
    create_project(folder, document())
    taken = project_session.opening_job(folder)()
    project_session.switch_to(taken.lock)
    session = Session(taken.project.document, folder)
    project_session.copy(session)
    written(project_session)
    assert not (folder / ".autosave").exists()
    session.change("Remove", session.document.without_plan(session.document.plans[0].id))
    project_session.copy(session)
    written(project_session)
    assert (folder / ".autosave" / "autosave.json").exists()
    project_session.drop_copy()
    assert not (folder / ".autosave").exists()


def test_work_without_a_project_has_a_place_until_it_is_let_go(project_session):
    session = Session()
    session.change("Open", document())
    project_session.copy(session)
    written(project_session)
    place = project_session.place()
    assert (place / ".autosave" / "autosave.json").exists()
    project_session.release()
    assert not place.exists()
    assert project_session.place() is None
    project_session.copy(Session(Document()))
    assert project_session.place() is None, "nothing is not copied"

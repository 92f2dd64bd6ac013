"""A keeper locks one project at a time and copies what is not saved; what it lets go of leaves nothing behind."""

import pytest

from groundstation.services.project.document import Document
from groundstation.services.project.folder import create_project
from groundstation.services.project.lock import lock_holder
from groundstation.services.project.session import ProjectSession, Session
from planning.base.errors import InputError
from tests.services.project_cases import document


@pytest.fixture
def keeper(tmp_path, monkeypatch):
    monkeypatch.setenv("REFLIGHT_CONFIG_DIR", str(tmp_path / "config"))
    told = []
    keeper = ProjectSession(told.append)
    yield keeper
    keeper.close()
    assert told == []


def written(keeper):
    """Wait until the copies asked for are on disk."""
    keeper._writer.submit(lambda: None).result()


def test_a_project_is_locked_while_it_is_held_and_free_afterwards(keeper, tmp_path):
    create_project(tmp_path / "a", document())
    create_project(tmp_path / "b", document())
    taken = keeper.taking(tmp_path / "a")()
    keeper.hold(taken.lock)
    assert keeper.may_save
    assert lock_holder(tmp_path / "a").is_this_process
    again = keeper.taking(tmp_path / "a")()
    assert again.lock is taken.lock, "one's own lock is no obstacle"
    keeper.hold(keeper.taking(tmp_path / "b")().lock)
    assert lock_holder(tmp_path / "a") is None
    keeper.hold(None)
    assert lock_holder(tmp_path / "b") is None
    assert not keeper.may_save


def test_a_project_that_cannot_be_read_is_not_left_locked(keeper, tmp_path):
    (tmp_path / "bad").mkdir()
    (tmp_path / "bad" / "project.json").write_text("{")
    with pytest.raises(InputError):
        keeper.taking(tmp_path / "bad")()
    assert lock_holder(tmp_path / "bad") is None


def test_a_project_of_another_window_is_read_without_a_lock(keeper, tmp_path):
    create_project(tmp_path / "a", document())
    other = ProjectSession(pytest.fail)
    other.hold(other.taking(tmp_path / "a")().lock)
    taken = keeper.taking(tmp_path / "a")()
    assert taken.lock is None
    assert "open in another Reflight" in taken.problem
    other.close()


def test_only_unsaved_work_is_copied_and_the_copy_goes_with_the_save(keeper, tmp_path):
    folder = tmp_path / "a"
    create_project(folder, document())
    taken = keeper.taking(folder)()
    keeper.hold(taken.lock)
    session = Session(taken.project.document, folder)
    keeper.copy(session)
    written(keeper)
    assert not (folder / ".autosave").exists()
    session.change("Remove", session.document.without_plan(session.document.plans[0].id))
    keeper.copy(session)
    written(keeper)
    assert (folder / ".autosave" / "autosave.json").exists()
    keeper.drop_copy()
    assert not (folder / ".autosave").exists()


def test_work_without_a_project_has_a_place_until_it_is_let_go(keeper):
    session = Session()
    session.change("Open", document())
    keeper.copy(session)
    written(keeper)
    place = keeper.place()
    assert (place / ".autosave" / "autosave.json").exists()
    keeper.release()
    assert not place.exists()
    assert keeper.place() is None
    keeper.copy(Session(Document()))
    assert keeper.place() is None, "nothing is not copied"

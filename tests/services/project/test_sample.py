"""The sample project that comes with the program: it is whole, opens, and every step of it is done."""

import pytest

from groundstation.services.project.folder import open_project
from groundstation.services.project.sample import ARCHIVE, unpack_sample
from groundstation.services.project.steps import steps_in_folder
from planning.base.errors import InputError, OperationCancelled


def test_the_sample_is_a_project_in_which_every_step_is_done(tmp_path):
    folder = unpack_sample(tmp_path / "sample")
    project = open_project(folder)
    assert project.document.site.site.n_panels > 0
    assert project.document.current is not None
    assert project.notes == ()
    found = steps_in_folder(folder, project.document.current.plan)
    assert found.is_exported
    assert found.flown.is_whole
    assert found.data_set == folder / "dataset"
    assert found.model is not None
    assert list((folder / "photos").glob("*.JPG"))
    assert ARCHIVE.stat().st_size < 3_000_000


def test_what_the_user_did_in_his_copy_stays(tmp_path):
    folder = unpack_sample(tmp_path / "sample")
    (folder / "flights" / "mine.json").write_text("{}")
    assert unpack_sample(folder) == folder
    assert (folder / "flights" / "mine.json").exists()


def test_nothing_of_others_is_replaced_and_nothing_is_left_half_made(tmp_path):
    folder = tmp_path / "sample"
    folder.mkdir()
    (folder / "notes.txt").write_text("mine")
    with pytest.raises(InputError, match="expected the sample project"):
        unpack_sample(folder)
    assert [path.name for path in folder.iterdir()] == ["notes.txt"]

    class Cancelling:
        def report(self, stage, done, total):
            if done > 3:
                raise OperationCancelled("cancelled")

    with pytest.raises(OperationCancelled):
        unpack_sample(tmp_path / "other", Cancelling())
    assert not (tmp_path / "other").exists()
    assert unpack_sample(tmp_path / "other").is_dir(), "the next try succeeds"

"""Pictures and documents beside the records: only real pictures, only in the folder, each content once."""

import os

import cv2
import numpy as np
import pytest

from groundstation.services.model.facility_records import put_fields
from planning.base.errors import InputError
from planning.base.files import FileLimit
from reconstruction.records import stored_files
from reconstruction.records.entries import Defect
from reconstruction.records.stored_files import store_document, store_picture, stored_path
from tests.reconstruction.records.cases import PANES, new_book

PICTURES = {
    ending: cv2.imencode(ending, np.full((4, 4, 3), 90, np.uint8))[1].tobytes() for ending in (".png", ".jpg", ".webp")
}


@pytest.fixture
def book(tmp_path):
    with new_book(tmp_path) as opened:
        yield opened


@pytest.mark.parametrize("ending", PICTURES)
def test_pictures_are_kept_once_under_their_checksum(book, tmp_path, ending):
    given = tmp_path / "crack.bin"
    given.write_bytes(PICTURES[ending])
    stored = store_picture(book, given)
    assert stored == store_picture(book, PICTURES[ending])
    assert stored.name == f"{stored.sha256}{ending}"
    assert stored_path(book, stored.name).read_bytes() == PICTURES[ending]
    assert len(list(book.files.iterdir())) == 1
    assert book.put(Defect(PANES[0], "crack", 3, "2026-01-01", picture=stored.name)).picture == stored.name


@pytest.mark.parametrize(
    "content", [b"", b"GIF89a", b"<svg onload='alert(1)'>", b"RIFF\x00\x00\x00\x00WAVE", b"%PDF-1.7", b"\x89PNG\n"]
)
def test_what_is_no_picture_is_refused(book, content):
    with pytest.raises(InputError, match="expected a PNG, JPEG or WebP picture"):
        store_picture(book, content)
    assert not book.files.exists()


def test_sizes_are_limited(book, tmp_path, monkeypatch):
    monkeypatch.setattr(stored_files, "PICTURE_FILE", FileLimit("a picture", 100))
    with pytest.raises(InputError, match="pictures may have 100"):
        store_picture(book, PICTURES[".png"] + bytes(100))
    large = tmp_path / "large.png"
    large.write_bytes(PICTURES[".png"] + bytes(100))
    with pytest.raises(InputError, match="has more than"):
        store_picture(book, large)
    with pytest.raises(InputError, match="expected a document, found a folder"):
        store_document(book, tmp_path)


@pytest.mark.parametrize(
    "name", ["../records.sqlite", "/etc/passwd", "..", "a/b", "C:\\x", ".hidden", "a\x00b", "", "CON:"]
)
def test_names_that_lead_elsewhere_are_refused(book, name):
    with pytest.raises(InputError, match="name: expected"):
        stored_path(book, name)


def test_files_that_were_exchanged_or_linked_are_not_given_out(book, tmp_path):
    paper = tmp_path / "Sheet.PDF"
    paper.write_bytes(b"%PDF-1.7")
    stored = store_document(book, paper)
    assert stored.name.endswith(".pdf")
    path = book.files / stored.name
    path.write_bytes(b"other")
    with pytest.raises(InputError, match="is not the file that was stored"):
        stored_path(book, stored.name)
    path.unlink()
    with pytest.raises(InputError, match="the file is missing"):
        stored_path(book, stored.name)
    secret = tmp_path / "secret"
    secret.write_bytes(b"secret")
    path.symlink_to(secret)
    with pytest.raises(InputError, match="the file is missing"):
        stored_path(book, stored.name)
    assert store_document(book, paper) == stored
    assert secret.read_bytes() == b"secret"
    assert not path.is_symlink()


def test_files_that_no_entry_refers_to_are_removed_by_a_later_store(book, tmp_path):
    kept, undone, stray, new = (
        store_picture(book, cv2.imencode(".png", np.full((4, 4, 3), grey, np.uint8))[1].tobytes()).name
        for grey in (10, 20, 30, 40)
    )
    book.put(Defect(PANES[0], "crack", 3, "2026-01-01", picture=kept))
    book.put(Defect(PANES[0], "crack", 3, "2026-01-01", picture=undone))
    assert book.undo() is not None
    (book.files / "notes.txt").write_text("somebody's")
    for path in book.files.iterdir():
        if path.name != new:
            os.utime(path, (0, 0))
    last = store_picture(book, PICTURES[".jpg"]).name
    assert {path.name for path in book.files.iterdir()} == {kept, undone, new, last, "notes.txt"}
    assert not (book.files / stray).exists()


def test_a_picture_whose_entry_is_refused_does_not_stay(book, tmp_path):
    picture = tmp_path / "crack.png"
    picture.write_bytes(PICTURES[".png"])
    fields = {"kind": "crack", "severity": "3", "found_on": "2026-01-01", "picture": str(picture)}
    with pytest.raises(InputError, match="severity"):
        put_fields(book, PANES[0], "defect", {**fields, "severity": "77"})
    assert list(book.files.glob("*")) == []
    known = put_fields(book, PANES[0], "defect", fields).picture
    with pytest.raises(InputError, match="severity"):
        put_fields(book, PANES[0], "defect", {**fields, "severity": "77"})
    assert [path.name for path in book.files.iterdir()] == [known]

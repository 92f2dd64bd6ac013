"""Use cases of records: from a site to a book, in and out."""

import csv
import getpass

import ifcopenshell
import pytest

from groundstation.services.model.facility_records import (
    export_ifc,
    export_tables,
    filter_value,
    import_records,
    make_records,
    object_content,
    object_lines,
    open_records,
    plain_records,
    put_attributes,
    put_fields,
    user_name,
)
from planning.base.errors import InputError
from planning.site.bundled import write_scene
from planning.site.file import read_site
from reconstruction.records.entries import Attribute, Defect
from reconstruction.records.objects import site_objects
from reconstruction.records.queries import ObjectFilter, history
from tests.reconstruction.records.test_stored_files import PICTURES


@pytest.fixture
def folder(tmp_path):
    """A folder with the records of a site of 32 panes, and its site file beside it."""
    make_records(tmp_path / "model", write_scene("roof", tmp_path), "Chan")
    return tmp_path / "model"


def test_records_of_a_site_have_its_objects_and_origin(folder):
    site = read_site(folder.parent / "roof.site.json").site
    with open_records(folder) as book:
        assert book.objects() == site_objects(site)
        assert book.origin == site.origin
    done = make_records(folder, folder.parent / "roof.site.json", "Chan")
    assert (done.n_new, done.n_changed, done.n_absent) == (0, 0, 0)


def test_where_there_are_no_records_the_way_to_some_is_told(tmp_path):
    with pytest.raises(InputError, match="'records FOLDER make --objects SITE'"):
        open_records(tmp_path)
    with pytest.raises(InputError, match="'records FOLDER make --objects SITE'"):
        open_records(tmp_path / "missing")
    (tmp_path / "notes.txt").write_text("x")
    with pytest.raises(InputError, match="expected a site file"):
        make_records(tmp_path / "m", tmp_path / "notes.txt")
    assert not (tmp_path / "m").exists()


def test_entries_from_texts_with_their_files(folder, tmp_path):
    picture, paper = tmp_path / "a.bin", tmp_path / "Sheet.pdf"
    picture.write_bytes(PICTURES[".jpg"])
    paper.write_bytes(b"%PDF")
    with open_records(folder, True, "Chan") as book:
        fields = {
            "kind": "crack",
            "severity": "3",
            "found_on": "2026-01-01",
            "u": "0.5",
            "v": "1",
            "picture": str(picture),
        }
        defect = put_fields(book, "A-0001", "defect", fields)
        again = put_fields(book, "A-0001", "defect", {**fields, "picture": defect.picture})
        assert (defect.severity, defect.u, defect.v, again.picture) == (3, 0.5, 1.0, defect.picture)
        assert (book.files / defect.picture).read_bytes() == PICTURES[".jpg"]
        document = put_fields(book, "A-0001", "document", {"title": "sheet", "place": str(paper)})
        assert (document.sha256, document.place.endswith(".pdf")) == (document.place.partition(".")[0], True)
        assert put_fields(book, "A-0001", "document", {"title": "s", "place": "https://x.org"}).sha256 == ""
        for kind, texts, words in (
            ("attribute", {}, "expected one of inspection"),
            ("crack", {}, "'crack': expected one of"),
            ("defect", {"colour": "red"}, "a defect has no field 'colour'"),
            ("defect", {"kind": "crack"}, "severity: expected a value"),
            ("defect", {**fields, "picture": str(paper)}, "expected a PNG, JPEG or WebP"),
            ("defect", {**fields, "picture": "/etc"}, "expected a picture, found a folder"),
            ("document", {"title": "s", "place": "../x"}, "place: expected an address"),
        ):
            with pytest.raises(InputError, match=words):
                put_fields(book, "A-0001", kind, texts)
        assert history(book, limit=1)[0].what == "document of A-0001"


def test_attributes_are_set_and_taken_out_together(folder):
    with open_records(folder, True, "Chan") as book:
        heads = {"maker": "Glas AG", "thickness": "28.5", "u-value [W/m²K] (number)": "1.1", "safe (yes/no)": "yes"}
        assert put_attributes(book, "A-0000", heads) == 4
        assert put_attributes(book, "A-0000", {"maker": "", "product": ""}) == 1
        found = {entry.name: entry.value for entry in book.entries(Attribute)}
        assert found == {"thickness": 28.5, "u-value": 1.1, "safe": True}
        assert filter_value(book, "thickness", "28.5") == 28.5
        assert filter_value(book, "safe", "yes") is True
        assert filter_value(book, "maker", "1") == "1"
        assert filter_value(book, "width", "3") == 3.0
        with pytest.raises(InputError, match="thickness: expected a number"):
            put_attributes(book, "A-0000", {"maker": "y", "thickness": "thick"})
        assert len(book.entries(Attribute)) == 3


def test_lines_and_contents_tell_the_state_of_objects(folder):
    with open_records(folder, True, "Chan") as book:
        put_fields(book, "A-0001", "inspection", {"date": "2026-01-01", "result": "fine"})
        put_fields(book, "A-0001", "defect", {"kind": "crack", "severity": "4", "found_on": "2026-01-01"})
        lines = {line["name"]: line for line in object_lines(book, ObjectFilter(layer="element"))}
        assert len(lines) == 32
        line = lines["A-0001"]
        assert (line["last_inspection"], line["result"], line["worst_open_defect"], line["severity"]) == (
            "2026-01-01", "fine", "crack", 4,
        )  # fmt: skip
        assert lines["A-0000"]["severity"] is None
        content = object_content(book, line["global_id"])
        assert (content["name"], content["present"], len(content["defects"])) == ("A-0001", True, 1)
        assert content["defects"][0]["kind"] == "crack"
        rows = plain_records(book)[line["global_id"]]
        assert [(row["record"], row.get("kind")) for row in rows] == [("inspection", None), ("defect", "crack")]


@pytest.mark.slow
def test_tables_and_ifc_go_out_and_come_back(folder, tmp_path):
    with open_records(folder, True, "Chan") as book:
        put_fields(book, "A-0001", "defect", {"kind": "=crack", "severity": "4", "found_on": "2026-01-01"})
        put_attributes(book, "A-0001", {"maker": "Glas AG"})
        tables = export_tables(book, tmp_path / "tables", semicolon=True)
        with tables.files[2].open(newline="", encoding="utf-8-sig") as file:
            assert [row["kind"] for row in csv.DictReader(file, delimiter=";")] == ["'=crack"]
        new = export_ifc(book, tmp_path / "new.ifc", site=folder.parent / "roof.site.json")
        assert new.notes == ()
        assert len(ifcopenshell.open(str(tmp_path / "new.ifc")).by_type("IfcBuildingElementProxy")) == 1
        with pytest.raises(InputError, match="--site goes with a new IFC file"):
            export_ifc(book, tmp_path / "x.ifc", tmp_path / "new.ifc", folder.parent / "roof.site.json")
        for _ in range(2):
            book.undo()
        assert import_records(book, tmp_path / "tables").n_changed["defect"] == 1
        (tmp_path / "list.csv").write_bytes(tables.files[0].read_bytes())
        with pytest.raises(InputError, match="or name the kind"):
            import_records(book, tmp_path / "list.csv")
        assert import_records(book, tmp_path / "list.csv", "attribute").n_changed == {"attribute": 0}
        with pytest.raises(InputError, match="--kind: expected one of"):
            import_records(book, tmp_path / "list.csv", "crack")
        with pytest.raises(InputError, match=r"holds none of attributes\.csv"):
            import_records(book, folder)
        taken = import_records(book, tmp_path / "new.ifc")
        assert (taken.n_changed, taken.notes) == ({"new.ifc": 0}, ())
        assert book.entries(Defect)[0].kind == "=crack"


def test_who_is_at_the_computer_is_always_somebody(monkeypatch):
    def nobody():
        raise OSError

    monkeypatch.setattr(getpass, "getuser", nobody)
    assert user_name() == "unknown"

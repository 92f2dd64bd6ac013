"""`records`: each action, as text and as JSON, and its refusals."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from planning.site.bundled import write_scene
from reconstruction.objects.store import write_scene as write_objects
from tests.reconstruction.objects.synthetic_scene import synthetic_scene


@pytest.fixture
def folder(tmp_path, reflight):
    """A folder with the records of a site of 32 panes."""
    write_scene("roof", tmp_path)
    done = reflight("records", tmp_path / "m", "make", "--objects", tmp_path / "roof.site.json", "--json")
    assert done.json["objects"] == {"new": 34, "changed": 0, "absent": 0, "present": 34}
    return tmp_path / "m"


def test_a_defect_is_added_found_shown_exported_and_taken_back(reflight, folder, tmp_path):
    fields = ("kind=crack", "severity=4", "found_on=2026-03-31", "u=0.25", "v=0.5", "note=south <b>side</b>")
    added = reflight("records", folder, "add", "A-0003", "defect", *fields, "--who", "Chan", "--json")
    assert reflight("records", folder, "set", "A-0003", "maker=Glas AG", "thickness=28").status == 0
    listed = reflight("records", folder, "list", "--severity", 3, "--json").json["objects"]
    assert [(line["name"], line["severity"]) for line in listed] == [("A-0003", 4)]
    assert "A-0003" in reflight("records", folder, "list", "--attribute", "thickness=28").out
    assert reflight("records", folder, "list", "--attribute", "thickness=27", "--facade", "A").out == "0 objects\n"
    assert reflight("records", folder, "list", "--not-inspected-since", "2026-01-01", "--name", "A-").out.endswith(
        "32 objects\n"
    )
    shown = reflight("records", folder, "show", "A-0003", "--json").json
    assert (shown["defects"][0]["key"], shown["defects"][0]["u"]) == (added.json["key"], 0.25)
    assert "defects: kind crack, severity 4" in reflight("records", folder, "show", "A-0003").out
    hits = reflight("records", folder, "search", "south side", "--json").json["hits"]
    assert [(hit["name"], hit["field"], hit["text"]) for hit in hits] == [("A-0003", "note", "south <b>side</b>")]
    assert "defect note: south" in reflight("records", folder, "search", "sou").out
    files = reflight("records", folder, "export", "-o", tmp_path / "tables", "--json").json["files"]
    assert len(files) == 5
    assert reflight("records", folder, "remove", "defect", added.json["key"]).out.endswith("taken out\n")
    assert reflight("records", folder, "import", tmp_path / "tables" / "defects.csv", "--json").json == {
        "changed": {"defect": 1}
    }
    history = reflight("records", folder, "history", "A-0003", "--json").json["changes"]
    assert [(change["kind"], change["who"]) for change in history][-2:] == [
        ("defect", "Chan"),
        ("object", history[-1]["who"]),
    ]
    assert "defect of A-0003 removed" in reflight("records", folder, "history").out
    assert "import of defects.csv" in reflight("records", folder, "undo").out
    assert reflight("records", folder, "show", "A-0003", "--json").json["defects"] == []
    assert reflight("records", folder, "check").out.endswith("sound\n")
    assert reflight("records", folder, "check", "--json").json == {"sound": True}


def test_a_new_ifc_file_and_what_it_lacks(reflight, folder, tmp_path):
    done = reflight("records", folder, "export", "-o", tmp_path / "a.ifc")
    assert (tmp_path / "a.ifc").read_bytes().startswith(b"ISO-10303-21")
    assert "note: the building behind the panes is not in the file" in done.err
    error = reflight("records", folder, "export", "-o", tmp_path / "t", "--site", tmp_path / "roof.site.json").error
    assert "expected a name ending in .ifc" in error


@pytest.mark.parametrize("name", ["x.xlsx", "x.csv", "x.pdf", "X.JSON"])
def test_tables_are_not_written_into_a_folder_that_is_called_as_a_file_is(reflight, folder, tmp_path, name):
    error = reflight("records", folder, "export", "-o", tmp_path / name).error
    assert f"{name}: not written: there is no export into a file of this ending; name a folder" in error
    assert not (tmp_path / name).exists()
    (tmp_path / name).mkdir()
    assert reflight("records", folder, "export", "-o", tmp_path / name).status == 0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("show", "nothing"), "'nothing': there is no such object"),
        (("set", "A-0003", "maker"), "'maker': expected NAME=VALUE"),
        (("set", "A-0003", "maker=a", "maker=b"), "'maker' is given twice"),
        (("set", "A-0003", "thickness=a"), "thickness: expected a number"),
        (("add", "A-0003", "crack", "a=b"), "'crack': expected one of"),
        (("add", "A-0003", "inspection", "date=1/2/2026"), "date: expected a date such as"),
        (("remove", "defect", "x"), "no defect with the key"),
        (("remove", "crack", "x"), "'crack': expected one of"),
        (("import", "missing.csv"), "expected a name of"),
        (("import", "defects.csv"), "cannot be read"),
        (("list", "--not-inspected-since", "soon"), "not_inspected_since: expected a date"),
        (("list", "--facade", "Z"), "'Z': there is no such object"),
    ],
)
def test_refusals_are_one_line_and_change_nothing(reflight, folder, arguments, words):
    before = (folder / "records.sqlite").read_bytes()
    assert words in reflight("records", folder, *arguments).error
    assert (folder / "records.sqlite").read_bytes() == before


def test_objects_are_called_as_those_who_look_after_the_building_call_them(reflight, folder):
    lines = reflight("records", folder, "list").out.splitlines()
    words = {line.split()[0]: line.split()[2].rstrip(",") for line in lines[:-1]}
    assert set(words.values()) <= {"building", "facade", "panel", "background"}
    assert words["A-0003"] == "panel"
    assert words["A"] == "facade"


def test_without_records_the_way_to_some_is_told(reflight, tmp_path):
    assert "'records FOLDER make --objects SITE'" in reflight("records", tmp_path, "list").error
    assert reflight("records", tmp_path).status == 2
    write_objects(synthetic_scene(), tmp_path / "a.gsscene")
    assert reflight("records", tmp_path / "a.gsscene", "list").error.endswith("make them with 'records FOLDER make'")
    (tmp_path / "a.model").mkdir()
    (tmp_path / "a.model" / "model.json").write_text("{}")
    assert "of which 'organise' makes a folder" in reflight("records", tmp_path / "a.model", "list").error


LOOK = """
import sys
from groundstation.cli.main import main
assert main(["records", sys.argv[1], "list", "--json"], print) == 0
assert not {"torch", "ifcopenshell", "pandas"} & set(sys.modules)
"""


@pytest.mark.slow
def test_looking_into_records_loads_nothing_heavy(folder):
    root = Path(__file__).resolve().parents[2]
    command = [sys.executable, "-c", LOOK, str(folder)]
    done = subprocess.run(command, cwd=root, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert len(json.loads(done.stdout)["objects"]) == 34


def test_records_of_a_scene_take_its_objects(reflight, tmp_path):
    write_objects(synthetic_scene(), tmp_path / "made.gsscene")
    done = reflight("records", tmp_path / "made.gsscene", "make", "--json")
    assert done.status == 0, done.error
    n_objects = 1 + len(synthetic_scene().components) + len(list(synthetic_scene().elements))
    assert done.json["objects"]["present"] == n_objects
    nothing = reflight("records", tmp_path, "make")
    assert nothing.status == 1
    assert "make one with `organise`" in nothing.error

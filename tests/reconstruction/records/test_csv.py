"""CSV tables: the same records come back, formulas do not get out, and every wrong cell is named."""

import csv
import io
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.base.errors import InputError
from reconstruction.records.csv import (
    TableError,
    escaped_formula,
    kind_of_table,
    number_cell,
    read_number,
    read_tables,
    unescaped_formula,
    write_tables,
)
from reconstruction.records.entries import KIND_NAMED, KINDS, Attribute, Defect, Inspection
from reconstruction.records.queries import history
from tests.reconstruction.records.cases import NASTY, PANES, contents, entries, model, new_book, numbers, state, texts


@pytest.fixture
def book(tmp_path):
    with new_book(tmp_path) as opened:
        yield opened


def table(folder, name, text):
    path = folder / f"{name}.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode("utf-8"))
    return path


def take(book, path, name=None):
    return read_tables(book, [(path, KIND_NAMED[name] if name else kind_of_table(path))])


def refusal(book, path, name=None):
    before = state(book)
    with pytest.raises(InputError) as caught:
        take(book, path, name)
    assert str(caught.value).startswith(str(path))
    assert state(book) == before
    return caught.value


@pytest.mark.slow
@given(st.lists(entries, max_size=8), st.booleans())
def test_records_come_back_as_they_were(tmp_path_factory, found, semicolon):
    folder, other = tmp_path_factory.mktemp("a"), tmp_path_factory.mktemp("b")
    with new_book(folder) as book, new_book(other) as again:
        for entry in found:
            book.put(entry)
        paths = write_tables(book, folder / "tables", semicolon)
        assert [path.name for path in paths] == [f"{kind.table}.csv" for kind in KINDS]
        read_tables(again, [(path, kind_of_table(path)) for path in reversed(paths)])
        assert contents(again) == contents(book)
        written = {path.name: path.read_bytes() for path in paths}
        assert {p.name: p.read_bytes() for p in write_tables(again, other / "tables", semicolon)} == written
        n_changes = len(history(again))
        assert sum(taken.n_changed for taken in read_tables(again, [(p, kind_of_table(p)) for p in paths])) == 0
        assert len(history(again)) == n_changes


@pytest.mark.long
@given(st.lists(entries, min_size=1, max_size=6))
def test_no_cell_can_be_taken_for_a_formula(tmp_path_factory, found):
    folder = tmp_path_factory.mktemp("a")
    with new_book(folder) as book:
        for entry in found:
            book.put(entry)
        for path in write_tables(book, folder / "tables"):
            for line in csv.reader(io.StringIO(path.read_bytes().decode("utf-8-sig"), newline="")):
                for cell in line:
                    assert not cell or cell[0] not in "=+@\t\r" or cell.startswith("'")
                    assert not cell.startswith("-") or float(cell) < 0.0, "of what begins with a minus only numbers"


@given(texts)
def test_guards_come_off_again_and_other_texts_keep_their_apostrophes(text):
    assert unescaped_formula(escaped_formula(text)) == text
    assert escaped_formula(escaped_formula(text)) != text or escaped_formula(text) == text
    assert escaped_formula("'t Hooft") == unescaped_formula("'t Hooft") == "'t Hooft"


@given(numbers, st.booleans())
def test_numbers_come_back_bit_by_bit(value, comma):
    assert read_number(number_cell(value), "x", comma) == value
    assert read_number(number_cell(value, comma), "x", comma) == value
    assert not (comma and "." in number_cell(value, comma)), "1.44 is a month to spreadsheets with decimal commas"


def test_tables_of_spreadsheets_with_semicolons_and_decimal_commas(book, tmp_path):
    text = "\ufeffname;thickness [mm];u-value [W/m²K] (number);maker\r\nA-0000;28,5;1,1;Glas, Söhne\r\n\r\n"
    text += "B-0001;;;=1+1\r\n"
    assert take(book, table(tmp_path, "attributes", text))[0].n_changed == 4
    assert {e.name: e.value for e in book.entries(Attribute, PANES[0])} == {
        "thickness": 28.5, "u-value": 1.1, "maker": "Glas, Söhne",
    }  # fmt: skip
    assert book.entries(Attribute, PANES[1])[0].value == "=1+1"
    error = refusal(book, table(tmp_path, "attributes", 'name,thickness\r\nA-0000,"28,5"\r\n'))
    assert "line 2, column 'thickness': expected a number with a point" in str(error)
    error = refusal(book, table(tmp_path, "attributes", "name;thickness\r\nA-0000;1.234,5\r\n"))
    assert "expected a number, got '1.234,5'" in str(error)


def test_tables_for_decimal_commas_have_them_and_dates_that_spreadsheets_save_with_points_are_read(book, tmp_path):
    book.put(Defect(PANES[0], "crack", 3, "2026-03-31", u=0.25, v=0.5))
    book.put(Attribute(PANES[0], "thickness", 28.5, "number", "mm"))
    attributes, _, defects, *_ = write_tables(book, tmp_path / "tables", semicolon=True)
    assert ";28,5;" in attributes.read_text("utf-8-sig")
    text = defects.read_text("utf-8-sig")
    assert ";3;2026-03-31;0,25;0,5;" in text
    defects.write_text(text.replace("2026-03-31", "1.4.2026"), "utf-8")
    before = contents(book)
    read_tables(book, [(defects, kind_of_table(defects))])
    (found,) = book.entries(Defect)
    assert (found.found_on, found.u) == ("2026-04-01", 0.25)
    assert contents(book) != before
    error = refusal(book, table(tmp_path, "defects", "name;kind;severity;found_on\r\nA-0000;crack;3;31.02.2026\r\n"))
    assert "expected a date such as 2026-03-31, got '2026-02-31'" in str(error)
    error = refusal(book, table(tmp_path, "defects", "name;kind;severity;found_on\r\nA-0000;crack;3;03/04/2026\r\n"))
    assert "expected a date such as 2026-03-31" in str(error)


def test_keys_replace_and_their_absence_adds(book, tmp_path):
    kept = book.put(Inspection(PANES[0], "2026-01-01", "Ann", note=NASTY[0]))
    head = "global_id,date,inspector,note,key\r\n"
    path = table(
        tmp_path, "inspections", f"{head}{PANES[0]},2026-01-01,Bob,,{kept.key}\r\n{PANES[1]},2026-02-01,,,\r\n"
    )
    assert take(book, path)[0].n_changed == 2
    assert contents(book) >= {replace(kept, inspector="Bob", note="")}
    assert len(book.entries(Inspection)) == 2
    assert history(book)[0].what == "import of inspections.csv"
    book.undo()
    assert contents(book) == {kept}
    path = table(tmp_path, "inspections", f"{head}{PANES[1]},2026-01-01,Bob,,{kept.key}\r\n")
    assert f"line 2, column 'key': the inspection {kept.key} belongs to another object" in str(refusal(book, path))
    path = table(
        tmp_path, "inspections", f"{head}{PANES[0]},2026-01-01,a,,{kept.key}\r\n{PANES[0]},2026-01-01,b,,{kept.key}\r\n"
    )
    assert "stands in line 2 already" in str(refusal(book, path))


def test_every_wrong_cell_is_named_with_its_line_and_column(book, tmp_path):
    lines = [
        "name,kind,severity,found_on,u,v,outline,repaired_on",
        "A-0000,crack,3,2026-01-01,0.5,0.5,,",
        '"A-0000","two\r\nlines",9,2026-01-01,,,,',
        "nobody,crack,3,31.1.2026,,,,",
        "A-0000,,3.5,2026-01-01,0.5,x,[1],",
        "A-0000,crack,3,2026-01-01,0.5,1.5,,",
        "A-0000,crack,3,2026-01-01,,,,2026-01-02",
    ]
    error = refusal(book, table(tmp_path, "defects", "\r\n".join(lines)))
    assert isinstance(error, TableError)
    assert [problem.partition(":")[0] for problem in error.problems] == [
        "line 3, column 'severity'",
        "line 5, column 'name'",
        "line 6, column 'kind'",
        "line 6, column 'severity'",
        "line 6, column 'v'",
        "line 6, column 'outline'",
        "line 7, column 'u, v'",
        "line 8, column 'repaired_on'",
    ]
    many = "\r\n".join([lines[0], *["A-0000,crack,9,2026-01-01,,,,"] * 50])
    error = refusal(book, table(tmp_path, "defects", many))
    assert (len(error.problems), str(error).count("; line"), "and 30 more" in str(error)) == (50, 19, True)


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("defects", b"", "the table is empty"),
        ("defects", b"\xff\xfe\x00", "line 1: expected UTF-8"),
        ("defects", b"name,kind\r\nA-0000,\xe4\r\n", "line 2: expected UTF-8"),
        ("defects", "a,b\r\n1,2\r\n", "line 1: expected a column 'global_id' or 'name'"),
        ("defects", "name,kind,kind\r\n", "the column 'kind' occurs twice"),
        ("defects", "name,kind,severity,found_on,colour\r\n", "there is no column 'colour'"),
        ("defects", "name,kind\r\n", "the column 'severity' is missing"),
        (
            "defects",
            "name,kind,severity,found_on\r\nA-0000,crack,3\r\n",
            "line 2: expected 4 cells parted by ',', found 3",
        ),
        ("defects", 'name,kind,severity,found_on\r\n"A-0000,crack\r\n', "line 2: is no CSV"),
        ("defects", "name,kind,severity,found_on\r\nA-0000,a\x00b,3,2026-01-01\r\n", "column 'kind': character 2"),
        (
            "defects",
            f"name,kind,severity,found_on\r\nA-0000,{'x' * 200_000},3,2026-01-01\r\n",
            "is no CSV (field larger",
        ),
        ("attributes", "name,thickness [m]\r\n", "line 1"),
        ("attributes", "name,a (colour)\r\n", "types are text, number, date, yes/no"),
        ("attributes", "name,a [b\r\n", "expected heads such as"),
        ("attributes", "name,a,a (number)\r\nA-0000,x,1\r\n", "line 2, column 'key': 'a' stands in line 2 already"),
        ("attributes", "name,safe (yes/no)\r\nA-0000,maybe\r\n", "expected yes or no, got 'maybe'"),
        ("attributes", "name,installed_on\r\nA-0000,2026\r\n", "column 'installed_on': expected a date"),
        ("attributes", "global_id,name,maker\r\n,,x\r\n", "column 'global_id': expected a GlobalId, or a name"),
        ("attributes", "global_id,maker\r\n0000000000000000000000,x\r\n", "expected an object of the model"),
    ],
)
def test_tables_that_are_wrong_change_nothing(book, tmp_path, name, text, words):
    path = table(tmp_path, name, text)
    if words == "line 1":
        assert take(book, path)[0].n_changed == 0, "a head alone is no value"
        assert "expected a number in mm" in str(refusal(book, table(tmp_path, name, f"{text}A-0000,1\r\n")))
    else:
        assert words in str(refusal(book, path))


def test_names_that_two_panes_have_need_the_global_id(book, tmp_path):
    rows = model()
    book.set_objects([*rows[:4], replace(rows[4], name="A-0000"), rows[5]])
    path = table(tmp_path, "attributes", "name,maker\r\nA-0000,x\r\n")
    assert "several objects have the name 'A-0000'" in str(refusal(book, path))
    take(book, table(tmp_path, "attributes", f"global_id,name,maker\r\n{PANES[1]},A-0000,x\r\n"))
    assert book.entries(Attribute, PANES[1])[0].value == "x"


def test_a_folder_of_tables_is_taken_as_one(book, tmp_path):
    inspection = Inspection(PANES[0], "2026-01-01", key=PANES[2])
    defect = Defect(PANES[0], "crack", 3, "2026-01-01", inspection=inspection.key, key=PANES[1])
    book.put(inspection)
    book.put(defect)
    paths = write_tables(book, tmp_path / "tables")
    book.undo()
    book.undo()
    broken = paths[2].read_bytes().replace(b"crack,3", b"crack,7")
    good = paths[2].read_bytes()
    paths[2].write_bytes(broken)
    with pytest.raises(TableError, match="severity"):
        read_tables(book, [(path, kind_of_table(path)) for path in paths])
    assert contents(book) == set()
    paths[2].write_bytes(good)
    read_tables(book, [(path, kind_of_table(path)) for path in reversed(paths)])
    assert contents(book) == {inspection, defect}
    with pytest.raises(InputError, match="expected a name of attributes"):
        kind_of_table(tmp_path / "notes.csv")

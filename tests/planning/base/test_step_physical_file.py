"""Names in IFC files that nobody has given."""

import pytest

from planning.base.step_physical_file import real_name

NONE = [
    *("", "  ", "$", "*", "-", "Unnamed", "UNNAMED", "<Unnamed>", "unnamed_3", "Untitled 2", "Default", "Default.1"),
    *("Undefined", "not defined", "NOTDEFINED", "Unknown", "n/a", "Project Number", "project_number", "Project Status"),
    *("Building", "Default Building", "Building Name", "IfcBuilding", "Enter address here", "Nombre de proyecto"),
    *("Unbenannt", "Gebäude", "Projektnummer", "Bâtiment", "Sans nom", "未命名", "Здание"),
]


@pytest.mark.parametrize("text", NONE)
def test_placeholders_of_programs_are_no_names(text):
    assert real_name(text) == ""
    assert real_name(text, None, " Haus 7 ") == "Haus 7"


@pytest.mark.parametrize(
    "text",
    [
        "Office A",
        "Building 12",
        "Haus 7",
        "4018106",
        "Default Street 5",
        "Project Tower",
        "Nameless Hall",
        "Site 3 North",
    ],
)
def test_names_that_somebody_gave_stay(text):
    assert real_name(text) == text

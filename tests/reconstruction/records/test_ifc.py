"""IFC: into copies that stay as they are but for our sets, into new files, and back; made files and real ones."""

import contextlib
import gc
from dataclasses import replace

import ifcopenshell
import ifcopenshell.guid
import ifcopenshell.util.element
import ifcopenshell.validate
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from planning.base.errors import InputError, OperationCancelled
from planning.geo.enu import enu_from_geodetic, geodetic_from_enu
from planning.geo.frames import Origin
from planning.site.bundled import SCENES, write_scene
from planning.site.file import read_site
from planning.site.importing.importer import import_site
from planning.site.importing.options import ImportOptions
from reconstruction.records.book import RecordBook, make_book
from reconstruction.records.entries import KINDS, Attribute, Defect, Document, Inspection, Maintenance
from reconstruction.records.ifc.extract import OUR_SETS, extract, property_sets, sets_of
from reconstruction.records.ifc.importing import (
    edited,
    entries_of_element,
    extend_copy,
    read_ifc_records,
    read_properties,
)
from reconstruction.records.ifc.new import extension, write_new_ifc
from reconstruction.records.objects import ObjectRow, site_objects
from tests.planning.facade_shapes import SHAPES, facades, normal
from tests.reconstruction.records.cases import NASTY, ORIGIN, PANES, contents, entries, model, new_book

SCHEMAS = ("IFC2X3", "IFC4", "IFC4X3")


class Made:
    """An IFC file of one curtain wall with plates that have given GlobalIds."""

    def __init__(self, schema="IFC4", ids=PANES):
        self.file = ifcopenshell.file(schema=schema)
        self.history = self.make("IfcOwnerHistory", self._user(), self._program(), None, "ADDED", None, None, None, 0)
        metre = self.make("IfcSIUnit", UnitType="LENGTHUNIT", Prefix="MILLI", Name="METRE")
        project = self.rooted("IfcProject", Name="P", UnitsInContext=self.make("IfcUnitAssignment", [metre]))
        assert project
        self.wall = self.rooted("IfcCurtainWall", Name="wall")
        self.plates = [self.rooted("IfcPlate", GlobalId=guid, Name=f"plate {i}; 'x'") for i, guid in enumerate(ids)]
        self.rooted("IfcRelAggregates", RelatingObject=self.wall, RelatedObjects=self.plates)

    def make(self, kind, *values, **fields):
        return self.file.create_entity(kind, *values, **fields)

    def rooted(self, kind, **fields):
        return self.make(kind, **{"GlobalId": ifcopenshell.guid.new(), "OwnerHistory": self.history, **fields})

    def _user(self):
        return self.make("IfcPersonAndOrganization", self.make("IfcPerson"), self.make("IfcOrganization", Name="o"))

    def _program(self):
        return self.make("IfcApplication", self.make("IfcOrganization", Name="o"), "1", "made", "made")

    def set(self, element, name, **values):
        properties = [self.single(key, value) for key, value in values.items()]
        added = self.rooted("IfcPropertySet", Name=name, HasProperties=properties)
        self.rooted("IfcRelDefinesByProperties", RelatedObjects=[element], RelatingPropertyDefinition=added)
        return added

    def single(self, name, value):
        kind, content = value if isinstance(value, tuple) else ("IfcLabel", value)
        nominal = None if content is None else self.make(kind, content)
        return self.make("IfcPropertySingleValue", Name=name, NominalValue=nominal)

    def material(self, element, material):
        self.rooted("IfcRelAssociatesMaterial", RelatedObjects=[element], RelatingMaterial=material)

    def write(self, path):
        self.file.write(str(path))
        return path


def findings(path, express_rules=False):
    log = ifcopenshell.validate.json_logger()
    ifcopenshell.validate.validate(ifcopenshell.open(str(path)), log, express_rules=express_rules)
    return [(statement["message"], str(statement["instance"])) for statement in log.statements]


def extended(path, out, sets, known):
    """What `extend_copy` does, in this process: the one of its own takes a second to start."""
    found = extension(path, sets, known)
    out.write_bytes(edited(path.read_bytes(), found.lines, found.replaced))
    assert len(list(ifcopenshell.open(str(out)))) == found.n_instances
    return found


def taken(book, path):
    """What `read_ifc_records` takes, likewise."""
    names = {row.global_id: row.name for row in book.objects()}
    notes, n_changed, elements = [], 0, extract(path, frozenset(names)).elements
    with book.changing("import") as changes:
        for element in elements:
            for entry in entries_of_element(element, names[element.global_id], False, notes):
                changes.put(entry)
        n_changed = changes.n_changed
    return len(elements), n_changed, notes


def element_of(path, global_id, known=frozenset(PANES)):
    return next(each for each in extract(path, known).elements if each.global_id == global_id)


def read(element):
    notes = []
    return {
        e.name if isinstance(e, Attribute) else type(e): e for e in entries_of_element(element, "x", False, notes)
    }, notes


@pytest.fixture
def book(tmp_path):
    with new_book(tmp_path) as opened:
        yield opened


def filled(book):
    """One entry of each kind, with texts that STEP has to write in its own way."""
    inspection = book.put(Inspection(PANES[0], "2026-01-01", "Ann; 'B'", "drone", "crack", NASTY[0]))
    book.put(Inspection(PANES[0], "2026-02-01", note="裂缝 */ ; /* #1=("))
    book.put(Defect(PANES[0], "crack", 3, "2026-01-01", 0.25, 0.5, ((0, 0), (1, 0), (1, 1)), inspection=inspection.key))
    book.put(Maintenance(PANES[1], "2026-01-03", "washed\r\n\ttwice", "Bob", 12.5, "EUR", "2027-01-03"))
    book.put(Document(PANES[1], "sheet", "https://example.org/a?b=c&d", "pdf", "0" * 64))
    for attribute in (
        Attribute(PANES[0], "maker", "Glas AG"), Attribute(PANES[0], "material", "Floatglas 𝔘"),
        Attribute(PANES[0], "warranty_until", "2030-12-31", "date"), Attribute(PANES[1], "tempered", True, "yes/no"),
        Attribute(PANES[1], "u-value", 1.1, "number", "W/m²K"), Attribute(PANES[1], "thickness", 28.5, "number", "mm"),
        Attribute(model()[1].global_id, "product", "<b>F1</b>"),
    ):  # fmt: skip
        book.put(attribute)


@pytest.mark.long
@pytest.mark.parametrize("schema", SCHEMAS)
def test_copies_get_our_sets_and_stay_as_they_are(book, tmp_path, schema):
    made = Made(schema)
    made.set(made.plates[0], "Pset_PlateCommon", Reference="it's; a #9= trap")
    original = made.write(tmp_path / "a.ifc")
    filled(book)
    known = frozenset(row.global_id for row in book.objects())
    found = extended(original, tmp_path / "b.ifc", property_sets(book), known)
    assert (set(found.extended), set(found.missing)) == ({PANES[0], PANES[1]}, {model()[1].global_id})
    before, after = original.read_bytes(), (tmp_path / "b.ifc").read_bytes()
    start = after.index(found.lines[0].encode())
    added = len(after) - len(before)
    assert after[:start] + after[start + added :] == before
    assert findings(tmp_path / "b.ifc") == findings(original)
    copy = ifcopenshell.open(str(tmp_path / "b.ifc"))
    sets = ifcopenshell.util.element.get_psets(copy.by_guid(PANES[0]))
    assert {name for name in sets if name in OUR_SETS} == {
        "Pset_ReflightAttributes", "Pset_ReflightInspection", "Pset_ReflightDefects",
    }  # fmt: skip
    assert sets["Pset_PlateCommon"]["Reference"] == "it's; a #9= trap"
    assert sets["Pset_ReflightInspection"]["LatestDate"] == "2026-02-01"
    assert (
        sets["Pset_ReflightDefects"]["Defect 0001"] == "crack; severity 3; found 2026-01-01; open; at u 0.250, v 0.500"
    )
    # Once more with other records, then without any: what is not ours never changes.
    book.put(Inspection(PANES[2], "2026-03-01"))
    extended(tmp_path / "b.ifc", tmp_path / "c.ifc", property_sets(book), known)
    text = (tmp_path / "c.ifc").read_bytes()
    assert text.count(b"'Pset_ReflightInspection'") == 2
    extended(tmp_path / "c.ifc", tmp_path / "d.ifc", {}, known)
    assert (tmp_path / "d.ifc").read_bytes() == before


@pytest.mark.slow
def test_the_process_of_its_own_does_the_same(book, tmp_path):
    original = Made().write(tmp_path / "a.ifc")
    filled(book)
    sets, known = property_sets(book), frozenset(PANES)
    found = extend_copy(original, tmp_path / "b.ifc", sets, known)
    assert found == extended(original, tmp_path / "c.ifc", sets, known)
    assert (tmp_path / "b.ifc").read_bytes() == (tmp_path / "c.ifc").read_bytes()
    with pytest.raises(InputError, match="would replace"):
        extend_copy(original, original, sets, known)
    kept = contents(book)
    assert read_ifc_records(book, tmp_path / "b.ifc").n_changed == 0
    assert contents(book) == kept


@pytest.mark.long
@pytest.mark.parametrize("schema", SCHEMAS)
@settings(max_examples=4, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])
@given(found=st.lists(entries, max_size=6))
def test_entries_come_back_from_the_sets_of_every_schema(tmp_path_factory, schema, found):
    folder = tmp_path_factory.mktemp("a")
    with new_book(folder) as book:
        for entry in found:
            book.put(entry)
        kept, sets = contents(book), property_sets(book)
    path = Made(schema).write(folder / "a.ifc")
    copy, notes = folder / "b.ifc", []
    extended(path, copy, sets, frozenset(PANES))
    back = {e for each in extract(copy, frozenset(PANES)).elements for e in entries_of_element(each, "x", False, notes)}
    assert (back, notes) == (kept, [])


def test_sets_that_others_share_are_only_left(tmp_path):
    made = Made(ids=(*PANES, "0" * 22))
    shared = made.set(made.plates[0], "Pset_ReflightInspection", LatestDate="2020-01-01")
    shared.DefinesOccurrence[0].RelatedObjects = [made.plates[0], made.plates[3]]
    path = made.write(tmp_path / "a.ifc")
    sets = {PANES[0]: sets_of([Inspection(PANES[0], "2026-01-01", key=PANES[1])])}
    found = extended(path, tmp_path / "b.ifc", sets, frozenset(PANES))
    back = ifcopenshell.open(str(tmp_path / "b.ifc"))
    assert len(list(back)) == found.n_instances
    values = [
        ifcopenshell.util.element.get_psets(back.by_guid(guid))["Pset_ReflightInspection"]["LatestDate"]
        for guid in (PANES[0], "0" * 22)
    ]
    assert values == ["2026-01-01", "2020-01-01"]


@pytest.mark.parametrize("schema", SCHEMAS)
def test_standard_sets_become_attributes_and_inspections(tmp_path, schema):
    made = Made(schema)
    plate = made.plates[0]
    kind = "IfcPlateType"
    plate_type = made.rooted(kind, Name="type", PredefinedType="CURTAIN_PANEL")
    made.rooted("IfcRelDefinesByType", RelatedObjects=[plate], RelatingType=plate_type)
    properties = [made.single("Manufacturer", "Type AG"), made.single("ModelLabel", "X1"), made.single("Nothing", None)]
    plate_type.HasPropertySets = [
        made.rooted("IfcPropertySet", Name="Pset_ManufacturerTypeInformation", HasProperties=properties)
    ]
    made.set(plate, "Pset_ManufacturerTypeInformation", Manufacturer="Own AG")
    made.set(
        plate,
        "Pset_PlateCommon",
        IsExternal=("IfcBoolean", True),
        ThermalTransmittance=("IfcThermalTransmittanceMeasure", 1.1),
    )
    made.set(
        plate,
        "Pset_Condition",
        AssessmentDate="2025-05-05T10:00:00",
        AssessmentCondition="good",
        AssessmentDescription="",
    )
    made.set(plate, "Pset_Warranty", WarrantyEndDate="2031-01-01")
    made.set(plate, "Pset_Custom", Secret="x")
    made.set(made.wall, "Pset_ManufacturerTypeInformation", Manufacturer="Wall AG", ModelLabel="W")
    made.set(made.wall, "Pset_CurtainWallCommon", Reference="W")
    layers = [
        made.make("IfcMaterialLayer", made.make("IfcMaterial", Name="Glas"), 6.0),
        made.make("IfcMaterialLayer", made.make("IfcMaterial", Name="Luft"), 16.0),
    ]
    made.material(plate, made.make("IfcMaterialLayerSet", layers))
    path = made.write(tmp_path / "a.ifc")
    found, notes = read(element_of(path, PANES[0]))
    inspection = found.pop(Inspection)
    assert (inspection.date, inspection.result, inspection.note) == ("2025-05-05", "good", "")
    assert {name: entry.value for name, entry in found.items()} == {
        "maker": "Own AG", "product": "X1", "material": "Glas, Luft", "thickness": 22.0, "warranty_until": "2031-01-01",
        "Pset_PlateCommon.IsExternal": True, "Pset_PlateCommon.ThermalTransmittance": 1.1,
    }  # fmt: skip
    assert found["Pset_PlateCommon.ThermalTransmittance"].unit == "W/m²K"
    assert notes == []
    others, _ = read(element_of(path, PANES[1]))
    assert {name: entry.value for name, entry in others.items()} == {"maker": "Wall AG", "product": "W"}


def test_parts_speak_for_a_window_unless_they_are_objects_themselves(tmp_path):
    made = Made(ids=PANES[:2])
    window = made.rooted("IfcWindow", GlobalId=PANES[2], Name="w")
    glass = made.rooted("IfcPlate", Name="glass")
    made.rooted("IfcRelAggregates", RelatingObject=window, RelatedObjects=[glass])
    made.material(glass, made.make("IfcMaterial", Name="Glas"))
    path = made.write(tmp_path / "a.ifc")
    assert read(element_of(path, PANES[2]))[0]["material"].value == "Glas"
    known = frozenset((*PANES, glass.GlobalId))
    assert read(element_of(path, PANES[2], known))[0] == {}
    assert read(element_of(path, glass.GlobalId, known))[0]["material"].value == "Glas"


def test_values_that_fit_nowhere_are_left_out_and_told(book, tmp_path):
    made = Made()
    made.set(made.plates[0], "Pset_Warranty", WarrantyEndDate="when it breaks")
    made.set(made.plates[0], "Pset_PlateCommon", Reference="x" * 15_000, Status="new")
    made.set(made.plates[1], "Pset_ReflightDefects", **{"Defect 0001": "crack"})
    broken = made.set(made.plates[1], "Pset_ReflightInspection", LatestDate="soon", A="x")
    broken.HasProperties[1].Description = '{"global_id": "' + PANES[0] + '", "date": "2026-13-01"}'
    path = made.write(tmp_path / "a.ifc")
    n_objects, n_changed, notes = taken(book, path)
    assert (n_objects, n_changed, len(notes)) == (3, 1, 4)
    assert "A-0000: Pset_Warranty.WarrantyEndDate: warranty_until: expected a date" in " ".join(notes)
    assert contents(book) == {book.entries(Attribute)[0]}
    assert book.entries(Attribute)[0].value == "new"


def test_records_in_a_file_cannot_name_another_object_than_their_own(tmp_path):
    made = Made()
    trap = made.set(made.plates[0], "Pset_ReflightInspection", A="x")
    trap.HasProperties[0].Description = (
        '{"global_id": "' + PANES[1] + '", "date": "2026-01-01", "key": "' + PANES[2] + '"}'
    )
    found, notes = read(element_of(made.write(tmp_path / "a.ifc"), PANES[0]))
    assert (found[Inspection].global_id, notes) == (PANES[0], [])


@pytest.fixture(scope="module")
def new_file(tmp_path_factory):
    """A bundled site as a new IFC file, with its site and its book."""
    return written(tmp_path_factory.mktemp("new"), "roof")


def written(folder, name):
    site = read_site(write_scene(name, folder))
    rows = site_objects(site.site)
    with new_book(folder, rows) as book:
        panes = [row.global_id for row in rows if row.layer == "element"]
        book.put(Inspection(panes[0], "2026-01-01", note=NASTY[0]))
        book.put(Defect(panes[0], "crack", 3, "2026-01-01", 0.25, 0.5))
        book.put(Attribute(panes[0], "thickness", 28.0, "number", "mm"))
        book.put(Attribute(rows[1].global_id, "maker", "Wall AG"))
        book.put(Attribute(panes[1], "warranty_until", "2030-01-01", "date"))
        assert write_new_ifc(book, folder / "new.ifc", site.building) == ()
    return folder / "new.ifc", site, book


def test_new_files_have_the_types_of_the_schema(new_file):
    assert findings(new_file[0]) == []


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning")
def test_new_files_keep_the_rules_of_the_schema(new_file):
    # IfcOpenShell leaves the files of its rules open.
    assert findings(new_file[0], express_rules=True) == []
    gc.collect()


def test_new_files_hold_the_same_panes_as_ifcopenshell_sees_them(new_file):
    path, site, _ = new_file
    model = ifcopenshell.open(str(path))
    assert (len(model.by_type("IfcCurtainWall")), len(model.by_type("IfcPlate"))) == (1, 32)
    assert len(model.by_type("IfcMapConversion")) == 0
    plate = model.by_guid(site_objects(site.site)[2].global_id)
    points = np.array(plate.Representation.Representations[0].Items[0].Coordinates.CoordList)
    assert points[:4].tolist() == [list(corner) for corner in site.site.panels[0].corners_enu_m]
    np.testing.assert_allclose(np.linalg.norm(points[4:] - points[:4], axis=1), 0.028, atol=1e-9)
    sets = ifcopenshell.util.element.get_psets(plate)
    assert sets["Pset_ReflightDefects"]["Defect 0001"].startswith("crack; severity 3")
    wall = ifcopenshell.util.element.get_psets(model.by_type("IfcCurtainWall")[0])
    assert wall["Pset_ManufacturerTypeInformation"]["Manufacturer"] == "Wall AG"


@pytest.mark.parametrize("origin", [None, ORIGIN])
@pytest.mark.parametrize("name", ["office", "library", "court"])
@pytest.mark.slow
def test_new_files_of_all_kinds_of_facades_import_as_the_same_site(tmp_path, name, origin):
    path, site, _ = written(tmp_path, name)
    check_import(path, site, origin)


@pytest.mark.slow
def test_new_files_import_as_the_same_site(new_file):
    path, site, _ = new_file
    check_import(path, site, None)


@pytest.mark.slow
def test_panes_of_new_files_face_where_they_did_with_no_building_behind_them(tmp_path):
    parts = [facades(shape, (60.0 * k, 0.0), f"{k}") for k, shape in enumerate(SHAPES)]
    site = replace(SCENES["office"]().site, facades=tuple(facade for part in parts for facade in part))
    rows = site_objects(site)
    with new_book(tmp_path, rows) as book:
        write_new_ifc(book, tmp_path / "new.ifc")
    imported = import_site(tmp_path / "new.ifc", ImportOptions(ground_z=0.0))
    found = {panel.source_id: panel for panel in imported.model.site.panels}
    expected = {row.global_id: row for row in rows if row.layer == "element"}
    assert found.keys() == expected.keys()
    assert all(normal(found[key].corners_enu_m) @ normal(row.corners_enu_m) > 0.99 for key, row in expected.items())
    assert not any("both sides" in note or "turned around" in note for note in imported.notes)


def check_import(path, site, origin):
    """The same panes, by their GlobalIds, within a millimetre."""
    back = import_site(path, ImportOptions(origin=origin)).model.site
    expected = {row.global_id: np.array(row.corners_enu_m) for row in site_objects(site.site) if row.layer == "element"}
    found = {panel.source_id: np.array(panel.corners_enu_m) for panel in back.panels}
    assert found.keys() == expected.keys()
    for global_id, corners in found.items():
        here = enu_from_geodetic(site.site.origin, *geodetic_from_enu(back.origin, corners))
        assert np.abs(here - expected[global_id]).max() < 0.001


def test_new_files_bring_their_records_back(new_file, tmp_path):
    path, site, book = new_file
    make_book(tmp_path / "again.sqlite")
    with RecordBook(tmp_path / "again.sqlite", True, "Lee") as again, RecordBook(book.path) as before:
        again.set_objects(site_objects(site.site))
        assert taken(again, path)[2] == []
        assert contents(again) == contents(before)
        assert taken(again, path)[1] == 0


def test_panes_that_are_warped_or_lack_corners_and_places_unknown(tmp_path):
    rows = model(2)
    warped = ((0.0, 0.0, 0.0), (1.5, 0.0, 0.0), (1.5, 0.03, 3.0), (0.0, 0.0, 3.0))
    rows[3] = ObjectRow(rows[3].global_id, "element", rows[3].parent, "warped", warped)
    rows[4] = ObjectRow(rows[4].global_id, "element", None, "alone")
    make_book(tmp_path / "b.sqlite")
    with RecordBook(tmp_path / "b.sqlite", True, "Chan") as book:
        with pytest.raises(InputError, match="holds no objects yet"):
            write_new_ifc(book, tmp_path / "a.ifc")
        book.set_objects(rows[:2])
        with pytest.raises(InputError, match="there are no panels"):
            write_new_ifc(book, tmp_path / "a.ifc")
        assert not (tmp_path / "a.ifc").exists()
        book.set_objects(rows)
        notes = write_new_ifc(book, tmp_path / "a.ifc")
    assert [note[:25] for note in notes] == ["the place on earth is not", "the building behind the p"]
    assert findings(tmp_path / "a.ifc") == []
    model_ = ifcopenshell.open(str(tmp_path / "a.ifc"))
    assert model_.by_type("IfcSite")[0].RefLatitude is None
    assert {each.is_a() for each in model_.by_type("IfcElement")} == {
        "IfcCurtainWall",
        "IfcBuildingElementProxy",
        "IfcPlate",
    }


@pytest.mark.slow
def test_hostile_and_broken_files_are_refused(book, tmp_path):
    path = tmp_path / "a.ifc"
    for content, words in (
        (b"", "expected an IFC file"),
        (b"PK\x03\x04", "expected an IFC file"),
        (b"ISO-10303-21;\nHEADER;", "is cut off"),
    ):
        path.write_bytes(content)
        with pytest.raises(InputError, match=words):
            read_ifc_records(book, path)
    with pytest.raises(InputError, match="there is no such file"):
        read_ifc_records(book, tmp_path / "missing.ifc")
    path.write_bytes(b"ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('IFC9'));\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n")
    with pytest.raises(InputError, match="cannot be read"):
        read_ifc_records(book, path)
    text = Made().write(path).read_text()
    path.write_text(text.replace("IFCPLATE('", "IFCPLATE(#1,'", 1))
    before = contents(book)
    with contextlib.suppress(InputError):
        taken(book, path)
    assert contents(book) == before


def test_reading_can_be_cancelled(tmp_path):
    class Cancelled:
        def report(self, stage, done, total):
            raise OperationCancelled

    path = Made().write(tmp_path / "a.ifc")
    with pytest.raises(OperationCancelled):
        read_properties(path, frozenset(PANES), Cancelled())


def test_semicolons_in_texts_and_comments_end_no_instance():
    content = (
        b"ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n#1=A('it''s; #2=B();');/* #2=C(); */\n#2 = B(#1,\n 'x;');\n"
        b"#12=C(#2);\nENDSEC;\nEND-ISO-10303-21;\n"
    )
    assert edited(content, (), {}) == content
    gone = edited(content, ("#13=D();",), {2: "", 12: "#12=E();"})
    assert gone == content.replace(b"#2 = B(#1,\n 'x;');\n", b"").replace(b"#12=C(#2);\n", b"#12=E();\n#13=D();\n")
    with pytest.raises(InputError, match="not understood"):
        edited(content, (), {3: ""})
    with pytest.raises(InputError, match="do not end"):
        edited(b"ISO-10303-21;\nEND-ISO-10303-21;\n", (), {})


@pytest.mark.parametrize(
    ("name", "n_panes"), [("curtain_wall_small", 21), pytest.param("office_a", 69, marks=pytest.mark.slow)]
)
def test_real_files_give_attributes_and_take_records(shared_data, tmp_path, name, n_panes):
    path = shared_data / "bim" / f"{name}.ifc"
    ids = [each.GlobalId for kind in ("IfcPlate", "IfcWindow") for each in ifcopenshell.open(str(path)).by_type(kind)]
    assert len(ids) == n_panes
    rows = [ObjectRow(guid, "element", None, f"A-{i:04d}") for i, guid in enumerate(ids)]
    with new_book(tmp_path, rows) as book:
        n_objects, _, notes = taken(book, path)
        assert (n_objects, notes) == (n_panes, [])
        external = [e.value for e in book.entries(Attribute) if e.name.endswith("Common.IsExternal")]
        assert len(external) == n_panes
        if name == "curtain_wall_small":
            assert {e.value for e in book.entries(Attribute) if e.name == "material"} >= {"Cristal"}
        book.put(Inspection(ids[0], "2026-01-01", note=NASTY[0]))
        known = frozenset(ids)
        found = extended(path, tmp_path / "b.ifc", property_sets(book), known)
        before, after = path.read_bytes(), (tmp_path / "b.ifc").read_bytes()
        start, added = after.index(found.lines[0].encode()), len(after) - len(before)
        assert after[:start] + after[start + added :] == before
        kept = contents(book)
        for kind in KINDS:
            for entry in book.entries(kind.record):
                book.remove(entry)
        taken(book, tmp_path / "b.ifc")
        assert contents(book) == kept


def test_latitudes_are_written_to_a_millionth_of_a_second(tmp_path):
    from reconstruction.records.ifc.new import _angle

    for degrees in (22.3372, -33.999999999999, 0.0, -0.5, 179.99999999999, -71.059722):
        parts = _angle(degrees)
        back = sum(part / size for part, size in zip(parts, (1.0, 60.0, 3600.0, 3.6e9), strict=True))
        assert abs(back - degrees) <= 0.5 / 3.6e9 + 1e-12
        assert len({part < 0 for part in parts if part}) <= 1
        assert all(abs(part) < limit for part, limit in zip(parts[1:], (60, 60, 1_000_000), strict=True))
    assert Origin(22.0, 114.0, 1.0)

"""Entries: what they refuse, and that every refusal names the field."""

import math

import pytest

from planning.base.errors import InputError
from planning.geo.frames import Origin
from planning.site.records import Airspace, Facade, Panel, Site
from reconstruction.records.entries import KINDS, Attribute, Defect, Document, Inspection, Maintenance, global_id_of
from reconstruction.records.objects import ObjectRow, check_objects, site_objects
from tests.reconstruction.records.cases import CORNERS, PANES, model

PANE = PANES[0]


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Inspection("x", "2026-01-01"), "global_id: expected an IFC GlobalId"),
        (lambda: Inspection(PANE, "2026-02-30"), "date: expected a date such as"),
        (lambda: Inspection(PANE, "31.3.2026"), "date: expected a date such as"),
        (lambda: Inspection(PANE, "20260331"), "date: expected a date such as"),
        (
            lambda: Inspection(PANE, "2026-01-01", note="x" * 10_001),
            "note: expected at most 10000 characters, got 10001",
        ),
        (lambda: Inspection(PANE, "2026-01-01", inspector="x" * 201), "inspector: expected at most 200"),
        (lambda: Inspection(PANE, "2026-01-01", note="a\x00b"), r"note: character 2 is a control character \(U\+0000"),
        (lambda: Inspection(PANE, "2026-01-01", note="a\x1b[2J"), "note: character 2 is a control"),
        (lambda: Inspection(PANE, "2026-01-01", note="\ud800"), "note: character 1 is a control"),
        (lambda: Inspection(PANE, "2026-01-01", note=7), "note: expected text, got 7"),
        (lambda: Defect(PANE, " ", 3, "2026-01-01"), "kind: expected a text"),
        (lambda: Defect(PANE, "crack", 6, "2026-01-01"), "severity: expected 1, 2, 3, 4, 5, got 6"),
        (lambda: Defect(PANE, "crack", True, "2026-01-01"), "severity: expected"),
        (lambda: Defect(PANE, "crack", 3, "2026-01-01", u=0.5), "u, v: expected both"),
        (
            lambda: Defect(PANE, "crack", 3, "2026-01-01", u=0.5, v=1.01),
            "u, v: expected a number from 0 to 1, got 1.01",
        ),
        (lambda: Defect(PANE, "crack", 3, "2026-01-01", u=0.5, v=math.nan), "u, v: expected a number"),
        (lambda: Defect(PANE, "crack", 3, "2026-01-01", outline=((0, 0), (1, 1))), "outline: expected none or 3"),
        (
            lambda: Defect(PANE, "crack", 3, "2026-01-01", outline=((0, 0), (1, 1), (0, 2))),
            "outline: expected a number",
        ),
        (lambda: Defect(PANE, "crack", 3, "2026-01-01", picture="../x.png"), "picture: expected"),
        (lambda: Defect(PANE, "crack", 3, "2026-01-01", status="gone"), "status: expected open, repaired, got 'gone'"),
        (lambda: Defect(PANE, "crack", 3, "2026-01-01", repaired_on="2026-01-02"), "repaired_on: expected none"),
        (lambda: Maintenance(PANE, "2026-01-01", "washed", cost=-1, currency="EUR"), "cost: expected a number from 0"),
        (lambda: Maintenance(PANE, "2026-01-01", "washed", cost=math.inf, currency="EUR"), "cost: expected a number"),
        (lambda: Maintenance(PANE, "2026-01-01", "washed", cost=5), "currency: expected three letters"),
        (lambda: Maintenance(PANE, "2026-01-01", "washed", currency="EUR"), "currency: expected three letters"),
        (lambda: Maintenance(PANE, "2026-01-01", "washed", next_due="soon"), "next_due: expected a date"),
        (lambda: Document(PANE, "sheet", "file:///etc/passwd"), "place: expected an address"),
        (lambda: Document(PANE, "sheet", "javascript:alert(1)"), "place: expected an address"),
        (lambda: Document(PANE, "sheet", "..\\x.pdf"), "place: expected an address"),
        (lambda: Document(PANE, "sheet", "C:x.pdf"), "place: expected an address"),
        (lambda: Document(PANE, "sheet", "/etc/passwd"), "place: expected an address"),
        (lambda: Document(PANE, "sheet", "https://[x"), "place: expected an address"),
        (lambda: Document(PANE, "sheet", "a.pdf", sha256="ABC"), "sha256: expected 64"),
        (
            lambda: Attribute(PANE, "thickness", 28.0, "number", "m"),
            "thickness: expected a number in mm, got a number in m",
        ),
        (lambda: Attribute(PANE, "thickness", -1.0, "number", "mm"), "thickness: expected a number from 0"),
        (lambda: Attribute(PANE, "installed_on", "2026"), "installed_on: expected a date, got a text"),
        (lambda: Attribute(PANE, "width", 1.0, "number", "m"), "width: follows from the corners"),
        (lambda: Attribute(PANE, "name", "x"), "name: 'name' stands for the object"),
        (lambda: Attribute(PANE, "a [b]", "x"), "name: expected a name without brackets"),
        (lambda: Attribute(PANE, "a", "x", "colour"), "type: expected text, number, date, yes/no, got 'colour'"),
        (lambda: Attribute(PANE, "a", 1, "yes/no"), "a: expected yes or no"),
        (lambda: Attribute(PANE, "a", True, "number"), "a: expected a number"),
        (lambda: Attribute(PANE, "a", math.nan, "number"), "a: expected a number"),
        (lambda: Attribute(PANE, "a", ""), "a: expected a text"),
        (lambda: Attribute(PANE, "a", "x", key="y"), "key: expected an IFC GlobalId"),
    ],
)
def test_what_does_not_fit_is_refused_by_the_name_of_its_field(make, words):
    with pytest.raises(InputError, match=f"^{words}"):
        make()


def test_codes_of_the_search_index_and_its_fields_never_change():
    assert {kind.name: (kind.code, kind.texts) for kind in KINDS} == {
        "attribute": (1, ("name", "value", "unit")),
        "inspection": (2, ("inspector", "method", "result", "note", "date")),
        "defect": (3, ("kind", "note", "status", "found_on")),
        "maintenance": (4, ("work", "done_by", "note", "date")),
        "document": (5, ("title", "kind", "place")),
    }


def test_objects_have_parents_of_the_layer_above_and_ids_of_their_own():
    rows = model()
    assert check_objects(reversed(rows))[0].layer == "scene"
    with pytest.raises(InputError, match="another object has its GlobalId"):
        check_objects([*rows, rows[-1]])
    with pytest.raises(InputError, match=r"its parent .* is no object of the layer above 'element'"):
        check_objects([rows[0], *rows[3:]])
    with pytest.raises(InputError, match="expected finite metres"):
        ObjectRow(PANE, "element", None, "a", ((math.nan, 0.0, 0.0), *CORNERS[1:]))
    assert (rows[3].width_m, rows[3].height_m, rows[0].width_m) == (1.5, 3.0, None)


def test_panels_keep_their_global_ids_where_these_are_theirs_alone():
    own, shared = PANES[0], PANES[1]
    ids = (own, shared, shared, "window-7", None)
    panels = tuple(
        Panel(f"A-{i:04d}", tuple((x + 2.0 * i, y, z) for x, y, z in CORNERS), source) for i, source in enumerate(ids)
    )
    airspace = Airspace((-50.0, -50.0, 0.0), (50.0, 50.0, 50.0), 0.0)
    site = Site("s", Origin(0.0, 0.0, 0.0), (Facade("A", panels),), airspace, (0.0, -10.0, 0.0))
    rows = site_objects(site)
    assert [row.layer for row in rows] == ["scene", "component", *["element"] * 5]
    assert rows[2].global_id == own
    assert len({row.global_id for row in rows}) == 7
    assert shared not in {row.global_id for row in rows}
    assert rows == site_objects(site)
    assert rows[6].global_id == global_id_of("s", "panel A-0004")

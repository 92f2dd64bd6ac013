"""The session knows what is open, what was saved, and tells everybody of every change once."""

from dataclasses import replace
from pathlib import Path

import pytest

from groundstation.services.project.document import Document, Item, ItemKind, PlanEntry, exists
from groundstation.services.project.session import Session
from planning.planner import plan_flight
from planning.request import PlanRequest
from tests.planning.plan_cases import kiosk
from tests.planning.revision.cases import QUICK

FOLDER = Path("project")


@pytest.fixture(scope="module")
def entry():
    return PlanEntry("plan-1", "Plan 1", plan_flight(kiosk(), PlanRequest(n_views=4, greedy=QUICK)).plan)


@pytest.mark.slow
def test_a_change_is_published_once_with_before_and_after_and_can_be_undone(entry):
    session, heard = Session(), []
    session.subscribe(lambda before, after: heard.append((before, after)))
    first = session.document
    session.change("Plan", first.with_plan(entry))
    session.undo()
    session.undo()
    assert [after.current_plan_id for _, after in heard] == ["plan-1", ""]
    assert heard[0][0] is first
    assert session.document is first
    assert session.redo_label == "Plan"


def test_a_document_is_saved_until_it_changes_and_again_after_undo(entry):
    session = Session()
    assert session.is_saved
    session.change("Plan", session.document.with_plan(entry))
    assert not session.is_saved
    session.undo()
    assert session.is_saved


def test_looking_at_another_plan_leaves_a_saved_document_saved(entry):
    document = Document().with_plan(entry)
    session = Session(document, FOLDER)
    session.amend(replace(document, current_plan_id=""))
    assert session.is_saved
    session.amend(document.without_plan("plan-1"))
    assert not session.is_saved


def test_a_save_that_ends_after_another_edit_does_not_hide_the_edit(entry):
    session = Session()
    asked = session.document
    session.change("Plan", asked.with_plan(entry))
    session.saved(asked, replace(asked), FOLDER)
    assert not session.is_saved
    assert session.document.current is entry
    assert session.folder == FOLDER


def test_a_recovered_document_counts_as_not_saved(entry):
    session = Session()
    session.open(Document().with_plan(entry), FOLDER, saved=False)
    assert not session.is_saved
    assert session.undo_label == ""


def test_a_plan_replaces_the_one_with_its_id_and_new_ids_are_free(entry):
    document = Document().with_plan(entry).with_plan(replace(entry, title="again"))
    assert [found.title for found in document.plans] == ["again"]
    assert document.free_plan_id() == "plan-2"
    both = document.with_plan(replace(entry, id="plan-2"))
    assert both.without_plan("plan-2").current_plan_id == "plan-1"
    with pytest.raises(ValueError, match="there is no plan"):
        replace(both, current_plan_id="plan-9")
    with pytest.raises(ValueError, match="unique"):
        replace(both, plans=(entry, entry))


def test_items_exist_as_long_as_what_they_name(entry):
    document = replace(Document(), site=kiosk()).with_plan(entry)
    first = entry.plan.viewpoints[0].id
    legs = len(entry.plan.sorties[0].path_enu_m) - 1
    for kind, known, unknown in (
        (ItemKind.VIEWPOINT, first, "v9999"),
        (ItemKind.SORTIE, "1", "0"),
        (ItemKind.LEG, f"1/{legs}", f"1/{legs + 1}"),
        (ItemKind.PANEL, "A-0000", "Z-0000"),
        (ItemKind.FACADE, "B", "Z"),
    ):
        assert exists(document, Item(kind, known))
        assert not exists(document, Item(kind, unknown))
        assert not exists(Document(), Item(kind, known))
    assert exists(document, Item(ItemKind.HOME))
    assert not exists(document, Item(ItemKind.LEG, "1/x"))
    assert exists(document, Item(ItemKind.OBSTACLE, "tree"))
    assert exists(document, Item(ItemKind.NO_FLY, "road"))
    assert not exists(document, Item(ItemKind.OBSTACLE, "crane"))

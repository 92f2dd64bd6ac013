"""Photos of a simulated flight are rendered in the window, and then are photos as any others: no dead end."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from groundstation.services.project.document import Document, PlanEntry
from missions.flight.flight_file import flight_of, write_flight
from planning.base.effects import Decision
from reconstruction.scenes.runs.run_record import begun_photos
from tests.gui.driving import choose, clicked, press_in, turn_until, turn_until_idle
from tests.missions.flight.flights import flown_as_planned
from tests.services.live_cases import planned


@pytest.fixture
def flight(tmp_path):
    """A flight file of a simulation, as the Fly tab leaves it."""
    model, plan = planned()
    effect = Decision("wind", True, "scene", "8 m/s", 0.4, 0.1, "m", 0.0)
    records = tuple(replace(record, effects=(effect,)) for record in flown_as_planned(plan))
    path = tmp_path / "flight.json"
    write_flight(path, flight_of(plan, model, records, None))
    return path


@pytest.mark.slow
def test_from_a_simulated_flight_to_the_data_set(application, controller, flight, tmp_path):
    model, plan = planned()
    context, window = controller.context, controller.window
    context.session.open(Document(model, plans=(PlanEntry("plan", "Plan", plan),), current_plan_id="plan"), None)
    context.begin_anew()
    window.show_tab("photos")
    page, bar = window.tab("photos"), window.next_step
    turn_until_idle(application, controller)
    assert not page.render.isVisible()
    context.note(simulated=flight)
    assert bar.button.text() == "Render photos"
    assert page.render.isVisible()
    page.width.setCurrentIndex(page.width.findData(512))
    with clicked(choose(tmp_path / "rendered")):
        press_in(window, "Render photos")
    assert [job.name for job in context.jobs()] == ["Render the photos"]
    turn_until(application, lambda: window.job_bar.isVisible())
    turn_until(application, lambda: len(page.controller.cards) == len(plan.viewpoints))
    turn_until_idle(application, controller)
    assert page.controller.folder == tmp_path / "rendered" / "images"
    assert bar.button.text() == "Make data set"
    with clicked(choose(tmp_path / "dataset")):
        press_in(window, "Make data set")
    turn_until(application, lambda: context.milestones.data_set is not None)
    assert bar.button.text() == "To Reconstruct"


@pytest.mark.slow
def test_a_cancelled_rendering_goes_on_where_it_stopped(application, controller, flight, tmp_path):
    model, plan = planned()
    context, window = controller.context, controller.window
    context.session.open(Document(model, plans=(PlanEntry("plan", "Plan", plan),), current_plan_id="plan"), None)
    context.begin_anew()
    window.show_tab("photos")
    turn_until_idle(application, controller)
    context.note(simulated=flight)
    page, folder = window.tab("photos"), tmp_path / "rendered"
    page.width.setCurrentIndex(page.width.findData(512))
    with clicked(choose(folder)):
        press_in(window, "Render these photos ...")
    turn_until(application, lambda: n_rendered(folder) >= 2)
    press_in(window, "Cancel")
    turn_until(application, lambda: not context.jobs())
    n_done = n_rendered(folder)
    assert 2 <= n_done < len(plan.viewpoints)
    assert window.next_step.button.text() == "Render photos"
    photos = {path: path.stat().st_mtime_ns for path in sorted((folder / "images").iterdir())[:2]}
    # Another width stands in the box by now: what was begun goes on as it was begun.
    page.width.setCurrentIndex(page.width.findData(1024))
    with clicked("Cancel") as asked:
        press_in(window, "Render photos")
    assert not context.jobs()
    assert f"{n_done} of {len(plan.viewpoints)} were rendered" in asked[0]
    with clicked("Go on"):
        press_in(window, "Render photos")
    turn_until(application, lambda: len(page.controller.cards) == len(plan.viewpoints))
    turn_until_idle(application, controller)
    assert {path: path.stat().st_mtime_ns for path in photos} == photos
    assert page.controller.begun_rendering(flight, folder) is None


def test_photos_of_another_flight_and_damaged_records_are_nothing_to_go_on_with(tmp_path):
    record = {
        "format": "reflight-scene-photos/1",
        "complete": False,
        "made_from": {"flight": "flight.json"},
        "camera": {"width_px": 512},
        "photos": [{}, {}],
        "files": {"a.jpg": {}},
    }
    for changed, is_begun in (
        ({}, True),
        ({"complete": True}, False),
        ({"made_from": {"flight": "another.json"}}, False),
        ({"made_from": {"views": 3}}, False),
        ({"camera": None}, False),
    ):
        (tmp_path / "scene.json").write_text(json.dumps(record | changed))
        found = begun_photos(tmp_path, Path("flight.json"))
        assert (found is not None) is is_begun
    (tmp_path / "scene.json").write_text("{")
    assert begun_photos(tmp_path, Path("flight.json")) is None
    assert begun_photos(tmp_path / "none", Path("flight.json")) is None


def n_rendered(folder):
    """Photos that the record of a run calls complete."""
    path = folder / "scene.json"
    return len(json.loads(path.read_text())["files"]) if path.is_file() else 0

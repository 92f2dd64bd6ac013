"""Photos of a simulated flight are rendered in the window, and then are photos as any others: no dead end."""

from dataclasses import replace

import pytest

from groundstation.services.project.document import Document, PlanEntry
from missions.flight.flight_file import flight_of, write_flight
from planning.base.effects import Decision
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
def test_a_rendering_can_be_cancelled_and_offered_again(application, controller, flight, tmp_path):
    model, plan = planned()
    context, window = controller.context, controller.window
    context.session.open(Document(model, plans=(PlanEntry("plan", "Plan", plan),), current_plan_id="plan"), None)
    context.begin_anew()
    window.show_tab("photos")
    turn_until_idle(application, controller)
    context.note(simulated=flight)
    with clicked(choose(tmp_path / "rendered")):
        press_in(window, "Render these photos ...")
    turn_until(application, lambda: window.job_bar.isVisible())
    press_in(window, "Cancel")
    turn_until(application, lambda: not context.jobs())
    assert window.next_step.button.text() == "Render photos"
    assert window.tab("photos").render.isEnabled()

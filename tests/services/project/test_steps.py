"""What comes next: from every state there is a way on, to the end, and edits take back what they spoil."""

import os
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.services.project.document import Document, PlanEntry
from groundstation.services.project.folder import open_project
from groundstation.services.project.sample import unpack_sample
from groundstation.services.project.steps import (
    Act,
    FlightState,
    Flown,
    Milestones,
    Step,
    flown_records,
    guidance,
    is_done,
    steps_in_folder,
    undone,
)
from missions.flight.flight_file import read_flight, write_flight
from missions.flight.outcome import FlightReport, Reason, Summary, ViewOutcome
from tests.services.project_cases import document

FOLDER = Path("folder")

WHOLE = Flown({"a": (1, Reason.TAKEN), "b": (2, Reason.TAKEN)})
EARLY = Flown({"a": (1, Reason.TAKEN), "b": (1, Reason.FLIGHT_ENDED)})
FIRST_SORTIE = Flown({"a": (1, Reason.TAKEN), "b": (2, Reason.NOT_FLOWN)})
UNANSWERED = Flown({"a": (1, Reason.TAKEN), "b": (1, Reason.NO_PHOTO)})

states = st.builds(
    Milestones,
    n_panels=st.sampled_from([None, 0, 280]),
    n_viewpoints=st.sampled_from([None, 60]),
    is_planning=st.booleans(),
    n_errors=st.sampled_from([None, 0, 2]),
    is_exported=st.booleans(),
    flight=st.sampled_from(FlightState),
    sortie=st.sampled_from([1, 2]),
    flown=st.sampled_from([None, WHOLE, EARLY, FIRST_SORTIE, UNANSWERED]),
    simulated=st.sampled_from([None, FOLDER / "flight.json"]),
    n_photos=st.sampled_from([0, 24]),
    data_set=st.sampled_from([None, FOLDER]),
    is_training=st.booleans(),
    model=st.sampled_from([None, FOLDER]),
    is_model_open=st.booleans(),
)

BROUGHT = {
    Act.DRAW_PANELS: {"n_panels": 40},
    Act.PLAN: {"is_planning": True},
    Act.KEEP_PLAN: {"is_planning": False, "n_viewpoints": 60},
    Act.CHECK: {"n_errors": 0},
    Act.SHOW_FINDING: {"n_errors": 0},
    Act.CONNECT: {"flight": FlightState.CONNECTED},
    Act.UPLOAD: {"flight": FlightState.ON_BOARD},
    Act.TAKE_OFF: {"flight": FlightState.IN_AIR},
    Act.NEXT_SORTIE: {"sortie": 2},
    Act.RESUME_SORTIE: {"flown": None, "n_errors": None},
    Act.TOP_UP: {"flown": None, "n_errors": None},
    Act.FROM_PHOTOS: {"n_panels": 0, "n_photos": 24},
    Act.READ_PHOTOS: {"n_photos": 24},
    Act.RENDER_PHOTOS: {"n_photos": 24},
    Act.FIND_PANELS: {"n_panels": 40},
    Act.MAKE_DATA_SET: {"data_set": FOLDER},
    Act.TRAIN: {"is_training": True},
    Act.KEEP_MODEL: {"is_training": False, "model": FOLDER},
    Act.OPEN_MODEL: {"is_model_open": True},
}
"""What each act brings about when it succeeds."""

WAITED = {
    FlightState.BUSY: {"flight": FlightState.CONNECTED},
    FlightState.ON_BOARD: {"flight": FlightState.READY},
    FlightState.IN_AIR: {"flight": FlightState.APART, "flown": WHOLE},
    FlightState.SIGNAL_LOST: {"flight": FlightState.IN_AIR},
}


@given(states, st.sampled_from(Step))
def test_from_every_state_and_tab_the_buttons_lead_to_an_open_model(now, step):
    seen = []
    for _ in range(40):
        found = guidance(step, now)
        assert found.next, "it is always said what comes next"
        assert bool(found.label) == (found.act is not None)
        seen.append((step, found.act))
        if found.act is Act.EXPORT_MODEL:
            assert is_done(Step.MODEL, now)
            return
        if found.act is None:
            now = replace(now, **WAITED[now.flight])
        elif found.act is Act.TO_START:
            # A new project begins with a building.
            step, now = Step.SITE, Milestones(n_panels=0)
        elif found.act in BROUGHT:
            now = replace(now, **BROUGHT[found.act])
        else:
            step = Step(found.act.value.removeprefix("to-"))
    pytest.fail(f"it goes around in circles: {seen[-8:]}")


def test_a_step_is_behind_once_what_it_is_for_is_there():
    now = Milestones()
    for step, brought in (
        (Step.SITE, {"n_panels": 280}),
        (Step.PLAN, {"n_viewpoints": 60}),
        (Step.MISSION, {"n_errors": 0}),
        (Step.FLY, {"flown": WHOLE}),
        (Step.PHOTOS, {"data_set": FOLDER}),
        (Step.RECONSTRUCT, {"model": FOLDER}),
        (Step.MODEL, {"is_model_open": True}),
    ):
        assert not is_done(step, now)
        now = replace(now, **brought)
        assert is_done(step, now)
    assert all(is_done(step, now) for step in Step)


def test_a_plan_with_errors_is_not_done_and_its_first_error_is_shown():
    now = Milestones(n_panels=280, n_viewpoints=60, n_errors=2)
    found = guidance(Step.MISSION, now)
    assert not found.is_done
    assert found.act is Act.SHOW_FINDING
    assert "2" in found.done


def test_a_flight_that_landed_early_is_not_done_and_says_what_was_flown():
    now = Milestones(n_panels=280, n_viewpoints=2, flown=EARLY)
    found = guidance(Step.FLY, now)
    assert not found.is_done
    assert found.done == "landed early; 1 of 2 photos taken"
    assert found.act is Act.RESUME_SORTIE
    assert guidance(Step.FLY, replace(now, flown=WHOLE)).done == "flown; 2 of 2 photos taken"


def test_what_follows_a_landing_is_the_next_sortie_a_top_up_or_the_photos():
    now = Milestones(n_panels=280, n_viewpoints=2, flown=FIRST_SORTIE)
    assert guidance(Step.FLY, now).act is Act.NEXT_SORTIE
    assert guidance(Step.FLY, replace(now, sortie=2, flight=FlightState.CONNECTED)).act is Act.UPLOAD
    unanswered = guidance(Step.FLY, replace(now, flown=UNANSWERED))
    assert (unanswered.act, unanswered.is_done) == (Act.TOP_UP, False)
    left = guidance(Step.FLY, replace(now, flown=replace(UNANSWERED, is_enough=True)))
    assert (left.act, left.is_done) == (Act.TO_PHOTOS, True)


def test_a_later_flight_of_a_plan_adds_its_photos_and_takes_none_away():
    early = report(a=Reason.TAKEN, b=Reason.FLIGHT_ENDED)
    later = report(a=Reason.NOT_FLOWN, b=Reason.NO_PHOTO)
    flown = Flown({}).also(early)
    assert (flown.n_taken, flown.is_cut_short) == (1, True)
    assert flown.also(later) == UNANSWERED
    assert flown.also(report(a=Reason.FLIGHT_ENDED, b=Reason.TAKEN)).is_whole
    assert Flown({}).also(report(a=Reason.REPORT_LOST, b=Reason.TAKEN)).is_whole, "its photo is on the card"


def report(**reasons):
    views = tuple(ViewOutcome(name, 1, reason) for name, reason in reasons.items())
    return FlightReport(Summary(len(views), 0, 0, 0, 0, 0), views, (), ())


def test_an_imported_mission_on_a_bare_site_is_led_to_panels_and_not_to_a_check_that_cannot_be_made():
    bare = Milestones(n_panels=0, n_viewpoints=16)
    assert guidance(Step.MISSION, bare).act is Act.TO_SITE
    assert guidance(Step.MISSION, replace(bare, n_panels=40)).act is Act.CHECK


def test_a_plan_with_warnings_is_done_and_they_are_to_be_read():
    found = guidance(Step.MISSION, Milestones(n_panels=280, n_viewpoints=60, n_errors=0, n_warnings=3))
    assert found.is_done
    assert found.done == "no errors; warnings: 3"
    assert found.next.startswith("read the warnings")
    clean = guidance(Step.MISSION, Milestones(n_panels=280, n_viewpoints=60, n_errors=0))
    assert clean.done == "all checks passed"
    unknown = Milestones(n_panels=280, n_viewpoints=60, n_errors=0, not_looked_at=("zones", "sun"))
    assert guidance(Step.MISSION, unknown).done == "all checks passed; not looked at: zones, sun"
    assert guidance(Step.MISSION, unknown).is_done
    warned = guidance(Step.MISSION, replace(unknown, n_warnings=2))
    assert warned.done == "no errors; warnings: 2; not looked at: zones, sun"


def test_edits_take_back_what_they_spoil_and_nothing_else():
    before = document("canyon")
    model, entry = before.site, before.current
    plan = entry.plan
    now = replace(undone(Milestones(), Document(), before), n_errors=0, flown=WHOLE, n_photos=9, data_set=FOLDER)
    assert (now.n_panels, now.n_viewpoints) == (model.site.n_panels, len(plan.viewpoints))

    titled = replace(before, plans=(replace(entry, title="Other"),))
    assert undone(now, before, titled) == now, "a title changes nothing"
    other = before.with_plan(PlanEntry("plan-2", "Second", replace(plan, seed=plan.seed + 1)))
    assert undone(now, before, other) == replace(now, n_errors=None, flown=None)
    moved = replace(before, site=replace(model, site=replace(model.site, home_enu_m=(1.0, 2.0, 0.0))))
    assert undone(now, before, moved) == replace(now, n_errors=None)
    elsewhere = replace(model, site=replace(model.site, name="elsewhere"), building=replace(model.building))
    assert undone(now, before, replace(before, site=elsewhere)).data_set is None


def test_what_a_project_has_on_the_disk_is_found(tmp_path):
    assert steps_in_folder(tmp_path / "nowhere", None).data_set is None
    for name in ("missions/a.kmz", "dataset/dataset.json", "models/a/model.json"):
        assert not all(getattr(steps_in_folder(tmp_path, None), part) for part in ("is_exported", "model"))
        path = tmp_path / name
        path.parent.mkdir(parents=True)
        path.write_text("{}")
    found = steps_in_folder(tmp_path, None)
    assert found.is_exported
    assert (found.data_set, found.model) == (tmp_path / "dataset", tmp_path / "models" / "a")


def test_flights_of_other_days_count_for_the_plan_that_they_were_flown_with(tmp_path):
    folder = unpack_sample(tmp_path / "sample")
    plan = open_project(folder).document.current.plan
    (path,) = (folder / "flights").glob("*.json")
    flight = read_flight(path)
    n_views = len(plan.viewpoints)
    assert steps_in_folder(folder, plan).flown.n_taken == n_views
    first_view, *others = plan.viewpoints
    x_m, y_m, z_m = first_view.position_enu_m
    moved = replace(plan, viewpoints=(replace(first_view, position_enu_m=(x_m, y_m, z_m + 0.01)), *others))
    assert steps_in_folder(folder, moved).flown is None
    assert steps_in_folder(folder, moved).simulated == path

    views = flight.report.views
    early = (*views[:5], *(replace(view, reason=Reason.FLIGHT_ENDED, photo=None) for view in views[5:]))
    (record,) = flight.sorties
    first = replace(record, photos=record.photos[:5])
    write_flight(path, replace(flight, sorties=(first,), report=replace(flight.report, views=early)))
    found = steps_in_folder(folder, plan)
    assert guidance(Step.FLY, replace(Milestones(n_panels=9, n_viewpoints=n_views), flown=found.flown)).done == (
        f"landed early; 5 of {n_views} photos taken"
    )
    assert [len(each.photos) for each in flown_records(folder, plan)] == [5]
    later = path.with_name("later.json")
    again = replace(flight.report, views=tuple(replace(view, record=1) for view in views))
    write_flight(later, replace(flight, sorties=(first, record), report=again))
    os.utime(later, (2e9, 2e9))
    assert steps_in_folder(folder, plan).flown.is_whole
    assert [len(each.photos) for each in flown_records(folder, plan)] == [5, n_views], "each sortie once"
    write_flight(path, replace(flight, sorties=()))
    assert len(flown_records(folder, plan)) == 2, "its report speaks of records that it has not"
    path.write_text("{}")
    assert steps_in_folder(folder, plan).flown.is_whole, "what cannot be read counts as not there"

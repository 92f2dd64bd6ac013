"""Widgets of the Plan tab edit one value each and show what they are given."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from groundstation.services.plan.effects import EffectChoice
from groundstation.services.units import UnitSystem
from planning.aircraft.catalogue import profile
from planning.base.effects import Decision
from planning.base.progress import QualityPoint
from planning.insight.sections import SectionState
from planning.parameters import DEFAULT_SHARE, Constraints, FlightRules, GreedyParameters
from planning.plan import Viewpoint, usual_gsd_m
from planning.request import PlanRequest


@pytest.fixture(scope="module")
def form(application):
    from groundstation.gui.plan.plan_form import PlanForm

    return PlanForm()


REQUESTS = st.builds(
    PlanRequest,
    method=st.sampled_from(["greedy", "pso", "noto", "orbit"]),
    n_views=st.integers(1, 20_000),
    profile_id=st.sampled_from(["m3e", "m30", "px4"]),
    constraints=st.builds(
        Constraints,
        min_distance_m=st.floats(0.5, 50.0),
        section_step_deg=st.sampled_from([30.0, 15.0, 10.0, 5.0]),
        occlusion=st.sampled_from(["auto", "on", "off"]),
        whole_panel=st.booleans(),
        max_distance_m=st.none() | st.floats(60.0, 90.0),
        wanted_gsd_mm=st.none() | st.just(0.0) | st.floats(0.01, 600.0),
    ),
    rules=st.builds(
        FlightRules, wind_m_s=st.floats(0.0, 12.0), battery_reserve=st.floats(0.0, 0.5), settle_s=st.floats(0.0, 10.0)
    ),
    precision=st.sampled_from(["f32", "f64"]),
    seed=st.integers(0, 2**31 - 1),
    time_budget_s=st.floats(1.0, 3600.0),
)


@given(REQUESTS)
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=40)
def test_the_form_gives_a_request_back_as_it_was_set(form, request_):
    heard = []
    form.valueChanged.connect(heard.append)
    form.setValue(request_)
    assert form.value() == request_
    assert not heard
    form.valueChanged.disconnect(heard.append)


def test_one_edit_changes_one_thing_and_is_announced_once(form):
    request = PlanRequest(n_views=37, constraints=Constraints(min_distance_m=7.123456), seed=5)
    form.setValue(request)
    heard = []
    form.valueChanged.connect(heard.append)
    form.box("rules.wind_m_s").box().setValue(4.0)
    form.valueChanged.disconnect(heard.append)
    assert heard == [replace(request, rules=FlightRules(wind_m_s=4.0))]


def test_the_wanted_pixel_is_that_of_camera_and_distance_until_one_is_typed(form):
    form.setValue(PlanRequest())
    assert form.box("constraints.wanted_gsd_mm").value() == pytest.approx(usual_gsd_m(profile("m3e").camera, 10.0))
    form.box("constraints.min_distance_m").box().setValue(60.0)
    assert form.box("constraints.wanted_gsd_mm").value() == pytest.approx(usual_gsd_m(profile("m3e").camera, 60.0))
    assert form.value().constraints.wanted_gsd_mm is None
    form.box("constraints.wanted_gsd_mm").box().setValue(12.5)
    assert form.value().constraints.wanted_gsd_mm == pytest.approx(12.5)
    form.box("constraints.min_distance_m").box().setValue(20.0)
    assert form.value().constraints.wanted_gsd_mm == pytest.approx(12.5)
    form.box("constraints.wanted_gsd_mm").box().setValue(0.0)
    assert form.value().constraints.wanted_gsd_mm == 0.0
    assert form.box("constraints.wanted_gsd_mm").box().text() == "any"


def test_the_goal_that_is_offered_is_that_of_what_views_are_chosen_for(form):
    from groundstation.gui.plan.plan_form import COVERAGE, GOOD_ENOUGH, MODEL

    goal, box = form._goal, form.box("greedy.objective")
    form.setValue(PlanRequest())
    assert (goal.currentIndex(), form.value().is_as_many_as_sections, box.isEnabled()) == (MODEL, True, True)
    form.setValue(PlanRequest(greedy=GreedyParameters(objective="sections")))
    assert (goal.currentIndex(), form.value().wanted_share) == (COVERAGE, DEFAULT_SHARE)
    form.setValue(PlanRequest())
    goal.setCurrentIndex(COVERAGE)
    assert form.value().share == DEFAULT_SHARE
    assert not box.isEnabled(), "a share is one of sections"
    goal.setCurrentIndex(GOOD_ENOUGH)
    assert form.value().least_gain_db == 0.5
    goal.setCurrentIndex(MODEL)
    assert form.value() == PlanRequest()


def test_a_request_that_makes_no_sense_is_explained_and_not_announced(form):
    form.setValue(PlanRequest(constraints=Constraints(min_distance_m=20.0, max_distance_m=40.0)))
    heard = []
    form.valueChanged.connect(heard.append)
    form.box("constraints.min_distance_m").box().setValue(60.0)
    form.valueChanged.disconnect(heard.append)
    assert not heard
    assert "within 40.0 m, but the safety distance is 60.0 m" in form.problem()
    form.setValue(PlanRequest())
    assert form.problem() == ""


def test_an_own_aircraft_is_taken_from_a_file_and_a_wrong_file_changes_nothing(form, tmp_path):
    own = tmp_path / "own.toml"
    own.write_text(
        '[quad]\naircraft = { name = "My quad", endurance_s = 900, max_speed_m_s = 8 }\n'
        'camera = { name = "Cam", sensor_width_mm = 13.2, sensor_height_mm = 8.8, focal_length_mm = 8.8, '
        "image_width_px = 5472, image_height_px = 3648, gimbal_pitch_deg = [-90, 20] }\n"
    )
    form.setValue(PlanRequest())
    form.aircraft.use_file(own)
    assert form.value().profile_id == str(own)
    (tmp_path / "bad.toml").write_text("[quad]\n")
    form.aircraft.use_file(tmp_path / "bad.toml")
    assert "bad.toml" in form._wrong.text()
    assert form.value().profile_id == str(own)
    own.unlink()
    form.setValue(PlanRequest(profile_id=str(tmp_path / "gone.toml")))
    assert "gone.toml" in form._wrong.text(), "a project can name a file that is not there any more"
    form.setValue(PlanRequest())


def decision(on, size):
    return Decision("occlusion", on, "scene", "something stands there", size, 0.5, "%", 1.2)


def test_effects_say_state_reason_size_and_cost_and_take_a_setting(application):
    from groundstation.gui.widgets.effects_panel import EffectsPanel

    panel, heard = EffectsPanel(), []
    panel.settingChanged.connect(lambda name, setting: heard.append((name, setting)))
    panel.set_effects(
        (EffectChoice(decision(True, 7.5), "auto"), EffectChoice(replace(decision(False, 0.0), effect="x"), None))
    )
    text = panel.card("occlusion").text()
    for part in ("occlusion", "is on", "something stands there", "7.5 %", "tolerance 0.5", "1.2 s"):
        assert part in text
    assert not heard
    panel.card("occlusion").setting.setCurrentIndex(2)
    assert heard == [("occlusion", "off")]
    assert panel.card("x").setting.isHidden()
    panel.set_effects(())
    assert panel.card("occlusion").isHidden()
    panel.set_effects((EffectChoice(decision(True, 7.5), "on"),))
    assert not panel.card("occlusion").isHidden()
    assert panel.card("x").isHidden()


class Clock:
    now_s = 0.0

    def __call__(self):
        return self.now_s


def test_the_chart_tells_quality_bound_and_time_left_while_a_plan_runs(application):
    from groundstation.gui.charts.quality_chart import QualityChart

    clock = Clock()
    chart = QualityChart(clock)
    chart.start(30.0)
    chart.add_point(QualityPoint(0.5, 600.0))
    chart.set_bound(800.0)
    clock.now_s = 12.0
    chart._draw()
    assert "600 sections" in chart.text()
    assert "75.0 %" in chart.text()
    assert "at most 18 s left" in chart.text()
    assert not chart.enough.isHidden()
    chart.finish()
    assert chart.enough.isHidden()
    assert "left" not in chart.text()


def curve_picture(plot, curve):
    from groundstation.gui.view3d.canvas import image_array

    plot.set_curve(curve)
    return image_array(plot.grab().toImage()).astype(int)


def rows_of(image, colour):
    """Rows of pixels in which a colour is, the lowest last."""
    wanted = [int(colour[place : place + 2], 16) for place in (1, 3, 5)]
    return np.flatnonzero((np.abs(image - wanted).max(axis=2) < 60).any(axis=1))


@pytest.mark.parametrize("size", [(330, 300), (260, 110), (900, 600)])
def test_the_curve_stands_below_its_bound_and_both_where_their_values_are(application, size):
    from PySide6.QtCore import QRectF

    from groundstation.gui.charts.axes import box_of_axes
    from groundstation.gui.charts.quality_chart import Curve, CurvePlot
    from groundstation.gui.widgets.theme import colours

    plot = CurvePlot("time in s", "covered sections")
    plot.resize(*size)
    x, y = np.array([0.0, 5.0, 10.0]), np.array([500.0, 500.0, 500.0])
    drawn = curve_picture(plot, Curve(x, y, 10.0, 1000.0, 750.0, 4.0))
    box = box_of_axes(QRectF(plot.rect()), plot.font())
    for value, colour in ((500.0, colours().covered), (750.0, colours().error)):
        middle = box.bottom() - box.height() * value / 1000.0
        assert np.median(rows_of(drawn, colour)) == pytest.approx(middle, abs=1.5)
    bare = curve_picture(plot, Curve(x, y, 10.0, 1000.0))
    assert not len(rows_of(bare, colours().error)), "no bound, no line"


def test_an_empty_curve_and_a_tiny_widget_are_no_trouble(application):
    from groundstation.gui.charts.quality_chart import Curve, CurvePlot

    plot = CurvePlot("time in s", "covered sections")
    none = np.zeros(0)
    for size in ((330, 300), (20, 15), (1, 1)):
        plot.setMinimumHeight(1)
        plot.resize(*size)
        curve_picture(plot, Curve(none, none, 1.0, 1.0, 1.0, 0.0))
        curve_picture(plot, Curve(np.array([0.0]), np.array([3.0]), 1.0, 3.0))


def test_of_thousands_of_improvements_only_those_that_can_be_seen_are_drawn(application):
    from PySide6.QtCore import QRectF

    from groundstation.gui.charts.quality_chart import Curve, steps

    x = np.linspace(0.1, 9.9, 20_000)
    curve = Curve(x, 1000.0 * x, 10.0, 10_000.0)
    drawn = steps(curve, curve.axes(QRectF(0.0, 0.0, 200.0, 100.0)))
    assert len(drawn) <= 2 * 200
    assert drawn[-1].x() == pytest.approx(198.0)
    assert all(b.x() >= a.x() and b.y() <= a.y() for a, b in pairwise(drawn)), "never back, never down"
    assert all(a.x() == b.x() or a.y() == b.y() for a, b in pairwise(drawn)), "steps"


def shown(state, n=0):
    from groundstation.gui.charts.hemisphere_view import ShownSection

    return ShownSection(state, n, f"{state.name} {n}")


@pytest.mark.parametrize("step_deg", [30.0, 15.0, 10.0, 90.0])
def test_every_section_is_found_where_it_is_painted(application, step_deg):
    from groundstation.gui.charts.hemisphere_view import HemisphereView
    from planning.coverage.sections import SectionGrid
    from planning.insight.sections import section_shapes

    view = HemisphereView()
    view.resize(400, 360)
    grid = SectionGrid(step_deg)
    view.set_sections(step_deg, tuple(shown(SectionState.COVERED, 1) for _ in range(grid.n_sections)))
    shapes = section_shapes(grid)
    for number in range(grid.n_sections):
        theta = (shapes.ring[number] + 0.5) * step_deg
        phi = (shapes.sector[number] + 0.5) * step_deg
        assert view.section_at(view.place_of(theta, phi)) == number
    assert view.section_at(view.place_of(91.0, 10.0)) is None


def test_states_differ_in_the_picture_and_the_first_sector_lies_to_the_right(application):
    from groundstation.gui.charts.hemisphere_view import HemisphereView

    view = HemisphereView()
    view.resize(300, 300)
    states = [SectionState.MISSED] * 4
    view.set_sections(90.0, tuple(shown(state) for state in states))
    plain = view.grab().toImage()
    for state in SectionState:
        view.set_sections(90.0, tuple(shown(s) for s in [state, *states[1:]]))
        picture = view.grab().toImage()
        differ = [picture.pixel(x, y) != plain.pixel(x, y) for x, y in ((200, 110), (210, 120), (205, 117), (190, 95))]
        assert any(differ) == (state is not SectionState.MISSED)
        assert picture.pixel(100, 110) == plain.pixel(100, 110), "only the sector to the upper right was changed"
    with pytest.raises(ValueError, match="36 sections"):
        view.set_sections(30.0, tuple(shown(state) for state in states))


def test_a_viewpoint_is_edited_one_thing_at_a_time(application):
    from groundstation.gui.plan.viewpoint_page import ViewpointEditor

    editor, heard = ViewpointEditor(), []
    editor.valueChanged.connect(heard.append)
    viewpoint = Viewpoint("v0001", (1.23456, -2.0, 3.00004), 12.3456, -10.123)
    editor.setValue(viewpoint)
    assert not heard
    editor.set_units(UnitSystem.IMPERIAL)
    editor._position[2].box().setValue(editor._position[2].box().value() + 10.0)
    assert heard[-1].position_enu_m[:2] == viewpoint.position_enu_m[:2]
    assert heard[-1].position_enu_m[2] == pytest.approx(3.00004 + 10 * 0.3048, abs=0.002)
    assert (heard[-1].heading_deg, heard[-1].gimbal_pitch_deg) == (12.3456, -10.123)
    editor._locked.setChecked(True)
    assert heard[-1].locked
    editor.setValue(None)
    assert editor.value() is None
    assert len(heard) == 2


def test_the_chart_never_draws_a_falling_curve_from_rising_points(application):
    from groundstation.gui.charts.quality_chart import QualityChart

    chart = QualityChart(Clock())
    chart.show_history(tuple(QualityPoint(t, v) for t, v in ((0.1, 5.0), (0.2, 9.0), (1.5, 12.0))), 20.0)
    curve = chart.plot.curve()
    assert all(a <= b for a, b in pairwise(curve.x))
    assert all(a <= b for a, b in pairwise(curve.y))

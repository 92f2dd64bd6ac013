"""Forms keep what they were given: what boxes cannot show, or round, is not changed by an edit of something else.

Each form is asked for what its boxes say after a value was set, without an edit and after one edit: over the whole
range that files may have, not only what can be typed.
"""

from dataclasses import replace

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from groundstation.services.fly.options import ConnectionChoice, LinkKind
from groundstation.services.reconstruct.choices import TrainChoice
from groundstation.services.units import UnitSystem
from missions.formats.options import ExportOptions
from missions.mavlink.autopilots import Autopilot
from missions.mission.export_choices import FileFormat, HeightReference, LinkLoss
from missions.simulator.conditions import Conditions
from planning.geo.frames import Origin
from planning.parameters import LARGEST_SEED, Constraints, FlightRules, GreedyParameters
from planning.plan import Camera, Viewpoint
from planning.request import PlanRequest
from planning.site.importing.options import ImportOptions
from reconstruction.records.entries import Attribute, Defect, Maintenance
from reconstruction.scenes.world.look import Look

PANEL = "0YvctVUKr0kugbFTf53O9L"

METRIC, IMPERIAL = UnitSystem.METRIC, UnitSystem.IMPERIAL

quick = settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=60, deadline=None)


def numbers(low, high):
    return st.floats(low, high, allow_nan=False)


def goals():
    """At most one of views, share and batteries."""
    return st.one_of(
        st.builds(dict),
        st.builds(dict, n_views=st.integers(1, 20_000)),
        st.builds(dict, share=numbers(1e-6, 1.0)),
        st.builds(dict, n_batteries=st.integers(1, 100)),
    )


def limits():
    nearest = numbers(0.0, 400.0)
    return st.builds(
        lambda near_m, more_m, step, whole, occlusion: Constraints(
            min_distance_m=near_m,
            max_distance_m=None if more_m is None else near_m + more_m,
            section_step_deg=90.0 / step,
            whole_panel=whole,
            occlusion=occlusion,
        ),
        nearest,
        st.none() | numbers(0.01, 5000.0),
        st.integers(1, 90),
        st.booleans(),
        st.sampled_from(["auto", "on", "off"]),
    )


REQUESTS = st.builds(
    lambda goal, **rest: PlanRequest(**goal, **rest),
    goals(),
    method=st.sampled_from(["greedy", "pso", "noto", "orbit", "of a later version"]),
    profile_id=st.sampled_from(["m3e", "m30", "px4"]),
    constraints=limits(),
    rules=st.builds(
        FlightRules,
        wind_m_s=numbers(0.0, 60.0),
        battery_reserve=numbers(0.0, 0.999),
        settle_s=numbers(0.0, 900.0),
        photo_s=numbers(0.0, 60.0),
        max_speed_m_s=st.none() | numbers(0.1, 40.0),
        takeoff_landing_s=numbers(0.0, 600.0),
        turn_in_flight=st.booleans(),
    ),
    greedy=st.builds(GreedyParameters, n_candidates=st.integers(1, 10**6), solid_angle_weights=st.booleans()),
    precision=st.sampled_from(["f32", "f64"]),
    seed=st.integers(0, LARGEST_SEED),
    time_budget_s=numbers(0.01, 1e6),
)


@pytest.fixture(scope="module")
def plan_form(application):
    from groundstation.gui.plan.plan_form import PlanForm

    return PlanForm()


@given(REQUESTS, st.sampled_from(UnitSystem))
@quick
def test_the_plan_form_keeps_what_it_cannot_show(plan_form, request_, units):
    plan_form.set_units(units)
    plan_form.setValue(request_)
    assert plan_form.value() == request_
    assert plan_form._request() == request_, "what the boxes say"
    plan_form.set_units(METRIC)
    plan_form.box("constraints.whole_panel").setChecked(not request_.constraints.whole_panel)
    assert plan_form.problem() == ""
    edited = replace(request_.constraints, whole_panel=not request_.constraints.whole_panel)
    assert plan_form.value() == replace(request_, constraints=edited)


def test_fifty_batteries_sections_of_45_degrees_and_a_long_seed_survive_an_edit(plan_form):
    request = PlanRequest(n_batteries=50, constraints=Constraints(section_step_deg=45.0), seed=LARGEST_SEED)
    plan_form.setValue(request)
    plan_form.box("rules.wind_m_s").box().setValue(3.0)
    assert plan_form.value() == replace(request, rules=replace(request.rules, wind_m_s=3.0))
    assert plan_form.box("n_batteries").text() == "50"
    assert plan_form.box("constraints.section_step_deg").currentText() == "45°"
    assert plan_form.box("seed").text() == "9223372036854775807"


@given(
    st.builds(
        Viewpoint,
        st.just("v1"),
        st.tuples(*[numbers(-20_000.0, 20_000.0)] * 3),
        numbers(-180.0, 360.0),
        numbers(-180.0, 90.0),
        locked=st.just(False),
    ),
    st.sampled_from(UnitSystem),
)
@quick
def test_the_viewpoint_editor_keeps_places_and_angles(application, viewpoint, units):
    from groundstation.gui.plan.viewpoint_page import ViewpointEditor

    editor = ViewpointEditor()
    editor.set_camera(Camera("c", 17.3, 13.0, 12.29, 5280, 3956, (-90.0, 35.0)))
    editor.set_units(units)
    editor.setValue(viewpoint)
    editor.set_camera(Camera("c", 17.3, 13.0, 12.29, 5280, 3956, (-90.0, 30.0)))
    editor._edited()
    assert editor.value() == viewpoint
    editor._locked.setChecked(True)
    assert editor.value() == replace(viewpoint, locked=True)


@given(
    numbers(0.0, 40.0), numbers(0.0, 360.0), st.sampled_from(["rtk-fixed", "rtk-float", "single"]), numbers(0.0, 9.0)
)
@quick
def test_the_simulation_keeps_its_conditions(application, wind_m_s, wind_from_deg, fix, latency_s):
    from groundstation.gui.fly.simulation_controller import SimulationPage

    page = SimulationPage()
    conditions = Conditions(wind_m_s, wind_from_deg, fix, photo_latency_s=latency_s)
    page.setValue(conditions, {"wind": "off"})
    page._edited()
    assert page.value() == (conditions, {"wind": "off"})


@given(st.sampled_from(LinkKind), st.sampled_from(Autopilot), numbers(1.0, 500.0))
@quick
def test_the_connection_keeps_its_choice(application, kind, autopilot, speed_up):
    from groundstation.gui.fly.connection_box import ConnectionBox

    address = "" if kind is LinkKind.SIMULATION else "127.0.0.1:5760"
    choice = ConnectionChoice(kind, address, autopilot, speed_up)
    box = ConnectionBox()
    box.setValue(choice)
    box._edited()
    assert box.value() == choice


@given(
    st.sampled_from(FileFormat),
    st.sampled_from(HeightReference),
    st.none() | st.sampled_from(Autopilot),
    st.sampled_from(LinkLoss),
    st.none() | numbers(2.0, 3000.0),
)
@quick
def test_the_export_form_keeps_what_the_format_takes(application, file_format, heights, autopilot, link_loss, rth_m):
    from groundstation.gui.mission.export_dialog import ExportForm

    form = ExportForm(METRIC)
    form.setValue(FileFormat.DJI_KMZ, ExportOptions(heights, autopilot, link_loss, rth_m))
    _, options = form.value()
    assert (options.height_reference, options.link_loss, options.rth_height_m) == (heights, link_loss, rth_m)
    form.setValue(file_format, ExportOptions(heights, autopilot, link_loss, rth_m))
    assert form.value()[0] == file_format


@given(numbers(0.0, 359.999), numbers(-90.0, 90.0), st.booleans(), numbers(0.0, 1.0))
@quick
def test_the_light_keeps_the_place_of_the_sun(application, heading_deg, elevation_deg, near, replaced):
    from groundstation.gui.camera_preview.photo_box import LightBox

    look = replace(Look(), sun_heading_deg=heading_deg, sun_elevation_deg=elevation_deg, near=near, replaced=replaced)
    box = LightBox()
    box.setValue(look)
    box._edited()
    assert box.value() == look
    box._near.setChecked(not near)
    assert box.value() == replace(look, near=not near)


@given(numbers(-89.9, 89.9), numbers(-179.9, 179.9), numbers(-400.0, 9000.0))
@quick
def test_a_place_on_earth_is_kept(application, lat_deg, lon_deg, height_m):
    from groundstation.gui.site.pages import OriginBox

    origin = Origin(lat_deg, lon_deg, height_m)
    box = OriginBox(IMPERIAL)
    box.setValue(origin)
    assert box.value() == origin
    box._place_edited(0.0)
    assert box.value() == origin


@pytest.mark.slow
@given(st.lists(st.tuples(numbers(-1e5, 1e5), numbers(-1e5, 1e5)), min_size=3, max_size=6), st.sampled_from(UnitSystem))
@quick
def test_corners_of_polygons_and_extents_are_kept(application, corners, units):
    from groundstation.gui.widgets.value_boxes import ExtentBox, PointBox, PolygonBox

    polygon, point, extent = PolygonBox(units), PointBox(units), ExtentBox(units)
    polygon.setValue(tuple(corners))
    place = (*corners[0], corners[1][0])
    point.setValue(place)
    extent.setValue((place, place))
    for system in UnitSystem:
        for box in (polygon, point, extent):
            box.set_units(system)
    assert polygon.value() == tuple(corners)
    assert point.value() == place
    assert extent.value() == (place, place)


@pytest.mark.slow
@given(st.integers(1, 5000), st.integers(1, 5000), numbers(0.0, 50.0), numbers(0.001, 500.0))
@quick
def test_a_grid_of_panels_is_kept(application, n_rows, n_columns, gap_m, tolerance_m):
    from groundstation.gui.site.grid_form import GridForm, GridRequest

    request = GridRequest(
        ((0.1, 0.2, 0.3), (1e4, 0.0, 0.0), (0.0, 0.0, 7.77777)), n_rows, n_columns, gap_m, tolerance_m
    )
    form = GridForm(IMPERIAL)
    form.setValue(request)
    assert form.value() == request


@pytest.mark.slow
@given(
    st.none() | numbers(-1000.0, 9000.0),
    numbers(0.0, 5000.0),
    st.sampled_from(["m", "mm", "ft"]),
    st.sampled_from([None, "y", "z"]),
    st.none() | st.just("bldg-7"),
    st.sampled_from(["auto", "xy", "yx"]),
    st.sampled_from(["auto", "orthometric", "ellipsoid"]),
)
@quick
def test_options_of_an_import_are_kept(application, tmp_path_factory, ground_z, margin_m, unit, up, building, order, h):
    from groundstation.gui.site.site_opener import ImportForm

    options = ImportOptions(
        ground_z=ground_z,
        airspace_margin_m=margin_m,
        unit=unit,
        up=up,
        building=building,
        axis_order=order,
        height_reference=h,
    )
    form = ImportForm(tmp_path_factory.getbasetemp() / "model.gml", METRIC)
    form.setValue(options)
    assert form.value() == options


@given(numbers(0.1, 1e5) | st.none(), st.sampled_from(["10min", "1h", "overnight"]))
@quick
def test_a_training_keeps_its_time(application, minutes, preset):
    from groundstation.gui.reconstruct.choice_side import ChoiceForm

    choice = TrainChoice(preset=preset, minutes=minutes)
    form = ChoiceForm()
    form.setValue(choice)
    form._changed()
    assert form.value() == choice


@given(numbers(0.0, 1e6), numbers(0.0, 1.0), numbers(0.0, 1.0), st.sampled_from(["crack", "mist"]))
@quick
def test_records_keep_their_numbers_when_something_else_is_changed(application, value, u, v, kind):
    from groundstation.gui.model.record_side import RecordDialog

    kept = []
    for entry in (
        Attribute(PANEL, "thickness", value, "number", "mm", PANEL),
        Defect(PANEL, kind, 3, "2026-05-04", u, v, note="as it is", key=PANEL),
        Maintenance(PANEL, "2026-05-04", "sealed", cost=value, currency="EUR", key=PANEL),
    ):
        dialog = RecordDialog(type(entry), PANEL, entry, str, lambda *found: kept.append(found) or "")
        dialog.accept()
        assert dialog.problem.text() == ""
        assert kept[-1] == (entry, None)
        dialog.deleteLater()

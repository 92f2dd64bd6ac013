"""Pre-flight rules about the camera: what it can do, motion blur, rolling shutter, depth of field to mirror images."""

from __future__ import annotations

import functools
import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planning.aircraft.camera_use import camera_use, camera_use_of, controls_of, worst_defocus_px
from planning.aircraft.catalogue import profile, profiles
from planning.base.findings import Finding, Severity
from planning.checks.camera import CAMERA_RULES, glass_depths_m, photo_motions
from planning.checks.case import Case
from planning.optics import STOPS, CameraControls, sharpest_f_number
from planning.parameters import CameraSettings, Constraints, FlightRules, FocusMode
from planning.plan import Coverage, Plan, Sortie, Viewpoint, plan_of, plan_to_json
from tests.planning.plan_cases import kiosk

HOME = (0.0, -30.0, 0.0)


@functools.cache
def row(in_passing: tuple[str, ...] = (), profile_id: str = "m3e", distance_m: float = 12.0) -> Plan:
    """Five photos in a row along the south facade, looking straight at it."""
    chosen = profile(profile_id)
    views = tuple(Viewpoint(f"v{i}", (2.0 * i - 4.0, -distance_m, 5.0), 0.0, 0.0) for i in range(5))
    path = (HOME, (0.0, -30.0, 5.0), *(view.position_enu_m for view in views), (0.0, -30.0, 5.0), HOME)
    length_m = sum(math.dist(a, b) for a, b in itertools.pairwise(path))
    sortie = Sortie(tuple(view.id for view in views), path, length_m, 100.0, in_passing)
    return Plan(
        site="kiosk",
        site_sha256="",
        method="greedy",
        seed=0,
        camera=chosen.camera,
        aircraft=chosen.aircraft,
        constraints=Constraints(min_distance_m=5.0, occlusion="off"),
        viewpoints=views,
        sorties=(sortie,),
        coverage=Coverage(0, 540, 540),
        profile=profile_id,
        rules=FlightRules(max_speed_m_s=2.0),
        camera_controls=chosen.controls,
    )


def findings(plan: Plan, **settings: object) -> dict[str, Finding]:
    plan = replace(plan, camera_settings=CameraSettings(**settings))  # type: ignore[arg-type]
    case = Case.of(plan, kiosk())
    return {finding.code: finding for rule in CAMERA_RULES for finding in rule(case)}


MANUAL = {"exposure": "manual", "iso": 100}


def test_the_usual_settings_keep_every_rule_and_say_what_they_are() -> None:
    found = findings(row())
    assert {finding.severity for finding in found.values()} == {Severity.OK}
    assert found["camera"].message == (
        "exposure measured once, then locked, f/7.1, white balance 5500 K, automatic focus before the first photo, "
        "then locked, mechanical shutter"
    )
    assert found["motion-blur"].message == "all photos are taken at a hover, so none is blurred by motion"
    assert found["rolling-shutter"].message == "the mechanical shutter takes all rows at once"


def test_photos_at_a_hover_have_no_blur_whatever_the_shutter_time() -> None:
    found = findings(row(), **MANUAL, shutter_s=8.0, shutter="electronic")
    assert found["motion-blur"].severity is found["rolling-shutter"].severity is Severity.OK
    assert found["motion-blur"].value == 0.0


def test_blur_in_passing_is_the_closed_form_and_its_advice_keeps_the_limit() -> None:
    """2 m/s, 1/100 s, 12 m from the pane with pixels of 3.2 mm: 6.25 pixels."""
    plan = row(("v1", "v2", "v3"))
    blur = findings(plan, **MANUAL, shutter_s=1 / 100)["motion-blur"]
    gsd_m = plan.camera.gsd_m(min(case_depths(plan)))
    assert blur.severity is Severity.WARNING
    assert blur.value == pytest.approx(2.0 / 100 / gsd_m, rel=0.02)
    assert "photos taken in passing: 3, at up to 2.0 m/s" in blur.message
    assert "1/640 s or 0.3 m/s keep it sharp, or a stop for each photo" in blur.message
    assert findings(plan, **MANUAL, shutter_s=1 / 640)["motion-blur"].severity is Severity.OK
    slow = replace(plan, rules=FlightRules(max_speed_m_s=0.3))
    assert findings(slow, **MANUAL, shutter_s=1 / 100)["motion-blur"].severity is Severity.OK


def case_depths(plan: Plan) -> list[float]:
    """Distances from each photo to the nearest middle of a panel that it covers."""
    return list(Case.of(plan, kiosk()).measures.nearest_m.values())


def test_a_shutter_time_that_the_camera_chooses_is_asked_for_where_it_matters() -> None:
    blur = findings(row(("v2",)))["motion-blur"]
    assert blur.severity is Severity.WARNING
    assert (
        "the camera chooses the shutter time; no longer than 1/640 s keeps motion blur within a pixel" in blur.message
    )


def test_no_photo_in_passing_is_faster_than_it_can_get_between_its_stops() -> None:
    """Two metres from the last stop and to the next, at 2.5 m/s2: at most sqrt(2 * 2.5 * 2) = 3.2 m/s of 15."""
    plan = replace(row(("v1",)), rules=FlightRules())
    (motion,) = photo_motions(Case.of(plan, kiosk()))
    assert motion.speed_m_s == pytest.approx(math.sqrt(2.0 * 2.5 * 2.0))
    assert motion.turn_rad_s == 0.0


def test_a_turn_on_the_way_blurs_too() -> None:
    plan = row(("v1", "v2", "v3"))
    turning = tuple(replace(view, heading_deg=4.0 * k) for k, view in enumerate(plan.viewpoints))
    turned = photo_motions(Case.of(replace(plan, viewpoints=turning), kiosk()))
    # 4 degrees on 2 m at 2 m/s.
    assert {round(math.degrees(each.turn_rad_s), 6) for each in turned} == {4.0}
    straight = findings(plan, **MANUAL, shutter_s=1 / 640)["motion-blur"]
    blurred = findings(replace(plan, viewpoints=turning), **MANUAL, shutter_s=1 / 640)["motion-blur"]
    assert blurred.value is not None
    assert straight.value is not None
    assert blurred.value - straight.value == pytest.approx(
        math.radians(4.0) / 640 / plan.camera.pixel_angle_rad, rel=0.1
    )


def test_an_electronic_shutter_skews_what_is_passed_and_names_what_mends_it() -> None:
    skew = findings(row(("v2",)), **MANUAL, shutter_s=1 / 2000, shutter="electronic")["rolling-shutter"]
    assert skew.severity is Severity.WARNING
    assert "reads its rows in 30 ms (assumed, nobody has published it)" in skew.message
    assert "use the mechanical shutter" in skew.message
    assert findings(row(("v2",)), shutter="mechanical")["rolling-shutter"].severity is Severity.OK
    only_electronic = findings(row(("v2",), "m3t"), shutter="mechanical")["rolling-shutter"]
    assert only_electronic.severity is Severity.WARNING, "the M3T has no mechanical one"
    assert "mechanical" not in only_electronic.message
    measured = replace(row(("v2",)), camera_controls=replace(row().camera_controls, readout_s=1e-4))  # type: ignore[type-var]
    assert findings(measured, shutter="electronic")["rolling-shutter"].severity is Severity.OK


def test_depth_of_field_counts_from_the_pane_to_the_mirror_image_at_infinity() -> None:
    """Wide open, 12 m away: 12.29^2 / (2.8 * 0.003277) / 12000 = 1.37 pixels, of the pane or of the mirror image."""
    wide = findings(row(), aperture=2.8)
    near_m = min(depths[0] for depths in glass_depths_m(Case.of(row(), kiosk())).values())
    expected = 12.29**2 / (2.8 * row().camera.pixel_mm) / (1e3 * near_m)
    assert wide["depth-of-field"].value == pytest.approx(expected, rel=2e-3)
    assert wide["mirror-focus"].value == pytest.approx(expected, rel=2e-3)
    assert wide["mirror-focus"].severity is Severity.NOTE
    assert "f/4 keeps both sharp" in wide["depth-of-field"].message
    assert findings(row(), aperture=4.0)["depth-of-field"].severity is Severity.OK
    near = findings(row(), aperture=2.8, focus="distance", focus_distance_m=12.0)
    assert near["depth-of-field"].severity is Severity.OK, "the pane is sharp"
    assert near["mirror-focus"].severity is Severity.NOTE, "and what it mirrors is not"
    between = findings(row(), aperture=2.8, focus="distance", focus_distance_m=24.0)
    assert between["depth-of-field"].severity is between["mirror-focus"].severity is Severity.OK


def test_the_long_lens_of_the_p1_cannot_hold_both_at_once_and_says_from_where_on_it_can() -> None:
    found = findings(row(profile_id="m350_p1"))
    assert found["mirror-focus"].severity is Severity.WARNING
    assert "keeps both sharp" in found["mirror-focus"].message
    far = replace(row(profile_id="m350_p1", distance_m=36.0))
    assert findings(far)["mirror-focus"].severity is Severity.OK


def test_depths_are_those_along_the_axis_and_only_of_what_is_in_the_picture() -> None:
    (near_m, far_m) = glass_depths_m(Case.of(row(), kiosk()))["v2"]
    assert near_m == pytest.approx(12.0)
    assert far_m == pytest.approx(12.0), "panes of the east side are not seen from there"


def test_depths_of_each_photo_do_not_depend_on_the_others() -> None:
    plan = row()
    turned = replace(plan.viewpoints[0], id="away", heading_deg=plan.viewpoints[0].heading_deg + 180.0)
    together = glass_depths_m(Case.of(replace(plan, viewpoints=(*plan.viewpoints, turned)), kiosk()))
    alone = {}
    for viewpoint in plan.viewpoints:
        alone |= glass_depths_m(Case.of(replace(plan, viewpoints=(viewpoint,), sorties=()), kiosk()))
    assert together.keys() == alone.keys(), "and a photo that covers nothing has none"
    np.testing.assert_allclose(list(together.values()), list(alone.values()), rtol=1e-12)


@pytest.mark.parametrize(
    ("settings", "text"),
    [
        ({"aperture": 1.8}, "the aperture goes from f/2.8 to f/11, f/1.8 cannot be set"),
        ({**MANUAL, "shutter_s": 1 / 4000}, "goes from 8 s to 1/2000 s, not to 1/4000 s; faster ones are electronic"),
        ({"iso": 12_800}, "ISO goes from 100 to 6400, 12800 cannot be set"),
        ({"white_balance_k": 1600}, "colour temperatures go from 2000 to 10000 K"),
        ({"compensation_ev": -4.0}, "exposures are compensated by 3 EV at most"),
        ({"focus": "distance", "focus_distance_m": 0.5}, "the lens focuses from 1 m on"),
    ],
)
def test_what_a_camera_cannot_do_is_told_with_what_it_can(settings: dict[str, object], text: str) -> None:
    found = findings(row(), **settings)["camera"]
    assert found.severity is Severity.WARNING
    assert text in found.message


def test_a_fixed_aperture_counts_as_it_is() -> None:
    m3t = profile("m3t")
    use = camera_use(m3t.camera, m3t.controls, CameraSettings(aperture=5.6), 10.0)
    assert use.f_number == 2.8
    assert list(use.problems()) == ["the aperture is fixed at f/2.8, f/5.6 cannot be set"]
    assert use.shutter == "electronic"


@pytest.mark.parametrize("identifier", sorted(profiles()))
def test_the_usual_settings_can_be_made_on_every_camera(identifier: str) -> None:
    known = profile(identifier)
    use = camera_use(known.camera, known.controls, CameraSettings(), 10.0)
    assert list(use.problems()) == []
    assert known.controls is not None
    assert known.controls.source
    assert known.controls.aperture[0] <= (use.f_number or 0.0) <= known.controls.aperture[1]


@given(st.floats(0.5, 200.0), st.sampled_from(["auto", "lock", "infinity"]))
def test_the_aperture_chosen_is_the_widest_that_holds_all_or_the_last_before_diffraction(
    distance_m: float, focus: FocusMode
) -> None:
    known = profile("m350_p1")
    assert known.controls is not None
    settings = CameraSettings(focus=focus)
    use = camera_use(known.camera, known.controls, settings, distance_m)
    assert use.f_number is not None
    low, _ = known.controls.aperture
    corner = 1.0 / math.hypot(1.0, known.camera.half_width, known.camera.half_height)
    nearest_m = max(corner * distance_m, known.controls.nearest_focus_m)
    limit = sharpest_f_number(known.camera.pixel_mm)
    assert low <= use.f_number <= limit
    stops = [each for each in STOPS if low <= each <= limit]
    is_sharp = worst_defocus_px(known.camera, use.f_number, settings, nearest_m) <= 1.0
    assert is_sharp or use.f_number == stops[-1]
    wider = [each for each in stops if each < use.f_number]
    assert not wider or worst_defocus_px(known.camera, wider[-1], settings, nearest_m) > 1.0


def test_what_depth_of_field_costs_is_said_in_light_and_time() -> None:
    """f/5.6 takes two stops more than f/2.8: four times the shutter time."""
    m3e = profile("m3e")
    use = camera_use(m3e.camera, m3e.controls, CameraSettings(aperture=5.6), 10.0)
    assert use.cost() == ("f/5.6 rather than f/2.8 takes 2.0 stops of light: 4.0 times the shutter time or the ISO")
    assert camera_use(m3e.camera, m3e.controls, CameraSettings(aperture=2.8), 10.0).cost() == ""


def test_a_camera_of_which_nothing_is_known_is_said_so_and_nothing_fails() -> None:
    plan = replace(row(), camera_controls=None, profile="")
    found = findings(plan)
    assert found["camera"].severity is found["depth-of-field"].severity is Severity.NOTE
    assert findings(plan, aperture=5.6)["depth-of-field"].severity is Severity.OK
    assert controls_of(replace(row(), camera_controls=None)) == profile("m3e").controls, "by the profile it names"
    assert camera_use_of(plan).f_number is None


def test_a_photo_nose_to_the_glass_is_no_crash() -> None:
    """Imported missions may do that; the rule about distances says so."""
    plan = row(("v2",))
    close = tuple(replace(v, position_enu_m=(v.position_enu_m[0], -1e-6, v.position_enu_m[2])) for v in plan.viewpoints)
    path = tuple((x, -1e-6, z) if y == -12.0 else (x, y, z) for x, y, z in plan.sorties[0].path_enu_m)
    sortie = replace(plan.sorties[0], path_enu_m=path)
    found = findings(replace(plan, viewpoints=close, sorties=(sortie,)), **MANUAL, shutter_s=1 / 500)
    assert all(finding.value is None or np.isfinite(finding.value) for finding in found.values())


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"exposure": "manual"}, "exposure: manual exposure needs a shutter time and an ISO"),
        ({"focus": "distance"}, "focus: a focus at a distance needs that distance, and no other has one"),
        ({"focus_distance_m": 10.0}, "focus: a focus at a distance needs that distance"),
        ({"aperture": 0.0}, "aperture: expected 0.5 to 64, got 0.0"),
        ({"shutter_s": 0.0}, "shutter_s: expected more than 0 s and at most 60 s, got 0.0"),
        ({"shutter_s": math.nan}, "shutter_s: expected more than 0 s and at most 60 s, got nan"),
        ({"focus": "distance", "focus_distance_m": math.inf}, "focus_distance_m: expected more than 0 m"),
        ({"iso": 0}, "iso: expected 25 to 409600, got 0"),
        ({"white_balance": "tungsten"}, "white_balance: expected kelvin, sunny, cloudy or auto, got 'tungsten'"),
    ],
)
def test_settings_that_no_camera_has_are_refused(values: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        CameraSettings(**values)  # type: ignore[arg-type]


def test_plan_files_keep_the_settings_and_old_ones_have_the_usual(tmp_path) -> None:  # type: ignore[no-untyped-def]
    import json

    settings = CameraSettings("manual", 1 / 500, 5.6, 200, focus="distance", focus_distance_m=25.0)
    plan = replace(row(), camera_settings=settings)
    content = plan_to_json(plan)
    assert plan_of(json.dumps(content).encode(), tmp_path / "plan.json") == plan
    assert "controls" not in content["camera"], "the contract's camera has no more fields"
    del content["camera_settings"], content["camera_controls"]
    old = plan_of(json.dumps(content).encode(), tmp_path / "plan.json")
    assert old.camera_settings == CameraSettings()
    assert isinstance(controls_of(old), CameraControls)

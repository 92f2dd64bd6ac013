"""Pre-flight rules about the camera: what it can set, and what motion and focus do to each photo.

Each effect decides by the plan whether it has to be looked at: photos that are taken at a hover have no motion blur.
What is mirrored lies behind the pane, up to infinity (sky), so a photo needs depth of field from the nearest pane on.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planning.aircraft.camera_use import SHARP_PX, CameraUse, camera_use_of, focus_text
from planning.base.effects import Assessment, Decision, decide
from planning.base.errors import InfeasibleError
from planning.base.findings import Finding, Severity
from planning.base.messages import joined, say
from planning.checks.case import NEAREST_GLASS_M, Case, Rule, judge, pose_of
from planning.geo.frames import heading_difference_rad
from planning.motion.timing import MotionLimits, motion_limits, sortie_flight_path, speed_limits_m_s
from planning.optics import STOPS, sharpest_f_number, shutter_text, shutter_within, smear_px
from planning.plan import Plan, Sortie, Viewpoint, viewpoint_arrays

Array = NDArray[np.float64]

BLURRED_PX = 2.0
"""Circle of confusion from which on a photo shows less than its pixels hold: two are the finest that they resolve."""

USUAL_READOUT_S = 0.03
"""Of an electronic shutter whose readout nobody has published: OpenDroneMap's default, the middle of its table."""


def camera_settings(case: Case) -> Iterator[Finding]:
    """The camera can do what is wanted of it."""
    use = camera_use_of(case.plan)
    if use.controls is None:
        text = say("what can be set on this camera is not known, so its settings are not checked: {}", use.summary())
        yield Finding(Severity.NOTE, "camera", text)
        return
    problems = list(use.problems())
    for problem in problems:
        yield Finding(Severity.WARNING, "camera", say("this camera cannot do what is wanted: {}", problem))
    if not problems:
        yield Finding(Severity.OK, "camera", use.summary())


# What moves while a photo is taken.


@dataclass(frozen=True, slots=True)
class PhotoMotion:
    """How a camera moves at a photo: speed, turn of nose and gimbal together, and GSD at the nearest pane it shows."""

    viewpoint_id: str
    speed_m_s: float
    turn_rad_s: float
    gsd_m: float

    def smear_px(self, time_s: float, pixel_angle_rad: float) -> float:
        """How far the picture moves in a time."""
        return smear_px(time_s, self.speed_m_s, self.turn_rad_s, self.gsd_m, pixel_angle_rad)


def photo_motions(case: Case) -> tuple[PhotoMotion, ...]:
    """Motion at each photo that is taken in passing. All others are taken at rest, after settling, and move not at all.

    Speeds are those that the aircraft may have there: the highest allowed, as far as it can get from one stop and to
    the next with its acceleration. None where nothing can fly.
    """
    plan = case.plan
    try:
        limits = motion_limits(plan.aircraft, plan.rules)
    except InfeasibleError:  # the rule about durations says so
        return ()
    by_id = {viewpoint.id: viewpoint for viewpoint in plan.viewpoints}
    return tuple(
        motion
        for sortie in plan.sorties
        if sortie.in_passing_ids
        for motion in _sortie_motions(case, sortie, by_id, limits)
    )


def _sortie_motions(
    case: Case, sortie: Sortie, by_id: dict[str, Viewpoint], limits: MotionLimits
) -> Iterator[PhotoMotion]:
    plan = case.plan
    timed = sortie_flight_path(sortie, by_id, plan.aircraft, plan.rules, stop_at_corners=False)
    if timed is None:
        return
    flown, vertices = timed
    lengths_m = np.linalg.norm(flown.deltas_enu_m, axis=1)
    along_m = np.concatenate([[0.0], np.cumsum(lengths_m)])
    stops_m = along_m[flown.is_stop]
    leg_m_s = np.where(lengths_m > 0.0, speed_limits_m_s(flown.deltas_enu_m, limits), 0.0)
    fastest_m_s = np.maximum(np.append(leg_m_s, 0.0), np.insert(leg_m_s, 0, 0.0))
    views = viewpoint_arrays(tuple(by_id[name] for name in sortie.viewpoint_ids))
    turns_rad = np.hypot(
        heading_difference_rad(views.heading_rad[:-1], views.heading_rad[1:]), np.diff(views.pitch_rad)
    )
    stretches_m = np.diff(along_m[vertices])
    # A picture that has to turn without way to do it on turns as fast as it can.
    per_metre = np.where(stretches_m > 0.0, turns_rad / np.where(stretches_m > 0.0, stretches_m, 1.0), math.inf)
    per_metre = np.where(turns_rad > 0.0, per_metre, 0.0)
    per_metre = np.maximum(np.append(per_metre, 0.0), np.insert(per_metre, 0, 0.0))
    passing = frozenset(sortie.in_passing_ids)
    for number, (name, vertex) in enumerate(zip(sortie.viewpoint_ids, vertices.tolist(), strict=True)):
        if name not in passing or flown.is_stop[vertex]:
            continue
        to_stop_m = float(np.abs(stops_m - along_m[vertex]).min())
        speed_m_s = min(float(fastest_m_s[vertex]), math.sqrt(2.0 * limits.acceleration_m_s2 * to_stop_m))
        turn_rad_s = min(float(per_metre[number]) * speed_m_s, limits.yaw_rate_rad_s) if speed_m_s > 0.0 else 0.0
        nearest_m = case.measures.nearest_m[pose_of(by_id[name])]
        yield PhotoMotion(name, speed_m_s, turn_rad_s, plan.camera.gsd_m(max(nearest_m, NEAREST_GLASS_M)))


@dataclass(frozen=True, slots=True)
class _Smear:
    """Motions, how long each picture moves (None: not known), and the angle of a pixel."""

    motions: tuple[PhotoMotion, ...]
    time_s: float | None
    pixel_angle_rad: float

    def worst(self) -> tuple[float, PhotoMotion | None]:
        """Largest smear, in pixels for the time, or for a second where that is not known, and where."""
        time_s = 1.0 if self.time_s is None else self.time_s
        found = [(each.smear_px(time_s, self.pixel_angle_rad), each) for each in self.motions]
        return max(found, key=lambda pair: pair[0], default=(0.0, None))


HALF_PX = 0.5
"""Less than what neighbouring pixels blur into each other."""


class MotionBlur:
    """The effect: smear while the shutter is open; off where all photos are taken at a hover, or move that little."""

    name = say("motion blur")
    unit = "px"
    tolerance = HALF_PX

    def assess(self, scene: _Smear) -> Assessment:
        """Largest smear; where the shutter time is not known, that of a second."""
        if not scene.motions:
            return Assessment(0.0, say("all photos are taken at a hover, so none is blurred by motion"), 0.0)
        fastest = max(each.speed_m_s for each in scene.motions)
        reason = say("photos taken in passing: {}, at up to {:.1f} m/s", len(scene.motions), fastest)
        return Assessment(scene.worst()[0], reason, 0.0)


class RollingShutter:
    """The effect: skew between the first row and the last; off with a mechanical shutter, or where all hover."""

    name = say("rolling shutter")
    unit = "px"
    tolerance = HALF_PX

    def assess(self, scene: _Smear) -> Assessment:
        """Largest skew."""
        if scene.time_s == 0.0:
            return Assessment(0.0, say("the mechanical shutter takes all rows at once"), 0.0)
        if not scene.motions:
            return Assessment(0.0, say("all photos are taken at a hover, so the electronic shutter skews none"), 0.0)
        return Assessment(scene.worst()[0], say("rows are read one after the other"), 0.0)


def _while_open(case: Case) -> _Smear:
    """What moves while the shutter is open."""
    plan = case.plan
    return _Smear(photo_motions(case), plan.camera_settings.shutter_s, plan.camera.pixel_angle_rad)


def _while_read(case: Case) -> _Smear:
    """What moves between the first row and the last."""
    use, readout_s = camera_use_of(case.plan), 0.0
    if use.shutter == "electronic":
        known_s = None if use.controls is None else use.controls.readout_s
        readout_s = USUAL_READOUT_S if known_s is None else known_s
    return _Smear(photo_motions(case), readout_s, case.plan.camera.pixel_angle_rad)


def motion_blur(case: Case) -> Iterator[Finding]:
    """Photos are not smeared by more than a pixel while the shutter is open."""
    plan, scene = case.plan, _while_open(case)
    decision, (worst_px, motion) = decide(MotionBlur(), scene), scene.worst()
    if motion is None or worst_px <= 0.0:
        yield Finding(Severity.OK, "motion-blur", decision.reason, "", 0.0, SHARP_PX, "px")
        return
    if scene.time_s is None:
        text = say(
            "{}, and the camera chooses the shutter time; no longer than {} keeps motion blur within a pixel: set it",
            decision.reason,
            shutter_text(shutter_within(SHARP_PX / worst_px)),
        )
        yield Finding(Severity.WARNING, "motion-blur", text, motion.viewpoint_id)
        return
    advice = _sharp_motion(motion, scene.time_s, worst_px, plan)
    subject = say("{}; motion blur at {}", decision.reason, shutter_text(scene.time_s))
    yield judge(
        worst_px <= SHARP_PX * (1.0 + 1e-9),
        "motion-blur", subject, worst_px, SHARP_PX, "px", motion.viewpoint_id, advice, Severity.WARNING,
    )  # fmt: skip


def _sharp_motion(motion: PhotoMotion, time_s: float, worst_px: float, plan: Plan) -> str:
    """What to change: the shutter time, or the speed where that is enough."""
    shutter = shutter_text(shutter_within(time_s * SHARP_PX / worst_px))
    speed_m_s = (SHARP_PX / time_s - motion.turn_rad_s / plan.camera.pixel_angle_rad) * motion.gsd_m
    speed_m_s = math.floor(10.0 * speed_m_s) / 10.0
    if speed_m_s <= 0.0:
        return say("{} keeps it sharp, or a stop for each photo", shutter)
    return say("{} or {:.1f} m/s keep it sharp, or a stop for each photo", shutter, speed_m_s)


def rolling_shutter(case: Case) -> Iterator[Finding]:
    """An electronic shutter does not skew photos by more than a pixel."""
    use = camera_use_of(case.plan)
    controls, scene = use.controls, _while_read(case)
    readout_s = scene.time_s or 0.0
    decision, (worst_px, motion) = decide(RollingShutter(), scene), scene.worst()
    if motion is None or worst_px <= 0.0:
        yield Finding(Severity.OK, "rolling-shutter", decision.reason, "", 0.0, SHARP_PX, "px")
        return
    subject = say("skew of a photo by the electronic shutter, which reads its rows in {:.0f} ms", 1e3 * readout_s)
    if controls is None or controls.readout_s is None:
        subject = say("{} (assumed, nobody has published it)", subject)
    advice = say("use the mechanical shutter") if controls is None or controls.mechanical_shutter_s else ""
    speed_m_s = math.floor(10.0 * SHARP_PX / readout_s * motion.gsd_m) / 10.0
    slower = (
        say("stop for each photo") if speed_m_s <= 0.0 else say("fly at {:.1f} m/s, or stop for each photo", speed_m_s)
    )
    advice = joined(say(", or "), [each for each in (advice, slower) if each])
    yield judge(
        worst_px <= SHARP_PX * (1.0 + 1e-9),
        "rolling-shutter", subject, worst_px, SHARP_PX, "px", motion.viewpoint_id, advice, Severity.WARNING,
    )  # fmt: skip


# What is in focus.


def glass_depths_m(case: Case) -> dict[str, tuple[float, float]]:
    """Nearest and farthest glass in each photo along its axis, by viewpoint; without photos that cover no panel."""
    measured = ((each.id, case.measures.glass_m[pose_of(each)]) for each in case.plan.viewpoints)
    return {name: (nearest_m, farthest_m) for name, (nearest_m, farthest_m) in measured if nearest_m <= farthest_m}


@dataclass(frozen=True, slots=True)
class Defocus:
    """Largest circles of confusion of a plan, in pixels: of panes, and of what they mirror; where, and how near."""

    pane_px: float
    pane_at: str
    mirror_px: float
    mirror_at: str
    nearest_m: float


def worst_defocus(case: Case, use: CameraUse, f_number: float) -> Defocus | None:
    """Defocus over all photos; None where no photo shows glass.

    An automatic focus may settle on a pane or on what it mirrors, so the worse of both counts. One that is locked does
    so at the first photo of its sortie.
    """
    depths, lens, settings = glass_depths_m(case), case.plan.camera.lens(f_number), use.settings
    if not depths:
        return None
    names, ends_m = list(depths), np.array(list(depths.values()))
    if settings.focus in ("auto", "lock"):
        focuses_m = np.full((len(names), 3), math.inf)
        focuses_m[:, :2] = _focused_on_m(case, depths, settings.focus == "lock")
    else:
        focuses_m = np.full((len(names), 1), settings.focus_distance_m or math.inf)
    pane_px = lens.defocus_px(focuses_m[:, :, None], ends_m[:, None, :]).max(axis=(1, 2))
    mirror_px = lens.defocus_px(focuses_m, np.full_like(focuses_m, math.inf)).max(axis=1)
    worst = (float(pane_px.max()), names[int(pane_px.argmax())], float(mirror_px.max()), names[int(mirror_px.argmax())])
    return Defocus(*worst, float(ends_m[:, 0].min()))


def _focused_on_m(case: Case, depths: Mapping[str, tuple[float, float]], is_locked: bool) -> Array:
    """Nearest and farthest glass that an automatic focus may settle on, of each photo, shape (n, 2)."""
    first = {name: name for name in depths}
    if is_locked:
        for sortie in case.plan.sorties:
            showing = [name for name in sortie.viewpoint_ids if name in depths]
            first |= dict.fromkeys(showing, showing[0]) if showing else {}
    return np.array([depths[first[name]] for name in depths])


class DepthOfField:
    """The effect: circles that points of panes and of mirror images become out of focus."""

    name = say("depth of field")
    unit = "px"
    tolerance = HALF_PX

    def assess(self, scene: Defocus | None) -> Assessment:
        """The largest circle."""
        if scene is None:
            return Assessment(0.0, say("no photo shows glass"), 0.0)
        reason = say("panes are out of focus by {:.1f} px, mirror images by {:.1f} px", scene.pane_px, scene.mirror_px)
        return Assessment(max(scene.pane_px, scene.mirror_px), reason, 0.0)


def camera_effects(case: Case) -> tuple[Decision, ...]:
    """What the camera does to photos of a plan, and whether it shows; depth of field where the aperture is known."""
    use = camera_use_of(case.plan)
    found = [decide(MotionBlur(), _while_open(case)), decide(RollingShutter(), _while_read(case))]
    if use.f_number is not None:
        found.append(decide(DepthOfField(), worst_defocus(case, use, use.f_number)))
    return tuple(found)


def depth_of_field(case: Case) -> Iterator[Finding]:
    """Panes and what they mirror are in focus together."""
    use = camera_use_of(case.plan)
    if use.f_number is None:
        text = say("the aperture is not known, so depth of field is not checked; state it")
        yield Finding(Severity.NOTE, "depth-of-field", text)
        return
    found = worst_defocus(case, use, use.f_number)
    if found is None:
        return
    focus_m = math.inf if use.settings.focus_distance_m is None else use.settings.focus_distance_m
    sharp_from_m, sharp_to_m = case.plan.camera.lens(use.f_number).sharp_between_m(focus_m)
    at = say("f/{:g}, {}", use.f_number, focus_text(use.settings))
    if math.isfinite(sharp_to_m):
        at = say("{}: sharp from {:.1f} to {:.1f} m", at, sharp_from_m, sharp_to_m)
    elif math.isfinite(focus_m):
        at = say("{}: sharp from {:.1f} m on", at, sharp_from_m)
    else:
        at = say("{}: sharp from {:.1f} m on wherever it focuses", at, sharp_from_m)
    advice = _sharp_focus(case, use, use.f_number, found)
    mirror = say("what panes mirror, behind them up to infinity, out of focus")
    for code, subject, value, place in (
        ("depth-of-field", say("panes out of focus ({})", at), found.pane_px, found.pane_at),
        ("mirror-focus", mirror, found.mirror_px, found.mirror_at),
    ):
        severity = Severity.NOTE if value <= BLURRED_PX else Severity.WARNING
        yield judge(value <= SHARP_PX, code, subject, value, SHARP_PX, "px", place, advice, severity)


def _sharp_focus(case: Case, use: CameraUse, f_number: float, found: Defocus) -> str:
    """What to change: the aperture, where that is possible without diffraction, else focus distance or safety distance.

    Focused at twice the nearest distance, that and infinity are out of focus alike, by half as much.
    """
    camera, controls = case.plan.camera, use.controls
    low, high = (f_number, f_number) if controls is None else controls.aperture
    largest = min(high, max(low, sharpest_f_number(camera.pixel_mm)))
    largest = max([low, *(each for each in STOPS if each <= largest)])
    wanted = f_number * max(found.pane_px, found.mirror_px)
    advice: list[object] = []
    stop = next((each for each in (*STOPS, high) if each >= wanted * (1.0 - 1e-9)), math.inf)
    if stop <= largest:
        advice.append(say("f/{:g} keeps both sharp", stop))
    best_m = 2.0 * found.nearest_m
    if use.settings.focus_distance_m is None or abs(use.settings.focus_distance_m / best_m - 1.0) > 0.05:
        least = max(low, f_number * camera.lens(f_number).defocus_px(best_m, math.inf) / SHARP_PX)
        stop = next((each for each in (*STOPS, high) if each >= least * (1.0 - 1e-9)), math.inf)
        if stop <= largest:
            advice.append(say("with the focus at {:.0f} m f/{:g} is enough", best_m, stop))
    if not advice:
        farther_m = found.nearest_m * wanted / largest
        advice.append(say("from {:.0f} m on f/{:g} keeps both sharp", math.ceil(farther_m), largest))
    return joined(say(", or "), advice)


CAMERA_RULES: tuple[Rule, ...] = (camera_settings, motion_blur, rolling_shutter, depth_of_field)

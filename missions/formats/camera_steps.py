"""What of a camera's settings a mission sets itself, and what is left for the pilot, in the order of the menus.

WPML sets the focus and nothing else of this: it has no exposure, ISO, shutter, aperture or white balance. MAVLink items
set what the camera takes from them, which its profile says.
"""

from __future__ import annotations

from dataclasses import dataclass

from missions.dji.wpml import dji_catalogue
from missions.mavlink.autopilots import Autopilot
from missions.mavlink.items import digicam_exposure
from missions.mission.export_choices import FileFormat
from planning.aircraft.camera_use import FOCUSES, CameraUse, camera_use_of, focus_text
from planning.base.findings import Finding, Severity
from planning.base.messages import joined, say
from planning.optics import shutter_text
from planning.plan import Plan

MAVLINK = (FileFormat.MAVLINK_PLAN, FileFormat.MAVLINK_WPL)


@dataclass(frozen=True, slots=True)
class CameraSteps:
    """Settings of a flight's camera, one line each: those that the mission sets, and those to be set by hand."""

    by_mission: tuple[str, ...]
    by_hand: tuple[str, ...]

    def findings(self) -> tuple[Finding, ...]:
        """What a pilot has to know of a mission file."""
        if not self.by_hand:
            return ()
        text = say(
            "the format cannot set all of the camera; set by hand before take-off: {}", joined("; ", self.by_hand)
        )
        return (Finding(Severity.NOTE, "camera-by-hand", text),)


def camera_steps(plan: Plan, file_format: str = "", autopilot: Autopilot | None = None) -> CameraSteps:
    """What is set by whom.

    Parameters
    ----------
    file_format
        Of the mission; "": that of the plan's aircraft. Tables and views to look at set nothing.
    autopilot
        Whose rules a MAVLink mission follows; None: that of the plan's aircraft.
    """
    use = camera_use_of(plan)
    if not file_format:
        file_format = FileFormat.DJI_KMZ if plan.profile in dji_catalogue().profiles else FileFormat.MAVLINK_PLAN
    autopilot = autopilot or (Autopilot.PX4 if plan.profile == Autopilot.PX4 else Autopilot.ARDUPILOT)
    by_mission = _by_mission(plan, use, file_format, autopilot)
    steps = [step for name, step in _steps(use) if name not in by_mission]
    return CameraSteps(tuple(by_mission.values()), tuple(steps))


def _by_mission(plan: Plan, use: CameraUse, file_format: str, autopilot: Autopilot) -> dict[str, str]:
    """What a mission sets, by the names of `_steps`."""
    settings, found = use.settings, dict[str, str]()
    if file_format == FileFormat.DJI_KMZ:
        profile = dji_catalogue().profiles.get(plan.profile)
        if profile is None:
            return {}
        takes_actions = profile.focus and (profile.infinity or settings.focus != "infinity")
        if settings.focus != "distance" and (takes_actions or (profile.focus_mode and settings.focus == "lock")):
            found["focus"] = FOCUSES[settings.focus]
    elif file_format in MAVLINK and use.controls is not None:
        exposure = digicam_exposure(settings, use.f_number)
        if "exposure" in use.controls.mavlink and autopilot is Autopilot.ARDUPILOT and exposure is not None:
            found |= {name: step for name, step in _steps(use) if name in ("mode", "iso", "shutter", "aperture")}
        if "focus" in use.controls.mavlink and (settings.focus != "distance" or autopilot is Autopilot.PX4):
            found["focus"] = focus_text(settings)
    return found


def _steps(use: CameraUse) -> list[tuple[str, str]]:
    """All settings in the order of the menus: exposure from left to right, then focus, colour and shutter."""
    settings = use.settings
    is_manual = settings.exposure == "manual"
    has_shutter, has_aperture = settings.shutter_s is not None, use.f_number is not None and not _is_fixed(use)
    steps: list[tuple[str, str]] = []
    if is_manual or (has_shutter and has_aperture):
        steps.append(("mode", say("exposure mode M")))
    elif has_shutter:
        steps.append(("mode", say("exposure mode S (shutter priority)")))
    elif has_aperture:
        steps.append(("mode", say("exposure mode A (aperture priority)")))
    else:
        steps.append(("mode", say("exposure mode P (automatic)")))
    steps.append(("iso", say("ISO automatic") if settings.iso is None else f"ISO {settings.iso}"))
    if settings.shutter_s is not None:
        steps.append(("shutter", say("shutter time {}", shutter_text(settings.shutter_s))))
    if use.f_number is not None and not _is_fixed(use):
        steps.append(("aperture", say("aperture f/{:g}", use.f_number)))
    if not is_manual:
        steps.append(("compensation", say("exposure compensation {} EV", _signed(settings.compensation_ev))))
    if settings.exposure == "locked":
        text = say("exposure lock (AE) on, with the facade filling the picture, and left on for the whole sortie")
        steps.append(("lock", text))
    if settings.focus_distance_m is not None:
        focus = say("manual focus (MF) on something {:g} m away", settings.focus_distance_m)
    elif settings.focus == "infinity":
        focus = say("manual focus (MF) at infinity")
    elif settings.focus == "lock":
        focus = say("single automatic focus (AF-S) on the facade, then manual (MF)")
    else:
        focus = say("automatic focus (AF)")
    steps.append(("focus", focus))
    if settings.white_balance == "kelvin":
        steps.append(("white balance", say("white balance manual, {:g} K", settings.white_balance_k)))
    else:
        words = {"sunny": say("white balance sunny"), "cloudy": say("white balance cloudy")}
        steps.append(("white balance", words.get(settings.white_balance, say("white balance automatic"))))
    controls = use.controls
    if controls is not None and controls.mechanical_shutter_s and controls.electronic_shutter_s:
        is_mechanical = use.shutter == "mechanical"
        steps.append(("kind", say("mechanical shutter on") if is_mechanical else say("mechanical shutter off")))
    return steps


def _signed(value: float) -> str:
    return f"{value:+g}" if value else "0"


def _is_fixed(use: CameraUse) -> bool:
    return use.controls is not None and use.controls.aperture[0] == use.controls.aperture[1]

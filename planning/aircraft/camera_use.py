"""What a camera does with the settings of a flight: the aperture and shutter that come of them, what it cannot do."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

from planning.aircraft.catalogue import profiles
from planning.base.messages import joined, say
from planning.optics import STOPS, CameraControls, sharpest_f_number, shutter_text
from planning.parameters import CameraSettings, ShutterKind
from planning.plan import Camera, Plan

SHARP_PX = 1.0
"""Circle of confusion that counts as sharp, and smear that does."""

FOCUSES = {
    "auto": say("automatic focus before each photo"),
    "lock": say("automatic focus before the first photo, then locked"),
    "infinity": say("focus at infinity"),
}


@dataclass(frozen=True, slots=True)
class CameraUse:
    """A camera with the settings of a flight.

    Parameters
    ----------
    f_number
        The one stated, of a fixed aperture the camera's, else chosen; None where nobody knows what the camera has.
    is_chosen
        Whether this program chose it.
    shutter
        The shutter that opens; the one wanted where nobody knows what the camera has.
    """

    camera: Camera
    controls: CameraControls | None
    settings: CameraSettings
    f_number: float | None
    is_chosen: bool
    shutter: ShutterKind

    def problems(self) -> Iterator[str]:
        """What the camera cannot do of what is wanted, with what it can; none where its controls are not known."""
        controls, wanted = self.controls, self.settings
        if controls is None:
            return
        low, high = controls.aperture
        if wanted.aperture is not None and not low - 0.05 <= wanted.aperture <= high + 0.05:
            if low == high:
                yield say("the aperture is fixed at f/{:g}, f/{:g} cannot be set", low, wanted.aperture)
            else:
                yield say("the aperture goes from f/{:g} to f/{:g}, f/{:g} cannot be set", low, high, wanted.aperture)
        if wanted.iso is not None and not controls.iso[0] <= wanted.iso <= controls.iso[1]:
            yield say("ISO goes from {} to {}, {} cannot be set", *controls.iso, wanted.iso)
        if wanted.shutter_s is not None:
            yield from self._shutter_problems(controls, wanted.shutter_s)
        if wanted.white_balance not in controls.white_balances or (
            wanted.white_balance == "kelvin" and controls.white_balance_k is None
        ):
            known = ", ".join(controls.white_balances)
            yield say("the white balance '{}' cannot be set; it has {}", wanted.white_balance, known)
        elif wanted.white_balance == "kelvin" and controls.white_balance_k is not None:
            coldest, warmest = controls.white_balance_k
            if not coldest <= wanted.white_balance_k <= warmest:
                yield say("colour temperatures go from {} to {} K", coldest, warmest)
        if abs(wanted.compensation_ev) > controls.compensation_ev:
            yield say("exposures are compensated by {:g} EV at most", controls.compensation_ev)
        if wanted.focus not in controls.focus:
            yield say("the focus '{}' cannot be set; it has {}", wanted.focus, ", ".join(controls.focus))
        if wanted.focus_distance_m is not None and wanted.focus_distance_m < controls.nearest_focus_m:
            yield say("the lens focuses from {:g} m on", controls.nearest_focus_m)

    def _shutter_problems(self, controls: CameraControls, shutter_s: float) -> Iterator[str]:
        shortest, longest = controls.shutter_times_s(self.shutter)
        if not shortest * 0.99 <= shutter_s <= longest * 1.01:
            advice = say("choose another time")
            if self.shutter == "mechanical" and controls.electronic_shutter_s is not None:
                advice = say("faster ones are electronic, and skew what moves")
            times = shutter_text(longest), shutter_text(shortest), shutter_text(shutter_s)
            yield (
                say("the mechanical shutter goes from {} to {}, not to {}; {}", *times, advice)
                if self.shutter == "mechanical"
                else say("the electronic shutter goes from {} to {}, not to {}; {}", *times, advice)
            )

    def cost(self) -> str:
        """What depth of field costs: light, and with it shutter time; empty where the aperture is wide open."""
        if self.controls is None or self.f_number is None or self.f_number <= self.controls.aperture[0]:
            return ""
        factor = (self.f_number / self.controls.aperture[0]) ** 2
        return say(
            "f/{:g} rather than f/{:g} takes {:.1f} stops of light: {:.1f} times the shutter time or the ISO",
            *(self.f_number, self.controls.aperture[0], math.log2(factor), factor),
        )

    def summary(self) -> str:
        """All that is set, in one line."""
        wanted = self.settings
        parts: list[object] = [
            {
                "auto": say("each photo exposed by itself"),
                "locked": say("exposure measured once, then locked"),
                "manual": say("manual exposure"),
            }[wanted.exposure]
        ]
        parts += [] if wanted.shutter_s is None else [shutter_text(wanted.shutter_s)]
        parts += [] if self.f_number is None else [f"f/{self.f_number:g}"]
        parts += [] if wanted.iso is None else [f"ISO {wanted.iso}"]
        if wanted.compensation_ev and wanted.exposure != "manual":
            parts.append(f"{wanted.compensation_ev:+g} EV")
        parts.append(white_balance_text(wanted))
        parts.append(focus_text(wanted))
        parts.append(say("mechanical shutter") if self.shutter == "mechanical" else say("electronic shutter"))
        return joined(", ", parts)


def white_balance_text(settings: CameraSettings) -> str:
    """The white balance in words."""
    match settings.white_balance:
        case "kelvin":
            return say("white balance {:g} K", settings.white_balance_k)
        case "sunny":
            return say("white balance for sun")
        case "cloudy":
            return say("white balance for clouds")
        case _:
            return say("automatic white balance")


def focus_text(settings: CameraSettings) -> str:
    """The focus in words."""
    if settings.focus_distance_m is not None:
        return say("focus at {:g} m", settings.focus_distance_m)
    return FOCUSES[settings.focus]


@lru_cache(maxsize=64)
def camera_use(
    camera: Camera, controls: CameraControls | None, settings: CameraSettings, min_distance_m: float
) -> CameraUse:
    """What a camera does with some settings.

    An aperture that nobody states is the widest at which everything from the nearest pane to the farthest mirror image
    is sharp to a pixel, wherever the focus comes to lie; but none at which diffraction blurs more than that.

    Parameters
    ----------
    min_distance_m
        Of views to panes. Along the axis a pane in the corner of the picture is nearer than that.
    """
    if controls is None:
        return CameraUse(camera, controls, settings, settings.aperture, False, settings.shutter)
    low, high = controls.aperture
    kind = controls.shutter_kind(settings.shutter)
    if settings.aperture is not None or low == high:
        return CameraUse(camera, controls, settings, low if low == high else settings.aperture, False, kind)
    corner = 1.0 / math.hypot(1.0, camera.half_width, camera.half_height)
    nearest_m = max(min_distance_m * corner, controls.nearest_focus_m)
    largest = max(low, min(high, sharpest_f_number(camera.pixel_mm)))
    stops = [low, *(each for each in STOPS if low < each <= largest)]
    chosen = next(
        (each for each in stops if worst_defocus_px(camera, each, settings, nearest_m) <= SHARP_PX), stops[-1]
    )
    return CameraUse(camera, controls, settings, chosen, True, kind)


def worst_defocus_px(camera: Camera, f_number: float, settings: CameraSettings, nearest_m: float) -> float:
    """Largest circle of confusion between a nearest pane and infinity, wherever an automatic focus comes to lie."""
    lens = camera.lens(f_number)
    focus_m = math.inf if settings.focus_distance_m is None else settings.focus_distance_m
    return max(lens.defocus_px(focus_m, nearest_m), lens.defocus_px(focus_m, math.inf))


def controls_of(plan: Plan) -> CameraControls | None:
    """What can be set on a plan's camera: as it says, else as the profile that it names has it."""
    if plan.camera_controls is not None or not plan.profile:
        return plan.camera_controls
    known = profiles().get(plan.profile)
    return known.controls if known is not None and known.camera == plan.camera else None


def camera_use_of(plan: Plan) -> CameraUse:
    """What a plan's camera does."""
    return camera_use(plan.camera, controls_of(plan), plan.camera_settings, plan.constraints.min_distance_m)

"""What can be asked of rendered photos, and what their effects are called; it loads nothing that renders."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

from planning.base.effects import Decision, EffectSetting
from planning.base.errors import InputError
from planning.base.messages import say
from planning.base.parameters import check, parameter
from planning.parameters import DEFAULT_PROFILE, LARGEST_SEED

NEAR_FIELD, FRESNEL, SECOND_BOUNCE = say("near-field reflection"), "Fresnel", say("second bounce")
TILT, DOUBLING, SHADOW = say("panel tilt"), say("pane doubling"), "shadow"
CURVATURE, INTERIOR, SUN_GLARE, OCCLUSION = "curvature", say("interior see-through"), say("sun glare"), "occlusion"
SKY_OCCLUSION = say("sky occlusion")
DISTORTION, VIGNETTING, NOISE = say("lens distortion"), "vignetting", "noise"
MOTION_BLUR, EXPOSURE = say("motion blur"), say("exposure changes")
DEPTH_OF_FIELD = say("depth of field")
POSITION_ERROR, GIMBAL_ERROR = say("position error"), say("gimbal error")

ROWS, MOST_ROWS = 1024, 8192
"""Of the picture of the surroundings, and at most: 2 GB."""

MITSUBA_RAYS = 64

DEFAULT_VIEWS, MAX_VIEWS = 24, 20_000

WIDTHS_PX = (16, 20_000)
"""Narrower pictures show nothing, wider ones no camera takes."""

DEFAULT_POINTS = 100_000
"""As many as `prepare` writes."""


@dataclass(frozen=True, slots=True)
class RenderSettings:
    """How photographs are made.

    Parameters
    ----------
    samples
        Rays along each side of a pixel; `auto` takes one, and several where detail calls for it.
    effects
        By name of the effect: on, off, or left to scene and flight; what is not named is left to them.
    tolerance
        How much more than its stated tolerance an effect may change pictures and still be left out.
    environment_rows
        Of the picture of the surroundings that takes the near field's place where that is left out: finer or sooner
        there.
    mitsuba_rays
        Through each pixel, where the light is Mitsuba's; None for that of `Renderer`.

    Raises
    ------
    InputError
        The samples, or the rows of the surroundings, make no sense.
    ValueError
        The tolerance or Mitsuba's rays are out of range.
    """

    samples: int | Literal["auto"] = "auto"
    effects: Mapping[str, EffectSetting] = field(default_factory=dict)
    tolerance: float = parameter(
        1.0,
        "times each effect's own tolerance",
        above=0.0,
        expected="a factor above 0",
        option="--tolerance",
        metavar="X",
    )
    environment_rows: int = ROWS
    mitsuba_rays: int | None = parameter(
        None,
        "through each pixel, by Mitsuba",
        name="rays",
        least=1,
        most=1 << 20,
        option="--rays",
        metavar="N",
        unset=str(MITSUBA_RAYS),
    )

    def __post_init__(self) -> None:
        if self.samples != "auto" and not 1 <= self.samples <= 32:
            raise InputError(say("samples: expected 1 to 32 along a pixel's side, or auto, got {}", self.samples))
        if not 2 <= self.environment_rows <= MOST_ROWS:
            raise InputError(
                say("expected 2 to {}, got {}", MOST_ROWS, self.environment_rows, place="environment_rows")
            )
        check(self)

    def decided(self, decisions: Iterable[Decision]) -> RenderSettings:
        """With decisions in place of what was left to scene and flight."""
        return replace(self, effects={**self.effects, **{d.effect: "on" if d.on else "off" for d in decisions}})

    def is_on(self, effect: str) -> bool:
        """Whether an effect is simulated; what nobody has decided yet is."""
        return self.effects.get(effect, "auto") != "off"


@dataclass(frozen=True, slots=True)
class SceneRequest:
    """What is to be photographed, from where, and how.

    Parameters
    ----------
    scene
        Name of a bundled scene where there is no file of that name; else path of a site file.
    plan, flight
        Views of a plan; or the poses of a flight, with the plan's camera, and with its angles where the flight knows
        none.
    profile_id
        Whose camera takes photos that no plan says the camera of.
    look, camera
        Files with the look of a site's scene, and with how photos are taken.
    """

    scene: str
    plan: Path | None = None
    flight: Path | None = None
    n_views: int | None = parameter(
        None,
        "number of views to plan",
        name="views",
        least=1,
        most=MAX_VIEWS,
        option="--views",
        metavar="N",
        unset=str(DEFAULT_VIEWS),
    )
    n_square: int | None = parameter(
        None,
        "number of views square to the facades instead, as a first flight takes them",
        least=1,
        most=MAX_VIEWS,
        option="--square",
        metavar="N",
    )
    profile_id: str = DEFAULT_PROFILE
    look: Path | None = None
    camera: Path | None = None
    seed: int = parameter(0, "of everything random", least=0, most=LARGEST_SEED, option="--seed", metavar="N")
    width_px: int | None = parameter(
        1024, "of the photos, in pixels", least=WIDTHS_PX[0], most=WIDTHS_PX[1], option="--width", metavar="PX"
    )
    n_points: int = parameter(
        DEFAULT_POINTS, "points that reconstruction starts from", least=0, option="--points", metavar="N"
    )
    settings: RenderSettings = field(default_factory=RenderSettings)

    def __post_init__(self) -> None:
        check(self)

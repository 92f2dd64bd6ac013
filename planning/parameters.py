"""What can be set for a plan, each parameter declared once. Light to import, since the command line reads it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from planning.base.effects import EffectSetting
from planning.base.messages import say
from planning.base.parameters import Choice, check, parameter

Precision = Literal["f32", "f64"]
"""Of the coverage kernel; single precision is faster and differs on section borders only (docs/benchmarks.md)."""

Objective = Literal["image-error", "sections"]
"""What views are chosen for: the expected error of a model's pictures, or hemisphere sections (paper Eq. 10)."""

ExposureMode = Literal["auto", "locked", "manual"]
"""Of the photos of a sortie: each by itself, all as the camera measures before the first, or all as it is stated."""

WhiteBalance = Literal["auto", "sunny", "cloudy", "kelvin"]

FocusMode = Literal["auto", "lock", "infinity", "distance"]
"""Before each photo; before the first and then no more; at infinity; at a distance that is stated."""

ShutterKind = Literal["mechanical", "electronic"]

SHUTTER_TIMES_S = tuple(
    1.0 / each for each in (2000, 1600, 1250, 1000, 800, 640, 500, 400, 320, 240, 200, 160, 120, 100)
)
"""Third stops, offered in lists; any other time can be typed."""

DEFAULT_PROFILE = "m3e"

METHOD_NAMES = ("greedy", "pso", "noto", "orbit", "random")
"""Of `planning.viewpoints.methods`, which takes long to load. A file may ask for one of a later version."""

N_CANDIDATES = 20_000
"""Spread candidates. With 56 to 560 views on the office 2000 do as well (fresh ones come with the improvement); with
200 views on the tower 2000 cover 0.7 % less after 60 s."""

MAX_CANDIDATES = 1_000_000
"""Takes 24 s and finds nothing that a tenth of it does not."""

DEFAULT_VIEWS, MAX_VIEWS = 560, 20_000
"""For methods that need a number of views when none is given: the paper's for its planar case."""

LARGEST_SEED = 2**63 - 1
"""What 64-bit integers of files and other programs hold."""

DEFAULT_SHARE = 0.99
"""Share of the reachable sections that is covered where greedy is told no goal; a choice for the model's pictures takes
as many views as that."""

GOAL, HOW, WHICH, FLIGHT = "how much (one goal at most)", "how", "which views count", "flight"
CAMERA = "camera"
"""Headings of the command line's help."""


def check_section_step(step_deg: float) -> None:
    """Raise `ValueError` unless `step_deg` divides 90 and leaves at most 90 rings."""
    if not (
        math.isfinite(step_deg) and 1.0 <= step_deg <= 90.0 and abs(90.0 / step_deg - round(90.0 / step_deg)) < 1e-9
    ):
        raise ValueError(f"section_step_deg: expected a divisor of 90 from 1 to 90 degrees, got {step_deg}")


@dataclass(frozen=True, slots=True)
class Constraints:
    """What every viewpoint and leg must keep, and which views count.

    Plans hold the `min_height_above_ground_m` and the `wanted_gsd_mm` that held. Views that are coarser than that still
    cover: `max_distance_m` is what makes them count for nothing.
    """

    min_distance_m: float = parameter(
        10.0,
        "of every view and path to everything solid",
        label="Safety distance",
        unit="m",
        least=0.0,
        option="--min-distance",
        metavar="M",
        group=WHICH,
        row="first",
        offered=(0.0, 1000.0),
        step=0.5,
    )
    section_step_deg: float = parameter(
        30.0,
        "width of the hemisphere sections",
        label="Section step",
        unit="deg",
        least=1.0,
        most=90.0,
        expected="a divisor of 90 from 1 to 90 degrees",
        option="--step",
        metavar="DEG",
        group=WHICH,
        row="more",
        suggested=(30.0, 15.0, 10.0, 5.0),
    )
    occlusion: EffectSetting = parameter(
        "auto",
        "whether lines of sight are checked for what stands in them; auto: as the scene calls for",
        choices=(Choice("auto"), Choice("on"), Choice("off")),
        option="--occlusion",
        group=WHICH,
    )
    whole_panel: bool = parameter(
        False,
        "a view counts only when all four corners of a panel are in the picture, not just its middle",
        label="Count whole panels only",
        option="--whole-panel",
        group=WHICH,
        row="more",
    )
    max_distance_m: float | None = parameter(
        None,
        "views from further away do not count",
        label="Largest distance",
        unit="m",
        above=0.0,
        most=math.inf,
        option="--max-distance",
        metavar="M",
        group=WHICH,
        unset="any distance",
    )
    min_height_above_ground_m: float | None = parameter(
        None,
        "lowest flight above the ground, but for take-off and landing",
        label="Lowest flight",
        unit="m",
        least=0.0,
        expected="0 m or more",
        option="--min-height",
        metavar="M",
        group=WHICH,
        unset="the site's, else 5 m",
    )
    wanted_gsd_mm: float | None = parameter(
        None,
        "each direction of view is wanted with pixels up to this size on the panel; those seen only more coarsely are "
        "counted and named",
        label="Wanted GSD",
        unit="mm",
        least=0.0,
        expected="0 mm or more",
        option="--wanted-gsd",
        metavar="MM",
        group=WHICH,
        unset="20 mm, or the camera's at 2.5 times the minimum distance if that is more; 0: any",
        row="more",
        offered=(0.0, 500.0),
        step=0.5,
    )

    def __post_init__(self) -> None:
        check(self)
        check_section_step(self.section_step_deg)
        if self.max_distance_m is not None and not self.max_distance_m > self.min_distance_m:
            raise ValueError(
                f"max_distance_m: expected more than the minimum distance {self.min_distance_m}, "
                f"got {self.max_distance_m}"
            )


@dataclass(frozen=True, slots=True)
class FlightRules:
    """How a sortie is flown; all of it enters durations and battery use."""

    battery_reserve: float = parameter(
        0.25,
        "part of the battery that is left at landing",
        label="Battery reserve",
        unit="share",
        least=0.0,
        below=1.0,
        option="--reserve",
        metavar="SHARE",
        group=FLIGHT,
        row="more",
        step=0.05,
        decimals=0,
    )
    settle_s: float = parameter(
        2.0,
        "hover between the end of all turning and the shutter",
        label="Hover before photo",
        unit="s",
        least=0.0,
        option="--settle",
        metavar="S",
        group=FLIGHT,
        row="more",
        offered=(0.0, 600.0),
        step=0.5,
    )
    photo_s: float = parameter(
        1.0, "hover from the shutter until the aircraft may move", label="Hover after photo", unit="s", least=0.0
    )
    max_speed_m_s: float | None = parameter(
        None,
        "highest speed, if lower than the aircraft's",
        label="Highest speed",
        unit="m/s",
        above=0.0,
        most=math.inf,
        expected="a positive speed",
        option="--speed",
        metavar="M_S",
        group=FLIGHT,
        unset="the aircraft's",
    )
    wind_m_s: float = parameter(
        0.0,
        "steady wind that is expected, from the worst direction",
        label="Wind",
        unit="m/s",
        least=0.0,
        option="--wind",
        metavar="M_S",
        group=FLIGHT,
        row="more",
        offered=(0.0, 60.0),
        step=0.5,
    )
    takeoff_landing_s: float = parameter(
        30.0,
        "motors running on the ground, take-off, check hover and landing together",
        label="Take-off and landing",
        unit="s",
        least=0.0,
    )
    turn_in_flight: bool = parameter(
        False,
        "turn heading and gimbal on the way instead of at the waypoint",
        label="Turn in flight",
        option="--turn-in-flight",
        group=FLIGHT,
    )
    at_once: int = parameter(
        1,
        "sorties that are in the air at the same time, each with an aircraft of its own",
        label="Aircraft at once",
        least=1,
        most=10,
        option="--at-once",
        metavar="N",
        group=FLIGHT,
        row="more",
    )
    apart_m: float = parameter(
        20.0,
        "distance that aircraft in the air at the same time keep, early or late as they may be",
        label="Aircraft apart",
        unit="m",
        above=0.0,
        option="--apart",
        metavar="M",
        group=FLIGHT,
    )

    def __post_init__(self) -> None:
        check(self)


@dataclass(frozen=True, slots=True)
class CameraSettings:
    """How the camera takes the photos of a flight.

    What a model of a facade needs is that a pane has one colour and one sharpness from all sides: so exposure, white
    balance and focus are held for a whole sortie unless somebody wants otherwise. Values that are not stated are the
    camera's to choose.
    """

    exposure: ExposureMode = parameter(
        "locked",
        "of the photos of a sortie: each by itself, all as measured before the first, or all as stated",
        label="Exposure",
        choices=(
            Choice("auto", "each photo by itself"),
            Choice("locked", "measured once, then locked"),
            Choice("manual", "manual"),
        ),
        option="--exposure",
        group=CAMERA,
        row="first",
    )
    shutter_s: float | None = parameter(
        None,
        "shutter time, such as 1/500",
        label="Shutter time",
        unit="s",
        above=0.0,
        most=60.0,
        expected="more than 0 s and at most 60 s",
        option="--shutter",
        metavar="S",
        group=CAMERA,
        unset="the camera chooses",
        row="first",
        suggested=SHUTTER_TIMES_S,
    )
    aperture: float | None = parameter(
        None,
        "f-number, such as 5.6",
        label="Aperture",
        least=0.5,
        most=64.0,
        option="--aperture",
        metavar="F",
        group=CAMERA,
        unset="wide, but sharp from pane to mirror image",
        row="first",
        suggested=(2.8, 3.2, 3.5, 4.0, 4.5, 5.0, 5.6, 6.3, 7.1, 8.0, 9.0, 10.0, 11.0, 13.0, 16.0),
    )
    iso: int | None = parameter(
        None,
        "sensitivity, such as 100",
        label="ISO",
        least=25,
        most=409_600,
        option="--iso",
        metavar="N",
        group=CAMERA,
        unset="the camera chooses",
        row="first",
        suggested=(100, 200, 400, 800, 1600, 3200, 6400),
    )
    compensation_ev: float = parameter(
        0.0,
        "brighter (+) or darker (-) than the camera measures, in stops; a manual exposure has none",
        label="Exposure compensation",
        unit="EV",
        least=-5.0,
        most=5.0,
        option="--compensation",
        metavar="EV",
        group=CAMERA,
        row="first",
        step=0.1,
    )
    white_balance: WhiteBalance = parameter(
        "kelvin",
        "how colours are balanced",
        label="White balance",
        choices=(
            Choice("kelvin", "colour temperature"),
            Choice("sunny", "sunny"),
            Choice("cloudy", "cloudy"),
            Choice("auto", "each photo by itself"),
        ),
        option="--white-balance",
        group=CAMERA,
        row="first",
    )
    white_balance_k: float = parameter(
        5500.0,
        "colour temperature that counts as white; 5500 K is daylight",
        label="Colour temperature",
        unit="K",
        least=1500,
        most=15_000,
        option="--kelvin",
        metavar="K",
        group=CAMERA,
        row="first",
        step=100.0,
        decimals=0,
    )
    focus: FocusMode = parameter(
        "lock",
        "automatic before each photo; automatic before the first, then locked; at infinity; or at a distance",
        label="Focus",
        choices=(
            Choice("auto", "automatic, each photo"),
            Choice("lock", "automatic once, then locked"),
            Choice("infinity", "infinity"),
            Choice("distance", "at a distance"),
        ),
        option="--focus",
        group=CAMERA,
        row="first",
    )
    focus_distance_m: float | None = parameter(
        None,
        "distance of the focus, where it is set to one",
        label="Focus distance",
        unit="m",
        above=0.0,
        most=10_000.0,
        expected="more than 0 m and at most 10 km",
        option="--focus-distance",
        metavar="M",
        group=CAMERA,
        unset="none",
        row="first",
        offered=(0.1, 1000.0),
        step=0.5,
    )
    shutter: ShutterKind = parameter(
        "mechanical",
        "shutter; a camera that has no mechanical one uses the electronic one",
        label="Shutter",
        choices=(Choice("mechanical", "mechanical"), Choice("electronic", "electronic")),
        option="--shutter-type",
        group=CAMERA,
        row="first",
    )

    def __post_init__(self) -> None:
        check(self)
        if self.exposure == "manual" and (self.shutter_s is None or self.iso is None):
            raise ValueError(say("manual exposure needs a shutter time and an ISO", place="exposure"))
        if (self.focus == "distance") != (self.focus_distance_m is not None):
            raise ValueError(say("a focus at a distance needs that distance, and no other has one", place="focus"))


@dataclass(frozen=True, slots=True)
class GreedyParameters:
    """Settings of the greedy method."""

    n_candidates: int = parameter(
        N_CANDIDATES,
        "well-spread viewpoints to choose from; witnesses of rarely seen sections come on top",
        label="Candidates",
        name="n_candidates",
        least=1,
        most=MAX_CANDIDATES,
        option="--candidates",
        metavar="N",
        group=HOW,
    )
    solid_angle_weights: bool = parameter(
        False,
        "weight hemisphere sections by their solid angle instead of equally",
        label="Weight by solid angle",
        choices=(Choice(False, word="equal"), Choice(True, word="solid-angle")),
        option="--weights",
        group=GOAL,
        row="more",
    )
    objective: Objective = parameter(
        "image-error",
        "what a number of views or batteries is spent on: pictures of a model that are near to the truth, or the "
        "paper's count of hemisphere sections",
        label="Views are chosen for",
        choices=(Choice("image-error", "the model's pictures"), Choice("sections", "hemisphere sections")),
        option="--objective",
        group=GOAL,
        row="more",
    )
    surroundings: EffectSetting = parameter(
        "auto",
        "whether places of what panes mirror count in the expected error; auto: as the scene calls for",
        choices=(Choice("auto"), Choice("on"), Choice("off")),
        option="--surroundings",
        group=GOAL,
    )
    improve: bool = parameter(True, "exchange candidates and refine poses after the greedy choice")
    certify: bool = parameter(True, "compute the dual bound for the number of views (about a second)")

    def __post_init__(self) -> None:
        check(self)


@dataclass(frozen=True, slots=True)
class PlanParameters:
    """What is wanted of a plan. At most one of `n_views`, `share`, `n_batteries` and `least_gain_db` is set."""

    method: str = parameter(
        "greedy",
        "how views are chosen",
        label="Method",
        suggested=METHOD_NAMES,
        option="--method",
        group=HOW,
        row="first",
    )
    n_views: int | None = parameter(
        None,
        "number of views",
        label="Views",
        name="views",
        least=1,
        most=MAX_VIEWS,
        option="--views",
        metavar="N",
        group=GOAL,
        row="first",
    )
    share: float | None = parameter(
        None,
        "share of what can be covered, 0 to 1, with as few views as possible",
        label="Target coverage",
        name="coverage",
        unit="share",
        above=0.0,
        most=1.0,
        option="--coverage",
        metavar="SHARE",
        group=GOAL,
        unset="0.99 with views chosen for sections",
        row="first",
        step=0.005,
    )
    n_batteries: int | None = parameter(
        None,
        "number of sorties: as much as can be covered within them",
        label="Batteries",
        name="batteries",
        least=1,
        most=100,
        option="--batteries",
        metavar="N",
        group=GOAL,
        row="first",
    )
    least_gain_db: float | None = parameter(
        None,
        "as many batteries as are worth it: until another would make pictures from new places less than so many dB "
        "better; 0.5 dB are 6 % less error",
        label="Worth another battery",
        name="good enough",
        unit="dB",
        above=0.0,
        most=100.0,
        option="--good-enough",
        metavar="DB",
        group=GOAL,
        row="first",
        step=0.1,
    )
    profile_id: str = parameter(
        DEFAULT_PROFILE,
        "aircraft and camera, or a .toml file with your own",
        label="Aircraft",
        option="--profile",
        metavar="ID",
        group=FLIGHT,
        row="first",
    )
    constraints: Constraints = Constraints()
    rules: FlightRules = FlightRules()
    camera: CameraSettings = CameraSettings()
    greedy: GreedyParameters = GreedyParameters()
    precision: Precision = parameter(
        "f32",
        "of the coverage kernel",
        label="Precision",
        choices=(Choice("f32", "single (fast)"), Choice("f64", "double (slower)")),
        option="--precision",
        group=HOW,
        row="more",
    )
    seed: int = parameter(
        0,
        "of everything random",
        label="Seed",
        least=0,
        most=LARGEST_SEED,
        option="--seed",
        metavar="N",
        group=HOW,
        row="more",
    )
    time_budget_s: float = parameter(
        60.0,
        "longest wall time for the whole plan; the search ends earlier when it finds nothing more",
        label="Time to plan",
        name="time budget",
        unit="s",
        above=0.0,
        most=math.inf,
        expected="more than 0 s",
        option="--time-budget",
        metavar="S",
        group=HOW,
        row="first",
        offered=(1.0, 86_400.0),
        step=5.0,
    )

    def __post_init__(self) -> None:
        goals = (self.n_views, self.share, self.n_batteries, self.least_gain_db)
        if sum(value is not None for value in goals) > 1:
            raise ValueError("expected at most one of a number of views, a share, a number of batteries and a gain")
        check(self)

    @property
    def wanted_share(self) -> float | None:
        """Share of what can be covered that the plan is to reach: `DEFAULT_SHARE` where views are chosen for sections.

        None where another goal is set, and where a method that flies a pattern of its own is told none.
        """
        return DEFAULT_SHARE if self._lacks_goal("sections") else self.share

    @property
    def is_as_many_as_sections(self) -> bool:
        """Whether views are chosen for the model's pictures, as many as would cover `DEFAULT_SHARE` of the sections."""
        return self._lacks_goal("image-error")

    @property
    def is_for_least_error(self) -> bool:
        """Whether views are chosen for the least expected error of the model: not where they are to cover a share."""
        return self.method == "greedy" and self.greedy.objective == "image-error" and self.share is None

    def _lacks_goal(self, objective: Objective) -> bool:
        goals = (self.n_views, self.share, self.n_batteries, self.least_gain_db)
        return self.method == "greedy" and self.greedy.objective == objective and all(goal is None for goal in goals)

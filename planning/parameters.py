"""What can be set for a plan, each parameter declared once. Light to import, since the command line reads it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from planning.base.effects import EffectSetting
from planning.base.parameters import Choice, check, parameter

Precision = Literal["f32", "f64"]
"""Of the coverage kernel; single precision is faster and differs on section borders only (docs/benchmarks.md)."""

Objective = Literal["image-error", "sections"]
"""What views are chosen for: the expected error of a model's pictures, or hemisphere sections (paper Eq. 10)."""

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
"""Share of the reachable sections that is covered when no number of views is given."""

GOAL, HOW, WHICH, FLIGHT = "how much (one goal at most)", "how", "which views count", "flight"
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
        unset="0.99",
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
        "as many batteries as are worth it: until another would bring unseen views less than so many dB more",
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

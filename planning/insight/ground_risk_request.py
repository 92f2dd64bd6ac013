"""What a pilot states for ground risk, declared once for command, window and docs. Light to import."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from planning.base.messages import say
from planning.base.parameters import Choice, check, parameter

Band = Literal["controlled", "remote", "lightly", "sparsely", "suburban", "city", "assembly"]
BANDS: tuple[Band, ...] = ("controlled", "remote", "lightly", "sparsely", "suburban", "city", "assembly")
"""From few people to many; `data/ground_risk.toml` says how many."""

Counts = Literal["auto", "cell", "km2"]

Robustness = Literal["none", "low", "medium", "high"]

ABOUT = "what is known"
ERRORS = "how far it may stray"
PEOPLE = "people below and what protects them"


@dataclass(frozen=True, slots=True)
class GroundRiskRequest:
    """What the pilot states; everything that is None is the aircraft's or the plan's."""

    population: str | None = parameter(
        None,
        "people below: a word of SORA, or people per square kilometre",
        label="People below",
        suggested=BANDS,
        option="--population",
        metavar="WORD|PER_KM2",
        group=PEOPLE,
        unset="not stated",
        row="first",
    )
    population_raster: str | None = parameter(
        None,
        "GeoTIFF of people (GHS-POP, WorldPop, ...), beside the word or in its place",
        label="People from a raster",
        option="--population-raster",
        metavar="FILE",
        group=PEOPLE,
        unset="none",
    )
    population_counts: Counts = parameter(
        "auto",
        "what a population raster counts people in; of known products the name of the file says it",
        label="Raster counts people",
        choices=(
            Choice("auto", "as its name says"),
            Choice("cell", "in a cell"),
            Choice("km2", "per km²"),
        ),
        option="--population-counts",
        group=PEOPLE,
        row="more",
    )
    terrain_raster: str | None = parameter(
        None,
        "GeoTIFF of the ground's heights, for this assessment in place of the site's own terrain",
        label="Ground from a raster",
        option="--terrain-raster",
        metavar="FILE",
        group=ABOUT,
        unset="the site's",
    )
    wind_m_s: float | None = parameter(
        None,
        "strongest wind in which it flies, from any side",
        label="Wind",
        unit="m/s",
        least=0.0,
        option="--wind",
        metavar="M_S",
        group=ABOUT,
        unset="the plan's, else the strongest that the aircraft may fly in",
        row="first",
        offered=(0.0, 60.0),
        step=0.5,
    )
    reaction_s: float = parameter(
        1.0,
        "from leaving the flight geography until the pilot acts",
        label="Reaction",
        unit="s",
        least=0.0,
        option="--reaction",
        metavar="S",
        group=ABOUT,
        row="first",
        offered=(0.0, 600.0),
        step=0.5,
    )
    speed_m_s: float | None = parameter(
        None,
        "fastest level flight through the air, where a mode limits it",
        label="Full speed",
        unit="m/s",
        above=0.0,
        option="--speed",
        metavar="M_S",
        group=ABOUT,
        unset="the aircraft's in its fastest mode",
        row="first",
        offered=(0.1, 100.0),
    )
    tilt_deg: float | None = parameter(
        None,
        "tilt with which it brakes",
        label="Braking tilt",
        unit="deg",
        above=0.0,
        most=45.0,
        option="--tilt",
        metavar="DEG",
        group=ABOUT,
        unset="the aircraft's",
        row="more",
        decimals=0,
    )
    dimension_m: float | None = parameter(
        None,
        "longest line between two points of the aircraft, propellers included",
        label="Largest dimension",
        unit="m",
        above=0.0,
        option="--dimension",
        metavar="M",
        group=ABOUT,
        unset="the aircraft's",
        row="more",
        offered=(0.01, 40.0),
        step=0.1,
        decimals=2,
    )
    mass_kg: float | None = parameter(
        None,
        "largest take-off mass in kilograms",
        label="Take-off mass in kg",
        above=0.0,
        option="--mass",
        metavar="KG",
        group=ABOUT,
        unset="the aircraft's",
        row="more",
        offered=(0.01, 1000.0),
        step=0.1,
        decimals=2,
    )
    gnss_error_m: float = parameter(
        3.0,
        "error of the position; near glass, reflected signals can make it larger",
        label="GNSS error",
        unit="m",
        least=0.0,
        option="--gnss-error",
        metavar="M",
        group=ERRORS,
        row="more",
        offered=(0.0, 100.0),
        step=0.5,
    )
    hold_error_m: float = parameter(
        3.0,
        "how far it strays from the place that it holds",
        label="Position hold error",
        unit="m",
        least=0.0,
        option="--hold-error",
        metavar="M",
        group=ERRORS,
        row="more",
        offered=(0.0, 100.0),
        step=0.5,
    )
    map_error_m: float = parameter(
        1.0,
        "error of the map or site on which the paths were planned",
        label="Map error",
        unit="m",
        least=0.0,
        option="--map-error",
        metavar="M",
        group=ERRORS,
        row="more",
        offered=(0.0, 100.0),
        step=0.5,
    )
    height_by: Literal["barometer", "gnss"] = parameter(
        "barometer",
        "what the aircraft measures its height with",
        label="Height by",
        choices=(Choice("barometer", "barometer"), Choice("gnss", "GNSS")),
        option="--height-by",
        group=ERRORS,
        row="more",
    )
    geography: Literal["hull", "paths"] = parameter(
        "hull",
        "flight geography: the hull of all paths, in which straight returns home stay, or the paths alone",
        label="Flight geography",
        choices=(Choice("hull", "hull of all paths"), Choice("paths", "paths alone")),
        option="--geography",
        group=ABOUT,
        row="more",
    )
    buffer: Literal["fall", "one-to-one"] = parameter(
        "fall",
        "ground-risk buffer: as far as the aircraft falls, or as wide as it flies high (1:1)",
        label="Buffer",
        choices=(Choice("fall", "as far as it falls"), Choice("one-to-one", "as wide as high (1:1)")),
        option="--buffer",
        group=ABOUT,
        row="more",
    )
    sheltering: Robustness = parameter(
        "none",
        "M1(A): people are in buildings that the aircraft does not get into",
        label="M1(A) sheltering",
        choices=(Choice("none"), Choice("low"), Choice("medium")),
        option="--m1a",
        group=PEOPLE,
        row="more",
    )
    restrictions: Robustness = parameter(
        "none",
        "M1(B): place or time of the flight have fewer people there",
        label="M1(B) restrictions",
        choices=(Choice("none"), Choice("medium"), Choice("high")),
        option="--m1b",
        group=PEOPLE,
        row="more",
    )
    observers: Robustness = parameter(
        "none",
        "M1(C): somebody watches the ground and the flight keeps away from people",
        label="M1(C) ground observation",
        choices=(Choice("none"), Choice("low")),
        option="--m1c",
        group=PEOPLE,
        row="more",
    )
    impact: Robustness = parameter(
        "none",
        "M2: what lessens the blow, such as a parachute",
        label="M2 softer impact",
        choices=(Choice("none"), Choice("medium"), Choice("high")),
        option="--m2",
        group=PEOPLE,
        row="more",
    )
    arc_tolerance_m: float = parameter(
        0.1,
        "how much wider than exact the corners of the areas may be; less has more corners",
        label="Arc tolerance",
        unit="m",
        least=0.001,
        most=10.0,
        option="--arc-tolerance",
        metavar="M",
        group=ERRORS,
        row="more",
        step=0.1,
        decimals=3,
    )

    def __post_init__(self) -> None:
        check(self)
        if self.population is not None and self.population not in BANDS and not _is_density(self.population):
            raise ValueError(
                say(
                    "expected one of {}, or people per square kilometre, got '{}'",
                    ", ".join(BANDS),
                    self.population,
                    place="population",
                )
            )
        if self.sheltering == "medium" and self.restrictions != "none":
            raise ValueError(say("M1(A) medium and M1(B) count the same people; state one of them", place="sheltering"))

    @property
    def mitigations(self) -> tuple[tuple[str, Robustness], ...]:
        """Each by the name that SORA gives it."""
        return (
            ("M1(A)", self.sheltering),
            ("M1(B)", self.restrictions),
            ("M1(C)", self.observers),
            ("M2", self.impact),
        )


def _is_density(text: str) -> bool:
    """Whether it is a number of people, none or more."""
    try:
        return 0.0 <= float(text) < math.inf
    except ValueError:
        return False

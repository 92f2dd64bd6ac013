"""Ground risk class by SORA 2.5: the tables of `data/ground_risk.toml`, and how a class follows from them.

Inputs are who is below, the aircraft's characteristic dimension, mass and full speed, and mitigations. Tables and rules
are those of AMC1 Article 11 of (EU) 2019/947 (ED Decision 2025/018/R), sections S.4.2 and S.4.3.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from planning.aircraft.catalogue import Body
from planning.base.json_file import read_toml
from planning.base.messages import glue, say
from planning.insight.ground_risk_request import Band, GroundRiskRequest, Robustness


@dataclass(frozen=True, slots=True)
class Column:
    """A size class: up to which dimension and speed, and the frontal area of its largest aircraft when it falls."""

    dimension_m: float
    speed_m_s: float
    frontal_area_m2: float


@dataclass(frozen=True, slots=True)
class PeopleBand:
    """A row of Table 2: its word, how many people there are fewer of, and the class of each column; 0 beyond SORA."""

    word: Band
    below_per_km2: float
    classes: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Grid:
    """Side of the cells in which people are counted, for flights up to a height above the ground."""

    height_m: float
    side_m: float


@dataclass(frozen=True, slots=True)
class GroundRiskTables:
    """See `data/ground_risk.toml`."""

    source: str
    grid_source: str
    grids: tuple[Grid, ...]
    mitigation_source: str
    drag_coefficient: float
    drag_source: str
    columns: tuple[Column, ...]
    bands: tuple[PeopleBand, ...]
    mitigations: dict[str, dict[Robustness, int]]

    def column_of(self, dimension_m: float, speed_m_s: float) -> int | None:
        """Number of the size class from 0; None where the aircraft is beyond all."""
        fits = (dimension_m <= each.dimension_m and speed_m_s <= each.speed_m_s for each in self.columns)
        return next((number for number, fit in enumerate(fits) if fit), None)


@cache
def ground_risk_tables() -> GroundRiskTables:
    """The tables of SORA."""
    return read_toml(Path(__file__).parent / "data" / "ground_risk.toml", GroundRiskTables)


def band_of(population: str) -> PeopleBand:
    """The band of a word, or of a number of people per square kilometre that `GroundRiskRequest` takes."""
    bands = ground_risk_tables().bands
    named = next((band for band in bands if band.word == population), None)
    return named or next(band for band in bands if float(population) < band.below_per_km2)


SMALL_KG, SMALL_M_S = 0.25, 25.0
"""A single aircraft of at most this mass and speed is of class 1, but over assemblies (SORA 2.5, note of Table 2)."""


@dataclass(frozen=True, slots=True)
class RiskClasses:
    """Ground risk class before and after mitigations, and how each came about: what went into which table."""

    intrinsic: int
    final: int
    how_intrinsic: str
    how_final: str


def risk_classes(
    band: PeopleBand, column: int, body: Body, speed_m_s: float, request: GroundRiskRequest
) -> RiskClasses | None:
    """Classes of a row and a column of the table; None beyond SORA.

    No mitigation brings a class below that of a controlled ground area (AMC1 Article 11, Annex B).

    Parameters
    ----------
    speed_m_s
        Fastest it can fly through the air in any mode.
    """
    if not band.classes[column]:
        return None
    tables = ground_risk_tables()
    size, dimension_m = tables.columns[column], body.characteristic_dimension_m
    intrinsic = band.classes[column]
    how = say(
        "{:.2f} m and {:g} m/s: column up to {:g} m and {:g} m/s; row {}",
        dimension_m,
        speed_m_s,
        size.dimension_m,
        size.speed_m_s,
        _row_text(band),
    )
    if body.max_takeoff_mass_kg <= SMALL_KG and speed_m_s <= SMALL_M_S and band.word != "assembly":
        intrinsic = 1
        how = say("at most 250 g and {:g} m/s: class 1 but over assemblies of people", SMALL_M_S)
    least = next(each for each in tables.bands if each.word == "controlled").classes[column]
    taken = [(name, level, tables.mitigations[name].get(level, 0)) for name, level in request.mitigations]
    final = intrinsic - sum(points for _, _, points in taken)
    parts = [f"{intrinsic}", *(f"{points} ({name} {level})" for name, level, points in taken if level != "none")]
    how_final = glue(" - ".join(parts), f" = {final}" if len(parts) > 1 else "")
    if final < min(least, intrinsic):
        how_final = say("{}, raised to {}, the class of controlled ground in this column", how_final, least)
    return RiskClasses(intrinsic, max(final, min(least, intrinsic)), how, how_final)


def _row_text(band: PeopleBand) -> str:
    """A row of the table of classes, as SORA heads it."""
    if band.word == "controlled":
        return say("controlled ground area")
    if band.below_per_km2 == math.inf:
        return say("more than {:g} people per km² (assemblies)", ground_risk_tables().bands[-2].below_per_km2)
    return say("less than {:g} people per km² ({})", band.below_per_km2, band.word)

"""Measured tilts of panes for a site, from a table: `panel,right_deg,up_deg`."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from groundstation.services.site.terrain import written
from planning.base.errors import InputError
from planning.base.files import MIB, FileLimit, read_input_file
from planning.base.messages import Message, say
from planning.insight.sunlight import shift_minutes
from planning.site.records import MAX_TILT_DEG, SiteModel

TILTS_FILE = FileLimit(say("a table of tilts"), 64 * MIB, say("it has a line for each panel"))

COLUMNS = ("panel", "right_deg", "up_deg")

Tilts = Mapping[str, tuple[float, float]]
"""By the identifiers of panels: to the right and upwards, degrees."""


def read_tilts(path: Path) -> Tilts:
    """Read a table.

    Raises
    ------
    InputError
        It is none; the message names the line.
    """
    try:
        text = read_input_file(path, TILTS_FILE).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(say("expected a table in UTF-8 with the columns {}", ",".join(COLUMNS), place=path)) from error
    found: dict[str, tuple[float, float]] = {}
    try:
        rows = list(csv.reader(io.StringIO(text)))
    except csv.Error as error:
        raise InputError(say("expected a table with commas ({})", str(error), place=path)) from error
    if not rows or tuple(cell.strip() for cell in rows[0]) != COLUMNS:
        raise InputError(say("expected the first line {}", ",".join(COLUMNS), place=path))
    for number, row in enumerate(rows[1:], 2):
        if not row:
            continue
        where = say("{}, line {}", path, number)
        if len(row) != len(COLUMNS):
            raise InputError(say("expected 3 values, got {}", len(row), place=where))
        panel, (right, up) = row[0].strip(), (_degrees(cell, where) for cell in row[1:])
        if panel in found:
            raise InputError(say("panel '{}' stands there twice", panel, place=where))
        found[panel] = (right, up)
    return found


def _degrees(text: str, where: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not abs(value) <= MAX_TILT_DEG:
        raise InputError(
            say("expected -{:g} to {:g} degrees, got '{}'", MAX_TILT_DEG, MAX_TILT_DEG, text.strip(), place=where)
        )
    return value


def with_tilts(model: SiteModel, tilts: Tilts) -> SiteModel:
    """A site whose panels have these tilts; others keep theirs.

    Raises
    ------
    InputError
        There is no such panel.
    """
    unknown = sorted(set(tilts).difference(panel.id for panel in model.site.panels))
    if unknown:
        raise InputError(say("the site has no panel '{}'", unknown[0]))
    facades = tuple(
        replace(
            facade,
            panels=tuple(replace(panel, tilt_deg=tilts.get(panel.id, panel.tilt_deg)) for panel in facade.panels),
        )
        for facade in model.site.facades
    )
    return replace(model, site=replace(model.site, facades=facades), sha256="")


def without_tilts(model: SiteModel) -> SiteModel:
    """A site whose panes stand as their corners do."""
    facades = tuple(
        replace(facade, panels=tuple(replace(panel, tilt_deg=None) for panel in facade.panels))
        for facade in model.site.facades
    )
    return replace(model, site=replace(model.site, facades=facades), sha256="")


def write_tilted(model: SiteModel, site_path: Path, tilts: Tilts | None, out: Path) -> SiteModel:
    """Write a site read from `site_path` with tilts, or without any where None; its meshes beside it.

    Raises
    ------
    InputError
        There is no such panel, or a file cannot be written.
    """
    return written(without_tilts(model) if tilts is None else with_tilts(model, tilts), site_path, out)


def tilts_text(model: SiteModel) -> Message:
    """How many panes have tilts, and what they do to glare."""
    tilts = [panel.tilt_deg for panel in model.site.panels if panel.tilt_deg is not None]
    if not tilts:
        return say("no pane has a measured tilt")
    most = max(math.hypot(*tilt) for tilt in tilts)
    return say(
        "{} of {} panes have measured tilts, up to {:.2f} degrees: they shift their glare by up to {:.1f} min",
        *(len(tilts), model.site.n_panels, most, shift_minutes(math.radians(most))),
    )

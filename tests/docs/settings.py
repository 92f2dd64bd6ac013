"""docs/reference/settings.md: every field of the settings files, from the records that read them."""

from __future__ import annotations

import inspect
import re
import types
from collections.abc import Sequence
from dataclasses import MISSING, Field, dataclass, fields, is_dataclass
from enum import Enum
from pathlib import Path
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

from planning.base.parameters import Parameter, declared

HEADER = """# Settings

Written by `make docs` (`python -m tests.docs`) from the records that read these files; do not edit by hand. All are
TOML. A key that is not listed, a wrong type and a value out of range are refused by name, with what was expected and
found. What is left out has its default.
"""


@dataclass(frozen=True, slots=True)
class SettingsFile:
    """A settings file, and the record that reads it.

    Parameters
    ----------
    title
        Heading.
    about
        Where the file is named, in a sentence.
    record
        Class of the record.
    """

    title: str
    about: str
    record: type


def settings_files() -> Sequence[SettingsFile]:
    """Every file, in the order of the page; imported here, since half of them bring torch."""
    from groundstation.services.fly.options import FlightSettings
    from groundstation.services.model.export import ModelExport
    from groundstation.services.settings import Settings
    from missions.simulator.conditions import Conditions
    from planning.parameters import PlanParameters
    from planning.plan import Aircraft, Camera
    from reconstruction.panels.search.parameters import SegmentationParameters
    from reconstruction.scenes.parameters import SceneRequest
    from reconstruction.scenes.photos.camera_model import CameraModel
    from reconstruction.scenes.world.look import Look
    from reconstruction.training.config import TrainConfig
    from reconstruction.training.parameters import TrainRequest

    return (
        SettingsFile("The program: settings.toml", "In the user's folder for settings.", Settings),
        SettingsFile("How flights are flown: flight.toml", "Beside `settings.toml`.", FlightSettings),
        SettingsFile("Planning", "`plan --settings FILE`.", PlanParameters),
        SettingsFile("Simulated flights", "Options of `simulate`, rows in the Fly tab.", Conditions),
        SettingsFile("Aircraft", "`aircraft` in a table of a profile, `plan --profile FILE`.", Aircraft),
        SettingsFile("Camera", "`camera` in a table of a profile, `plan --profile FILE`.", Camera),
        SettingsFile("Search for panels", "`segment --parameters FILE`.", SegmentationParameters),
        SettingsFile("Rendered photos", "Options of `scene render`.", SceneRequest),
        SettingsFile("Look of a virtual scene", "`scene render --look FILE`.", Look),
        SettingsFile("Camera model of rendered photos", "`scene render --camera FILE`.", CameraModel),
        SettingsFile("What is asked of a training", "Options of `train`, rows in the Reconstruct tab.", TrainRequest),
        SettingsFile("Training", "`train --settings FILE`.", TrainConfig),
        SettingsFile("Export of models", "Options of `export`, rows of its dialog in the Model tab.", ModelExport),
    )


def page() -> str:
    """Text of the page."""
    parts = [HEADER]
    for each in settings_files():
        parts += [f"## {each.title}\n", each.about + "\n", *_tables(each.record, None, "", set())]
    return "\n".join(parts)


def _tables(record: type, known: Any, prefix: str, seen: set[type]) -> list[str]:
    """Table of a record's fields, with the values of one that is `known` as defaults; then of the records in it."""
    seen.add(record)
    said, own = _described(record), declared(record)
    heads = ("key", "type", "default", *(("range", "option") if own else ()), "meaning")
    lines = [f"| {' | '.join(heads)} |", f"|{' --- |' * len(heads)}"]
    inner: list[tuple[str, Any]] = []
    kinds = get_type_hints(record)
    for field in fields(record):
        if field.name.startswith("_"):
            continue
        default = _default(field) if known is None else getattr(known, field.name)
        if is_dataclass(default) and type(default) not in seen:
            inner.append((field.name, default))
        cells = [f"`{prefix}{field.name}`", _type(kinds[field.name]), _shown(default)]
        if own:
            cells += _declared_cells(own[field.name].parameter if field.name in own else None, cells[1], default)
        meaning = own[field.name].parameter.help if field.name in own else said.get(field.name, "")
        lines.append(f"| {' | '.join([*cells, _cell(meaning)])} |")
    parts = ["\n".join(lines) + "\n"]
    for name, each in inner:
        if type(each) not in seen:
            parts += [f"### {prefix}{name}\n", *_tables(type(each), each, f"{prefix}{name}.", seen)]
    return parts


def _declared_cells(known: Parameter | None, kind: str, default: Any) -> list[str]:
    """Range and option of a declared parameter; what None means stands with the range."""
    if known is None:
        return ["", ""]
    values = known.range_text()
    if known.choices:
        values = "" if kind == "true, false" else ", ".join(f"`{choice.value}`" for choice in known.choices)
    elif known.suggested and isinstance(default, str):
        values = ", ".join(f"`{each}`" for each in known.suggested)
    if default is None and known.unset:
        values = f"{values}; none: {known.unset}" if values else f"none: {known.unset}"
    return [values, f"`{known.option}`" if known.option else ""]


def _described(record: type) -> dict[str, str]:
    """Meaning of each parameter, from the docstring's numpydoc section."""
    text = inspect.getdoc(record) or ""
    section = re.search(r"^Parameters\n-+\n(.*?)(?=^\w[^\n]*\n-{3,}\n|\Z)", text, re.S | re.M)
    meanings: dict[str, str] = {}
    for names, meaning in re.findall(r"^(\w[\w, ]*)\n((?:^(?: {4}.*)?\n?)+)", section[1] if section else "", re.M):
        for name in names.split(","):
            meanings[name.strip()] = meaning
    return meanings


def _default(field: Field[Any]) -> Any:
    if field.default is not MISSING:
        return field.default
    return field.default_factory() if field.default_factory is not MISSING else MISSING


def _type(kind: Any) -> str:
    """Name of a type as a reader of TOML says it; choices by their values."""
    origin, parts = get_origin(kind), get_args(kind)
    if origin is Literal:
        return ", ".join(f"`{part}`" for part in parts)
    if origin in (Union, types.UnionType):
        return " or ".join(_type(part) for part in parts if part is not type(None))
    if isinstance(kind, type) and issubclass(kind, Enum):
        return ", ".join(f"`{each.value}`" for each in kind)
    if origin is tuple:
        return "list" if Ellipsis in parts else f"list of {len(parts)}"
    if kind is Any or origin is not None or is_dataclass(kind):
        return "table"
    return {"str": "text", "float": "number", "int": "whole number", "bool": "true, false", "Path": "path"}.get(
        kind.__name__, kind.__name__
    )


def _shown(value: Any) -> str:
    if value is MISSING:
        return "(required)"
    if is_dataclass(value):
        return "below"
    if isinstance(value, Enum):
        value = value.value
    if isinstance(value, Path):
        value = str(value)
    if isinstance(value, str):
        return f'`"{value}"`'
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    if value is None:
        return "none"
    if isinstance(value, float):
        return f"`{value:.6g}`"
    if isinstance(value, tuple) and any(is_dataclass(each) for each in value):
        return f"{len(value)} of `{type(value[0]).__name__}`"
    if isinstance(value, tuple):
        return f"`{list(value)}`"
    return f"`{value}`"


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")

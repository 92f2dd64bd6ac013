"""groundstation/gui/application/parameter_texts.py: titles and tool tips of declared parameters, for Qt Linguist."""

from __future__ import annotations

import json
import textwrap
from typing import Any

from groundstation.services.model.export import ModelExport
from missions.formats.options import ExportOptions
from missions.simulator.conditions import Conditions
from planning.base.parameters import declared
from planning.insight.ground_risk_request import GroundRiskRequest
from planning.parameters import PlanParameters
from reconstruction.training.parameters import TrainRequest

HEADER = '''"""Titles and tool tips of declared parameters, for Qt Linguist.

Written by `make docs` (`python -m tests.docs`); do not edit by hand.
"""

from __future__ import annotations

from PySide6.QtCore import QT_TRANSLATE_NOOP

TEXTS = (
'''

RECORDS: tuple[type[Any], ...] = (
    PlanParameters,
    Conditions,
    ExportOptions,
    ModelExport,
    TrainRequest,
    GroundRiskRequest,
)
"""Records whose parameters have rows in forms."""

LINE = 120


def module() -> str:
    """Text of the module."""
    found: dict[str, None] = {}
    for record in RECORDS:
        for each in declared(record).values():
            if each.parameter.row:
                labels = [choice.label for choice in each.parameter.choices if choice.label]
                values = [choice.value for choice in each.parameter.choices]
                is_listed = labels and each.default is None and each.parameter.unset not in values
                unset = [each.parameter.unset] if is_listed else []
                found |= dict.fromkeys([each.parameter.label, each.parameter.help, *labels, *unset])
    return HEADER + "".join(_marked(text) for text in found if text) + ")\n"


def _marked(text: str) -> str:
    line = f'    QT_TRANSLATE_NOOP("Parameters", {_quoted(text)}),'
    if len(line) <= LINE:
        return line + "\n"
    parts = textwrap.wrap(text, LINE - 12, drop_whitespace=False, break_on_hyphens=False)
    if len(parts) == 1 and len(f'        "Parameters", {_quoted(text)}') <= LINE:
        return f'    QT_TRANSLATE_NOOP(\n        "Parameters", {_quoted(text)}\n    ),\n'
    lines = "".join(f"        {_quoted(part)}\n" for part in parts)
    return f'    QT_TRANSLATE_NOOP(\n        "Parameters",\n{lines.rstrip()},\n    ),\n'


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)

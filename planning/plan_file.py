"""Reading and writing `plan.json` (format reflight-plan/1, docs/file-formats.md)."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import msgspec

from planning.files import read_given
from planning.json_file import JSON_FILE, expect_format, parse_json, to_record, write_atomically
from planning.plan import PLAN_FORMAT, Plan


def read_plan(path: Path) -> Plan:
    """Read a plan.

    Raises
    ------
    InputError
        The file is missing or wrong; the message names the file, the field and what was expected.
    """
    return plan_of(read_given(path, JSON_FILE), path)


def plan_of(written: bytes, path: Path) -> Plan:
    """A plan from the content of its file `path`; errors as `read_plan`."""
    content = parse_json(written, path)
    expect_format(content, PLAN_FORMAT, path)
    return to_record(content, Plan, path)


def plan_to_json(plan: Plan) -> dict[str, Any]:
    """Content of `plan.json`; optional fields that are not set are left out."""
    content: dict[str, Any] = msgspec.to_builtins(plan)
    content = {"format": content.pop("format"), **content}
    content["coverage"] = {key: value for key, value in content["coverage"].items() if value is not None}
    for viewpoint in content["viewpoints"]:
        if not viewpoint["locked"]:
            del viewpoint["locked"]
    for sortie in content["sorties"]:
        if not sortie["in_passing_ids"]:
            del sortie["in_passing_ids"]
    return {key: value for key, value in content.items() if value is not None}


def write_plan(path: Path, plan: Plan) -> None:
    """Write a plan, whole or not at all."""
    write_atomically(path, json.dumps(plan_to_json(plan), indent=1, allow_nan=False).encode())

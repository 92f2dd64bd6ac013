"""Settings of the search for panels, as several commands take them."""

from __future__ import annotations

import argparse
from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any

from planning.errors import InputError
from planning.json_file import read_toml, to_record

if TYPE_CHECKING:
    from reconstruction.segmentation.parameters import SegmentationParameters

OPTIONS = {"long_side_px": "--long-side", "n_samples": "--samples", "detector": "--detector"}
"""Options by the settings that they change."""


def parameters_of(options: argparse.Namespace) -> SegmentationParameters:
    """Settings from a file, changed by what else was typed.

    Raises
    ------
    InputError
        The file cannot be read, or a value is out of range.
    """
    from reconstruction.segmentation.parameters import SegmentationParameters

    base = SegmentationParameters()
    if options.parameters is not None:
        content = read_toml(options.parameters, dict[str, Any])
        known = [field.name for field in fields(SegmentationParameters)]
        unknown = [name for name in content if name not in known]
        if unknown:
            raise InputError(f"{options.parameters}: {unknown[0]}: no such setting; expected {', '.join(known)}")
        base = to_record(content, SegmentationParameters, options.parameters)
    typed = {name: getattr(options, option[2:].replace("-", "_")) for name, option in OPTIONS.items()}
    try:
        return replace(base, **{name: value for name, value in typed.items() if value is not None})
    except ValueError as error:
        name, colon, rest = str(error).partition(":")
        raise InputError(f"{OPTIONS.get(name, name)}{colon}{rest}") from error

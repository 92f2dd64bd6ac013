"""Settings of the search for panels, as several commands take them."""

from __future__ import annotations

import argparse
from dataclasses import replace
from typing import TYPE_CHECKING

from planning.base.errors import InputError

if TYPE_CHECKING:
    from reconstruction.panels.search.parameters import SegmentationParameters

OPTIONS = {"long_side_px": "--long-side", "n_samples": "--samples", "detector": "--detector"}
"""Options by the settings that they change."""


def parameters_of(options: argparse.Namespace) -> SegmentationParameters:
    """Settings from a file, changed by what else was typed.

    Raises
    ------
    InputError
        The file cannot be read, or a value is out of range.
    """
    from reconstruction.panels.search.parameters import SegmentationParameters, read_parameters

    base = SegmentationParameters() if options.parameters is None else read_parameters(options.parameters)
    typed = {name: getattr(options, option[2:].replace("-", "_")) for name, option in OPTIONS.items()}
    try:
        return replace(base, **{name: value for name, value in typed.items() if value is not None})
    except ValueError as error:
        name, colon, rest = str(error).partition(":")
        raise InputError(f"{OPTIONS.get(name, name)}{colon}{rest}") from error

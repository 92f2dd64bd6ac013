"""Settings of the search for panels, as several commands take them."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from groundstation.cli.options import in_words_of_options, typed_values
from planning.base.parameters import with_values

if TYPE_CHECKING:
    from reconstruction.panels.search.parameters import SegmentationParameters


def parameters_of(options: argparse.Namespace) -> SegmentationParameters:
    """Settings from a file, changed by what else was typed.

    Raises
    ------
    InputError
        The file cannot be read, or a value is out of range.
    """
    from reconstruction.panels.search.parameters import SegmentationParameters, read_parameters

    base = SegmentationParameters() if options.parameters is None else read_parameters(options.parameters)
    with in_words_of_options(SegmentationParameters):
        return with_values(base, typed_values(options, SegmentationParameters))

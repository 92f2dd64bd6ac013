"""What a compressed file keeps of Gaussians: presets for SPZ and SOG."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from planning.base.errors import InputError
from planning.base.files import real_path
from planning.base.json_file import check_output, part_file
from planning.base.messages import say

# Files that are there whole or not at all, however they are written.


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """A new file beside `path`, of the same ending, which takes its place once all is written.

    A link is followed. Where the work fails nothing is left, and a file that was there stays.

    Raises
    ------
    InputError
        It cannot be written, or is no file.
    """
    check_output(path)
    target = real_path(path)
    if target.exists() and not target.is_file():
        raise InputError(say("cannot be written: it is no file; name one", place=path))
    try:
        with part_file(target) as part:
            yield part
    except OSError as error:
        raise InputError(say("cannot be written ({})", error.strerror or error, place=path)) from error


LEAST_SEEN = 1.0 / 255.0
"""Opacity below which no renderer draws a Gaussian, ours neither (`RasterSettings.min_alpha`)."""

MOST_COLOURS = 65_536
"""Of a SOG palette: its labels have 16 bits."""


@dataclass(frozen=True, slots=True)
class Compression:
    """How much is kept.

    Parameters
    ----------
    degree
        Of colours by direction, 0 to 3.
    first_bits, further_bits
        SPZ: of coefficients of degree 1, and of degrees 2 and 3; 1 to 8.
    palette, gaussians_each
        SOG: how many different sets of those coefficients there are, up to 65 536, and to how many Gaussians there is
        one at most.
    least_opacity
        Gaussians below are left out; nobody sees those below 1 / 255.
    """

    degree: int = 3
    first_bits: int = 5
    further_bits: int = 5
    palette: int = 16_384
    gaussians_each: int = 8
    least_opacity: float = LEAST_SEEN

    def __post_init__(self) -> None:
        if not 0 <= self.degree <= 3:
            raise ValueError(f"degree: expected 0 to 3, got {self.degree}")
        if not (1 <= self.first_bits <= 8 and 1 <= self.further_bits <= 8):
            raise ValueError(f"first_bits, further_bits: expected 1 to 8, got {self.first_bits}, {self.further_bits}")
        if not (1 <= self.palette <= MOST_COLOURS and self.gaussians_each >= 1):
            raise ValueError(
                f"palette, gaussians_each: expected 1 to {MOST_COLOURS}, and 1 or more, got {self.palette}, "
                f"{self.gaussians_each}"
            )
        if not 0.0 <= self.least_opacity < 1.0:
            raise ValueError(f"least_opacity: expected 0 to less than 1, got {self.least_opacity}")


PRESETS: dict[str, Compression] = {
    "small": Compression(first_bits=3, further_bits=3, palette=2048, gaussians_each=64),
    "balanced": Compression(),
    "fine": Compression(first_bits=8, further_bits=8, palette=MOST_COLOURS, gaussians_each=2),
}
"""By name. All keep the degree: what panels mirror is in it, and fewer bits cost far less than a lower degree
(`tests.benchmarks --only model-size`)."""


@dataclass(frozen=True, slots=True)
class Compressed:
    """What came of it.

    Parameters
    ----------
    n_gaussians, n_left_out
        Written, and left out because nobody sees them.
    n_resized
        SPZ: of those written, with a size beyond the format's 45 µm to 379 m, which became the nearest of these; the
        thickness of discs does not count.
    position_error_m
        Largest that the format's rounding can make along one axis.
    """

    path: Path
    n_bytes: int
    n_gaussians: int
    n_left_out: int
    n_resized: int
    position_error_m: float

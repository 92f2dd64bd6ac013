"""Where poses of photos come from, as several commands take it."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from planning.base.errors import InputError

if TYPE_CHECKING:
    from groundstation.services.photos.poses import RefinedOutcome, RefineRequest


def add_pose_arguments(parser: Any) -> None:
    """Add `--colmap`, `--refine` and what belongs to them, and `--heights`."""
    source = parser.add_mutually_exclusive_group()
    source.add_argument("--colmap", type=Path, metavar="FOLDER", help="COLMAP model of the photos, for better poses")
    source.add_argument(
        "--refine",
        action="store_true",
        help="refine the poses with COLMAP (needs pycolmap); computed once, kept in PHOTOS.refined beside the photos",
    )
    add = parser.add_argument
    add("--refined", type=Path, metavar="FOLDER", help="keep refined poses in this folder instead (with --refine)")
    add(
        "--refine-size",
        type=int,
        metavar="PX",
        help="longer side that photos are reduced to for refining: smaller is quicker, larger better (default 1600)",
    )
    add("--heights", choices=("auto", "takeoff", "absolute"), default="auto", help="which heights of photos count")


def refine_wish(options: argparse.Namespace) -> RefineRequest | None:
    """What was asked for; None without `--refine`.

    Raises
    ------
    InputError
        An option that belongs to `--refine` stands without it, or its value is out of range.
    """
    from groundstation.cli.options import in_words_of_options
    from groundstation.services.photos.poses import RefineRequest

    if options.refine:
        with in_words_of_options():
            return RefineRequest(options.refined, options.refine_size)
    for option, value in (("--refined", options.refined), ("--refine-size", options.refine_size)):
        if value is not None:
            raise InputError(f"{option}: belongs to --refine, which was not given")
    return None


def print_refined(outcome: RefinedOutcome | None) -> None:
    """Say where refined poses are kept."""
    if outcome is not None:
        print(f"{outcome.folder}: refined poses{', computed before' if outcome.was_kept else ''}")

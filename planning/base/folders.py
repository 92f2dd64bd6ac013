"""Folders for results, and names of files and folders that say what is in them."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from fnmatch import fnmatch
from pathlib import Path

from planning.base.errors import InputError
from planning.base.messages import say

FILE_ENDING = re.compile(
    r"\.(avi|bin|bmp|csv|docx?|exr|gif|glb|gltf|gml|html?|ifc|jpe?g|json|kml|kmz|las|laz|log|md|mp4|npy|obj|ods|odt|pdf|"
    r"plan|ply|png|pptx?|rtf|safetensors|sog|splat|spz|sqlite|stl|svg|tar|tiff?|tlog|toml|tsv|txt|ulg|usd[acz]?|waypoints|"
    r"webp|xls[mx]?|xml|ya?ml|zip)"
)
"""Endings that everybody knows: a name with one of them says what is in a file, and that it is a file."""

PLAIN_ENDINGS = frozenset({".bin", ".log", ".txt", ".zip"})
"""That say little: a KMZ file is a ZIP, and any text may be called a text."""


def is_empty(folder: Path) -> bool:
    """Whether there is no file in a folder that exists, nor in those within it; of what is in the making none counts.

    So a run that ended before it wrote anything leaves an empty folder.
    """
    return all(path.is_dir() or fnmatch(path.name, ".*.????????.part*") for path in folder.rglob("*"))


def make_folder(folder: Path) -> None:
    """Make a folder, and those above it, where it is missing.

    Raises
    ------
    InputError
        It cannot be made.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            say("cannot be made ({}); name another folder", error.strerror or error, place=folder)
        ) from error


def check_ending(path: Path, endings: Sequence[str], others: Collection[str] = PLAIN_ENDINGS) -> None:
    """Refuse to write a file under a name that says something else is in it.

    Parameters
    ----------
    endings
        Of such files, in lower case.
    others
        That are borne with.

    Raises
    ------
    InputError
        The name ends as files of another kind do.
    """
    ending = path.suffix.lower()
    is_known = FILE_ENDING.fullmatch(ending) is not None and ending not in others
    if is_known and not path.name.lower().endswith(tuple(endings)):
        told = " or ".join(endings)
        if path.exists():
            raise InputError(say("would replace a {} file by what is {}; name another file", ending, told, place=path))
        raise InputError(
            say(
                "not written: the name ends in {}, and what would be in the file is {}; name it so, or choose "
                "another format",
                ending,
                told,
                place=path,
            )
        )


def check_folder_name(path: Path) -> None:
    """Refuse to make a folder under a name that says it is a file.

    Raises
    ------
    InputError
        The name ends as files do, and there is no such folder.
    """
    ending = path.suffix.lower()
    if FILE_ENDING.fullmatch(ending) and not path.is_dir():
        raise InputError(
            say(
                "not written: the name ends in {} as files do, and this is written as a folder; name one",
                ending,
                place=path,
            )
        )

"""Reading files that strangers wrote: limits on size and number, nothing unpacked to disk, no path trusted."""

from __future__ import annotations

import lzma
import zipfile
import zlib
from pathlib import Path, PurePosixPath
from typing import BinaryIO

from planning.base.errors import InputError, MissionError
from planning.base.files import MIB, FileLimit, check_zip_directory, open_input_file, read_input_file
from planning.base.messages import say

MISSION_FILE = FileLimit(say("a mission file"), 64 * MIB)
"""Larger ones are refused; a mission of 10 000 waypoints with actions has about 40 MiB of XML."""

KMZ_FILE = FileLimit(say("a DJI KMZ"), 512 * MIB)
"""With reference pictures in it."""

MAX_FILE_BYTES = MISSION_FILE.max_bytes

MAX_LINES = 1_000_000
"""Of text files with a waypoint or photo in each line."""

MAX_MEMBERS = 1000
"""A KMZ holds two parts and perhaps reference pictures, one a waypoint."""


def read_limited(path: Path) -> bytes:
    """Content of a mission file.

    Raises
    ------
    InputError
        The file is missing, unreadable or larger than any mission.
    """
    return read_input_file(path, MISSION_FILE)


def open_archive(source: Path | BinaryIO, label: str) -> tuple[zipfile.ZipFile, dict[str, zipfile.ZipInfo]]:
    """A zip archive whose directory has been checked, and its files by name. The caller closes the archive.

    Parameters
    ----------
    label
        Name of the archive, for messages.

    Raises
    ------
    InputError
        The file is missing or unreadable.
    MissionError
        It is no zip, or one that no ground station writes: too many files, names that climb out of the archive, the
        same name twice, encrypted content.
    """
    if isinstance(source, Path):
        with open_input_file(source, KMZ_FILE) as file:
            check_zip_directory(file, label)
    try:
        archive = zipfile.ZipFile(source)
    except OSError as error:
        raise InputError.say("cannot be read ({})", error.strerror or error, place=label) from error
    except (zipfile.BadZipFile, ValueError, NotImplementedError) as error:
        raise MissionError.say(
            "damaged or no zip archive ({}); a KMZ is one; copy it again", error, place=label
        ) from error
    try:
        return archive, _checked_members(archive, label)
    except BaseException:
        archive.close()
        raise


def _checked_members(archive: zipfile.ZipFile, label: str) -> dict[str, zipfile.ZipInfo]:
    if len(archive.infolist()) > MAX_MEMBERS:
        raise MissionError.say("holds {} files; expected at most {}", len(archive.infolist()), MAX_MEMBERS, place=label)
    members: dict[str, zipfile.ZipInfo] = {}
    for member in archive.infolist():
        name = member.filename.replace("\\", "/")
        if name.startswith("/") or ":" in name or ".." in PurePosixPath(name).parts:
            raise MissionError.say(
                "holds the path '{}', which leads out of it; refused as hostile", member.filename, place=label
            )
        if name in members:
            raise MissionError.say(
                "holds '{}' twice, so which one is meant is unknown; export it again", name, place=label
            )
        if member.flag_bits & 0x1:
            raise MissionError.say("'{}' is encrypted; export it without a password", name, place=label)
        members[name] = member
    return members


def read_member(archive: zipfile.ZipFile, member: zipfile.ZipInfo, label: str) -> bytes:
    """Content of one file of an archive.

    Raises
    ------
    MissionError
        It is damaged, or inflates to more than any mission has (whatever size it claims).
    """
    try:
        with archive.open(member) as file:
            content = file.read(MAX_FILE_BYTES + 1)
    except (zipfile.BadZipFile, OSError, EOFError, RuntimeError, NotImplementedError, ValueError) as error:
        raise MissionError.say(
            "'{}' is damaged ({}); copy the file again", member.filename, error, place=label
        ) from error
    except (zlib.error, lzma.LZMAError) as error:
        raise MissionError.say(
            "'{}' cannot be inflated ({}); copy the file again", member.filename, error, place=label
        ) from error
    if len(content) > MAX_FILE_BYTES:
        raise MissionError.say(
            "'{}' inflates to more than {} MiB; refused as hostile",
            member.filename,
            MAX_FILE_BYTES // 2**20,
            place=label,
        )
    return content

"""A folder of photos as it comes from the card: all of them in the order of time, and what is wrong with some."""

from __future__ import annotations

import os
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from planning.base.errors import InputError
from planning.base.files import open_input_file
from planning.base.findings import Finding, Severity
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.photos.jpeg import JPEG_START, PHOTO_FILE
from planning.photos.metadata import read_photo
from planning.photos.record import PhotoMetadata

SUFFIXES = (".jpg", ".jpeg")

OTHER_PICTURES = (".png", ".tif", ".tiff", ".webp", ".bmp")
"""Pictures that can be decoded, but say nothing of themselves: of use where their poses are known from elsewhere."""

UNDECODED = (".dng", ".heic", ".heif", ".arw", ".cr2", ".cr3", ".nef", ".raf", ".rw2", ".orf")
"""Photos of formats that are not read."""

VIDEOS = (".mp4", ".mov", ".m4v", ".mts", ".avi", ".mkv")

N_THREADS = 8
"""Cards and network folders answer several requests at once; reading the metadata itself takes less than 1 ms."""

CHUNK = 64
"""Photos between two reports of progress."""


@dataclass(frozen=True, slots=True)
class PhotoFolder:
    """Photos in the order of time, and findings about files that could not be read or are not whole."""

    photos: tuple[PhotoMetadata, ...]
    findings: tuple[Finding, ...]


def read_photos(folder: Path, monitor: Monitor = QUIET, *, posed_elsewhere: bool = False) -> PhotoFolder:
    """All JPEG photos in a folder and the folders in it: those that are called so, and those that are.

    Parameters
    ----------
    posed_elsewhere
        Whether poses come from elsewhere, so that a folder of other pictures alone will do; they are not read here.

    Raises
    ------
    InputError
        The folder is missing, or holds no photo that can be read.
    """
    paths = _paths(folder, posed_elsewhere)
    if not paths:
        return PhotoFolder((), ())
    photos: list[PhotoMetadata] = []
    findings: list[Finding] = []
    with ThreadPoolExecutor(N_THREADS) as pool:
        for start in range(0, len(paths), CHUNK):
            monitor.report(say("reading photos"), start, len(paths))
            for found in pool.map(_photo_or_finding, paths[start : start + CHUNK]):
                if isinstance(found, Finding):
                    findings.append(found)
                else:
                    photos.append(found)
    if not photos and not posed_elsewhere:
        raise InputError.say(
            "none of its {} photos can be read; the first: {}", len(paths), findings[0].message, place=folder
        )
    findings += (
        Finding(
            Severity.WARNING,
            "photo-cut-off",
            say("the file has no end, so that a part of the picture is missing"),
            name,
        )
        for name in (str(photo.path) for photo in photos if not photo.is_complete)
    )
    return PhotoFolder(in_order(photos), tuple(findings))


def _paths(folder: Path, posed_elsewhere: bool) -> list[Path]:
    if not folder.is_dir():
        raise InputError(
            say("expected a folder of photos, found a file", place=folder)
            if folder.exists()
            else say("expected a folder of photos, found nothing", place=folder)
        )
    problems: list[OSError] = []
    files = [
        Path(inside, name)
        for inside, _, names in os.walk(folder, onerror=problems.append)
        for name in names
        if name.lower().endswith(SUFFIXES + OTHER_PICTURES + UNDECODED + VIDEOS) and not name.startswith(".")
    ]
    pictures = [path for path in files if path.suffix.lower() not in VIDEOS]
    if problems:
        raise InputError.say("cannot be read ({})", problems[0].strerror, place=problems[0].filename) from problems[0]
    paths = [path for path in pictures if path.suffix.lower() in SUFFIXES or _is_jpeg(path)]
    if paths or (posed_elsewhere and any(is_other_picture(path) for path in pictures)):
        return sorted(paths)
    if pictures:
        raise InputError.say(
            "holds no .jpg photo, but {} of other kinds, the first {}; save them as JPEG with all that the camera "
            "wrote into them",
            len(pictures),
            min(pictures).name,
            place=folder,
        )
    if files:
        raise InputError.say(
            "holds no .jpg photo, but videos, the first {}; fly again and take photos: videos do not say where each "
            "picture was taken",
            min(files).name,
            place=folder,
        )
    raise InputError.say("holds no .jpg photo; name the folder that was copied from the camera's card", place=folder)


def _is_jpeg(path: Path) -> bool:
    """Whether a picture of another name is a JPEG file nevertheless; what cannot be read is told where it is needed."""
    if not is_other_picture(path):
        return False
    try:
        with open_input_file(path, PHOTO_FILE) as file:
            return file.read(len(JPEG_START)) == JPEG_START
    except InputError:
        return False


def is_other_picture(path: Path) -> bool:
    """Whether a file is by its name a picture that can be decoded, but says nothing of itself."""
    return path.suffix.lower() in OTHER_PICTURES


def _photo_or_finding(path: Path) -> PhotoMetadata | Finding:
    try:
        return read_photo(path)
    except InputError as error:
        return Finding(Severity.WARNING, "photo-unreadable", str(error), str(path))


def in_order(photos: Iterable[PhotoMetadata]) -> tuple[PhotoMetadata, ...]:
    """Photos by time; those of one second by the camera's count; those without a time at the end, by name."""
    listed = tuple(photos)
    by_exposure = all(photo.exposed_at is not None for photo in listed)

    def key(photo: PhotoMetadata) -> tuple[float, int, str]:
        time = photo.exposed_at if by_exposure else photo.taken_at
        index = -1 if photo.image_index is None else photo.image_index
        return (float("inf") if time is None else clock_s(time)), index, str(photo.path)

    return tuple(sorted(listed, key=key))


def clock_s(time: datetime) -> float:
    """Seconds of a clock since year 1, whatever its time zone; only differences on the same clock mean something."""
    return (time.replace(tzinfo=None) - datetime.min).total_seconds()

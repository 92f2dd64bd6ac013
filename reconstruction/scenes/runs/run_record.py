"""`scene.json`: what a folder of rendered photos was made from, and which of its photos are complete."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, fields, is_dataclass
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any

import numpy as np

from planning.base.effects import Decision
from planning.base.errors import InputError
from planning.base.files import is_empty, sha256_of_file
from planning.base.json_file import expect_format, read_json, write_atomically
from planning.base.messages import say

if TYPE_CHECKING:  # a window looks for begun photos, and need not load what renders them
    from reconstruction.scenes.record import Scene
    from reconstruction.scenes.runs.photo_job import PhotoJob

SCENE_PHOTOS_FORMAT = "reflight-scene-photos/1"
RUN_FILE = "scene.json"

Files = dict[str, dict[str, str]]
"""For each complete photo, SHA-256 of its files by their paths in the folder."""

SAME = ("made_from", "settings", "taking", "camera", "photos", "scene", "seed", "scene_sha256")
"""What two runs must have in common to be one; what says most to a user comes first."""

LONGEST = 60
"""Characters of a value in a message."""

RunRecord = dict[str, Any]
"""Content of `scene.json` but for what changes while it is made."""


def is_rendered(folder: Path) -> bool:
    """Whether a folder has photos that were rendered, not taken."""
    return (folder / RUN_FILE).is_file()


def run_record(job: PhotoJob, decisions: Sequence[Decision]) -> RunRecord:
    """What a run is made from; the cameras of all photos are alike."""
    scene, lens = job.scene, job.photos[0].intrinsics
    settings = asdict(job.settings)
    # As files have called it since the first of them.
    settings["wishes"] = settings.pop("effects")
    record = {
        "format": SCENE_PHOTOS_FORMAT,
        "scene": scene.name,
        "seed": scene.seed,
        "made_from": dict(job.made_from),
        "scene_sha256": checksum(scene),
        "settings": settings,
        "taking": asdict(job.camera_model),
        "effects": [asdict(decision) for decision in decisions],
        "camera": asdict(lens),
        "photos": [
            {
                "name": photo.name,
                "taken_at": None if photo.taken_at is None else photo.taken_at.isoformat(),
                "position_enu_m": photo.pose.position_enu_m.tolist(),
                "cam_from_enu": photo.pose.cam_from_enu.tolist(),
                **asdict(moment),
            }
            for photo, moment in zip(job.photos, job.moments, strict=True)
        ],
    }
    # As it will be read back: lists in place of tuples.
    return dict(json.loads(json.dumps(record, allow_nan=False)))


def captures_record(job: PhotoJob) -> dict[str, Any]:
    """By photo: how it was exposed, and what it tells of its pose."""
    return {
        photo.name: {
            "exposure": capture.exposure,
            "exposure_s": capture.exposure_s,
            "moved_enu_m": capture.moved_enu_m.tolist(),
            "told_position_enu_m": capture.reported.position_enu_m.tolist(),
            "told_cam_from_enu": capture.reported.cam_from_enu.tolist(),
            "told_higher_m": capture.reported_higher_m,
        }
        for photo, capture in zip(job.photos, job.captures, strict=True)
    }


def checksum(scene: Scene) -> str:
    """SHA-256 of all there is in a scene, hexadecimal: another look, seed, site or program gives another one."""
    digest = hashlib.sha256()
    for part in _parts(scene):
        digest.update(part)
    return digest.hexdigest()


def _parts(value: Any) -> Iterator[bytes]:
    if isinstance(value, np.ndarray):
        yield f"{value.shape} {value.dtype}".encode()
        yield np.ascontiguousarray(value).tobytes()
    elif is_dataclass(value):
        for field in fields(value):
            yield field.name.encode()
            yield from _parts(getattr(value, field.name))
    elif isinstance(value, tuple):
        yield f"{len(value)} values".encode()
        for one in value:
            yield from _parts(one)
    else:
        yield repr(value).encode()


def check_folder(folder: Path) -> None:
    """Say before anything is built for it that photos cannot go into a folder.

    Raises
    ------
    InputError
        It is a file, or holds something else.
    """
    if folder.exists() and not folder.is_dir():
        raise InputError(say("expected a folder, found a file; name a folder for the photos", place=folder))
    if folder.exists() and not (folder / RUN_FILE).is_file() and not is_empty(folder):
        raise InputError(
            say("is not empty, and has no {} of photos to go on with; name a new folder", RUN_FILE, place=folder)
        )


def finished_photos(folder: Path, run: RunRecord) -> Files:
    """Photos of the same run that are complete in the folder, with their files.

    Raises
    ------
    InputError
        As for `check_folder`, or the folder holds photos of another run.
    """
    check_folder(folder)
    path = folder / RUN_FILE
    if not path.is_file():
        return {}
    found = read_json(path, names_files=True)
    expect_format(found, SCENE_PHOTOS_FORMAT, path)
    if not isinstance(found, dict) or not isinstance(found.get("files"), dict):
        raise InputError(say("expected an object with files, found something else; name a new folder", place=path))
    for key in SAME:
        difference = next(_differences(found.get(key), run[key], key), None)
        if difference is not None:
            place, old, new = difference
            raise InputError(
                say(
                    "holds photos of another run: {} is {} there, and {} was asked for; ask for the same again to go "
                    "on with it, or name a new folder",
                    place,
                    _short(old),
                    _short(new),
                    place=folder,
                )
            )
    names = {photo["name"] for photo in run["photos"]}
    return {name: sums for name, sums in found["files"].items() if name in names and _is_complete(folder, sums)}


@dataclass(frozen=True, slots=True)
class BegunPhotos:
    """Photos of a flight that a run left which was cancelled, or ended otherwise before it was done."""

    folder: Path
    n_done: int
    n_photos: int
    width_px: int


def begun_photos(folder: Path, flight: Path) -> BegunPhotos | None:
    """What a folder holds of a flight's photos, with which the same run goes on; None where it holds none."""
    path = folder / RUN_FILE
    try:
        run = read_json(path, names_files=True) if path.is_file() else None
    except InputError:
        return None
    match run:
        case {
            "format": "reflight-scene-photos/1",
            "complete": False,
            "made_from": {"flight": str(name)},
            "camera": {"width_px": int(width_px)},
            "photos": list(photos),
            "files": dict(files),
        } if name == flight.name:
            return BegunPhotos(folder, len(files), len(photos), width_px)
    return None


def _differences(old: Any, new: Any, place: str) -> Iterator[tuple[str, Any, Any]]:
    """Places in two JSON values where they differ, from the inside out."""
    if isinstance(old, dict) and isinstance(new, dict):
        for key in dict.fromkeys((*old, *new)):
            yield from _differences(old.get(key), new.get(key), f"{place}.{key}")
    elif isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        for i, (one, other) in enumerate(zip(old, new, strict=True)):
            yield from _differences(one, other, f"{place}[{i}]")
    elif isinstance(old, list) and isinstance(new, list):
        yield f"number of {place}", len(old), len(new)
    elif old != new:
        yield place, old, new


def _short(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) <= LONGEST else f"{text[:LONGEST]}..."


def _is_complete(folder: Path, sums: Any) -> bool:
    """Whether all files of a photo are there as they were written."""
    if not isinstance(sums, dict) or not sums:
        return False
    try:
        return all(_is_inside(path) and sha256_of_file(folder / path) == sha256 for path, sha256 in sums.items())
    except InputError:
        return False


def _is_inside(path: str) -> bool:
    return not PurePath(path).is_absolute() and ".." not in PurePath(path).parts


def write_run(folder: Path, run: RunRecord, files: Files, is_complete: bool = False) -> None:
    """Write `scene.json`, whole or not at all.

    Raises
    ------
    InputError
        It cannot be written.
    """
    # Sorted: photos that are rendered side by side are done in any order.
    content = run | {"complete": is_complete, "files": dict(sorted(files.items()))}
    write_atomically(folder / RUN_FILE, json.dumps(content, indent=1).encode())

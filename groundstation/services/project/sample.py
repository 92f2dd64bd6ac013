"""The sample project: a small glass facade with everything done, from the site to a trained model.

It comes with the program as one archive, which `python -m tests.sample_project` makes by the program's own commands.
"""

from __future__ import annotations

import io
import zipfile
from pathlib import Path, PurePosixPath

from groundstation.services.project.project_file import is_project
from groundstation.services.settings import data_folder
from planning.base.errors import InputError
from planning.base.files import ANY_FILE, make_folder, read_input_file
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor

ARCHIVE = Path(__file__).with_name("data") / "sample.zip"

NAME = "sample"


def sample_folder() -> Path:
    """Where the user's copy of the sample lies."""
    return data_folder() / NAME


def unpack_sample(folder: Path, monitor: Monitor = QUIET) -> Path:
    """Make the user's copy of the sample project, unless there is one; returns its folder.

    Raises
    ------
    InputError
        The folder cannot be written, or is there already and no project.
    """
    if is_project(folder):
        return folder
    if folder.exists():
        raise InputError(say("expected the sample project or nothing there, found something else", place=folder))
    making = folder.with_name(f"{folder.name}.making")
    with zipfile.ZipFile(io.BytesIO(read_input_file(ARCHIVE, ANY_FILE))) as archive:
        names = archive.namelist()
        for number, name in enumerate(names):
            monitor.report(say("unpacking"), number, len(names))
            path = making / PurePosixPath(name)
            make_folder(path.parent)
            try:
                path.write_bytes(archive.read(name))
            except OSError as error:
                raise InputError(say("the sample project cannot be written: {}", error, place=path)) from error
    try:
        making.replace(folder)
    except OSError as error:
        raise InputError(say("the sample project cannot be written: {}", error, place=folder)) from error
    return folder

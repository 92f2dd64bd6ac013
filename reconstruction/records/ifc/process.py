"""IfcOpenShell in a process of its own: a hostile file may crash it, but not the program.

`python -m reconstruction.records.ifc.process TASK FILE FOLDER` reads `wanted.json` in the folder and leaves
`result.json` and a copy of the file, or `refused.txt` there. What IfcOpenShell prints stays in that process.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TypeVar

import msgspec

from planning.base.errors import InputError
from planning.base.files import read_given
from planning.base.json_file import check_output, encoded, write_atomically
from planning.base.messages import about
from planning.base.progress import QUIET, Monitor
from planning.base.step_physical_file import END, IFC_FILE, check_ends
from reconstruction.records.ifc.extend import Extension, extension
from reconstruction.records.ifc.extract import IfcProperties, extract, open_model
from reconstruction.records.ifc.sets import PropertySet

# The text of a STEP file (ISO 10303-21): instances taken out, exchanged and added; all other bytes stay.

# Texts and comments are passed over whole: semicolons in them end nothing.
_TOKEN = re.compile(rb"'[^']*'|/\*.*?\*/|;", re.DOTALL)
_INSTANCE = re.compile(rb"(?:\s|/\*.*?\*/)*#([0-9]+)\s*=", re.DOTALL)


def edited(content: bytes, lines: Sequence[str], replaced: Mapping[int, str]) -> bytes:
    """Text with new instances at the end of its data.

    Parameters
    ----------
    lines
        New instances.
    replaced
        New text of instances, by their number; "" takes one out.

    Raises
    ------
    InputError
        There is no end of the data, or an instance to be replaced is not there.
    """
    end = content.rfind(b"ENDSEC", 0, content.rfind(END))
    if end < 0:
        raise InputError("the data of the file do not end (ENDSEC is missing)")
    line_end = b"\r\n" if b"\r\n" in content[:2000] else b"\n"
    parts, position = [], 0
    for start, stop, number in _statements(content, end) if replaced else ():
        if number in replaced:
            text = replaced[number].encode("ascii")
            parts += [content[position:start], text]
            position = stop if text else _after_line(content, stop)
    if len(parts) != 2 * len(replaced):
        raise InputError("instances of the file that are to be replaced stand in it in a way that is not understood")
    added = b"".join(line.encode("ascii") + line_end for line in lines)
    return b"".join((*parts, content[position:end], added, content[end:]))


def _after_line(content: bytes, stop: int) -> int:
    """The place after the line end that follows, if one follows at once."""
    for line_end in (b"\r\n", b"\n"):
        if content.startswith(line_end, stop):
            return stop + len(line_end)
    return stop


def _statements(content: bytes, end: int) -> list[tuple[int, int, int]]:
    """Start, end and number of all instances before a place."""
    found, start = [], 0
    for token in _TOKEN.finditer(content, 0, end):
        if token[0] != b";":
            continue
        instance = _INSTANCE.match(content, start, token.end())
        if instance is not None:
            found.append((instance.start(1) - 1, token.end(), int(instance[1])))
        start = token.end()
    return found


COPY = "copy.ifc"

POLL_S = 0.1
"""Time between two looks at whether the user has cancelled."""

EXIT_REFUSED = 3

Result = TypeVar("Result")


class _Sets(msgspec.Struct, frozen=True):
    sets: dict[str, tuple[PropertySet, ...]]
    known: frozenset[str]


def read_properties(path: Path, global_ids: frozenset[str], monitor: Monitor = QUIET) -> IfcProperties:
    """Properties of the elements with these GlobalIds, see `extract`.

    Raises
    ------
    InputError
        The file is wrong, or so broken that its reader died of it.
    """
    check_ends(path)
    with tempfile.TemporaryDirectory(prefix="reflight-ifc-") as folder:
        return _run("read", path, Path(folder), encoded(global_ids), IfcProperties, monitor)


def extend_copy(
    path: Path,
    out: Path,
    sets: dict[str, tuple[PropertySet, ...]],
    known: frozenset[str],
    monitor: Monitor = QUIET,
) -> Extension:
    """Write a copy of an IFC file with property sets of ours, whole or not at all; all else stays as it is.

    Raises
    ------
    InputError
        The file is wrong, the copy would replace it, or it cannot be written.
    """
    check_ends(path)
    check_output(out, [path])
    with tempfile.TemporaryDirectory(prefix="reflight-ifc-") as folder:
        found = _run("extend", path, Path(folder), encoded(_Sets(sets, known)), Extension, monitor)
        write_atomically(out, (Path(folder) / COPY).read_bytes())
    return found


def _run(task: str, path: Path, folder: Path, wanted: bytes, kind: type[Result], monitor: Monitor) -> Result:
    root = Path(__file__).resolve().parents[3]
    inherited = os.environ.get("PYTHONPATH")
    environment = {**os.environ, "PYTHONPATH": f"{root}{os.pathsep}{inherited}" if inherited else str(root)}
    (folder / "wanted.json").write_bytes(wanted)
    # -P: modules that lie about in the current folder are not ours.
    process = subprocess.Popen(
        [sys.executable, "-P", "-m", "reconstruction.records.ifc.process", task, str(path.absolute()), str(folder)],
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL, env=environment,
    )  # fmt: skip
    try:
        while True:
            try:
                process.wait(POLL_S)
                break
            except subprocess.TimeoutExpired:
                monitor.report("reading the IFC file", 0, 0)
    except BaseException:
        process.kill()
        process.wait()
        raise
    if process.returncode == EXIT_REFUSED:
        raise InputError((folder / "refused.txt").read_text("utf-8"))
    if process.returncode != 0:
        raise InputError(
            f"{path}: the reader of IFC files crashed on this one (status {process.returncode}), so something in "
            "it goes in circles or beyond all bounds; open and export it again in a BIM program"
        )
    return msgspec.json.decode((folder / "result.json").read_bytes(), type=kind)


def main(arguments: list[str]) -> int:
    """Do one task, as the process of its own."""
    task, path, folder = arguments[0], Path(arguments[1]), Path(arguments[2])
    wanted = (folder / "wanted.json").read_bytes()
    result: object
    try:
        if task == "read":
            result = extract(path, msgspec.json.decode(wanted, type=frozenset[str]))
        else:
            result = _extend(path, folder / COPY, msgspec.json.decode(wanted, type=_Sets))
    except InputError as error:
        (folder / "refused.txt").write_text(str(error), "utf-8")
        return EXIT_REFUSED
    (folder / "result.json").write_bytes(encoded(result))
    return 0


def _extend(path: Path, copy: Path, wanted: _Sets) -> Extension:
    """Write the copy, and see that it has as many instances as it should."""
    found = extension(path, wanted.sets, wanted.known)
    try:
        copy.write_bytes(edited(read_given(path, IFC_FILE), found.lines, found.replaced))
    except InputError as error:
        raise InputError(about(path, error)) from error
    n_instances = len(list(open_model(copy)))
    if n_instances != found.n_instances:
        raise InputError(
            f"{path}: with the records the file would have {n_instances} instances, {found.n_instances} were expected; "
            "it is written in a way that is not understood; save it anew in a BIM program"
        )
    return found


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

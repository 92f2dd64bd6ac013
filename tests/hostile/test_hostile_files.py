"""Files that are damaged, hostile or none at all, given to the commands that read them.

Whatever a file holds, a command does its work, or ends with status 1 and one clear line: in bounds of memory and time,
without a traceback, and with nothing left half-written.
"""

from __future__ import annotations

import os
import random
import re
import shutil
import zlib
from pathlib import Path

import pytest

from tests.hostile.conftest import Forks
from tests.hostile.inputs import Input, real, written
from tests.hostile.mutations import BY_KIND, no_file

N_QUICK, N_LONG = 2, int(os.environ.get("REFLIGHT_MUTATIONS", "24"))
"""Damaged files of each kind."""

LONGEST_LINE = 1200
"""Characters of a refusal; paths in the tests' folders alone have 100 each."""


def copied(given: Input, workspace: Path, folder: Path) -> Path:
    """A folder with what the command needs; returns the file that is to be damaged."""
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "out").mkdir(parents=True)
    for name in given.needs:
        source = workspace / name
        if source.is_dir():
            shutil.copytree(source, folder / name)
        else:
            shutil.copy(source, folder / name)
    return folder / given.target


def contents(folder: Path) -> dict[str, tuple[int, int] | None]:
    """What is in a folder, to be compared with what is there afterwards."""
    found = {}
    for path in folder.rglob("*"):
        status = path.lstat()
        found[str(path.relative_to(folder))] = None if path.is_dir() else (status.st_size, status.st_mtime_ns)
    return found


BY_DECODERS = re.compile(r"^(libpng|Corrupt JPEG|Premature end of JPEG|Invalid SOS|Unsupported marker|TIFF).*\n", re.M)
"""What libraries for pictures print by themselves."""


def _said(path: Path) -> str:
    """What was printed, with the traceback of a report."""
    said = BY_DECODERS.sub("", path.read_text("utf-8", "replace"))
    report = re.search(r"please report it with (\S+)", said)
    return said if report is None else said + Path(report[1]).read_text()


IN_PLACE = ("train data -o", "scene render", "records objects", "project add")
"""Commands that go on in a folder which is there already, and keep what is whole in it."""


def complaint(given: Input, folder: Path, forks: Forks) -> str:
    """What was wrong with how a command took a file; empty where all was well."""
    before = contents(folder)
    out, err = folder.with_suffix(".out"), folder.with_suffix(".err")
    job = {"folder": str(folder), "out": str(out), "err": str(err)}
    job |= (
        {"command": given.command.split()}
        if given.command
        else {"reader": given.reader, "path": str(folder / given.target)}
    )
    answer = forks.run(job)
    said, after = _said(err), contents(folder)
    told = f"status {answer['status']} after {answer['seconds']:.1f} s: {said[-3000:]}"
    if not answer["in_time"]:
        return f"took too long: {told}"
    if answer["status"] not in (0, 1) or "Traceback" in said or "failed where it should not" in said:
        return told
    lines = [line for line in said.splitlines() if line.startswith("error: ")]
    # A plan that breaks a rule is told on standard output.
    is_told = (len(lines) == 1 and lines == said.splitlines()) or (not lines and out.stat().st_size > 0)
    if answer["status"] == 1 and not is_told:
        return f"expected one line: {told}"
    if any(len(line) > LONGEST_LINE for line in lines):
        return f"a line of {len(lines[0])} characters: {lines[0][:300]}"
    new = sorted(name for name in set(after) - set(before) if Path(name).name != ".lock")
    temporary = [name for name in new if Path(name).name.startswith(".")]
    if temporary or (lines and new and not given.command.startswith(IN_PLACE)):
        return f"left {temporary or new}: {told}"
    return ""


def wrong(given: Input, n: int, workspace: Path, folder: Path, forks: Forks) -> list[str]:
    """Complaints about `n` damaged files of a kind, and about what is no file."""
    found = []
    others = [workspace / name for name in ("plan.json", "m.kmz", "photo.png", "b.glb", "quick.toml", "t.tsp")]
    for number in range(n):
        rng = random.Random(zlib.crc32(f"{given.name} {number}".encode()))
        case = folder / "case"
        path = copied(given, workspace, case)
        if number % 4 == 3:
            what = no_file(path, rng, others)
        else:
            mutation = rng.choice(BY_KIND[given.form])
            path.write_bytes(mutation(path.read_bytes(), rng))
            what = mutation.__name__
        said = complaint(given, case, forks)
        if said:
            found.append(f"{given.name}, {number} ({what}): {said}")
            kept = os.environ.get("REFLIGHT_KEEP")
            if kept and path.is_file() and path.stat().st_size < 2**24:
                shutil.copy(path, Path(kept) / f"{given.name.replace('/', '_')}-{number}-{path.name}")
    return found


@pytest.mark.long
@pytest.mark.few(2)
@pytest.mark.parametrize("given", [given for given in written() if given.is_quick], ids=lambda given: given.name)
def test_damaged_files_are_read_or_refused(given, workspace, tmp_path, forks):
    copied(given, workspace, tmp_path / "case")
    assert complaint(given, tmp_path / "case", forks) == ""
    assert wrong(given, N_QUICK, workspace, tmp_path, forks) == []


@pytest.mark.slow
@pytest.mark.parametrize("given", [*written(), *real()], ids=lambda given: given.name)
def test_many_damaged_files_of_every_kind_are_read_or_refused(given, full_workspace, tmp_path, forks):
    copied(given, full_workspace, tmp_path / "case")
    assert complaint(given, tmp_path / "case", forks) == ""
    assert wrong(given, N_LONG, full_workspace, tmp_path, forks) == []

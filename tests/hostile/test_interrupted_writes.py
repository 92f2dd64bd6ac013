"""Commands that are killed while they write, and disks that are full: what is there is old or new, never of both.

Every command is killed at each of its changes to the disk in turn, and in the middle of its files; and its files are
kept from growing beyond a size, as a full disk does. It is then run again, and leaves nothing of the run before.
"""

from __future__ import annotations

import hashlib
import random
import re
import shutil
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.conftest import SHARED_DATA
from tests.hostile.conftest import Forks
from tests.hostile.inputs import FLYING
from tests.services.project_cases import small_disk


@dataclass(frozen=True)
class Write:
    """A command that writes over what another one wrote.

    Parameters
    ----------
    needs
        Files and folders of the workspace.
    old
        Command that was run before; empty for none.
    new
        The command that is interrupted.
    again
        Command that goes on afterwards, where it is another one.
    kept
        What is looked at, in the folder of the case.
    is_each
        Each file is of its own: some may be old and others new.
    check
        Asked of the folder after each interruption.
    is_same
        Two runs write the same bytes.
    """

    name: str
    needs: tuple[str, ...]
    old: str
    new: str
    again: str = ""
    kept: str = "out"
    is_each: bool = False
    check: Callable[[Path], None] = lambda _: None
    is_same: bool = True
    is_quick: bool = False


MODELS = ("data", "model", "lit", "quick.toml")
IMPORT = "site import {} -o out/s.json --origin 22.3,114.2,60 --without-panels"
TRAIN = "train data -o out/m --preset smoke --iterations 4 --method 2dgs --settings quick.toml"


def whole_model(folder: Path) -> None:
    """A model that can be read, and splats that are its own."""
    from reconstruction.splats.ply import read_splats
    from reconstruction.training.model.saved import SPLATS, read_model
    from reconstruction.training.parameters import MODEL as DESCRIPTION

    if (folder / "out/m" / DESCRIPTION).exists():
        model = read_model(folder / "out/m").model
        if (folder / "out/m" / SPLATS).exists():
            means = read_splats(folder / "out/m" / SPLATS).splats.means.detach().numpy()
            assert means.shape == tuple(model.splats.means.shape)
            expected = model.splats.means.detach().numpy()
            assert abs(means - means.mean(0) - (expected - expected.mean(0))).max() < 1e-4


def whole_records(folder: Path) -> None:
    """Records without damage, and pictures of all defects."""
    from reconstruction.records.book import FILE, RecordBook
    from reconstruction.records.entries import Defect
    from reconstruction.records.stored_files import stored_path

    with RecordBook(folder / "objects" / FILE) as book:
        book.check()
        for defect in book.entries(Defect):
            if defect.picture:
                stored_path(book, defect.picture)


def whole_project(folder: Path) -> None:
    """A project that opens without a note."""
    from groundstation.services.project.folder import open_project

    assert [note.code for note in open_project(folder / "project").notes] == []


WRITES = [
    Write("mission", (*FLYING, "other.json"), "export other.json --format dji-kmz -o out/m.kmz",
          "export plan.json --format dji-kmz -o out/m.kmz", is_same=False, is_quick=True),
    Write("site", ("b.glb", "wall.ply"), IMPORT.format("wall.ply"), IMPORT.format("b.glb"), is_quick=True),
    Write("objects", MODELS, "organise model -o out/o", "organise lit -o out/o"),
    Write("tiles", ("objects", "others"), "export objects --format 3d-tiles -o out/t",
          "export others --format 3d-tiles -o out/t"),
    Write("web page", ("objects", "others"), "export objects --format web -o out/w",
          "export others --format web -o out/w"),
    Write("glTF", ("objects", "others"), "export objects --format gltf -o out/m.glb",
          "export others --format gltf -o out/m.glb"),
    Write("SOG", ("objects", "others"), "export objects --format sog -o out/m.sog",
          "export others --format sog -o out/m.sog"),
    Write("PLY", MODELS, "export model --format ply -o out/m.ply", "export lit --format ply -o out/m.ply"),
    Write("tables", ("objects", "others"), "records objects export -o out/t", "records others export -o out/t"),
    Write("records imported", ("objects", "tables"), "records objects set A-1 maker=Other",
          "records objects import tables", kept="objects", check=whole_records, is_same=False),
    Write("defect with its picture", ("objects", "picture.png"), "", "records objects add A-1 defect kind=crack "
          "severity=3 found_on=2026-01-02 picture=picture.png", kept="objects", check=whole_records, is_same=False),
    Write("pictures", MODELS, "render model --views data -o out/r --width 16",
          "render lit --views data -o out/r --width 16", is_each=True),
    Write("training", MODELS, TRAIN, f"{TRAIN} --seed 3", again="train data -o out/m --resume", check=whole_model,
          is_same=False),
    Write("project", ("project", "other.json"), "", "project add project other.json", kept="project",
          check=whole_project, is_same=False),
    Write("photos", ("site.json", "wall.ply"), "", "scene render site.json --square 2 --width 16 --points 20 -o out/s",
          is_each=True, is_same=False),
    Write("brief", (*FLYING, "other.json"), "brief other.json site.json -o out/b.html",
          "brief plan.json site.json -o out/b.html", is_same=False),
    Write("panels", ("photo.png", "photo.bmp"), "segment photo.bmp -o out/p.json --long-side 100",
          "segment photo.png -o out/p.json", is_same=False),
]  # fmt: skip
if SHARED_DATA.is_dir():
    WALL = ("wall.site.json", "wall.site.ply", "wall", "colmap")
    WRITES.append(
        Write("data set", WALL, "", "prepare wall wall.site.json --colmap colmap -o out/d", is_each=True, is_same=False)
    )

ids = [write.name for write in WRITES]
quick = [write for write in WRITES if write.is_quick]


class Case:
    """A folder in which a command is interrupted again and again, each time from the same start."""

    def __init__(self, write: Write, workspace: Path, folder: Path, forks: Forks, said: Path | None = None) -> None:
        self.write, self.folder, self._forks, self._start = write, folder / "case", forks, folder / "start"
        self._said = (said or folder) / "said"
        (self._start / "out").mkdir(parents=True)
        for name in write.needs:
            source = workspace / name
            (shutil.copytree if source.is_dir() else shutil.copy)(source, self._start / name)
        self.begin(self._start)
        if write.old:
            assert self.run(write.old)[0] == 0, self.said
        self._start = folder / "old"
        shutil.copytree(self.folder, self._start, symlinks=True)
        self.old = self.state()
        assert self.run(write.new)[0] == 0, self.said
        self.new = self.state()
        assert self.new != self.old
        self.begin()

    def begin(self, start: Path | None = None) -> None:
        """Have everything as it was."""
        shutil.rmtree(self.folder, ignore_errors=True)
        shutil.copytree(start or self._start, self.folder, symlinks=True)

    def run(self, command: str, **options: object) -> tuple[int, list[str]]:
        """Run a command; returns its status and what it had left that nobody owns."""
        out, err = self._said.with_suffix(".out"), self._said.with_suffix(".err")
        job = {"folder": str(self.folder), "out": str(out), "err": str(err), "command": command.split(), **options}
        status = self._forks.run(job)["status"]
        self.said = err.read_text("utf-8", "replace")
        hidden = [path for path in (self.folder / self.write.kept).rglob(".*") if not path.name.startswith(".lock")]
        return int(str(status)), [path.name for path in hidden]

    def state(self) -> dict[str, str]:
        """Files by name, with what they hold; what is only in the making is none."""
        root = self.folder / self.write.kept
        files = [path for path in root.rglob("*") if path.is_file() and not path.name.startswith(".")]
        return {str(path.relative_to(root)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}

    def check(self) -> None:
        """What is there is old or new."""
        self.write.check(self.folder)
        found = self.state()
        changed = [name for name, content in self.old.items() if self.new.get(name, content) != content]
        kinds = {found[name] == self.old[name] for name in changed if name in found}
        assert self.write.is_each or len(kinds) < 2, f"old beside new: {found}"
        if self.write.is_same:
            for name, content in found.items():
                assert content in (self.old.get(name), self.new.get(name)), f"{name} is half of something"

    def finish(self) -> None:
        """The next run makes it whole, and leaves nothing of this one."""
        status, hidden = self.run(self.write.new)
        if status and self.write.again:
            status, hidden = self.run(self.write.again)
        is_done = "already" in self.said or "is not empty; name a new folder for the data set" in self.said
        assert status == 0 or is_done, self.said
        assert hidden == []
        self.write.check(self.folder)
        if is_done and self.write.kept == "out":
            assert set(self.state()) == set(self.new)
        if self.write.is_same:
            assert self.state() == self.new
        elif status == 0:
            named_by_content = re.compile(r"weights-|[0-9a-f]{64}")
            assert set(self.state()) >= {name for name in self.new if not named_by_content.search(name)}


def killed_at(case: Case, number: int) -> bool:
    """Kill it at a write; False where it has not as many."""
    case.begin()
    status, _ = case.run(case.write.new, kill_at=number)
    assert status in (0, -9), case.said
    case.check()
    case.finish()
    return status == -9


@pytest.mark.long
@pytest.mark.parametrize("write", quick, ids=[write.name for write in quick])
def test_a_command_that_is_killed_leaves_old_or_new(write, workspace, tmp_path, forks):
    case, rng = Case(write, workspace, tmp_path, forks), random.Random(zlib.crc32(write.name.encode()))
    killed_at(case, rng.randrange(6, 12))


@pytest.mark.slow
@pytest.mark.timeout(3600)  # a training has dozens of writes, each followed by another training
@pytest.mark.parametrize("write", WRITES, ids=ids)
def test_a_command_that_is_killed_at_any_write_leaves_old_or_new(write, full_workspace, tmp_path, forks):
    case, rng = Case(write, full_workspace, tmp_path, forks), random.Random(zlib.crc32(write.name.encode()))
    number = 0
    while killed_at(case, number):
        number += 1 if number < 40 else rng.randrange(5, 60)


@pytest.mark.slow
@pytest.mark.parametrize("write", WRITES, ids=ids)
def test_a_command_that_is_killed_at_any_moment_or_byte_leaves_old_or_new(write, full_workspace, tmp_path, forks):
    case, rng = Case(write, full_workspace, tmp_path, forks), random.Random(zlib.crc32(write.name.encode()))
    for number in range(8):
        case.begin()
        how = {"kill_after_s": rng.uniform(0.05, 1.0)} if number % 2 else {
            "file_limit": int(10 ** rng.uniform(2.0, 5.0)), "is_killed": True
        }  # fmt: skip
        status, _ = case.run(write.new, **how)
        assert status in (0, -9, -25), case.said
        case.check()
        case.finish()


def full_at(case: Case, **options: object) -> None:
    """Files do not grow beyond a size: nothing is changed, and one line says so."""
    case.begin()
    status, hidden = case.run(case.write.new, **options)
    assert status in (0, 1), case.said
    assert hidden == []
    case.write.check(case.folder)
    if status:
        assert len(case.said.splitlines()) == 1, case.said
        assert case.said.startswith("error: ")
        assert "failed where it should not" not in case.said
        if case.write.is_each:
            case.check()
        else:
            assert case.state().items() >= case.old.items()
            # What a training goes on from.
            assert set(case.state()) - set(case.old) <= {"m/checkpoint.safetensors", "m/training.json"}


@pytest.mark.long
@pytest.mark.parametrize("write", quick, ids=[write.name for write in quick])
def test_a_full_disk_changes_nothing(write, workspace, tmp_path, forks):
    case = Case(write, workspace, tmp_path, forks)
    full_at(case, file_limit=1500)


@pytest.mark.slow
@pytest.mark.parametrize("write", WRITES, ids=ids)
def test_a_disk_that_is_full_at_any_size_changes_nothing(write, full_workspace, tmp_path, forks):
    case = Case(write, full_workspace, tmp_path, forks)
    for exponent in range(10, 20):  # what is said has to go somewhere, too
        full_at(case, file_limit=2**exponent)


@pytest.mark.slow
@pytest.mark.parametrize("write", WRITES, ids=ids)
def test_a_small_disk_that_gets_full_changes_nothing(write, full_workspace, tmp_path, forks):
    with small_disk(tmp_path / "disk", 100_000) as disk:
        if disk is None:
            pytest.skip("a file system of a few megabytes cannot be mounted here")
        case, filler = Case(write, full_workspace, disk, forks, tmp_path), disk / "filler"
        for free_kib in (0, 4, 12, 40, 120, 400):
            filler.unlink(missing_ok=True)
            case.begin()
            filler.write_bytes(bytes(max(0, shutil.disk_usage(disk).free - 1024 * free_kib)))
            status, hidden = case.run(case.write.new)
            after = case.state()
            assert status in (0, 1), case.said
            assert hidden == []
            if status:
                assert case.said.startswith("error: ")
                assert "failed where it should not" not in case.said, case.said
                if case.write.is_each:
                    case.check()
                else:
                    assert after.items() >= case.old.items()

"""One runner for everything whose accuracy is weighed against time.

What is compared (plans, tours, searches for panels, rendered photos, trainings) is a `Subject`: how its results become
rows of a table, panels of a picture and a title. `compare` runs it and writes both files together, `tradeoff-NAME.csv`
and `.png`; runs that fail or are cancelled leave nothing behind. Where knobs are turned one at a time, each result is
`Turned`, and `knob_lines` draws them alike.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

from planning.base.errors import InputError
from planning.base.json_file import part_folder, write_atomically
from planning.base.progress import Monitor, QualityPoint
from planning.tradeoff.curves import falling
from planning.tradeoff.picture import GapAxis, Line, Panel, draw

Found = TypeVar("Found")

Rows = Sequence[Mapping[str, Any]]


@dataclass(frozen=True, slots=True)
class Subject(Generic[Found]):
    """Something that can be compared.

    Parameters
    ----------
    name
        For the files: `plan` makes `tradeoff-plan.csv`.
    axis
        How its gaps are shown.
    rows, title, panels
        Of what a run found.
    more
        Tables beside the first, by what their names have after it.
    """

    name: str
    axis: GapAxis
    rows: Callable[[Found], Rows]
    title: Callable[[Found], str]
    panels: Callable[[Found], Sequence[Panel]]
    more: Callable[[Found], Mapping[str, Rows]] = lambda found: {}


@dataclass(frozen=True, slots=True, eq=False)
class Compared(Generic[Found]):
    """What was found, and the files written: the table, the picture, further tables."""

    found: Found
    csv_path: Path
    picture_path: Path
    more_paths: tuple[Path, ...] = ()

    @property
    def paths(self) -> tuple[Path, ...]:
        """All files."""
        return (self.csv_path, self.picture_path, *self.more_paths)


def compare(subject: Subject[Found], out: Path, run: Callable[[Path], Found]) -> Compared[Found]:
    """Run, and write what comes of it into `out`.

    Parameters
    ----------
    run
        Gets a folder for files of its own, which are moved into `out` as well.

    Raises
    ------
    InputError
        The folder cannot be made or written into.
    """
    stem = f"tradeoff-{subject.name}"
    with output_folder(out) as folder:
        found = run(folder)
        write_rows(folder / f"{stem}.csv", subject.rows(found))
        draw(subject.title(found), subject.panels(found), subject.axis, folder / f"{stem}.png")
        more = subject.more(found)
        for name, rows in more.items():
            write_rows(folder / f"{stem}-{name}.csv", rows)
    return Compared(found, out / f"{stem}.csv", out / f"{stem}.png", tuple(out / f"{stem}-{name}.csv" for name in more))


class Turned(Protocol):
    """What came of one setting: of all knobs one was turned, or none (""); how long it took, and its gap."""

    @property
    def knob(self) -> str:
        """What was turned."""

    @property
    def value(self) -> str:
        """To where."""

    @property
    def seconds(self) -> float:
        """That one run took."""

    @property
    def gap(self) -> float:
        """From the best there is."""


AnyTurned = TypeVar("AnyTurned", bound=Turned)


def knob_lines(results: Sequence[AnyTurned], nothing_turned: str, text: Callable[[AnyTurned], str]) -> tuple[Line, ...]:
    """A line for each knob: the smallest gap that its settings reach in the time they take, and the best in words."""
    lines = []
    for knob in dict.fromkeys(result.knob for result in results):
        chosen = sorted((result for result in results if result.knob == knob), key=lambda result: result.seconds)
        best = min(chosen, key=lambda result: result.gap)
        points = [QualityPoint(result.seconds, result.gap) for result in chosen]
        remark = f"{best.value}: {text(best)}".removeprefix(": ")
        lines.append(Line(knob or nothing_turned, falling(points, chosen[-1].seconds), remark))
    return tuple(lines)


class NumberedRuns:
    """Progress of one run among all of them."""

    def __init__(self, monitor: Monitor, word: str = "run") -> None:
        self._monitor, self._word, self._prefix = monitor, word, ""

    def begin(self, number: int, n_runs: int) -> None:
        """Run `number`, counted from 0, begins."""
        self._prefix = f"{self._word} {number + 1} of {n_runs}, "

    def report(self, stage: str, done: float, total: float) -> None:
        """Take the number of the run from a sweep over runs, everything else from the run itself."""
        if stage == "running":
            self.begin(round(done), round(total))
        else:
            self._monitor.report(self._prefix + stage, done, total)


@contextmanager
def output_folder(path: Path) -> Iterator[Path]:
    """Make a temporary folder whose files are moved into `path` in the end; nothing is left where that end is an error.

    Raises
    ------
    InputError
        The folder cannot be made or written into.
    """
    made = [folder for folder in (path, *path.parents) if not folder.exists()]
    try:
        path.mkdir(parents=True, exist_ok=True)
        with part_folder(path, "tradeoff") as temporary:
            yield temporary
            for file in sorted(temporary.iterdir()):
                file.replace(path / file.name)
            made = []
    except OSError as error:
        text = f"{path}: this folder cannot be made or written into ({error.strerror or error}); name another"
        raise InputError(text) from error
    finally:
        for folder in made:
            with suppress(OSError):  # it was never made, or holds something
                folder.rmdir()


def write_rows(path: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    """Write a table; cells stay empty where a row lacks a column."""
    columns = list(dict.fromkeys(column for row in rows for column in row))
    text = io.StringIO(newline="")
    writer = csv.DictWriter(text, columns, restval="")
    writer.writeheader()
    writer.writerows(rows)
    write_atomically(path, text.getvalue().encode())

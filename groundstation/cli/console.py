"""What all commands share: running a job with progress on stderr, one JSON object on stdout, lists of findings."""

from __future__ import annotations

import json
import shlex
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar, copy_context
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO, TypeVar

from groundstation.services.jobs.runner import JobContext, JobEvent, JobProgress, JobRunner
from groundstation.services.messages import LANGUAGES, localized, translation
from groundstation.services.units import UnitSystem
from planning.base.findings import Finding, Severity
from planning.base.messages import Message, about, glue, joined, say
from planning.base.progress import hear_compiling

if TYPE_CHECKING:
    from missions.flight.outcome import FlightReport
    from planning.tradeoff.runner import ComparisonFiles

Result = TypeVar("Result")
Found = TypeVar("Found")

MARKS = {Severity.ERROR: "ERROR", Severity.WARNING: "warning", Severity.NOTE: "note", Severity.OK: "ok"}

MAX_SHOWN = 5
"""Different findings of one kind that are printed before the rest is only counted."""


_LANGUAGE: ContextVar[str] = ContextVar("language", default=LANGUAGES[0])


@contextmanager
def speaking(language: str) -> Iterator[None]:
    """Messages are in a language meanwhile (one of `groundstation.services.messages.LANGUAGES`)."""
    before = _LANGUAGE.set(language)
    try:
        yield
    finally:
        _LANGUAGE.reset(before)


def worded(text: str) -> str:
    """A message in the language of the command line."""
    if _LANGUAGE.get() == LANGUAGES[0]:
        return text
    return localized(text, translation(_LANGUAGE.get()), UnitSystem.METRIC)


def tell(template: str, *values: object, place: object = "", file: TextIO | None = None, end: str = "\n") -> None:
    """Print a message, as `planning.base.messages.say` makes it, in the language of the command line."""
    show(say(template, *values, place=place), file=file, end=end)


def show(text: str, *, file: TextIO | None = None, end: str = "\n") -> None:
    """Print a message that is made already, in the language of the command line."""
    print(worded(text), file=file, end=end, flush=file is sys.stderr)


def tell_compiling() -> Callable[[], None]:
    """Say it, in a line of its own, when kernels are compiled; returns what ends that."""
    # Threads of jobs do not know what this one speaks.
    context, over_progress = copy_context(), "\r\033[K" if sys.stderr.isatty() else ""
    return hear_compiling(lambda text: context.copy().run(show, glue(over_progress, text), file=sys.stderr))


def program_name() -> str:
    """What to type: what was typed, for it works where the user is."""
    typed = Path(sys.argv[0])
    if typed.stem == "reflight":
        return "reflight"
    return "python -m groundstation" if typed.parts[-2:] == ("groundstation", "__main__.py") else "app.py"


def run_job(name: str, work: Callable[[JobContext], Result]) -> Result:
    """Result of `work`, run as a job; progress goes to stderr when that is a terminal, Ctrl-C cancels."""
    runner = JobRunner()
    line = _ProgressLine()
    runner.subscribe(line.show)
    job = runner.submit(name, work)
    try:
        while not job.wait(0.2):
            pass
    except KeyboardInterrupt:
        runner.cancel(job)
        job.wait()
        raise
    finally:
        line.clear()
        runner.shutdown()
    return job.result()


class _ProgressLine:
    """One line on the terminal that is written over and over."""

    def __init__(self) -> None:
        self._shown = False
        self._enabled = sys.stderr.isatty()
        # Jobs have threads of their own, which do not know what this one speaks.
        self._context = copy_context()

    def show(self, event: JobEvent) -> None:
        """Show where a job stands."""
        if not self._enabled or not isinstance(event, JobProgress):
            return
        share = f" {100 * event.done / event.total:3.0f} %" if event.total > 0 else ""
        left = say(", {:.0f} s left", event.remaining_s) if event.remaining_s is not None else ""
        stage = glue(f"\r\033[K{event.elapsed_s:5.1f} s  ", event.stage, share, left)
        self._context.copy().run(show, stage, file=sys.stderr, end="")
        self._shown = True

    def clear(self) -> None:
        """Take the line away."""
        if self._shown:
            print("\r\033[K", end="", file=sys.stderr, flush=True)


def print_json(content: dict[str, Any]) -> None:
    """One JSON object on stdout."""
    print(json.dumps(content, indent=1, allow_nan=False))


def show_tradeoff(
    name: str,
    is_json: bool,
    work: Callable[[JobContext], ComparisonFiles[Found]],
    summary: Callable[[Found], dict[str, Any]],
    tell: Callable[[Found], object],
) -> int:
    """Weigh something against time and say what came of it; returns the exit status.

    Parameters
    ----------
    summary
        What the JSON object has besides the files.
    tell
        Prints it for people; the files follow.
    """
    compared = run_job(f"tradeoff {name}", work)
    if is_json:
        print_json({"csv": str(compared.csv_path), "picture": str(compared.picture_path), **summary(compared.found)})
        return 0
    tell(compared.found)
    for path in compared.paths:
        print(path)
    return 0


def table_row(*cells: tuple[str, int]) -> str:
    """A line of a table in the language of the command line: texts and widths, below 0 for what stands on the left."""
    shown = ((worded(text), width) for text, width in cells)
    # A word that is as long as its column keeps a space before it.
    return "  " + "".join(f"{text:<{-width}}" if width < 0 else f" {text:>{width - 1}}" for text, width in shown)


def print_notes(notes: Iterable[str], file: TextIO | None = None) -> None:
    """Notes, a line each."""
    for note in notes:
        tell("note: {}", note, file=file)


def print_findings(findings: Iterable[Finding]) -> None:
    """Findings on stderr: equal ones once with their number, and of each kind the first few."""
    alike: dict[tuple[Severity, str], dict[str, list[Finding]]] = {}
    for finding in findings:
        texts = alike.setdefault((finding.severity, finding.code), {})
        texts.setdefault(finding.message, []).append(finding)
    for (severity, _), texts in alike.items():
        for message, equal in list(texts.items())[:MAX_SHOWN]:
            place = equal[0].place
            if len(equal) > 1:
                n = len(equal)
                message += say(" ({} times, the first: {})", n, place) if place else say(" ({} times)", n)
            elif place and place not in message:
                message = about(place, message)
            print(f"{worded(MARKS[severity])}: {worded(message)}", file=sys.stderr)
        if len(texts) > MAX_SHOWN:
            more = say("{} more like this (--json lists all)", len(texts) - MAX_SHOWN)
            print(f"{worded(MARKS[severity])}: {worded(more)}", file=sys.stderr)


def verdict_text(findings: Iterable[Finding]) -> Message:
    """Whether a plan is ready to fly, in words."""
    from groundstation.services.mission.readiness import Readiness, not_looked_at, readiness_of

    findings = tuple(findings)
    match readiness_of(findings):
        case Readiness.READY:
            verdict = say("ready to fly")
        case Readiness.WITH_WARNINGS:
            n_warnings = sum(finding.severity is Severity.WARNING for finding in findings)
            verdict = say("ready to fly, but read {} above", counted(n_warnings, "warning"))
        case Readiness.NOT_READY:
            return say("not ready to fly: see the errors above")
    unknown = not_looked_at(findings)
    return say("{}; not looked at: {}", verdict, joined(", ", unknown)) if unknown else verdict


def flight_status(report: FlightReport) -> int:
    """Exit status of a flight's report: 1, and a line that says why, where the flight did not end as it should."""
    from missions.flight.report_rules import ENDED_BADLY

    worst = next((finding for finding in report.findings if finding.code in ENDED_BADLY), None)
    if worst is None:
        return 0
    print(f"{worded('error')}: {worded(about(worst.place, worst.message))}", file=sys.stderr)
    return 1


def print_next(*arguments: object) -> None:
    """The command to type next, on stderr."""
    tell("next: {} {}", program_name(), shlex.join(map(str, arguments)), file=sys.stderr)


def named_like(path: Path, ending: str) -> Path:
    """Name for what is made from a site or plan file: `office.site.json` and `.kmz` give `office.kmz`."""
    stem = path.name.removesuffix(".json").removesuffix(".site").removesuffix(".plan")
    return path.with_name((stem or path.name) + ending)


COUNTED = (
    *(say("{} column", 1), say("{} columns", 2), say("{} facade", 1), say("{} facades", 2), say("{} Gaussian", 1)),
    *(say("{} Gaussians", 2), say("{} hit", 1), say("{} hits", 2), say("{} object", 1), say("{} objects", 2)),
    *(say("{} panel", 1), say("{} panels", 2), say("{} photo", 1), say("{} picture", 1)),
    *(say("{} pictures", 2), say("{} plan", 1), say("{} plans", 2), say("{} record", 1), say("{} records", 2)),
    *(say("{} row", 1), say("{} rows", 2), say("{} sortie", 1), say("{} sorties", 2), say("{} splat", 1)),
    *(say("{} splats", 2), say("{} step", 1), say("{} steps", 2), say("{} unseen view", 1)),
    *(say("{} unseen views", 2), say("{} view", 1)),
    *(say("{} warning", 1), say("{} warnings", 2)),
)
"""What `counted` says, for translators."""


def counted(n: int, singular: str) -> Message:
    """A number of things: `1 sortie`, `2 sorties`."""
    return say(f"{{}} {singular}{'' if n == 1 else 's'}", n)

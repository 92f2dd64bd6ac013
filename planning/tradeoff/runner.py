"""One runner for everything whose accuracy is weighed against time: its curves, tables and pictures.

What is compared (plans, tours, searches for panels, rendered photos, trainings) is a `Subject`: how its results become
rows of a table, panels of a picture and a title. `compare` runs it and writes both files together, `tradeoff-NAME.csv`
and `.png`; runs that fail or are cancelled leave nothing behind. Where knobs are turned one at a time, each result is
`KnobResult`, and `knob_lines` draws them alike.
"""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

from planning.base.errors import InputError
from planning.base.json_file import part_folder, write_atomically
from planning.base.progress import Monitor, QualityPoint

# Curves of quality against time, the winner among them, and answers to "I have 60 s" and "I want 99 %".
#
# Quality is a gap: how far the best known is from a bound, as a part of the bound; 0 is proven to be the best there is.
# For coverage the gap is 1 - covered / bound, for a tour length / bound - 1.

BUDGETS_S = (1.0, 3.0, 10.0, 30.0, 60.0)
"""Times for which the best run is named."""


@dataclass(frozen=True, slots=True)
class Curve:
    """Gap against time of one run: only the points at which it became smaller.

    Parameters
    ----------
    points
        `value` is the gap; times rise, gaps fall.
    end_s
        When the run was over.
    """

    points: tuple[QualityPoint, ...]
    end_s: float

    @property
    def final_gap(self) -> float:
        """Gap in the end; infinite for a run that found nothing."""
        return self.points[-1].value if self.points else math.inf

    def gap_at(self, t_s: float) -> float:
        """Gap after `t_s` seconds; infinite before anything was found."""
        return min((point.value for point in self.points if point.t_s <= t_s), default=math.inf)

    def time_to(self, gap: float) -> float | None:
        """Seconds until the gap was no larger than `gap`; None where it never was."""
        return next((point.t_s for point in self.points if point.value <= gap), None)

    def until(self, t_s: float) -> Curve:
        """What was known after `t_s` seconds."""
        return Curve(tuple(point for point in self.points if point.t_s <= t_s), min(self.end_s, t_s))


def falling(points: Iterable[QualityPoint], end_s: float) -> Curve:
    """Curve of the smallest gap so far."""
    kept: list[QualityPoint] = []
    for point in points:
        if not kept or point.value < kept[-1].value:
            kept.append(point)
    return Curve(tuple(kept), end_s)


def mean_curve(curves: Sequence[Curve]) -> Curve:
    """Mean gap of several runs (seeds), from when all of them had found something, to when the last was over."""
    times = sorted({point.t_s for curve in curves for point in curve.points})
    means = (QualityPoint(t_s, math.fsum(c.gap_at(t_s) for c in curves) / len(curves)) for t_s in times)
    return falling((mean for mean in means if math.isfinite(mean.value)), max(curve.end_s for curve in curves))


@dataclass(frozen=True, slots=True)
class Noise:
    """Gaps that count as equal: up to `floor` and, of the smaller one, `share` above it."""

    floor: float
    share: float = 0.0

    def equal_up_to(self, gap: float) -> float:
        """Largest gap that counts as equal to the smaller `gap`."""
        return gap + self.floor + self.share * gap


def winner(curves: Mapping[str, Curve], noise: Noise) -> str | None:
    """Name of the run with the smallest gap in the end; None where no run found anything.

    Among runs that count as equal to it, the first to get there wins.
    """
    best = min((curve.final_gap for curve in curves.values()), default=math.inf)
    if math.isinf(best):
        return None
    arrivals = {name: curve.time_to(noise.equal_up_to(best)) for name, curve in curves.items()}
    return min((t_s, name) for name, t_s in arrivals.items() if t_s is not None)[1]


@dataclass(frozen=True, slots=True)
class BudgetAnswer:
    """What so many seconds give, and which run gives it; None where nothing had been found by then."""

    budget_s: float
    run: str | None
    gap: float | None


@dataclass(frozen=True, slots=True)
class GapAnswer:
    """After how many seconds the gap was no larger than `gap`, and in which run; None where it never was."""

    gap: float
    run: str | None
    t_s: float | None


@dataclass(frozen=True, slots=True)
class Answers:
    """The winner in the end, the winner at each budget, and the first to reach each gap."""

    winner: str | None
    by_budget: tuple[BudgetAnswer, ...]
    by_gap: tuple[GapAnswer, ...]


def answers(
    curves: Mapping[str, Curve], gaps: Sequence[float], noise: Noise, budgets_s: Sequence[float] = BUDGETS_S
) -> Answers:
    """Winner overall and at each budget by the rule of `winner`, and who is first to reach each of `gaps`."""
    by_budget = []
    for budget_s in budgets_s:
        name = winner({name: curve.until(budget_s) for name, curve in curves.items()}, noise)
        by_budget.append(BudgetAnswer(budget_s, name, None if name is None else curves[name].gap_at(budget_s)))
    by_gap = []
    for gap in gaps:
        reached = [(t_s, name) for name, curve in curves.items() if (t_s := curve.time_to(gap)) is not None]
        t_s, first = min(reached) if reached else (None, None)
        by_gap.append(GapAnswer(gap, first, t_s))
    return Answers(winner(curves, noise), tuple(by_budget), tuple(by_gap))


def seconds_text(t_s: float) -> str:
    """Seconds with two digits or more."""
    return f"{t_s:.0f} s" if t_s >= 100.0 else f"{t_s:.1f} s" if t_s >= 1.0 else f"{t_s:.2g} s"


def answers_summary(found: Answers, key: str, value: Callable[[float], float]) -> dict[str, Any]:
    """Answers as JSON; `value` turns a gap into what is called `key` there."""
    return {
        "winner": found.winner,
        "by_budget": [
            {"t_s": budget.budget_s, "run": budget.run, key: None if budget.gap is None else value(budget.gap)}
            for budget in found.by_budget
        ],
        "by_quality": [{key: value(goal.gap), "run": goal.run, "t_s": goal.t_s} for goal in found.by_gap],
    }


# Pictures of quality against time: one panel a question, a line a run, both axes logarithmic.

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#999999")
"""Told apart by colour-blind readers too (Okabe and Ito, 2008)."""

STYLES = ("-", "--", "-.", ":")
"""Lines that lie on each other still show both where their styles differ."""

DENSE_TICKS, SPARSE_TICKS = (1.0, 2.0, 3.0, 5.0, 7.0), (1.0, 3.0)
"""Ticks of the time axis in each decade, up to `DENSE_DECADES` decades and beyond."""

DENSE_DECADES = 1.7

PANEL_WIDTH_IN, PANEL_HEIGHT_IN, LEGEND_LINE_IN, DOTS_PER_INCH = 6.0, 4.0, 0.2, 110

MAX_COLUMNS = 2

SHORTEST_S = 0.003
"""The time axis starts no earlier: what is there by then is there at once."""


@dataclass(frozen=True, slots=True)
class Line:
    """One run: its curve, and what is said about its end in the legend."""

    name: str
    curve: Curve
    remark: str = ""


@dataclass(frozen=True, slots=True)
class Panel:
    """Lines to be compared; `marks` are gaps worth a horizontal line, by name."""

    title: str
    lines: tuple[Line, ...]
    marks: tuple[tuple[str, float], ...] = ()


@dataclass(frozen=True, slots=True)
class GapAxis:
    """How gaps are shown.

    Parameters
    ----------
    ticks
        Gaps with a tick.
    text
        What stands at a gap: `99 %`, `+3 %`.
    floor
        Smaller gaps are drawn here, where the line of the bound is: on a logarithmic axis 0 has no place.
    bound_text
        What stands at that line.
    time_label
        What the other axis counts.
    """

    label: str
    ticks: tuple[float, ...]
    text: Callable[[float], str]
    floor: float
    bound_text: str
    time_label: str = "time since the start"


COVERAGE_AXIS = GapAxis(
    label="share of what can be covered at all",
    ticks=(1.0, 0.7, 0.5, 0.3, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001),
    text=lambda gap: f"{100.0 * (1.0 - gap):g} %",
    floor=5e-4,
    bound_text="100 %: bound, nothing more can be reached",
)

TOUR_AXIS = GapAxis(
    label="length above the proven lower bound",
    ticks=(2.0, 1.0, 0.5, 0.3, 0.2, 0.1, 0.05, 0.03, 0.02, 0.01, 0.005, 0.002),
    text=lambda gap: f"+{100.0 * gap:g} %",
    floor=1e-3,
    bound_text="lower bound: nothing is shorter",
)


def draw(title: str, panels: Sequence[Panel], axis: GapAxis, path: Path) -> None:
    """Draw panels side by side into a PNG file, on the same axes. The first line of a panel is the broadest."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    n_columns = min(MAX_COLUMNS, len(panels))
    n_rows = -(-len(panels) // n_columns)
    row_height_in = PANEL_HEIGHT_IN + LEGEND_LINE_IN * max(len(panel.lines) for panel in panels)
    title_height_in = 0.3 * (1 + title.count("\n"))
    size_in = (PANEL_WIDTH_IN * n_columns, row_height_in * n_rows + title_height_in)
    figure = Figure(figsize=size_in, layout="constrained")
    FigureCanvasAgg(figure)
    figure.suptitle(title, fontsize=12 if n_columns > 1 else 10, fontweight="bold")
    all_axes = figure.subplots(n_rows, n_columns, squeeze=False).ravel()
    scale = _Scale.of(panels, axis)
    for axes, panel in zip(all_axes, panels, strict=False):
        _draw_panel(axes, panel, axis, scale)
    for axes in all_axes[len(panels) :]:
        axes.set_visible(False)
    figure.savefig(path, dpi=DOTS_PER_INCH)


@dataclass(frozen=True, slots=True)
class _Scale:
    """Range of times, largest gap drawn, and the gap at which the bound stands."""

    first_s: float
    last_s: float
    worst: float
    floor: float

    @classmethod
    def of(cls, panels: Sequence[Panel], axis: GapAxis) -> _Scale:
        curves = [line.curve for panel in panels for line in panel.lines]
        starts_s = [curve.points[0].t_s for curve in curves if curve.points]
        gaps = [point.value for curve in curves for point in curve.points]
        smallest = min((gap for gap in gaps if gap > 0.0), default=axis.floor)
        floor = max(axis.floor, min(smallest / 3.0, axis.ticks[0]))
        return cls(
            first_s=max(min(starts_s, default=0.1), SHORTEST_S) / 1.3,
            last_s=max(*(curve.end_s for curve in curves), 2.0 * SHORTEST_S) * 1.3,
            worst=max(*gaps, 10.0 * floor),
            floor=floor,
        )

    def height(self, gap: float) -> float:
        """Place on the vertical axis: upwards is better."""
        return -math.log10(max(gap, self.floor))

    def ticks_s(self) -> list[float]:
        """Ticks of the time axis."""
        low, high = math.log10(self.first_s), math.log10(self.last_s)
        steps = DENSE_TICKS if high - low <= DENSE_DECADES else SPARSE_TICKS
        ticks = [step * 10.0**decade for decade in range(math.floor(low), math.ceil(high)) for step in steps]
        return [tick for tick in ticks if self.first_s <= tick <= self.last_s]


def _draw_panel(axes: Any, panel: Panel, axis: GapAxis, scale: _Scale) -> None:
    for number, line in enumerate(panel.lines):
        _draw_line(axes, line, number, scale)
    for name, gap in panel.marks:
        axes.axhline(scale.height(gap), color="#555555", linewidth=1.2, linestyle=(0, (6, 3)))
        axes.text(scale.first_s * 1.05, scale.height(gap), name, fontsize=8, color="#333333", va="bottom")
    top, bottom = scale.height(scale.floor), scale.height(scale.worst)
    axes.axhline(top, color="black", linewidth=1.5)
    axes.text(scale.last_s / 1.05, top, axis.bound_text, fontsize=8, va="bottom", ha="right")
    room = 0.06 * (top - bottom)
    heights = {scale.height(gap): axis.text(gap) for gap in axis.ticks if gap > 1.2 * scale.floor}
    axes.set_yticks(list(heights), list(heights.values()))
    axes.set_ylim(bottom - room, top + 1.2 * room)
    axes.set_xscale("log")
    axes.set_xlim(scale.first_s, scale.last_s)
    ticks_s = scale.ticks_s()
    axes.set_xticks(ticks_s, [f"{t_s:g} s" for t_s in ticks_s])
    axes.minorticks_off()
    axes.grid(color="#dddddd", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.set_xlabel(axis.time_label)
    axes.set_ylabel(axis.label)
    axes.set_title(panel.title, fontsize=10)
    axes.legend(fontsize=9, loc="upper center", bbox_to_anchor=(0.5, -0.13), frameon=False)


def _draw_line(axes: Any, line: Line, number: int, scale: _Scale) -> None:
    """Steps from point to point, and a dot where the run was over."""
    colour, style = COLOURS[number % len(COLOURS)], STYLES[number % len(STYLES)]
    name = f"{line.name}: {line.remark}" if line.remark else line.name
    points = line.curve.points
    times_s = [max(t_s, SHORTEST_S) for t_s in (*(point.t_s for point in points), line.curve.end_s)] if points else []
    heights = [scale.height(point.value) for point in (*points, *points[-1:])]
    width = 2.8 if number == 0 else 1.8
    axes.plot(times_s, heights, color=colour, linestyle=style, linewidth=width, drawstyle="steps-post", label=name)
    axes.plot(times_s[-1:], heights[-1:], "o", color=colour, markersize=5)


Found = TypeVar("Found")

Rows = Sequence[Mapping[str, Any]]


@dataclass(frozen=True, slots=True)
class Subject(Generic[Found]):
    """Something that can be compared.

    Parameters
    ----------
    name
        For the files: `plan` makes `tradeoff-plan.csv`, where no other `stem` is stated.
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
    stem: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class ComparisonFiles(Generic[Found]):
    """What was found, and the files written: the table, the picture, further tables."""

    found: Found
    csv_path: Path
    picture_path: Path
    more_paths: tuple[Path, ...] = ()

    @property
    def paths(self) -> tuple[Path, ...]:
        """All files."""
        return (self.csv_path, self.picture_path, *self.more_paths)


def compare(subject: Subject[Found], out: Path, run: Callable[[Path], Found]) -> ComparisonFiles[Found]:
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
    stem = subject.stem or f"tradeoff-{subject.name}"
    with output_folder(out) as folder:
        found = run(folder)
        write_rows(folder / f"{stem}.csv", subject.rows(found))
        draw(subject.title(found), subject.panels(found), subject.axis, folder / f"{stem}.png")
        more = subject.more(found)
        for name, rows in more.items():
            write_rows(folder / f"{stem}-{name}.csv", rows)
    return ComparisonFiles(
        found, out / f"{stem}.csv", out / f"{stem}.png", tuple(out / f"{stem}-{name}.csv" for name in more)
    )


class KnobResult(Protocol):
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


AnyKnobResult = TypeVar("AnyKnobResult", bound=KnobResult)


def knob_lines(
    results: Sequence[AnyKnobResult], nothing_turned: str, text: Callable[[AnyKnobResult], str]
) -> tuple[Line, ...]:
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
    new_folders = [folder for folder in (path, *path.parents) if not folder.exists()]
    try:
        path.mkdir(parents=True, exist_ok=True)
        with part_folder(path, "tradeoff") as temporary:
            yield temporary
            for file in sorted(temporary.iterdir()):
                file.replace(path / file.name)
            new_folders = []
    except OSError as error:
        raise InputError.say(
            "this folder cannot be made or written into ({}); name another", error.strerror or error, place=path
        ) from error
    finally:
        for folder in new_folders:
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

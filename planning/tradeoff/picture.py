"""Pictures of quality against time: one panel a question, a line a run, both axes logarithmic."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from planning.tradeoff.curves import Curve

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
    """

    label: str
    ticks: tuple[float, ...]
    text: Callable[[float], str]
    floor: float
    bound_text: str


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
    axes.set_xlabel("time since the start")
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

"""What the current plan paints in the 3-D view: coverage or pixel sizes on panels, clearance on routes."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QCoreApplication

from groundstation.gui.plan.paint_bar import PanelPaint, RoutePaint
from groundstation.gui.view3d.hemispheres import OPEN, UNDECIDED, UNREACHABLE
from groundstation.gui.view3d.paint import ColourScale, ValueKind
from groundstation.gui.view3d.scene_view import SceneView
from groundstation.services.plan_bench import PlanInHand
from groundstation.services.units import UnitSystem, length_unit, sampling_unit
from planning.insight.sections import PlanInsight, SectionState

WIDE_CLEARANCE = 3.0
"""Routes this many safety distances away from everything all look alike: far enough."""


def paint_plan(
    scene: SceneView, in_hand: PlanInHand | None, panels: PanelPaint, routes: RoutePaint, units: UnitSystem
) -> None:
    """Paint a plan on a 3-D view, as chosen; without a plan in hand everything is plain."""
    if in_hand is None or panels is not PanelPaint.HEMISPHERES:
        scene.paint_hemispheres(None)
    if in_hand is None or panels not in (PanelPaint.SHARE, PanelPaint.GSD):
        scene.set_panel_values(None)
    if in_hand is None:
        scene.set_route_values(None)
        return
    insight = in_hand.insight
    match panels:
        case PanelPaint.SHARE:
            title = QCoreApplication.translate("PlanPictures", "Covered of what is possible")
            scene.set_panel_values(ColourScale(title, "%", 0.0, 100.0), 100.0 * insight.share_per_panel)
        case PanelPaint.GSD:
            scale, values = _sampling(insight, units)
            scene.set_panel_values(scale, values)
        case PanelPaint.HEMISPHERES:
            scene.paint_hemispheres(insight.grid, painted_states(insight))
        case PanelPaint.FACADE:
            pass
    if routes is RoutePaint.SORTIE:
        scene.set_route_values(None)
    else:
        scene.set_route_values(*_clearance(in_hand, units))


def _sampling(insight: PlanInsight, units: UnitSystem) -> tuple[ColourScale | None, NDArray[np.float64]]:
    unit = sampling_unit(units)
    values = insight.sampling.best_m * unit.factor
    known = values[np.isfinite(values)]
    if len(known) == 0:
        return None, values
    low, high = float(known.min()), float(known.max())
    # A plan whose panels are all alike still has a scale.
    title = QCoreApplication.translate("PlanPictures", "Finest pixel")
    return ColourScale(title, unit.symbol, low, max(high, 1.01 * low + 1e-9), ValueKind.LOW_IS_GOOD), values


def _clearance(in_hand: PlanInHand, units: UnitSystem) -> tuple[ColourScale, list[NDArray[np.float64]]]:
    unit = length_unit(units)
    least_m = in_hand.plan.constraints.min_distance_m
    far_m = max(WIDE_CLEARANCE * least_m, least_m + 5.0)
    title = QCoreApplication.translate("PlanPictures", "Clearance")
    scale = ColourScale(title, unit.symbol, unit.shown(least_m), unit.shown(far_m))
    legs = (in_hand.revision.leg_clearances_m(sortie) for sortie in in_hand.plan.sorties)
    return scale, [unit.factor * vertex_clearances_m(clearances_m) for clearances_m in legs]


def painted_states(insight: PlanInsight) -> NDArray[np.int64]:
    """Number of views of each section, or why there is none, as the 3-D view takes it; shape (m, n_sections)."""
    states = insight.counts.astype(np.int64)
    states[insight.states == SectionState.MISSED] = OPEN
    states[insight.states == SectionState.UNREACHABLE] = UNREACHABLE
    states[insight.states == SectionState.UNDECIDED] = UNDECIDED
    return states


def vertex_clearances_m(legs_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """The lesser clearance of the legs at each vertex, shape (k,) from (k - 1,): none looks safer than its legs."""
    padded = [float("inf"), *legs_m.tolist(), float("inf")]
    return np.array([min(pair) for pair in itertools.pairwise(padded)])

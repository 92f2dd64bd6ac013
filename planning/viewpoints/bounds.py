"""Upper bounds on what N of the candidates can cover, and the exact optimum on small scenes.

Three, from cheap to exact: greedy's own (f(S) + the N largest marginal gains, any S), the Lagrangian dual of the
integer programme, and the integer programme itself (HiGHS). All hold for the given candidates; refined poses are not
candidates and may cover more, up to the number of reachable sections.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planning.base.jit import kernel
from planning.base.progress import Stop, never
from planning.coverage.model import Elements

Array = NDArray[np.float64]

DUAL_STEPS = 150


@kernel
def _scores(starts: NDArray[np.int64], items: NDArray[np.int32], prices: Array, scores: Array) -> None:
    """Sum of the prices of each candidate's elements."""
    for c in range(len(scores)):
        total = 0.0
        for i in range(starts[c], starts[c + 1]):
            total += prices[items[i]]
        scores[c] = total


@kernel
def _cover_counts(
    starts: NDArray[np.int64], items: NDArray[np.int32], chosen: NDArray[np.int64], counts: Array
) -> None:
    counts[:] = 0.0
    for c in chosen:
        for i in range(starts[c], starts[c + 1]):
            counts[items[i]] += 1.0


def dual_bound(
    elements: Elements, weights: Array, n_views: int, known: float, n_steps: int = DUAL_STEPS, stop: Stop = never
) -> float:
    """Lagrangian bound on the weight that `n_views` candidates can cover.

    With prices 0 <= p_e <= w_e for the constraint "an element counts only when a chosen view covers it", every p gives
    the bound sum (w_e - p_e) + the sum of the N largest candidate scores sum p_e. Subgradient steps (Polyak's length,
    towards `known`, the value of a solution at hand) lower it; the best one is returned.
    """
    coverable = np.bincount(elements.items, minlength=len(weights)) > 0
    best = float(weights[coverable].sum())
    n_candidates = len(elements.starts) - 1
    n_views = min(n_views, n_candidates)
    prices = np.where(coverable, 0.5 * weights, 0.0)
    scores, counts = np.empty(n_candidates), np.empty(len(weights))
    length, since_better = 1.0, 0
    for _ in range(n_steps):
        if stop():
            break
        _scores(elements.starts, elements.items, prices, scores)
        chosen = np.argpartition(-scores, n_views - 1)[:n_views] if n_views < n_candidates else np.arange(n_candidates)
        bound = float((weights - prices)[coverable].sum() + scores[chosen].sum())
        since_better = since_better + 1 if bound >= best - 1e-9 else 0
        best = min(best, bound)
        if since_better >= 8:
            length, since_better = 0.5 * length, 0
        _cover_counts(elements.starts, elements.items, chosen, counts)
        slope = np.where(coverable, counts - 1.0, 0.0)
        # Steps that only push prices against their limits say nothing.
        slope[(prices <= 0.0) & (slope > 0.0)] = 0.0
        slope[(prices >= weights) & (slope < 0.0)] = 0.0
        square = float(slope @ slope)
        if square <= 0.0 or bound <= known:
            break
        prices = np.clip(prices - length * (bound - known) / square * slope, 0.0, weights)
    return best


def exact_optimum(
    elements: Elements, weights: Array, n_views: int, time_limit_s: float = 60.0
) -> tuple[float, NDArray[np.int64], float]:
    """Best coverage by `n_views` candidates as an integer programme: value, chosen candidates, proven upper bound.

    Where HiGHS runs out of time, the value is the best it found and the bound lies above it.
    """
    from scipy.optimize import Bounds, LinearConstraint, milp
    from scipy.sparse import coo_array, csr_array, hstack, identity

    n_candidates, n_elements = len(elements.starts) - 1, len(weights)
    candidate = np.repeat(np.arange(n_candidates), np.diff(elements.starts))
    covers = csr_array(
        coo_array((np.ones(len(candidate)), (elements.items, candidate)), shape=(n_elements, n_candidates))
    )
    # Variables: candidate chosen (integer), element covered (continuous). covered_e <= sum of chosen views that see e.
    only_if_seen = LinearConstraint(hstack([-covers, identity(n_elements, format="csr")], format="csr"), ub=0.0)
    count = csr_array(np.concatenate([np.ones(n_candidates), np.zeros(n_elements)])[None])
    solved = milp(
        np.concatenate([np.zeros(n_candidates), -weights]),
        integrality=np.concatenate([np.ones(n_candidates), np.zeros(n_elements)]),
        bounds=Bounds(0.0, 1.0),
        constraints=[only_if_seen, LinearConstraint(count, ub=float(n_views))],
        options={"time_limit": time_limit_s},
    )
    if solved.x is None:
        return 0.0, np.zeros(0, np.int64), float(weights.sum())
    chosen = np.flatnonzero(solved.x[:n_candidates] > 0.5)
    return -float(solved.fun), chosen, -float(solved.mip_dual_bound)

"""The exact optimum of small choices of views, by integer programming."""

import numpy as np
from numpy.typing import NDArray

from planning.coverage.model import Elements
from planning.viewpoints.greedy import Array


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

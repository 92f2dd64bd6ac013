"""A fixed sparse matrix as a step of a model: compiled for float32 in main memory, plain torch elsewhere."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
import torch
from numpy.typing import NDArray
from scipy import sparse
from torch import Tensor
from torch.autograd.function import once_differentiable

from planning.base.jit import chunks, kernel, run_chunks

Floats = NDArray[np.float32]
Indices = NDArray[np.int32]

ENTRIES_AT_ONCE = 262_144
"""Weights of one call of the kernel: about a millisecond."""


class LinearMap:
    """A matrix that is multiplied with columns of numbers, and its gradient; the matrix itself has none.

    The same bits for any number of threads: each row is added up in its order.

    Parameters
    ----------
    matrix
        Shape (m, n).
    """

    def __init__(self, matrix: sparse.csr_array) -> None:
        self._matrix = matrix
        self.there, self.back = _Rows(matrix), _Rows(sparse.csr_array(matrix.T))
        self._placed: dict[tuple[torch.device, torch.dtype], tuple[Tensor, Tensor, Tensor]] = {}

    @property
    def shape(self) -> tuple[int, int]:
        """Rows m and columns n."""
        return self._matrix.shape

    @property
    def n_weights(self) -> int:
        """Entries that are not 0."""
        return int(self._matrix.nnz)

    def __call__(self, values: Tensor) -> Tensor:
        """Shape (m, c) of values of shape (n, c)."""
        if values.device.type == "cpu" and values.dtype == torch.float32:
            return cast(Tensor, _Multiplied.apply(values, self))  # type: ignore[no-untyped-call]
        rows, columns, weights = self._entries_like(values)
        out = torch.zeros((self.shape[0], values.shape[1]), dtype=values.dtype, device=values.device)
        return out.index_add(0, rows, weights[:, None] * values[columns])

    def _entries_like(self, values: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Rows, columns and weights, each shape (k,), on the device of the values and in their precision."""
        key = (values.device, values.dtype)
        if key not in self._placed:
            entries = self._matrix.tocoo()
            rows, columns = (torch.from_numpy(np.asarray(each, np.int64)).to(values.device) for each in entries.coords)
            weights = torch.from_numpy(np.asarray(entries.data, np.float64)).to(values.device, values.dtype)
            self._placed[key] = (rows, columns, weights)
        return self._placed[key]


class _Rows:
    """Compressed rows in the types that the kernel takes."""

    def __init__(self, matrix: sparse.csr_array) -> None:
        self.starts = np.asarray(matrix.indptr, np.int64)
        self.columns = np.asarray(matrix.indices, np.int32)
        self.weights = np.asarray(matrix.data, np.float32)
        n_rows = len(self.starts) - 1
        per_row = max(1, len(self.columns) // max(1, n_rows))
        self._ranges = chunks(n_rows, max(1, ENTRIES_AT_ONCE // per_row))

    def times(self, values: Floats) -> Floats:
        out = np.empty((len(self.starts) - 1, values.shape[1]), np.float32)
        work = _times_three if values.shape[1] == 3 else _times
        run_chunks(lambda a, b: work(self.starts, self.columns, self.weights, values, a, b, out), self._ranges)
        return out


@kernel
def _times_three(
    starts: Any, columns: Indices, weights: Floats, values: Floats, first: int, last: int, out: Floats
) -> None:
    for i in range(first, last):
        red = green = blue = np.float32(0.0)
        for k in range(starts[i], starts[i + 1]):
            weight, j = weights[k], columns[k]
            red += weight * values[j, 0]
            green += weight * values[j, 1]
            blue += weight * values[j, 2]
        out[i, 0], out[i, 1], out[i, 2] = red, green, blue


@kernel
def _times(starts: Any, columns: Indices, weights: Floats, values: Floats, first: int, last: int, out: Floats) -> None:
    n_channels = values.shape[1]
    for i in range(first, last):
        out[i] = np.float32(0.0)
        for k in range(starts[i], starts[i + 1]):
            weight, j = weights[k], columns[k]
            for c in range(n_channels):
                out[i, c] += weight * values[j, c]


class _Multiplied(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, values: Tensor, linear: LinearMap) -> Tensor:
        ctx.linear = linear
        return torch.from_numpy(linear.there.times(np.asarray(values.detach().contiguous().numpy())))

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, *gradients: Any) -> tuple[Tensor, None]:
        given = np.asarray(gradients[0].detach().contiguous().numpy())
        return torch.from_numpy(ctx.linear.back.times(given)), None

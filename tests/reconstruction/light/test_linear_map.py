"""Fixed matrices: right values and gradients, the same bits always."""

import numpy as np
import pytest
import torch
from scipy import sparse

from reconstruction.light.cube_lookup import LinearMap


def made(rows=40, columns=30, share=0.2, seed=0):
    return sparse.csr_array(sparse.random_array((rows, columns), density=share, rng=np.random.default_rng(seed)))


@pytest.mark.parametrize("channels", [1, 3, 16])
@pytest.mark.parametrize("dtype", [torch.float32, torch.float64])
def test_products_and_gradients_are_those_of_the_full_matrix(channels, dtype):
    matrix = made()
    generator = torch.Generator().manual_seed(1)
    values = torch.randn(30, channels, generator=generator, dtype=dtype).requires_grad_()
    given = torch.randn(40, channels, generator=generator, dtype=dtype)
    full = torch.from_numpy(matrix.toarray()).to(dtype)
    found = LinearMap(matrix)(values)
    (of_values,) = torch.autograd.grad(found, values, given)
    tolerance = 1e-6 if dtype == torch.float32 else 1e-13
    assert torch.allclose(found, full @ values, atol=10 * tolerance)
    assert torch.allclose(of_values, full.T @ given, atol=10 * tolerance)


def test_any_number_of_threads_gives_the_same_bits(monkeypatch):
    monkeypatch.setattr("reconstruction.light.cube_lookup.ENTRIES_AT_ONCE", 64)
    linear, found = LinearMap(made(400, 300)), []
    values = torch.randn(300, 3, generator=torch.Generator().manual_seed(2))
    for threads in (1, 3):
        monkeypatch.setattr("planning.base.jit.n_threads", lambda threads=threads: threads)
        moved = values.clone().requires_grad_()
        seen = linear(moved)
        found.append([seen, *torch.autograd.grad(seen.square().sum(), [moved])])
    assert all(torch.equal(one, many) for one, many in zip(*found, strict=True))


def test_rows_and_columns_without_weights_are_0():
    matrix = sparse.csr_array((np.array([2.0]), (np.array([1]), np.array([2]))), (3, 4))
    values = torch.ones(4, 3, requires_grad=True)
    found = LinearMap(matrix)(values)
    found.sum().backward()
    assert found[:, 0].tolist() == [0.0, 2.0, 0.0]
    assert values.grad[:, 0].tolist() == [0.0, 0.0, 2.0, 0.0]

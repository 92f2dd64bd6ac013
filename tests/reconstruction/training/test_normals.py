"""Smooth normals: flat ones cost nothing, and the photo's edges are free."""

import math

import torch

from reconstruction.training.losses import normal_smoothness


def step(size, column, height):
    picture = torch.zeros(size, size, 3)
    picture[:, column:, 0] = height
    return picture


def test_flat_normals_cost_nothing_and_have_no_gradient():
    normals = torch.ones(6, 6, 3, requires_grad=True)
    loss = normal_smoothness(normals, torch.rand(6, 6, 3, generator=torch.Generator().manual_seed(0)))
    loss.backward()
    assert float(loss.detach()) == 0.0
    assert torch.equal(normals.grad, torch.zeros(6, 6, 3))


def test_an_edge_costs_its_height_and_less_where_the_photo_has_one():
    normals = step(5, 2, 0.5)
    expected = 0.5 * 4 / 16
    assert abs(float(normal_smoothness(normals, torch.zeros(5, 5, 3))) - expected) < 1e-5
    assert abs(float(normal_smoothness(normals, step(5, 2, 2.0))) - expected * math.exp(-2.0)) < 1e-5
    assert abs(float(normal_smoothness(normals, step(5, 3, 2.0))) - expected) < 1e-5


def test_gradients_are_those_of_finite_differences():
    generator = torch.Generator().manual_seed(0)
    normals, photo = (torch.rand(4, 3, 3, generator=generator, dtype=torch.float64) for _ in range(2))
    assert torch.autograd.gradcheck(lambda each: normal_smoothness(each, photo), normals.requires_grad_())


def test_pictures_of_one_row_cost_nothing():
    assert float(normal_smoothness(torch.rand(1, 5, 3), torch.rand(1, 5, 3))) == 0.0

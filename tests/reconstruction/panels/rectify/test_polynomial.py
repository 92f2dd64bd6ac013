"""Eq. 2: normalised against raw pixels, at full size, against the exact maps, and where it must be refused."""

from __future__ import annotations

import numpy as np
import pytest

from planning.base.errors import InfeasibleError
from reconstruction.base.cameras import Intrinsics
from reconstruction.panels.rectify.surface import exponents, fit_polynomial, polynomial_view
from reconstruction.panels.rectify.view import TangentView, surface_view
from tests.reconstruction.panels.rectify.scenes import looking_at
from tests.reconstruction.panels.rectify.test_surface import surface

LOW, HIGH = np.array([-9.0, -7.0]), np.array([9.0, 7.0])
"""A third of a round of the strongest curvature used here."""

FULL = Intrinsics(5280, 3956, 3751.0, 3740.0, 2640.0, 1978.0)


def test_eq_2_has_36_coefficients_for_each_coordinate() -> None:
    assert len(exponents(7)) == 36


def test_any_polynomial_of_its_degree_is_found_exactly_at_full_size() -> None:
    rng = np.random.default_rng(0)
    points = rng.uniform((0.0, 0.0), (5280.0, 3956.0), (1600, 2))
    u = points / (2640.0, 1978.0) - 1.0
    terms = np.stack([u[:, 0] ** k * u[:, 1] ** el for k, el in exponents(7)], axis=1)
    target = terms @ rng.normal(size=(36, 2)) * 500.0
    assert fit_polynomial(points, target).residual_px < 1e-8


def test_raw_pixels_to_the_seventh_power_would_have_lost_pixels_that_normalised_ones_keep() -> None:
    face = surface(0.03)
    view = TangentView(surface_view(looking_at(face, intrinsics=FULL), face, LOW, HIGH))
    x, y = np.meshgrid(np.linspace(0.0, view.width_px, 40), np.linspace(0.0, view.height_px, 40))
    rectified = np.column_stack([x.ravel(), y.ravel()])
    photo = view.to_photo(rectified)
    seen = np.isfinite(photo).all(axis=1)
    raw = np.stack([photo[seen, 0] ** k * photo[seen, 1] ** el for k, el in exponents(7)], axis=1)
    coefficients = np.linalg.lstsq(raw, rectified[seen], rcond=None)[0]
    raw_off = np.abs(raw @ coefficients - rectified[seen]).max()
    ours = fit_polynomial(photo[seen], rectified[seen])
    assert np.linalg.cond(raw) > 1e20
    assert ours.residual_px < 0.5
    assert raw_off > 5.0 * ours.residual_px


@pytest.mark.parametrize("curvature", [0.0, 0.01, 0.03, -0.02])
def test_polynomials_there_and_back_agree_with_the_exact_maps(curvature: float) -> None:
    face = surface(curvature)
    exact = TangentView(surface_view(looking_at(face, aside_m=4.0), face, LOW, HIGH))
    view = polynomial_view(exact)
    x, y = np.meshgrid(np.linspace(0.0, view.width_px, 31), np.linspace(0.0, view.height_px, 23))
    points = np.column_stack([x.ravel(), y.ravel()])
    photo = exact.to_photo(points)
    seen = np.isfinite(photo).all(axis=1)
    assert np.abs(view.to_photo(points[seen]) - photo[seen]).max() < 1.5 * view.photo_from_rectified.residual_px + 1e-6
    assert view.photo_from_rectified.residual_px < 0.5
    assert np.abs(view.to_rectified(photo[seen]) - points[seen]).max() < 1.0


def test_seven_orders_do_not_follow_a_strongly_curved_facade_to_its_rim() -> None:
    face = surface(0.03)
    rim = TangentView(surface_view(looking_at(face), face))
    middle = TangentView(surface_view(looking_at(face), face, LOW, HIGH))
    assert polynomial_view(rim).rectified_from_photo.residual_px > 0.5
    assert polynomial_view(middle).rectified_from_photo.residual_px < 0.1


def test_a_polynomial_says_nothing_far_outside() -> None:
    points = np.random.default_rng(1).uniform(0.0, 100.0, (200, 2))
    found = fit_polynomial(points, 2.0 * points)
    assert np.isnan(found(np.array([[300.0, 50.0]]))).all()
    assert np.allclose(found(np.array([[105.0, 50.0]])), (210.0, 100.0))
    assert np.isnan(found(np.array([[np.nan, 50.0]]))).all()


def test_too_few_points_and_points_in_line_are_refused() -> None:
    with pytest.raises(InfeasibleError, match="at least 36"):
        fit_polynomial(np.zeros((35, 2)), np.zeros((35, 2)))
    line = np.linspace(0.0, 1.0, 100)[:, None] * np.array([3.0, 1.0])
    with pytest.raises(InfeasibleError, match="in line"):
        fit_polynomial(line, line)
    with pytest.raises(ValueError, match="shape"):
        fit_polynomial(np.zeros((50, 2)), np.zeros((49, 2)))

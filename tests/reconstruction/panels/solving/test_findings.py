"""What is said of solved facades."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from planning.base.findings import Severity
from reconstruction.base.cameras import PosedPhoto
from reconstruction.panels.solving.find import FoundPanels, find_panels, photos_a_panel_apart, repeated_step_m
from reconstruction.panels.solving.record import SurfaceLine
from reconstruction.scenes.facades.record import SyntheticFacade
from tests.reconstruction.panels.solving.test_find import load_from, posed
from tests.reconstruction.synthetic_photos import coarse_model, made_photos


@cache
def found() -> tuple[list[PosedPhoto], FoundPanels]:
    photos: list[SyntheticFacade] = made_photos()
    return posed(photos), find_panels(posed(photos), coarse_model(photos[0].case.wall), load_from(photos))


def with_heading_sigma(photos: Sequence[PosedPhoto], degrees: float) -> list[PosedPhoto]:
    covariance = np.diag([1e-4] * 3 + [np.radians(degrees) ** 2] * 3)
    return [replace(photo, pose=replace(photo.pose, covariance=covariance)) for photo in photos]


@pytest.mark.slow
def test_poses_that_cannot_tell_panels_apart_are_warned_of() -> None:
    photos, panels = found()
    (facade,) = panels.facades
    step = repeated_step_m(facade.columns)
    assert step is not None
    away_m = abs(float(facade.surface.height_m(photos[0].pose.position_enu_m[None])[0]))
    enough, too_little = (np.degrees(share * step / away_m) for share in (0.3, 0.8))
    assert photos_a_panel_apart(facade, with_heading_sigma(photos, float(enough))) == []
    (finding,) = photos_a_panel_apart(facade, with_heading_sigma(photos, float(too_little)))
    assert finding.severity is Severity.WARNING
    assert finding.message.startswith(f"panels repeat every {step:.2f} m")
    assert "refine the poses" in finding.message


@pytest.mark.parametrize(
    ("gaps", "step"),
    [
        ([1.5] * 8, 1.5),
        ([1.5] * 4 + [3.0] + [1.5] * 5, 1.5),
        ([1.5, 0.9] * 4, 2.4),
        ([1.1, 1.7, 1.3, 2.4, 0.9, 1.5], None),
        ([2.0], None),
    ],
    ids=["regular", "one wide panel", "alternating", "random", "one panel"],
)
def test_only_regular_grids_repeat(gaps: list[float], step: float | None) -> None:
    lines = [SurfaceLine(float(x), 0.06, 0.01, 0.9, 2) for x in np.concatenate([[0.0], np.cumsum(gaps)])]
    assert repeated_step_m(lines) == (None if step is None else pytest.approx(step))

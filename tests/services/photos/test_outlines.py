"""Known panels drawn into photos: where their corners are, bent as the lens bends them, without those not seen."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.services.photos import grid_edits as photo_outlines
from groundstation.services.photos.grid_edits import known_panels, panel_outlines
from reconstruction.base.cameras import Intrinsics, Pose, PosedPhoto
from tests.reconstruction.panels.rectify.scenes import BENT, SMALL
from tests.services.photo_cases import draft_of, site_model, with_paths


def panel(x=0.0, z=10.0, width=4.0, height=3.0, y=0.0):
    """Faces south, where the camera is."""
    return np.array([[x, y, z], [x + width, y, z], [x + width, y, z + height], [x, y, z + height]])


def camera(x=1.0, y=-20.0, z=11.0, heading=0.0, lens=SMALL):
    return PosedPhoto("p.jpg", Path("p.jpg"), lens, Pose.looking(np.array([x, y, z]), heading, 0.0))


@given(x=st.floats(-5.0, 5.0), z=st.floats(6.0, 14.0), heading=st.floats(-8.0, 8.0))
def test_an_outline_of_a_straight_camera_is_the_projected_panel(x, z, heading):
    photo, corners = camera(heading=heading), panel(x, z)
    found = panel_outlines(photo, [corners])
    assert len(found) == 1
    assert found[0] == pytest.approx(photo.pixels(corners))


def test_edges_are_bent_as_the_lens_bends_them(monkeypatch):
    photo, wide = camera(lens=BENT), panel(-6.0, 7.0, 13.0, 8.0)
    edges = zip(wide, np.roll(wide, -1, axis=0), strict=True)
    dense = photo.pixels(np.concatenate([np.linspace(start, end, 400) for start, end in edges]))

    def worst():
        outline = panel_outlines(photo, [wide])[0]
        ends = np.roll(outline, -1, axis=0)
        apart = []
        for point in dense:
            along = np.clip(((point - outline) * (ends - outline)).sum(1) / ((ends - outline) ** 2).sum(1), 0.0, 1.0)
            apart.append(np.linalg.norm(point - outline - along[:, None] * (ends - outline), axis=1).min())
        return max(apart)

    assert worst() < 0.5
    monkeypatch.setattr(photo_outlines, "BENT_PIECES", 1)
    assert worst() > 1.0


def test_panels_that_the_photo_does_not_show_are_left_out():
    photo = camera()
    back = panel()[[1, 0, 3, 2]]
    behind_camera, outside = panel(y=-40.0), panel(x=60.0)
    reaching_behind = np.array([[0.0, 0.0, 10.0], [0.0, -30.0, 10.0], [0.0, -30.0, 13.0], [0.0, 0.0, 13.0]])
    for unseen in (back, behind_camera, outside, reaching_behind):
        assert panel_outlines(photo, [unseen]) == ()
    assert panel_outlines(photo, []) == ()
    assert len(panel_outlines(photo, [back, panel(), outside])) == 1


def test_what_something_hides_is_left_out_and_asked_in_front_of_the_middle():
    asked = []

    def sight(places, targets):
        asked.append((places, targets))
        return targets[:, 0] > 1.0

    found = panel_outlines(camera(), [panel(-4.0), panel(1.0)], sight)
    assert len(found) == 1
    assert found[0] == pytest.approx(camera().pixels(panel(1.0)))
    places, targets = asked[0]
    assert places.shape == (2, 3)
    assert targets[0] == pytest.approx([-2.0, -0.15, 11.5])


def test_panels_of_any_number_of_corners_are_drawn():
    triangle, five = panel()[:3], np.insert(panel(4.0), 3, [6.0, 0.0, 14.0], axis=0)
    assert sorted(len(outline) for outline in panel_outlines(camera(), [five, triangle, panel(-4.0)])) == [3, 4, 5]


def test_facades_with_a_grid_in_the_photo_are_not_drawn_a_second_time():
    draft = with_paths(draft_of(), [Path(name) for name in ("a.jpg", "b.jpg", "c.jpg")])
    site = site_model().site
    assert len(known_panels(None, site, draft.photos[0])) == 1
    assert known_panels(draft, site, draft.photos[0]) == ()
    elsewhere = replace(draft.photos[0], path=Path("d.jpg"))
    known = known_panels(draft, site, elsewhere)
    assert len(known) == 30
    outlines = panel_outlines(elsewhere, known)
    grid = draft.found.grids["A", 0]
    middles = np.array([one.corners_px.mean(axis=0) for one in grid.panels])
    apart = [np.linalg.norm(middles - outline.mean(axis=0), axis=1).min() for outline in outlines]
    # As the photo's own pose has them: RTK is good for a few centimetres here, some pixels.
    assert max(apart) < 15.0
    assert isinstance(elsewhere.intrinsics, Intrinsics)

"""What a virtual scene shows of a site from outside: which surfaces, how they are cut, and where their pictures lie."""

import numpy as np
import pytest

from groundstation.services.scenes.surfaces import GROUND_BESIDE_M, Part, Surface, on_screen, site_surfaces
from planning.site.bundled import office


@pytest.fixture(scope="module")
def surfaces():
    return site_surfaces(office())


def test_there_are_walls_and_neighbours_with_windows_and_none_of_them_is_far(surfaces):
    assert {surface.part for surface in surfaces} == {Part.WALLS, Part.SURROUNDINGS}
    near = [surface for surface in surfaces if surface.part is Part.SURROUNDINGS]
    assert sum(surface.picture is not None for surface in near) >= 3
    reach_m = max(np.abs(surface.corners_enu_m[..., :2]).max() for surface in surfaces)
    assert GROUND_BESIDE_M < reach_m < 150.0, "the ground that photos see goes on for 1.5 km"


def test_pictures_are_drawn_in_their_scale_upright_and_float32_holds_their_places(surfaces):
    for surface in surfaces:
        if surface.uv is None:
            continue
        corners, uv = surface.corners_enu_m, surface.uv.astype(float)
        assert np.abs(uv).max() < 64.0, "a float32 tells a hundredth of a pixel apart there"
        size = np.array(surface.picture.shape[1::-1])
        for i, j in ((0, 1), (1, 2), (2, 0)):
            in_m = np.linalg.norm(corners[:, i] - corners[:, j], axis=1)
            in_px = np.linalg.norm((uv[:, i] - uv[:, j]) * size, axis=1)
            np.testing.assert_allclose(in_px / in_m, 20.0, rtol=1e-4)
            # What is higher in the world is higher in the picture.
            rises = corners[:, j, 2] - corners[:, i, 2]
            steep = np.abs(rises) > 0.5
            assert (np.sign((uv[:, j] - uv[:, i])[steep, 1]) == np.sign(rises[steep])).all()


def test_a_surface_without_a_picture_has_colours_that_differ(surfaces):
    plain = next(s for s in surfaces if s.picture is None and s.part is Part.SURROUNDINGS)
    assert isinstance(plain, Surface)
    assert len(np.unique(plain.colours, axis=0)) > 5
    assert plain.colours.shape == (len(plain.corners_enu_m), 3)


def test_bytes_of_screens():
    np.testing.assert_array_equal(on_screen(np.array([0.0, 0.5**2.2, 1.0, 1.7])), [0, 128, 255, 255])

"""Rendered previews of planned photos: as `scene render` would take them, quickly, and one scene at a time."""

from dataclasses import replace

import numpy as np
import pytest

from groundstation.services.scenes import preview as photo_preview
from groundstation.services.scenes.preview import (
    LEFT_OUT,
    MAX_WIDTH_PX,
    OF_FILES,
    QUICK_S,
    PhotoRequest,
    cached_photo,
    quick_width_px,
    site_key,
    site_photo,
)
from planning.aircraft.catalogue import profile
from planning.base.errors import InputError, OperationCancelled
from planning.geo.mesh import TriangleMesh
from planning.plan import Viewpoint
from planning.site.bundled import office, single_panel, tower
from planning.site.records import SiteModel
from reconstruction.base.cameras import Pose, PosedPhoto
from reconstruction.scenes.effects.registry import EFFECTS
from reconstruction.scenes.parameters import RenderSettings
from reconstruction.scenes.photos.flight_views import lens_of
from reconstruction.scenes.photos.lens_effects import developed
from reconstruction.scenes.photos.renderer import Renderer
from reconstruction.scenes.world.build import build_scene
from reconstruction.scenes.world.look import Look

CAMERA = profile("m3e").camera
ALONE = Look(near=False)
VIEW = Viewpoint("photo", (0.0, -20.0, 20.0), 0.0, 0.0)


def request_for(model, **changes):
    return replace(PhotoRequest(site_key(model), ALONE, 0, VIEW, CAMERA, 96), **changes)


class _Cancelling:
    """Cancels at the n-th report."""

    def __init__(self, n):
        self.left, self.stages = n, []

    def report(self, stage, done, total):
        self.stages.append(stage)
        self.left -= 1
        if self.left == 0:
            raise OperationCancelled(stage)


@pytest.fixture(autouse=True)
def _nothing_kept():
    photo_preview._LAST.clear()
    yield
    photo_preview._LAST.clear()


@pytest.mark.slow
def test_the_fine_picture_is_the_photo_that_would_be_rendered_whole(monkeypatch, tmp_path):
    model = office()
    monkeypatch.setattr(photo_preview, "STRIP_PX", 96 * 20)
    seen = site_photo(model, request_for(model))
    scene = build_scene(model, ALONE)
    photo = PosedPhoto("a", tmp_path / "a", lens_of(CAMERA, 96), Pose.of(VIEW))
    settings = RenderSettings(effects=LEFT_OUT)
    whole = Renderer(scene, settings.decided(seen.decisions)).render(photo)
    assert (seen.picture == developed(whole)).all()
    assert {found.effect for found in seen.decisions} | OF_FILES | set(LEFT_OUT) == {effect.name for effect in EFFECTS}
    assert seen.panels.tolist() == sorted({int(panel) - 1 for panel in np.unique(whole.panel)} - {-1})
    assert len(seen.panels) > 20


@pytest.mark.slow
def test_a_scene_is_built_once_and_only_the_last_one_is_kept(monkeypatch):
    built = []
    from reconstruction.scenes.world import build

    monkeypatch.setattr(build, "build_scene", lambda *given: built.append(given[1:]) or build_scene(*given))
    model = office()
    request = request_for(model, is_quick=True, width_px=32)
    assert cached_photo(request) is None
    first = site_photo(model, request)
    again = cached_photo(replace(request, view=replace(VIEW, heading_deg=5.0)))
    assert len(built) == 1
    assert (first.picture != again.picture).any()
    for other in (replace(request, look=replace(ALONE, sun_heading_deg=90.0)), replace(request, seed=1)):
        assert cached_photo(other) is None
    site_photo(model, replace(request, seed=1))
    assert built == [(ALONE, 0), (ALONE, 1)]
    assert cached_photo(request) is None


@pytest.mark.slow
def test_a_quick_picture_has_all_effects_and_decides_nothing():
    model = office()
    seen = site_photo(model, request_for(model, is_quick=True, width_px=32))
    assert seen.decisions == ()
    assert seen.picture.shape == (24, 32, 3)
    assert seen.picture.std() > 10.0


@pytest.mark.slow
def test_rendering_ends_soon_after_a_cancel_and_keeps_the_scene(monkeypatch):
    monkeypatch.setattr(photo_preview, "STRIP_PX", 96 * 10)
    model = office()
    with pytest.raises(OperationCancelled, match="choosing what to simulate"):
        site_photo(model, request_for(model), monitor=_Cancelling(4))
    quick = request_for(model, is_quick=True)
    for n in (1, 2, 5):
        cancelling = _Cancelling(n)
        with pytest.raises(OperationCancelled):
            cached_photo(quick, monitor=cancelling)
        assert cancelling.stages == ["rendering the photo"] * n
    assert cached_photo(quick) is not None


@pytest.mark.slow
def test_a_camera_inside_a_building_opposite_is_told():
    model = office()
    opposite = next(o for o in build_scene(model, Look()).site.site.obstacles if o.id.startswith("scene-opposite"))
    middle = tuple(map(float, np.mean(opposite.box_enu_m, axis=0)))
    request = request_for(model, look=Look(), view=replace(VIEW, position_enu_m=middle), is_quick=True, width_px=32)
    assert site_photo(model, request).is_walled_in
    assert not cached_photo(replace(request, view=VIEW)).is_walled_in


@pytest.mark.slow
def test_a_site_without_a_mesh_and_one_of_a_single_panel_are_photographed():
    model = single_panel()
    alone = SiteModel(replace(model.site, building_mesh=None), TriangleMesh(np.zeros((0, 3)), np.zeros((0, 3), int)))
    corners = np.array(model.site.panels[0].corners_enu_m)
    normal = np.cross(corners[2] - corners[0], corners[3] - corners[1])
    normal /= np.linalg.norm(normal)
    eye = corners.mean(axis=0) + 4.0 * normal
    heading = float(np.degrees(np.arctan2(-normal[0], -normal[1])))
    view = Viewpoint("photo", tuple(map(float, eye)), heading, 0.0)
    for found in (model, alone):
        seen = site_photo(found, request_for(found, view=view, width_px=48, is_quick=True))
        assert seen.panels.tolist() == [0]


def test_a_site_without_panels_is_refused_in_words():
    model = office()
    bare = SiteModel(replace(model.site, facades=()), model.building, model.obstacles)
    with pytest.raises(InputError, match="has no panels yet"):
        site_photo(bare, request_for(bare))


def test_the_key_of_a_site_changes_with_panels_and_with_meshes_of_the_same_file():
    model = office()
    mesh = model.building
    moved = TriangleMesh(mesh.vertices_enu_m + 0.01, mesh.triangles)
    fewer = replace(model.site, facades=model.site.facades[:1])
    keys = [site_key(found) for found in (model, replace(model, building=moved), replace(model, site=fewer))]
    assert site_key(office()) == keys[0]
    assert len(set(keys)) == (3 if len(model.site.facades) > 1 else 2)


def test_quick_pictures_are_as_large_as_the_machine_allows_and_never_larger_than_fine_ones():
    assert quick_width_px(1280, None) < quick_width_px(1280, 1e-7)
    for seconds_per_px in (2e-6, 5e-6):
        width = quick_width_px(1280, seconds_per_px)
        assert width * (0.75 * width) * seconds_per_px == pytest.approx(QUICK_S, rel=0.02)
    assert quick_width_px(1280, 1.0) == 160
    assert quick_width_px(100, 1.0) == 100
    assert MAX_WIDTH_PX == 1280


@pytest.mark.slow
def test_a_tower_of_thousands_of_panels_is_photographed():
    model = tower()
    assert model.site.n_panels > 3000
    seen = site_photo(model, request_for(model, view=replace(VIEW, position_enu_m=(0.0, -110.0, 65.0)), is_quick=True))
    assert 600 < len(seen.panels) <= 910

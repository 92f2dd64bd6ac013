"""Finished models that are looked at: cut, coloured and asked what is where."""

from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from groundstation.services.model.objects import organise_files
from groundstation.services.reconstruct.messages import Probe, Section, Subject, ViewRequest
from groundstation.services.reconstruct.render_queue import TINT_SHARE, RenderQueue, ShownModels
from planning.base.effects import Decision
from reconstruction.gpu.device import open_device, why_no_gpu
from reconstruction.light.config import ReflectionConfig
from reconstruction.light.photo_set import read_photo_set
from reconstruction.metrics.image_metrics import psnr_db
from reconstruction.training import devices
from reconstruction.training.config import TrainConfig
from reconstruction.training.model.saved import save_model
from reconstruction.training.train import train_model
from tests.reconstruction.training.synthetic_data_set import write_data_set

LIGHT = ReflectionConfig(environment_rows=8, steps=10, batch=256)
# With light apart, so that pictures say which panel a pixel is of.
CONFIG = TrainConfig(
    light="environment-map", iterations=3, n_splats=300, max_splats=400, reflections=LIGHT, score_every_s=1e9
)

DECISION = Decision("", True, "scene", "", 0.0, 0.1, "", 0.0)


@contextmanager
def made_model(folder):
    """A data set, a model of it, and that as objects; torch has one thread meanwhile."""
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    write_data_set(folder / "data", n=4)
    save_model(train_model(folder / "data", CONFIG), folder / "model")
    organise_files(folder / "model", folder / "scene")
    yield folder
    torch.set_num_threads(threads)


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    with made_model(tmp_path_factory.mktemp("shown")) as folder:
        yield folder


@pytest.fixture
def render_queue():
    return RenderQueue(lambda _message: None)


def look(folder, camera, **more):
    return ViewRequest("left", 1, Subject("model", folder), camera, **{"drawn_by": "cpu"} | more)


def camera(folders):
    return read_photo_set(folders / "data").photos[0]


def test_a_model_and_its_objects_are_the_same_picture(folders, render_queue):
    pictures = [render_queue.answer(look(folders / name, camera(folders))).picture for name in ("model", "scene")]
    assert np.array_equal(*pictures)
    assert pictures[0].any()


def test_colours_lie_on_their_panels_and_nowhere_else(folders, render_queue):
    plain = render_queue.answer(look(folders / "scene", camera(folders))).picture.astype(float)
    red = render_queue.answer(
        look(folders / "scene", camera(folders), tints=((0, (255, 0, 0)), (99, (1, 2, 3))))
    ).picture
    panels = render_queue._models.of(folders / "scene").model(_view(folders)).panels.numpy()
    mixed = np.round(plain * (1.0 - TINT_SHARE) + np.array([255.0, 0.0, 0.0]) * TINT_SHARE)
    is_red = (red == mixed).all(axis=2) & (red != plain).any(axis=2)
    assert ((panels == 0) & is_red).sum() > 0.9 * is_red.sum() > 20
    assert (red == plain).all(axis=2)[panels != 0].all()


def _view(folders):
    from reconstruction.splats.rasterising.views import View

    model = ShownModels().of(folders / "scene").model
    return View.of(camera(folders), model.origin_enu_m)


def test_what_lies_beyond_a_section_is_not_there(folders, render_queue):
    means = render_queue._models.of(folders / "scene").model.splats.means.detach().numpy()
    origin = render_queue._models.of(folders / "scene").model.origin_enu_m
    at_m = float(np.median(means[:, 0]) + origin[0])
    shown = render_queue._models.of(folders / "scene")
    for is_above in (True, False):
        kept = render_queue._models.cut(shown, Section(0, at_m, is_above)).splats.means[:, 0] + origin[0]
        assert (kept <= at_m).all() if is_above else (kept >= at_m).all()
        assert 0.3 * len(means) < len(kept) < 0.7 * len(means)
    whole = render_queue.answer(look(folders / "scene", camera(folders))).picture
    nothing = render_queue.answer(look(folders / "scene", camera(folders), section=Section(0, -1e6)))
    assert nothing.problem == ""
    assert not np.array_equal(whole, nothing.picture)
    assert np.array_equal(
        whole, render_queue.answer(look(folders / "scene", camera(folders), section=Section(0, 1e6))).picture
    )


def test_the_same_section_of_two_models_is_cut_once_each(folders, render_queue):
    section = Section(2, 1.0)
    shown = [render_queue._models.of(folders / "scene"), ShownModels().of(folders / "scene")]
    first = [render_queue._models.cut(each, section) for each in shown]
    assert first[0] is not first[1]
    for each, cut in zip(shown, first, strict=True):
        assert render_queue._models.cut(each, section) is cut
        assert render_queue._models.cut(each, Section(2, 2.0)) is not cut


def test_quick_pictures_of_small_models_are_as_they_are(folders, render_queue):
    plain, quick = (
        render_queue.answer(look(folders / "scene", camera(folders), is_quick=q)).picture for q in (False, True)
    )
    assert np.array_equal(plain, quick)
    assert not render_queue._models._of_detail


def test_quick_pictures_of_large_models_look_like_them_and_have_sections(folders, render_queue, monkeypatch):
    """A model that counts as large, from so far away that pixels are as coarse as its cubes."""
    monkeypatch.setattr("groundstation.services.reconstruct.render_queue.LARGE", 100)
    monkeypatch.setattr("reconstruction.splats.merged_splats.FEWEST", 20)
    near = camera(folders)
    lens = near.intrinsics
    small = replace(near, intrinsics=lens.scaled(lens.width_px // 4, lens.height_px // 4))
    shown = render_queue._models.of(folders / "scene")
    n = len(render_queue._models.quick(shown, None, _view_of(small, shown)).splats)
    assert 0 < n < len(shown.model.splats)
    plain, quick = (
        render_queue.answer(look(folders / "scene", small, is_quick=is_quick)).picture.astype(float)
        for is_quick in (False, True)
    )
    assert 0.0 < np.abs(plain - quick).mean() < 10.0
    means = shown.model.splats.means.detach().numpy()
    at_m = float(np.median(means[:, 0]) + shown.model.origin_enu_m[0])
    cut = render_queue._models.quick(shown, Section(0, at_m), _view_of(small, shown)).splats
    assert 0 < len(cut) < n
    assert (cut.means[:, 0].detach().numpy() + shown.model.origin_enu_m[0] <= at_m).all()
    assert len(render_queue._models._of_detail) == 1
    assert not render_queue.prepare()


def test_a_large_model_is_made_ready_while_nobody_waits(folders, render_queue, monkeypatch):
    assert not render_queue.prepare()
    render_queue.answer(look(folders / "scene", camera(folders)))
    assert not render_queue.prepare()
    monkeypatch.setattr("groundstation.services.reconstruct.render_queue.LARGE", 100)
    assert [render_queue.prepare(), render_queue.prepare()] == [True, False]


def test_where_there_is_no_memory_for_it_quick_pictures_are_as_they_are(folders, render_queue, monkeypatch):
    def no_memory(_splats):
        raise MemoryError

    monkeypatch.setattr("groundstation.services.reconstruct.render_queue.LARGE", 100)
    monkeypatch.setattr("reconstruction.splats.merged_splats.splats_of_detail", no_memory)
    plain, quick = (
        render_queue.answer(look(folders / "scene", camera(folders), is_quick=q)).picture for q in (False, True)
    )
    assert np.array_equal(plain, quick)
    assert not render_queue.prepare()


def _view_of(photo, shown):
    from reconstruction.splats.rasterising.views import View

    return View.of(photo, shown.model.origin_enu_m)


def test_a_probe_tells_panel_and_place(folders, render_queue):
    source = read_photo_set(folders / "data")
    photo, corners = source.photos[0], source.panels.corners_enu_m
    middle = corners[0].mean(axis=0)
    in_camera = photo.pose.points_cam(middle[None])[0]
    lens = photo.intrinsics
    at = (
        lens.cx_px + lens.fx_px * in_camera[0] / in_camera[2],
        lens.cy_px + lens.fy_px * in_camera[1] / in_camera[2],
    )
    found = render_queue.probed(Probe("pick", 1, Subject("model", folders / "scene"), photo, at))
    assert found.panel == 0
    np.testing.assert_allclose(found.point_enu_m, middle, atol=1e-6)
    sky = render_queue.probed(Probe("pick", 2, Subject("model", folders / "scene"), photo, (-500.0, -5000.0)))
    assert (sky.panel, sky.point_enu_m) == (None, None)
    missing = render_queue.probed(Probe("pick", 3, Subject("model", Path("nowhere")), photo, at))
    assert "make one with `organise`" in missing.problem or "no finished model" in missing.problem


def needs_card():
    if reason := why_no_gpu():
        pytest.skip(f"no graphics card: {reason}")


def apart_db(a, b):
    return psnr_db(float(np.mean(np.square((a.astype(float) - b.astype(float)) / 255.0))))


def test_the_card_shows_what_the_processor_shows_in_every_layer(folders, render_queue):
    needs_card()
    for layer in ("picture", "reflectivity", "normals", "depth"):
        there, here = (
            render_queue.answer(look(folders / "scene", camera(folders), layer=layer, drawn_by=by))
            for by in ("gpu", "cpu")
        )
        assert (there.by_card, here.by_card) == (True, False)
        assert "as you asked" in there.drawn_by
        assert "as you asked" in here.drawn_by
        assert apart_db(there.picture, here.picture) > 40.0
        assert there.depth_m == pytest.approx(here.depth_m, rel=1e-4)


def test_a_card_that_is_lost_is_told_and_the_processor_goes_on(folders, render_queue):
    needs_card()
    asked = look(folders / "scene", camera(folders), drawn_by="gpu")
    assert render_queue.answer(asked).by_card
    open_device().raw.destroy()
    after, later = (render_queue.answer(asked) for _ in range(2))
    expected = render_queue.answer(replace(asked, drawn_by="cpu")).picture
    for each in (after, later):
        assert each.problem == ""
        assert not each.by_card
        assert "the processor goes on: the graphics card" in each.drawn_by
        assert np.array_equal(each.picture, expected)
    assert after.lost == after.drawn_by
    assert later.lost == ""


def test_a_model_is_decided_about_when_nobody_waits_and_the_reason_is_said(folders, render_queue, monkeypatch):
    tried = []

    def decided(draw, n_splats, setting):
        tried.append((draw(False).shape, n_splats, setting))
        return replace(DECISION, on=False, reason="Arc takes 50 ms, the processor 20 ms")

    monkeypatch.setattr(devices, "shown_by_card", decided)
    monkeypatch.setattr(devices, "why_no_card", str)
    asked = look(folders / "scene", camera(folders), drawn_by="auto")
    before = render_queue.answer(asked)
    assert (before.by_card, before.drawn_by) == (False, "")
    assert render_queue.prepare()
    after = render_queue.answer(asked)
    assert (after.by_card, after.drawn_by) == (False, "Arc takes 50 ms, the processor 20 ms")
    assert not render_queue.prepare()
    lens = asked.camera.intrinsics
    n_splats = len(render_queue._models.of(folders / "scene").model.splats)
    assert tried == [((lens.height_px, lens.width_px, 3), n_splats, "auto")]


def test_where_there_is_no_card_the_first_picture_says_so(folders, render_queue, monkeypatch):
    monkeypatch.setattr(devices, "why_no_gpu", lambda: "no driver answers")
    found = render_queue.answer(look(folders / "scene", camera(folders), drawn_by="auto"))
    assert (found.by_card, found.drawn_by) == (False, "no graphics card: no driver answers")
    assert not render_queue.prepare()

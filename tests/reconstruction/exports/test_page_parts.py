"""Large models as a coarse one and parts beside the page: what is merged, what files hold, and what a browser keeps."""

import base64
import json
import re
import shutil
from dataclasses import replace

import numpy as np
import pytest

from planning.base.errors import OperationCancelled
from reconstruction.exports import page_parts, web
from reconstruction.exports.component_parts import ellipsoids_of_all
from reconstruction.exports.page_parts import GlassValues, two_levels
from reconstruction.exports.web import WebOptions, write_web
from reconstruction.objects.gs_scene import GsComponent, GsGaussian
from tests.reconstruction.exports.test_page_mirrors import made_mirrors
from tests.reconstruction.exports.web_browser import opened
from tests.reconstruction.objects.synthetic_scene import synthetic_scene

STATE = "return reflight.state()"


def small_parts(monkeypatch, embedded=500, coarse=200, part=300, resident=1 << 21):
    monkeypatch.setattr(web, "MOST_EMBEDDED", embedded)
    monkeypatch.setattr(web, "RESIDENT", resident)
    monkeypatch.setattr(page_parts, "MOST_COARSE", coarse)
    for module in (page_parts, web):
        monkeypatch.setattr(module, "PART", part)


def spread_out(scene, seed=0, size_m=12.0):
    """The scene with its Gaussians all over a box, small and opaque."""
    rng = np.random.default_rng(seed)
    for component in scene.components:
        values, n = component.gaussians.values, len(component.gaussians)
        values["means"][:] = rng.uniform(0.0, size_m, (n, 3)) * (1.0, 0.05, 1.0)
        values["opacity_logits"][:] = 3.0
    return scene


def test_every_gaussian_is_in_one_part_or_stays(monkeypatch):
    small_parts(monkeypatch)
    fine = ellipsoids_of_all(spread_out(synthetic_scene(sizes=((900, 900), (300,)), n_background=1500)).components)
    found = two_levels(fine, None)
    assert len(found.coarse) <= 200
    assert 5 < len(found.parts) < 200
    rows = np.concatenate([part.rows for part in found.parts])
    assert len(np.unique(rows)) == len(rows)
    n_stay = int((found.part_of < 0).sum())
    assert len(rows) + n_stay == len(fine)
    for number, part in enumerate(found.parts):
        assert len(part.rows) <= 300
        assert (found.part_of == number).any()
        apart = np.linalg.norm(fine.means_m[part.rows] - part.middle_m, axis=1)
        assert apart.max() <= part.radius_m
        # What stands for a part is of its panes, and within it.
        assert set(found.coarse.panels[found.part_of == number]) == set(fine.panels[part.rows])
        of_part = found.coarse.means_m[found.part_of == number]
        assert (np.linalg.norm(of_part - part.middle_m, axis=1) <= part.radius_m).all()


def test_merged_ones_have_the_mean_of_what_they_stand_for(monkeypatch):
    small_parts(monkeypatch)
    fine = ellipsoids_of_all(spread_out(synthetic_scene(sizes=((0,),), n_background=3000)).components)
    sh = np.zeros_like(fine.sh)
    sh[:, 0] = 0.7
    fine = replace(fine, sh=sh)
    n = len(fine)
    glass = GlassValues(sh, np.full(n, 0.6, np.float32), np.full((n, 3), 0.25, np.float32))
    found = two_levels(fine, glass)
    np.testing.assert_allclose(found.coarse.sh, np.broadcast_to(sh[:1], found.coarse.sh.shape), atol=1e-5)
    np.testing.assert_allclose(found.glass.reflectivity, 0.6, atol=1e-6)
    np.testing.assert_allclose(found.glass.f0, 0.25, atol=1e-6)
    assert np.isfinite(found.coarse.scales_m).all()
    np.testing.assert_allclose(np.linalg.norm(found.coarse.quats, axis=1), 1.0, atol=1e-5)
    # They are as wide as their cubes, about.
    merged = found.coarse.scales_m[found.part_of >= 0]
    assert 0.1 * found.side_m < np.median(merged.max(axis=1)) < found.side_m


@pytest.mark.parametrize("places", ["one place", "two far places", "a few huge"])
def test_hard_models_are_cut_too(monkeypatch, places):
    small_parts(monkeypatch)
    fine = ellipsoids_of_all(synthetic_scene(sizes=((0,),), n_background=2000).components)
    means, scales = np.zeros_like(fine.means_m), fine.scales_m.copy()
    if places == "two far places":
        means[1000:] = 1e5
    if places == "a few huge":
        means[:] = np.random.default_rng(0).uniform(0.0, 5.0, means.shape)
        scales[:15] = 1e4
    found = two_levels(replace(fine, means_m=means, scales_m=scales), None)
    rows = np.concatenate([part.rows for part in found.parts])
    assert len(np.unique(rows)) == len(rows) == 2000 - int((found.part_of < 0).sum())
    assert max(len(part.rows) for part in found.parts) <= 300
    assert len(found.coarse) <= 250
    for values in (found.coarse.means_m, found.coarse.scales_m, found.coarse.quats, found.coarse.opacities):
        assert np.isfinite(values).all()


def part_contents(folder, number):
    text = (folder / f"{number}.js").read_text()
    found = re.fullmatch(rf'reflightPart\({number},"([^"]*)","([^"]*)"\);\n', text)
    return [base64.b64decode(each) for each in found.groups()]


def test_a_page_has_a_coarse_model_and_its_parts_beside_it(monkeypatch, tmp_path):
    small_parts(monkeypatch)
    scene = spread_out(synthetic_scene(sizes=((900, 600),), n_background=1500))
    options = WebOptions(degree=1, mirrors=made_mirrors(scene))
    page = write_web(scene, tmp_path, (), options)
    model = json.loads(re.search(r'id="model">([^<]*)<', page.path.read_text())[1])
    parts = model["beside"]
    folder = tmp_path / parts["folder"]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["index.html", parts["folder"]]
    assert len(list(folder.iterdir())) == len(parts["each"]) > 3
    fine, n_glass = 0, 0
    for number, (n, on_panes, *_) in enumerate(parts["each"]):
        gaussians, glass = part_contents(folder, number)
        assert len(gaussians) == n * (32 + 9)
        assert len(glass) == on_panes * (8 + 9)
        assert on_panes <= parts["most_glass"]
        fine, n_glass = fine + n, n_glass + on_panes
    assert fine + 200 > page.n_gaussians >= fine
    assert n_glass > 500
    assert model["n"] < 250
    assert page.n_bytes == sum(path.stat().st_size for path in (page.path, *folder.iterdir()))
    # Another page takes its place with its parts, and the same scene gives the same bytes.
    again = write_web(scene, tmp_path / "again", (), options)
    assert again.path.read_bytes() == page.path.read_bytes()
    monkeypatch.setattr(web, "MOST_EMBEDDED", 10_000)
    write_web(scene, tmp_path, (), WebOptions(degree=1))
    assert not folder.exists()


def test_a_page_that_is_cancelled_leaves_the_older_one_with_its_parts(monkeypatch, tmp_path):
    small_parts(monkeypatch)
    scene = spread_out(synthetic_scene(sizes=((900,),), n_background=600))
    page = write_web(scene, tmp_path)
    before = {path.name: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    assert page.n_bytes == sum(map(len, before.values()))

    class Cancelled:
        def report(self, stage, done, total):
            if "page" in stage and done == 2:
                raise OperationCancelled("cancelled")

    with pytest.raises(OperationCancelled):
        write_web(scene, tmp_path, (), WebOptions(title="another"), Cancelled())
    assert {path.name: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before


@pytest.mark.slow
def test_a_browser_keeps_as_many_parts_as_there_is_room_for_from_the_disk(browser, monkeypatch, tmp_path):
    scene = spread_out(synthetic_scene(sizes=((900, 600),), n_background=1500))
    options = {"size": (640, 240), "mirrors": made_mirrors(scene)}
    opened(browser, tmp_path / "whole", scene, **options)
    whole = browser.pixels().astype(float)
    small_parts(monkeypatch)
    page = opened(browser, tmp_path / "parts", scene, **options)
    state = browser.run(STATE)
    n_parts = len(list(next(page.path.parent.glob("parts-*")).iterdir()))
    assert sorted(state["parts"]) == list(range(n_parts))
    assert np.sqrt(np.mean((browser.pixels() - whole) ** 2)) < 3.0
    assert browser.errors() == []
    # With room for three.
    small_parts(monkeypatch, resident=900)
    opened(browser, tmp_path / "few", scene, **options)
    state = browser.run(STATE)
    assert len(state["parts"]) == 3
    assert state["nOrdered"] <= state["most"] <= 1024 + 900
    browser.run("reflight.look(...arguments)", [11.0, -1.0, 11.0], 0, 0)
    browser.settled()
    assert browser.run(STATE)["parts"] != state["parts"]
    assert len(browser.run(STATE)["parts"]) == 3
    # The page alone, as somebody mails it: coarse, and it says what is missing.
    shutil.rmtree(next(page.path.parent.glob("parts-*")))
    browser.open(page.path)
    browser.settled()
    assert "beside this page is missing" in browser.texts("#note")[0]
    assert browser.run(STATE)["parts"] == []
    assert np.abs(browser.pixels() - whole).mean() < 40.0


def many(n):
    """A street of small Gaussians, most of them on no pane."""
    rng = np.random.default_rng(0)
    scene = synthetic_scene(sizes=((4,),), n_background=0)
    values = {
        "means": (rng.random((n, 3), np.float32) * np.array([400.0, 60.0, 40.0], np.float32)),
        "quats": rng.standard_normal((n, 4), np.float32),
        "log_scales": np.log(rng.uniform(0.01, 0.1, (n, 2))).astype(np.float32),
        "opacity_logits": np.full(n, 2.0, np.float32),
        # One row for all: harmonics that the page leaves out need no memory here.
        "sh": np.broadcast_to(np.full((1, 16, 3), 0.2, np.float32), (n, 16, 3)),
        "reflectivity_logits": np.zeros(n, np.float32),
        "f0_logits": np.zeros((n, 3), np.float32),
    }
    table = GsGaussian(values, np.arange(n, dtype=np.int32))
    background = GsComponent(scene.components[1].global_id, "background", "background", (), table)
    return replace(scene, components=(scene.components[0], background))


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_ten_million_gaussians_have_a_first_picture_within_2_mb_and_bounded_memory(tmp_path):
    n = 10_000_000
    scene = many(n)
    page = write_web(scene, tmp_path, (), WebOptions(degree=0))
    assert page.n_gaussians == n + 4
    text = page.path.read_bytes()
    assert text.index(b'id="g1"') < 2_000_000
    assert len(text) < 12_000_000
    model = json.loads(re.search(rb'id="model">([^<]*)<', text)[1])
    parts = model["beside"]
    assert max(each[0] for each in parts["each"]) <= parts["size"]
    sizes = [path.stat().st_size for path in (tmp_path / parts["folder"]).iterdir()]
    assert max(sizes) < 2_000_000
    assert sum(each[0] for each in parts["each"]) > 0.9 * n
    # What a page keeps does not grow with the model: 32 bytes each of the words, and 60 more beside them.
    assert model["n"] + parts["room"] < 2_400_000

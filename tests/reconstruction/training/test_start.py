"""What splats begin on, and whether light apart from them is worth it."""

import shutil
from dataclasses import replace

import numpy as np
import pytest
import torch

from planning.base.effects import decide
from planning.base.errors import InputError
from planning.base.progress import QUIET
from planning.geo.mesh import from_corners, write_mesh
from reconstruction.dataset.records import coloured_ply
from reconstruction.light import light_training
from reconstruction.light.choose_light import chosen
from reconstruction.light.config import ReflectionConfig
from reconstruction.light.photo_set import read_photo_set
from reconstruction.splats.rasterising.views import View
from reconstruction.splats.splats import NO_PANEL
from reconstruction.training import start as start_module
from reconstruction.training.callbacks import unshown
from reconstruction.training.config import TrainConfig
from reconstruction.training.model.render import render_view
from reconstruction.training.photos.decoded_photo import usual_reduce
from reconstruction.training.start import SeparateLight, start_model
from tests.reconstruction.light.synthetic_folder import LENS, far
from tests.reconstruction.training.synthetic_data_set import write_data_set

WALL_Y_M = 0.5
"""Of a mesh behind the panels, which are in the plane y = 0."""

LIGHT = ReflectionConfig(environment_rows=8, steps=2, batch=64)


@pytest.fixture
def source(tmp_path):
    """Panels before a wall, and points that all lie on the wall."""
    folder = tmp_path / "glass"
    write_data_set(folder, n=4)
    panels = read_photo_set(folder).panels.corners_enu_m
    low, high = panels.reshape(-1, 3).min(axis=0) - 3.0, panels.reshape(-1, 3).max(axis=0) + 3.0
    a, b, c, d = [
        (x, WALL_Y_M, z) for x, z in ((low[0], low[2]), (high[0], low[2]), (high[0], high[2]), (low[0], high[2]))
    ]
    write_mesh(folder / "building.ply", from_corners(np.array([[a, b, c], [a, c, d]])))
    places = np.random.default_rng(0).uniform(low, high, (400, 3))
    places[:, 1] = WALL_Y_M
    (folder / "points.ply").write_bytes(coloured_ply(places, np.full((400, 3), 99, np.uint8)))
    return read_photo_set(folder)


def begun(source, method, start_from):
    config = TrainConfig(
        method=method, light="environment-map", reflections=LIGHT, n_splats=300, max_splats=300, start_from=start_from
    )
    start = start_model(source, config)
    splats = start.model.splats
    heights = splats.means.detach().numpy()[:, 1] + start.model.origin_enu_m[1]
    return heights, splats.panels.numpy() != NO_PANEL


def test_splats_begin_on_panels_and_what_is_beside_them(source):
    y_m, _ = begun(source, "2dgs", "surfaces")
    assert (np.abs(y_m) < 1e-3).mean() > 0.3
    assert (np.abs(y_m - WALL_Y_M) < 1e-3).any()


def test_splats_that_begin_at_points_are_there_alone(source):
    y_m, _ = begun(source, "2dgs", "points")
    assert np.abs(y_m - WALL_Y_M).max() < 1e-3
    assert 100 < len(y_m) <= 400


def test_a_method_that_knows_panels_begins_on_them_and_at_points(source):
    y_m, is_on_panel = begun(source, "refglass-gs", "points")
    assert is_on_panel.any()
    assert np.abs(y_m[is_on_panel]).max() < 1e-3
    assert np.abs(y_m[~is_on_panel] - WALL_Y_M).max() < 1e-3


def test_a_start_at_points_that_are_not_there_is_refused(source):
    (source.folder / "points.ply").unlink()
    with pytest.raises(InputError, match="of 0 points of photogrammetry none is away from glass"):
        begun(source, "2dgs", "points")


ASKED = TrainConfig(
    iterations=1000,
    n_splats=300,
    max_splats=300,
    reflections=ReflectionConfig(environment_rows=16, steps=60, batch=512),
)


def of_other_light(folder, n):
    """Photos whose mirror images are of other surroundings each."""
    write_data_set(folder, n=n)
    for number in range(n):
        one = folder.with_name(f"{folder.name}-{number}")
        write_data_set(one, n=n, light=lambda places, omega_r, by=number: far(places, omega_r + 1.7 * by))
        name = f"p{number:02d}.png"
        shutil.copy(one / "images" / name, folder / "images" / name)
        shutil.rmtree(one)


class Stages:
    """How far each stage came, one after the other."""

    def __init__(self):
        self.shares = []

    def report(self, stage, done, total):
        if not self.shares or self.shares[-1][0] != stage:
            self.shares.append((stage, []))
        self.shares[-1][1].append(done / total if total else 0.0)


def light_apart(folder, config, monkeypatch, others=(), show=unshown, monitor=QUIET):
    """The decision, and the model of light; it is asked whatever rays alone say, of the environment map and others."""
    monkeypatch.setattr(start_module, "contenders", lambda *_: others)
    monkeypatch.setattr(start_module, "CLEAR_DB", np.inf)
    monkeypatch.setattr(start_module, "chosen", lambda trials: ("environment-map", chosen(trials)[1]))
    start = start_model(read_photo_set(folder), config, monitor, show=show)
    found = [decision for decision in start.decisions if decision.effect == "light apart from the splats"]
    return found, start.light_name


@pytest.mark.long
def test_what_is_placed_and_ever_better_light_are_shown_before_the_first_step(tmp_path, monkeypatch):
    monkeypatch.setattr(light_training, "LOOK_EVERY_S", 0.0)
    write_data_set(tmp_path / "same", n=16)
    source, errors, scores = read_photo_set(tmp_path / "same"), [], []
    photo = source.photos[0]

    def look(model, settings, history):
        scores[:] = history
        display = render_view(model, View.of(photo, model.origin_enu_m), settings=settings).display
        errors.append(float(np.abs(display - source.picture(photo) / 255.0).mean()))

    light_apart(tmp_path / "same", ASKED, monkeypatch, show=look)
    placed, tried, tried_with_splats, *learned = errors
    assert max(tried, tried_with_splats) < placed < 0.3
    assert learned
    assert learned[-1] < placed
    assert len(scores) == len(errors)
    assert [t_s for t_s, _ in scores] == sorted(t_s for t_s, _ in scores)
    assert scores[-1][1] > scores[0][1]


@pytest.mark.slow
def test_light_apart_is_on_where_mirror_images_agree_and_off_where_they_do_not(tmp_path, monkeypatch):
    write_data_set(tmp_path / "same", n=16)
    (decision,), name = light_apart(tmp_path / "same", ASKED, monkeypatch)
    assert (decision.on, decision.decided_by, name) == (True, "scene", "environment-map")
    assert decision.size > 1.0
    of_other_light(tmp_path / "other", 16)
    (decision,), name = light_apart(tmp_path / "other", ASKED, monkeypatch)
    assert (decision.on, decision.decided_by, name) == (False, "scene", "harmonics")
    assert "splats alone" in decision.reason


@pytest.mark.parametrize(
    ("apart_db", "unsure_db", "is_on"), [(20.5, 0.1, True), (20.5, 0.3, False), (20.2, 0.0, False)]
)
def test_light_apart_counts_as_far_as_its_gain_is_beyond_its_error(apart_db, unsure_db, is_on):
    decision = decide(SeparateLight(), (apart_db, 20.0, unsure_db, 3.0))
    assert decision.on == is_on
    assert decision.size == pytest.approx(apart_db - 20.0 - unsure_db)


@pytest.mark.slow
def test_of_several_lights_the_one_that_tells_most_together_with_splats_is_kept_with_what_these_learned(
    tmp_path, monkeypatch
):
    write_data_set(tmp_path / "same", n=16)
    trainers, found, begun = [], [], start_module.Trainer.__init__

    def noted(trainer, *arguments, **more):
        begun(trainer, *arguments, **more)
        trainers.append(trainer)

    monkeypatch.setattr(start_module.Trainer, "__init__", noted)
    monkeypatch.setattr(
        start_module, "warm_start_splats", lambda panels, splats, *_: found.append(splats.means.clone())
    )
    stages = Stages()
    (decision,), name = light_apart(tmp_path / "same", ASKED, monkeypatch, ("radiance-grid",), monitor=stages)
    assert decision.on
    names = [stage for stage, _ in stages.shares]
    assert len(set(names)) == len(names), "no stage comes back"
    assert all(shares == sorted(shares) for _, shares in stages.shares), "no bar goes back"
    assert len(trainers) == 3
    # All began alike; what the best one learned goes on.
    best = trainers[("environment-map", "radiance-grid").index(name)]
    assert torch.equal(found[0], found[1])
    assert torch.equal(found[0], found[2])
    assert torch.equal(found[3], best.model.splats.means)
    assert not torch.equal(found[3], found[0])


@pytest.mark.long
@pytest.mark.parametrize(("setting", "is_apart"), [("on", True), ("off", False)])
def test_light_apart_is_as_asked_and_nothing_is_tried_for_it(tmp_path, monkeypatch, setting, is_apart):
    write_data_set(tmp_path / "same", n=10)
    monkeypatch.setattr(start_module, "_is_worth", None)
    if not is_apart:
        monkeypatch.setattr(start_module, "try_lights", None)
    (decision,), name = light_apart(tmp_path / "same", replace(ASKED, light_apart=setting), monkeypatch)
    assert (decision.on, decision.decided_by) == (is_apart, "user")
    assert (name != "harmonics") == is_apart


@pytest.mark.parametrize(
    ("size_px", "window_px", "wanted"),
    [
        ((40, 30), 256 * 192, 1),
        ((800, 600), 96 * 72, 1),  # windows of quick looks are small, and photos are not made as small as these want
        ((1024, 768), 256 * 192, 2),
        ((1296, 1936), 256 * 192, 3),
        ((5280, 3956), 256 * 192, 10),
        ((5280, 3956), 768 * 576, 3),
    ],
)
def test_photos_are_made_as_small_as_some_windows_cover(size_px, window_px, wanted):
    width, height = size_px
    assert usual_reduce([LENS, LENS, LENS.scaled(width, height)], window_px) == wanted


@pytest.mark.slow
def test_large_photos_are_learned_from_smaller_unless_it_is_said_how(tmp_path):
    write_data_set(tmp_path / "large", 3, LENS.scaled(1040, 780))
    config = TrainConfig(method="2dgs", n_splats=100, max_splats=100)
    source = read_photo_set(tmp_path / "large")
    start = start_model(source, config)
    assert start.config.reduce == 2
    assert "photos of 1040 x 780 pixels are learned from at 520 x 390" in start.notes[0]
    assert "4 times" in start.notes[0]
    start = start_model(source, replace(config, reduce=1))
    assert (start.config.reduce, start.notes) == (1, ())

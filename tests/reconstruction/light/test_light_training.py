"""Learning light alone is interrupted and goes on bit by bit, and survives what it says it survives."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
import torch

from planning.base.effects import decide
from planning.base.errors import OperationCancelled, ReconstructionError
from planning.base.progress import QUIET
from reconstruction.light import light_training
from reconstruction.light.config import PAPER_STAGES, GlassLearned, GridSettings, ReflectionConfig
from reconstruction.light.glass_light import UNKNOWN
from reconstruction.light.glass_rays import glass_rays
from reconstruction.light.light_training import LEAST_BATCH, MOST_HALVINGS, CheckpointSettings, LightTraining, on_device
from reconstruction.light.losses import ray_errors, ray_loss
from reconstruction.light.photo_set import read_photo_set
from reconstruction.light.radiance_grid import RadianceGrid
from reconstruction.light.ray_table import RayTable
from reconstruction.light.reflection_mlp import MlpShape
from reconstruction.light.reflective_panels import ReflectivePanels
from reconstruction.light.training import mean_square_error, new_panels, train_reflections
from reconstruction.training.training_state import read_checkpoint, write_checkpoint
from tests.reconstruction.light.synthetic_folder import far, near, write_folder

GRID = GridSettings(most_cells=2048, levels=2, far_side=16, batch_share=1.0, rest=3, grown=0.6)
CONFIG = ReflectionConfig(
    mlp=MlpShape(16, 4, 3, 2),
    environment_rows=16,
    grid=GRID,
    learned=GlassLearned(rays=4, tilts=True, poses=True),
    steps=12,
    batch=256,
    warm_up=3,
    precision="float32",
)
MODELS = ["harmonics", "environment-map", "mlp", "radiance-grid"]


@pytest.fixture(scope="module")
def photos(tmp_path_factory):
    folder = tmp_path_factory.mktemp("light") / "photos"
    write_folder(folder, near, 4)
    source = read_photo_set(folder)
    return glass_rays(source, source.photos[:3]), source.panels, glass_rays(source, source.photos[3:])


class Cancelling:
    """Cancels at the n-th report."""

    def __init__(self, n):
        self.left = n

    def report(self, stage, done, total):
        self.left -= 1
        if self.left < 0:
            raise OperationCancelled("enough")


def learned(photos, model, keeping=None, monitor=QUIET, **more):
    rays, planes, unseen = photos
    return train_reflections(rays, planes, model, CONFIG, unseen=unseen, monitor=monitor, keeping=keeping, **more)


def training(photos, model="radiance-grid", config=CONFIG, **more):
    rays, planes, _ = photos
    generator = torch.Generator().manual_seed(0)
    begun = new_panels(rays, planes, model, config, generator)
    return LightTraining(begun, rays, config, "float32", generator, **more)


def assert_same(one, other):
    mine, theirs = one.state_dict(), other.state_dict()
    assert mine.keys() == theirs.keys()
    assert all(torch.equal(mine[name], theirs[name]) for name in mine)


# At 6 steps the grid has grown once of twice.
@pytest.mark.few(1)
@pytest.mark.parametrize(("model", "n"), [*((model, 6) for model in MODELS), ("radiance-grid", 1), ("mlp", 0)])
def test_interrupted_it_goes_on_bit_by_bit(photos, tmp_path, model, n):
    whole = learned(photos, model)
    keeping = CheckpointSettings(lambda state: write_checkpoint(tmp_path / "c", state))
    with pytest.raises(OperationCancelled):
        learned(photos, model, keeping, Cancelling(n))
    state = read_checkpoint(tmp_path / "c")
    assert state["progress"]["step"] == n
    again = learned(photos, model, CheckpointSettings(keeping.write, before=state))
    assert_same(whole.panels, again.panels)
    assert again.n_steps == whole.n_steps == 12
    assert [point.value for point in again.history] == [point.value for point in whole.history]
    assert len(again.history) == 12


def test_its_seconds_and_its_limit_go_on_too(photos):
    config = replace(CONFIG, time_limit_s=9.0)
    ticks, kept = itertools.count(), []
    first = training(photos, config=config, keeping=CheckpointSettings(kept.append), clock=lambda: next(ticks))
    with pytest.raises(OperationCancelled):
        first.run(None, 1, Cancelling(4))
    second = training(
        photos, config=config, keeping=CheckpointSettings(kept.append, 2.0, kept[0]), clock=lambda: next(ticks)
    )
    assert second.at.spent_s == 4.0
    second.run(None, 1)
    assert second.at.step == 9
    # And every two seconds.
    assert [state["progress"]["step"] for state in kept] == [4, 6, 8]


def test_a_state_of_another_model_is_refused(photos):
    state = training(photos, "mlp").state()
    for model in ("harmonics", "environment-map", "radiance-grid"):
        with pytest.raises(ValueError, match="another model"):
            training(photos, model).restore(state)
    with pytest.raises(ValueError, match="another model"):
        training(photos, "mlp", replace(CONFIG, mlp=MlpShape(20, 4, 3, 2))).restore(state)
    with pytest.raises(ValueError, match="another model"):
        training(photos, "mlp").restore(state | {"levels": [0]})


def spoiled_at(calls, monkeypatch):
    """Makes the loss NaN at some of its calls, counted from 0."""
    true, count = light_training.ray_loss, itertools.count()
    monkeypatch.setattr(
        light_training, "ray_loss", lambda *given: true(*given) * (math.nan if next(count) in calls else 1.0)
    )


@pytest.mark.parametrize("call", [0, 10])
def test_a_loss_that_is_no_number_halves_the_rates_and_goes_back(photos, monkeypatch, call):
    one = training(photos)
    spoiled_at({call}, monkeypatch)
    one.run(None, 1)
    assert one.at.step == 12
    assert one.at.factor == 0.5
    assert f"not a number at step {call + 1}; all rates are halved" in one.at.notes[0]
    assert all(value.isfinite().all() for value in one.panels.parameters())
    assert one.panels.light.light.level == 0


def test_weights_that_are_no_numbers_are_taken_from_the_last_good_state(photos, monkeypatch):
    monkeypatch.setattr(light_training, "KEPT_EVERY", 2)
    one = training(photos, "environment-map")
    for _ in range(5):
        one._survived_step()
    good = one._good["panels"]
    with torch.no_grad():
        one.panels.light.light.mean[0] = math.nan
    one._survived_step()
    assert one.at.step == 4
    assert all(torch.equal(value, good[name]) for name, value in one.panels.state_dict().items())
    one.run(None, 1)
    assert one.at.step == 12


def test_a_state_that_is_no_good_is_not_kept(photos):
    kept = []
    one = training(photos, "mlp", keeping=CheckpointSettings(kept.append))
    one.step()
    with torch.no_grad():
        one.panels.light.light.last.bias[0] = math.nan
    with pytest.raises(OperationCancelled):
        one.run(None, 1, Cancelling(0))
    assert all(value.isfinite().all() for value in kept[0]["panels"].values())


def test_without_numbers_it_ends_in_words(photos, monkeypatch):
    one = training(photos, "harmonics")
    spoiled_at(range(1, 99), monkeypatch)
    with pytest.raises(ReconstructionError, match="not a number at step 1 of 12; lower the learning rates"):
        one.run(None, 1)
    assert one.at.n_undone == MOST_HALVINGS + 1


@pytest.mark.parametrize("model", ["mlp", "radiance-grid"])
def test_when_memory_runs_out_batches_are_halved_and_steps_taken_again(photos, monkeypatch, model):
    true = ReflectivePanels.forward

    def greedy(self, rays, *arguments, **more):
        if len(rays) > 100:
            raise MemoryError
        return true(self, rays, *arguments, **more)

    one = training(photos, model)
    monkeypatch.setattr(ReflectivePanels, "forward", greedy)
    one.run(None, 1)
    assert (one.at.step, one.at.batch, one.at.factor) == (12, 64, 1.0)
    assert [note.split()[-4] for note in one.at.notes] == ["128", "64"]


def test_when_there_is_no_memory_to_grow_it_goes_back(photos, monkeypatch):
    true, calls = RadianceGrid.grow, itertools.count()

    def greedy(self):
        true(self)
        if next(calls) == 0:
            raise RuntimeError("DefaultCPUAllocator: can't allocate memory")

    one = training(photos)
    monkeypatch.setattr(RadianceGrid, "grow", greedy)
    one.run(None, 1)
    assert (one.at.step, one.at.batch) == (12, 128)
    assert one.panels.light.light.level == 0


def test_without_any_memory_it_ends_in_words_and_other_errors_are_not_swallowed(photos, monkeypatch):
    one = training(photos, "harmonics")
    monkeypatch.setattr(ReflectivePanels, "forward", lambda *_, **__: (_ for _ in ()).throw(MemoryError()))
    with pytest.raises(ReconstructionError, match=f"no memory for batches of {LEAST_BATCH} rays at step 1 of 12"):
        one.run(None, 1)
    monkeypatch.setattr(ReflectivePanels, "forward", lambda *_, **__: (_ for _ in ()).throw(RuntimeError("size")))
    with pytest.raises(RuntimeError, match="size"):
        one.run(None, 1)


def test_notes_come_with_the_result(photos, monkeypatch):
    spoiled_at({3}, monkeypatch)
    assert "halved" in learned(photos, "mlp").notes[0]


@pytest.mark.skipif(not torch.cuda.is_available(), reason="there is no CUDA device")
@pytest.mark.parametrize("model", MODELS)
def test_on_a_cuda_device_it_learns_the_same(photos, model):
    here, there = (learned(photos, model, device=device) for device in ("cpu", "cuda"))
    assert there.history[-1].value == pytest.approx(here.history[-1].value, abs=0.1)
    for name, value in there.panels.state_dict().items():
        assert value.device.type == "cpu"
        assert value.shape == here.panels.state_dict()[name].shape


@pytest.mark.long
@pytest.mark.few(1)
@pytest.mark.parametrize("model", MODELS)
def test_on_another_device_all_that_a_step_needs_is_there(photos, model, monkeypatch):
    # The meta device has shapes and no numbers, and refuses what is on two devices; lenses here are straight.
    monkeypatch.setattr(RayTable, "_unbent", lambda self, x, y, _: torch.stack([x, y], dim=1))
    rays, planes, _ = photos
    config = replace(CONFIG, learned=GlassLearned(rays=4, tilts=True, bows=True, poses=True))
    generator = torch.Generator().manual_seed(0)
    panels = new_panels(rays, planes, model, config, generator).to("meta")
    batch = on_device(rays, torch.device("meta"))[:64]
    for _ in range(2):
        loss = ray_loss(ray_errors(panels(batch, generator=generator), batch.display), PAPER_STAGES[0])
        more = None if panels.light is None else panels.light.regulariser(config, 0)
        (loss if more is None else loss + more).backward()
        if model == "radiance-grid":
            panels.light.light.grow()
    found = [value.grad for value in panels.parameters() if value.grad is not None]
    assert len(found) > 2
    assert {value.device.type for value in found} == {"meta"}


@pytest.mark.long
def test_rays_of_somebody_who_walked_by_are_left_out_and_stay_out(photos):
    rays, planes, unseen = photos
    person = (rays.photos == 1) & (rays.columns >= 8) & (rays.columns < 24)
    seen = replace(rays, colours=torch.where(person[:, None], 255 - rays.colours // 4, rays.colours))
    config = replace(CONFIG, steps=60, transients="on", learned=None)
    found = training((seen, planes, unseen), "environment-map", config)
    found.run(None, 1)
    assert found.at.transients == 0.0  # one photo alone is no evidence, and the user wants it
    assert len(found.rays) < len(rays)
    left = (found.rays.photos == 1) & (found.rays.columns >= 8) & (found.rays.columns < 24)
    assert float(left.sum() / person.sum()) < 0.2
    assert float((found.rays.photos != 1).sum() / (rays.photos != 1).sum()) > 0.8
    again = training((seen, planes, unseen), "environment-map", config)
    again.restore(found.state())
    assert len(again.rays) == len(found.rays)
    everything = training((seen, planes, unseen), "environment-map", replace(config, transients="off"))
    everything.run(None, 1)
    assert len(everything.rays) == len(rays)


BOW = 0.08
"""Radians, at the panes' edges."""


def of_bowed_panes(places, omega_r):
    """`far`, mirrored by panes that bulge: normals lean outwards towards the edges of the panes of `corners_of`."""
    off = np.mod(places[:, [0, 2]] - 1.0, 2.0) - 1.0
    normals = np.column_stack([BOW * off[:, 0], -np.ones(len(off)), BOW * off[:, 1]])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    arriving = omega_r * (1.0, -1.0, 1.0)
    return far(places, arriving - 2.0 * (arriving * normals).sum(axis=1, keepdims=True) * normals)


BOWED = replace(CONFIG, learned=None, steps=120, batch=512, grid=replace(GRID, levels=0, far_side=64, tilt_rate=5e-3))


@pytest.fixture(scope="module")
def bowed_photos(tmp_path_factory):
    folder = tmp_path_factory.mktemp("bowed") / "photos"
    write_folder(folder, of_bowed_panes, 6)
    source = read_photo_set(folder)
    return glass_rays(source, source.photos[:5]), source.panels, glass_rays(source, source.photos[5:])


@pytest.mark.long
def test_panes_stay_bowed_where_photos_show_that_they_are(bowed_photos):
    found = training(bowed_photos, config=BOWED)
    found.run(None, 1)
    (decision,) = found.decisions()
    assert decision.on
    assert decision.decided_by == "scene"
    # Normals lean along the lower edge, eastwards at its end, and up the left one.
    assert (found.panels.light.bows.detach().median(dim=0).values > 0.2 * BOW).all()
    flat = training(bowed_photos, config=replace(BOWED, bows="off"))
    flat.run(None, 1)
    errors = [mean_square_error(each.panels, bowed_photos[2]) for each in (found, flat)]
    assert errors[0] < 0.5 * errors[1]


def test_panes_are_flat_where_bows_move_little_and_go_on_so_bit_by_bit(photos, monkeypatch):
    monkeypatch.setattr(light_training, "decide", lambda effect, scene, setting: decide(effect, scene, setting, 1e9))
    config = replace(CONFIG, learned=None)
    found = training(photos, config=config)
    while found.at.bowed_px == UNKNOWN:
        found.step()
    found.step()
    again = training(photos, config=config)
    again.restore(found.state())
    for each in (found, again):
        each.step()
        assert each.panels.light.bows is None
        assert not each.panels.light.learned.bows
        assert not each.decisions()[0].on
    assert_same(found.panels, again.panels)


@pytest.mark.parametrize(("setting", "are_bowed"), [("on", True), ("off", False)])
def test_bows_are_as_the_user_says(photos, setting, are_bowed):
    found = training(photos, config=replace(CONFIG, learned=None, bows=setting))
    found.run(None, 1)
    assert (found.panels.light.bows is not None) == are_bowed
    (decision,) = found.decisions()
    assert (decision.on, decision.decided_by) == (are_bowed, "user")


def test_other_lights_have_no_bows_to_decide_about(photos):
    found = training(photos, "environment-map", replace(CONFIG, learned=None))
    found.run(None, 1)
    assert found.decisions() == ()

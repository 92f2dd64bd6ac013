"""Models on the disk: read back the same, refused where they are not what they say, never half-written."""

import json
import shutil
from dataclasses import replace

import numpy as np
import pytest
import torch
from safetensors.torch import load_file, save_file

from planning.base.errors import InputError
from reconstruction.light.config import GridSettings, ReflectionConfig
from reconstruction.light.photo_set import read_photo_set
from reconstruction.light.reflection_mlp import MlpShape
from reconstruction.splats.ply import read_splats
from reconstruction.training.config import TrainConfig
from reconstruction.training.model.record import site_record
from reconstruction.training.model.saved import FORMAT, read_model, save_model
from reconstruction.training.photos.photo_stream import PhotoStream
from reconstruction.training.train import resume_model, train_model

TINY = ReflectionConfig(
    mlp=MlpShape(width=16, layers=4, position_order=3, direction_order=2),
    environment_rows=8,
    steps=6,
    batch=256,
    grid=GridSettings(most_cells=2000, far_side=8, rest=4),
)
CONFIG = TrainConfig(iterations=5, n_splats=120, max_splats=200, reflections=TINY, score_every_s=1e9)


@pytest.fixture(scope="module")
def trained(data_set):
    return train_model(data_set, replace(CONFIG, light="environment-map"))


@pytest.fixture
def saved(trained, tmp_path):
    save_model(trained, tmp_path / "model")
    return tmp_path / "model"


def pictures(trained, data_set):
    source = read_photo_set(data_set)
    with PhotoStream(source, None, trained.model.origin_enu_m) as photos, torch.no_grad():
        return [trained.model(photos.frame(number).view).display for number in range(2)]


@pytest.mark.long
@pytest.mark.few(2)
@pytest.mark.parametrize("light", ["harmonics", "environment-map", "mlp", "radiance-grid"])
def test_models_are_read_back_bit_by_bit(data_set, tmp_path, light):
    trained = train_model(data_set, replace(CONFIG, light=light))
    save_model(trained, tmp_path / "m")
    back = read_model(tmp_path / "m")
    assert back.record == trained.record
    assert (back.record.light is None) == (light == "harmonics")
    assert (back.history, back.n_steps, back.seconds) == (trained.history, trained.n_steps, trained.seconds)
    for one, other in zip(pictures(trained, data_set), pictures(back, data_set), strict=True):
        assert torch.equal(one, other)
    assert torch.equal(trained.exposures.log_gains, back.exposures.log_gains)


@pytest.mark.slow
def test_auto_light_is_chosen_by_trial_and_says_why(data_set):
    trained = train_model(data_set, replace(CONFIG, light="auto", iterations=1))
    by_effect = {decision.effect: decision.on for decision in trained.record.decisions}
    assert {"overexposed photos", "near-field light", "mirrored surroundings"} <= by_effect.keys()
    name = "harmonics" if trained.record.light is None else trained.record.light.name
    # Where the gain is clear, nobody asks whether light apart is worth it.
    expected = "environment-map" if by_effect["mirrored surroundings"] else "harmonics"
    expected = "radiance-grid" if by_effect["near-field light"] else expected
    assert name == (expected if by_effect.get("light apart from the splats", True) else "harmonics")


def test_splats_for_viewers_lie_beside_it(saved, trained):
    found = read_splats(saved / "splats.ply")
    assert torch.equal(found.splats.means, trained.model.splats.means)


def test_the_record_knows_the_site(saved, data_set):
    content = json.loads((saved / "model.json").read_text())
    assert content["format"] == FORMAT
    assert content["method"] == "reflight"
    assert read_model(saved).record.site == site_record(data_set)
    assert sorted({*content["learned"], *content["held_out"]}) == [f"p{k:02d}.png" for k in range(8)]


def test_models_of_before_antialiasing_are_drawn_as_they_were_learned(saved, trained):
    assert trained.record.config.raster.antialiased
    assert read_model(saved).record.config.raster.antialiased
    changed(saved, lambda content: content["config"]["raster"].pop("antialiased"))
    assert not read_model(saved).record.config.raster.antialiased


def test_a_model_that_is_written_over_stays_whole_until_the_end(saved, trained, monkeypatch):
    with torch.no_grad():
        other = replace(trained, n_steps=99)
        other.model.corner_loss.add_(0.01)
    monkeypatch.setattr(
        "reconstruction.training.model.saved.json.dumps", lambda *_, **__: (_ for _ in ()).throw(KeyboardInterrupt())
    )
    with pytest.raises(KeyboardInterrupt):
        save_model(other, saved)
    monkeypatch.undo()
    assert read_model(saved).n_steps == trained.n_steps
    save_model(other, saved)
    assert read_model(saved).n_steps == 99
    assert len(list(saved.glob("weights-*"))) == 1


def changed(saved, change):
    path = saved / "model.json"
    content = json.loads(path.read_text())
    change(content)
    path.write_text(json.dumps(content))


def reweighted(saved, change):
    """Weights changed, and the description made to fit."""
    import hashlib

    path = next(saved.glob("weights-*"))
    tensors = load_file(path)
    change(tensors)
    save_file(tensors, path)
    changed(saved, lambda content: content["weights"].update(sha256=hashlib.sha256(path.read_bytes()).hexdigest()))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda c: c.update(format="reflight-plan/1"), "is it the right file"),
        (lambda c: c.pop("site"), "missing required field 'site'"),
        (lambda c: c["weights"].update(file="../weights.safetensors"), "expected the name of a file beside it"),
        (lambda c: c["weights"].update(file=""), "expected the name of a file beside it"),
        (lambda c: c["weights"].update(sha256="0"), "was it changed or cut off"),
        (lambda c: c["light"].update(name="mlp"), "weights of another model"),
        (lambda c: c["light"].update(name="nerf"), "weights of another model"),
        (lambda c: c["config"]["reflections"].update(environment_rows=1 << 20), "at most 4096"),
        (lambda c: c["light"].update(name="radiance-grid", box=None), "weights of another model"),
        (lambda c: c.update(corner_square=0.0), "corner_square: expected more than 0"),
        (lambda c: c["site"].update(panels=[]), "has splats on panel 6 of 0"),
        (lambda c: c["learned"].append("more.png"), "weights of another model"),
    ],
)
def test_descriptions_that_do_not_fit_are_refused(saved, change, message):
    changed(saved, change)
    with pytest.raises(InputError, match=message):
        read_model(saved)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t: t["splats.means"].fill_(float("nan")), "not finite"),
        (lambda t: t["corner_loss"].fill_(float("inf")), "not finite"),
        (lambda t: t.pop("splats.sh"), "has no 'sh'"),
        (lambda t: t.pop("sky.map.mean", None) or t.pop("corner_loss"), "weights of another model"),
        (lambda t: t["splats.panels"].fill_(600), "on panel 601 of 6"),
        (lambda t: t.update({"splats.means": t["splats.means"][:-1].contiguous()}), "expected shape"),
    ],
)
def test_weights_that_do_not_fit_are_refused(saved, change, message):
    reweighted(saved, change)
    with pytest.raises(InputError, match=message):
        read_model(saved)


def test_pickles_are_not_opened(saved, tmp_path):
    path = next(saved.glob("weights-*"))
    torch.save({"splats.means": torch.zeros(1)}, path)
    with pytest.raises(InputError, match="is no safetensors file, or damaged"):
        read_model(saved)


def test_folders_without_a_model_are_refused(tmp_path, data_set):
    with pytest.raises(InputError, match="holds no finished model"):
        read_model(data_set)
    (tmp_path / "checkpoint.safetensors").write_bytes(b"")
    with pytest.raises(InputError, match="resume its training"):
        read_model(tmp_path)
    with pytest.raises(InputError, match=r"is no safetensors file, or damaged.*begin the training anew"):
        resume_model(data_set, tmp_path / "checkpoint.safetensors")


def test_a_checkpoint_of_other_photos_is_refused(data_set, tmp_path):
    other = tmp_path / "other"
    shutil.copytree(data_set, other)
    content = json.loads((other / "dataset.json").read_text())
    corners = np.array(content["panels"][0]["corners_enu_m"]) + 0.25
    content["panels"][0]["corners_enu_m"] = corners.tolist()
    (other / "dataset.json").write_text(json.dumps(content))
    train_model(data_set, replace(CONFIG, method="2dgs", iterations=1), checkpoint=tmp_path / "c")
    with pytest.raises(InputError, match="shows other panels"):
        resume_model(other, tmp_path / "c")


def test_a_device_that_is_not_there_is_refused(data_set, monkeypatch):
    monkeypatch.setattr(torch.cuda, "is_available", lambda: False)
    with pytest.raises(InputError, match="finds no CUDA device"):
        train_model(data_set, replace(CONFIG, device="cuda"))


@pytest.mark.skipif(not torch.cuda.is_available(), reason="needs a CUDA device")
@pytest.mark.parametrize("light", ["environment-map", "mlp", "radiance-grid"])
def test_on_cuda_a_model_is_trained_that_renders_on_a_processor(data_set, light):
    pytest.importorskip("gsplat")
    trained = train_model(data_set, replace(CONFIG, light=light, device="cuda", iterations=30))
    assert trained.history[-1].value > trained.history[0].value
    assert all(torch.isfinite(picture).all() for picture in pictures(trained, data_set))

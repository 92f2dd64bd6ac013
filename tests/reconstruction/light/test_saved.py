"""Trained reflections come back from the disk bit by bit; damaged files are refused by name."""

import json
import struct

import numpy as np
import pytest
import torch
from safetensors.numpy import load_file, save_file

from planning.base.errors import InputError
from reconstruction.light.config import PAPER_STAGES, GridSettings, ReflectionConfig
from reconstruction.light.glass_rays import glass_rays
from reconstruction.light.photo_set import read_photo_set
from reconstruction.light.reflection_mlp import MlpShape
from reconstruction.light.saved import DESCRIPTION, WEIGHTS, read_reflections, save_reflections
from reconstruction.light.training import train_reflections
from tests.reconstruction.light.made_folder import far, write_folder

SMALL = ReflectionConfig(
    mlp=MlpShape(16, 3, 2, 2, staged=False),
    environment_rows=8,
    grid=GridSettings(most_cells=512, levels=1, far_side=8),
    steps=5,
    batch=64,
    precision="float32",
    high_frequency=PAPER_STAGES,
)


@pytest.fixture(scope="module")
def rays(tmp_path_factory):
    """Of a few photos, and the panels."""
    folder = tmp_path_factory.mktemp("saved") / "photos"
    write_folder(folder, far, 2)
    source = read_photo_set(folder)
    return glass_rays(source, source.photos), source.panels


@pytest.fixture
def saved(rays, tmp_path):
    """A model in a folder."""
    save_reflections(train_reflections(*rays, "mlp", SMALL, 0.7, rays[0]), tmp_path / "model")
    return tmp_path / "model"


@pytest.mark.parametrize("model", ["mlp", "environment-map", "harmonics", "radiance-grid"])
def test_what_comes_back_tells_the_same_colours_and_the_same_of_itself(rays, tmp_path, model):
    trained = train_reflections(*rays, model, SMALL, 0.7, rays[0])
    save_reflections(trained, tmp_path / "new" / "model")
    again = read_reflections(tmp_path / "new" / "model")
    with torch.no_grad():
        assert torch.equal(again.panels(rays[0]), trained.panels(rays[0]))
    assert np.array_equal(again.planes.corners_enu_m, trained.planes.corners_enu_m)
    for name in ("model", "config", "exposure", "precision", "n_rays", "n_steps", "seconds", "history", "health"):
        assert getattr(again, name) == getattr(trained, name)


@pytest.mark.parametrize("key", ["model", "config", "corners_enu_m", "precision"])
def test_descriptions_without_a_field_or_with_nonsense_are_refused(saved, key):
    path = saved / DESCRIPTION
    content = json.loads(path.read_text())
    for changed in ({k: v for k, v in content.items() if k != key}, {**content, key: "nonsense"}):
        path.write_text(json.dumps(changed))
        with pytest.raises(InputError, match=key):
            read_reflections(saved)


def test_weights_of_another_model_are_refused(saved):
    path = saved / DESCRIPTION
    content = json.loads(path.read_text())
    content["config"]["mlp"]["width"] = 17
    path.write_text(json.dumps(content))
    with pytest.raises(InputError, match="another model"):
        read_reflections(saved)


def test_weights_that_are_no_numbers_are_refused(saved):
    weights = load_file(saved / WEIGHTS)
    weights["corner_loss"] = np.array(np.nan, np.float32)
    save_file(weights, saved / WEIGHTS)
    with pytest.raises(InputError, match="not finite"):
        read_reflections(saved)


def file_of(header, numbers=b""):
    text = header if isinstance(header, bytes) else json.dumps(header).encode()
    return struct.pack("<Q", len(text)) + text + numbers


GOOD = {"dtype": "F32", "shape": [2], "data_offsets": [0, 8]}


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"1234",
        struct.pack("<Q", 2**63),
        file_of(b"{"),
        file_of([]),
        file_of({"a": 3}),
        file_of({"a": {**GOOD, "dtype": "F16"}}, bytes(8)),
        file_of({"a": {**GOOD, "shape": [-2]}}, bytes(8)),
        file_of({"a": {**GOOD, "shape": [True, 2]}}, bytes(8)),
        file_of({"a": {**GOOD, "shape": [3]}}, bytes(8)),
        file_of({"a": {**GOOD, "data_offsets": [0, 2**60]}}, bytes(8)),
        file_of({"a": {**GOOD, "data_offsets": [8, 0]}}, bytes(8)),
        file_of({"a": GOOD}, bytes(4)),
        file_of({"a": GOOD}, bytes(12)),
        file_of({"a": GOOD, "b": GOOD}, bytes(8)),
    ],
)
def test_damaged_weights_are_refused(saved, content):
    (saved / WEIGHTS).write_bytes(content)
    with pytest.raises(InputError, match=r"reflections\.safetensors"):
        read_reflections(saved)


def test_weights_that_are_missing_are_refused(saved):
    (saved / WEIGHTS).unlink()
    with pytest.raises(InputError, match="cannot be read"):
        read_reflections(saved)


def test_grids_that_are_not_of_the_box_that_is_told_are_refused(rays, tmp_path):
    folder = tmp_path / "grid"
    save_reflections(train_reflections(*rays, "radiance-grid", SMALL), folder)
    path = folder / DESCRIPTION
    content = json.loads(path.read_text())
    for box in (
        None,
        {**content["box"], "counts": [10**6, 10**6, 10**6]},
        {**content["box"], "halves": [0.0, 1.0, 1.0]},
    ):
        path.write_text(json.dumps({**content, "box": box}))
        with pytest.raises(InputError, match="box"):
            read_reflections(folder)

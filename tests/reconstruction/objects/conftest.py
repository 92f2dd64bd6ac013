"""A trained model and its scene of objects, which several tests read."""

import pytest
import torch

from reconstruction.light.config import ReflectionConfig
from reconstruction.light.reflection_mlp import MlpShape
from reconstruction.objects.organise import organised
from reconstruction.training.config import TrainConfig
from reconstruction.training.train import train_model
from tests.reconstruction.training.synthetic_data_set import write_data_set

TINY = ReflectionConfig(MlpShape(width=16, layers=4, position_order=3, direction_order=2), steps=6, batch=256)
CONFIG = TrainConfig(iterations=3, n_splats=150, max_splats=200, reflections=TINY, score_every_s=1e9, light="mlp")


@pytest.fixture(scope="package", autouse=True)
def _one_thread():
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    yield
    torch.set_num_threads(before)


@pytest.fixture(scope="package")
def data_set(tmp_path_factory):
    folder = tmp_path_factory.mktemp("objects") / "glass"
    write_data_set(folder, n=4)
    return folder


@pytest.fixture(scope="package")
def trained(data_set):
    return train_model(data_set, CONFIG)


@pytest.fixture(scope="package")
def scene(trained):
    return organised(trained)

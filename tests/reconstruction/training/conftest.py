"""One thread for torch, and small data set folders that several tests read."""

import pytest
import torch

from tests.reconstruction.training.synthetic_data_set import write_data_set


@pytest.fixture(scope="package", autouse=True)
def _one_thread():
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    yield
    torch.set_num_threads(before)


@pytest.fixture(scope="package")
def data_set(tmp_path_factory):
    folder = tmp_path_factory.mktemp("modelling") / "glass"
    write_data_set(folder, n=8)
    return folder

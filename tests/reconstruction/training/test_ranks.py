"""Several processes that train one model: the same splats in all, from gradients of different photos."""

import json
import os
import socket
import subprocess
import sys
from pathlib import Path

import pytest
import torch

from planning.base.errors import InputError
from reconstruction.training.ranks import ALONE, ranks_of_environment

ROOT = Path(__file__).resolve().parents[3]

TRAIN = """
import hashlib, json, sys
from pathlib import Path
import torch
torch.set_num_threads(1)
from reconstruction.training.config import TrainConfig
from reconstruction.training.ranks import Ranks, ranks_of_environment
from reconstruction.training.train import train_model

folder, out, light = Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3]
from reconstruction.light.config import ReflectionConfig
tiny = ReflectionConfig(environment_rows=8, steps=4, batch=64)
config = TrainConfig(
    method="2dgs" if light == "none" else "refglass-gs", light="auto" if light == "none" else light, reflections=tiny,
    iterations=12, n_splats=150, max_splats=400, densification="mcmc", densify_from=0.0, score_every_s=1e9,
)
looked_at = []
from reconstruction.training import trainer
true = trainer.objective
trainer.objective = lambda picture, sample, *rest: looked_at.append(sample.number) or true(picture, sample, *rest)
with ranks_of_environment() as ranks:
    made = train_model(folder, config, checkpoint=out / "checkpoint", ranks=ranks)
    state = b"".join(value.detach().numpy().tobytes() for value in made.model.state_dict().values())
    found = {"sha": hashlib.sha256(state).hexdigest(), "photos": looked_at, "history": len(made.history)}
    (out / f"rank-{ranks.rank}.json").write_text(json.dumps(found))
"""


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def train_together(folder, out, n, light):
    environment = {**os.environ, "MASTER_ADDR": "127.0.0.1", "MASTER_PORT": str(free_port()), "WORLD_SIZE": str(n)}
    command = [sys.executable, "-c", TRAIN, str(folder), str(out), light]
    started = [
        subprocess.Popen(command, cwd=ROOT, env={**environment, "RANK": str(rank), "OMP_NUM_THREADS": "1"})
        for rank in range(n)
    ]
    assert [process.wait(timeout=240) for process in started] == [0] * n
    return [json.loads((out / f"rank-{rank}.json").read_text()) for rank in range(n)]


@pytest.mark.slow
@pytest.mark.parametrize("light", ["environment-map"])
def test_two_processes_look_at_other_photos_and_have_the_same_model(data_set, tmp_path, light):
    (tmp_path / "one").mkdir()
    (tmp_path / "two").mkdir()
    (alone,) = train_together(data_set, tmp_path / "one", 1, light)
    first, second = train_together(data_set, tmp_path / "two", 2, light)
    assert first["sha"] == second["sha"]
    assert first["sha"] != alone["sha"]
    assert len(first["photos"]) == len(second["photos"]) == 12
    assert first["photos"][0] == alone["photos"][0]
    # Dealt out in turns: of seven photos, the first three steps of both look at six.
    assert len({*first["photos"][:3], *second["photos"][:3]}) == 6
    assert (first["history"] > 0, second["history"]) == (True, 0)


def test_alone_nothing_is_exchanged():
    value = torch.ones(3, requires_grad=True)
    value.grad = torch.full((3,), 2.0)
    loss = torch.tensor(5.0)
    assert ALONE.average_gradients([value], loss) is loss
    assert (value.grad == 2.0).all()
    assert ALONE.gathered(loss) == [loss]
    assert ALONE.agreed([1.5, 0.0]) == [1.5, 0.0]


def test_processes_that_torchrun_did_not_start_are_refused(monkeypatch):
    monkeypatch.setenv("WORLD_SIZE", "2")
    monkeypatch.delenv("RANK", raising=False)
    with pytest.raises(InputError, match="torchrun"), ranks_of_environment():
        pass
    monkeypatch.setenv("WORLD_SIZE", "1")
    with ranks_of_environment() as ranks:
        assert ranks == ALONE

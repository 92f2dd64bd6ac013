"""The public API: its examples run, and its page names all of it and includes the examples."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import groundstation.api as api
from tests.reconstruction.training.synthetic_data_set import write_data_set

ROOT = Path(__file__).parents[1]
EXAMPLES = ROOT / "docs" / "reference" / "examples"
PAGE = (ROOT / "docs" / "reference" / "api.md").read_text("utf-8")
NAMES = (ROOT / "docs" / "reference" / "api-names.md").read_text("utf-8")


def run(name, folder):
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, "-W", "error", EXAMPLES / name], cwd=folder, env=environment, capture_output=True, text=True,
        check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.slow
def test_a_flight_is_planned_exported_and_simulated(tmp_path):
    assert run("plan.py", tmp_path).startswith("12 views cover ")
    assert "flight.kmz: 12 photos" in run("export.py", tmp_path)
    assert run("simulate.py", tmp_path).startswith("12 photos taken, ")


@pytest.mark.slow
def test_a_small_model_is_trained_and_exported(tmp_path):
    write_data_set(tmp_path / "dataset", n=8)
    assert "splats after 20 steps" in run("train.py", tmp_path)
    assert (tmp_path / "model.ply").stat().st_size > 0


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.py")), ids=lambda path: path.name)
def test_examples_are_short_and_the_page_shows_them(path):
    text = path.read_text("utf-8")
    assert len(text.splitlines()) <= 18
    assert f"```{{literalinclude}} examples/{path.name}\n" in PAGE


def test_the_page_names_everything_that_is_public():
    missing = [name for name in api.__all__ if f"`{name}`" not in NAMES]
    assert missing == []

"""A training that is stopped: what letting its rates fall gains, on the model at the stop, and on going on."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from reconstruction.light.photo_set import read_photo_set
from reconstruction.training.callbacks import Callbacks, TrainingSnapshot
from reconstruction.training.config import TrainConfig, config_of
from reconstruction.training.model.score import mean_of, score_views
from reconstruction.training.presets import preset
from reconstruction.training.timer import Timer
from reconstruction.training.train import train_model
from reconstruction.training.trainer import SHARE
from tests.benchmarks.experiments import rendered
from tests.benchmarks.harness import Benchmark, Context, Row

N_VIEWS, WIDTH_PX, STOPS = 40, 192, (150, 600)
QUICK_N_VIEWS, QUICK_WIDTH_PX, QUICK_STOPS = 10, 48, (40,)

LOST_DB = 0.1
"""That settling may be below going on, which another seed changes by as much."""


def measure(context: Context) -> Iterator[Row]:
    """Splats alone, stopped early: at the stop, settled, and after as many steps more as settling takes."""
    is_quick = context.is_quick
    n_views, width = (QUICK_N_VIEWS, QUICK_WIDTH_PX) if is_quick else (N_VIEWS, WIDTH_PX)
    config = config_of({"method": "2dgs"}, preset("smoke" if is_quick else "10min"), Path("stopping"))
    config = replace(config, time_limit_s=None, score_every_s=1e9, checkpoint_every_s=1e9)
    with tempfile.TemporaryDirectory() as place:
        folder = rendered("planar", Path(place) / "planar", n_views, width)
        for n in QUICK_STOPS if is_quick else STOPS:
            more = max(1, round(SHARE * n))
            at_stop, going_on = (stopped(folder, config, steps, 0.0) for steps in (n, n + more))
            settled = stopped(folder, config, n, 1.0)
            target = (f"at most {LOST_DB:g} dB below going on", settled >= going_on - LOST_DB)
            gained = f"{settled - at_stop:+.2f} dB on the model at the stop"
            yield Row("planar", f"stopped after {n} steps", round(at_stop, 2), "dB")
            yield Row("planar", f"{more} steps later", round(going_on, 2), "dB")
            yield Row("planar", f"cooled down for {more} steps", round(settled, 2), "dB", None, gained, *target)


def stopped(folder: Path, config: TrainConfig, n: int, step_s: float) -> float:
    """PSNR of facades of unseen views, dB, of a training that is stopped after `n` steps of so many seconds each.

    Steps of 0 seconds leave no time to settle in.
    """
    steps = [0]

    def visit(at: TrainingSnapshot) -> None:
        steps[0] = at.step

    watch = Timer(lambda: step_s * steps[0], 0.0)
    trained = train_model(folder, config, Callbacks(stop=lambda: steps[0] >= n, visit=visit), watch=watch)
    scores = score_views(trained, read_photo_set(folder), trained.record.held_out)
    return mean_of(score.facade.psnr_db for score in scores) or 0.0


BENCHMARK = Benchmark(
    "stopping",
    "A training that is stopped",
    f"Splats alone (`2dgs`, preset `10min`) on {N_VIEWS} rendered photos of {WIDTH_PX} x 144 pixels of the bundled "
    "planar scene, stopped early: the model as it is then, as it is after some steps more, and after as many in which "
    "its rates fall to their last. The clock counts a second for each step. PSNR of facades of all views held out.",
    measure,
)

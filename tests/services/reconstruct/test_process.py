"""The process of models: it trains, shows, waits, settles, breaks off and goes on, and tells what becomes of it.

It runs as any other here: behind all that tests do beside it, it would hardly run at all.
"""

import queue
import shutil
import signal

import numpy as np
import pytest

from groundstation.services.jobs.channel import ProcessEnded
from groundstation.services.reconstruct.folders import (
    CHECKPOINT,
    MODEL,
    noted_data_set,
    read_data_set,
    read_model_card,
    standing,
)
from groundstation.services.reconstruct.guided_camera import sized
from groundstation.services.reconstruct.messages import (
    CancelTraining,
    Devices,
    Ended,
    FirstLook,
    Measured,
    ModelProcess,
    Pause,
    PhotoError,
    Stepped,
    Stop,
    Subject,
    Train,
    ViewAnswer,
    ViewRequest,
    WatchErrors,
)
from planning.base.errors import InputError
from reconstruction.training.parameters import TrainRequest
from tests.reconstruction.training.synthetic_data_set import write_data_set

TRAINING = Subject("training")
PATIENCE_S = 240.0


class Heard:
    """The process, and what it has said."""

    def __init__(self):
        self.messages: queue.SimpleQueue = queue.SimpleQueue()
        self.process = ModelProcess(self.messages.put, 0)
        self.kept = []
        self.n_looks = 0

    def send(self, message):
        self.process.send(message)

    def until(self, kind, condition=lambda _message: True):
        """The first message of a kind for which a condition holds, from now on; all before it are kept."""
        while True:
            message = self.messages.get(timeout=PATIENCE_S)
            self.kept.append(message)
            assert not isinstance(message, ProcessEnded) or kind is ProcessEnded, message
            if isinstance(message, Ended) and kind is not Ended:
                raise AssertionError(message)
            if isinstance(message, kind) and condition(message):
                return message

    def seen(self, subject, photo, layer="picture", width_px=40):
        self.n_looks += 1
        camera = sized(photo, width_px, width_px)
        self.send(ViewRequest("left", self.n_looks, subject, camera, layer, photo.name))
        return self.until(ViewAnswer, lambda seen: seen.look.number == self.n_looks)


@pytest.fixture(scope="module")
def card(tmp_path_factory):
    folder = tmp_path_factory.mktemp("process") / "glass"
    write_data_set(folder, n=5)
    return read_data_set(folder)


@pytest.fixture(scope="module")
def heard():
    heard = Heard()
    yield heard
    heard.process.end()


@pytest.fixture(scope="module")
def settings(tmp_path_factory):
    path = tmp_path_factory.mktemp("settings") / "small.toml"
    path.write_text("n_splats = 150\nmax_splats = 200\nscore_every_s = 1e9\n")
    return path


@pytest.fixture
def asked(settings):
    return TrainRequest(method="2dgs", iterations=100_000, settings=settings)


@pytest.mark.long
def test_it_is_looked_at_while_it_trains_and_waits_and_its_end_is_a_model(heard, card, asked, tmp_path):
    out, photo = tmp_path / "model", card.source.photos[0]
    heard.send(Train(card.folder, out, asked))
    assert heard.until(Devices).cuda is not None
    early = heard.seen(Subject("photo", card.folder, photo.name), photo)
    assert early.picture.shape == (30, 40, 3)
    first = heard.until(Stepped, lambda stepped: stepped.step > 0)
    assert set(first.terms) >= {"colour"}
    heard.send(WatchErrors(TRAINING, card.folder))
    heard.send(Pause(True))
    waiting = heard.until(Stepped, lambda stepped: stepped.phase == "paused")
    picture = heard.seen(TRAINING, photo)
    assert np.abs(picture.picture.astype(int) - early.picture).mean() < 60
    depth = heard.seen(TRAINING, photo, "depth")
    assert depth.scale[0] < depth.depth_m < depth.scale[1] + 1.0
    # It is the same model all the while.
    again = heard.seen(TRAINING, photo)
    np.testing.assert_array_equal(picture.picture, again.picture)
    # While it waits, each photo is told of once.
    while len({message.name for message in heard.kept if isinstance(message, PhotoError)}) < len(card.source.photos):
        heard.until(PhotoError)
    heard.send(Pause(False))
    on = heard.until(Stepped, lambda stepped: stepped.phase == "training" and stepped.step > waiting.step)
    heard.send(Stop())
    heard.until(Stepped, lambda stepped: stepped.phase == "settling")
    ended = heard.until(Ended)
    assert ended.outcome == "done"
    assert ended.summary["iterations"] > on.step
    measured = [message for message in heard.kept if isinstance(message, Measured)]
    assert measured[-1].psnr_db == pytest.approx(ended.summary["history"][-1]["psnr_db"], abs=1e-3)
    assert ended.summary["scored_views"] > 0
    assert not (out / CHECKPOINT).exists()
    assert noted_data_set(out) == card.folder
    kept, finished = heard.seen(TRAINING, photo), heard.seen(Subject("model", out), photo)
    np.testing.assert_array_equal(kept.picture, finished.picture)
    assert read_model_card(out).n_steps == ended.summary["iterations"]


@pytest.mark.long
def test_what_it_begins_with_is_seen_before_the_first_step(heard, card, tmp_path):
    path, photo = tmp_path / "light.toml", card.source.photos[0]
    path.write_text('n_splats = 150\nmax_splats = 200\nlight = "environment-map"\n[reflections]\nsteps = 100000\n')
    n_before = len(heard.kept)
    heard.send(Train(card.folder, tmp_path / "model", TrainRequest(iterations=10, settings=path)))
    heard.until(FirstLook)
    told = heard.seen(Subject("photo", card.folder, photo.name), photo).picture.astype(int)
    placed = heard.seen(TRAINING, photo).picture
    assert np.abs(placed - told).mean() < 60
    heard.send(CancelTraining())
    assert heard.until(Ended).outcome == "kept"
    assert not any(isinstance(message, Stepped) for message in heard.kept[n_before:])


@pytest.mark.slow
def test_broken_off_it_can_be_gone_on_with(heard, card, asked, tmp_path):
    out = tmp_path / "model"
    heard.send(Train(card.folder, out, asked))
    reached = heard.until(Stepped, lambda stepped: stepped.step > 3)
    heard.send(CancelTraining())
    assert heard.until(Ended).outcome == "kept"
    assert standing(out).is_interrupted
    heard.send(Train(card.folder, out, asked, resume=True))
    assert heard.until(Stepped).step >= reached.step
    heard.send(Stop())
    assert heard.until(Ended).outcome == "done"
    assert standing(out).has_model


@pytest.mark.slow
def test_what_cannot_be_is_said_and_it_goes_on_working(heard, card, asked, tmp_path):
    photo = card.source.photos[0]
    heard.send(Train(tmp_path / "nothing", tmp_path / "model", asked))
    ended = heard.until(Ended)
    assert ended.outcome == "failed"
    assert isinstance(ended.error, InputError)
    assert "has no dataset.json" in str(ended.error)
    (tmp_path / "model" / MODEL).write_text('{"format": "reflight-model/1"')
    seen = heard.seen(Subject("model", tmp_path / "model"), photo)
    assert seen.picture is None
    assert "not valid JSON" in seen.problem
    assert "no photo 'none.png'" in heard.seen(Subject("photo", card.folder, "none.png"), photo).problem
    assert heard.seen(TRAINING, photo).problem == "there is no model yet: it is being prepared"
    shutil.copytree(card.folder, tmp_path / "copy")
    damaged = tmp_path / "copy" / "images" / photo.name
    damaged.write_bytes(damaged.read_bytes()[:20])
    assert "cannot be decoded" in heard.seen(Subject("photo", tmp_path / "copy", photo.name), photo).problem


@pytest.mark.slow
def test_a_process_that_is_ended_is_told_and_another_one_takes_its_place(heard, card):
    photo = card.source.photos[0]
    heard.seen(Subject("photo", card.folder, photo.name), photo)
    heard.process._process._child.send_signal(signal.SIGKILL)
    assert heard.until(ProcessEnded).status == -signal.SIGKILL
    assert heard.seen(Subject("photo", card.folder, photo.name), photo).picture is not None


@pytest.mark.slow
def test_when_the_window_has_gone_a_training_keeps_its_state_and_the_process_ends(card, asked, tmp_path):
    heard, out = Heard(), tmp_path / "model"
    heard.send(Train(card.folder, out, asked))
    heard.until(Stepped, lambda stepped: stepped.step > 2)
    process = heard.process._process._child
    heard.process.close()
    assert process.wait(PATIENCE_S) == 0
    assert standing(out).is_interrupted
    heard.send(CancelTraining())
    assert not heard.process.is_running

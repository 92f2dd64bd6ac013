"""Transients while splats are learned: seen by windows, settled by the scene or the user, left out of the loss."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from reconstruction.light.transients import LEAST_ERROR, TRIED, UNSEEN
from reconstruction.splats.rasterising.views import View
from reconstruction.training.config import LossWeights
from reconstruction.training.model.joint_model import Picture
from reconstruction.training.photos.photo_stream import Sample
from reconstruction.training.photos.transients import Transients
from reconstruction.training.trainer import objective

WIDTH, HEIGHT, N_PHOTOS = 64, 48, 8


def sample_of(number, display, window=(0, 0, WIDTH, HEIGHT)):
    x, y, width, height = window
    matrix = torch.eye(4, dtype=torch.float64)
    matrix[0, 3] = 0.01 * number
    view = View(WIDTH, HEIGHT, 60.0, 60.0, WIDTH / 2, HEIGHT / 2, matrix).cropped(x, y, width, height)
    nothing = torch.zeros(height, width)
    return Sample(
        number, view, display[y : y + height, x : x + width], nothing > 1, nothing.int() - 1, None, None, x, y
    )


def displays(persons):
    """The same grey wall in all photos, with somebody in some of them, each elsewhere."""
    found = torch.full((N_PHOTOS, HEIGHT, WIDTH, 3), 120, dtype=torch.uint8)
    for number in persons:
        found[number, 8:40, 8 * number : 8 * number + 16] = 30
    return found


def looked_at(persons, setting, window=(0, 0, WIDTH, HEIGHT)):
    transients, shown = Transients([(WIDTH, HEIGHT)] * N_PHOTOS), torch.full((HEIGHT, WIDTH, 3), 120 / 255)
    x, y, width, height = window
    samples = [sample_of(number, display, window) for number, display in enumerate(displays(persons))]
    for _ in range(3):
        for sample in samples:
            transients.see(sample, shown[y : y + height, x : x + width], torch.full((height, width), 5.0), TRIED - 0.1)
    transients.settle(setting, TRIED - 0.01)
    assert float(transients.share) == UNSEEN
    transients.settle(setting, TRIED)
    return transients, samples


def test_somebody_in_one_photo_is_left_out_of_it_and_of_no_other():
    transients, samples = looked_at([3], "on")
    for sample in samples:
        lasting = transients.lasting(sample)
        assert bool(lasting[8:40, 24:40].any()) is (sample.number != 3)
        assert bool(lasting[:, :16].all())
    assert float(transients.share) == 0.0  # one photo alone is no evidence


def test_windows_see_and_are_seen_as_the_whole_photo_is():
    window = (5, 3, 50, 44)
    transients, samples = looked_at([3], "on", window)
    lasting = transients.lasting(samples[3])
    assert lasting.shape == (44, 50)
    assert not lasting[8 - 3 : 40 - 3, 24 - 5 : 40 - 5].any()
    assert lasting[:, : 16 - 5].all()


@pytest.mark.parametrize(("persons", "is_on"), [([], False), ([3], False), ([0, 2, 4, 6], True)])
def test_they_are_left_out_where_they_are_enough_to_be_worth_it(persons, is_on):
    transients, samples = looked_at(persons, "auto")
    decision = transients.decision("auto", 100.0)
    assert decision.on is is_on
    assert transients.are_looked_for("auto") is is_on
    assert all((transients.lasting(sample) is None) is not is_on for sample in samples)


@pytest.mark.parametrize(("persons", "is_on"), [([], False), (range(N_PHOTOS), True)])
def test_what_was_seen_of_a_model_that_had_hardly_begun_is_no_evidence(persons, is_on):
    transients, rng = Transients([(WIDTH, HEIGHT)] * N_PHOTOS), np.random.default_rng(0)
    truth = displays(persons)
    progresses = np.linspace(0.0, TRIED, 401)
    for progress in progresses:
        # Windows of a sixteenth, as trainings look at large photos, of a model that is darker the less it has learned.
        number, x, y = int(rng.integers(N_PHOTOS)), int(rng.integers(49)), int(rng.integers(37))
        shown = torch.full((12, 16, 3), 120 / 255 * (1.0 - np.exp(-20.0 * progress)))
        transients.see(
            sample_of(number, truth[number], (x, y, 16, 12)), shown, torch.full((12, 16), 5.0), float(progress)
        )
    transients.settle("auto", TRIED)
    assert transients.decision("auto", 100.0).on is is_on
    assert (float(transients.share) > 0.05) is is_on


def test_a_block_that_comes_up_again_after_long_has_the_error_of_then_and_stays_left_out_until_it_does():
    transients, sample = Transients([(WIDTH, HEIGHT)] * N_PHOTOS), sample_of(0, displays([])[0])
    depths = torch.full((HEIGHT, WIDTH), 5.0)
    for level, progress in ((0.0, 0.01), (120 / 255, TRIED)):
        transients.see(sample, torch.full((HEIGHT, WIDTH, 3), level), depths, progress)
    assert float(transients.errors[:48].max()) < LEAST_ERROR
    transients.left_out[3] = True
    transients.settle("on", 0.95)  # at which all was seen long ago
    assert bool(transients.left_out[3])
    transients.see(sample, torch.full((HEIGHT, WIDTH, 3), 120 / 255), depths, 0.95)
    for _ in range(2 * N_PHOTOS - 3):  # until all is settled again
        transients.see(sample, torch.full((HEIGHT, WIDTH, 3), 120 / 255), depths, 0.96)
    transients.settle("on", 0.96)
    assert not bool(transients.left_out[3])


def test_nothing_is_too_bright_for_a_photo_that_is_overexposed():
    transients, white = Transients([(WIDTH, HEIGHT)] * N_PHOTOS, white=0.9), torch.full((HEIGHT, WIDTH, 3), 255)
    for number in range(N_PHOTOS):
        brighter = torch.full((HEIGHT, WIDTH, 3), 1.0 + 0.5 * (number % 2))
        transients.see(sample_of(number, white.to(torch.uint8)), brighter, torch.full((HEIGHT, WIDTH), 5.0), TRIED)
    assert not transients.errors.any()


def test_who_wants_none_left_out_has_none():
    transients, samples = looked_at([0, 2, 4, 6], "off")
    assert float(transients.share) == UNSEEN
    assert transients.lasting(samples[0]) is None
    assert not transients.decision("off", 1.0).on


def test_what_learning_light_found_holds_until_splats_say_otherwise():
    known = np.zeros(48 * N_PHOTOS, bool)
    known[5] = True
    transients = Transients([(WIDTH, HEIGHT)] * N_PHOTOS, known)
    sample = sample_of(0, displays([])[0])
    assert not transients.lasting(sample)[:8, 40:48].any()
    transients.see(sample, torch.full((HEIGHT, WIDTH, 3), 120 / 255), torch.full((HEIGHT, WIDTH), 5.0), 1.0)
    transients.settle("auto", 1.0)
    assert transients.lasting(sample) is None
    assert not Transients([(WIDTH, HEIGHT)], known).left_out.any()  # of photos of another size


def test_its_state_goes_on_bit_by_bit():
    transients, _ = looked_at([0, 2, 4, 6], "auto")
    other = Transients([(WIDTH, HEIGHT)] * N_PHOTOS)
    other.load_state_dict(transients.state_dict())
    assert all(torch.equal(value, other.state_dict()[name]) for name, value in transients.state_dict().items())
    assert other.are_looked_for("auto")


def test_what_is_left_out_has_no_gradient():
    transients, samples = looked_at([0, 2, 4, 6], "auto")
    sample = samples[0]
    display = torch.full((HEIGHT, WIDTH, 3), 0.5, requires_grad=True)
    still = torch.zeros(HEIGHT, WIDTH)
    picture = Picture(display, *[still[..., None].expand(-1, -1, 3)] * 4, still, still, still.int(), None)
    weights = LossWeights(normal_consistency=0.0, dssim=0.0, high_frequency=())
    picture = replace(picture, raster=_Flat(still))
    loss, _ = objective(picture, replace(sample, shown=transients.lasting(sample)), weights, 0.5, False)
    loss.backward()
    assert not display.grad[8:40, :16].any()
    assert display.grad[:, 32:].all()


class _Flat:
    """A raster that only says that there is one."""

    def __init__(self, still):
        self.depths = self.alphas = still

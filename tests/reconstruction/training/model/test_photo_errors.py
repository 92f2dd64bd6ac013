"""How well single photos are shown: the same as a score says, in turn, and whatever becomes of a file."""

import shutil

import numpy as np
import pytest
import torch

from reconstruction.light.photo_set import read_photo_set
from reconstruction.metrics.image_metrics import score_picture
from reconstruction.splats.rasterising.raster_types import RasterSettings
from reconstruction.training.config import TrainConfig
from reconstruction.training.model.render import LEAST_LIGHT, OF_PICTURE, PhotoErrors, render_view
from reconstruction.training.photos.photo_stream import PhotoStream
from reconstruction.training.start import start_model

CONFIG = TrainConfig(method="2dgs", n_splats=150, max_splats=200)


@pytest.fixture(scope="module")
def model(data_set):
    return start_model(read_photo_set(data_set), CONFIG).model.eval()


def test_they_are_what_scores_say_of_each_photo_in_turn(data_set, model):
    source = read_photo_set(data_set)
    errors = PhotoErrors(source, source.photos)
    gains = {source.photos[1].name: torch.tensor([0.5])}
    found = [errors.next_db(model, gains, RasterSettings()) for _ in range(len(source.photos) + 1)]
    errors.close()
    assert [name for name, _ in found] == [*(photo.name for photo in source.photos), source.photos[0].name]
    assert found[-1][1] == found[0][1]
    with PhotoStream(source, None, model.origin_enu_m) as stream:
        for number in (0, 1):
            sample = stream.frame(number)
            picture = render_view(model, sample.view, (), gains.get(source.photos[number].name, 1.0)).display
            score = score_picture(picture, sample.display.numpy(), sample.facade.numpy())
            assert found[number][1] == pytest.approx(score.psnr_db, abs=1e-3)


def test_a_photo_that_cannot_be_read_is_passed_over(data_set, model, tmp_path):
    shutil.copytree(data_set, tmp_path / "data")
    source = read_photo_set(tmp_path / "data")
    source.photos[0].path.unlink()
    errors = PhotoErrors(source, source.photos[:2])
    assert errors.next_db(model, {}, RasterSettings()) is None
    assert errors.next_db(model, {}, RasterSettings())[0] == source.photos[1].name
    errors.close()
    assert errors.next_db(model, {}, RasterSettings()) is None
    assert PhotoErrors(source, ()).next_db(model, {}, RasterSettings()) is None


class Shaded:
    """The part of a picture that the share of reflected light is told from."""

    def __init__(self, reflectivity, fresnel, mirrored):
        self.reflectivity, self.mirrored = reflectivity, mirrored
        self.reflection = reflectivity[..., None] * fresnel * mirrored


@pytest.mark.parametrize("dtype", [torch.float32, torch.float64])
def test_the_share_of_reflected_light_is_told_from_what_is_mirrored(dtype):
    generator = torch.Generator().manual_seed(0)
    reflectivity = torch.rand(20, 30, generator=generator, dtype=dtype)
    mirrored = 3.0 * torch.rand(20, 30, 3, generator=generator, dtype=dtype)
    share = 0.04 + 0.96 * torch.rand(20, 30, 1, generator=generator, dtype=dtype)
    reflectivity[0], mirrored[1] = 0.0, 0.0
    mirrored[2] = torch.finfo(dtype).tiny
    found = OF_PICTURE["fresnel"](Shaded(reflectivity, share.expand(-1, -1, 3), mirrored))
    assert bool(torch.isfinite(found).all())
    assert bool((found[:3] == 0.0).all())
    is_told = reflectivity * mirrored.sum(dim=-1) > LEAST_LIGHT
    np.testing.assert_allclose(found[is_told], share[..., 0][is_told], rtol=1e-5)
    # Of glass that reflects colours by different shares it is the mean by their light.
    tinted = OF_PICTURE["fresnel"](
        Shaded(torch.ones(1, 1), torch.tensor([[[0.1, 0.3, 0.8]]]), torch.tensor([[[1.0, 1.0, 2.0]]]))
    )
    assert tinted.item() == pytest.approx((0.1 + 0.3 + 1.6) / 4.0)

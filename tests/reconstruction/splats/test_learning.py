"""The whole chain, splats to pictures and back: does it learn?"""

import math

import torch

from tests.reconstruction.splats.learned_scenes import picture_of, random_splats, train, truths_of, views_around


def psnr_db(splats, views, truths):
    with torch.no_grad():
        found = [picture_of(splats, view).features[..., :3] for view in views]
    return -10.0 * math.log10(
        sum(float((a - b).square().mean()) for a, b in zip(found, truths, strict=True)) / len(views)
    )


def test_a_hundred_shaken_splats_learn_their_pictures_again_and_unseen_ones_too():
    views, unseen = views_around(6), views_around(5)[1:2]
    splats = random_splats(100, seed=1)
    truths, others = truths_of(splats, views), truths_of(splats, unseen)
    generator = torch.Generator().manual_seed(5)
    shaken = {"means": 0.06, "quats": 0.1, "log_scales": 0.2, "opacity_logits": 0.3}
    with torch.no_grad():
        for name, by in shaken.items():
            value = getattr(splats, name)
            value += by * torch.randn(value.shape, generator=generator)
        splats.sh[:, 0] += torch.randn(100, 3, generator=generator)
    assert psnr_db(splats, views, truths) < 20.0
    train(splats, views, truths, 80)
    assert psnr_db(splats, views, truths) > 33.0
    assert psnr_db(splats, unseen, others) > 30.0

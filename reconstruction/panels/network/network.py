"""The network for panes: which places of a picture are glass of a pane, and where the corners of that pane lie.

A small convolutional network that narrows the picture to a 32nd and widens it again to a quarter (a U-Net); each place
of the result tells one logit, that it lies on a pane, and where it takes the pane's four corners to be. That every
place of a pane says where its corners are, lets panes be told apart between which no frame is seen, and panes be whole
that a tree stands before: `votes.py` lets them vote.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources

import numpy as np
import torch
from numpy.typing import NDArray
from safetensors.torch import load
from torch import Tensor, nn
from torch.nn import functional

from reconstruction.panels.network.votes import STRIDE, Picture, places_px

OFFSET_PX = 32.0
"""The network tells offsets in units of so many pixels."""

MULTIPLE_PX = 32
"""Pictures are padded to a multiple of it."""


@dataclass(frozen=True, slots=True)
class Shape:
    """How large the network is.

    Parameters
    ----------
    widths
        Channels at a half, a quarter, ... a 32nd of the picture.
    fine
        Channels at a quarter of the picture on the way back.
    residuals
        Pairs of convolutions that are added, at an 8th, a 16th and a 32nd.
    """

    widths: tuple[int, ...] = (16, 32, 64, 96, 128)
    fine: int = 40
    residuals: tuple[int, int, int] = (0, 1, 2)

    @classmethod
    def of(cls, weights: Mapping[str, Tensor]) -> Shape:
        """The shape of stored weights."""
        levels = range(5)
        widths = [next(v for k, v in weights.items() if k.startswith(f"down.{i}.") and v.dim() == 4) for i in levels]
        inner = [key.split(".") for key in weights if ".body." in key]
        body = [{key[2] for key in inner if key[1] == str(i)} for i in levels]
        return cls(
            tuple(len(each) for each in widths),
            weights["head.weight"].shape[1],
            (len(body[2]), len(body[3]), len(body[4])),
        )


SMALL, LARGE = Shape(), Shape((16, 40, 96, 160, 208), 48, (1, 2, 2))
"""Shapes that are trained: the second has three times the weights and takes twice as long."""

WEIGHTS = "panes.safetensors"


def _convolution(n_in: int, n_out: int, stride: int = 1) -> nn.Sequential:
    return nn.Sequential(nn.Conv2d(n_in, n_out, 3, stride, 1, bias=False), nn.BatchNorm2d(n_out), nn.ReLU(inplace=True))


class _Residual(nn.Module):
    """Two convolutions whose result is added to what they are given."""

    def __init__(self, n: int) -> None:
        super().__init__()
        self.body = nn.Sequential(_convolution(n, n), nn.Conv2d(n, n, 3, 1, 1, bias=False), nn.BatchNorm2d(n))

    def forward(self, x: Tensor) -> Tensor:
        """Of the same shape."""
        return functional.relu(x + self.body(x))


class PaneNetwork(nn.Module):
    """From pictures, shape (n, 3, h, w), -1 to 1, sides multiples of 32, to (n, 9, h / 4, w / 4).

    Channel 0 is the logit that a place lies on a pane; 1 to 8 are x and y of the lower left, lower right, upper right
    and upper left corner from the place, in units of `OFFSET_PX`.
    """

    def __init__(self, shape: Shape = SMALL) -> None:
        super().__init__()
        (a, b, c, d, e), fine = shape.widths, shape.fine
        at_8th, at_16th, at_32nd = shape.residuals
        self.down = nn.ModuleList(
            [
                _convolution(3, a, 2),
                nn.Sequential(_convolution(a, b, 2), _convolution(b, b)),
                nn.Sequential(_convolution(b, c, 2), _convolution(c, c), *(_Residual(c) for _ in range(at_8th))),
                nn.Sequential(_convolution(c, d, 2), *(_Residual(d) for _ in range(at_16th))),
                nn.Sequential(_convolution(d, e, 2), *(_Residual(e) for _ in range(at_32nd))),
            ]
        )
        # Narrowed where there are few places, and added: at a quarter of the picture each channel is dear.
        self.narrow = nn.ModuleList([nn.Conv2d(e, d, 1), nn.Conv2d(d, c, 1), nn.Conv2d(c, fine, 1)])
        self.aside = nn.ModuleList([nn.Conv2d(d, d, 1), nn.Conv2d(c, c, 1), nn.Conv2d(b, fine, 1)])
        self.up = nn.ModuleList([_convolution(d, d), _convolution(c, c), _convolution(fine, fine)])
        self.head = nn.Conv2d(fine, 9, 1)

    def forward(self, pictures: Tensor) -> Tensor:
        """What each place says."""
        layers = []
        x = pictures
        for step in self.down:
            x = step(x)
            layers.append(x)
        for narrow, aside, step, finer in zip(self.narrow, self.aside, self.up, reversed(layers[1:-1]), strict=True):
            wider = functional.interpolate(narrow(x), scale_factor=2.0, mode="nearest")
            x = step(wider + aside(finer))
        with torch.autocast(x.device.type, enabled=False):  # where a corner is needs more than half precision
            return torch.as_tensor(self.head(x.float()))


def as_input(image: Picture) -> Tensor:
    """A picture, shape (h, w, 3), uint8, as the network takes it, shape (1, 3, h', w'), padded with its borders."""
    height, width = image.shape[:2]
    below, right = -height % MULTIPLE_PX, -width % MULTIPLE_PX
    padded = np.pad(image, ((0, below), (0, right), (0, 0)), mode="edge")
    return torch.from_numpy(np.ascontiguousarray(padded.transpose(2, 0, 1)))[None].float() / 127.5 - 1.0


@cache
def network() -> PaneNetwork:
    """The network with the weights that come with the program."""
    return network_of((resources.files(__package__) / "data" / WEIGHTS).read_bytes())


def network_of(weights: bytes) -> PaneNetwork:
    """The network with these weights, the content of a file that `training` writes."""
    stored = load(weights)
    loaded = PaneNetwork(Shape.of(stored))
    loaded.load_state_dict({name: value.float() for name, value in stored.items()})
    return loaded.eval()


def pane_votes(image: Picture, by: PaneNetwork | None = None) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """What each place of a picture says, by the network that comes with the program or by another.

    Returns
    -------
    probability
        Shape (h / 4, w / 4): that the place lies on a pane.
    corners_px
        Shape (h / 4, w / 4, 4, 2): where the corners of that pane are in the picture; lower left, lower right, upper
        right, upper left.
    """
    height, width = -(-image.shape[0] // STRIDE), -(-image.shape[1] // STRIDE)
    with torch.inference_mode():
        output = (by or network())(as_input(image))[0, :, :height, :width]
    probability = torch.sigmoid(output[0]).numpy()
    offsets = output[1:].permute(1, 2, 0).reshape(height, width, 4, 2).numpy() * OFFSET_PX
    return probability, offsets + places_px(height, width)[:, :, None]

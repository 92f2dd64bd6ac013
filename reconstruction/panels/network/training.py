"""How the network for panes learns: made pictures and photos in crops, each pane by lot in a size by lot.

`python -m reconstruction.pane_training` gathers what it learns from and begins.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import torch
from numpy.typing import NDArray
from safetensors.torch import load_file, save_file
from torch import Tensor
from torch.nn import functional

from reconstruction.panels.network.network import OFFSET_PX, PaneNetwork
from reconstruction.panels.network.random_pictures import MadePicture, made_picture
from reconstruction.panels.network.votes import STRIDE, places_px, signed_areas
from reconstruction.panels.search.cells import from_lower_left

PER_FILE = 50
"""Made pictures in a file of the pool."""

MADE_PX = 320
"""Their size."""


def make_pool(folder: Path, n_pictures: int, n_processes: int = 1) -> list[Path]:
    """Files of made pictures, those that are there already left as they are; returns their paths."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = [folder / f"made-{number:04d}.npz" for number in range(-(-n_pictures // PER_FILE))]
    wanted = [(number, path) for number, path in enumerate(paths) if not path.exists()]
    if n_processes == 1:
        for number, path in wanted:
            _write_file(number, path)
    else:
        with ProcessPoolExecutor(n_processes) as processes:
            for _ in processes.map(_write_file, [number for number, _ in wanted], [path for _, path in wanted]):
                pass
    return paths


def _write_file(number: int, path: Path) -> None:
    cv2.setNumThreads(1)
    made = [made_picture(seed, MADE_PX) for seed in range(number * PER_FILE, (number + 1) * PER_FILE)]
    corners = [picture.corners_px for picture in made]
    unfinished = path.with_suffix(".part.npz")
    np.savez_compressed(
        unfinished,
        images=np.stack([picture.image for picture in made]),
        indices=np.stack([picture.index for picture in made]),
        corners=np.concatenate(corners),
        counts=np.array([len(each) for each in corners]),
    )
    unfinished.replace(path)


def read_pool(paths: Sequence[Path]) -> list[MadePicture]:
    """Pictures of a pool's files."""
    pictures = []
    for path in paths:
        with np.load(path) as file:
            images, indices, corners, counts = (file[name] for name in ("images", "indices", "corners", "counts"))
        parts = np.split(corners, np.cumsum(counts)[:-1])
        pictures += [MadePicture(*each) for each in zip(images, indices, parts, strict=True)]
    return pictures


# Photos as pictures to learn from: their panes' corners follow from the index images.

LONGEST_PX = (1280, 640, 320)
"""Sizes of a photo that are learned from: its panes are to be small in one of them."""


def learned_photo(photo: NDArray[np.uint8], truth: NDArray[np.uint16], longest_px: int) -> MadePicture:
    """A photo, shape (h, w, 3), and its panes' numbers, shape (h, w), as a picture of that size to learn from.

    Corners of panes that its border cuts are not known.
    """
    scale = min(1.0, longest_px / max(truth.shape))
    size = round(truth.shape[1] * scale), round(truth.shape[0] * scale)
    image = np.asarray(cv2.resize(photo, size, interpolation=cv2.INTER_AREA), np.uint8)
    index = np.asarray(cv2.resize(truth, size, interpolation=cv2.INTER_NEAREST_EXACT), np.uint16)
    corners = np.full((int(index.max(initial=0)), 4, 2), np.nan, np.float32)
    for number in range(1, len(corners) + 1):
        corners[number - 1] = _corners(index == number)
    return MadePicture(image, index, corners)


def _corners(mask: NDArray[np.bool_]) -> NDArray[np.float32]:
    """Corners of an area, shape (4, 2), NaN where it touches the picture's border or is no quadrilateral."""
    unknown = np.full((4, 2), np.nan, np.float32)
    rows, columns = np.nonzero(mask.any(axis=1))[0], np.nonzero(mask.any(axis=0))[0]
    if len(rows) < 3 or len(columns) < 3:
        return unknown
    if rows[0] == 0 or columns[0] == 0 or rows[-1] == mask.shape[0] - 1 or columns[-1] == mask.shape[1] - 1:
        return unknown
    outlines, _ = cv2.findContours(mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    outline = max(outlines, key=cv2.contourArea)
    quad = cv2.approxPolyN(cv2.convexHull(outline), 4).reshape(-1, 2).astype(np.float32)
    if len(quad) != 4 or cv2.contourArea(quad) > 1.25 * max(cv2.contourArea(outline), 1.0):
        return unknown
    off = quad - quad.mean(axis=0)
    ordered = quad[np.argsort(-np.arctan2(off[:, 1], off[:, 0]))].astype(
        float
    )  # counter-clockwise as seen, y downwards
    return np.asarray(from_lower_left(ordered + 0.5, np.array([0.0, -1.0])), np.float32)


# Crops of pictures, each another size, brightness and side.

CROP_PX = 128

PANE_PX = (8.0, 48.0)
"""Sizes, root of the area, that a pane is brought to."""

LEARNED_PX = (6.0, 66.0)
"""Panes of other sizes show in the crop, and are neither right nor wrong."""

MOST_SCALE = 2.2


@dataclass(frozen=True, slots=True, eq=False)
class Crop:
    """A part of a picture as the network learns it: image, shape (128, 128, 3), and truth at 32 x 32 places.

    `offsets` and `weight` have shape (32, 32, 8): 0 weight where a corner is not known. `counts`, shape (32, 32), is
    where `is_pane` is to be learned: not on panes of sizes that are found in a larger or smaller picture.
    """

    image: NDArray[np.uint8]
    is_pane: NDArray[np.bool_]
    counts: NDArray[np.bool_]
    offsets: NDArray[np.float32]
    weight: NDArray[np.float32]


def crop(picture: MadePicture, rng: np.random.Generator, is_photo: bool) -> Crop | None:
    """A part of a picture in which a pane, drawn by lot, has a size by lot; None where it is too large for any."""
    height, width = picture.index.shape
    known = np.nonzero(np.isfinite(picture.corners_px).all(axis=(1, 2)))[0]
    centre = np.array([rng.uniform(0, width), rng.uniform(0, height)])
    scale = float(np.exp(rng.uniform(np.log(0.5), np.log(1.5)))) * CROP_PX / MADE_PX
    if len(known) and rng.random() < 0.9:
        quad = picture.corners_px[rng.choice(known)].astype(float)
        size = np.sqrt(max(signed_areas(quad[None])[0], 1.0))
        scale = float(np.exp(rng.uniform(*np.log(PANE_PX)))) / size
        centre = quad.mean(axis=0) + rng.uniform(-0.45, 0.45, 2) * CROP_PX / scale
    scale = float(np.clip(scale, min(1.05 * CROP_PX / min(height, width), MOST_SCALE), MOST_SCALE))
    if len(known) and np.sqrt(np.median(signed_areas(picture.corners_px[known].astype(float)))) * scale > LEARNED_PX[1]:
        return None
    angle = np.radians(rng.normal(0.0, 3.0))
    stretch = float(np.exp(rng.normal(0.0, 0.08)))
    linear = scale * np.array([[np.cos(angle) * stretch, -np.sin(angle)], [np.sin(angle), np.cos(angle) / stretch]])
    mirrored = rng.random() < 0.5
    if mirrored:
        linear = np.diag([-1.0, 1.0]) @ linear
    half = 0.5 * CROP_PX
    within = 0.5 * CROP_PX / scale  # the crop lies within the picture
    shift = np.array([half, half]) - linear @ np.clip(centre, within, np.array([width, height]) - within)
    image = picture.image
    if scale < 0.7:  # averaged, as a camera farther away would
        image = np.asarray(cv2.GaussianBlur(image, (0, 0), 0.4 / scale), np.uint8)
    to_crop = np.column_stack([linear, shift + linear @ [0.5, 0.5] - 0.5])
    size, border = (CROP_PX, CROP_PX), cv2.BORDER_REFLECT
    seen = cv2.warpAffine(image, to_crop, size, flags=cv2.INTER_LINEAR, borderMode=border)
    numbers = cv2.warpAffine(picture.index, to_crop, size, flags=cv2.INTER_NEAREST, borderMode=border)
    index = np.asarray(numbers[STRIDE // 2 :: STRIDE, STRIDE // 2 :: STRIDE], np.uint16)
    corners = picture.corners_px @ linear.T.astype(np.float32) + shift.astype(np.float32)
    if mirrored:
        corners = corners[:, [1, 0, 3, 2]]
    ones = cv2.warpAffine(np.ones((height, width), np.uint8), to_crop, size, flags=cv2.INTER_NEAREST)
    is_inside = ones[STRIDE // 2 :: STRIDE, STRIDE // 2 :: STRIDE] > 0
    return _truth(_jittered(np.asarray(seen, np.uint8), rng, is_photo), index, corners, is_inside)


def _truth(
    image: NDArray[np.uint8],
    index: NDArray[np.uint16],
    corners: NDArray[np.float32],
    is_inside: NDArray[np.bool_],
) -> Crop:
    is_pane = index > 0
    told = np.concatenate([np.full((1, 4, 2), np.nan, np.float32), corners])[index]
    offsets = told - places_px(*index.shape)[:, :, None]
    size = np.sqrt(np.concatenate([[1.0], np.maximum(signed_areas(np.nan_to_num(corners.astype(float))), 1.0)]))[index]
    is_learned = (size > LEARNED_PX[0]) & (size < LEARNED_PX[1]) | ~np.isfinite(told).all(axis=(2, 3))
    # Relative to the pane; small panes count as much as large ones of many places, nearly. What lies far beyond the
    # crop can only be guessed.
    far = np.abs(offsets).max(axis=-1) > 90.0
    weight = np.where(np.isfinite(offsets).all(axis=-1) & is_inside[..., None], 1.0, 0.0) * np.where(far, 0.1, 1.0)
    weight = weight * (OFFSET_PX / size * (16.0 / np.maximum(size, 4.0)) ** 0.7)[..., None]
    shape = (*index.shape, 8)
    repeated = np.repeat(weight[..., None], 2, axis=-1)
    return Crop(
        image,
        is_pane,
        is_inside & (is_learned | ~is_pane),
        np.nan_to_num(offsets).reshape(shape).astype(np.float32) / np.float32(OFFSET_PX),
        repeated.reshape(shape).astype(np.float32),
    )


def _jittered(image: NDArray[np.uint8], rng: np.random.Generator, is_photo: bool) -> NDArray[np.uint8]:
    """Another brightness, colour, contrast, sharpness; photos, of which there are few, get more of it."""
    strength = 1.0 if is_photo else 0.4
    light = (np.arange(256) / 255.0) ** float(np.exp(strength * rng.normal(0.0, 0.4)))
    light = np.clip(light * np.exp(strength * rng.normal(0.0, 0.25)), 0.0, 1.0)
    tables = [np.clip(light * np.exp(strength * rng.normal(0.0, 0.12)), 0.0, 1.0) for _ in range(3)]
    if rng.random() < 0.05:
        tables = [1.0 - table for table in tables]
    table = (255.0 * np.stack(tables, axis=-1) + 0.5).astype(np.uint8)[None].reshape(1, 256, 3)
    image = np.asarray(cv2.LUT(image, table), np.uint8)
    if is_photo and rng.random() < 0.15:
        image = np.ascontiguousarray(image[..., rng.permutation(3)])
    if is_photo and rng.random() < 0.3:
        noisy = image + rng.normal(0.0, rng.uniform(1.0, 9.0), image.shape)
        image = np.asarray(np.clip(noisy, 0, 255), np.uint8)
    return image


# Learning.

BATCH = 32

SHARP = 0.05
"""Where the loss of an offset turns from square to linear, as a share of the pane's side."""

SOURCES = (0.62, 0.08, 0.3)
"""Shares of pictures made by chance, of traced facades, and of photos."""


def loss_of(told: Tensor, is_pane: Tensor, counts: Tensor, offsets: Tensor, weight: Tensor) -> tuple[Tensor, Tensor]:
    """Losses of logits and of offsets: told is (n, 9, h, w), the truths (n, h, w) twice and (n, h, w, 8) twice."""
    each = functional.binary_cross_entropy_with_logits(told[:, 0], is_pane, reduction="none")
    logits = (each * counts).sum() / counts.sum().clamp(min=1.0)
    off = torch.abs(told[:, 1:].permute(0, 2, 3, 1) - offsets) * weight
    robust = torch.where(off < SHARP, 0.5 * off * off / SHARP, off - 0.5 * SHARP)
    return logits, robust.sum() / (8.0 * torch.count_nonzero(weight[..., 0]).clamp(min=1))


def train(
    sources: Sequence[Sequence[MadePicture]],
    minutes: float,
    out: Path,
    start: Path | None = None,
    seed: int = 0,
    tell: Callable[[str], None] = lambda text: None,
) -> None:
    """Learn for so many minutes on one core and write the weights, as they are every 250 steps and at the end.

    Parameters
    ----------
    sources
        Made pictures, traced facades, photos; `SOURCES` are their shares.
    start
        Weights to go on from.
    tell
        Is told the losses every 100 steps.
    """
    torch.manual_seed(seed)
    torch.set_num_threads(1)
    rng = np.random.default_rng(seed)
    net = PaneNetwork().to(memory_format=torch.channels_last)  # type: ignore[call-overload]
    if start is not None:
        net.load_state_dict({name: value.float() for name, value in load_file(start).items()}, strict=False)
    optimiser = torch.optim.AdamW(net.parameters(), lr=1e-3, weight_decay=1e-4)
    shares = np.array([share if pictures else 0.0 for share, pictures in zip(SOURCES, sources, strict=True)])
    shares /= shares.sum()
    highest = 2e-3
    began, number, shown = time.monotonic(), 0, np.zeros(2)
    average: dict[str, Tensor] = {}
    while (done := (time.monotonic() - began) / (60.0 * minutes)) < 1.0:
        rate = highest * min(1.0, number / 200) * (0.5 * (1.0 + np.cos(np.pi * min(done, 1.0))) + 0.005)
        for group in optimiser.param_groups:
            group["lr"] = rate
        crops: list[Crop] = []
        while len(crops) < BATCH:
            source = int(rng.choice(len(sources), p=shares))
            picture = sources[source][int(rng.integers(len(sources[source])))]
            one = crop(picture, rng, is_photo=source == 2)
            crops += [one] if one is not None else []
        images = torch.from_numpy(np.stack([one.image for one in crops])).permute(0, 3, 1, 2).float() / 127.5 - 1.0
        told = net(images.contiguous(memory_format=torch.channels_last))
        truth = (np.stack([getattr(one, name) for one in crops]) for name in ("is_pane", "counts", "offsets", "weight"))
        logits, off = loss_of(told, *(torch.from_numpy(each).float() for each in truth))
        optimiser.zero_grad(set_to_none=True)
        torch.autograd.backward([logits + off])
        torch.nn.utils.clip_grad_norm_(net.parameters(), 5.0)
        optimiser.step()
        number += 1
        shown += 0.03 * (np.array([logits.item(), off.item()]) - shown) if number > 1 else [logits.item(), off.item()]
        if number % 100 == 0:
            tell(f"{number} steps, {100 * done:.0f} %: panes {shown[0]:.4f}, corners {shown[1]:.4f}")
        if number % 20 == 0 or not average:
            _averaged(average, net, min(0.98, number / (number + 100.0)))
        if number % 250 == 0:
            _write(average, out)
    _write(average, out)


def _averaged(average: dict[str, Tensor], net: PaneNetwork, keep: float) -> None:
    """Weights averaged over the last thousand steps: less noisy than those of the last."""
    for name, value in net.state_dict().items():
        if name not in average or not value.is_floating_point():
            average[name] = value.detach().clone()
        else:
            average[name].mul_(keep).add_(value.detach(), alpha=1.0 - keep)


def _write(weights: dict[str, Tensor], out: Path) -> None:
    """Weights in half precision: 2 MB. Sums over batches keep theirs: variances may be beyond its range."""
    halved = {
        name: value.half() if value.is_floating_point() and "running" not in name else value
        for name, value in weights.items()
    }
    save_file({name: value.contiguous() for name, value in halved.items()}, out)

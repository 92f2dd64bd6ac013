"""Crops of pictures that the network for panes learns from, hundreds at once, where it learns: processor or GPU.

All pictures are kept on the device, each in halved sizes. A crop is a part of a picture seen from elsewhere, in which
a pane, drawn by lot, has a size by lot; other light, glass that mirrors other pictures, and things before it are mixed
in, more into photos, of which there are few.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.nn import functional

from reconstruction.panels.network.network import OFFSET_PX
from reconstruction.panels.network.random_pictures import SyntheticPicture
from reconstruction.panels.network.votes import STRIDE, signed_areas

Array = NDArray[np.float64]

CROP_PX = 192

PLACES = CROP_PX // STRIDE

PANE_PX = (8.0, 48.0)
"""Sizes, root of the area, that a pane is brought to."""

LEARNED_PX = (6.0, 66.0)
"""Panes of other sizes show in the crop, and are neither right nor wrong."""

MOST_SCALE = 2.2

LEAST_SHOWN = 0.7
"""Sides of a crop that a picture fills at least, nearly: the rest is its border, and not learned."""

LEVELS = 5
"""Sizes that a picture is kept in, each half the one before."""

FAR_PX = 90.0
"""Corners so far beyond the crop can only be guessed, and count a tenth."""

NEAREST = 0.1
"""Least depth of what is seen, as a share of that of the crop's middle."""

STRENGTH = (0.4, 0.6, 1.0)
"""How much pictures made by chance, traced facades and photos are changed."""


class CropSampler:
    """Pictures on a device, and their panes. `add` them, then take crops.

    Parameters
    ----------
    shares
        How often crops are of each source.
    room_px
        Pixels of pictures that room is made for at once; more take up to twice their memory while room is made.
    """

    def __init__(self, device: str, shares: Sequence[float], room_px: int = 0) -> None:
        self.device = torch.device(device)
        self.shares = np.array(shares, float)
        self._pixels = _Growing(self.device, torch.int32, (int(1.34 * room_px),))
        self._numbers = _Growing(self.device, torch.int16, (room_px,))
        self._corners = _Growing(self.device, torch.float32, (0, 8))
        self._corners.append(torch.full((1, 8), torch.nan))
        # Of each picture: source, height, width, first of its numbers, first of its corners, median size of its panes,
        # first and number of its known panes; then where its sizes begin.
        self._pictures = np.zeros((0, 8 + LEVELS))
        self._known = np.zeros((0, 3))  # middle and size of panes whose corners are known

    def __len__(self) -> int:
        return len(self._pictures)

    def add(self, pictures: Sequence[SyntheticPicture], source: int) -> None:
        """Put pictures of any size on the device, those left out whose panes are too large for any crop."""
        for _, same in groupby(filter(_fits, pictures), key=lambda picture: picture.index.shape):
            self._add(list(same), source)

    def _add(self, pictures: Sequence[SyntheticPicture], source: int) -> None:
        height, width = pictures[0].index.shape
        rows = np.zeros((len(pictures), 8 + LEVELS))
        each = np.arange(len(pictures))
        rows[:, :3] = source, height, width
        numbers = torch.from_numpy(np.stack([picture.index for picture in pictures]).astype(np.int16))
        rows[:, 3] = self._numbers.append(numbers.reshape(-1)) + each * height * width
        image = torch.from_numpy(np.stack([picture.image for picture in pictures])).to(self.device)
        halved = image.permute(0, 3, 1, 2).float()
        for level in range(LEVELS):
            if level:
                odd = 0, halved.shape[3] % 2, 0, halved.shape[2] % 2
                halved = functional.avg_pool2d(functional.pad(halved, odd, mode="replicate"), 2)
            blue, green, red = (halved + 0.5).to(torch.int32).unbind(dim=1)
            packed = blue | (green << 8) | (red << 16)
            rows[:, 8 + level] = self._pixels.append(packed.reshape(-1)) + each * packed[0].numel()
        known: list[Array] = []
        for row, picture in zip(rows, pictures, strict=True):
            row[4] = self._corners.append(torch.from_numpy(picture.corners_px.reshape(-1, 8)))
            quads = picture.corners_px[np.isfinite(picture.corners_px).all(axis=(1, 2))].astype(float)
            sizes = np.sqrt(np.maximum(signed_areas(quads), 1.0))
            row[5] = np.median(sizes) if len(quads) else 0.0
            row[6:8] = len(self._known) + sum(len(each) for each in known), len(quads)
            known.append(np.column_stack([quads.mean(axis=1), sizes]))
        self._known = np.concatenate([self._known, *known])
        self._pictures = np.concatenate([self._pictures, rows])

    def views(self, n: int, rng: np.random.Generator) -> Views:
        """Draw n crops: of which picture, and from where it is seen.

        Raises
        ------
        ValueError
            There are no pictures.
        """
        if not len(self):
            raise ValueError("expected pictures to take crops of, found none")
        sources = [np.nonzero(self._pictures[:, 0] == source)[0] for source in range(len(self.shares))]
        shares = self.shares * [len(each) > 0 for each in sources]
        drawn: list[Views] = []
        while sum(len(one.which) for one in drawn) < n:
            kind = rng.choice(len(shares), 2 * n, p=shares / shares.sum())
            which = np.zeros(2 * n, int)
            for source, among in enumerate(sources):
                chosen = kind == source
                which[chosen] = among[rng.integers(len(among), size=chosen.sum())] if chosen.any() else 0
            drawn.append(self._seen_from(which, rng))
        return Views(
            *(np.concatenate([getattr(one, name) for one in drawn])[:n] for name in ("which", "to_crop", "mirrored"))
        )

    def _seen_from(self, which: NDArray[np.intp], rng: np.random.Generator) -> Views:
        """Views of pictures, those left out whose panes are too large for any."""
        n = len(which)
        source, height, width, _, _, median, first, n_known = self._pictures[which, :8].T
        sides = np.stack([width, height], axis=-1)
        strength = np.array(STRENGTH)[source.astype(int)]
        scale = np.exp(rng.uniform(np.log(0.5), np.log(1.5), n)) * CROP_PX / 480.0
        centre = rng.uniform(0.0, 1.0, (n, 2)) * sides
        by_pane = (n_known > 0) & (rng.random(n) < 0.9)
        pane = self._known[(first + np.floor(rng.random(n) * n_known)).astype(int)[by_pane]]
        scale[by_pane] = np.exp(rng.uniform(np.log(PANE_PX[0]), np.log(PANE_PX[1]), len(pane))) / pane[:, 2]
        centre[by_pane] = pane[:, :2] + rng.uniform(-0.45, 0.45, (len(pane), 2)) * CROP_PX / scale[by_pane, None]
        scale = np.clip(scale, _least_scale(sides.min(axis=1)), MOST_SCALE)
        within = np.minimum(0.5 * CROP_PX / scale[:, None], 0.5 * sides)
        centre = np.clip(centre, within, sides - within)
        turn = np.radians(rng.normal(0.0, 3.0, n))
        stretch = np.exp(rng.normal(0.0, 0.08, n) * (0.6 + 0.8 * strength))
        mirrored = rng.random(n) < 0.5
        side = np.where(mirrored, -1.0, 1.0)
        to_crop = np.zeros((n, 3, 3))
        to_crop[:, 0, 0], to_crop[:, 0, 1] = side * scale * np.cos(turn) * stretch, -side * scale * np.sin(turn)
        to_crop[:, 1, 0], to_crop[:, 1, 1] = scale * np.sin(turn), scale * np.cos(turn) / stretch
        to_crop[:, 0, 1] += scale * rng.normal(0.0, 0.05, n) * strength
        to_crop[:, 1, 0] += scale * rng.normal(0.0, 0.05, n) * strength
        to_crop[:, 2, 2] = 1.0
        to_crop[:, :2, 2] = -np.einsum("nij,nj->ni", to_crop[:, :2, :2], centre)
        tilt = np.broadcast_to(np.eye(3), (n, 3, 3)).copy()  # seen more from the side, about the crop's middle
        tilt[:, 2, :2] = np.clip(rng.normal(0.0, 0.1, (n, 2)), -0.22, 0.22) * strength[:, None] / (0.5 * CROP_PX)
        middle = np.array([[1.0, 0.0, 0.5 * CROP_PX], [0.0, 1.0, 0.5 * CROP_PX], [0.0, 0.0, 1.0]])
        fits = median * scale <= LEARNED_PX[1]
        return Views(which[fits], (middle @ tilt @ to_crop)[fits], mirrored[fits])

    def plain(self, views: Views) -> tuple[Tensor, Tensor, Truth]:
        """What the views show: images, shape (n, 3, 192, 192), 0 to 1, panes' numbers, (n, 192, 192), and the truth."""
        rows = self._pictures[views.which]
        to_crop, to_picture = (
            torch.from_numpy(each.astype(np.float32)).to(self.device)
            for each in (views.to_crop, np.linalg.inv(views.to_crop))
        )
        points = _mapped(to_picture, _pixels(CROP_PX, self.device))
        # Depth is 1 in the crop's middle, where the determinant is the square of the scale therefore.
        halvings = -0.5 * np.log2(np.abs(np.linalg.det(views.to_crop)))
        level = np.clip(np.floor(halvings + 0.5), 0, LEVELS - 1).astype(int)
        image = self._sampled(rows, level, points)
        height, width, first = (self._whole(rows[:, i])[:, None, None] for i in (1, 2, 3))
        x, y = points[..., 0].floor().long(), points[..., 1].floor().long()
        inside = (x >= 0) & (x < width) & (y >= 0) & (y < height)
        at = first + y.clamp(min=0).minimum(height - 1) * width + x.clamp(min=0).minimum(width - 1)
        numbers = self._numbers.values[at].long()
        some = slice(STRIDE // 2, None, STRIDE)
        number, is_inside = numbers[:, some, some], inside[:, some, some]
        row = torch.where(number > 0, self._whole(rows[:, 4])[:, None, None] + number - 1, 0)
        corners = _mapped(to_crop, self._corners.values[row].reshape(len(rows), -1, 2))
        corners = corners.reshape(len(rows), PLACES, PLACES, 4, 2)
        mirrored = torch.from_numpy(views.mirrored).to(self.device)[:, None, None, None, None]
        corners = torch.where(mirrored, corners[..., [1, 0, 3, 2], :], corners)
        return image, numbers, _truth(number > 0, is_inside, corners)

    def _whole(self, values: Array) -> Tensor:
        return torch.from_numpy(values.astype(np.int64)).to(self.device)

    def _sampled(self, rows: Array, level: NDArray[np.intp], points: Tensor) -> Tensor:
        """Pictures, each in one of its sizes, between their pixels, shape (n, 3, h, w), 0 to 1."""
        first = self._whole(rows[np.arange(len(rows)), 8 + level])[:, None, None]
        height, width = (self._whole(np.ceil(rows[:, i] / 2.0**level))[:, None, None] for i in (1, 2))
        smaller = torch.from_numpy((0.5**level).astype(np.float32)).to(self.device)[:, None, None]
        x, y = points[..., 0] * smaller - 0.5, points[..., 1] * smaller - 0.5
        left, top = x.floor(), y.floor()
        right_share, low_share = x - left, y - top
        image = torch.zeros((len(rows), 3, *points.shape[1:3]), device=self.device)
        for down in (0, 1):
            row = (top.long() + down).clamp(min=0).minimum(height - 1) * width + first
            for right in (0, 1):
                at = row + (left.long() + right).clamp(min=0).minimum(width - 1)
                packed = self._pixels.values[at]
                share = (low_share if down else 1.0 - low_share) * (right_share if right else 1.0 - right_share)
                for channel in range(3):
                    image[:, channel] += share * ((packed >> (8 * channel)) & 255)
        return image / 255.0

    def crops(self, n: int, rng: np.random.Generator, generator: torch.Generator) -> tuple[Tensor, Truth]:
        """Take n crops: images as the network takes them, shape (n, 3, 192, 192), -1 to 1, and the truth."""
        views = self.views(n, rng)
        image, numbers, truth = self.plain(views)
        source = self._pictures[views.which, 0].astype(int)
        strength = torch.from_numpy(np.array(STRENGTH, np.float32)[source]).to(self.device)
        changed = _lit(_mixed(image, numbers, strength, generator), strength, generator)
        return changed * 2.0 - 1.0, truth


def _least_scale(side_px: Array) -> Array:
    """At which pictures with such shorter sides, shape (n,), fill enough of a crop."""
    return np.minimum(LEAST_SHOWN * CROP_PX / side_px, MOST_SCALE)


def _fits(picture: SyntheticPicture) -> bool:
    """Whether at the least scale its usual pane is of a size that is learned."""
    sizes = np.sqrt(np.maximum(signed_areas(picture.corners_px.astype(float)), 1.0))
    known = sizes[np.isfinite(sizes)]
    least = float(_least_scale(np.array([min(picture.index.shape)], float))[0])
    return len(known) == 0 or float(np.median(known)) * least < 0.95 * LEARNED_PX[1]


@dataclass(frozen=True, slots=True, eq=False)
class Views:
    """Of which pictures crops are, shape (n,), homographies into the crops, (n, 3, 3), and which are mirrored, (n,)."""

    which: NDArray[np.intp]
    to_crop: Array
    mirrored: NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class Truth:
    """What is to be learned at the 48 x 48 places of crops, n of them.

    Parameters
    ----------
    is_pane, counts
        Shape (n, 48, 48), 0 or 1: whether a place lies on a pane; whether that is to be learned: not on panes of sizes
        that are found in a larger or smaller picture, nor beyond the picture.
    offsets, weight
        Shape (n, 48, 48, 8): corners from the place, in units of `OFFSET_PX`; 0 weight where they are not known.
    """

    is_pane: Tensor
    counts: Tensor
    offsets: Tensor
    weight: Tensor


class _Growing:
    """Values on a device that more are appended to, shape (n,) or (n, k)."""

    def __init__(self, device: torch.device, kind: torch.dtype, room: tuple[int, ...]) -> None:
        self._room = torch.empty(room, dtype=kind, device=device)
        self._n = 0

    @property
    def values(self) -> Tensor:
        """All that were appended."""
        return self._room[: self._n]

    def append(self, values: Tensor) -> int:
        """Append values and return where they begin."""
        first, n = self._n, self._n + len(values)
        if n > len(self._room):
            room = torch.empty(
                (max(n, int(1.3 * len(self._room))), *self._room.shape[1:]),
                dtype=self._room.dtype,
                device=self._room.device,
            )
            room[:first] = self._room[:first]
            self._room = room
        self._room[first:n] = values.to(self._room)
        self._n = n
        return first


def _pixels(size: int, device: torch.device) -> Tensor:
    """Middles of a crop's pixels, shape (1, size, size, 2)."""
    along = torch.arange(size, device=device) + 0.5
    y, x = torch.meshgrid(along, along, indexing="ij")
    return torch.stack([x, y], dim=-1)[None]


def _mapped(homographies: Tensor, points: Tensor) -> Tensor:
    """Points, shape (n or 1, ..., 2), by homographies, shape (n, 3, 3); NaN near the viewer and behind."""
    h = homographies.reshape(-1, 9, *[1] * (points.dim() - 2))
    x, y = points[..., 0], points[..., 1]
    depth = h[:, 6] * x + h[:, 7] * y + h[:, 8]
    depth = torch.where(depth > NEAREST, depth, torch.nan)
    return torch.stack(
        [(h[:, 0] * x + h[:, 1] * y + h[:, 2]) / depth, (h[:, 3] * x + h[:, 4] * y + h[:, 5]) / depth], dim=-1
    )


def _truth(is_pane: Tensor, is_inside: Tensor, corners: Tensor) -> Truth:
    """Truth where panes' corners, shape (n, 48, 48, 4, 2), are NaN if not known."""
    along = STRIDE * (torch.arange(PLACES, device=corners.device) + 0.5)
    y, x = torch.meshgrid(along, along, indexing="ij")
    offsets = corners - torch.stack([x, y], dim=-1)[None, :, :, None]
    after = corners.roll(-1, dims=3)
    area = 0.5 * (after[..., 0] * corners[..., 1] - corners[..., 0] * after[..., 1]).sum(dim=-1)
    is_known = torch.isfinite(area)
    size = torch.where(is_known, area, 1.0).clamp(min=1.0).sqrt()
    is_learned = (size > LEARNED_PX[0]) & (size < LEARNED_PX[1]) | ~is_known
    # Relative to the pane; small panes count as much as large ones of many places, nearly.
    far = torch.where(offsets.abs().amax(dim=-1) > FAR_PX, 0.1, 1.0)
    share = OFFSET_PX / size * (16.0 / size.clamp(min=4.0)) ** 0.7
    weight = torch.where((is_known & is_inside)[..., None], far * share[..., None], 0.0)
    return Truth(
        is_pane.float(),
        (is_inside & (is_learned | ~is_pane)).float(),
        offsets.nan_to_num(0.0, 0.0, 0.0).flatten(3) / OFFSET_PX,
        weight.repeat_interleave(2, dim=-1),
    )


# Changes of what is seen. Those by chance are drawn where the crops are: of each crop, and whether it is changed at
# all. `strength`, shape (n,), is how much.


class _Chance:
    """Numbers by chance on the device, of n crops, to be spread over channels and pixels."""

    def __init__(self, strength: Tensor, generator: torch.Generator) -> None:
        self._n, self._generator, self._device = len(strength), generator, strength.device

    def uniform(self, *shape: int) -> Tensor:
        """From 0 to 1, shape (n, ...); (n, 1, 1, 1) where none is given."""
        return torch.rand((self._n, *(shape or (1, 1, 1))), generator=self._generator, device=self._device)

    def normal(self, *shape: int) -> Tensor:
        """About 0 with deviation 1."""
        return torch.randn((self._n, *(shape or (1, 1, 1))), generator=self._generator, device=self._device)

    def happens(self, share: Tensor | float) -> Tensor:
        """Whether something does that befalls such a share of crops, shape (n, 1, 1, 1)."""
        return self.uniform() < share

    def field(self, cells: int, size: int, channels: int = 1) -> Tensor:
        """Smooth noise, shape (n, channels, size, size)."""
        coarse = self.normal(channels, cells, cells)
        return functional.interpolate(coarse, (size, size), mode="bilinear", align_corners=False)

    def others(self) -> Tensor:
        """Crops in another order, shape (n,)."""
        return torch.randperm(self._n, generator=self._generator, device=self._device)


N_PANES = 64
"""Panes of a crop that differ from one another; further ones repeat."""


def _mixed(image: Tensor, numbers: Tensor, strength: Tensor, generator: torch.Generator) -> Tensor:
    """Panes that mirror other crops, or that are lit or dark, and pieces of other crops before all."""
    chance = _Chance(strength, generator)
    much = strength[:, None, None, None]
    pane = (numbers % N_PANES)[:, None]
    is_pane = (numbers > 0)[:, None]

    def of_pane(values: Tensor) -> Tensor:
        return values[:, None, None].expand(-1, 1, CROP_PX, -1).gather(3, pane)

    other = image[chance.others()]
    usual = 0.6 * chance.uniform() ** 2
    share = (usual + 0.15 * of_pane(chance.normal(N_PANES))).clamp(0.0, 0.8)
    mirrors = is_pane & chance.happens(0.4 * much)
    image = torch.where(mirrors, image + share * (other - image), image)
    lit = (0.35 * of_pane(chance.normal(N_PANES))).exp()
    image = torch.where(is_pane & chance.happens(0.35 * much), (image * lit).clamp(0.0, 1.0), image)
    other = image[chance.others()]
    blob = chance.field(4, CROP_PX) + 0.6 * chance.field(12, CROP_PX) + 0.3 * chance.field(48, CROP_PX)
    covered = (blob > 1.1 + 1.2 * chance.uniform()) & chance.happens(0.25 * much)
    plain = chance.uniform(3, 1, 1) * (1.0 + 0.2 * chance.field(48, CROP_PX))
    before = torch.where(chance.happens(0.5), other, plain.clamp(0.0, 1.0))
    return torch.where(covered, before, image)


def _lit(image: Tensor, strength: Tensor, generator: torch.Generator) -> Tensor:
    """Another brightness, contrast, colour, shade and sharpness, and noise."""
    chance = _Chance(strength, generator)
    much = strength[:, None, None, None]
    image = image.clamp(1e-4, 1.0) ** (0.4 * much * chance.normal()).exp()
    shade = torch.where(chance.happens(0.4 * much), 0.35 * chance.field(3, CROP_PX), 0.0)
    image = image * (much * (0.25 * chance.normal() + 0.12 * chance.normal(3, 1, 1)) + shade).exp()
    grey = image.mean(dim=1, keepdim=True)
    colourful = torch.where(chance.happens(0.5 * much), 1.6 * chance.uniform(), 1.0)
    image = (grey + colourful * (image - grey)).clamp(0.0, 1.0)
    image = torch.where(chance.happens(0.05), 1.0 - image, image)
    order = torch.argsort(chance.uniform(3), dim=1)[:, :, None, None].expand_as(image)
    image = torch.where(chance.happens(0.15 * much), image.gather(1, order), image)
    soft = functional.interpolate(functional.avg_pool2d(image, 2), scale_factor=2.0, mode="bilinear")
    softness = torch.where(chance.happens(0.4 * much), 1.4 * chance.uniform() - 0.4, 0.0)
    image = image + softness * (soft - image)
    noise = torch.where(chance.happens(0.3 * much), 0.035 * chance.uniform(), 0.0)
    return (image + noise * chance.normal(3, CROP_PX, CROP_PX)).clamp(0.0, 1.0)

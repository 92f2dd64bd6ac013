"""One photo of a data set folder, decoded: picture, mask, panels and normals, straight and as small as asked for."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.json_file import read_json, to_record
from planning.base.messages import say
from reconstruction.base.cameras import Intrinsics, PosedPhoto
from reconstruction.dataset.layers import Maps, normals_from_16_bit, straightened_mask, straightening_maps
from reconstruction.dataset.prepare import layer_path, mask_of
from reconstruction.light.photo_set import PhotoSet
from reconstruction.metrics.pictures import read_labels

FACADE, SHOWN = 1, 2
"""Bits of `DecodedPhoto.flags`: panels and the frames between them; what the photo shows at all."""

DECODING_BYTES_PER_PX = 16
"""Of the photo as it is on the disk, at most, while it is decoded: the picture twice, and its layers."""


@dataclass(frozen=True, slots=True, eq=False)
class DecodedPhoto:
    """A photo in memory, in as few bytes as it has on the disk without compression.

    Parameters
    ----------
    photo
        With the straight camera of the decoded size.
    display
        sRGB, shape (h, w, 3).
    flags
        Shape (h, w).
    panels
        Number of the panel, from 1; 0 for none, shape (h, w).
    normals
        Coded as in the file, shape (ceil(h / normal_step), ceil(w / normal_step), 3), or None where not asked for.
    """

    photo: PosedPhoto
    display: NDArray[np.uint8]
    flags: NDArray[np.uint8]
    panels: NDArray[np.uint16]
    normals: NDArray[np.uint16] | None
    normal_step: int

    @property
    def n_bytes(self) -> int:
        """In memory."""
        normals = 0 if self.normals is None else self.normals.nbytes
        return self.display.nbytes + self.flags.nbytes + self.panels.nbytes + normals

    def normals_enu(self, x_px: int, y_px: int, width_px: int, height_px: int) -> NDArray[np.float32] | None:
        """Unit normals of a window, or 0 where there is none, shape (height, width, 3)."""
        if self.normals is None:
            return None
        rows = np.arange(y_px, y_px + height_px) // self.normal_step
        columns = np.arange(x_px, x_px + width_px) // self.normal_step
        part = normals_from_16_bit(self.normals[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1])
        return part[np.ix_(rows - rows[0], columns - columns[0])]


@dataclass(frozen=True, slots=True)
class Decoding:
    """What of a photo is decoded.

    Parameters
    ----------
    reduce
        Pixels of the photo, along each side, that one decoded pixel is the mean of; those left over at the right and
        lower edges are cut off.
    with_normals
        Whether normals are read.
    """

    reduce: int = 1
    with_normals: bool = False

    def __post_init__(self) -> None:
        if self.reduce < 1:
            raise ValueError(f"reduce: expected 1 or more, got {self.reduce}")


def reduced(lens: Intrinsics, reduce: int) -> Intrinsics:
    """The straight camera of a decoded photo.

    Raises
    ------
    InputError
        Nothing would be left of it.
    """
    width, height = lens.width_px // reduce, lens.height_px // reduce
    if not (width and height):
        raise InputError(
            say(
                "photos of {} x {} pixels cannot be made {} times smaller; choose less",
                lens.width_px,
                lens.height_px,
                reduce,
            )
        )
    straight = lens.straight()
    return replace(
        straight,
        width_px=width,
        height_px=height,
        fx_px=lens.fx_px / reduce,
        fy_px=lens.fy_px / reduce,
        cx_px=lens.cx_px / reduce,
        cy_px=lens.cy_px / reduce,
    )


WINDOWS, LEAST_LEARNED_PX = 4, 4 * 256 * 192
"""Windows of a photo that is made smaller, at least, and pixels that are left of it. A photo is seen as often as
windows show it: at full size, 446 windows of 12 photos of 1296 x 1936 pixels gave 14 dB on an unseen one, and 1227 of
photos of 257 x 384 pixels 27 dB."""


def usual_reduce(lenses: Collection[Intrinsics], window_px: int) -> int:
    """By how much photos are made smaller along each side, so that windows show all of them often; 1 for small ones."""
    largest_px = max(lens.width_px * lens.height_px for lens in lenses)
    return max(1, math.isqrt(largest_px // max(WINDOWS * window_px, LEAST_LEARNED_PX)))


def decoded_bytes(lens: Intrinsics, decoding: Decoding, normal_step: int) -> int:
    """What a photo takes in memory, before it is read."""
    small = reduced(lens, decoding.reduce)
    n_bytes = 6 * small.width_px * small.height_px
    if decoding.with_normals:
        step = normal_step if decoding.reduce == 1 and lens.is_straight else 1
        n_bytes += 6 * -(-small.width_px // step) * -(-small.height_px // step)
    return n_bytes


def normal_step_of(folder: Path) -> int:
    """Pixels of photos per pixel of normal maps, along each side, as `dataset.json` has it."""
    path = folder / "dataset.json"
    return to_record(read_json(path, names_files=True), _Steps, path).normal_step


@dataclass(frozen=True, slots=True)
class _Steps:
    normal_step: int = 1

    def __post_init__(self) -> None:
        if self.normal_step < 1:
            raise ValueError(f"normal_step: expected 1 or more, got {self.normal_step}")


def decode_photo(source: PhotoSet, photo: PosedPhoto, decoding: Decoding, normal_step: int) -> DecodedPhoto:
    """Read a photo and its layers.

    Distorted photos become straight, with the same camera matrix. Where they have no pixels for it, or some of a
    decoded pixel's do not count, `SHOWN` is not set. A pixel's panel, facade and normal are those at its middle.

    Raises
    ------
    InputError
        A file is missing, damaged or of another size; the message names it.
    """
    lens, reduce = photo.intrinsics, decoding.reduce
    small = reduced(lens, reduce)
    maps = None if lens.is_straight else straightening_maps(lens)
    normals, step = _normals(source.folder, photo, decoding, normal_step, maps)
    panels = _kept(_panels(source, photo), maps, small, reduce)
    # In place, here and for normals: short-lived arrays of this size would leave holes in memory that stay.
    flags = _kept(_layer(source.folder, "masks", photo, 1, np.uint8), maps, small, reduce)
    np.not_equal(flags, 0, out=flags)
    flags *= FACADE
    flags |= SHOWN
    valid = None if photo.mask is None else mask_of(photo)
    if maps is not None:
        valid = straightened_mask(maps, (lens.height_px, lens.width_px), valid)
    if valid is not None:
        flags[~_whole_blocks(valid, small, reduce)] = 0
    picture = source.picture(photo)
    if maps is not None:
        picture = np.asarray(cv2.remap(picture, *maps, cv2.INTER_CUBIC, borderMode=cv2.BORDER_CONSTANT), np.uint8)
    if reduce > 1:
        # Whole blocks only, so that each pixel is the mean of its own.
        blocks = picture[: small.height_px * reduce, : small.width_px * reduce]
        size = small.width_px, small.height_px
        picture = np.asarray(cv2.resize(blocks, size, interpolation=cv2.INTER_AREA), np.uint8)
    return DecodedPhoto(replace(photo, intrinsics=small), picture, flags, panels, normals, step)


def _kept(layer: NDArray[Any], maps: Maps | None, small: Intrinsics, reduce: int) -> NDArray[Any]:
    """Values at the middles of the decoded pixels, made straight where maps are given."""
    if maps is not None:
        layer = np.asarray(cv2.remap(layer, *maps, cv2.INTER_NEAREST, borderMode=cv2.BORDER_CONSTANT))
    half = reduce // 2
    return np.ascontiguousarray(layer[half::reduce, half::reduce][: small.height_px, : small.width_px])


def _whole_blocks(valid: NDArray[np.bool_], small: Intrinsics, reduce: int) -> NDArray[np.bool_]:
    """Decoded pixels that are the mean of valid ones alone, shape (h, w)."""
    height, width = small.height_px, small.width_px
    blocks = valid[: height * reduce, : width * reduce].reshape(height, reduce, width, reduce)
    return np.asarray(blocks.all(axis=(1, 3)))


def _panels(source: PhotoSet, photo: PosedPhoto) -> NDArray[np.uint16]:
    numbers = _layer(source.folder, "panels", photo, 1, np.uint8, np.uint16).astype(np.uint16, copy=False)
    n_panels = len(source.panels.corners_enu_m)
    if numbers.max(initial=0) > n_panels:
        path = layer_path(source.folder, "panels", photo.name)
        raise InputError(
            say("has panel {}, and dataset.json {}; is it of another run?", numbers.max(), n_panels, place=path)
        )
    return numbers


def _normals(
    folder: Path, photo: PosedPhoto, decoding: Decoding, step: int, maps: Maps | None
) -> tuple[NDArray[np.uint16] | None, int]:
    """Coded normals as they are kept, and their step; none where they are not asked for."""
    if not decoding.with_normals:
        return None, 1
    coded = _layer(folder, "normals", photo, step, np.uint16)[..., ::-1]
    if maps is None and decoding.reduce == 1:
        return coded, step
    lens = photo.intrinsics
    if step > 1:
        coded = coded[np.ix_(np.arange(lens.height_px) // step, np.arange(lens.width_px) // step)]
    return _kept(np.ascontiguousarray(coded), maps, reduced(lens, decoding.reduce), decoding.reduce), 1


def _layer(folder: Path, layer: str, photo: PosedPhoto, step: int, *types: type[Any]) -> NDArray[Any]:
    """A layer as it is on the disk: one channel, or three of normals."""
    path, lens = layer_path(folder, layer, photo.name), photo.intrinsics
    values = read_labels(path)
    n_channels = 3 if layer == "normals" else 1
    expected = -(-lens.height_px // step), -(-lens.width_px // step)
    if values.dtype not in types or (values.shape[2] if values.ndim == 3 else 1) != n_channels:
        bits = " or ".join(str(8 * np.dtype(each).itemsize) for each in types)
        raise InputError(say("expected {} channel(s) of {} bit; make the folder again", n_channels, bits, place=path))
    if values.shape[:2] != expected:
        raise InputError(
            say(
                "expected {} x {} pixels by its camera, got {} x {}; make the folder again",
                expected[1],
                expected[0],
                values.shape[1],
                values.shape[0],
                place=path,
            )
        )
    return values

"""Reading SOG files of anybody's: no more is unpacked or decoded than the description can mean."""

from __future__ import annotations

import zipfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from planning.base.errors import InputError
from planning.base.files import MIB, FileLimit, check_zip_directory, open_input_file
from planning.base.json_file import parse_json, to_record
from reconstruction.exports.component_parts import NO_PANEL, Ellipsoids
from reconstruction.exports.gaussian_blocks import Axes
from reconstruction.exports.sog import CODES, FIRST_TAG, META, PALETTE_COLUMNS, STEPS, Bytes, values_of
from reconstruction.exports.spz import LARGEST_SMALL, OTHERS
from reconstruction.splats.harmonic_colour import N_HARMONICS
from tests.reconstruction.exports.spz.reading import MOST_GAUSSIANS, turned_back

Floats = NDArray[np.float32]

SOG_FILE = FileLimit("a SOG file", 2048 * MIB)

MOST_META_BYTES = 1 << 20

MOST_FILE_BYTES = 1 << 29
"""Of one image."""

MOST_SPARE_PX = 1 << 16
"""Pixels of an image beyond its Gaussians."""

LARGEST_LOG = 80.0
"""Of places and sizes: 5e34 m; not much more would be no number."""

LARGEST_COLOUR = 1e4


@dataclass(frozen=True, slots=True)
class _Means:
    mins: tuple[float, float, float]
    maxs: tuple[float, float, float]
    files: tuple[str, str]


@dataclass(frozen=True, slots=True)
class _Coded:
    codebook: tuple[float, ...]
    files: tuple[str]


@dataclass(frozen=True, slots=True)
class _Quats:
    files: tuple[str]


@dataclass(frozen=True, slots=True)
class _Palette:
    count: int
    bands: int
    codebook: tuple[float, ...]
    files: tuple[str, str]


@dataclass(frozen=True, slots=True)
class _Meta:
    version: int
    count: int
    means: _Means
    scales: _Coded
    quats: _Quats
    sh0: _Coded
    shN: _Palette | None = None  # noqa: N815  (the format's name)


def read_sog(path: Path, axes: Axes = "y-down") -> Ellipsoids:
    """Gaussians of a bundled file of version 2, in ENU.

    Parameters
    ----------
    axes
        That the file is in.

    Raises
    ------
    InputError
        The file is missing, is no such file, is damaged, or holds more than can be read.
    """
    try:
        with open_input_file(path, SOG_FILE) as file:
            check_zip_directory(file, path)
            with zipfile.ZipFile(file) as archive:
                meta = _meta(archive, path)
                return turned_back(_Reader(archive, meta, path).ellipsoids(), axes)
    except (zipfile.BadZipFile, NotImplementedError, RuntimeError, EOFError) as error:
        raise InputError(f"{path}: is no SOG file, or damaged ({error})") from error


def _meta(archive: zipfile.ZipFile, path: Path) -> _Meta:
    content = _file(archive, META, MOST_META_BYTES, path)
    plain = parse_json(content, Path(f"{path}: {META}"))
    if isinstance(plain, dict) and plain.get("version") != 2:
        raise InputError(f"{path}: expected SOG of version 2, found {str(plain.get('version', 'none'))[:20]}")
    meta = to_record(plain, _Meta, path)
    if not 1 <= meta.count <= MOST_GAUSSIANS:
        raise InputError(f"{path}: has {meta.count} Gaussians; 1 to {MOST_GAUSSIANS} are read")
    _check_numbers("means", (*meta.means.mins, *meta.means.maxs), LARGEST_LOG, path)
    for name, part, largest in (("scales", meta.scales, LARGEST_LOG), ("sh0", meta.sh0, LARGEST_COLOUR)):
        _check_codes(name, part.codebook, largest, path)
    if meta.shN is not None:
        _check_codes("shN", meta.shN.codebook, LARGEST_COLOUR, path)
        if not (1 <= meta.shN.count <= 1 << 16 and 1 <= meta.shN.bands <= 3):
            raise InputError(f"{path}: shN: expected 1 to 65536 entries of degree 1 to 3")
    return meta


def _check_codes(name: str, codes: tuple[float, ...], largest: float, path: Path) -> None:
    if len(codes) != CODES:
        raise InputError(f"{path}: {name}: expected a codebook of {CODES} numbers, found {len(codes)}")
    _check_numbers(name, codes, largest, path)


def _check_numbers(name: str, values: tuple[float, ...], largest: float, path: Path) -> None:
    if not all(-largest <= value <= largest for value in values):
        raise InputError(f"{path}: {name}: expected numbers of -{largest:g} to {largest:g}")


def _file(archive: zipfile.ZipFile, name: str, most: int, path: Path) -> bytes:
    """Content of a member, of no more than `most` bytes whatever the archive says."""
    try:
        with archive.open(name) as stream:
            content = stream.read(most + 1)
    except KeyError as error:
        raise InputError(f"{path}: has no '{name[:80]}'; is it a SOG file?") from error
    except (ValueError, zipfile.zlib.error) as error:  # type: ignore[attr-defined]
        raise InputError(f"{path}: '{name[:80]}' is damaged ({error})") from error
    if len(content) > most:
        raise InputError(f"{path}: '{name[:80]}' has more than {most} bytes")
    return content


class _Reader:
    def __init__(self, archive: zipfile.ZipFile, meta: _Meta, path: Path) -> None:
        self._archive, self._meta, self._path = archive, meta, path

    def ellipsoids(self) -> Ellipsoids:
        """In the file's axes."""
        meta, n = self._meta, self._meta.count
        colours = self._rows(meta.sh0.files[0])
        sh = np.zeros((n, N_HARMONICS, 3), np.float32)
        sh[:, 0] = np.array(meta.sh0.codebook, np.float32)[colours[:, :3]]
        if meta.shN is not None:
            sh[:, 1 : (meta.shN.bands + 1) ** 2] = self._directions(meta.shN)
        logs = np.array(meta.scales.codebook, np.float32)[self._rows(meta.scales.files[0])[:, :3]]
        return Ellipsoids(
            self._means(),
            self._quats(),
            np.exp(logs),
            colours[:, 3].astype(np.float32) / np.float32(255.0),
            sh,
            np.full(n, NO_PANEL, np.int32),
        )

    def _rows(self, name: str) -> Bytes:
        """Pixels of the Gaussians, shape (n, 4)."""
        n = self._meta.count
        content = _file(self._archive, name, MOST_FILE_BYTES, self._path)
        pixels = values_of(content, name, self._path, 2 * n + MOST_SPARE_PX).reshape(-1, 4)
        if len(pixels) < n:
            raise InputError(f"{self._path}: {name} has {len(pixels)} pixels; expected {n} or more")
        return pixels[:n]

    def _means(self) -> Floats:
        means = self._meta.means
        low, high = (self._rows(name)[:, :3].astype(np.float64) for name in means.files)
        logs = np.array(means.mins) + (np.array(means.maxs) - np.array(means.mins)) * ((low + 256.0 * high) / STEPS)
        return np.asarray(np.sign(logs) * np.expm1(np.abs(logs)), np.float32)

    def _quats(self) -> Floats:
        name = self._meta.quats.files[0]
        pixels = self._rows(name)
        if (pixels[:, 3] < FIRST_TAG).any():
            raise InputError(f"{self._path}: {name} holds something else than rotations")
        largest = pixels[:, 3].astype(np.int64) - FIRST_TAG
        others = (pixels[:, :3] / 255.0 * 2.0 - 1.0) * LARGEST_SMALL
        found = np.zeros((len(pixels), 4))
        np.put_along_axis(found, OTHERS[largest], others, axis=1)
        rest = np.sqrt(np.maximum(0.0, 1.0 - (others**2).sum(axis=1)))
        np.put_along_axis(found, largest[:, None], rest[:, None], axis=1)
        found /= np.linalg.norm(found, axis=1, keepdims=True)
        return np.asarray(np.where(found[:, :1] < 0.0, -found, found), np.float32)

    def _directions(self, palette: _Palette) -> Floats:
        """Coefficients of degrees above 0, shape (n, k, 3)."""
        image, labels_name = palette.files
        n_coefficients = (palette.bands + 1) ** 2 - 1
        height = -(-palette.count // PALETTE_COLUMNS)
        content = _file(self._archive, image, MOST_FILE_BYTES, self._path)
        width = PALETTE_COLUMNS * n_coefficients
        pixels = values_of(content, image, self._path, width * height + MOST_SPARE_PX)
        if pixels.shape[1] != width or pixels.shape[0] < height:
            raise InputError(
                f"{self._path}: {image} has {pixels.shape[1]} x {pixels.shape[0]} pixels; expected {width} x {height}"
            )
        entries = np.array(palette.codebook, np.float32)[pixels[..., :3].reshape(-1, n_coefficients, 3)]
        labels = self._rows(labels_name)[:, :2].astype(np.int64)
        numbers = labels[:, 0] + 256 * labels[:, 1]
        if int(numbers.max()) >= palette.count:
            raise InputError(f"{self._path}: {labels_name} names entry {int(numbers.max())} of {palette.count}")
        return np.asarray(entries[numbers])

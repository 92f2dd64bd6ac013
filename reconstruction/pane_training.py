r"""Training the network for panes.

    python -m reconstruction.pane_training --pool POOL --glass FOLDER --offices FOLDER --minutes 120 \
        --out reconstruction/panels/network/data/panes.safetensors

It learns from pictures made by chance, which POOL keeps, from traced facades, and from every second photo of two sets
whose licence allows it; the other photos are left to measure with. docs/concepts/segmentation.md has its data card.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from itertools import chain, islice
from pathlib import Path

from reconstruction.metrics.sets import PhotoSet, annotated_set, folder_set, made_set
from reconstruction.panels.network.random_pictures import MadePicture
from reconstruction.panels.network.training import LONGEST_PX, learned_photo, make_pool, read_pool, train
from reconstruction.scenes.facades.cases import wide_camera

FIRST_SEED = 100_000
"""Of traced facades that are learned from: no test and no benchmark uses seeds from here on."""

EVERY_SECOND = 2


def traced_facades(n_seeds: int) -> list[MadePicture]:
    """Facades of the program's own scenes."""
    sets = (made_set(name, n_seeds, wide_camera(640, 480), first_seed=FIRST_SEED) for name in KINDS)
    return list(chain.from_iterable(_learned(photos) for photos in sets))


KINDS = ("made-planar", "made-curved")


def _learned(photos: PhotoSet, every: int = 1) -> Iterator[MadePicture]:
    for photo in islice(photos.photos(), 0, None, every):
        for longest_px in LONGEST_PX:
            yield learned_photo(photo.image, photo.index, longest_px)


def main() -> None:
    """Read the arguments, make what is missing, learn."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, required=True, help="file of the weights")
    parser.add_argument("--pool", type=Path, required=True, help="folder that made pictures are kept in")
    parser.add_argument("--pictures", type=int, default=3000, help="how many of them")
    parser.add_argument("--processes", type=int, default=2, help="that make them side by side")
    parser.add_argument("--traced", type=int, default=40, help="traced facades of each kind")
    parser.add_argument("--glass", type=Path, help="folder with photos/ and truth/ of a curtain wall")
    parser.add_argument("--offices", type=Path, help="folder of the set of offices at night")
    parser.add_argument("--minutes", type=float, default=120.0, help="how long to learn, on one core")
    parser.add_argument("--start", type=Path, help="weights to go on from")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    made = read_pool(make_pool(options.pool, options.pictures, options.processes))
    photos: list[MadePicture] = []
    if options.glass is not None:
        glass = folder_set(options.glass / "photos", options.glass / "truth")
        photos += list(_learned(glass, EVERY_SECOND))
    if options.offices is not None:
        photos += _learned(annotated_set("offices", options.offices), EVERY_SECOND)
    sources = made, traced_facades(options.traced), photos
    _tell(f"{len(made)} made pictures, {len(sources[1])} traced facades, {len(photos)} photos")
    train(sources, options.minutes, options.out, options.start, options.seed, _tell)


def _tell(text: str) -> None:
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()

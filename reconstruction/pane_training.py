r"""Training the network for panes.

    python -m reconstruction.pane_training --pool POOL --glass FOLDER --offices FOLDER --minutes 120 \
        --out reconstruction/panels/network/data/panes.safetensors

It learns from pictures made by chance, which POOL keeps, from traced facades, and from every second photo of two sets
whose licence allows it; the other photos are left to measure with. docs/concepts/segmentation.md has its data card.

    python -m reconstruction.pane_training --glass FOLDER --offices FOLDER \
        --confidence reconstruction/panels/network/data/confidence.json

fits how probable its panes are, to the same photos and to made ones that it did not learn from; weights come first.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from itertools import chain, islice
from pathlib import Path

from reconstruction.metrics.sets import PhotoSet, annotated_set, folder_set, made_set
from reconstruction.panels.network.calibration import Source, calibrated, write_regressions
from reconstruction.panels.network.random_pictures import MadePicture, made_picture
from reconstruction.panels.network.training import LONGEST_PX, PER_FILE, learned_photo, make_pool, read_pool, train
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


CALIBRATED_PX = 512
"""Size of pictures made by chance that confidences are fitted to."""

N_CALIBRATED = 150, 8
"""How many of them, and traced facades of each kind."""

N_LEARNED_AT_MOST = 1000
"""Pictures by chance beyond so many times `PER_FILE`, and traced facades beyond so many, were not learned from."""

WEIGHTS = 0.3, 0.6, 0.5, 2.0
"""What glass, offices, traced facades and pictures by chance count in the confidences."""


def calibrate(glass: PhotoSet, offices: PhotoSet, out: Path) -> None:
    """Fit confidences to panes that the network with its present weights finds, and write them."""
    n_made, n_traced = N_CALIBRATED
    first = FIRST_SEED + N_LEARNED_AT_MOST
    facades = [made_set(name, n_traced, wide_camera(1200, 900), first_seed=first) for name in KINDS]
    made = (made_picture(PER_FILE * N_LEARNED_AT_MOST + seed, CALIBRATED_PX) for seed in range(n_made))
    pictures = (
        ((photo.image, photo.index) for photo in islice(glass.photos(), 0, None, EVERY_SECOND)),
        ((photo.image, photo.index) for photo in islice(offices.photos(), 0, None, EVERY_SECOND)),
        ((photo.image, photo.index) for photos in facades for photo in photos.photos()),
        ((picture.image, picture.index) for picture in made),
    )
    sources = [Source(each, weight) for each, weight in zip(pictures, WEIGHTS, strict=True)]
    write_regressions(calibrated(sources, _tell), out)


def main() -> None:
    """Read the arguments, make what is missing, learn."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    wanted = parser.add_mutually_exclusive_group(required=True)
    wanted.add_argument("--out", type=Path, help="learn, and write the weights to this file")
    wanted.add_argument("--confidence", type=Path, help="fit confidences to the weights that are there; their file")
    parser.add_argument("--pool", type=Path, help="folder that made pictures are kept in")
    parser.add_argument("--pictures", type=int, default=3000, help="how many of them")
    parser.add_argument("--processes", type=int, default=2, help="that make them side by side")
    parser.add_argument("--traced", type=int, default=40, help="traced facades of each kind")
    parser.add_argument("--glass", type=Path, help="folder with photos/ and truth/ of a curtain wall")
    parser.add_argument("--offices", type=Path, help="folder of the set of offices at night")
    parser.add_argument("--minutes", type=float, default=120.0, help="how long to learn, on one core")
    parser.add_argument("--start", type=Path, help="weights to go on from")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    if options.confidence is not None:
        if options.glass is None or options.offices is None:
            parser.error("--confidence needs --glass and --offices")
        glass = folder_set(options.glass / "photos", options.glass / "truth")
        calibrate(glass, annotated_set("offices", options.offices), options.confidence)
        return
    if options.pool is None:
        parser.error("--out needs --pool")
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

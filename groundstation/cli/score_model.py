"""`score MODEL DATASET`: its arguments, and what it prints."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

EPILOG = """PSNR and SSIM are of sRGB values, means over views; SSIM has a Gaussian window of 11 x 11 pixels.
LPIPS needs weights that you supply: a backbone (AlexNet or VGG16 as torchvision names them) and the linear
heads on it, .safetensors or .pth.

examples:
  score tower.model tower.dataset
  score tower.model tower.dataset --views all --json
  score tower.model tower.dataset --lpips alexnet.pth --lpips lpips-heads.pth
"""


def add_arguments(parser: Any) -> None:
    """Describe what is scored."""
    add = parser.add_argument
    add("model", type=Path, metavar="MODEL", help="folder of a model")
    add("dataset", type=Path, metavar="DATASET", help="folder of a data set of the same site")
    add("--views", choices=("held-out", "all"), default="held-out", help="default: those that were not learned from")
    add("--lpips", type=Path, action="append", default=[], metavar="WEIGHTS", help="file of weights; give it again")
    add("--fit-exposure", action="store_true", help="fit the exposure of each view to its photo before it is scored")
    add("--json", action="store_true", help="print one JSON object instead of text")


def run_model(options: argparse.Namespace) -> int:
    """Score and print; returns the exit status."""
    from groundstation.cli.console import counted, print_json, run_job
    from groundstation.services.model.scoring import score_files, score_summary

    scored = run_job(
        "score",
        lambda context: score_files(
            options.model,
            options.dataset,
            options.views,
            options.lpips,
            with_fitted_gain=options.fit_exposure,
            monitor=context,
        ),
    )
    summary = score_summary(scored)
    if options.json:
        print_json({"model": str(options.model), "dataset": str(options.dataset), **summary})
        return 0
    print(f"{options.model}: {counted(len(scored.views), 'view')}")
    print(f"  {'':<10}{'PSNR':>10}{'worst':>10}{'SSIM':>9}{'LPIPS':>9}")
    for part in ("facade", "whole"):
        row = summary[part]
        cells = (_cell(row["psnr_db"], 2, " dB"), _cell(row["worst_psnr_db"], 2, " dB"))
        rest = (_cell(row["ssim"], 4), _cell(row["lpips"], 4))
        print(f"  {part:<10}{cells[0]:>10}{cells[1]:>10}{rest[0]:>9}{rest[1]:>9}")
    print(f"  {scored.lpips}" if scored.lpips else "  LPIPS unavailable: give weights with --lpips")
    return 0


def _cell(value: float | None, digits: int, unit: str = "") -> str:
    return "-" if value is None else f"{value:.{digits}f}{unit}"

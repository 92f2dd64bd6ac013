"""`tradeoff scene`: its arguments, and what it prints."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from groundstation.cli.lists import counts, words
from groundstation.cli.options import add_profile_argument, checked_seed, effect_settings, in_words_of_options, number
from planning.base.errors import InputError

if TYPE_CHECKING:
    from groundstation.services.scenes.tradeoff import SceneTrials
    from groundstation.services.scenes.views import SceneRequest
    from reconstruction.tradeoff.scene_downstream import EffectWorth
    from reconstruction.tradeoff.scene_tradeoff import SceneVariants

EPILOG = """Every way to render is compared with the truth: the same photos by Mitsuba with every effect and
--truth-rays rays a pixel (--truth-rays 0: by the embedded renderer with 64). Rays, sizes and effects are turned one
at a time, all else as the scene decides. Panels are looked for in all of them, to see what that changes.

examples:
  tradeoff scene planar -o tradeoff
  tradeoff scene office.site.json -o tradeoff --width 1024 --widths 256,512 --rays 4,16,64 --truth-rays 1024
  tradeoff scene court -o tradeoff --truth-rays 0 --turn second-bounce,near-field-reflection
"""


LEAST_VIEWS = 8
"""That reflections are learned from, and scored on a part of."""


def add_arguments(parser: Any) -> None:
    """Describe what can be turned."""
    add = parser.add_argument
    add("scene", metavar="SITE|NAME", help="site file, or name of a bundled scene ('scene list')")
    add("--plan", type=Path, metavar="PLAN", help="take views of this plan (default: views square to each facade)")
    add("--views", type=int, metavar="N", help="number of photos (default 4)")
    add_profile_argument(parser)
    add("--look", type=Path, metavar="FILE", help="TOML file with glass, frames, surroundings and light of a site")
    add("--seed", type=int, default=0, metavar="N", help="of everything random (default 0)")
    add("--width", type=int, default=512, metavar="PX", help="of the photos (default 512)")
    add("--truth-rays", type=int, default=256, metavar="N", help="a pixel, of the truth (default 256)")
    add("--effects", action="append", default=[], metavar="SETTING", help="start: auto, none, all, NAME=on|off|auto")
    add("--tolerance", type=number, default=1.0, metavar="X", help="times each effect's own tolerance (default 1)")
    add(
        "--reflections",
        type=int,
        default=0,
        metavar="N",
        help="also learn reflections from N small photos, with all effects and without each (default 0: do not)",
    )
    varied = parser.add_argument_group("what varies (lists with commas)").add_argument
    varied(
        "--samples",
        type=counts,
        default="1,2,3,4",
        metavar="LIST",
        help="rays along a pixel's side (default: %(default)s)",
    )
    varied(
        "--widths",
        type=counts,
        default="128,256",
        metavar="LIST",
        help="rendered so wide and enlarged (default: %(default)s)",
    )
    varied(
        "--rays", type=counts, default=(), metavar="LIST", help="a pixel of Mitsuba, such as 4,16,64 (default: none)"
    )
    varied(
        "--turn",
        type=words,
        default="all",
        metavar="LIST",
        help="effects that are turned on or off (default: all; or none)",
    )


def run_scene(options: argparse.Namespace) -> int:
    """Compare and print; returns the exit status."""
    from groundstation.cli.console import show_tradeoff
    from groundstation.services.scenes.tradeoff import scene_tradeoff

    wish, variants = _wish(options), _variants(options)
    if options.truth_rays < 0:
        raise InputError(f"--truth-rays: expected 0 or more, got {options.truth_rays}")
    if options.reflections != 0 and not options.reflections >= LEAST_VIEWS:
        raise InputError(f"--reflections: expected {LEAST_VIEWS} or more photos, or 0, got {options.reflections}")
    return show_tradeoff(
        "scene",
        options.json,
        lambda context: scene_tradeoff(
            wish, variants, options.truth_rays or None, options.out, context, n_reflection_views=options.reflections
        ),
        _summary,
        _print,
    )


def _summary(found: SceneTrials) -> dict[str, Any]:
    from planning.base.json_file import plain_values
    from reconstruction.tradeoff.scene_downstream import worth_rows
    from reconstruction.tradeoff.scene_tradeoff import scene_rows, truth_error

    truth = found.truth
    return {
        "truth": {"name": truth.name, "seconds": truth.seconds, "error": truth_error(truth)},
        "effects": plain_values(found.decisions),
        "settings": scene_rows(truth, found.trials),
        "reflections": worth_rows(found.worths) if found.worths else [],
    }


def _wish(options: argparse.Namespace) -> SceneRequest:
    from groundstation.services.scenes.views import SceneRequest
    from reconstruction.scenes.effect_names import EFFECTS
    from reconstruction.scenes.photos.renderer import RenderSettings

    wishes = effect_settings(options.effects, EFFECTS)
    with in_words_of_options():
        return SceneRequest(
            scene=options.scene,
            plan=options.plan,
            n_views=options.views,
            profile_id=options.profile,
            look=options.look,
            seed=checked_seed(options.seed),
            width_px=options.width,
            settings=RenderSettings(wishes=wishes, tolerance=options.tolerance),
        )


def _variants(options: argparse.Namespace) -> SceneVariants:
    from reconstruction.tradeoff.scene_tradeoff import OF_A_PHOTO, SceneVariants

    turned = options.turn
    by_option = {name.lower().replace(" ", "-"): name for name in OF_A_PHOTO}
    if turned == ("all",):
        effects = OF_A_PHOTO
    elif turned == ("none",):
        effects = ()
    else:
        effects = tuple(by_option.get(word, word) for word in turned)
    return SceneVariants(options.samples, options.widths, options.rays, effects)


def _print(made: SceneTrials) -> None:
    from missions.simulator.build import effects_table
    from reconstruction.tradeoff.scene_tradeoff import scene_rows, truth_error

    own = truth_error(made.truth)
    accuracy = f", itself good to {255.0 * own:.2f} grey levels" if own else ""
    print(f"truth: {made.truth.name}, {made.truth.seconds:.1f} s a photo{accuracy}")
    print(f"effects:\n{effects_table(made.decisions)}")
    print(f"  {'setting':<36}{'ready in':>10}{'s a photo':>10}{'PSNR':>10}{'':>8}{'mIoU':>9}{'':>9}{'missed':>8}")
    for row in scene_rows(made.truth, made.trials):
        ready, error = " " * 10, " " * 18
        if "psnr_db" in row:
            ready, error = f"{row['prepare_s']:>8.2f} s", f"{row['psnr_db']:>7.1f} dB{row['psnr_change_db']:>+8.2f}"
        single, change = row["individual_miou"], row["individual_miou_change"]
        found = f"{'-':>9}" if single is None else f"{single:>9.4f}{change:>+9.4f}{row['missed']:>8}"
        print(f"  {row['setting']:<36}{ready}{row['seconds']:>10.3f}{error}{found}")
    if made.worths:
        _print_worths(made.worths)


def _print_worths(worths: Sequence[EffectWorth]) -> None:
    from reconstruction.tradeoff.scene_downstream import worth_rows

    print("  reflections learned from photos, scored on glass of unseen views that have all that the scene calls for:")
    print(f"  {'photos':<36}{'rendered in':>12}{'PSNR':>10}{'lost':>9}{'worst':>10}{'on their own kind':>20}")
    for row in worth_rows(worths):
        print(
            f"  {row['photos']:<36}{row['photos_s']:>10.1f} s{row['psnr_db']:>7.2f} dB{row['lost_db']:>+6.2f} dB"
            f"{row['worst_db']:>7.2f} dB{row['own_db']:>17.2f} dB"
        )

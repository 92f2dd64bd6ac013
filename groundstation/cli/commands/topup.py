"""`topup`: what a flight left open to a short flight that closes it."""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from groundstation.cli.console import counted, print_findings, print_json, print_next, run_job, tell
from groundstation.cli.options import (
    add_pose_arguments,
    checked_seed,
    in_words_of_options,
    json_file,
    number,
    refine_request,
)
from planning.base.errors import InputError
from planning.base.messages import say

if TYPE_CHECKING:
    from groundstation.services.photos.top_up import PhotoTopUp
    from planning.revision.top_up import TopUp

EPILOG = """What was seen is decided by the poses of the photos, not by the views that they were meant to be. The plan
that is written is checked, exported and flown like any other. With --photos a quick model of what the panes mirror
learns from the photos first; the sorties bring most for the model, and the site is compared with what was seen.

examples:
  topup flight.json office.plan.json office.site.json -o topup.plan.json
  topup flight.json office.plan.json office.site.json -o topup.plan.json --battery 0.55
  topup flight.json office.plan.json office.site.json -o rest.plan.json --resume
  topup office.plan.json office.site.json --photos /media/card/DCIM -o second.plan.json --battery 0.8
"""


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser(
        "topup",
        help="plan the shortest flight that closes what a flight left open, or the one its photos call for",
        description="Compare a flight with its plan and plan the shortest flight that shows what is missing,\n"
        "within the battery that is left; or write the rest of a sortie that was interrupted; or plan the\n"
        "next battery from the photos of the last.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run)
    add = parser.add_argument
    add("flight", type=Path, nargs="?", metavar="FLIGHT", help="flight file, or a log (.tlog, .BIN, .ulg)")
    add("plan", type=Path, metavar="PLAN", help="plan file that was flown")
    add("site", type=Path, metavar="SITE", help="site file, as the site is now")
    add("-o", "--out", type=json_file, required=True, metavar="PLAN", help="plan file to write")
    add("--battery", type=number, metavar="CHARGE", help="charge of the battery on board, 0 to 1 (default: changed)")
    add("--batteries", type=int, metavar="N", help="full batteries that may be used (default: none beside --battery)")
    add(
        "--target",
        choices=("promised", "reachable"),
        help="what the plan had promised (default), or everything that can be seen",
    )
    add("--all", action="store_true", help="write a top-up for a negligible rest, too (at most 0.5 %% of the sections)")
    add("--photos", type=Path, metavar="FOLDER", help="photos of the last flight, or their data set, without FLIGHT")
    add("--learn", type=number, metavar="S", help="wall time for learning from --photos (default 40 s)")
    add("--time-budget", type=number, metavar="S", help="longest wall time (default 5 s; 60 s for --photos)")
    add("--seed", type=int, default=0, metavar="N", help="of everything random (default 0)")
    add("--resume", action="store_true", help="the rest of the sortie that was interrupted, as it was planned")
    add("--sortie", type=int, metavar="N", help="with --resume: which sortie (default: the last that is not complete)")
    add_pose_arguments(parser)
    add("--json", action="store_true", help="print one JSON object instead of text")


def run(options: argparse.Namespace) -> int:
    """Plan and write; returns the exit status."""
    if options.battery is not None and not 0.0 <= options.battery <= 1.0:
        raise InputError(say("expected a charge from 0 to 1, got {:g}", options.battery, place="--battery"))
    if options.photos is not None:
        return _from_photos(options)
    if options.flight is None:
        raise InputError(
            say("is missing: a flight file or a log, or --photos with the photos themselves", place="FLIGHT")
        )
    _check_options(options, {"--learn": options.learn, "--colmap": options.colmap, "--refine": options.refine or None})
    if options.resume:
        return _resume(options)
    if options.sortie is not None:
        raise InputError(say("is for --resume; a top-up closes what all sorties left open", place="--sortie"))
    return _top_up(options)


def _check_options(options: argparse.Namespace, given: dict[str, object]) -> None:
    """What belongs to the other way of asking, and is not None, is refused."""
    for option, value in given.items():
        if value is not None:
            needs = options.photos is None
            raise InputError(
                say("belongs to --photos", place=option) if needs else say("is not for --photos", place=option)
            )


def _from_photos(options: argparse.Namespace) -> int:
    from groundstation.services.photos.top_up import PhotoTopUpRequest, photo_top_up_files, photo_top_up_summary

    others = {
        "FLIGHT": options.flight,
        "--target": options.target,
        "--all": options.all or None,
        "--resume": options.resume or None,
        "--sortie": options.sortie,
    }
    _check_options(options, others)
    chosen = {
        "battery": options.battery,
        "n_batteries": options.batteries,
        "learn_s": options.learn,
        "time_budget_s": options.time_budget,
    }
    with in_words_of_options(PhotoTopUpRequest):
        request = PhotoTopUpRequest(
            seed=checked_seed(options.seed), **{name: value for name, value in chosen.items() if value is not None}
        )
    refine, begun_s = refine_request(options), time.perf_counter()
    found = run_job(
        "topup",
        lambda context: photo_top_up_files(
            options.photos,
            options.plan,
            options.site,
            options.out,
            request,
            heights=options.heights,
            colmap=options.colmap,
            refine=refine,
            stop=context.stop,
            trace=context.trace,
            monitor=context,
        ),
    )
    if options.json:
        print_json(photo_top_up_summary(found, time.perf_counter() - begun_s))
        return 0
    _print_from_photos(found, options.out)
    print_findings(found.findings)
    print_next("check", options.out, options.site)
    return 0


def _print_from_photos(found: PhotoTopUp, out: Path) -> None:
    look, plan = found.look, found.planned.plan
    tell(
        "{} looked at in {:.0f} s; glass of held-out photos: {:.1f} dB",
        counted(look.n_photos, "photo"),
        look.seconds,
        look.psnr_db,
    )
    tell(
        "{} in {}, {:.1f} min in the air",
        counted(len(plan.viewpoints), "view"),
        counted(len(plan.sorties), "sortie"),
        plan.duration_s / 60,
        place=out,
    )
    if found.planned.before_db is not None and plan.worth is not None:
        tell("unseen views of a model of the photos, expected: {:.1f} dB", found.planned.before_db)
        tell("with this flight: {}", plan.worth.text)


def _top_up(options: argparse.Namespace) -> int:
    from groundstation.services.plan.top_up import top_up_files, top_up_summary
    from planning.revision.top_up import Target, TopUpRequest

    with in_words_of_options():
        request = TopUpRequest(
            Target(options.target or "promised"),
            options.battery,
            options.batteries,
            checked_seed(options.seed),
            5.0 if options.time_budget is None else options.time_budget,
        )
    files = options.flight, options.plan, options.site, options.out
    found, findings = run_job(
        "topup",
        lambda context: top_up_files(
            *files, request, everything=options.all, stop=context.stop, trace=context.trace, monitor=context
        ),
    )
    is_left = found.is_negligible and not options.all
    if options.json:
        print_json({**top_up_summary(found, findings), "written": found.plan is not None and not is_left})
        return 0
    _print_top_up(found, options.out, is_left)
    print_findings(findings)
    if found.plan is not None and not is_left:
        print_next("check", options.out, options.site)
    return 0


def _print_top_up(found: TopUp, out: Path, is_left: bool) -> None:
    from groundstation.services.units import per_cent

    share = per_cent(found.delivered, found.promised, 2)
    tell(
        "the photos show {} of the {} sections that the plan promised ({:.2f} %)",
        found.delivered,
        found.promised,
        share,
    )
    plan = found.plan
    if plan is None:
        missing = say("nothing is missing") if found.wanted == 0 else say("what is missing cannot be shown")
        tell("{}; no top-up is needed, and none was written", missing)
        return
    if is_left:
        tell("no top-up was written; --all writes it all the same")
        return
    tell(
        "{} in {}, {:.1f} min in the air, close {} of {} missing sections",
        counted(len(plan.viewpoints), "view"),
        counted(len(plan.sorties), "sortie"),
        plan.duration_s / 60,
        found.closed,
        found.wanted,
        place=out,
    )
    for position, sortie in enumerate(plan.sorties, 1):
        battery = say("the battery on board") if found.on_board and position == 1 else say("a full battery")
        tell(
            "  sortie {}, on {}: {}, {:.0f} m, {:.1f} min",
            position,
            battery,
            counted(len(sortie.viewpoint_ids), "view"),
            sortie.length_m,
            sortie.duration_s / 60,
        )
    tell("covered before {}, together {} sections", found.seen, found.together)
    if found.shortest_s is not None:
        tell("no single flight over the views that were compared takes less than {:.1f} min", found.shortest_s / 60)
    elif found.closed < found.bound:
        tell("no choice from the views that were compared closes more than {} on these batteries", found.bound)


def _resume(options: argparse.Namespace) -> int:
    from groundstation.services.plan.top_up import resume_files, resumed_summary

    if options.batteries is not None:
        raise InputError(say("is not for --resume, which fits one battery", place="--batteries"))
    files = options.flight, options.plan, options.site, options.out
    rest, findings = run_job(
        "resume", lambda context: resume_files(*files, options.sortie, options.battery, monitor=context)
    )
    if options.json:
        print_json(resumed_summary(rest, findings))
        return 0
    sortie = rest.plan.sorties[0]
    tell(
        "rest of sortie {} from {} on, {}, {:.0f} m, {:.1f} min",
        rest.mission.number,
        sortie.viewpoint_ids[0],
        counted(len(sortie.viewpoint_ids), "view"),
        sortie.length_m,
        sortie.duration_s / 60,
        place=options.out,
    )
    print_findings(findings)
    print_next("check", options.out, options.site)
    return 0

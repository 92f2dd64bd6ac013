"""`scene`: photographs of a site that are rendered, with all that is true of them."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from groundstation.cli.console import counted, print_findings, print_json, run_job, show, tell, worded
from groundstation.cli.options import (
    add_parameter,
    add_profile_argument,
    effect_settings,
    in_words_of_options,
    new_folder,
    typed_values,
)
from planning.base.errors import InputError
from planning.base.messages import glue, say
from planning.base.parameters import declared, with_values
from reconstruction.scenes.parameters import MITSUBA_RAYS, RenderSettings, SceneRequest

if TYPE_CHECKING:
    from groundstation.services.scenes.photos import RenderedScene

EPILOG = """views (without any of them 24 are planned):
  --plan PLAN      those of a plan, by its camera
  --flight FLIGHT  where photos of a flight were really taken; with --plan by its camera, else by --profile's
  --views N        so many, planned here
  --square N       so many from before each facade in turn, as a first flight takes them to look for panels

effects:
  --effects auto             what the scene and the views call for (default)
  --effects none             none of them; --effects all: all
  --effects panel-tilt=on    one by name; give it several times, also behind none or all
  Names are printed with each run.

A run that was interrupted goes on where it stopped when the same is asked for again.

examples:
  scene render planar -o planar.photos --views 12 --width 512
  scene render office.site.json --plan office.plan.json -o office.photos
  scene render office.site.json --plan office.plan.json -o office.photos --camera m3e.toml
  scene render court -o judged.photos --views 2 --width 256 --renderer mitsuba --rays 256
  scene render office.site.json --flight office.flight.json --plan office.plan.json -o flown.photos --seed 3
"""


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser("scene", help="render photos of a site, with their truth")
    actions = parser.add_subparsers(title="actions", metavar="ACTION", required=True)
    listing = actions.add_parser("list", help="list the bundled scenes")
    listing.set_defaults(run=run_list)
    listing.add_argument("--json", action="store_true", help="print one JSON object instead of text")
    render = actions.add_parser(
        "render",
        help="render photos and their truth into a folder",
        description="Render the photos that a plan or flight takes of a site with glass panels, and write for each\n"
        "its depth, normals, panels, glass, and the picture without and of mirror images alone.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    render.set_defaults(run=run_render)
    add = render.add_argument
    add("scene", metavar="SITE|NAME", help="site file, or name of a bundled scene ('scene list')")
    add("-o", "--out", type=new_folder, required=True, metavar="DIR", help="folder for the photos")
    add("--plan", type=Path, metavar="PLAN", help="plan file")
    add("--flight", type=Path, metavar="FLIGHT", help="flight file, of 'simulate' or 'report'")
    add_profile_argument(render)
    for each in declared(SceneRequest).values():
        if each.parameter.option:
            add_parameter(render, each)
    add("--look", type=Path, metavar="FILE", help="TOML file with glass, frames, surroundings and light of a site")
    add("--camera", type=Path, metavar="FILE", help="TOML file with shutter, speed, exposure, lens and pose errors")
    add("--effects", action="append", default=[], metavar="SETTING", help="auto, none, all, or NAME=on|off|auto")
    add(
        "--renderer",
        choices=("embedded", "mitsuba"),
        default="embedded",
        help="what makes the light (default embedded)",
    )
    add("--jobs", type=int, metavar="N", help="photos rendered side by side (default: one for every four cores)")
    add("--cluster", metavar="ADDRESS", help="render on a Dask cluster, such as tcp://10.0.0.5:8786")
    add("--json", action="store_true", help="print one JSON object instead of text")


def run_list(options: argparse.Namespace) -> int:
    """Print the bundled scenes; returns the exit status."""
    from groundstation.services.scenes.views import BUNDLED_TEXTS

    if options.json:
        print_json({"scenes": BUNDLED_TEXTS})
    else:
        for name, text in BUNDLED_TEXTS.items():
            show(glue(f"{name:<12} ", text))
    return 0


def run_render(options: argparse.Namespace) -> int:
    """Render, write and print; returns the exit status."""
    from groundstation.services.scenes.photos import render_photos, rendered_summary

    request = _request(options)
    if options.jobs is not None and options.jobs < 1:
        raise InputError(say("expected 1 or more, got {}", options.jobs, place="--jobs"))
    if options.jobs is not None and options.cluster is not None:
        raise InputError(say("--jobs is for this machine; leave it out, or --cluster"))
    rendered = run_job(
        "scene",
        lambda context: render_photos(request, options.out, options.jobs, context, address=options.cluster),
    )
    if options.json:
        print_json(rendered_summary(rendered))
    else:
        _print_text(rendered)
    return 0


def _request(options: argparse.Namespace) -> SceneRequest:
    from reconstruction.scenes.effects.registry import effect_names

    settings = effect_settings(options.effects, effect_names())
    typed = typed_values(options, SceneRequest)
    rays = ("settings", "mitsuba_rays")
    if options.renderer == "mitsuba":
        typed.setdefault(rays, MITSUBA_RAYS)
    elif rays in typed:
        raise InputError(say("--rays is for Mitsuba; add --renderer mitsuba, or leave it out"))
    with in_words_of_options(SceneRequest):
        files = {name: getattr(options, name) for name in ("scene", "plan", "flight", "look", "camera")}
        request = SceneRequest(**files, profile_id=options.profile, settings=RenderSettings(effects=settings))
        return with_values(request, typed)


def _print_text(rendered: RenderedScene) -> None:
    from missions.simulator.build import effects_table

    written = rendered.written
    kept = say(", {} of them kept", written.n_kept) if written.n_kept else ""
    tell("{} of '{}'{}", counted(len(written.photos), "photo"), rendered.scene, kept, place=written.folder)
    tell("effects:\n{}", effects_table(written.decisions, worded))
    tell("rendered in {:.1f} s", rendered.seconds)
    print_findings(rendered.findings)

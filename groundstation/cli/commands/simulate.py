"""`simulate`: fly a plan with the simulated vehicle, or with one at the end of a link."""

from __future__ import annotations

import argparse
import os
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from groundstation.cli.console import flight_status, print_findings, print_json, run_job, show, tell, worded
from groundstation.cli.options import add_parameter, checked_seed, in_words_of_options, json_file, number, typed_values
from groundstation.cli.options import effect_settings as settings_of_effects
from missions.simulator.conditions import Conditions
from planning.base.errors import InputError
from planning.base.messages import about, say
from planning.base.parameters import declared, with_values

if TYPE_CHECKING:
    from groundstation.services.fly.flying import FlightRequest, Flown
    from missions.mavlink.remote_id import RemoteId
    from planning.base.effects import EffectSetting
    from planning.base.progress import Monitor

EPILOG = """effects:
  --effects auto             what the scene calls for (default)
  --effects none             none of them; --effects all: all
  --effects wind=on          one by name; give it several times, also behind none or all
  Names are printed with each flight, such as gnss-noise, multipath, gimbal-lag.

a vehicle at a link:
  --link tcp:127.0.0.1:5760  a simulation of ArduPilot or PX4. It is set up, armed and started.
  A vehicle that does not say itself that it is a simulation takes off only with --take-off, wherever it is: programs
  on this machine pass links on to aircraft. Its parameters are compared, and set only with --set-parameters.
  --overrule return, home-height or parameters flies though that line of the list before take-off grounds it;
  --overrule foreign-fence removes a geofence that this ground station did not put on the vehicle.

examples:
  simulate office.plan.json office.site.json -o office.flight.json
  simulate office.plan.json office.site.json -o windy.flight.json --wind 8 --gnss single
"""

PASSWORD_VARIABLE = "REFLIGHT_NTRIP_PASSWORD"

SITL_SPEEDUP = 10.0
"""Ten times is flown the same as real time, and leaves the link's time-outs room."""

MAY_BE_REAL = say("this could be a real aircraft, and 'simulate' takes off by itself; add --take-off if it may")
NO_SIMULATION = say("the vehicle does not say that it is a simulation: {}; nothing was changed on it", MAY_BE_REAL)


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser(
        "simulate",
        help="fly a plan in simulation and report what was covered",
        description="Upload a plan to a simulated vehicle over MAVLink, fly all its sorties, and compare every photo\n"
        "with what was planned. The flight and its report are written.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run)
    add = parser.add_argument
    add("plan", type=Path, metavar="PLAN", help="plan file")
    add("site", type=Path, metavar="SITE", help="site file")
    add("-o", "--out", type=json_file, required=True, metavar="FLIGHT", help="flight file to write")
    add("--link", default="sim", metavar="URL", help="sim (default), or the url of a vehicle")
    add("--autopilot", choices=("ardupilot", "px4"), help="which one is simulated, or expected (default: by profile)")
    for name, each in declared(Conditions).items():
        if each.parameter.option:
            unset = "what the plan expects" if name == "wind_m_s" else ""
            add_parameter(parser, replace(each, default=None if unset else each.default), unset=unset)
    add("--effects", action="append", default=[], metavar="SETTING", help="auto, none, all, or NAME=on|off|auto")
    add("--seed", type=int, default=0, help="of everything random (default 0)")
    add("--speedup", type=number, metavar="X", help="times real time (default: as fast as it goes)")
    add("--sitl", type=Path, metavar="BINARY", help="start this arducopter and fly it")
    add("--sitl-defaults", type=Path, metavar="PARM", help="more parameters for it, such as copter.parm")
    add("--take-off", action="store_true", help="let the vehicle at the link take off, wherever it is")
    add(
        "--set-parameters",
        action="store_true",
        help="set its parameters as the plan needs them; else they are compared",
    )
    add("--raise", type=number, dest="raised", metavar="M", help="take-off lies this much lower than the planned home")
    add("--overrule", action="append", default=[], metavar="CHECK", help="fly though this check grounds it")
    add("--signed", action="store_true", help="sign the link with this computer's key ('signing set')")
    add("--operator", metavar="NUMBER", help="operator's registration number, for vehicles with remote ID")
    add("--serial-number", default="", metavar="TEXT", help="of the aircraft, for remote ID (default: its module's)")
    add("--camera-definition", type=Path, metavar="FILE", help="definition file of its camera, to be set by")
    add("--ntrip", metavar="CASTER", help="RTK corrections for the vehicle: [ntrips://]USER@HOST:PORT/MOUNTPOINT")
    add("--logs", type=Path, metavar="DIR", help="folder for telemetry logs of a link (default: beside FLIGHT)")
    add("--json", action="store_true", help="print one JSON object instead of text")


def run(options: argparse.Namespace) -> int:
    """Fly and print; returns the exit status."""
    flown = run_job("simulate", lambda context: _fly(options, context))
    if options.json:
        print_json(_summary(flown, options))
    else:
        _print_text(flown, options)
    assert flown.flight.report is not None
    return flight_status(flown.flight.report)


def _fly(options: argparse.Namespace, monitor: Monitor) -> Flown:
    from groundstation.services.fly.flying import fly_files

    if options.sitl is None:
        between = _battery_change if sys.stdin is not None and sys.stdin.isatty() else None
        return fly_files(options.plan, options.site, options.out, _request(options), monitor=monitor, between=between)
    from groundstation.services.fly.flying import SITL_LINK, sitl
    from groundstation.services.project.input_files import read_input_plan, read_input_site
    from missions.mission.build import missions_from_plan

    site, plan = read_input_site(options.site).site, read_input_plan(options.plan)
    first = missions_from_plan(plan, site.origin, site.home_enu_m)[0]
    speedup, options.speedup, options.link = options.speedup or SITL_SPEEDUP, None, SITL_LINK
    endurance_s = plan.aircraft.endurance_s
    with sitl(options.sitl, first.takeoff, speedup, endurance_s, options.sitl_defaults, monitor) as restart:
        return fly_files(options.plan, options.site, options.out, _request(options), monitor=monitor, between=restart)


def _battery_change(number: int) -> None:
    """Let the pilot change the battery; whoever is not at a terminal is told by the list before take-off."""
    tell("\nsortie {} comes next: put in a full battery, then press Enter", number, file=sys.stderr)
    sys.stdin.readline()


def _request(options: argparse.Namespace) -> FlightRequest:
    from groundstation.services.fly.flying import SIMULATED, FlightRequest
    from groundstation.services.fly.signing import link_signer
    from missions.mavlink.autopilots import Autopilot
    from missions.mavlink.camera_definition import read_definition
    from missions.mavlink.ntrip import caster_of

    if options.speedup is not None and not options.speedup > 0.0:
        raise InputError(say("expected more than 0, got {:g}", options.speedup, place="--speedup"))
    is_simulated = options.link == SIMULATED
    if not is_simulated:
        _check_link(options)
    elif options.set_parameters or options.take_off or options.overrule or options.raised is not None:
        raise InputError(
            say("--take-off, --set-parameters, --raise and --overrule are for --link URL; nothing real moves here")
        )
    only_linked = ("signed", "operator", "ntrip", "camera_definition")
    for option, value in ((f"--{name.replace('_', '-')}", getattr(options, name)) for name in only_linked):
        if is_simulated and value:
            raise InputError(
                say("is for --link URL; the simulation in this program has no link to listen to", place=option)
            )
    with in_words_of_options(Conditions):
        conditions = with_values(Conditions(), typed_values(options, Conditions))
    if not hasattr(options, "wind"):
        from groundstation.services.project.input_files import read_input_plan

        conditions = replace(conditions, wind_m_s=read_input_plan(options.plan).rules.wind_m_s)
    return FlightRequest(
        link=options.link,
        autopilot=None if options.autopilot is None else Autopilot(options.autopilot),
        conditions=conditions,
        effects=effect_settings(options.effects),
        seed=checked_seed(options.seed),
        speedup=options.speedup,
        simulations_only="" if is_simulated or options.take_off else NO_SIMULATION,
        sets_parameters=options.set_parameters,
        overrules=_overrules(options.overrule),
        raised_m=options.raised or 0.0,
        log_folder=None if is_simulated else (options.logs or options.out.parent / "logs"),
        signer=link_signer() if options.signed else None,
        identity=_identity(options),
        camera_definition=(None if options.camera_definition is None else read_definition(options.camera_definition)),
        caster=None if options.ntrip is None else caster_of(options.ntrip),
        caster_password=_caster_password(options),
    )


def _caster_password(options: argparse.Namespace) -> str:
    """From the environment, or typed unseen; none for a caster without a user."""
    if options.ntrip is None or "@" not in options.ntrip:
        return ""
    known = os.environ.get(PASSWORD_VARIABLE)
    if known is not None or not sys.stdin.isatty():
        return known or ""
    from getpass import getpass

    return getpass(worded(say("password of the caster: ")))


def _identity(options: argparse.Namespace) -> RemoteId:
    """What the operator says of itself."""
    from missions.mavlink.remote_id import NOBODY, operator_number, serial_number

    serial = serial_number(options.serial_number) if options.serial_number else ""
    if options.operator is None:
        return replace(NOBODY, serial_number=serial)
    number = operator_number(options.operator)
    if number.is_eu and not number.is_proved:
        tell("the operator number has the right form; with its secret part its checksum can be proved", file=sys.stderr)
    return replace(NOBODY, operator=number.public, serial_number=serial)


def _overrules(codes: list[str]) -> frozenset[str]:
    from groundstation.vehicle.preflight import OVERRULABLE

    for code in codes:
        if code not in OVERRULABLE:
            raise InputError(
                say("expected one of {}, got '{}'", ", ".join(sorted(OVERRULABLE)), code, place="--overrule")
            )
    return frozenset(codes)


def _check_link(options: argparse.Namespace) -> None:
    """Refuse what would be ignored, and to start what may be an aircraft."""
    from missions.mavlink.link import parsed_url

    kind, _, _ = parsed_url(options.link)
    if options.effects or hasattr(options, "wind") or options.speedup is not None:
        raise InputError(say("--effects, --wind and --speedup are for --link sim; the vehicle at a link has its own"))
    if kind == "serial" and not options.take_off:
        raise InputError(about(f"--link {options.link}", MAY_BE_REAL))


def effect_settings(texts: list[str]) -> dict[str, EffectSetting]:
    """Settings by the names of the simulation's effects.

    Raises
    ------
    InputError
        A text is no setting, or names no effect.
    """
    from missions.simulator.build import EFFECTS

    return settings_of_effects(texts, [effect.name for effect in EFFECTS])


def _summary(flown: Flown, options: argparse.Namespace) -> dict[str, Any]:
    from missions.flight.report import report_to_json
    from planning.base.json_file import plain_values

    report = flown.flight.report
    assert report is not None
    return {
        "flight": str(options.out),
        "link": options.link,
        **report_to_json(report),
        "effects": plain_values(flown.sorties[0].effects if flown.sorties else ()),
        "logs": [str(sortie.log) for sortie in flown.sorties if sortie.log is not None],
        "notes": [plain_values(sortie.notes) for sortie in flown.sorties],
        "plan_findings": plain_values(flown.findings),
        "seconds": round(flown.seconds, 3),
    }


def _print_text(flown: Flown, options: argparse.Namespace) -> None:
    from missions.flight.report import report_text
    from missions.simulator.build import effects_table

    report = flown.flight.report
    assert report is not None
    tell("flight:   {} ({}, {:.1f} s)", options.out, flown.flight.sorties[0].vehicle, flown.seconds)
    show(report_text(report))
    for sortie in flown.sorties:
        if sortie.log is not None:
            tell("log:      {}", sortie.log)
        for note in sortie.notes:
            if note.code == "log" or note.code.startswith("warning-"):
                tell("warning: sortie {}, {:.0f} s: {}", sortie.number, note.time_s, note.text, file=sys.stderr)
    print_findings(flown.findings)
    if flown.sorties and flown.sorties[0].effects:
        tell("effects:\n{}", effects_table(flown.sorties[0].effects, worded))

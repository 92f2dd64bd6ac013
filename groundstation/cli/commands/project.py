"""`project`: a folder with a site, its plans and what belongs to them, as the window keeps it."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from groundstation.cli.console import counted, print_findings, print_json, print_next, tell
from planning.base.messages import joined, say

if TYPE_CHECKING:
    from groundstation.services.project.folder import OpenedProject

EPILOG = """examples:
  project new my-building --site office.site.json --name 'My building'
  plan my-building/site/site.json -o south.plan.json
  project add my-building south.plan.json
  project show my-building
"""


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser(
        "project",
        help="keep a site and its plans together in a project folder",
        description="Make, show, fill and bring up to date the project folders that the window works on.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    actions = parser.add_subparsers(title="actions", metavar="ACTION", required=True)
    new = _add_action(actions, "new", run_new, "make a project of a site file; the file is copied")
    new.add_argument("--site", type=Path, required=True, metavar="SITE", help="site file")
    new.add_argument("--name", default="", help="name of the project (default: the folder's)")
    show = _add_action(actions, "show", run_show, "say what is in a project")
    show.add_argument("--json", action="store_true", help="print one JSON object instead of text")
    add = _add_action(actions, "add", run_add, "add plans to a project; the files are copied")
    add.add_argument("plans", type=Path, nargs="+", metavar="PLAN", help="plan file")
    _add_action(actions, "migrate", run_migrate, "bring a project of an older version, or loose files, up to date")


def _add_action(actions: Any, name: str, run: Any, text: str) -> argparse.ArgumentParser:
    command: argparse.ArgumentParser = actions.add_parser(name, help=text, description=f"{text.capitalize()}.")
    command.add_argument("folder", type=Path, metavar="FOLDER", help="folder of the project")
    command.set_defaults(run=run)
    return command


def run_new(options: argparse.Namespace) -> int:
    """Make a project; returns the exit status."""
    from groundstation.services.project.document import Document
    from groundstation.services.project.folder import create_project, facades_beside, open_project
    from groundstation.services.project.input_files import read_input_site

    document = Document(read_input_site(options.site), found_facades=facades_beside(options.site))
    create_project(options.folder, document, name=options.name, site_source=options.site)
    project = open_project(options.folder)
    _print(project)
    print_next("plan", options.folder / project.record.site, "-o", "plan.json")
    return 0


def run_show(options: argparse.Namespace) -> int:
    """Show a project; returns the exit status."""
    from groundstation.services.plan.planning import finding_summary
    from groundstation.services.project.folder import open_project
    from groundstation.services.project.migration import VERSION
    from groundstation.services.project.recovery import find_recovery

    project = open_project(_folder_of_project(options.folder))
    recovery = find_recovery(project.folder)
    if options.json:
        content = _summary(project)
        content["notes"] = [finding_summary(note) for note in project.notes]
        content["unsaved_work"] = None if recovery is None else list(recovery.changes)
        print_json(content)
        return 0
    _print(project)
    if recovery is not None:
        unsaved = recovery.problem or say("{}; open the project in the window", joined(", ", recovery.changes))
        tell("unsaved: {}", unsaved)
    print_findings(project.notes)
    if project.version < VERSION:
        print_next("project", "migrate", options.folder)
    return 0


def run_add(options: argparse.Namespace) -> int:
    """Add plans to a project; returns the exit status."""
    from groundstation.services.project.folder import add_plans, open_project, save_project
    from groundstation.services.project.lock import lock_project

    with lock_project(_folder_of_project(options.folder)) as lock:
        project = open_project(lock.folder)
        document, notes = add_plans(project.document, options.plans)
        save_project(lock.folder, document)
    print_findings((*project.notes, *notes))
    tell("{} added, {} in the project", counted(len(options.plans), "plan"), len(document.plans), place=options.folder)
    print_next("project", "show", options.folder)
    return 0


def run_migrate(options: argparse.Namespace) -> int:
    """Save a project in the present format; returns the exit status."""
    from groundstation.services.project.folder import open_project, save_project
    from groundstation.services.project.lock import lock_project
    from groundstation.services.project.migration import FORMAT, VERSION

    with lock_project(_folder_of_project(options.folder)) as lock:
        project = open_project(lock.folder)
        if project.version < VERSION:
            save_project(lock.folder, project.document)
    print_findings(note for note in project.notes if note.code not in ("loose-files", "old-format"))
    if project.version == VERSION:
        tell("in format '{}{}' already, nothing to do", FORMAT, VERSION, place=options.folder)
    else:
        tell("now in format '{}{}' (see project.json)", FORMAT, VERSION, place=options.folder)
    return 0


def _folder_of_project(path: Path) -> Path:
    """Folder of a project that can be read: nothing else gets a lock file."""
    from groundstation.services.project.input_files import FileKind, expecting
    from groundstation.services.project.project_file import project_folder, read_index

    with expecting(FileKind.PROJECT, path):
        folder = project_folder(path)
        read_index(folder)
    return folder


def _summary(project: OpenedProject) -> dict[str, Any]:
    record, document = project.record, project.document
    site = document.site
    files = {plan.id: plan.file for plan in record.plans}
    return {
        "folder": str(project.folder),
        "name": project.name,
        "version": project.version,
        "site": None
        if site is None
        else {"file": record.site, "name": site.site.name, "panels": site.site.n_panels, "sha256": site.sha256},
        "plans": [
            {
                "id": entry.id,
                "title": entry.title,
                "file": files[entry.id],
                "method": entry.plan.method,
                "views": len(entry.plan.viewpoints),
                "covered": entry.plan.coverage.covered,
                "reachable_upper_bound": entry.plan.coverage.reachable_upper_bound,
                "sorties": len(entry.plan.sorties),
                "duration_s": round(entry.plan.duration_s, 1),
                "is_current": entry.id == document.current_plan_id,
            }
            for entry in document.plans
        ],
    }


def _print(project: OpenedProject) -> None:
    from groundstation.services.units import minutes_text, per_cent

    content = _summary(project)
    tell("project: {}", content["name"])
    site = content["site"]
    if site is None:
        tell("site:    none yet")
    else:
        tell("site:    {}, {} ({})", site["name"], counted(site["panels"], "panel"), site["file"])
    tell("plans:   {}", len(content["plans"]))
    for plan in content["plans"]:
        bound = plan["reachable_upper_bound"]
        share = say(", {:.1f} % of what is possible", per_cent(plan["covered"], bound)) if bound else ""
        tell(
            "  {}: {}{}, {} in {} ({}, {})",
            plan["title"],
            counted(plan["views"], "view"),
            share,
            counted(plan["sorties"], "sortie"),
            minutes_text(plan["duration_s"]),
            plan["method"],
            plan["file"],
        )

"""`records`: what is known about the panes of a building, kept beside its model."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any

from groundstation.cli.console import counted, print_json, print_next, print_notes, run_job, show, tell
from groundstation.cli.options import count
from planning.base.errors import InputError
from planning.base.files import FILE_ENDING
from planning.base.messages import glue, say

EPILOG = """examples:
  records tower.gsscene make
  records tower.records make --objects tower.site.json
  records tower.gsscene set A-0012 maker='Glas AG' 'thickness=28' 'u-value [W/m²K] (number)=1.1'
  records tower.gsscene add A-0012 inspection date=2026-03-31 inspector=Chan method=drone result=crack
  records tower.gsscene add A-0012 defect kind=crack severity=3 found_on=2026-03-31 u=0.2 v=0.7 picture=crack.jpg
  records tower.gsscene list --severity 3
  records tower.gsscene show A-0012
  records tower.gsscene search 'crack south'
  records tower.gsscene export -o tables
  records tower.gsscene import tables/defects.csv
  records tower.gsscene export -o records.ifc --into tower.ifc
  records tower.gsscene history A-0012
"""


def add_parser(subparsers: Any) -> None:
    """Describe the command."""
    parser = subparsers.add_parser(
        "records",
        help="keep inspections, defects and documents of panes",
        description="Look into the records of a building, change them, and bring them in and out as CSV and IFC.\n"
        "They lie beside the model, in records.sqlite. An OBJECT is a name such as A-0012, or an IFC GlobalId.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="folder of a model")
    actions = parser.add_subparsers(title="actions", metavar="ACTION", required=True)
    make = _add_action(actions, "make", run_make, "make the records of a site, or bring them up to its panels")
    make.add_argument(
        "--objects", type=Path, metavar="SITE", help="site file with facades and panels (default: the scene's)"
    )
    _add_looking(actions)
    _add_changing(actions)
    _add_files(actions)


def _add_action(
    actions: Any, name: str, run: Callable[[argparse.Namespace], int], text: str, changes: bool = True
) -> argparse.ArgumentParser:
    command: argparse.ArgumentParser = actions.add_parser(name, help=text, description=f"{text[:1].upper()}{text[1:]}.")
    command.set_defaults(run=run)
    command.add_argument("--json", action="store_true", help="print one JSON object instead of text")
    if changes:
        command.add_argument("--who", metavar="NAME", help="name for the history (default: who is logged in)")
    return command


def _add_looking(actions: Any) -> None:
    add = _add_action(actions, "list", run_list, "list objects with their state", False).add_argument
    add("--facade", metavar="OBJECT", help="only its panels")
    add("--name", default="", metavar="TEXT", help="only those with it in their name")
    add("--attribute", metavar="NAME[=VALUE]", help="only those that have it, or have it with this text")
    add("--severity", type=int, metavar="N", help="only those with an open defect of at least N")
    add("--not-inspected-since", metavar="DATE", help="only those without an inspection from then on")
    add("--absent", action="store_true", help="also those that the model lacks by now")
    show = _add_action(actions, "show", run_show, "show all records of an object", False)
    show.add_argument("object", metavar="OBJECT")
    search = _add_action(actions, "search", run_search, "find texts that hold all the words, the best first", False)
    search.add_argument("words", nargs="+", metavar="WORD")
    search.add_argument("--last", type=count, default=50, metavar="N", help="at most so many (default 50)")
    history = _add_action(actions, "history", run_history, "list changes, the newest first", False)
    history.add_argument("object", nargs="?", metavar="OBJECT")
    history.add_argument("--last", type=count, default=50, metavar="N", help="at most so many (default 50)")
    _add_action(actions, "check", run_check, "look for damage in the file", False)


def _add_changing(actions: Any) -> None:
    change = _add_action(actions, "set", run_set, "set attributes of an object; NAME= takes one out")
    change.add_argument("object", metavar="OBJECT")
    change.add_argument("values", nargs="+", metavar="NAME=VALUE")
    add = _add_action(actions, "add", run_add, "add an inspection, defect, maintenance or document")
    add.add_argument("object", metavar="OBJECT")
    add.add_argument("kind", metavar="KIND", help="inspection, defect, maintenance or document")
    add.add_argument("values", nargs="+", metavar="FIELD=VALUE", help="fields are those of the CSV tables")
    remove = _add_action(actions, "remove", run_remove, "take an entry out")
    remove.add_argument("kind", metavar="KIND")
    remove.add_argument("key", metavar="KEY", help="of the entry, as 'show' prints it")
    _add_action(actions, "undo", run_undo, "take the last changes back")


def _add_files(actions: Any) -> None:
    take = _add_action(actions, "import", run_import, "take records over from CSV tables or an IFC file")
    take.add_argument("path", type=Path, metavar="PATH", help=".csv, .ifc, or a folder of tables")
    take.add_argument("--kind", metavar="KIND", help="what a table holds, where its name does not say")
    take.add_argument("--all-sets", action="store_true", help="of IFC also the sets that BIM programs add")
    give = _add_action(actions, "export", run_export, "write CSV tables into a folder, or an IFC file", False)
    give.add_argument("-o", "--out", type=Path, required=True, metavar="PATH", help="folder, or a name ending in .ifc")
    give.add_argument("--into", type=Path, metavar="IFC", help="IFC file that a copy of gets the records")
    give.add_argument("--site", type=Path, metavar="SITE", help="site file whose building goes into a new IFC file")
    give.add_argument(
        "--semicolon",
        action="store_true",
        help="tables with semicolons and decimal commas, as spreadsheets of many languages want them",
    )


def run_make(options: argparse.Namespace) -> int:
    """Make the records of a site; returns the exit status."""
    from groundstation.services.model.facility_records import make_records, records_path

    done = make_records(options.folder, options.objects, options.who)
    if options.json:
        counts = {"new": done.n_new, "changed": done.n_changed, "absent": done.n_absent, "present": done.n_present}
        print_json({"records": str(records_path(options.folder)), "objects": counts})
        return 0
    tell(
        "{} objects, {} new, {} changed, {} no longer in the model",
        done.n_present,
        done.n_new,
        done.n_changed,
        done.n_absent,
        place=records_path(options.folder),
    )
    print_next("records", options.folder, "list")
    return 0


BACKGROUND = "background"
LAYERS = {"scene": "building", "component": "facade", "element": "panel"}
"""Objects of the model in the words of those who look after the building; what is on no facade is "background"."""


def run_list(options: argparse.Namespace) -> int:
    """List objects; returns the exit status."""
    from groundstation.services.model.facility_records import filter_value, object_lines, open_records
    from reconstruction.records.queries import ObjectFilter

    attribute, equals, value = (options.attribute or "").partition("=")
    with open_records(options.folder) as book:
        object_filter = ObjectFilter(
            parent=None if options.facade is None else book.object(options.facade).global_id,
            name_part=options.name,
            attribute=attribute or None,
            value=filter_value(book, attribute, value) if equals else None,
            min_open_severity=options.severity,
            not_inspected_since=options.not_inspected_since,
            with_absent=options.absent,
        )
        lines = object_lines(book, object_filter)
    if options.json:
        print_json({"objects": lines})
        return 0
    for line in lines:
        inspected, worst = line["last_inspection"], line["worst_open_defect"]
        seen = say("inspected {}", inspected) if inspected else say("never inspected")
        defect = say(", open: {} ({})", worst, line["severity"]) if line["severity"] else ""
        what = BACKGROUND if line["name"] == BACKGROUND else LAYERS[line["layer"]]
        show(glue(f"{line['name']:<12} {line['global_id']}  ", what, ", ", seen, defect))
    show(counted(len(lines), "object"))
    return 0


def run_show(options: argparse.Namespace) -> int:
    """Show one object; returns the exit status."""
    from groundstation.services.model.facility_records import object_content, open_records

    with open_records(options.folder) as book:
        content = object_content(book, options.object)
    if options.json:
        print_json(content)
        return 0
    for field, value in content.items():
        if isinstance(value, list):
            for entry in value:
                shown = {k: v for k, v in entry.items() if k != "global_id" and v not in (None, "", [], ())}
                print(f"{field}: " + ", ".join(f"{k} {' '.join(str(v).split())}" for k, v in shown.items()))
        elif value is not None and field != "corners_enu_m":
            print(f"{field}: {value}")
    return 0


def run_search(options: argparse.Namespace) -> int:
    """Search texts; returns the exit status."""
    from groundstation.services.model.facility_records import open_records
    from reconstruction.records.queries import search

    with open_records(options.folder) as book:
        hits = search(book, " ".join(options.words), options.last)
    if options.json:
        fields = ("global_id", "name", "kind", "field", "key", "text")
        print_json({"hits": [{field: getattr(hit, field) for field in fields} for hit in hits]})
        return 0
    for hit in hits:
        print(f"{hit.name:<12} {hit.kind} {hit.field}: {' '.join(hit.text.split())[:100]}")
    show(counted(len(hits), "hit"))
    return 0


def run_history(options: argparse.Namespace) -> int:
    """List changes; returns the exit status."""
    from dataclasses import asdict

    from groundstation.services.model.facility_records import open_records
    from reconstruction.records.queries import history

    with open_records(options.folder) as book:
        global_id = None if options.object is None else book.object(options.object).global_id
        changes = history(book, global_id, options.last)
    if options.json:
        print_json({"changes": [asdict(change) for change in changes]})
        return 0
    for change in changes:
        of = change.at_utc, change.who, change.kind, change.name, change.what
        if change.old is None:
            tell("{}  {}: {} of {} added ({})", *of)
        elif change.new is None:
            tell("{}  {}: {} of {} removed ({})", *of)
        else:
            tell("{}  {}: {} of {} changed ({})", *of)
    return 0


def run_check(options: argparse.Namespace) -> int:
    """Look for damage; returns the exit status."""
    from groundstation.services.model.facility_records import open_records, records_path

    with open_records(options.folder) as book:
        book.check()
    return _say(options, say("sound", place=records_path(options.folder)), sound=True)


def run_set(options: argparse.Namespace) -> int:
    """Set attributes; returns the exit status."""
    from groundstation.services.model.facility_records import open_records, put_attributes

    with open_records(options.folder, True, options.who) as book:
        n_changed = put_attributes(book, options.object, _fields(options.values))
    return _say(options, say("{} changed", n_changed, place=options.object), changed=n_changed)


def run_add(options: argparse.Namespace) -> int:
    """Add an entry; returns the exit status."""
    from groundstation.services.model.facility_records import open_records, put_fields

    with open_records(options.folder, True, options.who) as book:
        entry = put_fields(book, options.object, options.kind, _fields(options.values))
    return _say(options, say("{} {}", options.kind, entry.key, place=options.object), key=entry.key)


def run_remove(options: argparse.Namespace) -> int:
    """Take an entry out; returns the exit status."""
    from groundstation.services.model.facility_records import open_records
    from reconstruction.records.entries import KIND_NAMED

    if options.kind not in KIND_NAMED:
        raise InputError(say("'{}': expected one of {}", options.kind, ", ".join(KIND_NAMED)))
    with open_records(options.folder, True, options.who) as book:
        book.remove(book.entry(KIND_NAMED[options.kind].record, options.key))
    return _say(options, say("taken out", place=f"{options.kind} {options.key}"), removed=options.key)


def run_undo(options: argparse.Namespace) -> int:
    """Take the last changes back; returns the exit status."""
    from groundstation.services.model.facility_records import open_records

    with open_records(options.folder, True, options.who) as book:
        what = book.undo()
    return _say(options, say("nothing to take back") if what is None else say("taken back: {}", what), undone=what)


def run_import(options: argparse.Namespace) -> int:
    """Take records over; returns the exit status."""
    from groundstation.services.model.facility_records import import_records, open_records

    with open_records(options.folder, True, options.who) as book:
        done = run_job("import", lambda job: import_records(book, options.path, options.kind, options.all_sets, job))
    changed = ", ".join(f"{name} {n_changed}" for name, n_changed in done.n_changed.items())
    return _say(options, say("added or changed: {}", changed), done.notes, changed=done.n_changed)


def run_export(options: argparse.Namespace) -> int:
    """Write files; returns the exit status."""
    from groundstation.services.model.facility_records import export_ifc, export_tables, open_records

    is_ifc = options.out.suffix.lower() == ".ifc"
    if not is_ifc:
        check_tables_name(options.out)
    if not is_ifc and (options.into is not None or options.site is not None):
        raise InputError(say("--into and --site are for IFC; expected a name ending in .ifc", place=options.out))
    with open_records(options.folder) as book:
        if is_ifc:
            done = run_job("export", lambda job: export_ifc(book, options.out, options.into, options.site, job))
        else:
            done = export_tables(book, options.out, options.semicolon)
    names = [str(path) for path in done.files]
    return _say(options, "\n".join(names), done.notes, files=names)


def check_tables_name(out: Path) -> None:
    """Refuse to make a folder that is called as a file is.

    Raises
    ------
    InputError
        Its name ends in .xlsx, .csv or the like.
    """
    if FILE_ENDING.fullmatch(out.suffix.lower()) and not out.is_dir():
        raise InputError(
            say(
                "not written: there is no export into a file of this ending; name a folder, which gets a CSV "
                "table for each kind of records (any spreadsheet opens them), or a name ending in .ifc",
                place=out,
            )
        )


def _fields(texts: list[str]) -> dict[str, str]:
    """Names and values of `NAME=VALUE`; the first equals sign behind brackets parts them."""
    found: dict[str, str] = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals or not name.strip():
            raise InputError(say("'{}': expected NAME=VALUE", text[:60]))
        if name in found:
            raise InputError(say("'{}' is given twice", name[:60]))
        found[name] = value
    return found


def _say(options: argparse.Namespace, text: str, notes: tuple[str, ...] = (), **content: Any) -> int:
    """Print what was done, or its JSON object; returns the exit status."""
    import sys

    if options.json:
        print_json({**content, **({"notes": notes} if notes else {})})
        return 0
    show(text)
    print_notes(notes, sys.stderr)
    return 0

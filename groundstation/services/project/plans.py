"""The plans of a project as files, one each, and what project.json knows of them."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from groundstation.services.project.document import Document, PlanEntry
from groundstation.services.project.input_files import read_given_plan
from groundstation.services.project.migration import free_name, title_of
from groundstation.services.project.project_file import PLANS_FOLDER, PlanRecord, ProjectRecord, json_bytes
from groundstation.services.project.site import file_stem
from groundstation.services.project.store import PROJECT_FILE, current_content, digest, holds, may_replace
from planning.base.errors import InputError
from planning.base.files import read_given
from planning.base.findings import Finding, Severity
from planning.base.json_file import JSON_FILE, plain_values, to_record
from planning.base.messages import say
from planning.plan import plan_of, plan_to_json
from planning.request import PlanRequest
from planning.site.file import is_planned_on


def read_entry(folder: Path, record: PlanRecord) -> tuple[PlanEntry | None, list[Finding]]:
    """A plan with what the project knows of it, and notes; None where its file cannot be read."""
    title = record.id if record.title is None else record.title
    try:
        path, written = current_content(folder, record.file, record.sha256)
        plan = plan_of(written, path)
    except InputError as error:
        text = say("{}; the plan '{}' was left out", error, title)
        return None, [Finding(Severity.WARNING, "plan-left-out", text, record.id)]
    if record.sha256 and digest(written) != record.sha256:
        # What was asked for and the bound belong to the plan that was there before.
        text = say("another program has changed the plan '{}' since the project was saved", title, place=path)
        return PlanEntry(record.id, title, plan), [Finding(Severity.NOTE, "plan-changed", text, record.id)]
    request, notes = read_request(record.request, say("the plan '{}'", title))
    return PlanEntry(record.id, title, plan, request, record.bound_for_views), notes


def read_request(content: dict[str, Any] | None, what: str) -> tuple[PlanRequest | None, list[Finding]]:
    """A request as project.json holds it; None with a note where it cannot be read. `what` says whose it is."""
    if content is None:
        return None, []
    try:
        return to_record(content, PlanRequest, Path(PROJECT_FILE)), []
    except InputError as error:
        text = say("{}; what was asked of {} was left out", error, what)
        return None, [Finding(Severity.WARNING, "request-left-out", text)]


def plan_file(
    folder: Path, entry: PlanEntry, before: ProjectRecord, taken: set[str]
) -> tuple[PlanRecord, bytes | None]:
    """Entry of project.json for a plan, and the content to write; None where the file holds the plan already.

    A file that another program wrote stays as it is, with fields that this version does not know, while the plan in it
    is the same. One that holds something else is never replaced: the plan gets another file then.

    Parameters
    ----------
    before
        The project as it is in the folder.
    taken
        Files of other plans.

    Raises
    ------
    InputError
        A number in the plan is not finite.
    """
    content = json_bytes(plan_to_json(entry.plan), say("plan '{}'", entry.title))
    known = before.plan(entry.id)
    if known is not None:
        with contextlib.suppress(InputError):  # what cannot be read does not hold the plan
            found = read_given(folder / known.file, JSON_FILE)
            if found != content and plan_of(found, folder / known.file) == entry.plan:
                content = found
    if (
        known is not None
        and known.file.rpartition("/")[0] == PLANS_FOLDER
        and known.file not in taken
        and may_replace(folder / known.file, known.sha256, content)
    ):
        file = known.file
    else:
        file = _free_file(folder, entry.id, {*taken, *(plan.file for plan in before.plans)})
    record = PlanRecord(
        id=entry.id,
        file=file,
        title=entry.title,
        sha256=digest(content),
        request=None if entry.request is None else plain_values(entry.request),
        bound_for_views=entry.bound_for_views,
    )
    return record, None if holds(folder / file, content) else content


def _free_file(folder: Path, plan_id: str, taken: set[str]) -> str:
    """Name for a new plan file, other than all that there are, in whatever case they are written."""
    there = {f"{PLANS_FOLDER}/{path.name}" for path in (folder / PLANS_FOLDER).glob("*")}
    used = {file.casefold() for file in taken | there}
    stem, number = file_stem(plan_id) or "plan", 1
    while _numbered(stem, number).casefold() in used:
        number += 1
    return _numbered(stem, number)


def _numbered(stem: str, number: int) -> str:
    return f"{PLANS_FOLDER}/{stem}{'' if number == 1 else f'-{number}'}.plan.json"


def add_plans(document: Document, paths: Sequence[Path]) -> tuple[Document, tuple[Finding, ...]]:
    """A document with the plans of some files; the last becomes the current one. They are called like their files.

    Raises
    ------
    InputError
        A file cannot be read, or the project holds its plan already.
    """
    notes = []
    for path in paths:
        plan = read_given_plan(path)
        same = next((entry for entry in document.plans if entry.plan == plan), None)
        if same is not None:
            raise InputError(say("the project holds this plan already, as '{}'; leave it out", same.title, place=path))
        site = document.site
        is_ours = site is not None and bool(site.sha256) and is_planned_on(plan.site_sha256, site)
        if site is not None and plan.site_sha256 and not is_ours:
            text = say(
                "this plan was made for another state of the site, or for another site ('{}')", plan.site, place=path
            )
            notes.append(Finding(Severity.WARNING, "site-changed", text))
        title = title_of(path.name)
        plan_id = free_name(title, {entry.id for entry in document.plans})
        document = document.with_plan(PlanEntry(plan_id, title, plan))
    return document, tuple(notes)

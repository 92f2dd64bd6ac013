"""Older shapes of a project to the present one, version by version, as functions on plain JSON content.

0  a loose folder as the command line leaves it: one site file, plans beside it, no project.json
1  {"format": "reflight-project/1", "site": "site.json", "plans": ["a.plan.json", ...]}
2  docs/guide/projects.md
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from groundstation.services.project.document import first_free
from planning.base.errors import InputError
from planning.base.messages import say
from planning.plan import PLAN_FORMAT
from planning.site.records import SITE_FORMAT

FORMAT = "reflight-project/"

Content = dict[str, Any]

Listing = Mapping[str, str]
"""Format (`reflight-site/1` and so on) by name of the JSON files that lie in a folder."""

Migration = Callable[[Content, Listing], Content]


def migrate(content: Content, version: int, listing: Listing) -> Content:
    """Content in the present shape.

    Parameters
    ----------
    version
        Of `content`, up to `VERSION`.
    listing
        Of the project's folder; only version 0 looks at it.

    Raises
    ------
    InputError
        The content is not what a project of its version holds; the message does not name the file.
    """
    for step in MIGRATIONS[version:]:
        content = step(content, listing)
    return content


def from_loose_files(content: Content, listing: Listing) -> Content:
    """Version 0 to 1: the only site in the folder, and all plans by name."""
    sites = sorted(name for name, file_format in listing.items() if file_format == SITE_FORMAT)
    plans = sorted(name for name, file_format in listing.items() if file_format == PLAN_FORMAT)
    if not sites:
        raise InputError(
            say(
                "there is no project in this folder: expected project.json, or a site file with plans beside it; "
                "'project new' makes a project"
            )
        )
    if len(sites) > 1:
        raise InputError(
            say(
                "expected one site file in a folder without project.json, found {} ({}); make a project of one "
                "with 'project new'",
                len(sites),
                ", ".join(sites),
            )
        )
    return {**content, "format": f"{FORMAT}1", "site": sites[0], "plans": plans}


def name_plans(content: Content, _listing: Listing) -> Content:
    """Version 1 to 2: plans get identifiers and titles after their files; the last one is the current one."""
    files = content.get("plans", [])
    if not isinstance(files, list) or not all(isinstance(file, str) for file in files):
        raise InputError(say("plans: expected a list of file names"))
    plans: list[Content] = []
    for file in files:
        name = title_of(file)
        used_ids = {plan["id"] for plan in plans}
        plans.append({"id": free_name(name, used_ids), "title": name, "file": file})
    current = plans[-1]["id"] if plans else ""
    return {"current_plan_id": current, **content, "format": f"{FORMAT}2", "plans": plans}


def title_of(file: str) -> str:
    """Title for a plan that has none: `plans/south.plan.json` gives `south`."""
    name = file.replace("\\", "/").rpartition("/")[2]
    return name.removesuffix(".json").removesuffix(".plan") or "plan"


def free_name(name: str, used: set[str]) -> str:
    """The name, or with -2, -3 and so on where it is taken."""
    return first_free(lambda number: name if number == 1 else f"{name}-{number}", used)


MIGRATIONS: tuple[Migration, ...] = (from_loose_files, name_plans)
"""From version n, at place n, to version n + 1."""

VERSION = len(MIGRATIONS)
"""The present version."""

"""Documents of all kinds, a disk that fails where it is told to, and when two documents are the same."""

from __future__ import annotations

import errno
import os
import subprocess
from contextlib import contextmanager
from dataclasses import replace

from hypothesis import strategies as st

from groundstation.services.project.document import Document, PlanEntry
from groundstation.services.project.site import same_site
from planning.aircraft.catalogue import profile
from planning.parameters import Constraints, FlightRules
from planning.plan import Coverage, HistoryPoint, Plan, Sortie, Viewpoint
from planning.request import PlanRequest
from planning.site.bundled import SCENES
from tests.planning.plan_cases import kiosk

SITES = {**{name: SCENES[name]() for name in ("single-panel", "roof", "canyon", "library")}, "kiosk": kiosk()}
"""Small sites: without mesh, with one, with boxes, with coordinates that single precision rounds, with no-fly zones."""

M3E = profile("m3e")


def plan(n_views=2, seed=0, site_sha256="", x_m=0.5):
    """A plan that nobody computed: `n_views` viewpoints in one sortie."""
    views = tuple(Viewpoint(f"v{i:04d}", (x_m + i, -20.0, 12.0), float(i % 180), -5.0) for i in range(n_views))
    ids = tuple(view.id for view in views)
    path = ((0.0, -30.0, 0.0), *(view.position_enu_m for view in views), (0.0, -30.0, 0.0))
    return Plan(
        site="any",
        site_sha256=site_sha256,
        method="greedy",
        seed=seed,
        camera=M3E.camera,
        aircraft=M3E.aircraft,
        constraints=Constraints(occlusion="off"),
        viewpoints=views,
        sorties=(Sortie(ids, path, 100.0, 60.0),) if views else (),
        coverage=Coverage(min(seed, 36), 36, 36),
        history=(HistoryPoint(0.25, 3),),
        profile="m3e",
    )


def document(site="roof", n_plans=1, **changes):
    """A document with a site and some plans."""
    made = Document(SITES[site], **changes)
    for number in range(1, n_plans + 1):
        made = made.with_plan(PlanEntry(f"plan-{number}", f"Plan {number}", plan(seed=number), PlanRequest(n_views=2)))
    return made


def edited(before, seed):
    """The document with its last plan changed."""
    entry = before.plans[-1]
    return before.with_plan(replace(entry, plan=replace(entry.plan, seed=seed), title=f"{entry.title}*"))


def is_same(one, other):
    """Whether two documents hold the same; sites count as the same under other names of mesh files."""
    return (
        same_site(one.site, other.site)
        and (one.current_plan_id, one.request) == (other.current_plan_id, other.request)
        and [_fields(entry) for entry in one.plans] == [_fields(entry) for entry in other.plans]
    )


def _fields(entry):
    return (entry.id, entry.title, entry.plan, entry.request, entry.bound_for_views)


class Crash(BaseException):
    """The process ends: no handler of errors sees it."""


@contextmanager
def failing_disk(at, *, crash=False):
    """Let the `at`-th write to the disk (from 0) fail for want of room; yields a list of all that were tried.

    With `crash` the process ends there: that one and all later ones never happen.
    """
    names = ("open", "fsync", "replace", "rename", "mkdir", "unlink", "rmdir", "chmod")
    real = {name: getattr(os, name) for name in names}
    tried = []

    def failing(name):
        def call(*arguments, **options):
            writes = name != "open" or (len(arguments) > 1 and arguments[1] & (os.O_WRONLY | os.O_RDWR))
            if not writes:
                return real[name](*arguments, **options)
            tried.append((name, str(arguments[0])))
            if crash and len(tried) > at:
                raise Crash
            if len(tried) - 1 == at:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(arguments[0]))
            return real[name](*arguments, **options)

        return call

    for name in names:
        setattr(os, name, failing(name))
    try:
        yield tried
    finally:
        for name in names:
            setattr(os, name, real[name])


@contextmanager
def small_disk(folder, size_kib):
    """A file system of its own at `folder`; None where this user or system cannot mount one."""
    folder.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", f"size={size_kib}k", "tmpfs", str(folder)]
    try:
        mounted = subprocess.run(command, capture_output=True, check=False).returncode == 0
    except OSError:
        mounted = False
    try:
        yield folder if mounted else None
    finally:
        if mounted:
            subprocess.run(["umount", "-l", str(folder)], check=True, capture_output=True)


odd_text = st.text(st.characters(exclude_categories=()), max_size=20)

requests = st.builds(
    PlanRequest,
    method=st.sampled_from(["greedy", "pso", "noto", "orbit"]),
    share=st.none() | st.floats(0.01, 1.0),
    profile_id=odd_text,
    constraints=st.builds(
        Constraints,
        min_distance_m=st.floats(0.0, 50.0),
        section_step_deg=st.sampled_from([10.0, 15.0, 30.0]),
        whole_panel=st.booleans(),
        max_distance_m=st.none() | st.floats(51.0, 1e6),
    ),
    rules=st.builds(FlightRules, wind_m_s=st.floats(0.0, 20.0), turn_in_flight=st.booleans()),
    precision=st.sampled_from(["f32", "f64"]),
    seed=st.integers(0, 2**32 - 1),
    time_budget_s=st.floats(1e-3, 1e9),
)

plans = st.builds(
    plan,
    n_views=st.integers(0, 4),
    seed=st.integers(0, 2**32),
    site_sha256=st.text(max_size=20),
    x_m=st.floats(-100.0, 100.0),
)

entries = st.builds(
    PlanEntry,
    id=odd_text.filter(bool),
    title=odd_text,
    plan=plans,
    request=st.none() | requests,
    bound_for_views=st.none() | st.floats(0.0, 1e6),
)


@st.composite
def documents(draw):
    """Any document: site or none, any plans with any identifiers, any of them the current one."""
    chosen = draw(st.lists(entries, max_size=4, unique_by=lambda entry: entry.id))
    name = draw(st.none() | st.sampled_from(sorted(SITES)))
    return Document(
        None if name is None else SITES[name],
        tuple(chosen),
        draw(st.sampled_from([entry.id for entry in chosen])) if chosen else "",
        draw(requests),
    )

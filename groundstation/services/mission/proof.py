"""Plans that carry their proof: written beside plans and missions, and judged by the independent verifier.

The verifier is one file that knows nothing of this program (`planning.proof.reflight_verify`). It goes along with each
mission, so that anybody can run it on what will be flown.
"""

from __future__ import annotations

import hashlib
import pickle
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from planning.base.errors import InfeasibleError, InputError
from planning.base.files import read_input_file
from planning.base.findings import Finding, Severity
from planning.base.json_file import JSON_FILE, parse_json, write_atomically
from planning.base.messages import joined, say
from planning.base.progress import QUIET, Monitor, Stop, Trace, never
from planning.coverage.reachability import Reachability, find_reachable
from planning.geo.mesh import MESH_FILE
from planning.plan import Plan, plan_bytes, write_plan
from planning.proof import reflight_verify
from planning.proof.make import proof_of, proof_path
from planning.site.file import site_with_files, write_site
from planning.site.free_space import free_space
from planning.site.records import SiteModel
from planning.viewpoints.prepare import coverage_model

PROVED, FALSE = reflight_verify.PROVED, reflight_verify.FALSE
VERIFIER = Path(reflight_verify.__file__)
PAGE = VERIFIER.with_suffix(".html")
"""The verifier for people without Python: a page that says the same in any browser, without a network."""


@dataclass(frozen=True, slots=True)
class Claim:
    """What the verifier says of one claim: `proved`, `false` or `not proved`, and in words what or why."""

    id: str
    verdict: str
    text: str


def verified(site: Path, plan: Path, proof: Path, missions: Sequence[Path] = ()) -> tuple[Claim, ...]:
    """All claims of a plan, as the verifier judges them."""
    return tuple(Claim(**each) for each in reflight_verify.verify(site, plan, proof, list(missions)))


def proof_finding(claims: Sequence[Claim]) -> Finding:
    """The verdict of the verifier in one line: proved, or what is not."""
    wrong = [each for each in claims if each.verdict == FALSE]
    missing = [each for each in claims if each.verdict not in (PROVED, FALSE)]
    n_proved = len(claims) - len(wrong) - len(missing)
    if not wrong and not missing:
        text = say("proved by an independent check: all {} claims on this plan", n_proved)
        return Finding(Severity.OK, "proof", text, "", float(n_proved), float(len(claims)), "claims")
    names = joined("; ", (say("{}: {}", each.id, each.text) for each in (*wrong, *missing)))
    if wrong:
        text = say("an independent check finds that claims are false ({} of {}): {}", len(wrong), len(claims), names)
        return Finding(Severity.WARNING, "proof", text, wrong[0].id, float(n_proved), float(len(claims)), "claims")
    text = say("an independent check proves {} of {} claims; not proved: {}", n_proved, len(claims), names)
    return Finding(Severity.NOTE, "proof", text, missing[0].id, float(n_proved), float(len(claims)), "claims")


def no_proof(path: Path) -> Finding:
    """That a plan comes without its proof."""
    text = say("the plan has no proof beside it ({}); plan it again", path.name)
    return Finding(Severity.ERROR, "proof", text)


def refused_unless_proved(finding: Finding) -> Finding:
    """The finding as an error where anything is not proved."""
    if finding.severity is Severity.OK:
        return finding
    return Finding(Severity.ERROR, *(getattr(finding, name) for name in Finding.__slots__[1:]))


def write_plan_proof(
    plan_path: Path,
    site_path: Path,
    site_model: SiteModel,
    reachability: Reachability | None,
    monitor: Monitor = QUIET,
) -> Path:
    """Write the proof beside a plan's file; returns its path.

    Raises
    ------
    InputError
        A file cannot be read or written.
    """
    path = proof_path(plan_path)
    written = read_input_file(plan_path, JSON_FILE)
    write_atomically(path, proof_of(site_path, plan_path, written, site_model, reachability, monitor=monitor))
    return path


def proved_as_saved(
    plan: Plan, site_model: SiteModel, *, stop: Stop = never, trace: Trace | None = None, monitor: Monitor = QUIET
) -> Finding:
    """What the verifier says of an open plan, as it and its site are saved.

    For a process of its own, like `open_mission_proof` and `judged`: the verifier is Python throughout, and a window
    would stand still beside it. It cannot be stopped.

    Raises
    ------
    InputError
        There is no room for the files.
    """
    with TemporaryDirectory(prefix="reflight-") as name:
        site_path, plan_path = _write_open(plan, site_model, Path(name), "")
        write_atomically(proof_path(plan_path), _proof_of_open(plan, site_model, site_path, plan_path, None, monitor))
        monitor.report(say("checking the proof"), 0, 1)
        return proof_finding(verified(site_path, plan_path, proof_path(plan_path)))


def _write_open(plan: Plan, site_model: SiteModel, folder: Path, prefix: str) -> tuple[Path, Path]:
    """Write an open plan and its site with all that it names, as a set of files of its own: paths of site and plan."""
    site, files = site_with_files(site_model, prefix)
    for name, content in files.items():
        write_atomically(folder / name, content)
    site_path, plan_path = folder / f"{prefix}site.json", folder / f"{prefix}plan.json"
    write_plan(plan_path, replace(plan, site_sha256=write_site(site_path, site)))
    return site_path, plan_path


def open_mission_proof(
    plan: Plan,
    site_model: SiteModel,
    mission: Path,
    return_height_m: float | None,
    *,
    stop: Stop = never,
    trace: Trace | None = None,
    monitor: Monitor = QUIET,
) -> MissionProof:
    """What `mission_proof` has, for missions of an open plan.

    Site, meshes and plan go along as they are in the window, under names that begin with the first mission's: what is
    saved in the project may be older.

    Raises
    ------
    InputError
        There is no room for the files.
    OperationCancelled
        From `monitor`.
    """
    folder, first = mission.parent, mission.name
    with TemporaryDirectory(prefix="reflight-") as name:
        site_path, plan_path = _write_open(plan, site_model, Path(name), f"{first}.")
        proof = _proof_of_open(plan, site_model, site_path, plan_path, return_height_m, monitor)
        beside = {folder / path.name: path.read_bytes() for path in sorted(Path(name).iterdir())}
    return _with_verifiers(folder, first, proof, beside, folder / site_path.name, folder / plan_path.name)


_last_known: dict[str, dict[str, Any]] = {}
"""In a process of the window: the last proof of an open plan, by what its site and its views are. A check, and each
export, ask for the same one, of which nearly all is said of these."""


def _proof_of_open(
    plan: Plan, site_model: SiteModel, site_path: Path, plan_path: Path, return_height_m: float | None, monitor: Monitor
) -> bytes:
    """The proof of an open plan that was written to these files, with what an earlier one says of the same views."""
    views = (site_model, plan.viewpoints, plan.camera, plan.constraints, plan.aircraft, plan.seed)
    key = hashlib.sha256(pickle.dumps(views)).hexdigest()
    known, written = _last_known.get(key), read_input_file(plan_path, JSON_FILE)
    reached = _reachability(plan, site_model, monitor) if known is None else None
    proof = proof_of(
        *(site_path, plan_path, written, site_model, reached),
        known=known,
        return_height_m=return_height_m,
        monitor=monitor,
    )
    if known is None:
        content = parse_json(proof, plan_path)
        _last_known.clear()
        if "seen" in content:
            _last_known[key] = content
    return proof


def _reachability(plan: Plan, site_model: SiteModel, monitor: Monitor) -> Reachability | None:
    """What can be reached under a plan's limits; None where they allow no flight, or leave occlusion open."""
    constraints = plan.constraints
    if constraints.occlusion == "auto":
        return None
    try:
        space = free_space(site_model, constraints.min_distance_m, constraints.min_height_above_ground_m)
        model = coverage_model(site_model, space, plan.camera, constraints)
    except (InfeasibleError, InputError):
        return None
    return find_reachable(model, space, plan.seed, monitor=monitor)


def proof_of_files(plan_path: Path, site_path: Path) -> Finding | None:
    """What the verifier says of a plan with the proof beside it; None where there is none."""
    path = proof_path(plan_path)
    return proof_finding(verified(site_path, plan_path, path)) if path.is_file() else None


@dataclass(frozen=True, slots=True, eq=False)
class MissionProof:
    """What goes beside mission files, so that anybody can check them: proof, what it speaks of, and both verifiers."""

    path: Path
    site_path: Path
    plan_path: Path
    files: dict[Path, bytes]

    def judged(self, missions: Sequence[Path]) -> Finding:
        """What the verifier says, once all is written."""
        return proof_finding(verified(self.site_path, self.plan_path, self.path, missions))


def judged(
    proof: MissionProof,
    missions: Sequence[Path],
    *,
    stop: Stop = never,
    trace: Trace | None = None,
    monitor: Monitor = QUIET,
) -> Finding:
    """`MissionProof.judged`, for a process of its own."""
    monitor.report(say("checking the proof"), 0, 1)
    return proof.judged(missions)


def mission_proof(
    plan_path: Path,
    plan: Plan | None,
    site_path: Path,
    site_model: SiteModel,
    mission: Path,
    return_height_m: float | None,
) -> MissionProof:
    """The proof of mission files that are to be written; nothing is written yet.

    Parameters
    ----------
    plan
        What is flown where that is another plan than in the file: the same views, shared out among more sorties.
    mission
        The first of the files.
    return_height_m
        Above take-off, as the mission says it; None where it does not.

    Raises
    ------
    InputError
        A file cannot be read, or the folder holds another site's files.
    """
    folder, first = mission.parent, mission.name
    written = read_input_file(plan_path, JSON_FILE)
    flown_path = folder / plan_path.name
    if plan is not None:
        flown_path = folder / f"{first}.plan.json"
        written = plan_bytes(plan)
    known = _known_proof(proof_path(plan_path))
    proof = proof_of(site_path, flown_path, written, site_model, None, known=known, return_height_m=return_height_m)
    beside = dict(_copies(site_path, site_model, folder))
    if not _is_same(flown_path, plan_path):
        beside[flown_path] = written
    return _with_verifiers(folder, first, proof, beside, folder / site_path.name, flown_path)


def _with_verifiers(
    folder: Path, first: str, proof: bytes, beside: dict[Path, bytes], site_path: Path, plan_path: Path
) -> MissionProof:
    path = folder / f"{first}.mission.proof"
    checkers = {folder / checker.name: checker.read_bytes() for checker in (VERIFIER, PAGE)}
    return MissionProof(path, site_path, plan_path, {path: proof, **beside, **checkers})


def _known_proof(path: Path) -> dict[str, Any] | None:
    """The proof of a plan as it was written; None where there is none that can be read."""
    try:
        content = parse_json(read_input_file(path, JSON_FILE), path) if path.is_file() else None
    except InputError:
        return None
    return content if isinstance(content, dict) else None


def _copies(site_path: Path, site_model: SiteModel, folder: Path) -> Iterator[tuple[Path, bytes]]:
    """The site's file and meshes, where a folder does not hold them."""
    if _is_same(folder, site_path.parent):
        return
    site = site_model.site
    meshes = [site.building_mesh, *(obstacle.mesh for obstacle in site.obstacles)]
    for name in (site_path.name, *dict.fromkeys(mesh for mesh in meshes if mesh is not None)):
        target, content = folder / name, read_input_file(site_path.parent / name, MESH_FILE)
        if target.exists() and read_input_file(target, MESH_FILE) != content:
            raise InputError.say(
                "expected the site's own '{}' here, or none; write the mission into another folder", name, place=folder
            )
        yield target, content


def _is_same(one: Path, other: Path) -> bool:
    return one.resolve() == other.resolve()

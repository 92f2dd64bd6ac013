"""Terrain for a site: from files of heights to a new site file beside the obstacles that it names."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from groundstation.services.project.site import site_files
from planning.base.json_file import write_atomically
from planning.base.messages import say
from planning.base.progress import QUIET, Monitor
from planning.site.ground import decide_terrain, terrain_text
from planning.site.importing.attach_terrain import Attached, TerrainRequest, attach_terrain, without_terrain
from planning.site.records import SiteModel
from planning.site.terrain import surfaces

SITE_ENDING = ".site.json"


def terrain_attached(
    model: SiteModel, site_path: Path, request: TerrainRequest, out: Path, monitor: Monitor = QUIET
) -> Attached:
    """Attach terrain to a site read from `site_path` and write it to `out`, its meshes beside it.

    Raises
    ------
    InputError
        As `attach_terrain`, or a file cannot be written.
    """
    stem = out.name.removesuffix(SITE_ENDING) if out.name.endswith(SITE_ENDING) else out.stem
    attached = attach_terrain(model, request, stem, monitor)
    return replace(attached, model=written(attached.model, site_path, out))


def terrain_removed(model: SiteModel, site_path: Path, out: Path) -> SiteModel:
    """Write a site without its terrain and the obstacles that came with it."""
    return written(without_terrain(model), site_path, out)


def written(model: SiteModel, site_path: Path, out: Path) -> SiteModel:
    """Write a site and those of its meshes that are not there yet; returns it as a reader will find it."""
    files = site_files(model, out.parent, (site_path,))
    for name, content in files.meshes.items():
        write_atomically(out.parent / name, content)
    write_atomically(out, files.content)
    return files.model


def attached_facts(attached: Attached) -> tuple[str, ...]:
    """What came of files of heights, a sentence each."""
    site, ground = attached.model.site, attached.ground
    assert site.terrain is not None
    z = surfaces(site.terrain).ground.z_m
    known = np.isfinite(z)
    facts: list[str] = [
        say(
            "terrain from {:.1f} m to {:.1f} m in the site's own frame, known on {:.1f} % of the area",
            float(z[known].min()),
            float(z[known].max()),
            100.0 * float(known.mean()),
        ),
        say(
            "steps of {:.3g} m from heights {:.3g} m apart: bounds at most {:.2f} m off, and {:g} m for the accuracy",
            site.terrain.step_m,
            ground.post_spacing_m,
            ground.error_m,
            site.terrain.accuracy_m,
        ),
    ]
    if attached.n_boxes or attached.n_unknown_boxes:
        n = attached.n_boxes, attached.n_unknown_boxes
        facts.append(say("obstacles from the surface: {} boxes, and {} where it has no heights", *n))
    return (*facts, terrain_text(decide_terrain(site)))


def terrain_summary(attached: Attached, seconds: float) -> dict[str, Any]:
    """What `site terrain --json` prints."""
    site, ground = attached.model.site, attached.ground
    assert site.terrain is not None
    decision, found = decide_terrain(site), surfaces(site.terrain).ground.z_m
    known = found[np.isfinite(found)]
    return {
        "name": site.name,
        "columns": site.terrain.columns,
        "rows": site.terrain.rows,
        "step_m": round(site.terrain.step_m, 6),
        "post_spacing_m": round(ground.post_spacing_m, 6),
        "posts": ground.n_posts,
        "error_m": round(ground.error_m, 3),
        "accuracy_m": site.terrain.accuracy_m,
        "lowest_m": round(float(known.min()), 3),
        "highest_m": round(float(known.max()), 3),
        "unknown_share": round(float(np.isnan(found).mean()), 6),
        "obstacle_boxes": attached.n_boxes,
        "unknown_boxes": attached.n_unknown_boxes,
        "home_enu_m": site.home_enu_m,
        "home_moved_m": round(attached.home_moved_m, 3),
        "sources": [
            {"file": each.file, "sha256": each.sha256, "crs": each.crs, "vertical": each.vertical}
            for each in site.terrain.sources
        ],
        "effect": {
            "on": decision.on,
            "decided_by": decision.decided_by,
            "reason": decision.reason,
            "size_m": round(decision.size, 3),
            "tolerance_m": decision.tolerance,
        },
        "notes": attached.notes,
        "sha256": attached.model.sha256,
        "seconds": round(seconds, 3),
    }

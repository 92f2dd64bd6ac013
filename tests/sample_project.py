"""Makes the sample project of the start page, by the program's own commands: `python -m tests.sample_project`.

It takes some minutes. The archive holds nothing but what these commands write; times in it are fixed, so that the same
files make the same archive.
"""

import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

from groundstation.services.project.sample import ARCHIVE

N_VIEWS, WIDTH_PX = 16, 240
"""Enough for every tab to have something to show, in an archive of some megabytes."""

N_POINTS, STEPS = 3000, 300

WHEN = (2026, 1, 1, 0, 0, 0)


def run(*arguments: object) -> None:
    subprocess.run([sys.executable, "-m", "groundstation", *map(str, arguments)], check=True)


def make(work: Path) -> Path:
    """All steps, from a bundled scene to a model; returns the project's folder."""
    rendered, project = work / "rendered", work / "project"
    site, plan = rendered / "site.json", rendered / "plan.json"
    run("scene", "render", "planar", "-o", rendered, "--views", N_VIEWS, "--width", WIDTH_PX, "--points", N_POINTS)
    run("project", "new", project, "--site", site, "--name", "Sample")
    named = work / "first-plan.plan.json"
    shutil.copyfile(plan, named)
    run("project", "add", project, named)
    run("export", named, "--format", "dji-kmz", "-o", project / "missions" / "first-plan.kmz")
    run("simulate", named, site, "-o", project / "flights" / "first-plan.flight.json", "--speedup", 30)
    shutil.copytree(rendered / "images", project / "photos", dirs_exist_ok=True)
    dataset, model = project / "dataset", project / "models" / "first-reflight"
    run("prepare", project / "photos", site, "-o", dataset, "--points", N_POINTS)
    run("train", dataset, "-o", model, "--preset", "smoke", "--iterations", STEPS, "--light", "harmonics")
    return project


def pack(project: Path, archive: Path) -> None:
    """Write a folder as an archive that is the same for the same files."""
    archive.parent.mkdir(exist_ok=True)
    files = sorted(path for path in project.rglob("*") if path.is_file() and path.name != ".lock")
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as written:
        for path in files:
            entry = zipfile.ZipInfo(path.relative_to(project).as_posix(), WHEN)
            entry.compress_type = zipfile.ZIP_DEFLATED
            written.writestr(entry, path.read_bytes())


if __name__ == "__main__":
    with tempfile.TemporaryDirectory(prefix="reflight-sample-") as folder:
        pack(make(Path(folder)), ARCHIVE)
    sys.stdout.write(f"{ARCHIVE}: {ARCHIVE.stat().st_size / 1e6:.1f} MB\n")

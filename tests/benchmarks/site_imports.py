"""Importing real building files: time and memory of the whole command."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path

from tests.benchmarks.fresh_process import run_command
from tests.benchmarks.harness import Benchmark, Context, Row

QUICK = ("bim/curtain_wall_small.ifc",)


def measure(context: Context) -> Iterator[Row]:
    """Every IFC and CityGML file of the input data."""
    if context.is_quick:
        paths = [context.data(name) for name in QUICK]
    else:
        paths = [*sorted(context.data("bim").glob("*.ifc"))]
        paths += sorted(context.data("buildings/ingolstadt_lod3").glob("*.xml"))
    with tempfile.TemporaryDirectory() as folder:
        for path in paths:
            done = run_command(["site", "import", path, "-o", Path(folder) / "site.json"])
            found = done.content
            what = f"{found['panels']} panels, {found['triangles']} triangles"
            yield Row(path.name, what, done.seconds, "s", against=f"{done.peak_mib:.0f} MiB at most")


BENCHMARK = Benchmark(
    "site-import",
    "Site import",
    "`app.py site import` on the real files of the input data, starting Python included; the largest resident memory "
    "of any process stands beside.",
    measure,
)

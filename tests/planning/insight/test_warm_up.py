"""After the warm-up of this package, analysing plans compiles none of its kernels again."""

import subprocess
import sys
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[3]

ANALYSES = """
from datetime import date, timedelta, timezone
from groundstation.services.mission.sunlight import SunRequest, sun_report
from planning.geo import sun
from planning.insight import clearance, obstructions, reasons, sunlight
from planning.insight.clearance import route_clearance
from planning.insight.reasons import section_reasons
from planning.insight.obstructions import obstructions_of
from planning.warm_up import compile_kernels
from planning.site.free_space import unchecked_space
from tests.planning.insight.cases import plan, prepared, scene

kernels = [
    *(reasons.explain_sections, clearance._nearest_parts, obstructions._nearest_triangles, obstructions._first_hits),
    *(sun._trace_all, sunlight._mirrored_spans),
]
compile_kernels()
warm = [len(kernel.signatures) for kernel in kernels]
for name in ("kiosk", "canyon"):
    section_reasons(scene(name), prepared(name))
    space = unchecked_space(scene(name), 5.0)
    for sortie in plan(name).sorties:
        route_clearance(sortie, space, obstructions_of(scene(name), space))
    sun_report(scene(name), plan(name), SunRequest(date(2026, 12, 21), timezone(timedelta(hours=8))))
print(warm == [1] * 6 == [len(kernel.signatures) for kernel in kernels])
"""


@pytest.mark.slow
@pytest.mark.timeout(7200)  # where nothing was compiled before, and the machine is busy
def test_analyses_of_other_sites_use_what_the_warm_up_compiled():
    done = subprocess.run([sys.executable, "-c", ANALYSES], cwd=REPOSITORY, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout.strip()) == (0, "True"), done.stderr

"""The demonstration: everything it says it made is there."""

import pytest

from groundstation.services.demo import demonstrate
from groundstation.services.mission.proof import PAGE, VERIFIER
from missions.mission.export_choices import FileFormat
from planning.base.errors import InputError, OperationCancelled
from planning.base.findings import is_flyable
from planning.plan import read_plan
from planning.proof.make import proof_path
from planning.request import PlanRequest
from tests.planning.revision.cases import QUICK


@pytest.mark.slow
def test_all_files_are_made_and_the_plan_is_ready_to_fly(tmp_path):
    made = demonstrate(tmp_path / "new" / "demo", "single-panel", PlanRequest(n_views=4, greedy=QUICK))
    paths = {made.site_path, made.plan_path, made.flight_path, *made.mission_paths}
    others = {path.name for path in (tmp_path / "new" / "demo").iterdir() if path not in paths}
    assert all(path.is_file() for path in paths)
    proofs = {
        f"{path.name}.mission.proof" for path in made.mission_paths if path.suffix in (".kmz", ".plan", ".waypoints")
    }
    assert others == {proof_path(made.plan_path).name, VERIFIER.name, PAGE.name, *proofs}
    assert len(made.mission_paths) == len(FileFormat)
    assert read_plan(made.plan_path) == made.planned.plan
    assert is_flyable(made.findings)
    assert is_flyable(made.export_findings)
    assert made.flown.flight.report.summary.n_taken == 4


def test_unknown_sites_and_bad_folders_are_refused(tmp_path):
    with pytest.raises(InputError, match="there is no bundled site 'castle'; known are: canyon, court"):
        demonstrate(tmp_path, "castle")
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be made"):
        demonstrate(tmp_path / "file")


def test_a_cancelled_demonstration_leaves_no_plan(tmp_path):
    class Cancelling:
        def report(self, stage, done, total):
            raise OperationCancelled("cancelled")

    with pytest.raises(OperationCancelled):
        demonstrate(tmp_path, "single-panel", monitor=Cancelling())
    assert not list(tmp_path.glob("*.plan*"))

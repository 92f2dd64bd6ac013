"""A user who tries everything for a minute: nothing is raised, and the program goes on."""

import subprocess
import sys

import pytest

from groundstation.services.project.sample import unpack_sample
from tests.gui import random_user
from tests.gui.screen import the_application

SECONDS = 60


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "language", "has_project"), [(1, "en", False), (2, "en", True), (3, "de", True)])
def test_nothing_that_is_tried_ends_the_program_or_is_answered_by_an_exception(tmp_path, seed, language, has_project):
    the_application()  # skips where there is no screen
    project = [str(unpack_sample(tmp_path / "home" / "sample"))] if has_project else []
    arguments = [str(seed), str(SECONDS), str(tmp_path / "home"), language, *project]
    done = subprocess.run(
        [sys.executable, "-m", random_user.__name__, *arguments], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-4000:]
    n_acts = int(done.stdout.split()[-4])
    assert n_acts > SECONDS

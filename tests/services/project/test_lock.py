"""One window for each project; the lock of a process that has died is no lock."""

import os
import signal
import subprocess
import sys

import pytest

from groundstation.services.project.lock import HOLDER_FILE, ProjectInUse, lock_holder, lock_project
from planning.base.errors import InputError
from tests.services.project_cases import failing_disk

HOLD = """
import pathlib, sys
from groundstation.services.project.lock import lock_project
lock = lock_project(pathlib.Path(sys.argv[1]))
print("locked", flush=True)
sys.stdin.read()
"""


@pytest.fixture
def other_process(tmp_path):
    """Another Reflight that has the project open."""
    command = [sys.executable, "-c", HOLD, str(tmp_path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "locked\n"
        yield process
        process.kill()


def test_a_second_window_of_the_same_program_is_told(tmp_path):
    with lock_project(tmp_path) as lock:
        with pytest.raises(ProjectInUse, match=f"open in another Reflight \\(process {os.getpid()} on .* since 20"):
            lock_project(tmp_path)
        assert lock_holder(tmp_path).is_this_process
        lock.release()
        lock.release()
    assert lock_holder(tmp_path) is None
    lock_project(tmp_path).release()


def test_another_program_is_told_and_the_lock_ends_with_its_holder(tmp_path, other_process):
    with pytest.raises(ProjectInUse) as caught:
        lock_project(tmp_path)
    assert caught.value.holder.process == other_process.pid
    assert lock_holder(tmp_path).process == other_process.pid
    assert not lock_holder(tmp_path).is_this_process
    other_process.send_signal(signal.SIGKILL)
    other_process.wait()
    assert (tmp_path / HOLDER_FILE).exists()
    assert lock_holder(tmp_path) is None
    with lock_project(tmp_path):
        assert lock_holder(tmp_path).is_this_process


@pytest.mark.long
@pytest.mark.parametrize("content", [b"", b"{", b'{"process": "x"}'])
def test_a_damaged_note_on_the_holder_is_no_obstacle(tmp_path, content):
    with lock_project(tmp_path):
        (tmp_path / HOLDER_FILE).write_bytes(content)
        with pytest.raises(ProjectInUse, match="unknown"):
            lock_project(tmp_path)
    lock_project(tmp_path).release()


def test_a_folder_that_cannot_be_locked_says_what_can_be_done(tmp_path):
    with pytest.raises(InputError, match="found nothing of that name"):
        lock_project(tmp_path / "missing")
    assert not (tmp_path / "missing").exists()
    with failing_disk(1), pytest.raises(InputError, match=r"No space left on device.*saved as another project"):
        lock_project(tmp_path)
    assert lock_holder(tmp_path) is None


def test_a_lock_whose_holder_cannot_be_noted_is_a_lock(tmp_path):
    with failing_disk(2), lock_project(tmp_path), pytest.raises(ProjectInUse, match="unknown"):
        lock_project(tmp_path)
    lock_project(tmp_path).release()

"""Photos rendered on a Dask cluster: the same as by one process, whatever becomes of workers."""

import os
import signal
import subprocess
import sys
from dataclasses import replace
from functools import partial
from pathlib import Path

import distributed
import pytest

from planning.base.errors import InputError, OperationCancelled, ReconstructionError
from planning.site.bundled import single_panel
from reconstruction.scenes.runs.cluster_workers import TOKEN_FILE, RenderPlugin, program_sha256
from reconstruction.scenes.runs.photo_folder import render_photo_folder
from reconstruction.scenes.runs.photo_job import RenderWorker
from reconstruction.scenes.world.build import build_scene
from reconstruction.scenes.world.look import Look
from tests.reconstruction.scenes.runs.test_photo_folder import StopsAfter, job_for, record_of

ROOT = Path(__file__).resolve().parents[4]
IN_PROCESS = {"threads_per_worker": 1, "processes": False, "dashboard_address": ":0"}


@pytest.fixture(scope="module")
def scene():
    return build_scene(single_panel(), Look(near=False), 2)


@pytest.fixture(scope="module")
def client():
    """Of a cluster of two workers in this process."""
    with distributed.LocalCluster(n_workers=2, **IN_PROCESS) as cluster, distributed.Client(cluster) as client:
        yield client


@pytest.fixture(scope="module")
def alone(scene, tmp_path_factory):
    """A finished run of one process; tests must not change it."""
    folder = tmp_path_factory.mktemp("alone") / "photos"
    render_photo_folder(job_for(scene, folder), folder, 1)
    return folder


@pytest.fixture
def heeds_ctrl_c():
    """What is started obeys Ctrl-C: shells start jobs in the background with it ignored, and that is inherited."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def files_of(folder):
    return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def runs_known(client):
    """Of all workers."""
    known = client.run(lambda dask_worker: [name for name in dask_worker.plugins if name.startswith("reflight")])
    return [name for names in known.values() for name in names]


class OnStage:
    """Does something when a stage begins."""

    def __init__(self, stage, action):
        self._stage, self._action = stage, action

    def report(self, stage, done, total):
        if stage == self._stage:
            self._action()


@pytest.mark.slow
def test_a_clusters_photos_are_those_of_one_process(scene, client, alone, tmp_path):
    render_photo_folder(job_for(scene, tmp_path), tmp_path, cluster=client)
    assert files_of(tmp_path) == files_of(alone)
    assert runs_known(client) == []


@pytest.mark.slow
def test_workers_that_do_not_see_the_folder_send_what_belongs_there(scene, client, alone, tmp_path):
    hide = OnStage("giving the scene to the cluster", lambda: (tmp_path / TOKEN_FILE).unlink())
    render_photo_folder(job_for(scene, tmp_path), tmp_path, None, hide, cluster=client)
    assert files_of(tmp_path) == files_of(alone)


@pytest.mark.parametrize("found", [b"mine", b"another", None])
def test_only_a_worker_that_reads_the_token_writes_by_itself(scene, alone, tmp_path, found):
    for path in ("images", "depth", "diffuse", "reflection", "panels", "masks", "normals", "glass"):
        (tmp_path / path).mkdir()
    if found is not None:
        (tmp_path / TOKEN_FILE).write_bytes(found)
    job = job_for(scene, tmp_path)
    plugin = RenderPlugin(partial(RenderWorker, job, tmp_path, 1.0), tmp_path, b"mine", program_sha256())
    plugin.setup(type("Worker", (), {"address": "here"}))
    sums, contents = plugin.render(0)
    assert (len(sums), len(contents)) == ((8, 0) if found == b"mine" else (0, 8))
    assert job.photos[0].path.exists() == (found == b"mine")


@pytest.mark.slow
def test_a_cancelled_run_leaves_nothing_behind_and_goes_on_without_the_cluster(scene, client, alone, tmp_path):
    job = job_for(scene, tmp_path)
    with pytest.raises(OperationCancelled):
        render_photo_folder(job, tmp_path, None, StopsAfter(1), cluster=client)
    assert 1 <= len(record_of(tmp_path)["files"]) < 3
    assert not (tmp_path / TOKEN_FILE).exists()
    assert runs_known(client) == []
    assert render_photo_folder(job, tmp_path, 1).n_kept >= 1
    assert files_of(tmp_path) == files_of(alone)


@pytest.mark.slow
def test_a_photo_that_fails_by_itself_is_named(scene, client, tmp_path):
    job = job_for(scene, tmp_path)
    elsewhere = replace(job.photos[1], path=Path("elsewhere.jpg"))
    job = replace(job, photos=(job.photos[0], elsewhere, job.photos[2]))
    with pytest.raises(ReconstructionError, match=f"^{elsewhere.name}: a worker could not render it: ValueError"):
        render_photo_folder(job, tmp_path, cluster=client)
    assert runs_known(client) == []


def test_a_worker_with_another_program_takes_no_photos(scene, tmp_path):
    job = job_for(scene, tmp_path)
    plugin = RenderPlugin(partial(RenderWorker, job, tmp_path, 1.0), tmp_path, b"", "another")
    plugin.setup(type("Worker", (), {"address": "tcp://10.0.0.7:4000"}))
    with pytest.raises(InputError, match=r"tcp://10\.0\.0\.7:4000 runs another version of it"):
        plugin.render(0)


@pytest.mark.slow
def test_a_cluster_without_workers_is_waited_for_and_can_be_cancelled(scene, tmp_path):
    def cancel():
        raise OperationCancelled("enough")

    waiting = OnStage("waiting for workers of the cluster", cancel)
    with (
        distributed.LocalCluster(n_workers=0, **IN_PROCESS) as cluster,
        distributed.Client(cluster) as client,
        pytest.raises(OperationCancelled),
    ):
        render_photo_folder(job_for(scene, tmp_path), tmp_path, None, waiting, cluster=client)


@pytest.mark.slow
def test_a_photo_whose_worker_dies_is_handed_out_again(scene, alone, tmp_path):
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0") as cluster,
        distributed.Client(cluster) as client,
    ):
        victims = list(client.run(os.getpid).values())[:1]

        def kill():
            # Both workers have a photo by now, and first of all load what it takes to render one.
            while victims:
                os.kill(victims.pop(), signal.SIGKILL)

        render_photo_folder(job_for(scene, tmp_path), tmp_path, None, OnStage("rendering photos", kill), cluster=client)
        assert victims == []
    assert files_of(tmp_path) == files_of(alone)


@pytest.mark.slow
def test_a_photo_that_kills_every_worker_is_named(scene, tmp_path):
    with (
        distributed.LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=":0") as cluster,
        distributed.Client(cluster) as client,
    ):
        job = job_for(scene, tmp_path)

        def kill():
            for process in client.run(os.getpid, on_error="ignore").values():
                os.kill(process, signal.SIGKILL)

        with pytest.raises(ReconstructionError, match=f"^{job.photos[0].name}: 4 workers ended while they rendered"):
            render_photo_folder(job, tmp_path, None, OnStage("rendering photos", kill), cluster=client)


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="sends SIGINT as a POSIX terminal does")
def test_ctrl_c_ends_the_command_and_leaves_the_cluster_to_others(heeds_ctrl_c, tmp_path):
    folder = tmp_path / "photos"
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0") as cluster,
        distributed.Client(cluster) as client,
    ):
        command = [sys.executable, "app.py", "scene", "render", "planar-far", "-o", str(folder), "--views", "40"]
        command += ["--width", "256", "--cluster", cluster.scheduler_address]
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
        with subprocess.Popen(command, cwd=ROOT, start_new_session=True, **pipes) as running:
            while not (folder / "scene.json").is_file() or not record_of(folder)["files"]:
                with pytest.raises(subprocess.TimeoutExpired):
                    running.wait(0.2)
            running.send_signal(signal.SIGINT)
            out, err = running.communicate(timeout=400)
        assert (running.returncode, out) == (1, "")
        assert err.endswith("cancelled\n")
        assert "Traceback" not in err
        assert 1 <= len(record_of(folder)["files"]) < 40
        assert runs_known(client) == []
        assert client.submit(pow, 2, 3).result() == 8
    assert not (folder / TOKEN_FILE).exists()

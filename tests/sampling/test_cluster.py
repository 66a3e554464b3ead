"""Studies on a Dask cluster: real worker processes on this machine, one of them killed."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from cagepose import SceneError, StudyResults
from cagepose.cli.app import main
from cagepose.sampling import cluster, runner
from our_studies import RAIL, RunStudy, rows_of

distributed = pytest.importorskip("distributed")
ANGLES = {f"cage.pose.euler_zyx_deg[{axis}]": {"uniform": [-0.4, 0.4]} for axis in range(3)}
KINDS: dict[str, tuple[int, dict[str, Any]]] = {
    "batch": (3000, ANGLES),
    "built": (300, {"object.boxes[0].size[2]": {"uniform": [0.9, 2.2]}, **ANGLES}),
}

pytestmark = pytest.mark.filterwarnings("ignore::ResourceWarning")  # of Dask's own processes


@pytest.fixture(scope="module")
def workers() -> Iterator[Any]:
    options = {"n_workers": 3, "threads_per_worker": 1, "dashboard_address": ":0", "silence_logs": 50}
    with distributed.LocalCluster(**options) as found:
        yield found


@pytest.fixture(autouse=True)
def small_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(runner, "ROWS_OF_A_BATCH", 256)
    monkeypatch.setattr(runner, "ROWS_ONE_BY_ONE", 32)


@pytest.mark.parametrize("kind", KINDS)
def test_the_table_is_the_same_for_one_process_and_three_dask_workers(
    run_study: RunStudy, workers: Any, kind: str
) -> None:
    runs, vary = KINDS[kind]
    alone = run_study(vary, runs, workers=1, folder="alone")
    spread = run_study(vary, runs, dask=workers.scheduler_address, folder="spread")
    assert len(spread.folder.parts()) == 12 - 2 * (kind == "built")
    assert rows_of(spread) == rows_of(alone)
    first, second, *_ = spread.folder.parts()
    kept = first.stat().st_mtime_ns
    second.unlink()
    resumed = run_study(vary, runs, dask=workers.scheduler_address, folder="spread", resume=True)
    assert rows_of(resumed) == rows_of(alone)
    assert first.stat().st_mtime_ns == kept


@contextmanager
def once_a_part_is_there(folder: Path, act: Callable[[], object]) -> Iterator[None]:
    """Act while a study runs, and see to it that this was not too late."""
    done, acted = threading.Event(), threading.Event()

    def wait() -> None:
        while not list(folder.glob("parts/*.parquet")):
            if done.wait(0.01):
                return
        act()
        acted.set()

    thread = threading.Thread(target=wait)
    thread.start()
    try:
        yield
    finally:
        done.set()
        thread.join()
    assert acted.is_set()


def test_the_table_is_the_same_after_a_worker_was_killed(run_study: RunStudy, workers: Any, tmp_path: Path) -> None:
    """Kill -9 as soon as a part is there; Dask gives what it had to the others, and starts a new one."""
    runs, vary = KINDS["built"]
    victim = next(iter(workers.workers.values())).pid
    with once_a_part_is_there(tmp_path / "killed", lambda: os.kill(victim, signal.SIGKILL)):
        killed = run_study(vary, runs, dask=workers.scheduler_address, folder="killed")
    assert rows_of(killed) == rows_of(run_study(vary, runs, folder="alone"))


@pytest.mark.filterwarnings("ignore")  # Dask's own, of connections that end
def test_a_study_goes_on_alone_after_its_scheduler_was_lost(
    run_study: RunStudy, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(cluster, "CONNECT_S", 2.0)  # so long it is looked for
    runs, vary = 20 * 32, KINDS["built"][1]
    options = {"n_workers": 1, "threads_per_worker": 1, "dashboard_address": ":0", "silence_logs": 50}
    lost = pytest.raises(SceneError, match="the scheduler was lost; what is done is kept: add --resume")
    with distributed.LocalCluster(**options) as found, lost, once_a_part_is_there(tmp_path / "lost", found.close):
        run_study(vary, runs, dask=found.scheduler_address, folder="lost")
    assert 0 < len(StudyResults(tmp_path / "lost")) < runs
    assert rows_of(run_study(vary, runs, folder="lost", resume=True)) == rows_of(run_study(vary, runs, folder="alone"))


def test_what_is_wrong_with_a_cluster_is_said(
    run_study: RunStudy, monkeypatch: pytest.MonkeyPatch, workers: Any, tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    monkeypatch.setattr(cluster, "CONNECT_S", 0.2)
    monkeypatch.setattr(cluster, "WORKERS_S", 0.2)
    study = tmp_path / "study.yaml"
    study.write_text(f"scene: {RAIL}\nvary: {{friction.coefficient: {{uniform: [0, 1]}}}}\nsample: {{runs: 8}}\n")
    for address in ("tcp://127.0.0.1:1", "nowhere://x"):
        assert main(["study", str(study), "--out", str(tmp_path / "out"), "--resume", "--dask", address]) == 2
        told = capsys.readouterr().err
        assert told.startswith(f"dask: {address}: no scheduler answers (")
        assert told.endswith("; start one with: dask scheduler\n")
    missing = pytest.raises(SceneError, match="has no workers; start some with: dask worker tcp://")
    with distributed.LocalCluster(n_workers=0, dashboard_address=":0", silence_logs=50) as empty, missing:
        run_study(ANGLES, 8, dask=empty.scheduler_address, folder="empty")
    monkeypatch.setattr(cluster, "__version__", "0.0.0")
    with pytest.raises(SceneError, match=r"a worker has cagepose .*, and this is 0\.0\.0; install this cagepose"):
        run_study(ANGLES, 8, dask=workers.scheduler_address, folder="other")
    assert len(StudyResults(tmp_path / "other")) == 0

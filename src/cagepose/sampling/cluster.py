"""Parts of a study run by the workers of a Dask cluster."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError
from itertools import islice

from distributed import Client, KilledWorker, as_completed

from cagepose import __version__
from cagepose.errors import Problem, SceneError
from cagepose.files.study_file import StudyFile
from cagepose.model.checks import FloatArray
from cagepose.sampling.outcome import Outcomes
from cagepose.sampling.runner import Part, Runner, RunPart

CONNECT_S, WORKERS_S = 10.0, 30.0
"""How long to wait for the scheduler, and for its first worker."""
PARTS_OF_A_WORKER = 2
"""One that it runs and one that waits for it; no more are sent, so that memory does not grow with the rows."""


def run_on_cluster(
    study: StudyFile, address: str, parts: Sequence[Part], values_of: Callable[[int, int], FloatArray]
) -> Iterator[RunPart]:
    """Yield parts of a study in the order in which they are done, with their varied numbers and where their runs ended.

    A worker that dies is no matter: Dask gives its part to another one.

    Raises
    ------
    SceneError
        No scheduler at the address, or it was lost; no worker, or one without this version of cagepose; or workers die
        of the same rows again and again.
    """
    try:
        client = Client(address, timeout=CONNECT_S, set_as_default=False)
    except (OSError, ValueError) as error:
        reason = " ".join(str(error).split())
        raise _refused(f"{address}: no scheduler answers ({reason}); start one with: dask scheduler") from None
    with client:
        try:
            client.wait_for_workers(1, timeout=WORKERS_S)
        except TimeoutError:
            raise _refused(f"{address}: has no workers; start some with: dask worker {address} --nthreads 1") from None
        # each thread has a part that it runs and others that wait for it
        waiting = iter(parts)
        values = dict[str, tuple[Part, FloatArray]]()
        n_threads = sum(worker["nthreads"] for worker in client.scheduler_info(n_workers=-1)["workers"].values())

        def sent(part: Part) -> object:
            rows = values_of(*part)
            future = client.submit(_run_part, study, rows, pure=False)
            values[future.key] = part, rows
            return future

        running = as_completed(map(sent, islice(waiting, PARTS_OF_A_WORKER * n_threads)), loop=client.loop)
        for future in running:
            try:
                version, outcomes = future.result()
            except CancelledError:
                raise _refused(f"{address}: the scheduler was lost; what is done is kept: add --resume") from None
            except KilledWorker as error:
                raise _refused(
                    f"{address}: the same rows ended several workers ({error}); look at their logs"
                ) from None
            except ImportError as error:
                raise _refused(f"{address}: a worker cannot import what it needs ({error}); {_REMEDY}") from None
            if version != __version__:
                raise _refused(f"{address}: a worker has cagepose {version}, and this is {__version__}; {_REMEDY}")
            for part in islice(waiting, 1):
                running.add(sent(part))
            yield *values.pop(future.key), outcomes


_REMEDY = "install this cagepose, with its extras study and dask, for all workers"


def _refused(message: str) -> SceneError:
    return SceneError([Problem(("dask",), message)])


def _run_part(study: StudyFile, values: FloatArray) -> tuple[str, Outcomes]:
    """Run rows in a worker, by one thread; the same rows have the same bits wherever they are run."""
    return __version__, Runner(study, workers=1).run(values, with_forces=bool(study.model.forces))

"""Inner kernels as machine code, for tests that ask them thousands of times: as plain Python the search for another
onset takes seconds, and Coulomb's law up to two.

They come from a library of their own, which is built once for each state of the kernels and kept in ``build/``; that
takes some 5 s after the program's own library was built. As a program, ``inner_kernels.py PATH`` builds it.
"""

from __future__ import annotations

import fcntl
import hashlib
import os
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

from cagepose.kernels.native import kernel
from cagepose.kernels.native.library import LIBRARY, Library, kernel_library, sources_hash

ROOT = Path(__file__).resolve().parents[1]


def entries() -> Iterator[tuple[Any, tuple[object, ...]]]:
    """Yield each kernel and arguments of the types that tests call it with."""
    import numpy as np

    from cagepose.kernels.algebra.least_squares import empty_system
    from cagepose.kernels.algebra.motion import Motion
    from cagepose.kernels.algebra.record import empty_record, empty_rows
    from cagepose.kernels.boundary import first_meeting as of_boundaries
    from cagepose.kernels.boundary.circle_first import first_touch_of_curved
    from cagepose.kernels.boundary.features import NO_BOUNDARY, empty_placed, place_boundary
    from cagepose.kernels.boundary.groups import number_groups
    from cagepose.kernels.boundary.meetings import find_meetings
    from cagepose.kernels.boundary.overlap import empty_overlap_work, find_overlap
    from cagepose.kernels.boundary.queue import empty_queue
    from cagepose.kernels.boundary.touching import empty_meetings
    from cagepose.kernels.boundary.within import depth_in
    from cagepose.kernels.circles.beside_circle import places_by_circle
    from cagepose.kernels.circles.beside_round import Round, places_by_round
    from cagepose.kernels.circles.places import Circle, Place
    from cagepose.kernels.contact.cone import ConeWorkspace, cone_residual
    from cagepose.kernels.contact.contact_set import empty_contact_set
    from cagepose.kernels.contact.coulomb import coulomb_onset
    from cagepose.kernels.contact.coulomb_newton import NewtonWorkspace
    from cagepose.kernels.contact.coulomb_pivots import PivotWorkspace
    from cagepose.kernels.stability.relaxation import N_COLUMNS
    from cagepose.kernels.stability.strong import ModeTree, other_onset

    contacts, load = empty_contact_set(1), np.zeros(7)
    cone, newton, tree = empty_record(ConeWorkspace), empty_record(NewtonWorkspace), empty_record(ModeTree)
    yield cone_residual, (contacts, 0.0, cone)
    yield coulomb_onset, (contacts, 0.0, load, cone, load, newton, empty_record(PivotWorkspace))
    yield other_onset, (contacts, 0.0, load, tree, newton, empty_system(N_COLUMNS))
    origin = (0.0, 0.0, 0.0)
    circle, line, places = Circle(origin, origin, origin, 0.0), Round(origin, origin, 0.0, 0.0), empty_rows(Place, 1)
    yield places_by_round, (circle, line, 0.0, places)
    yield places_by_circle, (circle, circle, 0.0, places)
    body, found, motion = empty_placed(NO_BOUNDARY), empty_meetings(0), Motion(origin, origin, 0.0, origin)
    yield place_boundary, (body, origin, (1.0, 0.0, 0.0, 0.0))
    yield find_meetings, (body, body, 0.0, found)
    yield number_groups, (body, body, 0.0, found)
    yield find_overlap, (body, body, 0.0, empty_overlap_work(NO_BOUNDARY, NO_BOUNDARY))
    yield depth_in, (NO_BOUNDARY, origin, 0.0, found.waiting)
    search = of_boundaries.Search(motion, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    yield of_boundaries.first_to_meet, (body, body, search, found, empty_queue(), body)
    one = (body, 0, body, 0, motion, 0.0, 0.0, 0.0, 0.0, body, found.places, found.waiting, found.kept, 0)
    yield first_touch_of_curved, one


def as_machine_code(inner: Any) -> Any:
    """A kernel of `entries` as machine code; as plain Python where all kernels are."""
    called = kernel.Entry(inner)
    called.library = _library()
    return called


@cache
def _library() -> Library | None:
    native = kernel_library()
    if native is None:
        return None
    digest = hashlib.sha256(sources_hash().encode() + native.level.encode())
    for source in (Path(__file__), *sorted((ROOT / "build_kernels").glob("*.*"))):
        digest.update(source.read_bytes())
    path = ROOT / "build" / "inner_kernels" / f"{digest.hexdigest()[:16]}{LIBRARY.suffix}"
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # tests run in several processes
        if not path.exists():
            environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), *sys.path])}
            subprocess.run([sys.executable, __file__, str(path), native.level], env=environment, check=True)
    return Library(path, native.level)


def _build(target: Path, level: str) -> None:
    """Build as `build_kernels.build.build` does, other entries and one level of processors."""
    os.environ.update(NUMBA_OPT="0", NUMBA_DISABLE_INTEL_SVML="1")
    from build_kernels.c_functions import module_of
    from build_kernels.compile import take_over
    from build_kernels.link import link

    take_over()
    link(module_of(entries()), (level,), sources_hash(), target)


if __name__ == "__main__":
    _build(Path(sys.argv[1]), sys.argv[2])

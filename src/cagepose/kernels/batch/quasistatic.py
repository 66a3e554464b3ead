"""Many quasistatic runs with their proofs, one after the other, without Python between them."""

from __future__ import annotations

import numpy as np

from cagepose.kernels.algebra.record import Rows
from cagepose.kernels.algebra.tolerances import KernelTolerances
from cagepose.kernels.algebra.vector import Vector
from cagepose.kernels.batch.rows import (
    INVALID,
    Endings,
    Starts,
    at_run,
    is_valid_start,
    object_start,
    place_cage,
    scaled_tolerances,
    write_ending,
)
from cagepose.kernels.collision.geometry import Geometry
from cagepose.kernels.contact.metric import Body, PhaseLoad
from cagepose.kernels.native.kernel import entry
from cagepose.kernels.quasistatic.run import QuasistaticRules, QuasistaticWorkspace, phase_run
from cagepose.kernels.quasistatic.step import Setting
from cagepose.kernels.stability.proof import PROVEN_MOVES, TOO_MANY_CONTACTS, UNIQUENESS_NOT_SHOWN, ProofRoom, prove
from cagepose.kernels.stability.proof_search import search_onsets
from cagepose.kernels.trace import RESTS, STALLED


@entry
def quasistatic_runs(
    first: int,
    last: int,
    starts: Starts,
    loads: Rows[Rows[PhaseLoad]],
    geometry: Geometry,
    body: Body,
    middle_object: Vector,
    rules: QuasistaticRules,
    tolerances: KernelTolerances,
    work: QuasistaticWorkspace,
    at: ProofRoom,
    endings: Endings,
) -> None:
    """Run ``first`` up to, without, ``last``, and prove where a phase comes to rest.

    Parameters
    ----------
    starts
        What differs.
    loads
        As for one run, with one more axis in front: one row for each run, or one for all.
    geometry, body
        The object as seen from its centre of gravity; the cage points are written over.
    middle_object
        The centre of gravity in the object's frame, metres.
    rules
        The friction of ``starts`` counts, not theirs.
    tolerances
        For a scene of size 1.
    work, at
        Written over.
    endings
        Filled. A phase whose end is no balance after all is "stalled", as in `cagepose.run`.
    """
    for run in range(first, last):
        size_m = starts.sizes_m[at_run(len(starts.sizes_m), run)]
        friction = starts.frictions[at_run(len(starts.frictions), run)]
        run_tolerances = scaled_tolerances(tolerances, size_m)
        run_loads = loads[at_run(len(loads), run)]
        origin = place_cage(starts, run, geometry)
        position, quaternion = object_start(starts, run, middle_object, origin)
        if not is_valid_start(geometry, starts, position, quaternion, size_m, run_tolerances.touch_m, work.placement):
            endings.verdicts[run, 0] = INVALID
            continue
        n_events = int(np.int64(0))  # a plain 0 would compile `phase_run` twice
        for phase in range(endings.verdicts.shape[1]):
            before, load = n_events, run_loads[phase]
            setting = Setting(geometry, body, load, size_m, friction, rules.turn_step_rad, run_tolerances)
            verdict, n_events, position, quaternion = phase_run(
                setting, position, quaternion, phase, rules.step_limit, n_events, work
            )
            if verdict == RESTS:
                proof, _, _ = prove(geometry, body, position, quaternion, load, friction, size_m, run_tolerances, at)
                if proof == UNIQUENESS_NOT_SHOWN:
                    proof = search_onsets(friction, at)
                endings.proofs[run, phase] = proof
                if proof in (PROVEN_MOVES, TOO_MANY_CONTACTS):
                    verdict = STALLED
            write_ending(endings, run, phase, verdict, n_events - before, position, quaternion, middle_object, origin)
            for i in range(work.contacts.used[0]):
                endings.touching[run, phase, work.contacts.rows[i].point] = True
            if verdict != RESTS:
                break

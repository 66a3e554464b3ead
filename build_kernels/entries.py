"""Every entry of the library, with arguments of the types that it is called with."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from cagepose.kernels.algebra.linear_program import ProgramRoom, extents, program_rows, solve_program
from cagepose.kernels.algebra.pose import write_euler_zyx, write_quaternions
from cagepose.kernels.algebra.record import dtype_of, empty_record, empty_rows
from cagepose.kernels.algebra.tolerances import kernel_tolerances
from cagepose.kernels.batch.quasistatic import quasistatic_runs
from cagepose.kernels.batch.rows import Starts, empty_endings
from cagepose.kernels.batch.stepwise import stepwise_runs
from cagepose.kernels.collision.contacts import empty_contact_rows, fill_contact_rows
from cagepose.kernels.collision.geometry import Geometry, empty_placement, place_object
from cagepose.kernels.contact.metric import Body, PhaseLoad
from cagepose.kernels.play.certificate import certify, empty_certificate_room
from cagepose.kernels.play.escape import Station, grow_tree
from cagepose.kernels.play.goal import Goal
from cagepose.kernels.play.rows import empty_play_room, write_start
from cagepose.kernels.play.search import Extreme, find_play
from cagepose.kernels.quasistatic.run import QuasistaticRules, empty_quasistatic_workspace, quasistatic_run
from cagepose.kernels.stability.critical_friction import critical_friction
from cagepose.kernels.stability.proof import empty_proof_room, prove
from cagepose.kernels.stability.proof_search import first_motion, search_onsets
from cagepose.kernels.stepwise.run import PhaseLoads, StepwiseRules, empty_workspace, stepwise_run
from cagepose.kernels.stepwise.slip import SlipRules
from cagepose.kernels.stepwise.support import SupportRules

ORIGIN = (0.0, 0.0, 0.0)
UPRIGHT = (1.0, 0.0, 0.0, 0.0)


def entries() -> Iterator[tuple[Any, tuple[object, ...]]]:
    """Yield each entry and its arguments; only their types count."""
    vectors, quaternions, numbers = np.zeros((1, 3)), np.zeros((1, 4)), np.zeros(1)
    geometry = Geometry(vectors, vectors, np.zeros((1, 3, 3)), 1, vectors)
    body, tolerances = empty_record(Body), kernel_tolerances(1.0, 1e-9)
    loads = empty_rows(PhaseLoad, 1)

    yield write_quaternions, (vectors, quaternions)
    yield write_euler_zyx, (quaternions, vectors)
    yield place_object, (geometry, ORIGIN, UPRIGHT, empty_placement(geometry))
    yield fill_contact_rows, (geometry, ORIGIN, UPRIGHT, 0.0, empty_placement(geometry), empty_contact_rows(1))

    rules = QuasistaticRules(0.0, 0.0, 1)
    work, proof = empty_quasistatic_workspace(geometry, 1, 1), empty_proof_room(geometry)
    yield quasistatic_run, (geometry, body, ORIGIN, UPRIGHT, loads, rules, 0.0, tolerances, work)
    load = loads[0]
    yield prove, (geometry, body, ORIGIN, UPRIGHT, load, 0.0, 0.0, tolerances, proof)
    yield search_onsets, (0.0, proof)
    yield first_motion, (0.0, proof)
    yield critical_friction, (geometry, body, ORIGIN, UPRIGHT, load, tolerances, proof)

    directions = PhaseLoads(vectors, vectors, np.zeros(1, np.bool_))
    paper = StepwiseRules(SupportRules(0.0, 0.0, 0.0, 0.0), SlipRules(0.0, 0.0, 0.0, 0.0), 1)
    paper_work = empty_workspace(geometry, 1, paper)
    yield stepwise_run, (geometry, ORIGIN, UPRIGHT, directions, paper, 0.0, tolerances, paper_work)

    starts = Starts(vectors, quaternions, np.zeros((1, 1, 3)), vectors, quaternions, numbers, numbers, 0.0)
    endings = empty_endings(1, 1, 1)
    many_loads = np.zeros((1, 1), dtype_of(PhaseLoad))
    yield (
        quasistatic_runs,
        (0, 0, starts, many_loads, geometry, body, ORIGIN, rules, tolerances, work, proof, endings),
    )
    many_directions = PhaseLoads(np.zeros((1, 1, 3)), np.zeros((1, 1, 3)), np.zeros(1, np.bool_))
    yield stepwise_runs, (0, 0, starts, many_directions, geometry, ORIGIN, paper, tolerances, paper_work, endings)

    program, (rows, bounds) = empty_record(ProgramRoom), program_rows(1)
    yield solve_program, (rows, bounds, program)
    yield extents, (rows, bounds, program, np.zeros(6), np.zeros(6))
    room, goals, extremes = empty_play_room(geometry), empty_rows(Goal, 1), empty_rows(Extreme, 1)
    yield write_start, (geometry, 0.0, room)
    yield find_play, (geometry, 0.0, goals, extremes, room)
    yield certify, (geometry, 0.0, 0.0, goals, numbers, room, empty_certificate_room(1))
    yield grow_tree, (geometry, 0.0, vectors, empty_rows(Station, 1), 1, empty_placement(geometry), tolerances)

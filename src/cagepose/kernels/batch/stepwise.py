"""Many stepwise runs, one after the other, without Python between them."""

from __future__ import annotations

import numpy as np

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
from cagepose.kernels.native.kernel import entry, kernel
from cagepose.kernels.stepwise.run import PhaseLoads, StepwiseRules, Workspace, forget_contacts, phase_run
from cagepose.kernels.stepwise.slip import SlipRules
from cagepose.kernels.stepwise.support import SupportRules
from cagepose.kernels.trace import STABLE


@kernel
def rules_of_run(of_size: StepwiseRules, no_slip_angle_rad: float, size_m: float) -> StepwiseRules:
    """Scale rules that are given for a scene of size 1."""
    support, slip = of_size.support, of_size.slip
    return StepwiseRules(
        SupportRules(support.least_moment, support.blocked_key, support.unseen_key, support.equal_distance_m * size_m),
        SlipRules(no_slip_angle_rad, slip.contactless_angle_rad, slip.parallel_sine, slip.equal_distance_m * size_m),
        of_size.event_limit,
    )


@entry
def stepwise_runs(
    first: int,
    last: int,
    starts: Starts,
    loads: PhaseLoads,
    geometry: Geometry,
    middle_object: Vector,
    rules: StepwiseRules,
    tolerances: KernelTolerances,
    workspace: Workspace,
    endings: Endings,
) -> None:
    """Run ``first`` up to, without, ``last``.

    Parameters
    ----------
    starts
        What differs; ``frictions`` are angles here, below which a contact does not slip (R4), radians.
    loads
        As for one run, with one more axis in front: one row for each run, or one for all.
    geometry
        Boxes as seen from ``middle_object``; the cage points are written over.
    middle_object
        In the object's frame, metres.
    rules, tolerances
        For a scene of size 1.
    workspace
        Written over.
    endings
        Filled.
    """
    placement, touching = workspace.placement, workspace.touching
    for run in range(first, last):
        size_m = starts.sizes_m[at_run(len(starts.sizes_m), run)]
        no_slip = starts.frictions[at_run(len(starts.frictions), run)]
        run_tolerances = scaled_tolerances(tolerances, size_m)
        run_rules = rules_of_run(rules, no_slip, size_m)
        run_loads = PhaseLoads(
            loads.directions_world[at_run(len(loads.directions_world), run)],
            loads.points_object[at_run(len(loads.points_object), run)],
            loads.is_push,
        )
        origin = place_cage(starts, run, geometry)
        position, quaternion = object_start(starts, run, middle_object, origin)
        if not is_valid_start(geometry, starts, position, quaternion, size_m, run_tolerances.touch_m, placement):
            endings.verdicts[run, 0] = INVALID
            continue
        forget_contacts(touching)
        n_events = int(np.int64(0))  # a plain 0 would compile `phase_run` twice
        for phase in range(endings.verdicts.shape[1]):
            before = n_events
            verdict, n_events, position, quaternion = phase_run(
                geometry,
                placement,
                touching,
                position,
                quaternion,
                run_loads,
                phase,
                run_rules,
                size_m,
                run_tolerances,
                workspace.trace,
                n_events,
            )
            write_ending(endings, run, phase, verdict, n_events - before, position, quaternion, middle_object, origin)
            for point in range(len(geometry.points_world)):
                endings.touching[run, phase, point] = touching.is_touching[point]
            if verdict != STABLE:
                break

"""Everything that a drive writes to, and what does not change along it."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from cagepose.kernels.algebra.least_squares import MOST_FREEDOMS, PassiveSet
from cagepose.kernels.algebra.record import FloatArray, IntArray, Rows, empty_rows
from cagepose.kernels.boundary.geometry import Geometry, most_rows
from cagepose.kernels.contact.coulomb_newton import CARRYING_LIMIT
from cagepose.kernels.contact.metric import ScaledVector
from cagepose.kernels.driven.bodies import DriveMemory, empty_drive_memory
from cagepose.kernels.driven.rest_of_mode import RestWorkspace
from cagepose.kernels.quasistatic.setting import Setting
from cagepose.kernels.quasistatic.workspace import QuasistaticWorkspace, empty_quasistatic_workspace

HITS_LIMIT = 8
"""What the object may meet on one step, and is looked at."""
OF_CARRYING = 4
"""Guards of each contact that carries: its force, its cone, its slip, and the end of its features."""


class DriveScratch:
    """Memory of fixed size for one step of a drive; a record.

    Attributes
    ----------
    rest
        See there.
    held, stiffness, factor, vectors
        Basis of what contacts that carry hold, the stiffness, and its factor or its eigenvectors.
    guided, way, end_way
        Scaled motions for a unit share: with the bodies that push it, in all, and where a trial has got to.
    change, beside, load
        How the balance changes, for a unit share, where the object stands still; scratch; and a load.
    greatest, greatest_at, work, rubbed, lost
        Of the phase so far: the greatest sum of the drivers' forces along their ways, and after which share; their
        work, what friction took of it, and what was lost where the object snapped.
    kept_forces, kept_sticking, kept_contacts, n_kept
        What contacts did before other modes were tried.
    leap
        How far a trial is from leaping to another rest: below zero, it does.
    least_jam
        The least coefficient of friction with which the object could jam anywhere in the phase so far; inf: none.
    n_hits, hit_features, hit_angles
        What may be met: features of object and cage, and where along a circle.
    """

    rest: RestWorkspace
    held: PassiveSet
    stiffness: Annotated[FloatArray, MOST_FREEDOMS, MOST_FREEDOMS]
    factor: Annotated[FloatArray, MOST_FREEDOMS, MOST_FREEDOMS]
    vectors: Annotated[FloatArray, MOST_FREEDOMS, MOST_FREEDOMS]
    guided: ScaledVector
    way: ScaledVector
    end_way: ScaledVector
    change: ScaledVector
    beside: ScaledVector
    load: ScaledVector
    greatest: float
    greatest_at: float
    work: float
    rubbed: float
    lost: float
    kept_forces: Annotated[FloatArray, CARRYING_LIMIT, 3]
    kept_sticking: Annotated[IntArray, CARRYING_LIMIT]
    kept_contacts: Annotated[IntArray, CARRYING_LIMIT]
    n_kept: int
    leap: float
    least_jam: float
    n_hits: int
    hit_features: Annotated[IntArray, HITS_LIMIT, 2]
    hit_angles: Annotated[FloatArray, HITS_LIMIT]


class DriveWorkspace(NamedTuple):
    """All arrays that a run writes to.

    Attributes
    ----------
    run
        Those of steps with the bodies at rest.
    memory
        Where the bodies are.
    scratch
        One record.
    low, high, middle
        Guards at the two sides of an event, and between them, (n_guards,).
    drivers
        What the drivers do, (n_bodies, 7), see `write_drivers`.
    """

    run: QuasistaticWorkspace
    memory: DriveMemory
    scratch: Rows[DriveScratch]
    low: FloatArray
    high: FloatArray
    middle: FloatArray
    drivers: FloatArray


def empty_drive_workspace(
    geometry: Geometry, step_limit: int, n_phases: int, n_legs: int, n_actions: int
) -> DriveWorkspace:
    """Return a workspace for one run at a time (plain Python)."""
    n_bodies = len(geometry.cage.first_nodes) - 1
    n_guards = OF_CARRYING * CARRYING_LIMIT + most_rows(geometry) + HITS_LIMIT + 3
    return DriveWorkspace(
        empty_quasistatic_workspace(geometry, step_limit),
        empty_drive_memory(n_phases, n_bodies, n_legs, n_actions),
        empty_rows(DriveScratch, 1),
        np.zeros(n_guards),
        np.zeros(n_guards),
        np.zeros(n_guards),
        np.zeros((n_bodies, 7)),
    )


class DriveSetting(NamedTuple):
    """What does not change along the drive of a phase: its setting, whose load is that in the memory of the bodies, its
    number, and the force at which it stops.
    """

    setting: Setting
    phase: int
    stop_at: float

"""The quasistatic method as seen from a scene: its numbers, and what a careful reader should know of its runs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from cagepose.kernels.driven.workspace import DriveWorkspace, empty_drive_workspace
from cagepose.kernels.quasistatic.run import QuasistaticRules
from cagepose.kernels.quasistatic.step import RULE_NAMES, STUCK
from cagepose.model.load import Load
from cagepose.model.remarks import remarks
from cagepose.model.scene import Scene
from cagepose.model.wording import few
from cagepose.runs.actions import actions_of
from cagepose.runs.driven import DriveRun
from cagepose.runs.drives import bodies_off, drives_of
from cagepose.runs.run import PhaseRun
from cagepose.runs.warnings_of_runs import (
    edge_warnings,
    lost_weight_warnings,
    plane_warnings,
    proof_warnings,
    spring_warnings,
    unrun_warnings,
    weight_warnings,
)

TURN_STEP_RAD = 0.02
"""Longest turn in one step: the path is wrong by about this fraction of it (docs/theory/mechanics)."""
STEP_LIMIT = 3000
"""Steps in a phase after which a run is named "limit"."""


NEAR_THE_END = 0.01
"""Share of what is done of a drive."""
FAILURE_REMEDY = (
    "change the friction coefficient by a hundredth, or move a point or the start by a millionth of the size"
)
"""What may help a run that failed. Most fail on contacts that fit exactly."""


def quasistatic_rules(_scene: Scene) -> QuasistaticRules:
    """Return the numbers of the method."""
    return QuasistaticRules(TURN_STEP_RAD, STEP_LIMIT)


def quasistatic_workspace(scene: Scene, step_limit: int) -> DriveWorkspace:
    """Return what one run of a scene at a time writes to."""
    n_phases, n_actions = actions_of(scene).shape
    n_legs = np.asarray(drives_of(scene).legs).shape[2]
    return empty_drive_workspace(scene.geometry, step_limit, n_phases, n_legs, n_actions)


def quasistatic_warnings(scene: Scene, phases: Sequence[PhaseRun], friction: float) -> Iterator[str]:
    """What a careful reader should know: weights, contacts on edges, and what is less than a proven rest."""
    yield from remarks(scene)
    yield from weight_warnings(scene, len(phases))
    yield from lost_weight_warnings(scene, len(phases))
    yield from plane_warnings(scene, phases)
    for phase in phases:
        yield from edge_warnings(phase)
        yield from _edge_motion_warnings(phase)
        yield from spring_warnings(scene, phase)
    if not any(spring_warnings(scene, phases[-1])):  # they say why
        yield from _failure_warnings(phases[-1], scene.loads[len(phases) - 1])
    yield from _off_warnings(scene, phases[-1], scene.loads[len(phases) - 1])
    yield from unrun_warnings(scene, phases)
    yield from proof_warnings(phases, friction)


def _off_warnings(scene: Scene, phase: PhaseRun, load: Load) -> Iterator[str]:
    """Where a grip has slipped off."""
    if off := bodies_off(scene, phase, load):
        yield (
            f"{phase.name}: {few(off)} slipped off the object and has nothing ahead, so the drive ends here; press"
            " harder, or end it before, to see what the object does"
        )


def _edge_motion_warnings(phase: PhaseRun) -> Iterator[str]:
    """The first event of a phase that begins because a contact is exactly on an edge."""
    for number, event in enumerate(phase.events, start=1):
        if event.note == "edge":
            yield (
                f"{phase.name}, event {number}: it moves only because contacts lie exactly on edges: with the other"
                " faces of these edges they would hold it. On a real part chance decides that: move them off the edges"
            )
            return


def _may_jam_there(drive: DriveRun | None) -> bool:
    """Whether a drive could jam where it ended, and took its greatest force as it came there."""
    if drive is None or not drive.jam_possible:
        return False
    came_there = (1.0 - NEAR_THE_END) * drive.share
    return drive.jam_possible[-1][1] >= drive.share and drive.greatest_share >= came_there > 0.0


def _failure_warnings(phase: PhaseRun, load: Load) -> Iterator[str]:
    """Why a phase failed, with which contacts, and what to change."""
    has_potential = not load.moments and all(push.has_potential for push in load.pushes)
    touching = ", ".join(dict.fromkeys(contact.point for contact in phase.contacts)) or "no point"
    if phase.verdict == "limit" and not has_potential:
        yield (
            f"{phase.name}: it still moved after {STEP_LIMIT} steps, touching {touching}: moments, and forces that"
            " follow or stay at a point of the world, can drive an object in circles for ever; add a stop or a spring"
        )
    elif phase.verdict == "limit":
        yield f"{phase.name}: it still moved after {STEP_LIMIT} steps, touching {touching}; {FAILURE_REMEDY}"
    elif phase.verdict == "stalled" and _may_jam_there(phase.drive):
        assert phase.drive is not None
        yield (
            f"{phase.name}: it probably jams here, at {100.0 * phase.drive.share:.4g} % of the drive, which was not"
            f" shown: no step goes on, the drive force is greatest there, and forces of {touching} could stand against"
            " it and grow without bound"
        )
    elif phase.verdict == "stalled" and phase.events and phase.events[-1].rule == RULE_NAMES[STUCK]:
        yield (
            f"{phase.name}: touching {touching}, no motion that obeys Coulomb's law was found, nor a rest"
            f" ({phase.proof.reason}); {FAILURE_REMEDY}"
        )
    elif phase.verdict == "stalled":
        yield f"{phase.name}: no step was found that keeps the contacts of {touching}; {FAILURE_REMEDY}"

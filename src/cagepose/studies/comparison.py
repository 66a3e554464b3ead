"""The same scene by several methods, metrics and coefficients of friction, and where the runs part."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite
from typing import get_args

import numpy as np

from cagepose.model.checks import expect
from cagepose.model.methods import DEFAULT_FRICTION, Metric
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.model.scope import check_boxes_and_points
from cagepose.model.wording import components, counted
from cagepose.runs.changes import mode_of
from cagepose.runs.run import AT_REST, Event, Motion, PhaseRun, Run, Verdict
from cagepose.runs.solve import run
from cagepose.studies.tolerances import SAME_POSE_OF_SIZE

METRICS: dict[Metric, str] = {"release": "by inertia", "drag": "by drag"}
"""What decides how the object starts to move."""
GROUNDS = {
    "free": "no contact resists",
    "escapes": "no contact is ahead",
    "slide": "the contacts do not balance the load, and those with a force slide",
    "pivot": "the contacts do not balance the load, but one of them sticks by friction",
    "driven": "bodies of the cage are driven and move it, always in equilibrium",
    **dict.fromkeys(("A-1", "B-1"), "no contact, so along the load"),
    **dict.fromkeys(("A-2", "B-2"), "about its one contact, taken as fixed, along the load's moment"),
    **dict.fromkeys(("A-3", "B-3"), "about the line through two contacts, taken as fixed"),
    "Slp-1": "every normal is more than the friction angle off the load, so it slips on that face",
    "Slp-2": "every normal is more than the friction angle off the load, so it slips on two faces",
}
"""Why a rule moves the object as it does."""
ENDS: dict[Verdict, str] = {
    "escapes": "no contact is ahead",
    "spins": "a full turn meets nothing",
    "cycling": "a pose came back",
    "stalled": "no progress",
    "limit": "too many events",
    "blocked": "no motion of the object makes way for the drive",
    "jams": "friction alone stops the drive",
    "stops": "the drive has reached its force limit",
}
"""Why a run ends that does not end at rest, or why a drive does."""


@dataclass(frozen=True, eq=False)
class Variant:
    """One way to run the scene, and what came of it.

    Attributes
    ----------
    label
        "stepwise", or "quasistatic" with metric and coefficient of friction.
    friction
        The coefficient of friction that was used.
    run
        The run.
    """

    label: str
    friction: float
    run: Run

    def __repr__(self) -> str:
        return f"<Variant {self.label!r}: {self.run.verdict}>"


@dataclass(frozen=True, eq=False)
class Parting:
    """Where a variant leaves the way of the first one.

    Attributes
    ----------
    label
        Of the variant.
    phase
        Name of the phase.
    number, first_number
        Number of the event in that phase, from 1, of the variant and of the first one; None: it has ended.
    reason
        What each of the two does there, and why.
    """

    label: str
    phase: str
    number: int | None
    first_number: int | None
    reason: str

    def __repr__(self) -> str:
        return f"<Parting of {self.label!r} in {self.phase!r}>"


@dataclass(frozen=True, eq=False)
class Comparison:
    """All variants, the first one being what the others are compared with, and where they part from it."""

    variants: tuple[Variant, ...]
    partings: tuple[Parting, ...]

    def __repr__(self) -> str:
        counts = counted((len(self.variants), "variant", "variants"), (len(self.partings), "parting", "partings"))
        return f"<Comparison of {self.variants[0].run.scene.name!r}: {counts}>"


def compare(scene: Scene, frictions: Sequence[float] | None = None) -> Comparison:
    """Run ``scene`` by the paper's rules and by the mechanics, under both metrics and each coefficient of friction.

    Parameters
    ----------
    scene
        What to run.
    frictions
        Coefficients of friction; None: without friction, and with the scene's own (else that of the paper's rules).

    Raises
    ------
    SceneError
        A coefficient below zero, or other shapes than boxes and points.
    """
    expect(scene, Scene, "scene")
    check_boxes_and_points(scene, "compare")
    own = DEFAULT_FRICTION["stepwise"] if scene.friction_coefficient is None else scene.friction_coefficient
    variants = [Variant("stepwise", own, run(scene, "stepwise"))]
    for friction in dict.fromkeys((0.0, own) if frictions is None else frictions):
        for metric in get_args(Metric):
            label = f"quasistatic, {METRICS[metric]}, friction {friction:.4g}"
            changed = scene.changed(friction_coefficient=friction, metric=metric)
            variants.append(Variant(label, friction, run(changed, "quasistatic")))
    partings = [parting_of(variants[0], variant) for variant in variants[1:]]
    return Comparison(tuple(variants), tuple(parting for parting in partings if parting is not None))


def parting_of(first: Variant, other: Variant) -> Parting | None:
    """Return where ``other`` leaves the way of ``first``; None: it ends every motion at the same pose."""
    for one, two in zip(first.run.phases, other.run.phases, strict=False):
        moves, others = _motions(one), _motions(two)
        for place in range(max(len(moves), len(others))):
            event = moves[place] if place < len(moves) else None
            rival = others[place] if place < len(others) else None
            if event is not None and rival is not None and same_pose(first.run.scene, event, rival):
                continue
            return Parting(
                other.label,
                two.name,
                None if rival is None else two.events.index(rival) + 1,
                None if event is None else one.events.index(event) + 1,
                f"{_says(first, one, event)}; {_says(other, two, rival)}",
            )
        if (one.verdict in AT_REST) != (two.verdict in AT_REST):
            return Parting(other.label, two.name, None, None, f"{_says(first, one, None)}; {_says(other, two, None)}")
    return None


def same_pose(scene: Scene, one: Event, two: Event) -> bool:
    """Whether two events end at one pose."""
    return _distance(scene, one.pose_world_object, two.pose_world_object) <= SAME_POSE_OF_SIZE * scene.size_m


def _distance(scene: Scene, one: Pose, two: Pose) -> float:
    held = scene.object
    around = held.center_of_gravity_m + held.reach_m * np.concatenate([np.eye(3), -np.eye(3)])
    return float(np.linalg.norm(one.transform(around) - two.transform(around), axis=1).max())


def _motions(phase: PhaseRun) -> list[Event]:
    """The motions that end somewhere: an escape is told by the verdict."""
    return [event for event in phase.events if event.motion is not None and isfinite(event.motion.distance_m)]


def _says(variant: Variant, phase: PhaseRun, event: Event | None) -> str:
    """What a variant does at an event, and on what ground; None: it has ended."""
    name = variant.run.method
    if event is None or event.motion is None:
        return f"{name} ends: {phase.verdict} ({_ground_of_end(phase)})"
    return f"{name} {_moves(event.motion)} ({mode_of(event.rule)}: {GROUNDS[event.rule]})"


def _ground_of_end(phase: PhaseRun) -> str:
    if phase.verdict != "stable":
        return ENDS.get(phase.verdict, phase.proof.reason)
    is_needle = phase.events[-1].note == "balanced"
    return "the load passes through its one contact" if is_needle else "no turn about two of its contacts is free"


def _moves(motion: Motion) -> str:
    """``turns about (0, 1, 0) by 19.23 deg``; lengths are left out, they would need the scene's unit."""
    if motion.axis_world is None:
        assert motion.direction_world is not None
        return f"travels along ({components(motion.direction_world)})"
    return (
        f"{'turns' if motion.kind == 'turn' else 'moves by a screw'} about ({components(motion.axis_world)})"
        f" by {np.degrees(motion.angle_rad):.4g} deg"
    )

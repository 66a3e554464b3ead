"""The same scene by several methods, metrics and coefficients of friction, and where the runs part."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import get_args

import numpy as np

from cagepose.nouns.pose import Pose
from cagepose.nouns.scene import Metric, Scene
from cagepose.runs.run import Event, PhaseRun, Run
from cagepose.runs.solve import run
from cagepose.runs.stepwise import NO_SLIP_ANGLE_DEFAULT_RAD

SAME_POSE_OF_SIZE = 1e-6
"""Two poses are one where no corner of the scene's size is farther apart than this fraction of it."""


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
        Number of the event in that phase, from 1, of the variant and of the first one; None: it ended before.
    reason
        What each of the two does there, and why.
    """

    label: str
    phase: str
    number: int | None
    first_number: int | None
    reason: str


@dataclass(frozen=True, eq=False)
class Comparison:
    """All variants, the first one being what the others are compared with, and where they part from it."""

    variants: tuple[Variant, ...]
    partings: tuple[Parting, ...]


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
        A coefficient below zero.
    """
    own = float(np.tan(NO_SLIP_ANGLE_DEFAULT_RAD)) if scene.friction_coefficient is None else scene.friction_coefficient
    variants = [Variant("stepwise", own, run(scene, "stepwise"))]
    for friction in dict.fromkeys((0.0, own) if frictions is None else frictions):
        for metric in get_args(Metric):
            label = f"quasistatic, {metric}, friction {friction:.4g}"
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
            if event is None and rival is None:
                continue
            return Parting(
                other.label,
                two.name,
                None if rival is None else two.events.index(rival) + 1,
                None if event is None else one.events.index(event) + 1,
                f"{_says(first, one, event)}; {_says(other, two, rival)}",
            )
    if len(first.run.phases) != len(other.run.phases):
        phase = first.run.scene.loads[min(len(first.run.phases), len(other.run.phases)) - 1].name
        return Parting(other.label, phase, None, None, f"{first.run.verdict} against {other.run.verdict}")
    return None


def same_pose(scene: Scene, one: Event, two: Event) -> bool:
    """Whether two events end at one pose."""
    return _distance(scene, one.pose_world_object, two.pose_world_object) <= SAME_POSE_OF_SIZE * scene.size_m


def _distance(scene: Scene, one: Pose, two: Pose) -> float:
    corners = np.concatenate([box.corners_object() for box in scene.object.boxes])
    return float(np.linalg.norm(one.transform(corners) - two.transform(corners), axis=1).max())


def _motions(phase: PhaseRun) -> list[Event]:
    return [event for event in phase.events if event.motion is not None]


def _says(variant: Variant, phase: PhaseRun, event: Event | None) -> str:
    """What a variant does at an event, and on what ground; None: it has ended."""
    name = variant.run.method
    if event is None:
        ground = phase.proof.reason if name == "quasistatic" else "no pair of contacts lets the load turn it"
        return f"{name} ends there: {phase.verdict} ({ground})"
    assert event.motion is not None
    ground = {
        "free": "no contact carries: it follows load and inertia",
        "slide": "the contacts that carry slide",
        "pivot": "friction makes a contact stick",
        "Slp-1": "the angles of the normals to the load say that it slips on one face",
        "Slp-2": "the angles of the normals to the load say that it slips on two faces",
    }.get(
        event.rule, "the rule turns it about contacts that stay where they are" if event.motion.kind == "turn" else ""
    )
    motion = f"{name} goes on with a {event.motion.kind} ({event.rule}"
    return f"{motion}: {ground})" if ground else f"{motion})"

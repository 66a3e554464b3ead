"""From what kernels write of a phase's end to its `Proof`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from cagepose.kernels.contact.metric import frame_at
from cagepose.kernels.outcome.records import Outcome
from cagepose.kernels.outcome.trace import MOTION_NAMES, NONE, TRAVEL
from cagepose.kernels.stability.proof import (
    OTHER_ONSET,
    PROVEN_MOVES,
    PROVEN_UNIQUE,
    PROVEN_WITHOUT_FRICTION,
    TOO_MANY_CHOICES,
    TOO_MANY_CONTACTS,
)
from cagepose.kernels.stability.second_order import STABILITY_NAMES
from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.actions import load_size
from cagepose.runs.cases import body_of
from cagepose.runs.proof import FreeMotion, Proof
from cagepose.runs.tolerances import SINE_TO_SPAN

REASONS = {
    PROVEN_WITHOUT_FRICTION: "the contacts balance the load without friction",
    PROVEN_UNIQUE: "the contacts balance the load with friction, and every other contact mode is ruled out",
    OTHER_ONSET: "the contacts can balance the load with friction, but Coulomb's law allows this motion too",
    PROVEN_MOVES: "no contact forces balance the load",
    TOO_MANY_CHOICES: "the contacts can balance the load with some faces at edges; too many to check all",
    TOO_MANY_CONTACTS: "too many faces touch at one place for a proof",
}
UNTOUCHED = "nothing touches, and the loads balance each other"
NOT_SHOWN = "the contacts can balance the load with friction, but that the object cannot move was not shown"
WEDGED = "; the contacts can press against each other without a load, as in a wedge"
STOPPED = "; the rest of the load is held by contacts without play, to second order, by forces of unlimited size"
CHAINED = "; contacts without play hold each other in turn: the slightest play frees it"
CLAMPED = "; it seems to depend on contacts that no load keeps closed: opening one of them for a moment may free it"
IN_PLANE = "; only motions in the plane {} are asked about"
HELD_BY_NO_FORCES = (PROVEN_MOVES, TOO_MANY_CONTACTS)
NUMBERS = [
    *("proof", "stability", "residual", "wedged", "is_second_order", "is_chained", "is_clamped"),
    *("n_contacts", "n_undetermined"),
]
"""Fields of a phase's record that are one number."""
ONES = np.ones(3)


def read_proofs(outcome: Outcome, scene: Scene, ends: Sequence[Pose], shared: Sequence[Sequence[str]]) -> list[Proof]:
    """Return the proof of each phase's end, given the poses there and the names of contacts that share forces."""
    phases: Any = outcome.phases
    columns = zip(
        phases[NUMBERS].tolist(),
        phases["undetermined"],
        _free_motions(phases),
        ends,
        _sizes(outcome, scene, ends),
        shared,
        strict=True,
    )
    found, first = list[Proof](), 0
    for numbers, undetermined, motion, end, (gap_work, largest_force), names in columns:
        code, stability, residual, wedged, second, chained, clamped, last, n_undetermined = numbers
        held = code not in HELD_BY_NO_FORCES
        is_open = held and code not in (PROVEN_WITHOUT_FRICTION, PROVEN_UNIQUE)
        found.append(
            Proof(
                verdict="moves" if not held else "may rest" if is_open else "rests",
                reason=(REASONS.get(code, NOT_SHOWN) if last > first or not held else UNTOUCHED)
                + (WEDGED if is_open and wedged else "")
                + (STOPPED if held and second else "")
                + (CHAINED if held and chained else "")
                + (CLAMPED if held and clamped else "")
                + ("" if scene.planar is None else IN_PLANE.format(scene.planar)),
                residual=residual,
                needs_friction=held and code != PROVEN_WITHOUT_FRICTION,
                stability=STABILITY_NAMES[stability] if held else None,
                undetermined=_freedoms(scene, end, undetermined[:n_undetermined]) if held and n_undetermined else (),
                shared=tuple(names) if held else (),
                motion=motion,
                gap_work=gap_work if held else None,
                largest_force=largest_force if held else None,
            )
        )
        first = last
    return found


def _sizes(outcome: Outcome, scene: Scene, ends: Sequence[Pose]) -> Iterator[tuple[float, float]]:
    """Yield `Proof.gap_work` and `Proof.largest_force` of each phase's end."""
    phases: Any = outcome.phases
    contacts: Any = outcome.contacts
    normal, across = contacts["force_normal"], contacts["force_tangential"]
    works = (normal * contacts["gap"]).tolist()
    squares = (normal * normal + (across * across) @ ONES).tolist()
    first = 0
    for last, load_n in zip(phases["n_contacts"].tolist(), _load_sizes(scene, outcome, ends), strict=False):
        largest = max(squares[first:last], default=0.0)
        size = load_n or 1.0  # springs that pull on nothing any more, and no forces
        yield sum(works[first:last]) / (size * scene.size_m), largest**0.5 / size
        first = last


_LOAD_SIZES: WeakKeyDictionary[Scene, list[float]] = WeakKeyDictionary()
"""A scene never changes: without springs its loads are of one size wherever the object is."""


def _load_sizes(scene: Scene, outcome: Outcome, ends: Sequence[Pose]) -> list[float]:
    """Return the size of the load at the end of each phase."""
    if scene in _LOAD_SIZES:
        return _LOAD_SIZES[scene]
    sizes = [load_size(scene, phase, end, outcome.displaced[phase]) for phase, end in enumerate(ends)]
    if len(ends) == len(scene.loads) and not any(load.springs for load in scene.loads):
        _LOAD_SIZES[scene] = sizes
    return sizes


def _free_motions(phases: Any) -> Iterator[FreeMotion | None]:
    columns = zip(phases["motion"].tolist(), phases["along"], phases["through"], phases["pitch"].tolist(), strict=True)
    for code, along, through, pitch in columns:
        is_travel = code == TRAVEL
        yield (
            None
            if code == NONE
            else FreeMotion(
                MOTION_NAMES[code],
                along if is_travel else None,
                None if is_travel else along,
                None if is_travel else through,
                pitch,
            )
        )


def _freedoms(scene: Scene, pose: Pose, undetermined: FloatArray) -> tuple[str, ...]:
    """Name the freedoms, in the cage's frame, that a set of scaled twists (5.3) holds."""
    frame = frame_at(body_of(scene), pose.as_tuples()[1])
    to_cage = scene.cage.pose_world_cage.rotation.T
    spins = (undetermined[:, 3:] / np.array(frame.radii)) @ np.array(frame.axes)
    rows = np.hstack([undetermined[:, :3] @ to_cage.T, frame.extent_m * spins @ to_cage.T])
    basis = np.linalg.svd(rows, full_matrices=False)[2]
    found = [name for k, name in enumerate(("x", "y", "z")) if _is_in_span(basis, np.eye(6)[k])]
    turning = np.linalg.svd(basis[:, 3:], full_matrices=False)
    turns = turning[2][turning[1] > SINE_TO_SPAN]
    found += [name for k, name in enumerate(("roll", "pitch", "yaw")) if _is_in_span(turns, np.eye(3)[k])]
    return tuple(found) if len(found) >= len(rows) else (*found, "and others" if found else "others")


def _is_in_span(basis: FloatArray, vector: FloatArray) -> bool:
    return bool(np.linalg.norm(vector - basis.T @ (basis @ vector)) < SINE_TO_SPAN) if len(basis) else False

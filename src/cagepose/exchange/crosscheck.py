"""A run beside MuJoCo: do the two end at the same poses, and where not, what each says of the other's: `crosscheck`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cagepose.errors import Problem, SceneError
from cagepose.exchange.mujoco_run import WINDOW_LIMIT, MujocoRest, MujocoScene
from cagepose.exchange.solids import Assembly, assembly_of
from cagepose.model.cage import Cage
from cagepose.model.checks import FloatArray
from cagepose.model.load import Load
from cagepose.model.parts import Object
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.model.surface import shape_mesh
from cagepose.model.tolerances import TOUCH_GREATEST, Tolerances
from cagepose.model.wording import few
from cagepose.runs.methods import chosen_method
from cagepose.runs.run import AT_REST, PhaseRun, Run
from cagepose.runs.solve import run

ALLOWED_DISTANCE = 20.0
"""Poses agree if no point is farther apart than so many times MuJoCo's penetration and the exported shapes' error: what
contacts give near each other, a long part shows many times as large at its end."""
CHORDS_OF_CIRCLE = 16
"""Chords of the circles on which points of round parts are looked at."""


@dataclass(frozen=True, eq=False)
class PhaseCheck:
    """One phase in both programs.

    Attributes
    ----------
    phase
        As cagepose ran it.
    mujoco
        As MuJoCo ended it, from where it had ended the phase before; from cagepose's pose if the two had parted there.
    distance_m
        How far the object's points are apart at most, metres.
    angle_rad
        By which angle its poses are turned against each other, radians.
    allowed_m
        Up to which distance they agree.
    leaves_theirs_m, leaves_ours_m
        How far cagepose goes if it is started at MuJoCo's pose, and MuJoCo at cagepose's; within `allowed_m`, it stays.
        None: not asked, as they agree; or MuJoCo has no rest, or one that cannot be a start, too deep in the cage.
    reasons
        Why they part, in sentences.
    """

    phase: PhaseRun
    mujoco: MujocoRest
    distance_m: float
    angle_rad: float
    allowed_m: float
    leaves_theirs_m: float | None
    leaves_ours_m: float | None
    reasons: tuple[str, ...]

    @property
    def agrees(self) -> bool:
        """Whether the two end at one pose."""
        return not self.reasons


@dataclass(frozen=True, eq=False)
class Crosscheck:
    """All phases of a run in both programs, and what the exported model does not hold as the scene does."""

    run: Run
    phases: tuple[PhaseCheck, ...]
    notes: tuple[str, ...]

    @property
    def agrees(self) -> bool:
        """Whether all phases end at one pose."""
        return all(phase.agrees for phase in self.phases)


def crosscheck(done: Run) -> Crosscheck:
    """Bring the scene of a run to rest in MuJoCo, and compare.

    Raises
    ------
    SceneError
        MuJoCo's format cannot hold a part of the scene, or a load drives a body of the cage or lets one press; which is
        named.
    MissingExtraError
        There is no MuJoCo.
    CageposeError
        MuJoCo's pose is no longer a number, or it had no room for all contacts.
    """
    _expect_still(done.scene)
    assembly = assembly_of(done.scene)
    points = surface_points(done.scene.object)
    mujoco = MujocoScene(assembly, points)
    found: list[PhaseCheck] = []
    start = done.scene.object.pose_world_object
    for index, phase in enumerate(done.phases):
        found.append(_checked(done, index, mujoco, assembly, points, start))
        start = found[-1].mujoco.pose if found[-1].agrees else phase.pose
    return Crosscheck(done, tuple(found), assembly.notes)


def _expect_still(scene: Scene) -> None:
    problems = [
        Problem(
            ("loads", index, key),
            f"{load.name!r} {verb} a body, and MuJoCo is asked where all of the cage stands still; leave the load out",
        )
        for index, load in enumerate(scene.loads)
        for key, verb, bodies in (("drive", "drives", load.drive), ("press", "presses with", load.press))
        if bodies
    ]
    if problems:
        raise SceneError(problems)


def surface_points(held: Object) -> FloatArray:
    """Return points of the object that tell how far a pose is from another, (n, 3), in its frame, metres."""
    return np.concatenate([shape_mesh(part, CHORDS_OF_CIRCLE).vertices_m for part in held.parts])


def _checked(
    done: Run, index: int, mujoco: MujocoScene, assembly: Assembly, points: FloatArray, start: Pose
) -> PhaseCheck:
    phase, scene = done.phases[index], done.scene
    there = mujoco.settle(index, start)
    distance_m = apart_m(points, there.pose, phase.pose)
    angle_rad = _angle(there.pose, phase.pose)
    allowed_m = ALLOWED_DISTANCE * (there.penetration_m + assembly.error_m)
    escapes = phase.verdict == "escapes" and not there.settled.is_quiet and distance_m > scene.size_m
    if escapes or (phase.verdict in AT_REST and there.settled.is_quiet and distance_m <= allowed_m):
        return PhaseCheck(phase, there, distance_m, angle_rad, allowed_m, None, None, ())
    theirs_m = ours_m = None
    if phase.verdict in AT_REST:
        ours_m = apart_m(points, mujoco.settle(index, phase.pose).pose, phase.pose)
        if there.settled.is_quiet:
            theirs_m = _left(done, index, there, points)
    reasons = (
        *_of_ends(phase, there, scene),
        *_of_starts(theirs_m, ours_m, allowed_m, scene.size_m),
        *_of_export(phase, assembly),
        *_of_proof(done, phase),
    )
    return PhaseCheck(phase, there, distance_m, angle_rad, allowed_m, theirs_m, ours_m, reasons)


def _left(done: Run, index: int, there: MujocoRest, points: FloatArray) -> float | None:
    """Return how far cagepose goes under the load of a phase from where MuJoCo ended it; None: it cannot start there.

    Touching counts from as deep as MuJoCo's contacts are.
    """
    scene, held = done.scene, done.scene.object
    touch = max(scene.tolerances.touch, 2.0 * there.penetration_m / scene.size_m)
    try:
        again = scene.but_for(
            object=held.starting_at(there.pose),
            loads=[_from(scene.cage, scene.loads[index], held.pose_world_object, there.pose)],
            method=None,
            tolerances=Tolerances(min(touch, TOUCH_GREATEST), scene.tolerances.grazing_band_rad),
        )
    except SceneError:
        return None
    ended = run(again, done.method)
    return None if ended.failed else apart_m(points, ended.pose, there.pose)


def _from(cage: Cage, load: Load, start: Pose, other: Pose) -> Load:
    """Return a load for another start: a spring's preload is its tension at the start."""
    springs = [
        spring.starting_longer(cage.spring_length_m(spring, other) - cage.spring_length_m(spring, start))
        for spring in load.springs
    ]
    return Load(
        load.name,
        gravity=load.gravity_world,
        force=load.force,
        forces=load.forces,
        moments=load.moments,
        springs=springs,
    )


def apart_m(points: FloatArray, one: Pose, other: Pose) -> float:
    """Return how far points of an object, (n, 3), are from where they are at another pose, at most."""
    return float(np.linalg.norm(one.transform(points) - other.transform(points), axis=1).max())


def _angle(one: Pose, other: Pose) -> float:
    product = (one.inverse() @ other).quaternion_wxyz
    return 2.0 * float(np.arctan2(np.linalg.norm(product[1:]), product[0]))


def _of_ends(phase: PhaseRun, there: MujocoRest, scene: Scene) -> list[str]:
    found = []
    if phase.verdict not in AT_REST:
        found.append(f"cagepose ends without a rest: {phase.verdict}")
    if not there.settled.is_quiet:
        still = f"{there.settled.moved / scene.size_m:.1g} of the scene's size in each window"
        found.append(f"MuJoCo is not at rest after {WINDOW_LIMIT} windows of time steps: it still moves by {still}")
    return found


def _of_starts(theirs_m: float | None, ours_m: float | None, allowed_m: float, size_m: float) -> list[str]:
    if theirs_m is not None and ours_m is not None and max(theirs_m, ours_m) <= allowed_m:
        return ["both poses are rests: each program stays where the other one ended, so the end depends on the path"]
    found = []
    for program, pose, left_m in (("cagepose", "MuJoCo", theirs_m), ("MuJoCo", "cagepose", ours_m)):
        if left_m is not None:
            goes = "stays there" if left_m <= allowed_m else f"moves away by {left_m / size_m:.1g} of the scene's size"
            found.append(f"{program}, started at {pose}'s pose, {goes}")
    return found


def _of_export(phase: PhaseRun, assembly: Assembly) -> list[str]:
    """Name holes that were touched and have another friction in MuJoCo."""
    touched = {name for event in phase.events for name in event.contacts}
    touched |= {name for contact in phase.contacts for name in (contact.point, contact.box)}
    return [
        f"{hole} has a friction of its own, {assembly.scene.friction_of[hole]:.4g}, and that of {few(parts)} in MuJoCo"
        for hole, parts in assembly.frictions_of_parts.items()
        if hole in touched
    ]


def _of_proof(done: Run, phase: PhaseRun) -> list[str]:
    proof = phase.proof
    found = []
    if phase.verdict == "stable" and proof.verdict == "moves":
        found.append(f"the paper's rules end here, but by the mechanics it moves: {proof.reason}")
    if proof.verdict == "may rest":
        found.append("cagepose proves only that it may rest: a motion can begin there as well")
    if proof.stability in ("marginal", "unstable"):
        found.append(f"the rest is {proof.stability}: a small disturbance may end it")
    if proof.undetermined:
        found.append(f"the load does not determine {', '.join(proof.undetermined)}: a whole range of poses is at rest")
    if proof.verdict != "moves" and proof.needs_friction:
        friction = chosen_method(done.scene, done.method).friction(done.scene)
        of_all = "" if done.scene.friction_of else f" (coefficient {friction:.4g})"
        found.append(f"friction holds it{of_all}: a whole range of poses is at rest")
    return found

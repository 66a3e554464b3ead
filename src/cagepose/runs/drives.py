"""How the bodies of a cage are driven, and how they press, as kernels take it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple, cast

import numpy as np

from cagepose.kernels.algebra.least_squares import WRENCH
from cagepose.kernels.algebra.record import Rows, dtype_of
from cagepose.kernels.driven.bodies import BEFORE_LEG_ENDS
from cagepose.kernels.outcome.drives import Drives, Leg, Press
from cagepose.model.checks import FloatArray
from cagepose.model.drive import Drive
from cagepose.model.load import Load
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.actions import body_numbers
from cagepose.runs.run import PhaseRun, Run
from cagepose.runs.tolerances import TENSION_AT_ZERO


def drives_of(scene: Scene, moved: Mapping[str, Pose] | None = None) -> Drives:
    """Return the drives of all phases; the first body is what stands still. ``moved``: by name, how the whole ways of
    bodies are moved, in the cage's frame, from where the scene has them.
    """
    ways = {} if moved is None else moved
    bodies, loads = scene.cage.bodies, scene.loads
    most = max((len(legs) for load in loads for legs in load.drive.values()), default=0)
    legs = np.zeros((len(loads), 1 + len(bodies), max(most, 1)), dtype_of(Leg))
    n_legs = np.zeros((len(loads), 1 + len(bodies)), np.int64)
    stop_at = np.array([np.inf if load.stop_at is None else load.stop_at for load in loads])
    for phase, load in enumerate(loads):
        for body, of_body in enumerate(bodies, start=1):
            driven = load.drive.get(of_body.name, ())
            if of_body.name in ways:
                driven = tuple(leg.moved(ways[of_body.name]) for leg in driven)
            n_legs[phase, body] = len(driven)
            for place, drive in enumerate(driven):
                leg = legs[phase, body, place : place + 1]
                spin = np.zeros(3) if drive.about_cage is None else (drive.angle_rad or 0.0) * drive.about_cage
                travel = np.zeros(3) if drive.travel_m is None else drive.travel_m
                through = np.zeros(3) if drive.through_cage_m is None else drive.through_cage_m
                leg["velocity"], leg["spin"] = travel - np.cross(spin, through), spin
                leg["length"] = np.linalg.norm(travel) or np.linalg.norm(spin)
    return Drives(cast(Rows[Rows[Rows[Leg]]], legs), n_legs, stop_at, _presses_of(scene))


def _presses_of(scene: Scene) -> Rows[Rows[Press]]:
    """Return how bodies press in all phases, (n_phases, n_bodies)."""
    found = np.zeros((len(scene.loads), 1 + len(scene.cage.bodies)), dtype_of(Press))
    for phase, load in enumerate(scene.loads):
        for body, of_body in enumerate(scene.cage.bodies, start=1):
            press = load.press.get(of_body.name)
            if press is not None:
                one = found[phase, body : body + 1]
                one["freedom"] = WRENCH + list(load.press).index(of_body.name)
                one["direction"], one["origin"] = press.along_cage, of_body.pose_cage_body.position_m
                one["force"], one["stiffness"] = press.force_n, press.stiffness_n_per_m
    return cast(Rows[Rows[Press]], found)


def no_drives(scene: Scene) -> Drives:
    """Return the drives of one phase in which all bodies of the cage stand still."""
    n_bodies = 1 + len(scene.cage.bodies)
    legs = np.zeros((1, n_bodies, 1), dtype_of(Leg))
    no_press = cast(Rows[Rows[Press]], np.zeros((1, n_bodies), dtype_of(Press)))
    return Drives(cast(Rows[Rows[Rows[Leg]]], legs), np.zeros((1, n_bodies), np.int64), np.array([np.inf]), no_press)


def way_of(drives: Sequence[Drive], share: float) -> tuple[float, float]:
    """Return how far a body has got after a share of its legs: all travels, metres, and all turns, radians."""
    amounts = np.clip(share * len(drives) - np.arange(len(drives)), 0.0, 1.0)
    travels = [0.0 if leg.travel_m is None else float(np.linalg.norm(leg.travel_m)) for leg in drives]
    return float(amounts @ travels), float(amounts @ [leg.angle_rad or 0.0 for leg in drives])


def turns_alone(load: Load, share: float) -> bool:
    """Whether all bodies that a phase drives turn alone as they get to a share of it, so that moments drive them, and
    what is along their ways is newton metres for a radian.
    """
    last = [max(math.ceil(share * len(legs) - BEFORE_LEG_ENDS) - 1, 0) for legs in load.drive.values()]
    return all(legs[which].is_turn for legs, which in zip(load.drive.values(), last, strict=True))


def displaced_by(drives: Sequence[Drive], share: float) -> Pose:
    """Return how a body is displaced, in the cage's frame, after a share of its legs."""
    found = Pose()
    for which, leg in enumerate(drives):
        amount = min(max(share * len(drives) - which, 0.0), 1.0)
        travel = np.zeros(3) if leg.travel_m is None else amount * leg.travel_m
        step = Pose(travel)
        if leg.about_cage is not None and leg.through_cage_m is not None and leg.angle_rad is not None:
            half = 0.5 * amount * leg.angle_rad
            turn = Pose((0, 0, 0), np.array([math.cos(half), *(math.sin(half) * leg.about_cage)]))
            step = Pose(travel + leg.through_cage_m - turn.transform(leg.through_cage_m), turn.quaternion_wxyz)
        found = step @ found
    return found


class PhaseWay(NamedTuple):
    """How far bodies have got in a phase: the share of its drive, and of each body that presses how far it has gone."""

    share: float
    pressed: Mapping[str, float]


def way_in(phase: PhaseRun, share: float | None = None) -> PhaseWay:
    """Return how far bodies have got after a share of a phase of a run; left out: at its end."""
    if share is None:
        share = 1.0 if phase.drive is None else phase.drive.share
    pressed = {} if phase.press is None else phase.press.ways_at(share)
    return PhaseWay(0.0 if phase.drive is None else share, pressed)


def displaced_bodies(scene: Scene, ways: Sequence[PhaseWay]) -> dict[str, Pose]:
    """Return how each body of the cage is displaced from its start, in the cage's frame, after the first phases of a
    scene, in each of which it has got so far.
    """
    found = {body.name: Pose() for body in scene.cage.bodies}
    for load, way in zip(scene.loads, ways, strict=False):
        for name, legs in load.drive.items():
            found[name] = displaced_by(legs, way.share) @ found[name]
        for name, gone in way.pressed.items():
            found[name] = Pose(gone * load.press[name].along_cage) @ found[name]
    return found


def displaced_at(scene: Scene, ways: Sequence[PhaseWay]) -> FloatArray:
    """Return how the bodies of a cage are displaced after the first phases, as `displaced_bodies`, in the form of
    `at_start`.
    """
    moved, found = displaced_bodies(scene, ways), at_start(scene)
    for row, body in enumerate(scene.cage.bodies, start=1):
        found[row] = *moved[body.name].position_m, *moved[body.name].quaternion_wxyz
    return found


def displaced_after(run: Run, phase: int) -> FloatArray:
    """Return how the bodies of a cage are displaced at the end of a phase of a run, counted from 0, as `at_start`."""
    return displaced_at(run.scene, [way_in(ended) for ended in run.phases[: phase + 1]])


def pressing_forces(scene: Scene, phase: int, displaced: FloatArray) -> dict[str, float]:
    """Return how hard each body presses in a phase where the bodies are displaced, as in `at_start`; newtons."""
    found, rows = dict[str, float](), body_numbers(scene)
    for name, press in scene.loads[phase].press.items():
        row = rows[name]
        origin = scene.cage.bodies[row - 1].pose_cage_body.position_m
        way = Pose(displaced[row, :3], displaced[row, 3:]).transform(origin) - origin
        less = press.stiffness_n_per_m * float(press.along_cage @ way)
        is_slack = abs(press.force_n - less) <= TENSION_AT_ZERO * (abs(press.force_n) + abs(less))
        found[name] = 0.0 if is_slack else press.force_n - less
    return found


def points_displaced(scene: Scene, displaced: FloatArray) -> FloatArray:
    """Return where the cage's points are in the world, (n, 3), metres, its bodies being displaced as in `at_start`."""
    points, bodies = scene.cage.points_cage.copy(), np.array(scene.cage.element_bodies[: len(scene.cage.names)])
    for body in range(1, len(displaced)):
        of_body = bodies == body
        points[of_body] = Pose(displaced[body, :3], displaced[body, 3:]).transform(points[of_body])
    return scene.cage.pose_world_cage.transform(points)


def at_start(scene: Scene) -> FloatArray:
    """Return how the bodies of a cage are displaced at the start, position and quaternion in its frame, (n_bodies, 7),
    metres, the first being what stands still: not at all.
    """
    return np.tile([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0], (1 + len(scene.cage.bodies), 1))


def bodies_off(scene: Scene, phase: PhaseRun, load: Load) -> list[str]:
    """Return the bodies that press beside a drive and came off the object, with nothing ahead of them, by name: there
    the drive has ended, though nothing is said of the object.
    """
    if phase.verdict != "escapes" or phase.drive is None or not load.press:
        return []
    bodies = [None, *(body.name for body in scene.cage.bodies)]
    names = dict(zip(scene.cage.element_names, scene.cage.element_bodies, strict=True))
    touching = {bodies[names[contact.point]] for contact in phase.contacts}
    return [name for name in load.press if name not in touching]

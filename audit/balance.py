"""Do contact forces balance the load? By linear programs (HiGHS) with pyramids inside and around the friction cones.

Moments are taken about the middle of the contacts, over the object's diameter; the load is as large as the greater of
its force and its moment there, so that a load on a long lever is weighed as its contacts feel it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.optimize import linprog

from audit.case import Answer, FloatArray, is_held_by_forces
from audit.geometry import (
    Acting,
    Touch,
    acting,
    acting_at,
    are_one,
    choices,
    corners,
    friction_of,
    load_of,
    load_size,
    tangents,
    touches,
    touches_are_clear,
)
from audit.goes_on import COULD_STAY
from cagepose import Contact, PhaseRun, Pose, Run, Scene

AT_REST = ("rests", "may rest")
N_SIDES = 64
"""A pyramid has so many sides: it differs from the round cone by 0.12 % of the friction."""
FEW_SIDES = 12
"""The pyramid that is asked first has so many sides. What it says settles most cases, at a fifth of the price."""
MOST_FORCE = 1e6
"""In loads, for one contact. A real part is flexible: a wedge that multiplies the load a million times yields."""
REST = 1e-8
"""What may be left of the load at a rest, in loads."""
EXACT = 1e-13
"""What may be left where this oracle says that a pose is balanced: rounding."""
FALL = 1e-11
"""How far the load may still fall at a rest, in sizes, by duality: forces times gaps. Rounding is below a tenth of it;
a gap within the touch tolerance that was not closed is far above.
"""
CLOSED = 1e-13
"""Gap of a contact, in sizes, that is surely closed."""
MOST_CHOICES = 12
MOST_STARTS = 3


def balance(run: Run) -> Answer:
    """A rest is balanced at every choice of faces, by forces below `MOST_FORCE`."""
    found, asked = [], False
    for phase in run.phases:
        if phase.verdict in AT_REST and is_held_by_forces(phase) and touches_are_clear(run.scene, phase.pose):
            asked = True
            acts = acting(run.scene, load_of(run.scene, phase.name))
            for chosen in choices(touches(run.scene, phase.pose), MOST_CHOICES, np.random.default_rng(0))[0]:
                left = least_imbalance(run.scene, phase.pose, chosen, acts, outside=False, n_sides=FEW_SIDES)
                if left > REST:
                    left = least_imbalance(run.scene, phase.pose, chosen, acts, outside=True)
                if left > REST:
                    found.append(f"{phase.name}: {phase.verdict}, but at least {left:.1e} loads are left unbalanced")
                    break
    return found if asked else None


def unbalance(run: Run) -> Answer:
    """Where the run says that the part moves, no forces of the contacts that are surely closed balance the load. Events
    say where friction could hold it all the same: `goes_on` asks about them.
    """
    found, asked = [], False
    for phase in run.phases:
        acts = acting(run.scene, load_of(run.scene, phase.name))
        starts = [phase.start_pose, *(event.pose_world_object for event in phase.events)]
        moving = [
            start
            for start, event in zip(starts, phase.events, strict=False)
            if event.motion is not None and event.note != COULD_STAY
        ]
        if phase.proof.verdict == "moves":
            moving.append(phase.pose)
        for pose in moving[-MOST_STARTS:]:
            closed = _surely_closed(run.scene, pose)
            chosen, is_all = choices(closed, MOST_CHOICES, np.random.default_rng(0))
            if not closed or not is_all:
                continue
            asked = True
            if all(_is_balanced(run.scene, pose, one, acts) for one in chosen):
                found.append(f"{phase.name}: moves from a pose at which the contacts balance the load")
    return found if asked else None


def forces(run: Run) -> Answer:
    """The reported forces lie in their cones, balance the load, are not absurd, and have no gap to fall through."""
    found, asked = [], False
    for phase in run.phases:
        if phase.verdict in AT_REST and is_held_by_forces(phase):
            asked = True
            found += [f"{phase.name}: {text}" for text in _wrong_forces(run.scene, phase)]
    return found if asked else None


def contacts(run: Run) -> Answer:
    """The contacts at the end of each phase are those of (2.7); of those at one place with one normal one is told."""
    found, asked = [], False
    names, boxes = run.scene.cage.names, [box.name for box in run.scene.object.boxes]
    for phase in run.phases:
        if touches_are_clear(run.scene, phase.pose):
            asked = True
            expected = touches(run.scene, phase.pose)
            told = [(names.index(contact.point), boxes.index(contact.box)) for contact in phase.contacts]
            needless = set(told) - {(touch.point, touch.box) for touch in expected}
            chosen = [touch for touch in expected if (touch.point, touch.box) in told]
            missing = [t for t in expected if not any(are_one(t, other, run.scene.touch_m) for other in chosen)]
            if needless or missing:
                found.append(f"{phase.name}: contacts {told}, of which {needless} are none, and {missing} are missing")
    return found if asked else None


def _surely_closed(scene: Scene, pose: Pose) -> list[Touch]:
    """The contacts of points whose gap to every face of the box that they touch is rounding."""
    found = touches(scene, pose)
    ajar = {(t.point, t.box) for t in found if abs(t.gap) > CLOSED * scene.size_m}
    return [t for t in found if (t.point, t.box) not in ajar]


def _is_balanced(scene: Scene, pose: Pose, chosen: Sequence[Touch], acts: Sequence[Acting]) -> bool:
    if least_imbalance(scene, pose, chosen, acts, outside=True, n_sides=FEW_SIDES) > EXACT:
        return False
    return least_imbalance(scene, pose, chosen, acts, outside=False) <= EXACT


def least_imbalance(
    scene: Scene,
    pose: Pose,
    chosen: Sequence[Touch],
    acts: Sequence[Acting],
    *,
    outside: bool,
    n_sides: int = N_SIDES,
) -> float:
    """What forces in the pyramids inside or around the cones leave of the load at least, in loads."""
    frame = _Frame(scene, pose, np.array([touch.place for touch in chosen]), acts)
    if not chosen:
        return 1.0
    columns = np.vstack([_edges(frame, touch, friction_of(scene, touch), n_sides, outside) for touch in chosen]).T
    n_columns, b = columns.shape[1], -frame.load
    slack = np.hstack([np.eye(6), -np.eye(6)])
    answer = linprog(
        np.concatenate([np.zeros(n_columns), np.ones(12)]),
        A_eq=np.hstack([columns, slack]),
        b_eq=b,
        bounds=[(0.0, MOST_FORCE)] * n_columns + [(0.0, None)] * 12,
        method="highs-ds",
        options={"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10},
    )
    if answer.x is None:
        return 1.0
    carried = answer.x[:n_columns].clip(0.0)
    left = float(np.abs(columns @ carried - b).max())
    used = np.flatnonzero(carried > 1e-12)
    polished = np.linalg.lstsq(columns[:, used], b, rcond=None)[0]
    if len(used) and (polished >= 0.0).all() and polished.max() <= MOST_FORCE:
        left = min(left, float(np.abs(columns[:, used] @ polished - b).max()))
    return left


class _Frame:
    """Where wrenches are taken, and the load there: of magnitude 1."""

    def __init__(
        self,
        scene: Scene,
        pose: Pose,
        places: FloatArray,
        acts: Sequence[Acting],
        couple: FloatArray | None = None,
        *,
        of_all: bool = False,
        pressed: float = 0.0,
    ) -> None:
        """With ``of_all`` the load is as large as all that acts, which may balance without contacts; and it is no
        smaller than what bodies press with.
        """
        points = corners(scene, pose) if scene.object.boxes else pose.position_m[None]
        reach = float(np.linalg.norm(points - points.mean(axis=0), axis=1).max())
        self.length = 2.0 * reach if scene.object.boxes else scene.size_m
        self.middle = places.mean(axis=0) if len(places) else points.mean(axis=0)
        total = np.sum([self.wrench(act.force, pose.transform(act.at_object)) for act in acts], axis=0)
        size = load_size(acts)
        if couple is not None:
            total = total + np.concatenate([np.zeros(3), couple / self.length])
            size += float(np.linalg.norm(couple)) / self.length
        force, moment = float(np.linalg.norm(total[:3])), float(np.linalg.norm(total[3:]))
        self.magnitude = max(force, moment, size if of_all else 1e-9 * size, pressed)
        self.load = total / self.magnitude

    def wrench(self, force: FloatArray, at: FloatArray) -> FloatArray:
        return np.concatenate([force, np.cross(at - self.middle, force) / self.length])


def _edges(frame: _Frame, touch: Touch, mu: float, n_sides: int, outside: bool) -> FloatArray:
    """Wrenches of the edges of a pyramid with normal force 1, (edges, 6)."""
    if mu == 0.0:
        return frame.wrench(-touch.normal, touch.place)[None]
    angles = 2 * np.pi * np.arange(n_sides) / n_sides
    reach = mu / np.cos(np.pi / n_sides) if outside else mu
    rays = -touch.normal + reach * np.column_stack([np.cos(angles), np.sin(angles)]) @ tangents(touch.normal)
    return np.array([frame.wrench(ray, touch.place) for ray in rays])


def imbalance(scene: Scene, phase: PhaseRun) -> float:
    """What the reported forces leave of the load of a phase, and of what bodies press with, in loads; all of its
    contacts have forces.
    """
    frame, places = _frame_of(scene, phase)
    net, left = frame.load.copy(), _presses(scene, phase) / frame.magnitude
    bodies = dict(zip(scene.cage.element_names, scene.cage.element_bodies, strict=True))
    presses, turned = load_of(scene, phase.name).press, scene.cage.pose_world_cage.rotation
    ways = [turned @ press.along_cage for press in presses.values()]
    numbers = [[body.name for body in scene.cage.bodies].index(name) + 1 for name in presses]
    for contact, place in zip(phase.contacts, places, strict=True):
        assert contact.force_normal_n is not None
        assert contact.force_tangential_n is not None
        force = contact.force_tangential_n - contact.force_normal_n * contact.normal_world
        net += frame.wrench(force / frame.magnitude, place)
        for which, (number, way) in enumerate(zip(numbers, ways, strict=True)):
            left[which] -= float(force @ way) / frame.magnitude if bodies[contact.point] == number else 0.0
    return float(max(np.linalg.norm(net[:3]), np.linalg.norm(net[3:]), np.abs(left).max(initial=0.0)))


def _presses(scene: Scene, phase: PhaseRun) -> FloatArray:
    """What bodies press with at the end of a phase, newtons, in the order of the load."""
    found = []
    for name, press in load_of(scene, phase.name).press.items():
        body = next(body for body in scene.cage.bodies if body.name == name)
        assert phase.press is not None
        way = phase.press.bodies[name].pose_cage_body.position_m - body.pose_cage_body.position_m
        found.append(press.force_n - press.stiffness_n_per_m * float(way @ press.along_cage))
    return np.array(found)


def _frame_of(scene: Scene, phase: PhaseRun) -> tuple[_Frame, FloatArray]:
    """The frame of a phase's contacts, and their places, of points where these are."""
    load = load_of(scene, phase.name)
    driven = {} if phase.drive is None else {name: body.pose_cage_body for name, body in phase.drive.bodies.items()}
    acts, couple = acting_at(scene, load, phase.pose, driven)
    world = dict(zip(scene.cage.names, scene.cage.points_world(), strict=True))
    places = np.array([world.get(contact.point, contact.place_world) for contact in phase.contacts])
    pressed = float(_presses(scene, phase).max(initial=0.0))
    return _Frame(scene, phase.pose, places, acts, couple, of_all=load.needs_newtons, pressed=pressed), places


def _wrong_forces(scene: Scene, phase: PhaseRun) -> list[str]:
    frame, _ = _frame_of(scene, phase)
    largest, fall = 0.0, 0.0
    found = []
    for contact in phase.contacts:
        if contact.force_normal_n is None or contact.force_tangential_n is None:
            return [f"{phase.verdict} without the force of {contact.point}"]
        normal_n, tangential = contact.force_normal_n / frame.magnitude, contact.force_tangential_n / frame.magnitude
        largest = max(largest, normal_n)
        fall += normal_n * abs(contact.gap_m) / scene.size_m
        found += _outside_its_cone(contact, normal_n, tangential, friction_of(scene, contact))
    left = imbalance(scene, phase)
    if left > REST:
        found.append(f"the reported forces leave {left:.1e} loads")
    if largest > MOST_FORCE:
        found.append(f"a reported force of {largest:.1e} loads")
    if fall > FALL:
        found.append(f"forces times gaps let the load fall by {fall:.1e} sizes")
    return found


def _outside_its_cone(contact: Contact, normal_n: float, tangential: FloatArray, mu: float) -> list[str]:
    beyond = float(np.linalg.norm(tangential)) - mu * normal_n
    aslant = abs(float(tangential @ contact.normal_world))
    allowed = 1e-9 * (1.0 + abs(normal_n))
    if normal_n < -allowed or beyond > allowed or aslant > allowed:
        return [f"the force of {contact.point} is outside its cone (normal {normal_n:.3g}, beyond {beyond:.1e} loads)"]
    return []

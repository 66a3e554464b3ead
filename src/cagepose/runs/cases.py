"""A scene as kernels take it: `Part`, what is held, and `Cases`, everything else, once or many times."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import cast
from weakref import WeakKeyDictionary

import numpy as np

from cagepose.kernels.algebra.record import Rows, empty_record
from cagepose.kernels.algebra.tolerances import kernel_tolerances
from cagepose.kernels.contact.friction import friction_of
from cagepose.kernels.contact.loads import DEAD_MOMENT, PhaseLoad
from cagepose.kernels.contact.metric import Body
from cagepose.kernels.native.slots import Slots
from cagepose.kernels.outcome.cases import Cases, Part
from cagepose.model.boundary.body_parts import shifted
from cagepose.model.checks import FloatArray, as_vector
from cagepose.model.methods import DEFAULT_METRIC
from cagepose.model.planar import held_freedoms
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.runs.actions import Wrench, actions_of
from cagepose.runs.drives import at_start, drives_of
from cagepose.runs.tolerances import LEAST_RADIUS_OF_GYRATION


def part_of(scene: Scene) -> Part:
    """Return the object as seen from its centre of gravity."""
    boxes, center = scene.boxes, scene.object.center_of_gravity_m
    return Part(
        shifted(scene.geometry.held, -center),
        boxes.half_sizes,
        boxes.box_positions - center,
        boxes.box_rotations,
        boxes.n_own_boxes,
        body_of(scene),
        as_vector(center),
    )


def body_of(scene: Scene) -> Body:
    """Return the metric of a scene: its inertia about the centre of gravity, or the same about every axis ("drag")."""
    gyration = scene.object.gyration_m2
    reach_m = scene.object.reach_m
    if (scene.metric or DEFAULT_METRIC) == "drag":
        squares, axes = np.full(3, np.trace(gyration) / 3.0), np.eye(3)
    else:
        squares, axes = np.linalg.eigh(gyration)
    body = empty_record(Body)
    body.axes_object[:] = axes.T
    # A needle's inertia about its own axis may come out as zero: no body is thinner than a box may be.
    body.radii[:] = np.sqrt(np.maximum(squares, (LEAST_RADIUS_OF_GYRATION * reach_m) ** 2))
    body.reach_m = reach_m
    body.held[:] = held_freedoms(scene.planar)
    return body


def cases_of(scene: Scene, friction: float, start: Pose | None = None, displaced: FloatArray | None = None) -> Cases:
    """Return a scene as a case of one; ``start`` stands in the place of the object's own start pose, and ``displaced``,
    (n_bodies, 7), says where the bodies of the cage and the springs on them are, if not where the scene has them.
    """
    cage, held = scene.cage.pose_world_cage, start or scene.object.pose_world_object
    return Cases(
        cage.position_m[None],
        cage.quaternion_wxyz[None],
        scene.cage.points_cage[None],
        scene.geometry.cage,
        at_start(scene) if displaced is None else displaced,
        drives_of(scene),
        held.position_m[None],
        held.quaternion_wxyz[None],
        np.array([scene.size_m]),
        np.array([friction]),
        _own_frictions(scene, scene.cage.element_names),
        _own_frictions(scene, scene.object.element_names),
        cast(Rows[Rows[PhaseLoad]], actions_of(scene, displaced)[None]),
        kernel_tolerances(1.0, scene.tolerances.touch),
    )


def with_greatest_friction(cases: Cases, greatest: float) -> Cases:
    """Return a case of one in which ``greatest`` is the greatest coefficient of all contacts that there can be, and the
    others keep their proportion to it; all are equal where there is no friction yet.
    """
    of_points, of_boxes = cases.point_frictions, cases.box_frictions
    now = friction_of(float(cases.frictions[0]), of_points, of_boxes).greatest
    if now == 0.0:
        return cases._replace(
            frictions=np.array([float(greatest)]),
            point_frictions=np.full_like(of_points, math.nan),
            box_frictions=np.full_like(of_boxes, math.nan),
        )
    times = greatest / now
    return cases._replace(
        frictions=times * cases.frictions, point_frictions=times * of_points, box_frictions=times * of_boxes
    )


def with_wrench(cases: Cases, phase: int, wrench: Wrench) -> Cases:
    """Return a case of one in which only a force and a moment act in a phase, whose directions are of the world."""
    known = np.asarray(cases.actions)
    actions = np.zeros((1, known.shape[1], max(known.shape[2], 2)), known.dtype)
    actions[:, :, : known.shape[2]] = known
    acting = actions[0, phase]
    acting[:] = 0
    acting["vector"][0], acting["vector"][1], acting["kind"][1] = wrench.force, wrench.moment, DEAD_MOMENT
    return cases._replace(actions=cast(Rows[Rows[PhaseLoad]], actions))


def _own_frictions(scene: Scene, names: Sequence[str]) -> FloatArray:
    """Return the coefficients of friction of points, boxes and shapes, (n,): NaN for those without one."""
    return np.array([scene.friction_of.get(name, math.nan) for name in names])


def contact_friction(scene: Scene, friction: float, point: str, box: str) -> float:
    """Return the coefficient of a contact, with ``friction`` where neither its point nor its box has one."""
    return scene.friction_of.get(point, scene.friction_of.get(box, friction))


def greatest_friction(scene: Scene, friction: float) -> float:
    """Return the greatest coefficient of all contacts that there can be, with ``friction`` as in `contact_friction`."""
    of_points, of_boxes = (_own_frictions(scene, part.element_names) for part in (scene.cage, scene.object))
    return friction_of(friction, of_points, of_boxes).greatest


_PREPARED: WeakKeyDictionary[Scene, dict[float, tuple[Slots, Slots]]] = WeakKeyDictionary()


def prepared(scene: Scene, friction: float) -> tuple[Slots, Slots]:
    """Return `Part` and `Cases` of a scene, taken apart; a scene never changes, so that they are made once."""
    of_scene = _PREPARED.setdefault(scene, {})
    if friction not in of_scene:
        of_scene[friction] = taken_apart(scene, friction)
    return of_scene[friction]


def taken_apart(
    scene: Scene, friction: float, start: Pose | None = None, displaced: FloatArray | None = None
) -> tuple[Slots, Slots]:
    """Return `Part` and `Cases` of a scene, taken apart; ``start`` and ``displaced`` as for `cases_of`, but that a run
    takes springs along with the bodies itself.
    """
    cases = cases_of(scene, friction, start)
    return Slots(part_of(scene)), Slots(cases if displaced is None else cases._replace(displaced=displaced))

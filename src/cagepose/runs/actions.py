"""What acts in a phase as kernels take it: `Action` records, and their sum at a pose."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple
from weakref import WeakKeyDictionary

import numpy as np

from cagepose.kernels.algebra.record import dtype_of
from cagepose.kernels.contact.loads import (
    DEAD_FORCE,
    DEAD_MOMENT,
    FIXED_FORCE,
    FOLLOWING_FORCE,
    FOLLOWING_MOMENT,
    SPRING,
    Action,
    acting,
    total_load,
)
from cagepose.model.checks import FloatArray, as_vector
from cagepose.model.geometry import cage_bodies
from cagepose.model.load import Force, Load
from cagepose.model.pose import Pose
from cagepose.model.scene import Scene
from cagepose.model.spring import Spring
from cagepose.runs.load_scaling import one_force, scaled_load
from cagepose.runs.tolerances import TENSION_AT_ZERO


class Wrench(NamedTuple):
    """A force and its moment about the centre of gravity, (3,) each, in the world."""

    force: FloatArray
    moment: FloatArray


def actions_of(scene: Scene, displaced: FloatArray | None = None) -> np.ndarray:
    """Return what acts in each phase, (n_phases, n_actions): the weight, forces, moments and springs, then such as do
    nothing. ``displaced``, (n_bodies, 7), says where the bodies that springs ride on are, if not where they start.
    """
    of_phases = [_actions_of_phase(scene, load, displaced) for load in scene.loads]
    found = np.zeros((len(of_phases), max(map(len, of_phases))), dtype_of(Action))
    for index, actions in enumerate(of_phases):
        found[index, : len(actions)] = actions
    return found


def _actions_of_phase(scene: Scene, load: Load, displaced: FloatArray | None = None) -> np.ndarray:
    center, start = scene.object.center_of_gravity_m, scene.object.pose_world_object
    cage = scene.cage.pose_world_cage
    weighed = scaled_load(scene, load)
    pushes = acting_pushes(load, weighed.forces)
    found = np.zeros(1 + len(pushes) + len(load.moments) + len(load.springs), dtype_of(Action))
    found["vector"][0] = weighed.gravity
    for index, push in enumerate(pushes, start=1):
        found["vector"][index] = push.vector
        if push.kind == FIXED_FORCE:
            found["anchor"][index] = push.at_m - cage_middle(scene)
        else:
            found["arm_object"][index] = push.at_m - center
        found["kind"][index] = push.kind
    for index, moment in enumerate(load.moments, start=1 + len(pushes)):
        found["kind"][index] = FOLLOWING_MOMENT if moment.follows else DEAD_MOMENT
        found["vector"][index] = moment.magnitude_nm * moment.direction
    for index, spring in enumerate(load.springs, start=len(found) - len(load.springs)):
        found["kind"][index] = SPRING
        found["arm_object"][index] = spring.at_object_m - center
        ends = spring_ends(scene, spring, cage.position_m[None], cage.quaternion_wxyz[None])
        found["body"][index] = body = body_numbers(scene).get(spring.of, 0)
        end = ends[0] if displaced is None or body == 0 else _moved(cage, ends[0], displaced[body])
        found["anchor"][index] = end - cage_middle(scene)
        found["stiffness"][index] = spring.stiffness_n_per_m
        found["tension_at_zero"][index] = tensions_at_zero(
            spring, ends, start.position_m[None], start.quaternion_wxyz[None]
        )[0]
    return found


def _moved(cage: Pose, place_world: FloatArray, displaced: FloatArray) -> FloatArray:
    """Return where a place of a body is in the world, (3,), after the body was displaced in the cage's frame, (7,)."""
    return (cage @ Pose(displaced[:3], displaced[3:])).transform(cage.inverse_transform(place_world))


def body_numbers(scene: Scene) -> dict[str | None, int]:
    """Return the numbers of the bodies of a cage, by name, as kernels count them: what stands still is 0."""
    return {body.name: number for number, body in enumerate(scene.cage.bodies, start=1)}


class Push(NamedTuple):
    """A force that acts: its kind of `Action`, and its vector (3,), in the world or in the object's frame if it follows
    it, at a point (3,), metres, in the object's frame, or in the world if it is fixed there.
    """

    kind: int
    vector: FloatArray
    at_m: FloatArray


def acting_pushes(load: Load, forces: FloatArray) -> list[Push]:
    """Return a phase's forces, (n, 3), each at its point; dead forces that one force is equal to are that one.

    So the stepwise method, which knows one force, sees what such forces come to.
    """
    pushes = [_push(push, force) for push, force in zip(load.pushes, forces, strict=True)]
    dead = [push for push in pushes if push.kind == DEAD_FORCE]
    if len(dead) > 1:
        one = one_force(np.array([push.vector for push in dead]), np.array([push.at_m for push in dead]))
        if one is not None:
            return [Push(DEAD_FORCE, *one), *(push for push in pushes if push.kind != DEAD_FORCE)]
    return pushes


def _push(force: Force, vector: FloatArray) -> Push:
    if force.at_object_m is not None:
        return Push(FOLLOWING_FORCE if force.follows else DEAD_FORCE, vector, force.at_object_m)
    assert force.at_world_m is not None  # it has one of the two
    return Push(FIXED_FORCE, vector, force.at_world_m)


def is_one_force(scene: Scene, load: Load) -> bool:
    """Whether besides its weight a phase has at most one dead force, or such as one is equal to, and neither drives nor
    presses anything.
    """
    if load.drive or load.press:
        return False
    if load.moments or load.springs or not all(push.has_potential for push in load.pushes):
        return False
    return len(load.pushes) < 2 or len(acting_pushes(load, scaled_load(scene, load).forces)) == 1


def spring_ends(scene: Scene, spring: Spring, positions_m: FloatArray, quaternions: FloatArray) -> FloatArray:
    """Return where a spring is held at the start, in the world, (n, 3), metres, of cages at poses, (n, 3) and (n, 4);
    one row for all where it rides on no body. Number by number, as below.
    """
    if spring.of is None:
        return spring.to_m[None]
    (body,) = (body for body in scene.cage.bodies if body.name == spring.of)
    turned = _turned(quaternions, *body.pose_cage_body.transform(spring.to_m))
    ends: FloatArray = positions_m + np.stack(turned, axis=1)
    return ends


def tensions_at_zero(
    spring: Spring, ends_m: FloatArray, positions_m: FloatArray, quaternions: FloatArray
) -> FloatArray:
    """Return the tension that a spring would have if its ends met, newtons, (n,), held at ``ends_m``, (n, 3), for
    objects that start at poses, (n, 3) and (n, 4). Number by number, so that a row has the same bits as alone.
    """
    turned = _turned(quaternions, *spring.at_object_m)
    ways = [ends_m[:, axis] - (positions_m[:, axis] + turned[axis]) for axis in range(3)]
    pulls = spring.stiffness_n_per_m * np.sqrt(ways[0] * ways[0] + ways[1] * ways[1] + ways[2] * ways[2])
    tensions = spring.preload_n - pulls
    is_rounding = np.abs(tensions) <= TENSION_AT_ZERO * (abs(spring.preload_n) + pulls)
    kept: FloatArray = np.where(is_rounding, 0.0, tensions)
    return kept


_MIDDLES: WeakKeyDictionary[Scene, FloatArray] = WeakKeyDictionary()


def cage_middle(scene: Scene) -> FloatArray:
    """Return the middle of all points, shapes and holes of the cage that stand still, in the world, (3,), metres. A
    scene never changes, so that it is found once.
    """
    if scene not in _MIDDLES:
        points, pose = scene.cage.points_cage, scene.cage.pose_world_cage
        _MIDDLES[scene] = cage_middles(scene, points[None], pose.position_m[None], pose.quaternion_wxyz[None])[0]
    return _MIDDLES[scene]


def cage_middles(
    scene: Scene, points_cage_m: FloatArray, positions_m: FloatArray, quaternions: FloatArray
) -> FloatArray:
    """Return the middles of cages in the world, (n, 3), metres, from which kernels see all positions: those of what
    stands still, or the origins of their frames where all is of bodies.

    Points are (n, n_points, 3), poses (n, 3) and (n, 4), each also one row for all; the shapes are those of the scene,
    and their middles are the kernels' own (`cagepose.kernels.outcome.cases.start_of`). Number by number, as below.
    """
    n_points = points_cage_m.shape[1]
    parts = np.asarray(cage_bodies(scene.cage, scene.touch_m).own.parts)
    stands = parts["body"] == 0
    shapes = parts["middle"][n_points:][stands[n_points:]]
    points = points_cage_m[:, stands[:n_points]]
    places = np.concatenate([points, np.repeat(shapes[None], len(points), axis=0)], axis=1)
    middles = places.cumsum(axis=1)[:, -1] / places.shape[1] if stands.any() else np.zeros((len(points), 3))
    found: FloatArray = positions_m + np.stack(_turned(quaternions, *middles.T), axis=1)
    return found


def _turned(quaternions: FloatArray, x: FloatArray, y: FloatArray, z: FloatArray) -> tuple[FloatArray, ...]:
    """Return vectors turned by quaternions, (n, 4): as `cagepose.kernels.algebra.pose.rotated` does."""
    w, i, j, k = quaternions.T
    t = (2.0 * (j * z - k * y), 2.0 * (k * x - i * z), 2.0 * (i * y - j * x))
    return (
        x + w * t[0] + (j * t[2] - k * t[1]),
        y + w * t[1] + (k * t[0] - i * t[2]),
        z + w * t[2] + (i * t[1] - j * t[0]),
    )


def load_size(scene: Scene, phase: int, pose: Pose, displaced: FloatArray | None = None) -> float:
    """Return the lengths of all that acts in a phase while the object is at a pose, added up: of weight and forces, of
    what the springs' tensions are made of, and the moments over the scene's size. ``displaced`` as for `actions_of`.
    """
    center = pose.transform(scene.object.center_of_gravity_m) - cage_middle(scene)
    return total_load(
        _actions_of_phase(scene, scene.loads[phase], displaced), as_vector(center), pose.as_tuples()[1], scene.size_m
    )


def wrench_at(scene: Scene, phase: int, pose: Pose, displaced: FloatArray | None = None) -> Wrench:
    """Return the sum of all that acts in a phase while the object is at a pose; ``displaced`` as for `actions_of`."""
    forces, moments = zip(*wrenches_at(scene, phase, pose, displaced), strict=True)
    return Wrench(np.sum(forces, axis=0), np.sum(moments, axis=0))


def wrenches_at(scene: Scene, phase: int, pose: Pose, displaced: FloatArray | None = None) -> Iterator[Wrench]:
    """Yield what acts in a phase while the object is at a pose, one by one: the weight, forces, moments, then springs;
    ``displaced`` as for `actions_of`.
    """
    center = pose.transform(scene.object.center_of_gravity_m) - cage_middle(scene)
    for action in _actions_of_phase(scene, scene.loads[phase], displaced):
        one = acting(action, as_vector(center), pose.as_tuples()[1])
        yield Wrench(one.share * np.array(one.force), one.share * np.array(one.moment))

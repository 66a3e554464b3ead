"""The room that a playback is drawn in: its scale follows the scene's size, and small motions can be exaggerated.

Drawing coordinates have the scene's size as their unit and the middle of the scene as their origin, so that a scene in
millimetres and one in metres look alike.

Exaggeration by k shows the object k times as far from where it started, turned k times as much; a cage point is shown k
times as far from the nearest place of the object at the start, a shape of the cage as a whole. To first order in the
motion, the gaps on screen are then k times the true ones: what touches on screen touches. (Of a shape this holds where
it comes to touch along the way on which it was nearest.)
"""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np

from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose
from cagepose.views.solids import cut_off, outer_points, vertices_of
from cagepose.views.viewer.playback import Playback
from cagepose.views.viewer.surface import nearest_on_object

EXAGGERATIONS = (1, 2, 5, 10, 20, 50, 100, 200)
"""What a slider offers."""
MOST_TURN_RAD, MOST_WAY = math.radians(10.0), 0.15
"""The exaggeration that is proposed shows no greater turn, and no longer way in sizes of the scene."""
MOST_ADDED = 0.5
"""A cage point is moved away from the object by at most this many sizes: one that is far off must stay in the picture.
"""


class Stage:
    """Where things of a playback are drawn.

    Attributes
    ----------
    middle_world
        The origin of drawing coordinates, (3,), metres.
    size_m
        Their unit: the size of the scene, or of what is shown of it.
    gaps_world
        From the place of the object at the start that is nearest to each of the cage's points and shapes, to the place
        there, (n, 3), metres.
    bodies_world
        Points whose hull is that of each shape of the cage, as far as they are shown: tuples of (n, 3), metres.
    middles_world
        Of each of these, and the mouth of each hole of the cage, (n, 3), metres.
    radius
        A sphere about the origin that holds the cage and the object at the start and the end, in drawing units.
    """

    def __init__(self, shown: Playback) -> None:
        scene, held = shown.run.scene, shown.run.scene.object
        self.shown = shown
        self.center_object_m = held.center_of_gravity_m
        self.reference = shown.shots[0].pose_world_object
        nearest = nearest_on_object(held, self.reference, scene.cage)
        still = np.zeros((len(scene.cage.holes), 3))  # a hole stays where it is
        self.gaps_world: FloatArray = np.concatenate([nearest.places_world - nearest.feet_world, still])
        ends = (self.reference, shown.shots[-1].pose_world_object)
        everything = np.concatenate([shown.points_world, *(pose.transform(outer_points(held)) for pose in ends)])
        bodies = [scene.cage.pose_world_cage.transform(vertices_of([shape])) for shape in scene.cage.shapes]
        self.bodies_world = tuple(cut_off(body, everything, held.reach_m) for body in bodies)
        everything = np.concatenate([everything, *self.bodies_world])
        mouths = [scene.cage.pose_world_cage.transform(hole.pose_body_shape.position_m) for hole in scene.cage.holes]
        self.middles_world = np.array([*(body.mean(axis=0) for body in self.bodies_world), *mouths]).reshape(-1, 3)
        self.middle_world: FloatArray = (everything.min(axis=0) + everything.max(axis=0)) / 2.0
        radius_m = float(np.linalg.norm(everything - self.middle_world, axis=1).max())
        # Of a ball on a large table the scene's size is that of the table, of which little is shown.
        self.size_m = min(scene.size_m, 2.0 * radius_m) if bodies else scene.size_m
        self.radius = radius_m / self.size_m

    def place(self, point_world: FloatArray) -> FloatArray:
        """Return a point of the world, (3,) or (n, 3) in metres, in drawing coordinates."""
        drawn: FloatArray = (point_world - self.middle_world) / self.size_m
        return drawn

    def pose(self, pose_world_object: Pose, exaggeration: float) -> Pose:
        """Return the pose, in the world and in metres, at which the object is shown."""
        if exaggeration == 1.0:
            return pose_world_object
        before = self.reference.transform(self.center_object_m)
        center = before + exaggeration * (pose_world_object.transform(self.center_object_m) - before)
        turn = _turn_vector(self.reference, pose_world_object)
        turned = _from_turn_vector(exaggeration * turn) @ Pose(quaternion_wxyz=self.reference.quaternion_wxyz)
        return Pose(center - turned.transform(self.center_object_m), turned.quaternion_wxyz)

    def shifts(self, exaggeration: float) -> FloatArray:
        """Return how far each of the cage's points, shapes and holes is moved from its place, (n, 3), metres."""
        lengths = np.linalg.norm(self.gaps_world, axis=1, keepdims=True)
        most = MOST_ADDED * self.size_m / np.maximum(lengths, np.finfo(np.float64).tiny)
        moved: FloatArray = np.minimum(exaggeration - 1.0, most) * self.gaps_world
        return moved

    def points(self, exaggeration: float) -> FloatArray:
        """Return where the cage points are shown, (n, 3), metres in the world."""
        moved: FloatArray = self.shown.points_world + self.shifts(exaggeration)[: len(self.shown.points_world)]
        return moved

    def normal(self, normal_world: FloatArray, true: Pose, shown: Pose) -> FloatArray:
        """Return how a vector that turns with the object is shown, (3,)."""
        turned: FloatArray = shown.rotation @ (true.rotation.T @ normal_world)
        return turned

    @cached_property
    def proposed(self) -> int:
        """The greatest of `EXAGGERATIONS` that keeps every turn and way small on screen; 1 where nothing moves."""
        turn = way = 0.0
        start = self.reference.transform(self.center_object_m)
        for row in self.shown.rows:
            pose = self.shown.shots[row.last_shot].pose_world_object
            turn = max(turn, float(np.linalg.norm(_turn_vector(self.reference, pose))))
            way = max(way, float(np.linalg.norm(pose.transform(self.center_object_m) - start)))
        if turn == way == 0.0:
            return 1
        fitting = [k for k in EXAGGERATIONS if k * turn <= MOST_TURN_RAD and k * way <= MOST_WAY * self.size_m]
        return fitting[-1] if fitting else 1


def _turn_vector(start: Pose, end: Pose) -> FloatArray:
    """Return axis times angle, (3,), of the turn in the world from one orientation to another, at most half a turn."""
    turn = (end @ start.inverse()).quaternion_wxyz
    sine = float(np.linalg.norm(turn[1:]))
    if sine == 0.0:
        return np.zeros(3)
    vector: FloatArray = turn[1:] * (2.0 * math.atan2(sine, float(turn[0])) / sine)
    return vector


def _from_turn_vector(vector: FloatArray) -> Pose:
    angle = float(np.linalg.norm(vector))
    if angle == 0.0:
        return Pose()
    return Pose(quaternion_wxyz=np.concatenate([[math.cos(angle / 2.0)], math.sin(angle / 2.0) * vector / angle]))

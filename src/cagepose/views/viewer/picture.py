"""One shot of a playback as a picture: the same things in the same colours as on the page."""

from __future__ import annotations

import math

import numpy as np
from PIL import Image

from cagepose.files.units import from_metres
from cagepose.model.checks import FloatArray
from cagepose.model.pose import Pose
from cagepose.model.shapes import Shape
from cagepose.studies.acts import Act, coil
from cagepose.views.solids import outer_points, solid_of
from cagepose.views.viewer.caption import LOUD_INK, QUIET_INK, Caption, Label
from cagepose.views.viewer.playback import Shot, Touches
from cagepose.views.viewer.raster import DIM, Color, Raster
from cagepose.views.viewer.stage import Stage

SIZE = (900, 600)
"""Pixels across and down."""
FINER = 2
"""How many times as many are drawn before they are put together."""
AZIMUTH, ELEVATION = math.radians(-56.0), math.radians(24.0)
BLUE, SKY, GREY, DARK = (0.0, 0.447, 0.698), (0.337, 0.706, 0.914), (0.6, 0.6, 0.6), (0.45, 0.45, 0.45)
ORANGE, VERMILLION, PURPLE, BLACK = (0.902, 0.624, 0.0), (0.835, 0.369, 0.0), (0.8, 0.475, 0.655), (0.05, 0.05, 0.05)
BALL, FREE_BALL, ROD, LONGEST_ARROW, NORMAL = 0.01, 0.007, 0.0045, 0.22, 0.07
"""In sizes of the scene, as on the page."""
SECOND_HEAD, LONGEST_SPRING, COIL = 0.8, 1.0, 0.012
"""Where a moment's arrow has its other head; in sizes of the scene, the greatest length of a spring that is drawn, and
the radius of its coils."""
SAND, BROWN = (0.72, 0.66, 0.55), (0.36, 0.3, 0.2)
"""Of the cage's bodies and their outlines."""
SEE_THROUGH, BODY_OPACITY = 0.3, 0.45
FEW_NAMES = 14
"""Of more contacts than these, only those are named that press or were just reached."""
LEAST_FORCE = 1e-9
"""In parts of the greatest one; what is less is rounding."""
_Faces = tuple[FloatArray, FloatArray | None, Color, float]
"""Corners, how bright these are, colour and opacity."""
_EDGES = ((0, 1), (0, 2), (0, 4), (1, 3), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 6), (5, 7), (6, 7))
_FACES = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))


class PictureMaker:
    """Draws shots of one playback, all from the same place."""

    def __init__(self, stage: Stage, exaggeration: int, size: tuple[int, int] = SIZE) -> None:
        self.stage = stage
        self.width, self.height = size
        self.shown = stage.shown
        self.exaggeration = exaggeration
        scene = self.shown.run.scene
        self.corners_object = np.concatenate([np.zeros((0, 3)), *(box.corners_object() for box in scene.object.boxes)])
        self.points = stage.place(stage.points(exaggeration))
        self.shifts = stage.shifts(exaggeration)
        self.body_shifts = self.shifts[len(self.points) : len(self.points) + len(scene.cage.shapes)]
        self.body_poses = [
            Pose(shift) @ scene.cage.pose_world_cage @ shape.pose_body_shape
            for shift, shape in zip(self.body_shifts, scene.cage.shapes, strict=True)
        ]
        self.hole_poses = [scene.cage.pose_world_cage @ hole.pose_body_shape for hole in scene.cage.holes]
        sin_a, cos_a, sin_e, cos_e = math.sin(AZIMUTH), math.cos(AZIMUTH), math.sin(ELEVATION), math.cos(ELEVATION)
        back = np.array([cos_a * cos_e, sin_a * cos_e, sin_e])
        right = np.array([-sin_a, cos_a, 0.0])
        self.axes = np.stack([right, np.cross(back, right), back])
        self.arrow_per_force = LONGEST_ARROW / (self.shown.greatest_force or 1.0)
        self._fit()
        center = stage.center_object_m
        self.way = self._pixels(
            stage.place(np.stack([self._shown(shot).transform(center) for shot in self.shown.shots]))
        )
        self.raster = Raster(self.width * FINER, self.height * FINER)
        self._draw_standing()
        units_per_pixel = float(from_metres(stage.size_m, self.shown.length_unit)) * FINER / self.pixels
        self.caption = Caption(self.shown, exaggeration, size, units_per_pixel)

    def picture(self, shot: Shot) -> Image.Image:
        """Return one shot as a picture."""
        self.raster.begin()
        self.labels: list[Label] = []
        pose = self.stage.pose(shot.pose_world_object, self.exaggeration)
        self._draw_points(shot)
        self._draw_touches(shot, pose)
        self._draw_loads(shot, pose)
        self._draw_motion(shot, pose)
        self._draw_way(shot)
        self._draw_object(pose)
        image = self.raster.shrunk(FINER)
        self.caption.write(image, shot, self.labels)
        return image

    def _fit(self) -> None:
        """Choose scale and middle so that the ends of all events, the cage, the loads and the last forces fit."""
        ends = [self._shown(self.shown.shots[shot]) for shot in (0, *(row.last_shot for row in self.shown.rows))]
        outer = outer_points(self.shown.run.scene.object)
        places = [self.stage.place(pose.transform(outer)) for pose in ends]
        for act in (act for acts in self.shown.loads for act in acts):
            places.append(np.stack(self._ends(act, ends[-1])))
        last = self.shown.shots[-1].touches
        if last.forces_object is not None:
            places.append(self._places(last) - self.arrow_per_force * last.forces_object @ ends[-1].rotation.T)
        for body, shift in zip(self.stage.bodies_world, self.body_shifts, strict=True):
            places.append(self.stage.place(body + shift))
        for hole, pose in zip(self.shown.run.scene.cage.holes, self.hole_poses, strict=True):
            places.append(self.stage.place(pose.transform(solid_of(hole).mesh.vertices_m)))
        seen = np.concatenate([*places, self.points]) @ self.axes.T
        low, high = seen.min(axis=0), seen.max(axis=0)
        self.middle = (low + high) / 2.0
        half = np.maximum((high - low) / 2.0, 0.05)
        self.pixels = 0.42 * FINER * min(self.width / half[0], self.height / half[1])

    def _shown(self, shot: Shot) -> Pose:
        return self.stage.pose(shot.pose_world_object, self.exaggeration)

    def _pixels(self, places: FloatArray) -> FloatArray:
        """Turn drawing coordinates into those of the raster."""
        seen = (places @ self.axes.T - self.middle) * self.pixels * np.array([1.0, -1.0, 1.0])
        pixels: FloatArray = seen + np.array([self.width, self.height, 0.0]) * FINER / 2.0
        return pixels

    def _places(self, touches: Touches) -> FloatArray:
        """Return where things touch, (n, 3)."""
        return self.stage.place(touches.places_world + self.shifts[touches.points])

    def _rod(self, start: FloatArray, end: FloatArray, radius: float, color: Color) -> None:
        first, last = self._pixels(np.stack([start, end]))
        self.raster.rod(first, last, max(radius * self.pixels, 0.5 * FINER), color)

    def _arrow(self, tail: FloatArray, tip: FloatArray, radius: float, color: Color) -> None:
        length = float(np.linalg.norm(tip - tail))
        if length < 0.01:
            return
        neck = tip - min(5.0 * radius / length, 0.6) * (tip - tail)
        self._rod(tail, neck, radius, color)
        first, last = self._pixels(np.stack([neck, tip]))
        self.raster.rod(first, last, 2.6 * radius * self.pixels, color, 0.0)

    def _ball(self, place: FloatArray, radius: float, color: Color) -> None:
        self.raster.ball(self._pixels(place), radius * self.pixels, color)

    def _name(self, place: FloatArray, text: str, *, is_loud: bool) -> None:
        x, y = (self._pixels(place)[:2] / FINER).tolist()
        self.labels.append(Label((x, y), text, LOUD_INK if is_loud else QUIET_INK))

    def _draw_standing(self) -> None:
        """Draw what all shots have: where the object started, and the cage; a point that touches covers itself."""
        self._draw_edges(self.stage.reference, GREY)
        for shape in self.shown.run.scene.object.shapes:
            self._solid(shape, self.stage.reference @ shape.pose_body_shape, GREY)
        for point in self.points:
            self._ball(point, FREE_BALL, DARK)
        self.raster.keep()

    def _draw_points(self, shot: Shot) -> None:
        touching = set(shot.touches.points.tolist())
        row = self.shown.rows[shot.row] if shot.row >= 0 else None
        is_end = row is not None and self.shown.shots[row.last_shot] is shot
        pressing, names = self._pressing(shot), self.shown.run.scene.cage.element_names
        places = self._places(shot.touches)
        for index, name in enumerate(names):
            if is_end and row is not None and name in row.event.hit:
                color = VERMILLION
            else:
                color = ORANGE if index in touching else DARK
            is_point = index < len(self.points)
            marks = places[shot.touches.points == index]
            if color != DARK:
                for mark in self.points[index : index + 1] if is_point else marks:
                    self._ball(mark, BALL, color)
            counts = color == VERMILLION or (color == ORANGE and (len(touching) <= FEW_NAMES or index in pressing))
            if counts or len(names) <= FEW_NAMES:
                self._name(self._named_place(index, marks), name, is_loud=color != DARK)

    def _named_place(self, index: int, marks: FloatArray) -> FloatArray:
        """Return where an element of the cage has its name: a shape or a hole that touches where it does, else in its
        middle or at its mouth.
        """
        if index < len(self.points):
            return np.asarray(self.points[index])
        if len(marks):
            return np.asarray(marks[0])
        return self._middle(index - len(self.points))

    def _pressing(self, shot: Shot) -> set[int]:
        """Return the points that bear some of the load in a shot."""
        if shot.touches.forces_object is None:
            return set()
        forces = np.linalg.norm(shot.touches.forces_object, axis=1)
        return set(shot.touches.points[forces > LEAST_FORCE * self.shown.greatest_force].tolist())

    def _draw_touches(self, shot: Shot, pose: Pose) -> None:
        places, forces = self._places(shot.touches), shot.touches.forces_object
        for place, normal in zip(places, shot.touches.normals_object @ pose.rotation.T, strict=True):
            self._rod(place, place + NORMAL * normal, 0.3 * ROD, (0.3, 0.3, 0.3))
        if forces is not None:
            for place, arrow in zip(places, self.arrow_per_force * forces @ pose.rotation.T, strict=True):
                self._arrow(place - arrow, place, ROD, VERMILLION)

    def _draw_loads(self, shot: Shot, pose: Pose) -> None:
        for act in self.shown.loads[shot.phase]:
            start, end = self._ends(act, pose)
            if act.kind == "spring":
                line = self._pixels(coil(start, end, COIL))
                self.raster.lines(line[:-1], line[1:], BLACK)
            else:
                self._arrow(start, end, 1.3 * ROD, BLACK)
            if act.kind == "moment":  # two heads
                self._arrow(start, start + SECOND_HEAD * (end - start), 1.3 * ROD, BLACK)
            self._name(end if act.kind == "spring" else start, act.name, is_loud=True)

    def _ends(self, act: Act, pose: Pose) -> tuple[FloatArray, FloatArray]:
        """Return where an act's arrow starts and ends: that of a force ends where it acts, that of a moment starts at
        the centre of gravity. A spring is drawn for `LONGEST_SPRING` at most.
        """
        at, direction = self.stage.place(pose.transform(act.at_object_m)), act.direction_at(pose)
        if act.to_world_m is not None:
            length = float(np.linalg.norm(self.stage.place(act.to_world_m) - at))
            return at, at + min(length, LONGEST_SPRING) * direction
        if act.kind == "moment":
            return at, at + LONGEST_ARROW * direction
        return at - LONGEST_ARROW * direction, at

    def _draw_motion(self, shot: Shot, pose: Pose) -> None:
        row = self.shown.rows[shot.row] if shot.row >= 0 else None
        if row is None or row.event.motion is None:
            return
        motion = row.event.motion
        before = self.shown.shots[row.first_shot - 1]
        carried = self._shown(before)
        along = motion.direction_world if motion.axis_world is None else motion.axis_world
        assert along is not None
        direction = self.stage.normal(along, before.pose_world_object, carried)
        if motion.through_world is None:
            center = self.stage.place(pose.transform(self.stage.center_object_m))
            self._arrow(center, center + 0.25 * direction, 0.8 * ROD, PURPLE)
            return
        through = carried.transform(before.pose_world_object.inverse_transform(motion.through_world))
        middle = self.stage.place(through)
        middle = middle - (middle @ direction) * direction
        half = math.sqrt(max(0.04, self.stage.radius**2 - float(middle @ middle)))
        self._rod(middle - half * direction, middle + half * direction, 0.5 * ROD, PURPLE)

    def _draw_way(self, shot: Shot) -> None:
        """Draw the way of the centre of gravity up to a shot."""
        way = self.way[: self.shown.shots.index(shot) + 1]
        self.raster.lines(way[:-1], way[1:], BLUE)

    def _draw_object(self, pose: Pose) -> None:
        """Draw the object's edges, and, seen through, its faces and the bodies of the cage, far ones first."""
        self._draw_edges(pose, BLUE)
        center = self.stage.place(pose.transform(self.stage.center_object_m))
        self._ball(center, BALL, BLUE)
        scene = self.shown.run.scene
        drawn: list[tuple[float, _Faces]] = []
        for face in (corners[list(face)] for corners in self._corners(pose) for face in _FACES):
            drawn.append((float(face[:, 2].mean()), (face, None, SKY, SEE_THROUGH)))
        for shape in scene.object.shapes:
            faces = self._solid(shape, pose @ shape.pose_body_shape, BLUE)
            drawn.append((float(faces[0][..., 2].mean()), (*faces, SKY, SEE_THROUGH)))
        for hole in scene.object.holes:  # of which the surface of a part shows nothing
            self._solid(hole, pose @ hole.pose_body_shape, BLUE)
        for hole, hole_pose in zip(scene.cage.holes, self.hole_poses, strict=True):
            self._solid(hole, hole_pose, BROWN)
        for index, body in enumerate(scene.cage.shapes):
            depth = float(self._pixels(self._middle(index))[2])
            drawn.append((depth, (*self._solid(body, self.body_poses[index], BROWN), SAND, BODY_OPACITY)))
        for _, (corners, lit, color, opacity) in sorted(drawn, key=lambda faces: faces[0]):
            if lit is None:
                self.raster.face(corners, color, opacity)
            else:
                self.raster.triangles(corners, lit, color, opacity)

    def _middle(self, body: int) -> FloatArray:
        """Return the middle of what is shown of a shape of the cage, or the mouth of a hole behind these, (3,)."""
        return self.stage.place(self.stage.middles_world[body] + self.shifts[len(self.points) + body])

    def _solid(self, shape: Shape, pose: Pose, ink: Color) -> tuple[FloatArray, FloatArray]:
        """Draw the outline of a shape; return the triangles that face the viewer, and how bright their corners are."""
        solid, back = solid_of(shape), pose.rotation.T @ self.axes[2]
        is_front = solid.normals @ back > 0.0
        vertices = self._pixels(self.stage.place(pose.transform(solid.mesh.vertices_m)))
        outline = solid.outline(is_front)
        self.raster.lines(vertices[outline[:, 0]], vertices[outline[:, 1]], ink)
        lit = DIM + (1.0 - DIM) * np.abs(solid.corner_normals[is_front] @ back)
        return vertices[solid.mesh.triangles[is_front]], lit

    def _draw_edges(self, pose: Pose, color: Color) -> None:
        if len(self.corners_object) == 0:
            return
        starts, ends = (self._corners(pose)[:, which].reshape(-1, 3) for which in np.array(_EDGES).T)
        self.raster.lines(starts, ends, color)

    def _corners(self, pose: Pose) -> FloatArray:
        """All boxes' corners on the raster, (n_boxes, 8, 3)."""
        return self._pixels(self.stage.place(pose.transform(self.corners_object))).reshape(-1, 8, 3)

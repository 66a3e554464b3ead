"""One shot of a playback as a picture: the same things in the same light as on the page."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
from PIL import Image

from cagepose.files.units import from_metres
from cagepose.model.checks import FloatArray
from cagepose.model.hole import Hole
from cagepose.model.pose import Pose
from cagepose.studies.acts import Act, coil
from cagepose.views.solids import outer_points, vertices_of
from cagepose.views.viewer import look
from cagepose.views.viewer.caption import LOUD_INK, QUIET_INK, Caption, Label
from cagepose.views.viewer.eye import Eye
from cagepose.views.viewer.look import PAINT, ink
from cagepose.views.viewer.paint_bodies import BodyPainter, ShownHole
from cagepose.views.viewer.paint_marks import MarkPainter
from cagepose.views.viewer.playback import Shot
from cagepose.views.viewer.raster import Raster
from cagepose.views.viewer.stage import Look, Stage

SIZE = (900, 600)
"""Pixels across and down."""
FINER_PIXELS = 2
"""How many times as many are drawn before they are put together."""
DISTANCE_OF_EYE = 3.0
"""In radii of the scene: how far off the eye is that looks at what is near the cage."""


class PictureMaker:
    """Draws shots of one playback, all from the same place."""

    def __init__(
        self,
        stage: Stage,
        exaggerations: Sequence[float] | None = None,
        size: tuple[int, int] = SIZE,
        *,
        seen: Sequence[int] | None = None,
        is_near: bool = False,
    ) -> None:
        """``exaggerations``: of each phase; left out, those that the stage proposes. ``seen``: the shots that must fit
        into the picture; left out, the start and the end of every event. The object's outline is drawn where the
        first of them has it. ``is_near``: only what is near the cage must fit, of an object that reaches far beyond it.
        """
        self.stage, self.shown = stage, stage.shown
        self.width, self.height = size
        self.exaggerations = stage.proposed if exaggerations is None else tuple(exaggerations)
        self.scene = self.shown.scene
        self.seen = (0, *(row.last_shot for row in self.shown.rows)) if seen is None else tuple(seen)
        self.is_near = is_near
        self.eye = Eye(size, DISTANCE_OF_EYE * stage.radius if is_near else 0.0)
        self.force_scale = look.FORCE / (self.shown.greatest_force or 1.0)
        self._measure_pins()
        self.eye.fit(stage.radius, self._content)
        self.raster = Raster(self.width * FINER_PIXELS, self.height * FINER_PIXELS)
        self.bodies = BodyPainter(stage, self.eye, self.raster, FINER_PIXELS)
        self.marks = MarkPainter(self.bodies)
        self._draw_ground()
        units_per_pixel = float(from_metres(stage.size_m, self.shown.length_unit)) * self.eye.pixel()
        self.caption = Caption(self.shown, size, units_per_pixel)

    def picture(self, shot: Shot, *, is_captioned: bool = True) -> Image.Image:
        """Return one shot as a picture, with or without the words above it."""
        self.raster.begin()
        self.labels: list[Label] = []
        self.now = self._look(shot)
        pose = self.stage.pose(shot.pose_world_object, self.now)
        self._draw_bodies(pose)
        self._draw_start()
        self._draw_points(shot, pose)
        self._draw_touches(shot, pose)
        self._draw_loads(shot, pose)
        self._draw_motion(shot, pose)
        self._draw_way(shot, pose)
        self._glaze_bodies()
        image = self.raster.shrunk(FINER_PIXELS)
        self.caption.write(image, shot if is_captioned else None, self.labels, self.now.factor)
        return image

    def places(self, shot: Shot) -> FloatArray:
        """Return where the contacts of a shot are shown, (n, 3), drawing units."""
        now = self._look(shot)
        places = shot.touches.places_world + self.stage.touch_shifts(shot.touches, now)
        return self.stage.place(places)

    def seen_at(self, places: FloatArray) -> FloatArray:
        """Return the pixels of the picture, (..., 2), at which places of drawing coordinates are."""
        return self.eye.pixels(places)[..., :2]

    def _look(self, shot: Shot) -> Look:
        return self.stage.look(self.shown.shots.index(shot), self.exaggerations)

    def _measure_pins(self) -> None:
        points = self.stage.place(self.shown.points_world)
        self.pin = look.PIN
        if len(points) == 0:
            return
        reach = float(np.linalg.norm(points - points.mean(axis=0), axis=1).max())
        self.pin = min(look.PIN, look.PIN_OF_CAGE * reach) or look.PIN
        self.gaps = self.stage.gaps_world(self.stage.phases[0].reference)[: len(points)]

    def _content(self) -> FloatArray:
        """Return all that must fit: the object, the cage, the loads and the last forces."""
        shots = [self.shown.shots[index] for index in self.seen]
        outer = outer_points(self.scene.object)
        poses = [self.stage.pose(shot.pose_world_object, self._look(shot)) for shot in shots]
        last, end = shots[-1], poses[-1]
        found = [self.stage.place(pose.transform(outer)) for pose in poses]
        now = self._look(last)
        found.append(self.stage.place(self.stage.points(now)))
        for act in self.shown.loads[last.phase] if len(shots) < len(self.shown.rows) else sum(self.shown.loads, ()):
            found.append(np.stack(self._ends(act, last, end, now)))
        if last.touches.forces_object is not None:
            places = self.places(last)
            forces = last.touches.forces_object @ end.rotation.T
            found.append(places - self.force_scale * self.eye.pixel() * forces)
        shifts = self.stage.shifts(now)[len(self.shown.points_world) :]
        for body, shift in zip(self.stage.bodies_world, shifts, strict=False):
            found.append(self.stage.place(body + shift))
        found += [self.stage.place(body) for shot in shots for body in self.stage.driven_bodies(self._look(shot))]
        for which, hole in enumerate(self.scene.cage.holes, len(self.scene.cage.shapes)):
            found.append(self.stage.place(now.cage.pose_of_cage(which).transform(vertices_of([hole]))))
        places = np.concatenate(found)
        return places if not self.is_near else self._near_cage(places, last, now)

    def _near_cage(self, places: FloatArray, shot: Shot, now: Look) -> FloatArray:
        """Return places as they are, or where some are far from the cage and its contacts, moved to what is near."""
        cage = [self.stage.place(self.stage.points(now)), self.places(shot)]
        cage += [self.stage.place(body) for body in self.stage.bodies_world]
        cage.append(self.stage.place(self.stage.middles_world))
        low, high = np.concatenate(cage).min(axis=0), np.concatenate(cage).max(axis=0)
        extent = float((high - low).max())
        if (np.maximum(low - places, places - high) <= look.FAR_FROM_CAGE * extent).all():
            return places
        room = max(look.NEAR_CAGE * extent, look.LEAST_NEAR)
        return np.clip(places, low - room, high + room)

    def _name(self, place: FloatArray, text: str, *, is_loud: bool) -> None:
        x, y = self.seen_at(place).tolist()
        self.labels.append(Label((x, y), text, LOUD_INK if is_loud else QUIET_INK))

    def _draw_ground(self) -> None:
        """Draw what all shots have: a grid of round lengths below."""
        shots = (self.shown.shots[0], self.shown.shots[-1])
        poses = [self.stage.pose(shot.pose_world_object, self._look(shot)) for shot in shots]
        outer = outer_points(self.scene.object)
        lowest = [self.stage.place(pose.transform(outer))[:, 2].min() for pose in poses]
        lowest += [self.stage.place(body)[:, 2].min() for body in self.stage.bodies_world]
        lowest += (self.stage.place(self.stage.points(self._look(shots[-1])))[:, 2] - self.pin).tolist()
        unit = float(from_metres(self.stage.size_m, self.shown.length_unit))
        reach = min(self.stage.radius, 2.0 * self.eye.half) if self.is_near else self.stage.radius
        rough = 2.0 * reach * unit / look.GRID_LINES
        power = 10.0 ** math.floor(math.log10(rough))
        step = power * next(times for times in (1, 2, 5, 10) if times * power >= rough) / unit
        at = step * np.arange(-look.GRID_LINES, look.GRID_LINES + 1)
        end, height = np.full(len(at), at[-1]), np.full(len(at), min(lowest) - look.BELOW)
        starts = np.concatenate([np.stack([at, -end, height], axis=1), np.stack([-end, at, height], axis=1)])
        ends = np.concatenate([np.stack([at, end, height], axis=1), np.stack([end, at, height], axis=1)])
        self.raster.lines(self.bodies.pixels(starts), self.bodies.pixels(ends), ink(PAINT["grid"]))
        self.raster.keep()

    def _holes(self, holes: Sequence[Hole], poses: Sequence[Pose], plays: FloatArray) -> list[ShownHole]:
        added = (self.now.factor - 1.0) * plays
        return [
            ShownHole(hole, pose, 1.0 + float(more) / hole.radius_m)
            for hole, pose, more in zip(holes, poses, added, strict=True)
        ]

    def _cage_poses(self) -> list[Pose]:
        """Return where the cage's shapes and holes are shown."""
        shifts = self.stage.shifts(self.now)[len(self.shown.points_world) :]
        return [Pose(shift) @ self.now.cage.pose_of_shape(which) for which, shift in enumerate(shifts)]

    def _draw_bodies(self, pose: Pose) -> None:
        held, cage = self.scene.object, self.scene.cage
        around, within = self.stage.plays
        holes = self._holes(held.holes, [pose @ hole.pose_body_shape for hole in held.holes], around)
        self.cage_poses = self._cage_poses()
        self.cage_holes = self._holes(cage.holes, self.cage_poses[len(cage.shapes) :], within)
        for part in held.parts:
            placed = pose @ part.pose_body_shape
            self.bodies.paint(part, placed, PAINT["object"], holes)
            self.bodies.edges(part, placed, PAINT["objectEdge"])
        reach = look.LARGE * held.reach_m
        self.glass = [body.farthest_m(body.pose_body_shape.position_m) > reach for body in cage.shapes]
        for body, placed, is_glass in zip(cage.shapes, self.cage_poses, self.glass, strict=False):
            self.bodies.paint(body, placed, PAINT["cage"], self.cage_holes, is_glass=is_glass)
            self.bodies.edges(body, placed, PAINT["cageEdge"])
        for hole in holes:
            self.bodies.wall(hole, PAINT["objectWall"], PAINT["objectEdge"])
        for hole in self.cage_holes:
            self.bodies.wall(hole, PAINT["cageWall"], PAINT["cageEdge"])

    def _glaze_bodies(self) -> None:
        """Paint the faces of the cage's large bodies that are in front, last, far ones first."""
        bodies = [
            (float(self.eye.axes[2] @ placed.position_m), body, placed)
            for body, placed, is_glass in zip(self.scene.cage.shapes, self.cage_poses, self.glass, strict=False)
            if is_glass
        ]
        for _, body, placed in sorted(bodies, key=lambda found: found[0]):
            self.bodies.glaze(body, placed, PAINT["cage"], self.cage_holes, look.GLASS)

    def _draw_start(self) -> None:
        """Draw where the object, and bodies that have been driven since, were in the first shot that must be seen."""
        start = self.shown.shots[self.seen[0]]
        before = self._look(start)
        pose = self.stage.pose(start.pose_world_object, before)
        for part in self.scene.object.parts:
            self.bodies.edges(part, pose @ part.pose_body_shape, PAINT["ghost"])
        first = len(self.shown.points_world)
        shifts = self.stage.shifts(before)[first:]
        for which, body in enumerate(self.scene.cage.shapes):
            if self.now.cage.of_element(first + which) is not before.cage.of_element(first + which):
                placed = Pose(shifts[which]) @ before.cage.pose_of_shape(which)
                self.bodies.edges(body, placed, PAINT["ghost"])

    def _draw_points(self, shot: Shot, pose: Pose) -> None:
        touching = set(shot.touches.points.tolist())
        row = self.shown.rows[shot.row] if shot.row >= 0 else None
        is_end = row is not None and self.shown.shots[row.last_shot] is shot
        pressing, names = self._pressing(shot), self.scene.cage.element_names
        points, places = self.stage.place(self.stage.points(self.now)), self.places(shot)
        for index, name in enumerate(names):
            kind = "touching" if index in touching else "free"
            if is_end and row is not None and name in row.event.hit:
                kind = "reached"
            marks = places[shot.touches.points == index]
            if index < len(points):
                self._draw_pin(index, points[index], shot, pose)
                marks = points[index : index + 1]
            for mark in marks if kind != "free" else ():
                self.marks.ball(mark, look.BALL, PAINT[kind])
            counts = kind == "reached" or (
                kind == "touching" and (len(touching) <= look.FEW_NAMES or index in pressing)
            )
            if counts or len(names) <= look.FEW_NAMES:
                place = marks[0] if len(marks) else self._middle(index - len(points))
                self._name(place, name, is_loud=kind != "free")

    def _draw_pin(self, index: int, place: FloatArray, shot: Shot, pose: Pose) -> None:
        """Draw a cage point as a pin with its tip there, away from the object."""
        out, length = self.gaps[index], float(np.linalg.norm(self.gaps[index]))
        if length < 1e-9 * self.stage.size_m:
            touches = np.nonzero(shot.touches.points == index)[0]
            out = (
                pose.rotation @ shot.touches.normals_object[touches[0]] if len(touches) else np.array((0.0, 0.0, -1.0))
            )
            length = 1.0
        self.marks.pin(place, self.pin / length * out)

    def _pressing(self, shot: Shot) -> set[int]:
        """Return the points that bear some of the load in a shot."""
        if shot.touches.forces_object is None:
            return set()
        forces = np.linalg.norm(shot.touches.forces_object, axis=1)
        return set(shot.touches.points[forces > look.LEAST_FORCE * self.shown.greatest_force].tolist())

    def _draw_touches(self, shot: Shot, pose: Pose) -> None:
        places, forces = self.places(shot), shot.touches.forces_object
        for place, normal in zip(places, shot.touches.normals_object @ pose.rotation.T, strict=True):
            self.marks.rod(place, place + look.NORMAL * self.eye.pixel(place) * normal, look.THIN, PAINT["normal"])
        if forces is None:
            return
        for place, force in zip(places, self.force_scale * forces @ pose.rotation.T, strict=True):
            if np.linalg.norm(force) >= look.LEAST_SHOWN * look.FORCE:
                self.marks.arrow(place - self.eye.pixel(place) * force, place, look.ROD, PAINT["force"])

    def _draw_loads(self, shot: Shot, pose: Pose) -> None:
        for act in self.shown.loads[shot.phase]:
            start, end = self._ends(act, shot, pose, self.now)
            if act.kind == "spring":
                line = coil(start, end, look.COIL * self.eye.pixel(start))
                for one, other in itertools.pairwise(line):
                    self.marks.rod(one, other, look.THIN, PAINT["load"])
            else:
                self.marks.arrow(start, end, 1.3 * look.ROD, PAINT["load"])
            if act.kind == "moment":  # two heads
                self.marks.arrow(start, start + look.SECOND_HEAD * (end - start), 1.3 * look.ROD, PAINT["load"])
            self._name(end if act.kind == "spring" else start, act.name, is_loud=True)

    def _ends(self, act: Act, shot: Shot, pose: Pose, now: Look) -> tuple[FloatArray, FloatArray]:
        """Return where an act's arrow starts and ends at a shot whose object is shown at a pose: that of a force ends
        at the place of the object where it truly acts, that of a moment starts at the centre of gravity. A spring is
        drawn for `LONGEST_SPRING` at most.
        """
        at = self.stage.place(pose.transform(act.at_object(shot.pose_world_object)))
        direction = act.direction_at(pose, now.cage)
        if act.to_world_m is not None:
            length = float(np.linalg.norm(self.stage.place(act.end_world(now.cage)) - at))
            return at, at + min(length, look.LONGEST_SPRING) * direction
        arrow = look.LOAD * self.eye.pixel(at) * direction
        return (at, at + arrow) if act.kind == "moment" else (at - arrow, at)

    def _draw_motion(self, shot: Shot, pose: Pose) -> None:
        row = self.shown.rows[shot.row] if shot.row >= 0 else None
        if row is None or row.seen is None:
            return
        motion = row.seen
        before = self.shown.shots[row.first_shot - 1]
        carried = self.stage.pose(before.pose_world_object, self._look(before))
        direction = self.stage.normal(motion.line_world, before.pose_world_object, carried)
        if motion.through_world is None:
            center = self.stage.place(pose.transform(self.stage.center_object_m))
            self.marks.arrow(center, center + look.TRAVEL * self.eye.pixel(center) * direction, look.ROD, PAINT["axis"])
            return
        through = carried.transform(before.pose_world_object.inverse_transform(motion.through_world))
        middle = self.stage.place(through)
        middle = middle - (middle @ direction) * direction
        half = math.sqrt(max(0.04, self.stage.radius**2 - float(middle @ middle)))
        self.marks.arrow(middle - half * direction, middle + half * direction, 0.6 * look.ROD, PAINT["axis"])

    def _draw_way(self, shot: Shot, pose: Pose) -> None:
        """Draw the centre of gravity, and its way up to a shot."""
        shots = self.shown.shots[: self.shown.shots.index(shot) + 1]
        center = self.stage.center_object_m
        poses = [self.stage.pose(before.pose_world_object, self._look(before)) for before in shots]
        way = self.bodies.pixels(self.stage.place(np.stack([before.transform(center) for before in poses])))
        self.raster.lines(way[:-1], way[1:], ink(PAINT["trace"]))
        self.marks.ball(self.stage.place(pose.transform(center)), look.BALL - 1.0, PAINT["trace"])

    def _middle(self, body: int) -> FloatArray:
        """Return the middle of what is shown of a shape of the cage, or the mouth of a hole behind these, (3,)."""
        element = len(self.shown.points_world) + body
        middle = self.now.cage.of_element(element).transform(self.stage.middles_world[body])
        return self.stage.place(middle + self.stage.shifts(self.now)[element])

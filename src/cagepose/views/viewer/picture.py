"""One shot of a playback as a picture: the same things in the same light as on the page."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
from PIL import Image

from cagepose.files.units import from_metres
from cagepose.files.words import force_words
from cagepose.model.checks import FloatArray
from cagepose.model.hole import Hole
from cagepose.model.pose import Pose
from cagepose.runs.load_scaling import force_unit
from cagepose.studies.acts import Act, coil
from cagepose.views.solids import outer_points, vertices_of
from cagepose.views.viewer import look
from cagepose.views.viewer.caption import LOUD_INK, QUIET_INK, Caption, Label
from cagepose.views.viewer.eye import Eye
from cagepose.views.viewer.framing import Frame, frame_of
from cagepose.views.viewer.inset import Inset
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
RANK_OF_LOAD, RANK_OF_FORCE, RANK_OF_TOUCH = 5.0, 3.0, 2.0
"""Which names choose their places first; among forces, great ones."""


class PictureMaker:
    """Draws shots of one playback, all from the same place."""

    def __init__(
        self,
        stage: Stage,
        exaggerations: Sequence[float] | None = None,
        size: tuple[int, int] = SIZE,
        *,
        seen: Sequence[int] | None = None,
    ) -> None:
        """``exaggerations``: of each phase; left out, those that the stage proposes. ``seen``: the shots that must fit
        into the picture; left out, the start and the end of every event. The object's outline is drawn where the
        first of them has it.
        """
        self.stage, self.shown = stage, stage.shown
        self.width, self.height = size
        self.exaggerations = stage.proposed if exaggerations is None else tuple(exaggerations)
        self.scene, self.greatest_forces = self.shown.scene, self.shown.greatest_forces
        ends = (0, *(row.last_shot for row in self.shown.rows))
        self.seen = ends if seen is None else tuple(seen)
        self.frame = self._frame(ends)
        self.eye = Eye(size, look.DISTANCE_OF_EYE * stage.radius if self.frame else 0.0)
        self._measure_pins()
        self.eye.fit(stage.radius, self._content)
        self.raster = Raster(self.width * FINER_PIXELS, self.height * FINER_PIXELS)
        self.bodies = BodyPainter(stage, self.eye, self.raster, FINER_PIXELS)
        self.inset = self._inset() if self.frame else None
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
        self._place_bodies(pose)
        self._draw_bodies(pose, self.bodies)
        self._draw_start()
        self._draw_points(shot, pose)
        self._draw_touches(shot, pose)
        self._draw_loads(shot, pose)
        self._draw_motion(shot, pose)
        self._draw_way(shot, pose)
        self._glaze_bodies(self.bodies)
        image = self.raster.shrunk(FINER_PIXELS)
        taken = [self.inset.box] if self.inset else []
        self.caption.write(image, shot if is_captioned else None, self.labels, self._magnified(shot), taken)
        if self.inset:
            self._draw_inset(self.inset, shot, pose)
            self.inset.paste(image)
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

    def _magnified(self, shot: Shot) -> float:
        """Return how many times as large play is shown; 1 where nothing is."""
        is_magnified = self.stage.is_magnified(self.shown.shots.index(shot), self.now)
        return self.now.factor if is_magnified else 1.0

    def _measure_pins(self) -> None:
        points = self.stage.place(self.shown.points_world)
        self.pin = look.PIN
        if len(points) == 0:
            return
        reach = float(np.linalg.norm(points - points.mean(axis=0), axis=1).max())
        self.pin = min(look.PIN, look.PIN_OF_CAGE * reach) or look.PIN
        self.gaps = self.stage.gaps_world(self.stage.phases[0].reference)[: len(points)]

    def _content(self) -> FloatArray:
        """Return all that must fit: the object, the cage, the loads and the last forces, as far as the frame goes."""
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
            found.append(self.places(last) - self.eye.pixel() * self._arrows(last, end))
        shifts = self.stage.shifts(now)[len(self.shown.points_world) :]
        for body, shift in zip(self.stage.bodies_world, shifts, strict=False):
            found.append(self.stage.place(body + shift))
        found += [self.stage.place(body) for shot in shots for body in self.stage.driven_bodies(self._look(shot))]
        for which, hole in enumerate(self.scene.cage.holes, len(self.scene.cage.shapes)):
            found.append(self.stage.place(now.cage.pose_of_cage(which).transform(vertices_of([hole]))))
        places = np.concatenate(found)
        return places if self.frame is None else self.frame.within(places)

    def _frame(self, ends: Sequence[int]) -> Frame | None:
        """Return what must be seen of a run that has these shots at its start and at the ends of its events."""
        shots = [self.shown.shots[index] for index in ends]
        poses = [self.stage.pose(shot.pose_world_object, self._look(shot)) for shot in shots]
        now, center = self._look(shots[-1]), self.stage.center_object_m
        touching = [self.places(shot) for shot in shots] + [self.stage.place(self.stage.points(now))]
        if not sum(map(len, touching)):
            return None
        touching += [self.stage.place(pose.transform(center))[None] for pose in poses]
        outer = outer_points(self.scene.object)
        held = [self.stage.place(pose.transform(outer)) for pose in poses]
        driven = [self.stage.place(body) for shot in shots for body in self.stage.driven_bodies(self._look(shot))]
        bodies = [self.stage.place(body) for body in self.stage.bodies_world]
        nothing = np.zeros((0, 3))
        return frame_of(
            np.concatenate(touching), held, np.concatenate([nothing, *driven]), np.concatenate([nothing, *bodies])
        )

    def _inset(self) -> Inset:
        shots = [self.shown.shots[0], self.shown.shots[-1]]
        poses = [self.stage.pose(shot.pose_world_object, self._look(shot)) for shot in shots]
        outer, at = outer_points(self.scene.object), shots[-1].cage
        found = [pose.transform(outer) for pose in poses] + [self.stage.points(self._look(shots[-1]))]
        found += [at.pose_of_cage(which).transform(vertices_of([shape])) for which, shape in enumerate(at.cage.shapes)]
        whole = self.stage.place(np.concatenate(found))
        return Inset(self.stage, self.eye, whole, self.stage.radius, FINER_PIXELS)

    def _draw_inset(self, inset: Inset, shot: Shot, pose: Pose) -> None:
        """Draw the bodies of the whole, and what acts outside of the picture."""
        self._draw_bodies(pose, inset.bodies)
        self._glaze_bodies(inset.bodies)
        for act in self.shown.loads[shot.phase]:
            start, end = self._ends(act, shot, pose, self.now)
            place = start if act.kind == "moment" else end
            seen = self.seen_at(place)
            if act.kind != "spring" and not ((seen > 0.0) & (seen < [self.width, self.height])).all():
                inset.arrow(place, act.direction_at(pose, self.now.cage), act.name)

    def _arrows(self, shot: Shot, pose: Pose) -> FloatArray:
        """Return the arrows of a shot's forces, which are known, in the world, (n, 3), pixels: the longest one for the
        greatest force of the phase; zero for what is rounding.
        """
        forces = np.array(shot.touches.forces_object).reshape(-1, 3) @ pose.rotation.T
        shares = np.linalg.norm(forces, axis=1, keepdims=True) / self.greatest_forces[shot.phase]
        lengths = np.where(shares > look.LEAST_FORCE, np.maximum(look.FORCE * shares, look.SHORTEST_FORCE), 0.0)
        arrows: FloatArray = lengths * forces / np.maximum(shares, look.LEAST_FORCE) / self.greatest_forces[shot.phase]
        return arrows

    def _name(self, place: FloatArray, text: str, rank: float, force: str = "") -> None:
        x, y = self.seen_at(place).tolist()
        self.labels.append(Label((x, y), text, LOUD_INK if rank else QUIET_INK, rank, force))

    def _draw_ground(self) -> None:
        """Draw what all shots have: a grid of round lengths below."""
        shots = (self.shown.shots[0], self.shown.shots[-1])
        poses = [self.stage.pose(shot.pose_world_object, self._look(shot)) for shot in shots]
        outer = outer_points(self.scene.object)
        lowest = [self.stage.place(pose.transform(outer))[:, 2].min() for pose in poses]
        lowest += [self.stage.place(body)[:, 2].min() for body in self.stage.bodies_world]
        lowest += (self.stage.place(self.stage.points(self._look(shots[-1])))[:, 2] - self.pin).tolist()
        unit = float(from_metres(self.stage.size_m, self.shown.length_unit))
        reach = min(self.stage.radius, 2.0 * self.eye.half) if self.frame else self.stage.radius
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

    def _place_bodies(self, pose: Pose) -> None:
        held, cage = self.scene.object, self.scene.cage
        around, within = self.stage.plays
        self.object_holes = self._holes(held.holes, [pose @ hole.pose_body_shape for hole in held.holes], around)
        self.cage_poses = self._cage_poses()
        self.cage_holes = self._holes(cage.holes, self.cage_poses[len(cage.shapes) :], within)
        reach = look.LARGE * held.reach_m
        self.glass = [body.farthest_m(body.pose_body_shape.position_m) > reach for body in cage.shapes]

    def _draw_bodies(self, pose: Pose, painter: BodyPainter) -> None:
        for part in self.scene.object.parts:
            placed = pose @ part.pose_body_shape
            painter.paint(part, placed, PAINT["object"], self.object_holes)
            painter.edges(part, placed, PAINT["objectEdge"])
        for body, placed, is_glass in zip(self.scene.cage.shapes, self.cage_poses, self.glass, strict=False):
            painter.paint(body, placed, PAINT["cage"], self.cage_holes, is_glass=is_glass)
            painter.edges(body, placed, PAINT["cageEdge"])
        for hole in self.object_holes:
            painter.wall(hole, PAINT["objectWall"], PAINT["objectEdge"])
        for hole in self.cage_holes:
            painter.wall(hole, PAINT["cageWall"], PAINT["cageEdge"])

    def _glaze_bodies(self, painter: BodyPainter) -> None:
        """Paint the faces of the cage's large bodies that are in front, last, far ones first."""
        bodies = [
            (float(self.eye.axes[2] @ placed.position_m), body, placed)
            for body, placed, is_glass in zip(self.scene.cage.shapes, self.cage_poses, self.glass, strict=False)
            if is_glass
        ]
        for _, body, placed in sorted(bodies, key=lambda found: found[0]):
            painter.glaze(body, placed, PAINT["cage"], self.cage_holes, look.GLASS)

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
            counts = kind == "reached" or (kind == "touching" and len(touching) <= look.FEW_NAMES)
            if index not in pressing and (counts or len(names) <= look.FEW_NAMES):
                place = marks[0] if len(marks) else self._middle(index - len(points))
                self._name(place, name, 0.0 if kind == "free" else RANK_OF_TOUCH)

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
        return set(shot.touches.points[forces > look.LEAST_FORCE * self.greatest_forces[shot.phase]].tolist())

    def _draw_touches(self, shot: Shot, pose: Pose) -> None:
        places, forces = self.places(shot), shot.touches.forces_object
        for place, normal in zip(places, shot.touches.normals_object @ pose.rotation.T, strict=True):
            self.marks.rod(place, place + look.NORMAL * self.eye.pixel(place) * normal, look.THIN, PAINT["normal"])
        if forces is None:
            return
        arrows, sizes = self._arrows(shot, pose), np.linalg.norm(forces, axis=1)
        for which, (place, arrow) in enumerate(zip(places, arrows, strict=True)):
            if not arrow.any():
                continue
            tail = place - self.eye.pixel(place) * arrow
            self.marks.arrow(tail, place, look.ROD, PAINT["force"])
            rank = RANK_OF_FORCE + float(sizes[which]) / self.greatest_forces[shot.phase]
            name = self.scene.cage.element_names[shot.touches.points[which]]
            normal = -float(forces[which] @ shot.touches.normals_object[which])
            across = float(np.linalg.norm(forces[which] + normal * shot.touches.normals_object[which]))
            self._name(tail, name, rank, self._force(normal, across, shot.phase))

    def _force(self, normal: float, across: float, phase: int) -> str:
        """Return a force as it stands at its arrow: along the normal and across it, as the command has them."""
        words = force_words(normal, across).removesuffix(" friction")
        return f"{words} N" if force_unit(self.scene, self.scene.loads[phase]) == "N" else words

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
            self._name(end if act.kind == "spring" else start, act.name, RANK_OF_LOAD)

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

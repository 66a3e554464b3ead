"""What a page needs to play a run: plain numbers in drawing coordinates, and words."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from cagepose.files.units import from_metres
from cagepose.files.words import LengthWords, force_notes, force_words
from cagepose.model.box import Box
from cagepose.model.checks import FloatArray
from cagepose.model.hole import Hole
from cagepose.model.pose import Pose
from cagepose.model.shapes import Capsule, Shape, Sphere, Turned
from cagepose.model.wording import duration
from cagepose.runs.cases import contact_friction
from cagepose.runs.changes import Change, changes_of, mode_of
from cagepose.runs.driven_cage import CageAt
from cagepose.runs.load_scaling import force_unit
from cagepose.runs.methods import chosen_method
from cagepose.runs.on_the_way import DRIVEN
from cagepose.runs.run import AT_REST, CONTRADICTED, FAILURES, STOPPED, PhaseRun
from cagepose.studies.acts import Act
from cagepose.studies.comparison import ENDS, same_pose
from cagepose.studies.ending import phase_kind, turned_far
from cagepose.views.drive_words import STOPS, along_drawn, drive_data, how_far, share_words
from cagepose.views.solids import Solid, solid_of
from cagepose.views.viewer import look
from cagepose.views.viewer.gaps import gap_data
from cagepose.views.viewer.playback import Playback, Row, Shot, Touches
from cagepose.views.viewer.stage import EASED_SHARE, EXAGGERATIONS, MOST_ADDED, MOST_WAY, Stage

AMOUNT_DIGITS = 4
"""A list beside a picture is for reading; saved runs have all digits."""
DRAWN_DIGITS = 13
"""Behind the point, of places: a picture may be a millionth of the scene wide, or less."""


def page_data(shown: Playback, stage: Stage | None = None) -> dict[str, Any]:
    """Return the data of a page: only dict, list, str, int, finite float, bool and None. ``stage``: that of the
    playback, if it is there already.

    Lengths are in drawing units (see `Stage`), but for the words and for ``origin``, which is in the scene's own unit.
    Axes, normals, forces and centres are in the object's frame, so that they go along with the object as it is shown.
    """
    return _Writer(shown, stage or Stage(shown)).document()


class _Writer:
    def __init__(self, shown: Playback, stage: Stage) -> None:
        self.shown = shown
        self.run = shown.run
        self.stage = stage
        self.greatest_forces = shown.greatest_forces
        self.usual_friction = chosen_method(self.run.scene, self.run.method).friction(self.run.scene)
        self.words = LengthWords(shown.length_unit, shown.run.scene.size_m)
        self.touches = list(dict.fromkeys(shot.touches for shot in shown.shots))
        self.which = {touches: index for index, touches in enumerate(self.touches)}
        self.cages = list(dict.fromkeys(shot.cage for shot in shown.shots))
        self.which_cage = {cage: index for index, cage in enumerate(self.cages)}

    def document(self) -> dict[str, Any]:
        run, stage = self.run, self.stage
        held = run.scene.object
        return {
            "name": run.scene.name,
            "method": run.method,
            "solve": duration(run.solve_s),
            "contradicted": CONTRADICTED if run.is_contradicted else "",
            "turned": list(turned_far(run)),
            "unit": self.shown.length_unit,
            "unitsPerDrawing": float(from_metres(stage.size_m, self.shown.length_unit)),
            "radius": stage.radius,
            "shotsPerMotion": self.shown.shots_per_motion,
            "mostAdded": MOST_ADDED,
            "mostWay": MOST_WAY,
            "look": look.document(),
            "exaggerations": list(EXAGGERATIONS),
            "ease": EASED_SHARE * self.shown.shots_per_motion,
            "center": _numbers(held.center_of_gravity_m / stage.size_m),
            "reach": stage.reach_m / stage.size_m,
            "names": list(run.scene.cage.element_names),
            "partNames": list(held.element_names),
            "points": [_numbers(point) for point in stage.place(self.shown.points_world)],
            "elementBodies": list(run.scene.cage.element_bodies),
            "cages": [self._cage(cage) for cage in self.cages],
            "gaps": {
                phase.reference: [_numbers(gap / stage.size_m) for gap in stage.gaps_world(phase.reference)]
                for phase in stage.phases
            },
            "clearances": gap_data(self.shown, stage),
            **self._solids(),
            "phases": [
                {
                    **view._asdict(),
                    "name": phase.name,
                    "verdict": phase.verdict,
                    "verdictKind": phase_kind(phase),
                    "isUnstable": phase.proof.stability == "unstable",
                    "note": phase_note(self.shown, phase),
                    "loads": [self._load(act) for act in acts],
                    "greatestForce": self.greatest_forces[index],
                    "forceNotes": force_notes(phase),
                    "forceUnit": force_unit(run.scene, run.scene.loads[index]),
                    "drive": drive_data(run, index, self.shown.length_unit),
                }
                for index, (phase, view, acts) in enumerate(
                    zip(run.phases, stage.phases, self.shown.loads, strict=True)
                )
            ],
            "rows": list(map(self._row, self.shown.rows, changes_of(run))),
            "touches": [self._touch(touches) for touches in self.touches],
            "shots": [self._shot(shot) for shot in self.shown.shots],
            "notes": notes(self.shown),
        }

    def _solids(self) -> dict[str, Any]:
        """The parts and holes of the object in its frame, and the shapes and holes of the cage in the world at the
        start, by the indices of their forms: parts of the same kind and size have the same one.
        """
        scene, forms = self.run.scene, dict[Solid, Shape]()
        solids: dict[str, list[dict[str, Any]]] = {}
        around, within = (plays / self.stage.size_m for plays in self.stage.plays)
        kinds: tuple[tuple[str, Sequence[Shape], Pose | None, FloatArray | None], ...] = (
            ("parts", scene.object.parts, None, None),
            ("holes", scene.object.holes, None, around),
            ("bodies", scene.cage.shapes, scene.cage.pose_world_cage, None),
            ("cageHoles", scene.cage.holes, scene.cage.pose_world_cage, within),
        )
        for key, shapes, pose, plays in kinds:
            solids[key] = []
            for index, shape in enumerate(shapes):
                placed = shape.pose_body_shape if pose is None else pose @ shape.pose_body_shape
                in_object = placed.position_m / self.stage.size_m
                forms.setdefault(solid_of(shape), shape)
                solids[key].append(
                    {
                        "form": list(forms).index(solid_of(shape)),
                        "position": _numbers(in_object if pose is None else self.stage.place(placed.position_m)),
                        "quaternion": _numbers(placed.quaternion_wxyz),
                        **({} if plays is None else {"play": float(plays[index]), **self._mouth(shape, pose is None)}),
                    }
                )
        return {**solids, "forms": [self._form(shape, solid) for solid, shape in forms.items()]}

    def _mouth(self, shape: Shape, is_object: bool) -> dict[str, Any]:
        """Say whether a hole is open below, and which shape it is cut out of, by its index, if that is one."""
        assert isinstance(shape, Hole)
        scene = self.run.scene
        all_parts = scene.object.parts if is_object else scene.cage.shapes
        around = [(index, part) for index, part in enumerate(all_parts) if part.name in shape.in_]
        _, is_open = shape.run_through([part for _, part in around])
        return {"open": is_open, "in": around[0][0] if around and not is_object else None}

    def _form(self, shape: Shape, solid: Solid) -> dict[str, Any]:
        """What is turned about an axis is told by its measures: the page makes a mesh of it as fine as its picture
        needs. All else has the mesh that pictures have.
        """
        size_m = self.stage.size_m
        if isinstance(shape, Turned):
            return {"rims": [[height / size_m, radius / size_m] for height, radius in shape.rims]}
        if isinstance(shape, (Sphere, Capsule)):
            length = shape.length_m if isinstance(shape, Capsule) else 0.0
            return {"radius": shape.radius_m / size_m, "length": length / size_m}
        if isinstance(shape, Box):
            return {"size": _numbers(shape.size_m / size_m)}
        mesh = {"vertices": _rounded(solid.mesh.vertices_m / size_m), "triangles": solid.mesh.triangles.tolist()}
        return {**mesh, "convex": shape.is_convex}

    def _cage(self, cage: CageAt) -> list[dict[str, Any]]:
        """How what stands still, then each body, is displaced from its start."""
        middle = self.stage.middle_world
        return [
            {
                "position": _numbers(self.stage.place(displaced.transform(middle))),
                "quaternion": _numbers(displaced.quaternion_wxyz),
            }
            for displaced in cage.displaced
        ]

    def _shot(self, shot: Shot) -> dict[str, Any]:
        pose = shot.pose_world_object
        return {
            "cage": self.which_cage[shot.cage],
            "share": shot.share,
            "along": along_drawn(self.run, shot.phase, shot.along, self.shown.length_unit),
            "row": shot.row,
            "phase": shot.phase,
            "position": _numbers(self.stage.place(pose.position_m)),
            "quaternion": _numbers(pose.quaternion_wxyz),
            "origin": _numbers(from_metres(pose.position_m, self.shown.length_unit)),
            "angles": [math.degrees(angle) for angle in pose.euler_zyx],
            "touches": self.which[shot.touches],
        }

    def _touch(self, touches: Touches) -> dict[str, Any]:
        forces = touches.forces_object
        return {
            "points": touches.points.tolist(),
            "boxes": list(touches.boxes),
            "normals": _rounded(touches.normals_object),
            "forces": None if forces is None else (forces + 0.0).tolist(),
            "words": None if forces is None else _force_words(touches.normals_object, forces),
            "places": self._places(touches),
            "friction": None if forces is None else [self._friction(*pair) for pair in self._pairs(touches)],
        }

    def _places(self, touches: Touches) -> list[list[float]] | None:
        scene = self.run.scene
        has_points_alone = not (scene.cage.shapes or scene.cage.holes or scene.cage.bodies)
        return None if has_points_alone else _rounded(self.stage.place(touches.places_world))

    def _pairs(self, touches: Touches) -> list[tuple[str, str]]:
        names = self.run.scene.cage.element_names
        return [(names[point], box) for point, box in zip(touches.points.tolist(), touches.boxes, strict=True)]

    def _friction(self, element: str, part: str) -> float:
        """The coefficient of one contact."""
        return contact_friction(self.run.scene, self.usual_friction, element, part)

    def _row(self, row: Row, change: Change) -> dict[str, Any]:
        motion = row.seen
        return {
            "phase": row.phase,
            "rule": mode_of(row.event.rule),
            "motion": "" if motion is None else motion.kind,
            "amount": "" if motion is None else self.words.amount(motion, AMOUNT_DIGITS),
            "drive": f"to {share_words(row.event.share)} of the drive" if row.event.rule == DRIVEN else "",
            "hit": list(row.event.hit),
            "reached": list(change.reached),
            "left": list(change.left),
            "contacts": list(row.event.contacts),
            "verdict": row.verdict,
            "verdictKind": None if row.verdict is None else phase_kind(self.run.phases[row.phase]),
            "first": row.first_shot,
            "last": row.last_shot,
            "line": self._line(row),
        }

    def _line(self, row: Row) -> dict[str, Any] | None:
        if row.seen is None:
            return None
        before = self.shown.shots[row.first_shot - 1].pose_world_object
        through = before.position_m if row.seen.through_world is None else row.seen.through_world
        return {
            "turns": row.seen.through_world is not None,
            "through": _numbers(before.inverse_transform(through) / self.stage.size_m),
            "direction": _numbers(row.seen.line_world @ before.rotation),
        }

    def _load(self, act: Act) -> dict[str, Any]:
        return {
            "kind": act.kind,
            "name": act.name,
            "at": None if act.at_object_m is None else _numbers(act.at_object_m / self.stage.size_m),
            "atWorld": None if act.at_world_m is None else _numbers(self.stage.place(act.at_world_m)),
            "direction": _numbers(act.direction),
            "follows": act.follows,
            "to": None if act.to_world_m is None else _numbers(self.stage.place(act.to_world_m)),
            "body": act.body,
        }


def _force_words(normals: FloatArray, forces: FloatArray) -> list[str]:
    along = -np.einsum("ij,ij->i", forces, normals)
    across = np.linalg.norm(forces + along[:, None] * normals, axis=1)
    return [force_words(*pair) for pair in zip(along.tolist(), across.tolist(), strict=True)]


def phase_note(shown: Playback, phase: PhaseRun) -> str:
    """Return why a phase ended as it did."""
    proof, far = phase.proof, how_far(phase, shown.length_unit)
    if phase.verdict in AT_REST:
        return f"{phase.name}: {phase.verdict}{far} ({proof.stability or 'moves'}): {proof.reason}"
    if phase.verdict in STOPPED:
        return f"{phase.name}: {phase.verdict}{far}: {STOPS[phase.verdict]}"
    where = f" after event {len(shown.rows)}: {_failing(shown)}" if phase.verdict in FAILURES else ""
    return f"{phase.name}: {phase.verdict}{far}{where}"


def notes(shown: Playback) -> list[str]:
    """Return what else a careful viewer should know: how far the object turned, and the run's warnings."""
    turned = [f"It turned far in {told}" for told in turned_far(shown.run)]
    return [*turned, *(f"Warning: {warning}" for warning in shown.run.warnings)]


def _failing(shown: Playback) -> str:
    """Return why the last phase found no end; of a pose that came back, which event had it before."""
    *before, last = (row for row in shown.rows if row.phase == len(shown.run.phases) - 1)
    same = [number for number, row in enumerate(shown.rows, 1) if row in before and _ends_alike(shown, row, last)]
    if shown.run.verdict == "cycling" and same:
        return f"its pose is that of event {same[-1]}, so it would repeat itself for ever"
    return ENDS[shown.run.verdict]


def _ends_alike(shown: Playback, one: Row, other: Row) -> bool:
    return one.event.contacts == other.event.contacts and same_pose(shown.run.scene, one.event, other.event)


def _rounded(values: FloatArray) -> list[list[float]]:
    """To what can be seen at the greatest exaggeration, in a third of the characters."""
    rows: list[list[float]] = (values.round(DRAWN_DIGITS) + 0.0).tolist()
    return rows


def _numbers(values: FloatArray) -> list[float]:
    return [float(value) + 0.0 for value in values]

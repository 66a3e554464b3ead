"""A `Scene` as the data of a scene file, from which the same scene is read again.

In the unit that its lengths were given in, that is to the last bit of each number, but for the angles of parts that
were given as quaternions.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cagepose.files.measures import Measures, plain_number
from cagepose.files.triples import text_of
from cagepose.files.units import LengthUnit
from cagepose.model.box import Box
from cagepose.model.cage import Cage
from cagepose.model.cage_elements import Elements
from cagepose.model.drive import Drive
from cagepose.model.facets import Facets
from cagepose.model.load import Load
from cagepose.model.parts import Object
from cagepose.model.pose import Pose
from cagepose.model.press import Press
from cagepose.model.scene import Scene
from cagepose.model.shapes import Shape
from cagepose.model.surfaces import CONE, PLANE, SPHERE, TORUS, Surface
from cagepose.model.tolerances import GRAZING_BAND_DEFAULT_RAD, TOUCH_DEFAULT

MOST_DECIMALS = 15
"""An angle in degrees is written with so many decimals."""

FULL_TURNS = ((0.0, 0.0, 0.0), (360.0, 0.0, 0.0), (0.0, 0.0, 360.0), (360.0, 0.0, 360.0))
"""The same angles as people may have written them, 240 for -120 deg: sines and cosines differ in their last digits."""


def scene_document(scene: Scene, length_unit: LengthUnit = "mm") -> dict[str, Any]:
    """Return what a scene file with lengths in ``length_unit`` would hold: only dict, list, str, int, float and bool.

    Poses have angles if these give the same quaternion again, else the quaternion. What was left out of a scene is left
    out, but for names and poses. The ranges of adjustable numbers stay as they are.
    """
    return SceneWriter(length_unit, scene.friction_of).document(scene)


def pose_angles(pose: Pose) -> list[float] | None:
    """Return yaw, pitch and roll in degrees, with few decimals, that give the very same pose; None: there are none."""
    angles = [math.degrees(angle) for angle in pose.euler_zyx]
    for decimals, around in product(range(MOST_DECIMALS + 1), FULL_TURNS):
        rounded = [round(angle + turn, decimals) for angle, turn in zip(angles, around, strict=True)]
        again = Pose(euler_zyx=[math.radians(angle) for angle in rounded])
        if np.array_equal(again.quaternion_wxyz, pose.quaternion_wxyz):
            return [plain_number(angle) for angle in rounded]
    return None


class SceneWriter(Measures):
    """Writes a scene, or parts of one, with lengths in a unit; what has its own friction says so beside its shape."""

    def __init__(self, unit: LengthUnit, friction_of: Mapping[str, float] | None = None) -> None:
        super().__init__(unit)
        self.unit: LengthUnit = unit
        self.friction_of = dict(friction_of or {})

    def document(self, scene: Scene) -> dict[str, Any]:
        found: dict[str, Any] = {"name": scene.name, "units": {"length": self.unit}}
        found["object"] = self.object(scene.object)
        found["cage"] = self.cage(scene.cage)
        found["loads"] = [self.load(load) for load in scene.loads]
        friction = {"coefficient": scene.friction_coefficient, "of": self.friction_of or None}
        if given := _given(friction):
            found["friction"] = given
        found |= _given({"method": scene.method, "metric": scene.metric, "planar": scene.planar})
        touch, band_rad = scene.tolerances.touch, scene.tolerances.grazing_band_rad
        if touch != TOUCH_DEFAULT or band_rad != GRAZING_BAND_DEFAULT_RAD:
            found["tolerances"] = {"touch": touch, "grazing_band_deg": self.angle(band_rad)}
        if scene.adjustable:
            found["adjustable"] = {
                entry.name: {"key": entry.key, "range": [entry.low, entry.high]} for entry in scene.adjustable
            }
        if scene.left_out:
            found["left_out"] = list(scene.left_out)
        return found

    def object(self, held: Object) -> dict[str, Any]:
        found = self.parts(held.part_paths, (*held.parts, *held.holes))
        is_centroid = "_union_moments" in vars(held) and np.array_equal(
            held._union_moments.centroid_m, held.center_of_gravity_m
        )
        if not is_centroid:
            found["center_of_gravity"] = self.lengths(held.center_of_gravity_m)
        if held.mass_kg is not None:
            found["mass"] = plain_number(held.mass_kg)
        if held.inertia_kg_m2 is not None:
            found["inertia"] = [[self.inertia(value) for value in row] for row in held.inertia_kg_m2.tolist()]
        found["pose"] = self.pose(held.pose_world_object)
        return found

    def cage(self, cage: Cage) -> dict[str, Any]:
        found = self.elements(cage.standing, "")
        if cage.bodies:
            found["bodies"] = {
                body.name: {**self.elements(body.own, f"{body.name}/"), "pose": self.pose(body.pose_cage_body)}
                for body in cage.bodies
            }
        found["pose"] = self.pose(cage.pose_world_cage)
        return found

    def elements(self, elements: Elements, prefix: str) -> dict[str, Any]:
        """Return the points and shapes of a cage or a body; names that begin with ``prefix`` and say no more than which
        point it is are left out.
        """
        found: dict[str, Any] = {}
        points = [self.lengths(point) for point in elements.points_m]
        if elements.names == tuple(f"{prefix}C{index + 1}" for index in range(len(points))):
            found |= {"points": points} if points else {}
        else:
            found["points"] = dict(zip(elements.names, points, strict=True))
        paths = (*elements.shape_paths, *elements.hole_paths)
        return found | self.parts(paths, (*elements.shapes, *elements.holes))

    def parts(self, paths: Sequence[tuple[Any, ...]], parts: Sequence[Shape]) -> dict[str, Any]:
        """Return boxes and shapes in the lists and the order in which they were given; holes stand among shapes."""
        listed = sorted(zip(paths, parts, strict=True), key=lambda given: given[0][:2])
        shapes = [self.shape(part) for key in ("shapes", "holes") for path, part in listed if path[0] == key]
        boxes = [self.box(part) for path, part in listed if path[0] == "boxes" and isinstance(part, Box)]
        return _given({"boxes": boxes or None, "shapes": shapes or None})

    def box(self, box: Box) -> dict[str, Any]:
        return {"name": box.name, "size": self.lengths(box.size_m), **self.pose(box.pose_object_box, turn=False)}

    def shape(self, shape: Shape) -> dict[str, Any]:
        found: dict[str, Any] = {"name": shape.name, shape.kind: self.numbers(shape)}
        found |= self.pose(shape.pose_body_shape, turn=False)
        coefficient = self.friction_of.pop(str(shape.name), None)
        return found | _given({"friction": coefficient})

    def surface(self, surface: Surface) -> dict[str, Any]:
        """Return the numbers of a surface that triangles stand for."""
        point, axis = self.lengths(surface.point_m), _plain_list(surface.axis)
        if surface.kind == PLANE:
            return {"point": point, "normal": axis}
        hollow = {"hollow": True} if surface.radius_m < 0.0 else {}
        radius = self.length(abs(surface.radius_m))
        if surface.kind == SPHERE:
            return {"center": point, "radius": radius, **hollow}
        if surface.kind == TORUS:
            return {"center": point, "axis": axis, "radius": self.length(surface.core_m), "tube": radius, **hollow}
        slope = {"slope": plain_number(surface.slope)} if surface.kind == CONE else {}
        return {"point": point, "axis": axis, "radius": radius, **slope, **hollow}

    def numbers(self, shape: Shape) -> dict[str, Any]:
        """Return the numbers that make a shape."""
        if not isinstance(shape, Facets):
            return self.of(shape)
        found: dict[str, Any] = {
            "vertices": text_of([self.lengths(vertex) for vertex in shape.vertices_m]),
            "triangles": text_of(shape.triangles.tolist()),
            "flat": self.length(shape.flat_m),
        }
        if shape.surfaces:
            found["surfaces"] = [{surface.kind: self.surface(surface)} for surface in shape.surfaces]
            found["on"] = " ".join(str(index) for index in shape.on.tolist())
        return found

    def pose(self, pose: Pose, *, turn: bool = True) -> dict[str, Any]:
        """Return where something is and how it is turned; ``turn``: even if it is not."""
        found: dict[str, Any] = {"position": self.lengths(pose.position_m)}
        angles = pose_angles(pose)
        if angles is None and not turn:
            angles = [math.degrees(angle) for angle in pose.euler_zyx]  # parts have no quaternion in a file
        if angles is None:
            found["quat_wxyz"] = pose.quaternion_wxyz.tolist()
        elif turn or any(angles):
            found["euler_zyx_deg"] = angles
        return found

    def load(self, load: Load) -> dict[str, Any]:
        gravity = None if load.gravity_world is None else _plain_list(load.gravity_world)
        return _given(
            {
                "name": load.name,
                "gravity": gravity,
                "force": None if load.force is None else self.of(load.force),
                "forces": [self.of(force) for force in load.forces] or None,
                "moments": [self.of(moment) for moment in load.moments] or None,
                "springs": [self.of(spring) for spring in load.springs] or None,
                "drive": {name: self.legs(legs) for name, legs in load.drive.items()} or None,
                "stop_at": self.limit(load),
                "press": {name: self.press(press) for name, press in load.press.items()} or None,
            }
        )

    def press(self, press: Press) -> dict[str, Any]:
        found = self.of(press)
        if press.stiffness_n_per_m == 0.0:
            return {"along": found["along"], "force": found["force"]}
        return {"along": found["along"], "spring": {"stiffness": found["stiffness"], "preload": found["force"]}}

    def legs(self, legs: Sequence[Drive]) -> dict[str, Any] | list[dict[str, Any]]:
        found = [self.leg(leg) for leg in legs]
        return found[0] if len(found) == 1 else found

    def leg(self, leg: Drive) -> dict[str, Any]:
        found: dict[str, Any] = {} if leg.travel_m is None else {"travel": self.lengths(leg.travel_m)}
        if leg.about_cage is not None and leg.through_cage_m is not None and leg.angle_rad is not None:
            found["turn"] = {
                "about": _plain_list(leg.about_cage),
                "through": self.lengths(leg.through_cage_m),
                "angle_deg": self.angle(leg.angle_rad),
            }
        return found

    def limit(self, load: Load) -> dict[str, Any] | None:
        if load.stop_at is None:
            return None
        return {"moment": self.length(load.stop_at)} if load.stops_at_moment else {"force": plain_number(load.stop_at)}


def _plain_list(values: ArrayLike) -> list[float]:
    return [plain_number(value) for value in np.asarray(values, dtype=np.float64).tolist()]


def _given(keys: dict[str, Any]) -> dict[str, Any]:
    """Leave out what is None."""
    return {key: value for key, value in keys.items() if value is not None}

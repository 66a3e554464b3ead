"""From a checked scene file to the model: lengths to metres, angles to radians, and the problems that it finds."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, ParamSpec, TypeVar

import numpy as np

from cagepose.errors import Key, Problem, SceneError, key_path
from cagepose.files.build_loads import load_of
from cagepose.files.measures import made
from cagepose.files.points_file import PointsTable
from cagepose.files.schema import BoxModel, SceneModel
from cagepose.files.schema_base import PoseModel
from cagepose.files.schema_cage import CageBodyModel
from cagepose.files.schema_shapes import CoefficientModel, FacetsModel, MeshModel, ShapeModel
from cagepose.files.schema_surfaces import SurfaceModel
from cagepose.files.triples import triples, whole_numbers, whole_triples
from cagepose.files.units import LengthUnit, to_metres
from cagepose.model.box import Box
from cagepose.model.cage import Cage
from cagepose.model.cage_body import CageBody
from cagepose.model.facets import Facets
from cagepose.model.hole import Hole
from cagepose.model.naming import place_of
from cagepose.model.parts import Object
from cagepose.model.pose import Pose
from cagepose.model.scene import Adjustable, Scene
from cagepose.model.scope import unknown_shapes
from cagepose.model.shapes import Capsule, Cone, Convex, Cylinder, Disc, Shape, Sphere
from cagepose.model.surfaces import CONE, CYLINDER, PLANE, SPHERE, TORUS, Surface, three
from cagepose.model.tolerances import GRAZING_BAND_DEFAULT_RAD, TOUCH_DEFAULT, Tolerances

if TYPE_CHECKING:
    from cagepose.files.meshes.mesh_shapes import MeshShapes

Noun = TypeVar("Noun")
Given = ParamSpec("Given")

Body = tuple[Key, ...]
"""Where a body stands in a scene file: ``("object",)``, ``("cage",)`` or ``("cage", "bodies", "mate")``."""
SHAPES: dict[str, type[Shape]] = {kind.kind: kind for kind in (Sphere, Capsule, Cylinder, Cone, Convex, Disc, Hole)}
"""By the key that says what a shape is; a box names its pose otherwise, and facets stand in texts."""
CURRENT = Path()
"""The folder that names of files start from where there is no scene file."""


class Built(NamedTuple):
    """A scene, and what of its meshes is not in it as it is in their files, in sentences."""

    scene: Scene
    notes: tuple[str, ...]


def build_scene(
    model: SceneModel, table: PointsTable | None, folder: Path = CURRENT, *, is_whole: bool = True
) -> Built:
    """Make the scene that ``model`` describes; ``table`` holds the points if they stand in a file of their own, and
    ``folder`` its meshes. Not ``is_whole``: parts are missing, so that only each part that is there is checked.

    Raises
    ------
    SceneError
        All that the model found wrong, with paths from the root of the scene file.
    """
    builder = Builder(model.units.length if model.units else "mm", folder)
    held = builder.make(("object",), builder.object, model)
    cage = builder.make(("cage",), builder.cage, model, table)
    loads = [builder.make(("loads", index), load_of, load, builder.unit) for index, load in enumerate(model.loads)]
    tolerances = builder.make(("tolerances",), builder.tolerances, model)
    friction_of = builder.friction_of(model, held, cage) if held is not None and cage is not None else {}
    builder.check_adjustable(model)
    if builder.problems or held is None or cage is None or tolerances is None or not is_whole:
        raise SceneError(builder.problems)
    scene = Scene(
        held,
        cage,
        [load for load in loads if load is not None],
        name=model.name,
        friction_coefficient=_coefficient(model.friction),
        friction_of=friction_of,
        method=model.method,
        metric=model.metric,
        planar=model.planar,
        tolerances=tolerances,
        adjustable=[
            Adjustable(name, entry.key, entry.range[0], entry.range[1])
            for name, entry in (model.adjustable or {}).items()
        ],
        left_out=model.left_out or (),
    )
    if unknown := unknown_shapes(scene):
        raise SceneError(unknown)  # here, where each has its line in the file
    return Built(scene, tuple(dict.fromkeys(builder.notes)))


class Builder:
    """Makes parts of a scene whose file has lengths in one unit, and notes what is wrong with them.

    Attributes
    ----------
    problems, notes
        What is wrong, and what of meshes is left out.
    pieces
        Names of what meshes are, by body and index.
    """

    def __init__(self, unit: LengthUnit, folder: Path) -> None:
        self.unit: LengthUnit = unit
        self.folder = folder
        self.problems: list[Problem] = []
        self.notes: list[str] = []
        self.pieces: dict[tuple[Body, int], list[str]] = {}

    def make(
        self, prefix: tuple[Key, ...], maker: Callable[Given, Noun], *args: Given.args, **kwargs: Given.kwargs
    ) -> Noun | None:
        """Return what ``maker`` makes, or collect its problems as seen from ``prefix``."""
        try:
            return maker(*args, **kwargs)
        except SceneError as error:
            self.problems.extend(error.under(*prefix).problems)
            return None

    def object(self, model: SceneModel) -> Object | None:
        part = model.object
        boxes = [self.make(("object", "boxes", index), self.box, box) for index, box in enumerate(part.boxes or [])]
        shapes = self.shapes(("object",), part.shapes or [])
        pose = self.make(("object", "pose"), self.pose, part.pose)
        if None in boxes or None in shapes:
            return None
        metres_per_unit = float(to_metres(1.0, self.unit))
        return Object(
            [box for box in boxes if box is not None],
            None if part.center_of_gravity is None else to_metres(part.center_of_gravity, self.unit),
            shapes=[shape for shape in shapes if shape is not None],
            pose=pose,
            mass_kg=part.mass,
            inertia_kg_m2=None if part.inertia is None else np.array(part.inertia) * metres_per_unit**2,
        )

    def box(self, model: BoxModel) -> Box:
        return Box(to_metres(model.size, self.unit), self.shape_pose(model), model.name)

    def shapes(self, body: Body, models: list[ShapeModel]) -> list[Shape | None]:
        """Return the shapes of a body, which stands at a path. Of a mesh that is several, all but the first stand last,
        so that numbers of others stay where their keys say.
        """
        first: list[Shape | None] = []
        others: list[Shape] = []
        for index, model in enumerate(models):
            place: tuple[Key, ...] = (*body, "shapes", index, *model.kinds_given())
            if model.mesh is None:
                first.append(self.make(place, self.shape, model))
            elif (found := self.make(place, self.mesh, model, mesh_name(body, index, model))) is None:
                first.append(None)
            else:
                self.pieces[body, index] = [str(piece.name) for piece in found if not isinstance(piece, Hole)]
                first.append(found[0])
                others += found[1:]
        meshes = {
            mesh_name(body, index, models[index]): names for (of, index), names in self.pieces.items() if of == body
        }
        return [
            shape.cut_out_of([piece for name in shape.in_ for piece in meshes.get(name, [name])])
            if isinstance(shape, Hole)
            else shape
            for shape in (*first, *others)
        ]

    def shape(self, model: ShapeModel) -> Shape:
        pose, (kind,) = self.shape_pose(model), model.kinds_given()
        if model.facets is not None:
            return self.facets(model.facets, pose, model.name)
        if model.box is not None:
            return made(Box, model.box, self.unit, pose_object_box=pose, name=model.name)
        return made(SHAPES[kind], getattr(model, kind), self.unit, pose_body_shape=pose, name=model.name)

    def facets(self, model: FacetsModel, pose: Pose, name: str | None) -> Facets:
        vertices = to_metres(triples(model.vertices, "vertices"), self.unit)
        flat_m = None if model.flat is None else self.length(model.flat)
        triangles = whole_triples(model.triangles, "triangles")
        surfaces = [self.surface(surface) for surface in model.surfaces or ()]
        return Facets(vertices, triangles, flat_m, pose, name, surfaces, whole_numbers(model.on or "", "on"))

    def surface(self, model: SurfaceModel) -> Surface:
        if model.plane is not None:
            return Surface(PLANE, three(to_metres(model.plane.point, self.unit)), three(model.plane.normal))
        if model.sphere is not None:
            radius_m = (-1.0 if model.sphere.hollow else 1.0) * self.length(model.sphere.radius)
            return Surface(SPHERE, three(to_metres(model.sphere.center, self.unit)), (0.0, 0.0, 0.0), radius_m)
        if model.torus is not None:
            tube_m, core_m = self.length(model.torus.tube), self.length(model.torus.radius)
            point, axis = three(to_metres(model.torus.center, self.unit)), three(model.torus.axis)
            return Surface(TORUS, point, axis, -tube_m if model.torus.hollow else tube_m, core_m=core_m)
        side = model.cone or model.cylinder
        assert side is not None, "the schema lets no surface pass that has no kind"
        radius_m = (-1.0 if side.hollow else 1.0) * self.length(side.radius)
        kind, slope = (CYLINDER, 0.0) if model.cone is None else (CONE, model.cone.slope)
        return Surface(kind, three(to_metres(side.point, self.unit)), three(side.axis), radius_m, slope)

    def mesh(self, model: ShapeModel, name: str) -> list[Shape]:
        """Return what a mesh is, in its body's frame."""
        assert model.mesh is not None
        path = self.folder / model.mesh.file
        try:
            found = self.body_in_file(path, model.mesh, name)
        except SceneError as error:
            raise SceneError([Problem(("file",), f"{path} {error.problems[0].message}")]) from None
        self.notes += found.notes
        pose = self.shape_pose(model)
        return [shape.moved(pose @ shape.pose_body_shape) for shape in found.shapes]

    def body_in_file(self, path: Path, model: MeshModel, name: str) -> MeshShapes:
        from cagepose.files.meshes.mesh_file import read_mesh  # 50 modules, which most scenes do not need
        from cagepose.files.step import step_file

        if path.suffix.lower() not in step_file.SUFFIXES:
            if model.solid is not None:
                raise SceneError(
                    [Problem((), "has no solids to choose from, being no STEP file; remove the key solid")]
                )
            return read_mesh(path, model.unit, self.unit, name)
        if model.unit is not None:
            raise SceneError([Problem((), "says its unit itself, as STEP files do; remove the key unit")])
        return step_file.read_step_shapes(path, model.solid, name, fillets=model.fillets)

    def shape_pose(self, model: BoxModel | ShapeModel) -> Pose:
        return Pose(to_metres(model.position or [0.0, 0.0, 0.0], self.unit), euler_zyx=_radians(model.euler_zyx_deg))

    def length(self, length: float) -> float:
        return float(to_metres(length, self.unit))

    def pose(self, model: PoseModel | None) -> Pose:
        if model is None:
            return Pose()
        position = to_metres(model.position or [0.0, 0.0, 0.0], self.unit)
        return Pose(position, model.quat_wxyz, euler_zyx=_radians(model.euler_zyx_deg))

    def cage(self, model: SceneModel, table: PointsTable | None) -> Cage | None:
        points, names = point_rows(model, table)
        shapes = self.shapes(("cage",), model.cage.shapes or [])
        bodies = [
            self.make(("cage", "bodies", name), self.cage_body, name, body)
            for name, body in (model.cage.bodies or {}).items()
        ]
        if None in shapes or None in bodies:
            return None
        return Cage(
            to_metres(points, self.unit),
            names,
            self.pose(model.cage.pose),
            [shape for shape in shapes if shape is not None],
            bodies=[body for body in bodies if body is not None],
        )

    def cage_body(self, name: str, model: CageBodyModel) -> CageBody | None:
        shapes = self.shapes(("cage", "bodies", name), model.shapes or [])
        if None in shapes:
            return None
        given = model.points or []
        points, names = (list(given.values()), tuple(given)) if isinstance(given, dict) else (given, None)
        return CageBody(
            name,
            to_metres(points, self.unit),
            names,
            self.pose(model.pose),
            [shape for shape in shapes if shape is not None],
        )

    def friction_of(self, model: SceneModel, held: Object, cage: Cage) -> dict[str, float]:
        """Return the coefficients of all that have their own, by name; those of shapes stand beside them."""
        found = dict((model.friction and model.friction.of) or {})
        in_object = dict(zip(map(place_of, held.part_paths), held.element_names, strict=True))
        in_cage = dict(zip(map(place_of, cage.shape_paths), cage.element_names[len(cage.names) :], strict=True))
        shared = set(in_object.values()) & set(cage.element_names)
        bodies: list[tuple[Body, list[ShapeModel] | None]] = [
            (("object",), model.object.shapes),
            (("cage",), model.cage.shapes),
            *((("cage", "bodies", name), body.shapes) for name, body in (model.cage.bodies or {}).items()),
        ]
        for body, shapes in bodies:
            names = in_object if body == ("object",) else in_cage
            for index, shape in enumerate(shapes or []):
                if (coefficient := _coefficient(shape.friction)) is None:
                    continue
                place = (*body, "shapes", index, "friction")
                for name in self.pieces.get((body, index), [names[*body[1:], "shapes", index]]):
                    if name in shared:
                        found_twice = (
                            f"is that of {name!r}, a name in the cage and in the object; rename one of the two"
                        )
                        self.problems.append(Problem(place, found_twice))
                    elif name in found:
                        self.problems.append(Problem(place, f"stands in friction.of.{name}, too; keep one of the two"))
                    else:
                        found[name] = coefficient
        return found

    def check_adjustable(self, model: SceneModel) -> None:
        """Note numbers that would move one piece of a mesh alone."""
        several = [
            f"{key_path(body)}.shapes[{index}]." for (body, index), names in self.pieces.items() if len(names) > 1
        ]
        for name, entry in (model.adjustable or {}).items():
            if entry.key.startswith(tuple(several)):
                message = "points into a mesh that is several shapes, which do not move together; move its body instead"
                self.problems.append(Problem(("adjustable", name, "key"), message))

    def tolerances(self, model: SceneModel) -> Tolerances:
        given = model.tolerances
        touch = TOUCH_DEFAULT if given is None or given.touch is None else given.touch
        band_deg = None if given is None else given.grazing_band_deg
        return Tolerances(touch, GRAZING_BAND_DEFAULT_RAD if band_deg is None else math.radians(band_deg))


def mesh_name(body: Body, index: int, model: ShapeModel) -> str:
    """Return the name that the pieces of a mesh begin with."""
    of_body = f"{body[2]}/" if len(body) == 3 else ""
    return model.name or f"{of_body}mesh{index + 1}"


def point_rows(model: SceneModel, table: PointsTable | None) -> tuple[list[list[float]], tuple[str, ...] | None]:
    """Return the points in the file's unit and their names (None: the default ones)."""
    points = model.cage.points
    if table is not None:
        return table.points, table.names
    if isinstance(points, dict):
        return list(points.values()), tuple(points)
    return (points, None) if isinstance(points, list) else ([], None)


def _radians(angles_deg: list[float] | None) -> list[float] | None:
    return None if angles_deg is None else [math.radians(angle) for angle in angles_deg]


def _coefficient(friction: CoefficientModel | float | None) -> float | None:
    if not isinstance(friction, CoefficientModel):
        return friction
    if friction.angle_deg is not None:
        return math.tan(math.radians(friction.angle_deg))
    return friction.coefficient

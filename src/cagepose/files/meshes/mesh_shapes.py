"""A body of triangles as shapes: what it is made of is recognised, else cut, else decomposed with its error stated.

Round holes are found first and filled. What is left is cut along its faces until all pieces are convex, and each piece
is a box, a cylinder, a cone, a ball or a capsule if it stands for one. What has too many hollow edges for that, as a
fillet has, is decomposed by coacd.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from cagepose.files.meshes.convex_shapes import Recognised
from cagepose.files.meshes.cuts import separate
from cagepose.files.meshes.decomposed import Decomposition
from cagepose.files.meshes.edges import is_hollow_and_round
from cagepose.files.meshes.manifolds import Triangles, without_rounding
from cagepose.files.meshes.pieces import convex_pieces, parts_of, simplified
from cagepose.files.meshes.round_holes import RoundHole, filled
from cagepose.files.meshes.tolerances import ROUNDING_OF_MESH
from cagepose.files.progress import tell
from cagepose.model.box import Box
from cagepose.model.checks import FloatArray
from cagepose.model.hole import Chamfer, Hole
from cagepose.model.pose import Pose
from cagepose.model.shapes import Capsule, Cone, Convex, Cylinder, Shape, Sphere

DIGITS_OF_SIZE = 11
"""Numbers are written with so many digits of the size. What follows is the rounding of double precision."""

Decompose = Callable[[Triangles], Decomposition]


class MeshShapes(NamedTuple):
    """Shapes that are a body together; lengths in the unit of the mesh.

    Attributes
    ----------
    shapes
        Convex ones, then holes in them; each named, "NAME", or "NAME/1" and "NAME/hole 1" where there are several.
    error
        By how much the mesh is off from them at most.
    notes
        What is not in them as it is in the mesh, in sentences.
    """

    shapes: tuple[Shape, ...]
    error: float
    notes: tuple[str, ...]


def mesh_shapes(mesh: Triangles, name: str, unit: str, decompose: Decompose) -> MeshShapes:
    """Return the shapes of a closed body.

    Parameters
    ----------
    mesh
        Its surface, not inside out.
    name
        Of its shapes.
    unit
        Of its lengths, for what is said.
    decompose
        Makes convex parts of what cannot be cut.
    """
    middle = (mesh.vertices.max(axis=0) + mesh.vertices.min(axis=0)) / 2.0
    scale = 2.0 ** float(np.frexp(mesh.size)[1])
    body = without_rounding(Triangles((mesh.vertices - middle) / scale, mesh.faces).body())
    found: list[Recognised] = []
    holes: list[RoundHole] = []
    notes: list[str] = []
    errors: list[float] = []
    is_filleted = False
    for part in separate(body):
        tell(f"{name!r}: {part.num_tri():,} triangles, its shape recognised")
        simple, tolerance = simplified(part)
        if tolerance > 0.0:
            off = _words(scale * tolerance, unit)
            notes.append(f"{name!r} has too many triangles: here, simplified, up to {off} off")
        whole, of_part = filled(simple)
        is_filleted |= is_hollow_and_round(Triangles.of(whole), ROUNDING_OF_MESH * Triangles.of(whole).size)
        pieces = convex_pieces(whole, [one.hole for one in of_part])
        if pieces is not None:
            found += pieces.found
            if pieces.error > 0.0:
                off = _words(scale * pieces.error, unit)
                notes.append(f"{name!r} would be too many convex parts: here, simplified, up to {off} off")
            errors.append(tolerance + pieces.error)
        else:
            made = decompose(Triangles.of(whole))
            off = _words(scale * made.error, unit)
            notes.append(f"{name!r} is not convex: here, {len(made.parts)} convex parts, up to {off} off")
            if whole.genus() > 0:
                notes.append(
                    f"{name!r} has {whole.genus()} openings that are not round with flat ends, which such parts hold"
                    " badly: fill those that matter in the mesh and give them as `hole`"
                )
            found += [Recognised(Convex(corners), made.error) for corners in made.parts]
            errors.append(tolerance)
        holes += of_part
    of_shapes = max([*(one.error for one in found), *(one.error for one in holes)])
    error = scale * (of_shapes + max(errors))
    if of_shapes > 0.0 and not notes:
        notes.append(f"{name!r} has flat sides where it is round here, up to {_words(error, unit)} off")
    if is_filleted and len(found) > 1:
        notes.append(
            f"{name!r} is hollow and round somewhere, as in a fillet, which makes many parts of it: here, {len(found)};"
            " leave fillets that do not matter out in CAD"
        )
    names = [name] if len(found) == 1 else [f"{name}/{index + 1}" for index in range(len(found))]
    pieces_named = [one.shape.renamed(each) for one, each in zip(found, names, strict=True)]
    cuts = [_in_pieces(one.hole, pieces_named, f"{name}/hole {k + 1}") for k, one in enumerate(holes)]
    shapes = [tidied(shape, scale, middle) for shape in (*pieces_named, *cuts)]
    return MeshShapes(tuple(shapes), error, tuple(notes))


def tidied(shape: Shape, scale: float, origin: FloatArray) -> Shape:
    """Return a shape with its lengths times ``scale``, moved to ``origin``, and no digits that are rounding alone."""
    size = scale * shape.farthest_m(shape.nodes_body().mean(axis=0)) + float(np.abs(origin).max())
    decimals = DIGITS_OF_SIZE - math.floor(math.log10(size))

    def lengths(values: Any) -> Any:
        return np.round(scale * np.asarray(values), decimals) + 0.0

    place = shape.pose_body_shape
    pose = Pose(lengths(place.position_m + origin / scale), np.round(place.quaternion_wxyz, DIGITS_OF_SIZE + 1))
    if isinstance(shape, Box):
        return Box(lengths(shape.size_m), pose, shape.name)
    if isinstance(shape, Convex):
        return Convex(lengths(shape.vertices_m + origin / scale), float(lengths(shape.radius_m)), None, shape.name)
    numbers: dict[str, Any] = {key: float(lengths(value)) for key, value in vars(shape).items() if key.endswith("_m")}
    if isinstance(shape, Hole):
        chamfer = shape.chamfer and Chamfer(float(lengths(shape.chamfer.width_m)), shape.chamfer.angle_rad)
        return Hole(**numbers, chamfer=chamfer, in_=shape.in_, pose_body_shape=pose, name=shape.name)
    assert isinstance(shape, Sphere | Capsule | Cylinder | Cone)
    return type(shape)(**numbers, pose_body_shape=pose, name=shape.name)


def _in_pieces(hole: Hole, pieces: Sequence[Shape], name: str) -> Hole:
    """Return a hole with its name and those of the pieces that it is cut out of."""
    return hole.cut_out_of([str(piece.name) for piece in parts_of(hole, pieces)]).renamed(name)


def _words(length: float, unit: str) -> str:
    return f"{length:.2g} {unit}"

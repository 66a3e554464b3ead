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

from cagepose.files.meshes.convex_shapes import Recognised, convex_shape
from cagepose.files.meshes.cuts import cut_above, cut_until, is_convex, separate
from cagepose.files.meshes.decomposed import Decomposition, farthest_from
from cagepose.files.meshes.edges import is_hollow_and_round
from cagepose.files.meshes.manifolds import ROUNDING, Triangles, without_rounding
from cagepose.files.meshes.round_holes import RoundHole, filled
from cagepose.files.progress import tell
from cagepose.model.box import Box
from cagepose.model.checks import FloatArray
from cagepose.model.hole import Chamfer, Hole
from cagepose.model.pose import Pose
from cagepose.model.shapes import Capsule, Cone, Convex, Cylinder, Shape, Sphere
from cagepose.model.surface import shape_mesh

MOST_CORNERS = 300
"""Of a convex shape: the time of runs grows with the square of it."""
MOST_TRIANGLES = 10_000
"""Of a body that is not convex: more of them are simplified first."""
FIRST = 1e-5
"""Of the size: by how much triangles are moved first."""
HALVINGS = 4
"""Of the last such step, for a convex body: as many of its corners as may be should stay."""
HOLLOW = 0.97
"""Of its hull's volume: what is round has more."""
DIGITS = 11
"""Of the size that numbers are written with; what follows is the rounding of double precision."""
SEGMENTS = 64
"""Chords of what is round, where it is asked whether a hole is in a piece."""
LEAST_SHARED = 1e-6
"""Of a hole's volume: what is less of a piece is rounding."""

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
    errors = [0.0]
    is_filleted = False
    for part in separate(body):
        tell(f"{name!r}: {part.num_tri():,} triangles, its shape recognised")
        simple, tolerance = _simplified(part)
        if tolerance > 0.0:
            notes.append(
                f"{name!r} has too many triangles: here, simplified, up to {_words(scale * tolerance, unit)} off"
            )
            errors.append(tolerance)
        whole, of_part = filled(simple)
        is_filleted |= is_hollow_and_round(Triangles.of(whole), ROUNDING * Triangles.of(whole).size)
        pieces = cut_until(_cut_at_steps(whole, of_part), _recognised)
        if pieces is None:
            made = decompose(Triangles.of(whole))
            off = _words(scale * made.error, unit)
            notes.append(f"{name!r} is not convex: here, {len(made.parts)} convex parts, up to {off} off")
            if whole.genus() > 0:
                notes.append(
                    f"{name!r} has {whole.genus()} openings that are not round with flat ends, which such parts hold"
                    " badly: fill those that matter in the mesh and give them as `hole`"
                )
            found += [Recognised(Convex(corners), made.error) for corners in made.parts]
        else:
            found += pieces
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
    bored = {name for cut in cuts for name in cut.in_}  # points of a cage see no holes in boxes
    pieces_named = [_as_convex(piece) if piece.name in bored else piece for piece in pieces_named]
    shapes = [tidied(shape, scale, middle) for shape in (*pieces_named, *cuts)]
    return MeshShapes(tuple(shapes), error, tuple(notes))


def tidied(shape: Shape, scale: float, origin: FloatArray) -> Shape:
    """Return a shape with its lengths times ``scale``, moved to ``origin``, and no digits that are rounding alone."""
    size = scale * shape.farthest_m(shape.nodes_body().mean(axis=0)) + float(np.abs(origin).max())
    decimals = DIGITS - math.floor(math.log10(size))

    def lengths(values: Any) -> Any:
        return np.round(scale * np.asarray(values), decimals) + 0.0

    place = shape.pose_body_shape
    pose = Pose(lengths(place.position_m + origin / scale), np.round(place.quaternion_wxyz, DIGITS + 1))
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


def _cut_at_steps(whole: Any, holes: Sequence[RoundHole]) -> list[Any]:
    """Return a filled body, cut where a hole ends at the bottom of a wider one."""
    parts = [whole]
    for hole, _ in holes:
        others = [other for other, _ in holes if other is not hole and other.radius_m > hole.radius_m]
        axis = hole.pose_body_shape.rotation[:, 2]
        for end in hole.nodes_body():
            if any(_is_at_bottom(end, other) for other in others):
                parts = [side for part in parts for side in cut_above(part, axis, float(axis @ end))]
    return parts


def _is_at_bottom(point: FloatArray, hole: Hole) -> bool:
    x, y, z = hole.pose_body_shape.inverse_transform(point).tolist()
    return math.hypot(x, y) < hole.radius_m and abs(z + hole.depth_m) < 1e-4 * hole.radius_m


def _simplified(body: Any) -> tuple[Any, float]:
    """Return a body that is not convex with fewer triangles, where it has too many, and how far they are moved."""
    if body.num_tri() <= MOST_TRIANGLES or is_convex(body):
        return body, 0.0
    tolerance, moved = FIRST, 0.0
    while body.num_tri() > MOST_TRIANGLES:
        body, moved = body.simplify(tolerance), moved + tolerance
        tolerance *= 2.0
    return body, moved


def _recognised(piece: Any) -> Recognised | None:
    """Return the shape of a convex piece, with fewer corners where it has too many; None: it is not convex.

    Triangles between the corners of a cone may be a little hollow.
    """
    hull = piece.hull()
    is_full = is_convex(piece)
    if not is_full and piece.volume() < HOLLOW * hull.volume():
        return None
    surface = without_rounding(hull) if is_full else piece
    found = convex_shape(Triangles.of(surface))
    if found is not None or not is_full:
        return found
    if surface.num_vert() <= MOST_CORNERS:
        return Recognised(Convex(Triangles.of(surface).vertices), 0.0)
    fewer = Triangles.of(_with_fewer_corners(surface).hull())
    return Recognised(Convex(fewer.vertices), farthest_from(Triangles.of(surface), fewer))


def _with_fewer_corners(body: Any) -> Any:
    """Return a body with as many corners as are allowed, and not many fewer."""
    found, tolerance = body.simplify(FIRST), FIRST
    while found.num_vert() > MOST_CORNERS:
        body, tolerance = found, 2.0 * tolerance
        found = body.simplify(tolerance)
    few, many = tolerance, tolerance / 2.0
    for _ in range(HALVINGS):
        middle = (few + many) / 2.0
        simple = body.simplify(middle)
        if simple.num_vert() <= MOST_CORNERS:
            found, few = simple, middle
        else:
            many = middle
    return found


def _as_convex(shape: Shape) -> Shape:
    return Convex(shape.nodes_body(), 0.0, None, shape.name) if isinstance(shape, Box) else shape


def _in_pieces(hole: Hole, pieces: Sequence[Shape], name: str) -> Hole:
    """Return a hole with its name and those of the pieces that it is cut out of."""
    plug = _body(hole)
    least = LEAST_SHARED * plug.volume()
    in_ = [str(piece.name) for piece in pieces if (plug ^ _body(piece)).volume() > least]
    return hole.cut_out_of(in_).renamed(name)


def _body(shape: Shape) -> Any:
    mesh = shape_mesh(shape, SEGMENTS)
    return Triangles(mesh.vertices_m, mesh.triangles).body()


def _words(length: float, unit: str) -> str:
    return f"{length:.2g} {unit}"

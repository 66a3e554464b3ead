"""A body of triangles as shapes: what it is made of is recognised, and what is none of our shapes stays flat facets.

Round holes are found first and filled. What is left is a box, a cylinder, a cone, a ball, a bar or a convex hull, or a
few of these, if a few cuts along its faces say so. All else is one shape of facets, with the round holes in it; and
where these are no holes of ours, as their mouths are in what is round, they are facets, too.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from cagepose.files.meshes.convex_shapes import Recognised
from cagepose.files.meshes.cuts import separate
from cagepose.files.meshes.facets import facets_of, is_coarse, round_error
from cagepose.files.meshes.manifolds import Triangles, manifold3d, without_rounding
from cagepose.files.meshes.pieces import known_pieces, parts_of
from cagepose.files.meshes.round_holes import RoundHole, filled
from cagepose.files.progress import tell
from cagepose.model.box import Box
from cagepose.model.checks import FloatArray, ProblemList
from cagepose.model.facets import Facets
from cagepose.model.hole import Chamfer, Hole, check_holes
from cagepose.model.pose import Pose
from cagepose.model.shapes import Capsule, Cone, Convex, Cylinder, Shape, Sphere

DIGITS_OF_SIZE = 11
"""Numbers are written with so many digits of the size. What follows is the rounding of double precision."""


class MeshShapes(NamedTuple):
    """Shapes that are a body together; lengths in the unit of the mesh.

    Attributes
    ----------
    shapes
        Solid ones, then holes in them; each named, "NAME", or "NAME/1" and "NAME/hole 1" where there are several.
    error
        By how much the mesh is off from them at most.
    notes
        What is not in them as it is in the mesh, or what is round there, in sentences.
    """

    shapes: tuple[Shape, ...]
    error: float
    notes: tuple[str, ...]


class _Part(NamedTuple):
    """The shapes of what hangs together, and by how much facets of it are within what they may stand for."""

    found: list[Recognised]
    holes: list[RoundHole]
    within: float


def mesh_shapes(mesh: Triangles, name: str, unit: str) -> MeshShapes:
    """Return the shapes of a closed body.

    Parameters
    ----------
    mesh
        Its surface, not inside out.
    name
        Of its shapes.
    unit
        Of its lengths, for what is said.
    """
    found = _shapes(mesh, name, unit, facets=True)
    assert found is not None, "what is not known is facets"
    return found


def known_shapes(mesh: Triangles, name: str, unit: str) -> MeshShapes | None:
    """As `mesh_shapes`; None: it would have facets."""
    return _shapes(mesh, name, unit, facets=False)


def _shapes(mesh: Triangles, name: str, unit: str, *, facets: bool) -> MeshShapes | None:
    middle = (mesh.vertices.max(axis=0) + mesh.vertices.min(axis=0)) / 2.0
    scale = 2.0 ** float(np.frexp(mesh.size)[1])
    body = without_rounding(Triangles((mesh.vertices - middle) / scale, mesh.faces).body())
    parts = []
    for part in separate(body):
        tell(f"{name!r}: {part.num_tri():,} triangles, its shape recognised")
        made = _shapes_of(part, is_coarse(mesh), facets=facets)
        if made is None:
            return None
        parts.append(made)
    found, holes = [one for part in parts for one in part.found], [one for part in parts for one in part.holes]
    error = scale * max([*(one.error for one in found), *(one.error for one in holes)])
    notes = []
    if error > 0.0:
        notes.append(f"{name!r} has flat sides where it is round here, up to {_words(error, unit)} off")
    n_facets = sum(len(one.shape.triangles) for one in found if isinstance(one.shape, Facets))
    n_facets += sum(len(hull.faces) for hull in _hulls_of(found) if round_error(hull) > 0.0)
    within = scale * max(part.within for part in parts)
    if within > 0.0:
        off = f"where these stand for what is round, they are about {_words(within, unit)} off"
        notes.append(f"{name!r} has {n_facets:,} flat facets here, as in the mesh; {off}")
    names = [name] if len(found) == 1 else [f"{name}/{index + 1}" for index in range(len(found))]
    named = [one.shape.renamed(each) for one, each in zip(found, names, strict=True)]
    cuts = [_in_pieces(one.hole, named, f"{name}/hole {k + 1}") for k, one in enumerate(holes)]
    shapes = [tidied(shape, scale, middle) for shape in (*named, *cuts)]
    return MeshShapes(tuple(shapes), error, tuple(notes))


def _shapes_of(part: Any, coarse: bool, *, facets: bool) -> _Part | None:
    """Return the shapes of a body that hangs together; None, where there are to be no ``facets``: it needs some."""
    whole, holes = filled(part)
    pieces = known_pieces(whole, [one.hole for one in holes])
    if pieces is not None and _are_in(holes, [one.shape for one in pieces]):
        return _Part(pieces, holes, max((round_error(hull) for hull in _hulls_of(pieces)), default=0.0))
    if not facets:
        return None
    if holes:
        filled_in = facets_of(Triangles.of(whole), coarse=coarse)
        if _are_in(holes, [filled_in]):
            return _Part([Recognised(filled_in, 0.0)], holes, round_error(Triangles.of(whole)))
    return _Part([Recognised(facets_of(Triangles.of(part), coarse=coarse), 0.0)], [], round_error(Triangles.of(part)))


def _hulls_of(found: Sequence[Recognised]) -> list[Triangles]:
    """Return the surfaces of those shapes that are sharp hulls."""
    sharp = [one.shape for one in found if isinstance(one.shape, Convex) and one.shape.radius_m == 0.0]
    return [Triangles.of(manifold3d().Manifold.hull_points(shape.vertices_m)) for shape in sharp]


def _are_in(holes: Sequence[RoundHole], shapes: Sequence[Shape]) -> bool:
    """Whether holes can be cut out of shapes: their mouths are on faces, and no side of a shape runs along them."""
    named = [shape.renamed(f"{index}") for index, shape in enumerate(shapes)]
    cuts = [_in_pieces(one.hole, named, f"hole {index}") for index, one in enumerate(holes)]
    problems = ProblemList()
    check_holes(cuts, [(cut.name or "",) for cut in cuts], named, problems)
    if problems.problems or not all(cut.in_ for cut in cuts):
        return False
    around = [[shape for shape in named if shape.name in cut.in_] for cut in cuts]
    return not any(cut.leaves_sideways(these) or cut.divided_by(these) for cut, these in zip(cuts, around, strict=True))


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
    if isinstance(shape, Facets):
        surfaces = [surface.changed(scale, Pose(origin)) for surface in shape.surfaces]
        corners, flat_m = lengths(shape.vertices_m + origin / scale), scale * shape.flat_m
        return Facets(corners, shape.triangles, flat_m, None, shape.name, surfaces, shape.on)
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

"""Convex polyhedra that a body is the union of, as kernels take them, and the planes of their faces."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from cagepose.kernels.algebra.record import FloatArray, IntArray, Rows
from cagepose.kernels.algebra.vector import Vector, cross, dot, minus, norm, row, scaled, vector_from
from cagepose.kernels.native.kernel import entry, kernel

NO_PLANE = -1


class Piece:
    """A convex polyhedron; a record.

    Attributes
    ----------
    part
        Index of the part that it belongs to.
    first_vertex, last_vertex, first_edge, last_edge, first_face, last_face
        Its rows, the last one not included.
    low, high
        Of its bounds, metres.
    """

    part: int
    first_vertex: int
    last_vertex: int
    first_edge: int
    last_edge: int
    first_face: int
    last_face: int
    low: Annotated[FloatArray, 3]
    high: Annotated[FloatArray, 3]


class PieceEdge:
    """An edge of a piece; a record: the vertices at its ends, and the faces to its left and right as seen from outside
    on the way from the start to the end.
    """

    start: int
    end: int
    left: int
    right: int


class PieceFace:
    """A face of a piece; a record.

    Attributes
    ----------
    piece
        Whose face it is.
    normal
        Unit outward normal.
    middle
        A place on its plane, the mean of its corners, metres.
    reach
        Greatest distance of a corner from there, metres.
    first_corner, last_corner
        Its rows of `Pieces.corners`, the last one not included.
    plane, side
        The plane that it lies on, and 1.0 or -1.0: whether its normal is that plane's or the opposite one; written by
        `find_planes`.
    """

    piece: int
    normal: Annotated[FloatArray, 3]
    middle: Annotated[FloatArray, 3]
    reach: float
    first_corner: int
    last_corner: int
    plane: int
    side: float


class Plane:
    """A plane that faces of pieces lie on, flush or back to back; a record.

    Attributes
    ----------
    normal
        Unit normal, that of the largest of these faces.
    middle
        The middle of that face, metres.
    offset
        normal . middle, metres.
    """

    normal: Annotated[FloatArray, 3]
    middle: Annotated[FloatArray, 3]
    offset: float


class Pieces(NamedTuple):
    """Pieces of one body, in its frame: near its origin, as offsets of planes are measured from there.

    Attributes
    ----------
    vertices
        (n_vertices, 3), metres.
    corners
        Indices of vertices around each face, counter-clockwise as seen from outside.
    """

    pieces: Rows[Piece]
    vertices: FloatArray
    edges: Rows[PieceEdge]
    faces: Rows[PieceFace]
    corners: IntArray


@entry
def find_planes(order: IntArray, touch_m: float, tilt_rad: float, pieces: Pieces, planes: Rows[Plane]) -> int:
    """Write the planes of all faces, and on which of them each face lies; return how many there are.

    A face lies on the plane of an earlier one in ``order`` if it makes an angle of at most ``tilt_rad`` with it, and
    each of its corners is within ``touch_m`` of it, but for what the angle itself makes of the way between the two
    faces. Two faces of one piece have planes of their own. ``planes`` has room for one of each face.
    """
    for f in range(len(pieces.faces)):
        pieces.faces[f].plane = NO_PLANE
    n_planes = 0
    for k in range(len(order)):
        face = pieces.faces[order[k]]
        for p in range(n_planes):
            if _is_on(face, planes[p], touch_m, tilt_rad, pieces) and not _has_plane(face.piece, p, pieces):
                is_along = dot(vector_from(face.normal), vector_from(planes[p].normal)) > 0.0
                face.plane, face.side = p, 1.0 if is_along else -1.0
                break
        if face.plane == NO_PLANE:
            face.plane, face.side = n_planes, 1.0
            _write_plane(face, planes[n_planes])
            n_planes += 1
    return n_planes


@kernel
def _is_on(face: PieceFace, plane: Plane, touch_m: float, tilt_rad: float, pieces: Pieces) -> bool:
    normal, middle = vector_from(plane.normal), vector_from(plane.middle)
    tilt = norm(cross(vector_from(face.normal), normal))
    if tilt > tilt_rad:
        return False
    for c in range(face.first_corner, face.last_corner):
        way = minus(row(pieces.vertices, pieces.corners[c]), middle)
        if abs(dot(way, normal)) > touch_m + tilt * norm(way):
            return False
    return True


@kernel
def _has_plane(k: int, plane: int, pieces: Pieces) -> bool:
    """Whether a face of piece ``k`` was found to lie on a plane."""
    piece, has_plane = pieces.pieces[k], False
    for f in range(piece.first_face, piece.last_face):
        has_plane = has_plane or pieces.faces[f].plane == plane
    return has_plane


@kernel
def _write_plane(face: PieceFace, plane: Plane) -> None:
    for k in range(3):
        plane.normal[k], plane.middle[k] = face.normal[k], face.middle[k]
    plane.offset = dot(vector_from(face.normal), vector_from(face.middle))


@kernel
def outward(face: PieceFace, planes: Rows[Plane]) -> Vector:
    """Return the outward normal of a face, as its plane has it."""
    return scaled(vector_from(planes[face.plane].normal), face.side)


@kernel
def height_over(face: PieceFace, place: Vector, planes: Rows[Plane]) -> float:
    """Return how far a place is outside of a face's plane, metres."""
    plane = planes[face.plane]
    return face.side * (dot(vector_from(plane.normal), place) - plane.offset)


@kernel
def are_within_reach(one: Piece, other: Piece, touch_m: float) -> bool:
    """Whether the bounds of two pieces meet, or nearly so."""
    is_near = True
    for k in range(3):
        is_near = is_near and one.low[k] <= other.high[k] + touch_m and other.low[k] <= one.high[k] + touch_m
    return is_near

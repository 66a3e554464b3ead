"""Bodies as boundaries: the features that kernels take, and the trees around them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import pairwise

import numpy as np

from cagepose.kernels.boundary.features import FACE, HALF_SPACE, LINE, VERTEX, Boundary
from cagepose.model.boundary.blocks import NOWHERE, Block, Row, block_of, pierced
from cagepose.model.boundary.convex_pieces import ConvexPiece, piece_of_box, piece_of_hull
from cagepose.model.boundary.covers import united
from cagepose.model.boundary.exact_surface import exact_block
from cagepose.model.boundary.joined_surfaces import joined_surface, surface_groups
from cagepose.model.boundary.packed import nothing, packed
from cagepose.model.boundary.pieces_apart import boundary_apart
from cagepose.model.boundary.turned_rows import circle_row, disc_row, side_row, tip_row
from cagepose.model.boundary.union import union_of
from cagepose.model.boundary.union_block import union_block
from cagepose.model.box import Box
from cagepose.model.checks import FloatArray, unit_rows
from cagepose.model.facets import Facets
from cagepose.model.hole import Hole
from cagepose.model.hull import Hull, hull_of
from cagepose.model.pose import Pose
from cagepose.model.shapes import Convex, Disc, Rounded, Shape, Turned

AROUND = 50.0
"""A hole that stands alone is one in a square plate: so many times its own size to each side."""


def boundary_of(parts: Iterable[Shape | FloatArray], touch_m: float) -> Boundary:
    """Return the boundary of a body in its frame; a single point (3,) is a part, too. A body may have no parts.

    Of polyhedra it is that of their union: what lies inside another one is no feature, and a seam between flush faces
    is no edge. Round parts and holes have all of their features, and these have covers.

    Parameters
    ----------
    parts
        Those of the body.
    touch_m
        What is this close is at one place, metres.
    """
    every = list(parts)
    if not every:
        return nothing()
    solids = [part for part in every if isinstance(part, Shape) and not isinstance(part, Hole)]
    holes = [part for part in every if isinstance(part, Hole)]
    blocks, polyhedra, pieces = list[Block](), dict[int, Shape](), dict[int, ConvexPiece]()
    for number, part in enumerate(every):
        if isinstance(part, Hole):
            within = [solid for solid in solids if solid.name in part.in_]
            own = frozenset(other for other, solid in enumerate(every) if any(solid is each for each in within))
            blocks.append(block_of(_hole_rows(part, within, number), own))
            if not within:
                plate = block_of(_rows_of(_plate_of(part), number), frozenset())
                blocks.append(pierced(plate, part, frozenset((number,))))
        elif isinstance(part, Facets):
            polyhedra[number] = part
        elif isinstance(part, Shape) and (piece := _piece_of(part, number)) is not None:
            polyhedra[number], pieces[number] = part, piece
        else:
            blocks.append(_lone_block(_Placed(_key_of(part), part, None, number)))
    for group in surface_groups(polyhedra, touch_m):
        members = sorted(group)
        alone = polyhedra[members[0]]
        if len(members) == 1 and isinstance(alone, Facets) and alone.surfaces:
            blocks.append(exact_block(alone, members[0]))
            del polyhedra[members[0]]
            continue
        blocks.append(
            union_block(joined_surface([polyhedra.pop(number) for number in members], members, touch_m), group)
        )
    for group in united(polyhedra, holes, touch_m):
        members = sorted(group)
        if len(members) == 1:
            part = polyhedra[members[0]]
            blocks.append(_lone_block(_Placed(_key_of(part), part, pieces[members[0]], members[0])))
        else:
            blocks.append(union_block(union_of([pieces[number] for number in members], touch_m), group))
    return packed([_with_holes(block, every, holes) for block in blocks], every, touch_m)


@dataclass(frozen=True)
class _Placed:
    """A part that is no hole, as a convex piece if it is a sharp polyhedron, its number, and its form and place, by
    which it is known again.
    """

    key: tuple[object, ...]
    part: Shape | FloatArray = field(compare=False)
    piece: ConvexPiece | None = field(compare=False)
    number: int


def _key_of(part: Shape | FloatArray) -> tuple[object, ...]:
    return (part.tobytes(),) if isinstance(part, np.ndarray) else (*part.form, *part.pose_body_shape.key)


@lru_cache(maxsize=256)
def _lone_block(placed: _Placed) -> Block:
    """Return the features of a part that is united with no other. Those of the last ones are remembered: what changes
    from scene to scene of a study is few of its parts.
    """
    own = frozenset((placed.number,))
    if placed.piece is None:
        return block_of(_rows_of(placed.part, placed.number), own)
    return union_block(boundary_apart([placed.piece]), own)


def _with_holes(block: Block, parts: Sequence[Shape | FloatArray], holes: Sequence[Hole]) -> Block:
    """Return features of some parts without what holes cut out of these."""
    owners = ((number, parts[number]) for number in np.unique(block.features["part"]).tolist())
    names = {number: part.name for number, part in owners if isinstance(part, Shape) and not isinstance(part, Hole)}
    for hole in holes if names else ():
        opened = frozenset(number for number, name in names.items() if name in hole.in_)
        if opened:
            block = pierced(block, hole, opened)
    return block


def is_flat_sided(part: Shape) -> bool:
    """Whether a part is joined with others of its body where they meet: a box, a sharp hull, or facets."""
    return isinstance(part, Facets) or _piece_of(part, 0) is not None


def _piece_of(part: Shape | FloatArray, number: int) -> ConvexPiece | None:
    """Return a sharp polyhedron as a piece of a union; None: the part is none."""
    if isinstance(part, Box):
        return piece_of_box(part, number)
    if isinstance(part, Convex) and part.radius_m == 0.0 and len(part.hull.faces) > 3:
        return piece_of_hull(part.hull, part.pose_body_shape, number)
    return None


def _row(
    kind: int,
    part: int,
    point: FloatArray,
    direction: FloatArray,
    toward: FloatArray,
    length: float,
    radius: float,
    bounds: list[tuple[int, FloatArray, FloatArray, float]],
    least: float,
    corners: FloatArray,
) -> Row:
    """Return a straight feature, blown up by a radius."""
    box = np.stack([corners.min(axis=0) - radius, corners.max(axis=0) + radius])
    numbers = (length, radius, 0.0, 0.0, 0.0, 0.0, 0.0)
    return Row(kind, part, point, direction, toward, *numbers, bounds, least, box)


def _rows_of(part: Shape | FloatArray, number: int) -> list[Row]:
    if isinstance(part, np.ndarray):
        return [_row(VERTEX, number, part, NOWHERE, NOWHERE, 0.0, 0.0, [], np.inf, part[None])]
    if isinstance(part, Box):
        return _hull_rows(hull_of(part.corners_object()), Pose(), 0.0, number)
    if isinstance(part, Rounded):
        hull = part.hull if isinstance(part, Convex) else hull_of(part.core())
        return _hull_rows(hull, part.pose_body_shape, part.radius_m, number)
    if isinstance(part, Turned):
        return _turned_rows(part, number)
    raise TypeError(f"no boundary is known of a {part.kind}")


def _turned_rows(part: Turned, number: int) -> list[Row]:
    """Return the features of what is turned about an axis: flat ends, their circles, and the side between them."""
    pose, (low, wide), (high, narrow) = part.pose_body_shape, part.rims[0], part.rims[-1]
    slant = math.atan2(wide - narrow, high - low) if high > low else 0.0
    rows = []
    for height, radius, out in ((low, wide, -1.0), (high, narrow, 1.0)):
        lowest_rad = slant * out
        if radius == 0.0:
            rows.append(tip_row(pose, height, out, slant, max(wide, narrow), number))
            continue
        if isinstance(part, Disc):
            lowest_rad = -0.5 * math.pi
        rows.append(disc_row(pose, height, radius, out, number))
        if not isinstance(part, Disc) or out > 0.0:
            rows.append(circle_row(pose, height, radius, out, (lowest_rad, 0.5 * math.pi), number))
    if not isinstance(part, Disc):
        rows.append(side_row(pose, (low, wide), (high, narrow), number))
    return rows


def _hole_rows(hole: Hole, solids: Sequence[Shape], number: int) -> list[Row]:
    """Return the features of a hole: its walls, the circles between them, and its bottom."""
    pose = hole.pose_body_shape
    depth, is_open = hole.run_through(solids)
    heights = [(-depth, hole.radius_m), *hole.rims[1:]]
    rows = [side_row(pose, (low, -radius), (high, -wide), number) for (low, radius), (high, wide) in pairwise(heights)]
    slants = [math.atan2(wide - radius, high - low) for (low, radius), (high, wide) in pairwise(heights)]
    for index, (height, radius) in enumerate(heights[1:]):
        above = math.pi - slants[index + 1] if index + 1 < len(slants) else 0.5 * math.pi
        rows.append(circle_row(pose, height, radius, 1.0, (above, math.pi - slants[index]), number))
    if is_open:
        rows.append(circle_row(pose, -depth, hole.radius_m, -1.0, (0.5 * math.pi, math.pi), number))
    else:
        rows.append(disc_row(pose, -depth, hole.radius_m, 1.0, number))
    return rows


def _plate_of(hole: Hole) -> Box:
    """Return the plate that a hole which stands alone is in."""
    wide = max(radius for _, radius in hole.rims)
    depth, _ = hole.run_through([])
    side = 2.0 * AROUND * (wide + depth)
    return Box((side, side, depth), hole.pose_body_shape @ Pose((0.0, 0.0, -0.5 * depth)))


def _hull_rows(hull: Hull, pose: Pose, radius_m: float, number: int) -> list[Row]:
    """Return the features of a hull, blown up by a radius."""
    vertices = pose.transform(hull.vertices_m)
    normals = hull.normals @ pose.rotation.T
    starts, ends = vertices[hull.edges[:, 0]], vertices[hull.edges[:, 1]]
    lengths = np.linalg.norm(ends - starts, axis=1)
    along = (ends - starts) / lengths[:, None]
    rows = []

    def add(
        kind: int,
        point: FloatArray,
        direction: FloatArray,
        length: float,
        bounds: Sequence[tuple[FloatArray, float]],
        least: float,
        corners: FloatArray,
    ) -> None:
        spaces = [(HALF_SPACE, across, NOWHERE, size) for across, size in bounds]
        rows.append(_row(kind, number, point, direction, NOWHERE, length, radius_m, spaces, least, corners))

    for index, vertex in enumerate(vertices):
        begins, ending = hull.edges[:, 0] == index, hull.edges[:, 1] == index
        away = [(direction, 0.0) for direction in (*along[begins], *-along[ending])]
        add(VERTEX, vertex, NOWHERE, 0.0, away, lengths[begins | ending].min(initial=np.inf), vertex[None])
    outward = [_outward_across(vertices[list(face)], normal) for face, normal in zip(hull.faces, normals, strict=True)]
    of_edge: dict[tuple[int, int], list[tuple[FloatArray, float]]] = {}
    for face, across in zip(hull.faces, outward, strict=True):
        for one, other, direction in zip(face, (*face[1:], face[0]), across, strict=True):
            of_edge.setdefault((min(one, other), max(one, other)), []).append((-direction, 0.0))
    for index, pair in enumerate(hull.edges.tolist()):
        inward, ended = of_edge.get((min(pair), max(pair)), []), vertices[pair]
        add(LINE, starts[index], along[index], float(lengths[index]), inward, float(lengths[index]), ended)
    for face, normal, across in zip(hull.faces, normals, outward, strict=True):
        corners = vertices[list(face)]
        center = corners.mean(axis=0)
        sides = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1)
        bounds = [
            (direction, float(direction @ (corner - center))) for direction, corner in zip(across, corners, strict=True)
        ]
        add(FACE, center, normal, 0.0, bounds, float(sides.min()), corners)
    return rows


def _outward_across(corners: FloatArray, normal: FloatArray) -> FloatArray:
    """Return the unit vectors out of a face across its sides, of which each begins at a corner."""
    return unit_rows(np.cross(np.roll(corners, -1, axis=0) - corners, normal))

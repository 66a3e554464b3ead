"""What is to be run: one scene, or many that differ in numbers. A scene by itself is a case of one."""

from __future__ import annotations

from typing import NamedTuple

from cagepose.kernels.algebra.pose import Quaternion, matrix_from_quaternion, rotated
from cagepose.kernels.algebra.record import FloatArray, Rows
from cagepose.kernels.algebra.tolerances import KernelTolerances, scaled_tolerances
from cagepose.kernels.algebra.vector import (
    Vector,
    matrix_product,
    minus,
    norm,
    plus,
    row,
    scaled,
    times,
    vector_from,
)
from cagepose.kernels.boundary.features import (
    Bodies,
    Boundary,
    body_of,
    number_of_bodies,
    place_boundary,
    place_turned,
)
from cagepose.kernels.boundary.geometry import Geometry, PlacedCage, Placement, cage_at, deepest_overlap, held_at
from cagepose.kernels.boundary.refit import refit_vertices
from cagepose.kernels.contact.friction import Friction, friction_of
from cagepose.kernels.contact.loads import PhaseLoad
from cagepose.kernels.contact.metric import Body
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.outcome.drives import Drives


class Part(NamedTuple):
    """The object, the same in all cases.

    Attributes
    ----------
    boundary
        That of all its parts, its own boxes first, as seen from the centre of gravity.
    half_sizes, box_positions, box_rotations, n_own_boxes
        Its boxes, likewise seen, for the paper's method: as in `cagepose.kernels.collision.boxes`.
    body
        Its inertia.
    center_object
        Centre of gravity in the object's own frame, metres.
    """

    boundary: Boundary
    half_sizes: FloatArray
    box_positions: FloatArray
    box_rotations: FloatArray
    n_own_boxes: int
    body: Body
    center_object: Vector


class Cases(NamedTuple):
    """What differs from case to case: each array has one row for each case, or one for all.

    Attributes
    ----------
    cage_positions, cage_quaternions
        The cage's pose in the world, (n, 3) metres and (n, 4).
    points_cage
        (n, n_points, 3), metres.
    bodies_cage
        Those of the cage: first what stands still, its points first, in the cage's frame; the same for all but for
        where single points are.
    displaced
        How each of these bodies is displaced from its place there, the same for all: position and quaternion,
        (n_bodies, 7), in the cage's frame.
    drives
        How they are driven, the same for all.
    object_positions, object_quaternions
        The object's pose in the world at the start.
    sizes_m
        The scene's size, (n,).
    frictions
        Coefficient of friction of the scene, (n,).
    point_frictions, box_frictions
        Those of single cage points and boxes, (n_points,) and (n_boxes,), the same for all; NaN: none.
    actions
        What acts in each phase, (n, n_phases, n_actions); see `PhaseLoad`.
    tolerances
        For a scene of size 1; the same for all.
    """

    cage_positions: FloatArray
    cage_quaternions: FloatArray
    points_cage: FloatArray
    bodies_cage: Bodies
    displaced: FloatArray
    drives: Drives
    object_positions: FloatArray
    object_quaternions: FloatArray
    sizes_m: FloatArray
    frictions: FloatArray
    point_frictions: FloatArray
    box_frictions: FloatArray
    actions: Rows[Rows[PhaseLoad]]
    tolerances: KernelTolerances


class Start(NamedTuple):
    """One case, ready to be run. Cage and object are each seen from a middle of their own, so that neither a cage far
    from the world's origin nor an object drawn far from its own costs digits.

    Attributes
    ----------
    geometry
        The cage as seen from its middle, the object from the centre of gravity.
    position, quaternion
        Of the centre of gravity, seen from the middle of the cage, and the object's orientation.
    origin_world
        That middle.
    size_m, friction, tolerances, actions
        Those of the case.
    """

    geometry: Geometry
    position: Vector
    quaternion: Quaternion
    origin_world: Vector
    size_m: float
    friction: Friction
    tolerances: KernelTolerances
    actions: Rows[PhaseLoad]


@kernel
def row_of(n_rows: int, case: int) -> int:
    """Return the row of a case in an array with one row for each case, or one for all."""
    return case if n_rows > 1 else 0


@kernel
def quaternion_row(quaternions: FloatArray, index: int) -> Quaternion:
    q = quaternions[index]
    return (q[0], q[1], q[2], q[3])


@kernel
def displacement_of(cases: Cases, geometry: Geometry, body: int) -> tuple[Vector, Quaternion]:
    """Return how a body of the cage is displaced, as seen from the cage's middle."""
    still, displaced = geometry.placed.poses[0], cases.displaced[body]
    turned = (row(still, 1), row(still, 2), row(still, 3))
    axis = times(turned, (displaced[4], displaced[5], displaced[6]))
    quaternion = (displaced[3], axis[0], axis[1], axis[2])
    origin, moved = row(still, 0), times(turned, vector_from(displaced))
    return plus(moved, minus(origin, rotated(quaternion, origin))), quaternion


@kernel
def start_of(case: int, part: Part, cases: Cases, cage: PlacedCage) -> Start:
    """Return how a case starts; its cage is written into ``cage``, each body at its place."""
    points = cases.points_cage[row_of(len(cases.points_cage), case)]
    turned = quaternion_row(cases.cage_quaternions, row_of(len(cases.cage_quaternions), case))
    parts, n_points = cases.bodies_cage.own.parts, len(points)
    # the origin of what follows is the middle of all elements of the cage that stand still
    middle, n_still = (0.0, 0.0, 0.0), 0
    for which in range(len(parts)):
        if parts[which].body == 0:
            place = row(points, which) if which < n_points else vector_from(parts[which].middle)
            middle, n_still = plus(middle, place), n_still + 1
    middle = scaled(middle, 1.0 / max(n_still, 1))
    # points, or the boundary, turned about it
    for point in range(len(cage.points_world)):
        placed = rotated(turned, minus(row(points, point), middle))
        for k in range(3):
            cage.points_world[point, k] = placed[k]
    bodies = Bodies(own_boundary(cases.bodies_cage, points, cage), cases.bodies_cage.first_nodes)
    place_boundary(body_of(bodies, cage.placing, 0), scaled(rotated(turned, middle), -1.0), turned)
    # the object beside it
    cage_position = row(cases.cage_positions, row_of(len(cases.cage_positions), case))
    origin = plus(cage_position, rotated(turned, middle))
    position = row(cases.object_positions, row_of(len(cases.object_positions), case))
    quaternion = quaternion_row(cases.object_quaternions, row_of(len(cases.object_quaternions), case))
    size_m = cases.sizes_m[row_of(len(cases.sizes_m), case)]
    tolerances = scaled_tolerances(cases.tolerances, size_m)
    geometry = Geometry(part.boundary, bodies, cage.placing, tolerances.touch_m)
    for body in range(1, number_of_bodies(bodies)):
        place_displaced(geometry, body, *displacement_of(cases, geometry, body))
    return Start(
        geometry,
        plus(minus(position, origin), rotated(quaternion, part.center_object)),
        quaternion,
        origin,
        size_m,
        friction_of(cases.frictions[row_of(len(cases.frictions), case)], cases.point_frictions, cases.box_frictions),
        tolerances,
        cases.actions[row_of(len(cases.actions), case)],
    )


@kernel
def place_displaced(geometry: Geometry, body: int, position: Vector, quaternion: Quaternion) -> None:
    """Place a body of the cage, displaced from where it would be if it stood as what stands still does."""
    still = geometry.placed.poses[0]
    rotation = matrix_product(matrix_from_quaternion(quaternion), (row(still, 1), row(still, 2), row(still, 3)))
    place_turned(cage_at(geometry, body), plus(position, rotated(quaternion, row(still, 0))), rotation)


@kernel
def own_boundary(bodies: Bodies, points: FloatArray, cage: PlacedCage) -> Boundary:
    """Return the boundary of cages whose single points are elsewhere, (n_points, 3), metres."""
    boundary = bodies.own
    for i in range(len(boundary.features)):
        cage.features[i] = boundary.features[i]  # type: ignore[index]
    for i in range(len(boundary.parts)):
        cage.parts[i] = boundary.parts[i]  # type: ignore[index]
    for i in range(len(boundary.nodes)):
        cage.nodes[i] = boundary.nodes[i]  # type: ignore[index]
    own = Boundary(
        cage.parts,
        cage.features,
        boundary.bounds,
        boundary.covers,
        boundary.cover_list,
        cage.nodes,
        boundary.planes,
    )
    is_elsewhere = False
    for point in range(len(points)):
        feature = own.features[own.parts[point].point]
        for k in range(3):
            is_elsewhere = is_elsewhere or feature.point[k] != points[point, k]
            feature.point[k] = own.parts[point].middle[k] = points[point, k]
    for body in range(number_of_bodies(bodies) if is_elsewhere else 0):
        nodes = cage.nodes[bodies.first_nodes[body] : bodies.first_nodes[body + 1]]
        refit_vertices(nodes, own.features)
    return own


@kernel
def is_valid(start: Start, farthest: float, points_vary: bool, placement: Placement, cage: PlacedCage) -> bool:
    """Whether the object starts within ``farthest`` sizes of the cage, nothing of it is inside it, and no two points
    that vary are one. The placement is scratch.
    """
    if norm(start.position) > farthest * start.size_m:
        return False
    place_boundary(held_at(start.geometry, placement), start.position, start.quaternion)
    if deepest_overlap(start.geometry, placement, cage.overlap).feature >= 0:
        return False
    return not points_vary or are_single(start.geometry, start.tolerances.touch_m)


@kernel
def are_single(geometry: Geometry, touch_m: float) -> bool:
    """Whether no two single points of a boundary are one."""
    parts = geometry.cage.own.parts
    for point in range(len(parts)):
        for other in range(point if parts[point].point >= 0 else 0):
            away = norm(minus(vector_from(parts[other].middle), vector_from(parts[point].middle)))
            if parts[other].point >= 0 and parts[other].body == parts[point].body and away <= touch_m:
                return False
    return True


@kernel
def object_position(start: Start, part: Part, position: Vector, quaternion: Quaternion) -> Vector:
    """Return where the object's own origin is in the world, its centre of gravity being at ``position``."""
    return plus(start.origin_world, minus(position, rotated(quaternion, part.center_object)))

"""How far contacts stray from their faces on a screw: it leaves curved constraints by the square of its length."""

from __future__ import annotations

from cagepose.kernels.algebra.pose import Quaternion, matrix_from_quaternion, rotated
from cagepose.kernels.algebra.vector import Vector, dot, minus, row
from cagepose.kernels.collision.geometry import Geometry
from cagepose.kernels.contact.contact_set import ContactSet
from cagepose.kernels.contact.metric import moved_along_twist
from cagepose.kernels.contact.on_rim import is_along_wall, is_kept
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.quasistatic.along_rims import meeting_along_rim
from cagepose.kernels.quasistatic.projection import box_axis
from cagepose.kernels.shapes.features import Shapes, place_feature
from cagepose.kernels.shapes.meeting import meeting_kept, twin_pair
from cagepose.kernels.shapes.rims import is_rim_on_side

STRAYED = 2.0
"""Times the way that contacts stray: a point or an edge that was nearer than this is met because they do."""


@kernel
def strayed(
    geometry: Geometry,
    contacts: ContactSet,
    position: Vector,
    quaternion: Quaternion,
    velocity: Vector,
    spin: Vector,
    amount: float,
    where_over: float,
    moved: Shapes,
) -> float:
    """Return how far the contacts that stay on their faces leave them on a screw, until they are put back, metres.

    A contact that has no place any more at the end counts for ``where_over``; of a rim that stays flat, for nothing.
    """
    end, turned = moved_along_twist(position, quaternion, velocity, spin, amount)
    back = (turned[0], -turned[1], -turned[2], -turned[3])
    farthest = 0.0
    for i in range(contacts.used[0]):
        if not is_kept(contacts, i):
            continue
        contact = contacts.rows[i]
        if contact.feature >= 0:
            matrix = matrix_from_quaternion(turned)
            place_feature(geometry.held, contact.feature, end, matrix, moved)
            twin, _ = twin_pair(moved, contact.feature, geometry.cage, contact.cage_feature)
            if twin >= 0:
                place_feature(geometry.held, twin, end, matrix, moved)
            held, cage = moved.features[contact.feature], geometry.cage.features[contact.cage_feature]
            is_along = is_along_wall(contacts, i)
            if is_along and is_rim_on_side(held, cage):
                met = meeting_along_rim(geometry, contact.feature, contact.cage_feature, end, matrix, moved)
            else:
                met = meeting_kept(moved, contact.feature, geometry.cage, contact.cage_feature, contact.gap)
            if met.is_one:
                farthest = max(farthest, abs(met.gap - contact.gap))
            elif not (contacts.states[i].stays_flat or is_along):
                farthest = max(farthest, where_over)
        else:
            from_center = rotated(back, minus(row(geometry.points_world, contact.point), end))
            from_box = minus(from_center, row(geometry.box_positions, contact.box))
            along = contact.side * dot(box_axis(geometry, contact.box, contact.axis), from_box)
            farthest = max(farthest, abs(along - geometry.half_sizes[contact.box, contact.axis] - contact.gap))
    return farthest

"""How far contacts stray from their faces on a screw: it leaves curved constraints by the square of its length.

A screw from one pose on the faces to another one leaves them most about half way.
"""

from __future__ import annotations

from cagepose.kernels.algebra.pose import Quaternion, matrix_from_quaternion
from cagepose.kernels.algebra.vector import Vector
from cagepose.kernels.boundary.features import place_feature, place_feature_at
from cagepose.kernels.boundary.geometry import Geometry, Placement, cage_at, held_moved
from cagepose.kernels.boundary.kept import crossed, meeting_kept
from cagepose.kernels.contact.contact_set import ContactSet
from cagepose.kernels.contact.metric import moved_along_twist
from cagepose.kernels.contact.on_circle import is_along_wall, is_kept
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.quasistatic.pushing_out import is_fixed

STRAYED = 2.0
"""Times the way that contacts stray: a point or an edge that was nearer than this is met because they do."""


@kernel
def strayed(
    geometry: Geometry,
    placement: Placement,
    contacts: ContactSet,
    position: Vector,
    quaternion: Quaternion,
    velocity: Vector,
    spin: Vector,
    amount: float,
    where_over: float,
) -> float:
    """Return how far the contacts that stay on their faces leave them on a screw, until they are put back, metres.

    A contact that has no place any more at the end counts for ``where_over``; of a circle that stays flat, or of edges
    that crossed, for nothing.
    """
    end, turned = moved_along_twist(position, quaternion, velocity, spin, amount)
    farthest, moved, places = 0.0, held_moved(geometry, placement), placement.memory.places
    for i in range(contacts.used[0]):
        if not is_kept(contacts, i):
            continue
        contact = contacts.rows[i]
        i_held, i_cage, fixed = contact.feature, contact.cage_feature, is_fixed(contacts, i)
        place_feature_at(moved, i_held, end, matrix_from_quaternion(turned))
        cage = cage_at(geometry, contact.cage_body)
        place_feature(cage, i_cage)
        met = meeting_kept(moved, i_held, cage, i_cage, contact.angle, fixed, geometry.touch_m, places)
        if met.is_one:
            farthest = max(farthest, abs(met.gap - contact.gap))
        elif not (
            contacts.states[i].stays_flat
            or is_along_wall(contacts, i)
            or crossed(moved.features[i_held], cage.features[i_cage])
        ):
            farthest = max(farthest, where_over)
    return farthest

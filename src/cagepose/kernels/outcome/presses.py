"""How the bodies that press in a phase do so where they are."""

from __future__ import annotations

from cagepose.kernels.algebra.pose import Quaternion, rotated
from cagepose.kernels.algebra.record import Rows
from cagepose.kernels.algebra.vector import Vector, dot, minus, plus, row, times, vector_from
from cagepose.kernels.boundary.features import number_of_bodies
from cagepose.kernels.boundary.geometry import Geometry
from cagepose.kernels.contact.pressing import Pressing
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.outcome.cases import Cases, Start, displacement_of
from cagepose.kernels.outcome.drives import Press


@kernel
def press_at(press: Press, geometry: Geometry, position: Vector, quaternion: Quaternion, out: Pressing) -> None:
    """Write how a body presses that is displaced from its place in the scene, as seen from the cage's middle."""
    still = geometry.placed.poses[0]
    turned = (row(still, 1), row(still, 2), row(still, 3))
    direction = times(turned, vector_from(press.direction))
    origin = plus(row(still, 0), times(turned, vector_from(press.origin)))
    gone = dot(direction, minus(plus(position, rotated(quaternion, origin)), origin))
    out.freedom, out.stiffness = press.freedom, press.stiffness
    out.force, out.gone = press.force - press.stiffness * gone, 0.0
    for k in range(3):
        out.direction[k] = direction[k]


@kernel
def press_at_start(phase: int, start: Start, cases: Cases, pressing: Rows[Pressing]) -> None:
    """Write how all bodies press in a phase where a case has them."""
    for body in range(1, number_of_bodies(start.geometry.cage)):
        position, quaternion = displacement_of(cases, start.geometry, body)
        press_at(cases.drives.presses[phase][body], start.geometry, position, quaternion, pressing[body])

"""Whether a body that presses beside a drive has come off the object, as a pad that slips along a part to its end."""

from __future__ import annotations

from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.vector import Vector
from cagepose.kernels.boundary.geometry import place_object
from cagepose.kernels.contact.pressing import copy_pressing
from cagepose.kernels.driven.advance import met_on_chord
from cagepose.kernels.driven.workspace import DriveSetting, DriveWorkspace
from cagepose.kernels.native.kernel import kernel

FARTHEST = 10.0
"""In sizes of the scene: a body that has gone so far and meets too little does not come back."""


@kernel
def one_came_off(
    drive: DriveSetting, position: Vector, quaternion: Quaternion, share: float, work: DriveWorkspace
) -> bool:
    """Whether a body that presses touches nothing, and would meet nothing if it went on where the others stand."""
    pressing, tried, geometry = work.memory.pressing, work.memory.tried, drive.setting.geometry
    for body in range(1, len(pressing)):
        if pressing[body].freedom == 0 or pressing[body].force <= 0.0 or touches(body, work):
            continue
        copy_pressing(pressing, tried)
        tried[body].gone += FARTHEST * drive.setting.size_m
        place_object(geometry, position, quaternion, work.run.placement)
        hit = met_on_chord(drive, position, quaternion, share, position, quaternion, share, pressing, work)
        copy_pressing(pressing, tried)
        if hit.feature < 0:
            return True
    return False


@kernel
def touches(body: int, work: DriveWorkspace) -> bool:
    """Whether one of the contacts is with a body of the cage."""
    contacts, found = work.run.contacts, False
    for i in range(contacts.used[0]):
        found = found or contacts.rows[i].cage_body == body
    return found

"""Where along a drive the object could jam, and with how much friction: the question of `cannot_jam` with its support.

Contacts with bodies that move alike do not stop them: forces that cancel do no work. What stops such an insertion is
the support. Where springs ride on driven bodies, the load grows with the drive, and it counts as one more contact that
gives way along that growth: forces that take it up without bound hold the object while the drive goes on.
"""

from __future__ import annotations

import math

from cagepose.kernels.algebra.least_squares import MOST_FREEDOMS, WRENCH, length
from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.vector import Vector, norm
from cagepose.kernels.contact.contact_set import ContactSet, choose
from cagepose.kernels.contact.metric import frame_at
from cagepose.kernels.driven.bodies import twist_of_body, write_drift
from cagepose.kernels.driven.rate import copy_contact, write_load_rate
from cagepose.kernels.driven.workspace import DriveSetting, DriveWorkspace
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.stability.jam import cannot_jam

MOST_FRICTION = 10.0
"""Up to this coefficient of friction it is asked whether an object could jam."""
SAME_FRICTION, LESS_FRICTION = 1e-12, 1e-9
"""Of a coefficient: the least one is known so well, and one that is less by so little is none."""


@kernel
def gather_drives(
    drive: DriveSetting,
    position: Vector,
    quaternion: Quaternion,
    share: float,
    with_support: bool,
    work: DriveWorkspace,
) -> bool:
    """Copy the contacts of ``work.run`` into ``work.run.turned``, as they drift where the drive goes on, and, if asked
    for, the load that grows as one of them; False: there is no room.
    """
    contacts, out, scratch = work.run.contacts, work.run.turned, work.scratch[0]
    n, frame, fastest = contacts.n_freedoms, frame_at(drive.setting.body, quaternion), 0.0
    if contacts.used[0] == len(out.rows):
        return False
    out.used[0] = contacts.used[0]
    for i in range(contacts.used[0]):
        write_drift(contacts, i, position, share, work.memory)
        copy_contact(contacts, i, out, i)
        choose(out, i, contacts.states[i].chosen)
    if not with_support:
        return True
    write_load_rate(drive.setting.load, position, quaternion, frame, share, work.memory, scratch.beside)
    for k in range(WRENCH, n):
        scratch.beside[k] = 0.0
    grows = length(scratch.beside, n)
    if grows > 0.0:
        for body in range(len(work.memory.n_legs)):
            velocity, spin = twist_of_body(work.memory, body, share)
            fastest = max(fastest, norm(velocity), drive.setting.body.reach_m * norm(spin))
        write_support(out, grows, fastest, work)
    return True


@kernel
def write_support(out: ContactSet, grows: float, fastest: float, work: DriveWorkspace) -> None:
    """Append the load that grows, as a contact without friction."""
    last = out.used[0]
    row = out.rows[last]
    for j in range(3):
        row.drift[j] = 0.0
        for k in range(MOST_FREEDOMS):
            row.columns[j, k] = 0.0
    for k in range(out.n_freedoms):
        row.columns[0, k] = -work.scratch[0].beside[k] / grows
    row.drift[0] = fastest
    choose(out, last, True)
    out.used[0] = last + 1


@kernel
def note_jams(
    drive: DriveSetting, position: Vector, quaternion: Quaternion, share: float, work: DriveWorkspace
) -> bool:
    """Return whether the object could jam at a place of a drive with the friction that there is, and note the least
    coefficient with which it could anywhere so far.
    """
    solver, scratch, turned = work.run.scratch[0].solver, work.scratch[0], work.run.turned
    if not gather_drives(drive, position, quaternion, share, True, work):
        return True
    low, high = 0.0, min(scratch.least_jam, MOST_FRICTION)
    if high > 0.0 and not cannot_jam(turned, high * (1.0 - LESS_FRICTION), solver):
        if cannot_jam(turned, 0.0, solver):
            while high - low > SAME_FRICTION * high:
                middle = 0.5 * (low + high)
                if not low < middle < high:
                    break
                if cannot_jam(turned, middle, solver):
                    low = middle
                else:
                    high = middle
        else:
            high = 0.0
        scratch.least_jam = high
    friction = drive.setting.friction.greatest
    if scratch.least_jam > friction or math.isinf(scratch.least_jam):
        return False
    return not cannot_jam(turned, friction, solver)

"""Why a drive does not go on: what blocks it, or jams it, and the proof.

Blocked: normal forces alone cancel and resist the drive, and along no motion that they leave free do they let it go on
to second order. Jammed: with friction no motion of the object and the drive obeys Coulomb's law, in whatever mode. That
is the search for another onset, with the drive as one more freedom: its share, along which each contact drifts, pushed
as hard as need be, beside the load.
"""

from __future__ import annotations

from cagepose.kernels.algebra.least_squares import length
from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.vector import Vector
from cagepose.kernels.contact.cone import write_forces
from cagepose.kernels.contact.contact_set import ContactSet
from cagepose.kernels.contact.coulomb_newton import SLIDES
from cagepose.kernels.contact.curvature import add_face_curvature, clear_matrix
from cagepose.kernels.contact.metric import frame_at
from cagepose.kernels.contact.pressing import write_whole_load
from cagepose.kernels.driven.could_jam import gather_drives
from cagepose.kernels.driven.stiffness import STABLE, hold_carried, least_stiffness
from cagepose.kernels.driven.workspace import DriveSetting, DriveWorkspace
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.outcome.trace import BLOCKED, JAMS, STALLED
from cagepose.kernels.quasistatic.step import stand_at
from cagepose.kernels.stability.drive_search import search_drive
from cagepose.kernels.stability.jam import cannot_jam
from cagepose.kernels.stability.strong import UNIQUE

OPENS = -2
"""Instead of the code of a verdict: normal forces resist the drive, but a motion opens them to second order."""


@kernel
def stopped_verdict(
    drive: DriveSetting, position: Vector, quaternion: Quaternion, share: float, work: DriveWorkspace
) -> int:
    """Return the verdict of a drive that does not go on from a rest: BLOCKED, JAMS, or STALLED where neither is proven;
    or OPENS, and then the motion is the first column of the vectors in the scratch.
    """
    run, solver = work.run, work.run.scratch[0].solver
    if not stand_at(drive.setting, position, quaternion, run):
        return STALLED
    if not gather_drives(drive, position, quaternion, share, False, work):
        return STALLED
    if not cannot_jam(run.turned, 0.0, solver):
        write_forces(solver.cone, 0.0, run.turned)
        return OPENS if opens_to_second_order(drive, quaternion, work) else BLOCKED
    return JAMS if is_jammed(drive, position, quaternion, work) else STALLED


@kernel
def opens_to_second_order(drive: DriveSetting, quaternion: Quaternion, work: DriveWorkspace) -> bool:
    """Whether normal forces that cancel, those of ``work.run.turned``, let a motion open to second order."""
    scratch, turned, frame = work.scratch[0], work.run.turned, frame_at(drive.setting.body, quaternion)
    clear_matrix(scratch.rest.curvature, turned.n_freedoms)
    scratch.rest.newton.n_carrying = 0
    for i in range(turned.used[0]):
        if turned.states[i].forces[0] > 0.0:
            add_face_curvature(turned, i, turned.states[i].forces[0], frame, False, scratch.rest.curvature)
            place = scratch.rest.newton.n_carrying
            scratch.rest.newton.contacts[place], scratch.rest.newton.modes[place] = i, SLIDES
            scratch.rest.newton.n_carrying = place + 1
    hold_carried(turned, work)
    return least_stiffness(drive, turned, scratch.rest.curvature, work) < STABLE


@kernel
def is_jammed(drive: DriveSetting, position: Vector, quaternion: Quaternion, work: DriveWorkspace) -> bool:
    """Whether no motion in which the drive goes on obeys Coulomb's law at the contacts of ``work.run.turned``."""
    turned, scratch, at = work.run.turned, work.scratch[0], work.run.proof
    n, friction, tree, fastest = turned.n_freedoms, drive.setting.friction.greatest, at.scratch[0].tree, 0.0
    for i in range(turned.used[0]):
        fastest = max(fastest, length(turned.rows[i].drift, 3))
    if fastest == 0.0:
        return False
    for i in range(turned.used[0]):
        row = turned.rows[i]
        for j in range(3):
            row.columns[j, n], row.drift[j] = row.drift[j] / fastest, 0.0
    driven = ContactSet(turned.used, turned.rows, turned.states, turned.bends, turned.pressing, n + 1)
    frame = frame_at(drive.setting.body, quaternion)
    terms = write_whole_load(drive.setting.load, turned.pressing, position, quaternion, frame, n, scratch.load)
    for k in range(n):
        scratch.beside[k] = 0.0
        scratch.load[k] = scratch.load[k] / terms if terms > 0.0 else 0.0
    scratch.beside[n], scratch.load[n] = 1.0, 0.0
    newton = work.run.scratch[0].solver.newton
    return search_drive(driven, friction, scratch.beside, scratch.load, tree, newton, at.system) == UNIQUE

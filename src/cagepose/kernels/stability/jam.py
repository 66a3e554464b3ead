"""Whether forces in the cones of contacts can stand against a drive, whatever the loads: `cannot_jam`.

Forces that cancel among themselves and do not give way to the drive, A f = 0 and f . w >= 0 with the drift w of each
contact, can grow without bound: the object may be jammed. None but zero do if there is a motion y in which every force
of every cone does at least the work of the drive,

    -(n + mu d) . A^T y >= w_n + mu d . w_t    for all contacts and unit tangents d.

The shortest such y is what is left of no load by contacts that drift: the least squares of forces with the work of the
drive as their gain. Where there is none, the forces have no bound.
"""

from __future__ import annotations

from cagepose.kernels.algebra.least_squares import inner, length
from cagepose.kernels.contact.cone import clear_cone, cone_residual, steepest_tangent
from cagepose.kernels.contact.contact_set import ContactSet
from cagepose.kernels.contact.workspace import ContactWorkspace
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.stability.tolerances import SPEED_OF_PROOF

ROUNDING_OF_PROOF, LONGEST_PROOF = 1e-12, 1e7
"""In lengths of the motion, which is long near a jam; and in the fastest drift: a longer motion proves nothing."""


@kernel
def cannot_jam(contacts: ContactSet, friction: float, work: ContactWorkspace) -> bool:
    """Whether contacts that drift cannot jam an object, with this coefficient of friction and so with any below it.

    If so, ``work.y`` is the scaled motion that proves it. The forces are lost.
    """
    n, fastest = contacts.n_freedoms, 0.0
    for i in range(contacts.used[0]):
        contacts.states[i].slip_speed = 0.0
        if contacts.states[i].counts:
            size = length(contacts.rows[i].columns[0], n)
            fastest = max(fastest, length(contacts.rows[i].drift, 3) / size)
    for k in range(n):
        work.trial[k] = 0.0
    clear_cone(work.cone, work.trial, n, fastest)
    work.cone.is_corrected = True  # by nothing: gains count, and that no load is left is no end
    cone_residual(contacts, friction, work.cone)
    for k in range(n):
        work.y[k] = work.cone.passive.residual[k]
    if length(work.y, n) > LONGEST_PROOF * fastest:  # by its rounding it would give way to anything
        return False
    allowed = max(SPEED_OF_PROOF * fastest, ROUNDING_OF_PROOF * length(work.y, n))
    for i in range(contacts.used[0]):
        if not contacts.states[i].counts:
            continue
        row = contacts.rows[i]
        closing = inner(row.columns[0], work.y, n) + row.drift[0]
        if closing + friction * steepest_tangent(contacts, i, work.y)[0] > allowed * length(row.columns[0], n):
            return False
    return True

"""Whether contacts leave a motion in which a drive goes on: the search that rules out other onsets, with the drive as
one more freedom.
"""

from __future__ import annotations

from cagepose.kernels.algebra.least_squares import System, length
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.contact.contact_set import ContactSet
from cagepose.kernels.contact.coulomb_newton import NewtonWorkspace
from cagepose.kernels.native.kernel import kernel
from cagepose.kernels.stability.relaxation import take_contacts
from cagepose.kernels.stability.strong import NOT_SHOWN, ModeTree, search_modes


@kernel
def search_drive(
    driven: ContactSet,
    friction: float,
    drive: FloatArray,
    beside: FloatArray,
    tree: ModeTree,
    newton: NewtonWorkspace,
    system: System,
) -> int:
    """Search for a motion of the object and the drive in which the drive goes on; return UNIQUE, there is none, or
    NOT_SHOWN.

    Parameters
    ----------
    driven
        Contacts in seven freedoms: the last says how each drifts.
    friction
        Coefficient.
    drive, beside
        What pushes the drive, and the load, which acts to any extent; zero: there is none. (7,) each, scaled, the load
        in lengths of its terms.
    tree, newton, system
        Memory. Filled: the tree.
    """
    if not take_contacts(driven, drive, tree.relaxation):
        return NOT_SHOWN
    tree.relaxation.has_beside = length(beside, driven.n_freedoms) > 0.0
    for k in range(driven.n_freedoms):
        tree.relaxation.beside[k] = beside[k]
    return search_modes(driven, friction, drive, False, tree, newton, system)

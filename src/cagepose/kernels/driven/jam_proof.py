"""The proof that a drive jams, made once more for those who want to see it: `search_jam`."""

from __future__ import annotations

from cagepose.kernels.algebra.least_squares import WRENCH
from cagepose.kernels.algebra.record import FloatArray
from cagepose.kernels.contact.contact_set import ContactSet
from cagepose.kernels.native.kernel import entry
from cagepose.kernels.stability.drive_search import search_drive
from cagepose.kernels.stability.proof import ProofWorkspace


@entry
def search_jam(friction: float, drive: FloatArray, beside: FloatArray, at: ProofWorkspace) -> int:
    """Search for a motion of the object and the drive in which the drive goes on, with the contacts that count; return
    UNIQUE, there is none, or NOT_SHOWN.

    Parameters
    ----------
    friction
        Coefficient of friction.
    drive, beside
        What pushes the drive, the seventh freedom, and the load, which acts to any extent; zero: there is none,
        (7,) each, scaled, the load a unit vector.
    at
        As left by the proof of a rest; the seventh number of each column says how the contact drifts. Filled: the tree.
    """
    contacts, scratch = at.contacts, at.scratch[0]
    driven = ContactSet(contacts.used, contacts.rows, contacts.states, contacts.bends, contacts.pressing, WRENCH + 1)
    return search_drive(driven, friction, drive, beside, scratch.tree, scratch.solver.newton, at.system)

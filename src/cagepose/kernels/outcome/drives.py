"""How bodies of the cage are driven in each phase: along legs, each a screw, one after the other."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from cagepose.kernels.algebra.record import FloatArray, IntArray, Rows


class Leg:
    """A constant twist that a body follows for one unit; a record. All zero: it stands still.

    Attributes
    ----------
    velocity, spin
        Of the body's material at the origin of the cage's frame, metres, and radians, in that frame.
    length
        What the driver's force is told for: metres of travel, or radians of a pure turn.
    """

    velocity: Annotated[FloatArray, 3]
    spin: Annotated[FloatArray, 3]
    length: float


class Press:
    """How a body presses in a phase; a record, in the cage's frame. All zero: it does not.

    Attributes
    ----------
    freedom
        See `cagepose.kernels.contact.pressing.Pressing`; 0: it does not press.
    direction, origin
        Unit vector along which it is pushed; and a place of it, where it stands in the scene, whose way along that is
        how far it has gone, metres.
    force, stiffness
        How hard where it stands in the scene, and how much less for each metre that it goes on.
    """

    freedom: int
    direction: Annotated[FloatArray, 3]
    origin: Annotated[FloatArray, 3]
    force: float
    stiffness: float


class Drives(NamedTuple):
    """The drives of all phases, and what presses in them.

    Attributes
    ----------
    legs
        (n_phases, n_bodies, n_legs). The first body stands still.
    n_legs
        How many of them each body follows, (n_phases, n_bodies): each takes an equal share of the phase.
    stop_at
        The sum of the driver's forces along their ways at which a phase stops, (n_phases,); inf: none.
    presses
        (n_phases, n_bodies).
    """

    legs: Rows[Rows[Rows[Leg]]]
    n_legs: IntArray
    stop_at: FloatArray
    presses: Rows[Rows[Press]]

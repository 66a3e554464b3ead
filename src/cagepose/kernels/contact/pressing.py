"""Bodies of the cage that press: each has one freedom, along a direction, and a force or a spring that pushes it there.

Beside the object's six freedoms each is one more, of the object's mass: the contact's part along its direction, and
among the loads its force. Balance, its uniqueness and the least friction are then those of all that can move together.
"""

from __future__ import annotations

from typing import Annotated

from cagepose.kernels.algebra.least_squares import MOST_FREEDOMS, WRENCH
from cagepose.kernels.algebra.pose import Quaternion
from cagepose.kernels.algebra.record import FloatArray, Rows
from cagepose.kernels.algebra.vector import Vector, dot, scaled, vector_from
from cagepose.kernels.contact.loads import PhaseLoad, write_load
from cagepose.kernels.contact.metric import Frame
from cagepose.kernels.native.kernel import kernel

MOST_PRESSING = MOST_FREEDOMS - WRENCH
"""So many bodies may press in a phase."""


class Pressing:
    """How one body of the cage presses in a phase; a record. All zero: it stands still.

    Attributes
    ----------
    freedom
        Which of the freedoms is its own; those of the object are the first six. 0: it does not press.
    direction
        Unit vector along which it is pushed, as seen from the middle of the cage, turned as the world is.
    force, stiffness
        How hard, where it is, and how much less for each metre that it goes on.
    gone
        How far it has gone along its direction, metres, beside where it is driven.
    """

    freedom: int
    direction: Annotated[FloatArray, 3]
    force: float
    stiffness: float
    gone: float


@kernel
def number_pressing(pressing: Rows[Pressing]) -> int:
    """Return how many bodies press."""
    found = 0
    for body in range(len(pressing)):
        found += 1 if pressing[body].freedom > 0 else 0
    return found


@kernel
def write_pressed(
    pressing: Rows[Pressing], body: int, directions: FloatArray, n_freedoms: int, out: FloatArray
) -> None:
    """Write what forces along a contact's directions do to the freedoms of bodies that press, into the columns from the
    seventh on of rows, (3, n_freedoms): the contact with a body pushes it as hard as the object, the other way.
    """
    for j in range(3):
        for k in range(WRENCH, n_freedoms):
            out[j, k] = 0.0
    own = pressing[body].freedom if body < len(pressing) else 0
    if own > 0:
        for j in range(3):
            out[j, own] = -dot(vector_from(directions[j]), vector_from(pressing[body].direction))


@kernel
def write_whole_load(
    load: PhaseLoad,
    pressing: Rows[Pressing],
    position: Vector,
    quaternion: Quaternion,
    frame: Frame,
    n_freedoms: int,
    out: FloatArray,
) -> float:
    """Write the load on the object, as `write_load`, and behind it what bodies press with; return the length of all
    terms.
    """
    total = write_load(load, position, quaternion, frame, out)
    for k in range(WRENCH, n_freedoms):
        out[k] = 0.0
    for body in range(len(pressing) if n_freedoms > WRENCH else 0):
        if pressing[body].freedom > 0:
            out[pressing[body].freedom] = pressing[body].force
            total += abs(pressing[body].force)
    return total


@kernel
def press_farther(one: Pressing, way: float) -> None:
    """Note that a body has gone on so far along its direction, metres."""
    one.gone += way
    one.force -= one.stiffness * way


@kernel
def copy_pressing(pressing: Rows[Pressing], out: Rows[Pressing]) -> None:
    for body in range(len(pressing)):
        out[body] = pressing[body]  # type: ignore[index]


@kernel
def velocity_of_body(pressing: Rows[Pressing], body: int, y: FloatArray) -> Vector:
    """Return how fast a body of the cage goes in a scaled motion of all that can move."""
    own = pressing[body].freedom if body < len(pressing) else 0
    return scaled(vector_from(pressing[body].direction), y[own]) if own > 0 else (0.0, 0.0, 0.0)


@kernel
def add_pressed_curvature(
    pressing: Rows[Pressing], body: int, bend: FloatArray, factor: float, out: FloatArray
) -> None:
    """Add to S what the bend of a contact, (6, 6), adds where its body goes along its direction: the object then goes
    the other way, as the body sees it.
    """
    own = pressing[body].freedom if body < len(pressing) else 0
    for j in range(3 if own > 0 else 0):
        along = -factor * pressing[body].direction[j]
        for k in range(WRENCH):
            out[own, k] += along * bend[j, k]
            out[k, own] += along * bend[k, j]
        for k in range(3):
            out[own, own] -= along * bend[j, k] * pressing[body].direction[k]


@kernel
def add_pressing_stiffness(pressing: Rows[Pressing], out: FloatArray) -> None:
    """Add to S the springs with which bodies press."""
    for body in range(len(pressing)):
        if pressing[body].freedom > 0:
            out[pressing[body].freedom, pressing[body].freedom] += pressing[body].stiffness

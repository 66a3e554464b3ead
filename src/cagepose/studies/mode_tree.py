"""Cases of what contacts do, as data: `ModeTree`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from cagepose.model.checks import FloatArray
from cagepose.model.wording import number_of

Decision = Literal["none", "opens", "closed", "sticks", "slips"]


@dataclass(frozen=True, eq=False)
class ModeTree:
    """Cases of what the contacts do, each divided into cases that cover it, down to cases in which no motion begins.

    Attributes
    ----------
    parents
        Of each node the one that it divides, which comes before it; -1: the root, node 0, which decides nothing.
    contacts
        Of each node the contact that it decides, by its place among those that count; -1: the root.
    decisions
        What it decides: the contact "opens" (its force is zero) or stays "closed" (its gap does); it "sticks" (it has
        no slip) or "slips" (in a sector of directions). "none": the root.
    starts_rad, widths_rad
        Of a sector: the angle from the first tangent towards the second at which it starts, and how wide it is; (n,).
    twists
        Of each leaf, in the order of the nodes: z of (5.20), velocity of the centre of gravity and angular velocity in
        the world, for a load of length 1, (n_leaves, 6); of a drive that jams with a seventh number, see `StopChoice`.
    pressures
        Of each leaf and contact: along normal and tangents, in loads, what D z leaves of the load, as velocities
        that its case does not allow; (n_leaves, n_contacts, 3).
    """

    parents: tuple[int, ...]
    contacts: tuple[int, ...]
    decisions: tuple[Decision, ...]
    starts_rad: Annotated[FloatArray, (-1,)]
    widths_rad: Annotated[FloatArray, (-1,)]
    twists: Annotated[FloatArray, (-1, -1)]
    pressures: Annotated[FloatArray, (-1, -1, 3)]

    def __repr__(self) -> str:
        return f"<ModeTree: {number_of(len(self.parents), 'node')}, {number_of(len(self.leaves()), 'leaf', 'leaves')}>"

    def leaves(self) -> list[int]:
        """Return the nodes that are not divided."""
        divided = set(self.parents)
        return [node for node in range(len(self.parents)) if node not in divided]

    def above(self, node: int) -> list[int]:
        """Return a node and those above it, the root left out."""
        found = list[int]()
        while node > 0:
            found.append(node)
            node = self.parents[node]
        return found

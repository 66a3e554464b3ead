"""The proof of a rest as data: `Certificate`.

`certify` makes one, and `certificate_check` says whether it is right. Nothing
here knows how such a proof is found.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from cagepose.model.checks import FloatArray
from cagepose.model.wording import counted
from cagepose.runs.proof import Uniqueness
from cagepose.studies.touched_faces import ContactFace

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
        the world, for a load of length 1; (n_leaves, 6).
    pressures
        Of each leaf and contact: along normal and tangents, in loads, what D z leaves of the load, as velocities
        that its case does not allow; (n_leaves, n_contacts, 3).
    """

    parents: tuple[int, ...]
    contacts: tuple[int, ...]
    decisions: tuple[Decision, ...]
    starts_rad: Annotated[FloatArray, (-1,)]
    widths_rad: Annotated[FloatArray, (-1,)]
    twists: Annotated[FloatArray, (-1, 6)]
    pressures: Annotated[FloatArray, (-1, -1, 3)]

    def __repr__(self) -> str:
        return f"<ModeTree: {len(self.parents)} nodes, {len(self.leaves())} leaves>"

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


@dataclass(frozen=True, eq=False)
class ChosenFaces:
    """One choice of faces at edges; without points on edges there is one, with all contacts.

    Attributes
    ----------
    contacts
        Those that count, by their places in `Certificate.contacts`.
    forces
        That balance the load, along normal and tangents, in loads, (n, 3); the contact pushes the object along the
        negative of these.
    tree
        The proof that no motion can begin; None: there is none.
    """

    contacts: tuple[int, ...]
    forces: Annotated[FloatArray, (-1, 3)]
    tree: ModeTree | None

    def __repr__(self) -> str:
        proof = "no tree" if self.tree is None else repr(self.tree)
        return f"<ChosenFaces: {len(self.contacts)} contacts, {proof}>"


@dataclass(frozen=True, eq=False)
class OtherOnset:
    """Forces with which the object begins to move, by Coulomb's law (5.7).

    Attributes
    ----------
    contacts, forces
        As for `ChosenFaces`. The motion is what these forces leave of the load.
    """

    contacts: tuple[int, ...]
    forces: Annotated[FloatArray, (-1, 3)]

    def __repr__(self) -> str:
        return f"<OtherOnset: {len(self.contacts)} contacts>"


@dataclass(frozen=True, eq=False)
class Certificate:
    """The proof of a rest as data, which `check_certificate` verifies.

    A load of length 1 in the scaled coordinates of (5.3) is the unit of all forces.

    Attributes
    ----------
    uniqueness
        "strong": for each choice of faces there is a tree. "weak": there is another onset. "not shown": neither; the
        forces show that rest is one onset.
    contacts
        Between what they are.
    places_world, directions_world
        Where each is, (n, 3), metres, and the outward normal of the object and two tangents there, unit vectors
        (n, 3, 3): what forces and pressures go along.
    friction
        Coefficient of each, (n,).
    choices
        One for each choice of faces at edges.
    onset
        The other one, for "weak".
    """

    uniqueness: Uniqueness
    contacts: tuple[ContactFace, ...]
    places_world: Annotated[FloatArray, (-1, 3)]
    directions_world: Annotated[FloatArray, (-1, 3, 3)]
    friction: Annotated[FloatArray, (-1,)]
    choices: tuple[ChosenFaces, ...]
    onset: OtherOnset | None

    def __repr__(self) -> str:
        counts = counted((len(self.contacts), "contact", "contacts"), (len(self.choices), "choice", "choices"))
        return f"<Certificate: {self.uniqueness}, {counts} of faces>"

"""The proof of a rest, and what is proven of the drive before it, as data: `Certificate`.

`certify` makes one, and `certificate_check` says whether it is right. Nothing
here knows how such a proof is found.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from cagepose.model.checks import FloatArray
from cagepose.model.wording import counted, number_of
from cagepose.runs.proof import Uniqueness
from cagepose.studies.drive_proof import DriveProof
from cagepose.studies.mode_tree import ModeTree
from cagepose.studies.touched_faces import ContactFace


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
        return f"<ChosenFaces: {number_of(len(self.contacts), 'contact')}, {proof}>"


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
        return f"<OtherOnset: {number_of(len(self.contacts), 'contact')}>"


@dataclass(frozen=True, eq=False)
class Certificate:
    """The proof of a rest, and of a drive that led there, as data, which `check_certificate` verifies.

    A load of length 1 in the scaled coordinates of (5.3) is the unit of all forces.

    Attributes
    ----------
    uniqueness
        "strong": for each choice of faces there is a tree. "weak": there is another onset. "not shown": neither; the
        forces show that rest is one onset. None: nothing is said of rest, only of the drive.
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
    drive
        What is proven of the drive of the phase; None: nothing was driven.
    """

    uniqueness: Uniqueness | None
    contacts: tuple[ContactFace, ...]
    places_world: Annotated[FloatArray, (-1, 3)]
    directions_world: Annotated[FloatArray, (-1, 3, 3)]
    friction: Annotated[FloatArray, (-1,)]
    choices: tuple[ChosenFaces, ...]
    onset: OtherOnset | None
    drive: DriveProof | None = None

    def __repr__(self) -> str:
        counts = counted((len(self.contacts), "contact", "contacts"), (len(self.choices), "choice", "choices"))
        rest = "nothing of rest" if self.uniqueness is None else f"{self.uniqueness}, {counts} of faces"
        return f"<Certificate: {rest}{f', {self.drive!r}' if self.drive else ''}>"

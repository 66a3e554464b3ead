"""What is proven of a drive as data: `DriveProof`, where the object could jam, and why it stopped.

`drive_proof` makes one, and `check_certificate` says whether it is right. Nothing here knows how such a proof is found.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from cagepose.model.checks import FloatArray
from cagepose.model.wording import counted, number_of
from cagepose.studies.mode_tree import ModeTree
from cagepose.studies.touched_faces import ContactFace

Stopped = Literal["blocked", "jams"]


@dataclass(frozen=True, eq=False)
class JamChoice:
    """With one choice of faces at edges: a motion that gives way to all forces, or forces that stand against the drive.

    Attributes
    ----------
    contacts
        Those that count, by their places in `DrivenPlace.contacts`.
    motion
        "Cannot jam": velocity of the centre of gravity and angular velocity, in the world, for all of the drive, (6,),
        metres and radians. With it each contact opens at least as fast as its coefficient of friction times its slip,
        seen from its body; and the growth of the load does work. None: there is none.
    forces
        "Could jam": along normal and tangents, (n, 3), of no unit. They cancel but for what they take up of the growth
        of the load, and do not give way to the drive. None: there are none.
    taken
        How much of the growth of the load they take up, in its scaled length (5.3).
    """

    contacts: tuple[int, ...]
    motion: Annotated[FloatArray, (6,)] | None
    forces: Annotated[FloatArray, (-1, 3)] | None
    taken: float

    def __repr__(self) -> str:
        jams = "could" if self.motion is None else "cannot"
        return f"<JamChoice: {number_of(len(self.contacts), 'contact')}, {jams} jam>"


@dataclass(frozen=True, eq=False)
class DrivenPlace:
    """One place of a drive, with all that touches there.

    Attributes
    ----------
    row, share
        The row of the curve of `DriveRun` that it is, and how much of the drive is done there.
    contacts, places_world, directions_world, friction
        As in `Certificate`.
    drifts
        How fast each contact closes, and slips along its tangents, where the object stands still, (n, 3), metres for
        all of the drive (8.1).
    growth
        How the load grows as springs ride on bodies, force and moment about the centre of gravity in the world, (6,),
        newtons and newton metres for all of the drive; zero: it does not.
    choices
        One for each choice of faces at edges.
    """

    row: int
    share: float
    contacts: tuple[ContactFace, ...]
    places_world: Annotated[FloatArray, (-1, 3)]
    directions_world: Annotated[FloatArray, (-1, 3, 3)]
    friction: Annotated[FloatArray, (-1,)]
    drifts: Annotated[FloatArray, (-1, 3)]
    growth: Annotated[FloatArray, (6,)]
    choices: tuple[JamChoice, ...]

    def __repr__(self) -> str:
        return f"<DrivenPlace {self.row} at {self.share:.6g}: {number_of(len(self.contacts), 'contact')}>"


@dataclass(frozen=True, eq=False)
class StopChoice:
    """Why a drive does not go on from its last place, with one choice of faces at edges.

    Attributes
    ----------
    contacts
        Those that count, by their places in the last of `DriveProof.places`.
    normal_forces
        "blocked": they cancel, and stand against the drive, (n,), of no unit.
    free
        "blocked": motions of the object along which no contact that carries opens or closes to first order: velocity of
        the centre of gravity and angular velocity in the world, (k, 6), one for each freedom that is left.
    tree
        "jams": proof that no motion of the object and the drive begins in which the drive goes on. The twists have a
        seventh number, the speed of the drive in that of its fastest contact.
    motion
        "jams": gives way without friction, as `JamChoice.motion`.
    """

    contacts: tuple[int, ...]
    normal_forces: Annotated[FloatArray, (-1,)] | None
    free: Annotated[FloatArray, (-1, 6)] | None
    tree: ModeTree | None
    motion: Annotated[FloatArray, (6,)] | None

    def __repr__(self) -> str:
        proof = "blocked" if self.tree is None else repr(self.tree)
        return f"<StopChoice: {number_of(len(self.contacts), 'contact')}, {proof}>"


@dataclass(frozen=True, eq=False)
class DriveProof:
    """What is proven of the drive of a phase.

    Attributes
    ----------
    places
        Where it was asked whether the object could jam: the places of the curve of `DriveRun`. Nothing is said of what
        lies between them.
    stopped
        Why the drive did not go on: "blocked" or "jams"; None: it did, or there is no proof.
    choices
        Of the last place, the proof of that, one for each choice of faces at edges; none: there is no proof.
    """

    places: tuple[DrivenPlace, ...]
    stopped: Stopped | None
    choices: tuple[StopChoice, ...]

    def __repr__(self) -> str:
        counts = counted((len(self.places), "place", "places"))
        return f"<DriveProof: {counts}{f', {self.stopped}' if self.stopped else ''}>"

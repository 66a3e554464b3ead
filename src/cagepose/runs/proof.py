"""What proves a verdict: `Proof`, and `FreeMotion`, the onset of a motion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from cagepose.model.checks import FloatArray
from cagepose.model.wording import coordinates

ProofVerdict = Literal["rests", "may rest", "moves"]
Stability = Literal["stable", "marginal", "unstable", "not shown"]
Uniqueness = Literal["strong", "weak", "not shown"]


@dataclass(frozen=True, eq=False)
class FreeMotion:
    """How an object begins to move, at any speed.

    Attributes
    ----------
    kind
        "travel", "turn" or "screw".
    direction_world
        Unit vector of a travel, (3,); None for a turn or a screw.
    axis_world, through_world
        Unit vector of the axis and a point on it, (3,) each, metres; None for a travel. Turns are right-handed.
    pitch_m
        Travel along the axis for each radian, metres; zero for a travel or a turn.
    """

    kind: Literal["travel", "turn", "screw"]
    direction_world: FloatArray | None
    axis_world: FloatArray | None
    through_world: FloatArray | None
    pitch_m: float

    def __repr__(self) -> str:
        along = self.direction_world if self.axis_world is None else self.axis_world
        line = "" if along is None else f" {'along' if self.kind == 'travel' else 'about'} {coordinates(along, 4)}"
        return f"<FreeMotion: {self.kind}{line}>"


@dataclass(frozen=True, eq=False)
class Proof:
    """The verdict of the mechanics on a pose under a load (docs/theory/mechanics).

    Attributes
    ----------
    verdict
        "rests": the contacts' forces balance the load, and the object cannot begin to move. "may rest": they can, but
        Coulomb's law allows a motion too, or that could not be ruled out. "moves": no contact forces balance the load.
    reason
        Why, in words.
    residual
        What the contact forces leave of the load, as a fraction of it (moments at the scale of the radii of gyration).
        A balance leaves at most 1e-8, mostly below 1e-11. More is left at rest where contacts without play carry it to
        second order: then the reason says so.
    needs_friction
        Whether there is a balance with friction only.
    stability
        Against small disturbances; "not shown" where loads that have no potential may decide it, or a contact lies
        where surfaces meet that bend by different amounts; None where the object moves.
    undetermined
        Freedoms in the cage's frame ("x", "y", "z", "roll", "pitch", "yaw") along which the load does not tell poses
        apart, with "and others" where these do not span them all.
    shared
        Names of the cage points whose normal force is not unique: the one given is one of many.
    motion
        Where the object moves: what nothing stops; where it may rest: the other motion, if one was found.
    critical_friction
        The least coefficient of friction at which the contacts balance the load: None if not asked for, infinite if
        there is none.
    gap_work
        The sum of normal force times gap over the contacts, as a fraction of the load times the scene's size; below
        zero where points are inside, all within the touch tolerance. Without friction no motion that keeps the points
        out of the object lets the load do more work than this (to first order), so it tells how far a rest stands on
        the touch tolerance. None where the object moves, or in a run that an older version saved.
    largest_force
        The greatest force of a contact as a fraction of the load. Many loads mean contacts that press against each
        other, as in a wedge, and a rest that hangs on little changes of shape. None as above.

    What is accepted as zero, and why, is in docs/conventions.
    """

    verdict: ProofVerdict
    reason: str
    residual: float
    needs_friction: bool
    stability: Stability | None
    undetermined: tuple[str, ...]
    shared: tuple[str, ...]
    motion: FreeMotion | None
    critical_friction: float | None = None
    gap_work: float | None = None
    largest_force: float | None = None

    def __repr__(self) -> str:
        stability = "" if self.stability is None else f" ({self.stability})"
        return f"<Proof: {self.verdict}{stability}, residual {self.residual:.1e}>"

    @property
    def uniqueness(self) -> Uniqueness | None:
        """Whether rest is the only onset of motion (Pang and Trinkle, 2000); None where the object moves.

        "strong" stability ("rests"): rest is the only onset that Coulomb's law allows. "weak" ("may rest"): rest is
        one, and `motion` is another. "not shown" ("may rest"): rest is one, and whether there is another is open.
        """
        if self.verdict == "moves":
            return None
        return "strong" if self.verdict == "rests" else "not shown" if self.motion is None else "weak"

"""Is what a certificate says of a drive right? `check_drive`, in NumPy, with nothing of the search that made it.

A motion gives way to the forces of a cone if the contact opens at least mu times as fast as it slips: of a Coulomb cone
that is all. Forces that stand are multiplied and added. How a drive that jams is proven is as for rest, with the drive
as one more freedom.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import get_args

import numpy as np

from cagepose.errors import CertificateError
from cagepose.model.checks import FloatArray
from cagepose.runs.run import Run
from cagepose.studies.choice_check import CheckedChoice
from cagepose.studies.contact_problem import ContactProblem
from cagepose.studies.contacts_check import check_choices, check_contacts
from cagepose.studies.drive_proof import DrivenPlace, DriveProof, JamChoice, StopChoice, Stopped
from cagepose.studies.driven_contacts import DriveContacts, DrivenContacts
from cagepose.studies.tolerances import (
    FORCE_OUTSIDE_CONE,
    FORCES_THAT_CANCEL,
    RESIDUAL_OF_LEAF,
    SAME_DRIFT,
    SAME_FREEDOM,
    SPEED_OF_GIVING_WAY,
)


@dataclass(frozen=True)
class DriveCheck:
    """What a proof about a drive that is right shows.

    Attributes
    ----------
    n_places
        At so many places of the drive, those of its curve, it was asked whether the object could jam.
    could_jam
        At which shares of them it could. At all others it cannot, with these contacts, at this friction and below.
    margin
        At these others each contact opens faster than friction asks for, at least by so much, in the drift of the
        fastest contact. Zero, or below it by rounding: no forces that cancel do work against the drive, but some that
        do none are not ruled out. None: there are no such places, or nothing touches there.
    stopped
        Why the drive did not go on.
    n_leaves
        "jams": how many cases its trees tell apart.
    speed
        "blocked", "jams": in a motion that the proof does not rule out the drive is no more than this share of it, with
        forces that add up to no more than the motion.
    n_free
        "blocked": so many freedoms are left along which the contacts that carry open to second order at the first.
        That they do not open then is the kernels' word, and not checked. Zero: there is nothing left to check.
    """

    n_places: int
    could_jam: tuple[float, ...]
    margin: float | None
    stopped: Stopped | None
    n_leaves: int
    speed: float
    n_free: int


def check_drive(proof: DriveProof, run: Run, phase: int) -> DriveCheck:
    """Check what is said of the drive of a phase, counted from 0, against a run's scene, and the poses of its curve.

    Raises
    ------
    CertificateError
        It proves nothing: says where, what was found, and what was to be there.
    """
    if run.phases[phase].drive is None:
        raise CertificateError("drive is there, and the phase drives nothing")
    known = DriveContacts(run, phase)
    _check_rows(proof, known)
    could, margins, ended = list[float](), list[float](), None
    for place in proof.places:
        checked = _CheckedPlace(place, known.at_row(place.row), run.scene.size_m, known.share_of(place.row))
        found = [checked.margin(number, choice) for number, choice in enumerate(place.choices)]
        if None in found:
            could.append(place.share)
        else:
            margins += [margin for margin in found if margin is not None]
        ended = checked
    if proof.stopped is not None and ended is not None:
        n_leaves, speed, n_free = ended.stop(proof)
    else:
        n_leaves, speed, n_free = 0, 0.0, 0
    least = min(margins, default=np.inf)
    return DriveCheck(
        len(proof.places), tuple(could), least if np.isfinite(least) else None, proof.stopped, n_leaves, speed, n_free
    )


def _check_rows(proof: DriveProof, known: DriveContacts) -> None:
    """The places must be those of the curve, all of them."""
    given, wanted = [place.row for place in proof.places], known.rows()
    for row in given:
        if row not in wanted:
            raise CertificateError(f"drive.places name row {row}, which is none of the drive's curve")
    missing = sorted(set(wanted) - set(given))
    if missing or given != wanted:
        what = f"leave out row {missing[0]} of the drive's curve" if missing else "are not in the order of the curve"
        raise CertificateError(f"drive.places {what}")


def driven_problem(contacts: DrivenContacts) -> tuple[ContactProblem, FloatArray | None]:
    """Return the contact problem with the drive as a seventh freedom, which is pushed in the place of the load, as fast
    as the fastest contact drifts; and the load, (7,), which may act beside to any extent; None: there is none.
    """
    problem, speed = contacts.problem, contacts.speed
    wrenches = np.concatenate([problem.wrenches, contacts.drifts[:, :, None] / speed], axis=2)
    scale = np.eye(7)
    scale[:6, :6] = problem.scale
    beside = np.append(problem.load, 0.0) if problem.load.any() else None
    return replace(problem, wrenches=wrenches, load=np.eye(7)[6], scale=scale), beside


class _CheckedPlace:
    """What touches at a place of a drive, in the order of the certificate."""

    def __init__(self, place: DrivenPlace, own: DrivenContacts, size_m: float, share: float) -> None:
        self.where, self.own, problem = f"drive, row {place.row}: ", own, own.problem
        if place.share != share:
            raise CertificateError(f"{self.where}share is {place.share!r}, and the curve's is {share!r}")
        self.places = check_contacts(place, problem, size_m, self.where)
        check_choices([choice.contacts for choice in place.choices], self.places, problem, self.where)
        off = place.drifts.shape != (len(self.places), 3) or not np.isfinite(place.drifts).all()
        if off or np.abs(place.drifts - own.drifts[self.places]).max(initial=0.0) > SAME_DRIFT * own.speed:
            raise CertificateError(f"{self.where}drifts are not those of the scene's bodies at this place")
        grown = np.linalg.norm(problem.scaled(place.growth - own.growth))
        if not grown <= SAME_DRIFT * own.growth_size:
            raise CertificateError(f"{self.where}growth is not how the scene's load grows at this place")

    def _of(self, contacts: tuple[int, ...]) -> list[int]:
        return [self.places[contact] for contact in contacts]

    def margin(self, number: int, choice: JamChoice) -> float | None:
        """Return by how much the contacts of a choice give way faster than they must; None: forces stand there."""
        where, at = f"{self.where}choices[{number}]", self._of(choice.contacts)
        if choice.motion is not None:
            return self._gives_way(where, at, choice.motion, self.own.problem.friction[at], self.own.growth)
        if choice.forces is None:
            raise CertificateError(f"{where} has neither a motion nor forces")
        self._check_standing(where, at, choice.forces, choice.taken)
        return None

    def _gives_way(
        self, where: str, at: list[int], motion: FloatArray, friction: FloatArray, growth: FloatArray
    ) -> float:
        problem, own = self.own.problem, self.own
        if not np.isfinite(motion).all():
            raise CertificateError(f"{where}.motion has a number that is not finite")
        least = SPEED_OF_GIVING_WAY * own.speed
        moving = problem.wrenches[at] @ motion + own.drifts[at]
        margins = -moving[:, 0] - friction * np.hypot(moving[:, 1], moving[:, 2])
        lengths = np.linalg.norm(problem.scaled(problem.wrenches[at, 0]), axis=1)
        for place, margin in zip(at, (margins + least * lengths).tolist(), strict=True):
            if not margin >= 0.0:
                raise CertificateError(
                    f"{where}.motion does not give way to {problem.faces[place]}: it opens {-margin:.1e} m too slowly"
                )
        if growth.any() and not growth @ motion > least * own.growth_size:
            raise CertificateError(f"{where}.motion does not give way to the growth of the load")
        return float(margins.min(initial=np.inf)) / own.speed

    def _check_standing(self, where: str, at: list[int], forces: FloatArray, taken: float) -> None:
        problem, own = self.own.problem, self.own
        if forces.shape != (len(at), 3) or not (np.isfinite(forces).all() and np.isfinite(taken)):
            raise CertificateError(f"{where}.forces are not three numbers for each of {len(at)} contacts")
        lengths = np.linalg.norm(problem.scaled(problem.wrenches[at, 0]), axis=1)
        friction = np.linalg.norm(forces[:, 1:], axis=1) - problem.friction[at] * forces[:, 0]
        outside = float((np.maximum(-forces[:, 0], friction) * lengths).max(initial=0.0))
        total = float(forces[:, 0] @ lengths) + taken
        if not (total > 0.0 and taken >= 0.0 and outside <= FORCE_OUTSIDE_CONE * total):
            raise CertificateError(f"{where}.forces leave their friction cones by {outside:.1e}")
        wrench = np.einsum("ij,ijk->k", forces, problem.wrenches[at])
        if own.growth_size > 0.0:
            wrench = wrench - taken * own.growth / own.growth_size
        left = float(np.linalg.norm(problem.scaled(wrench)))
        if not left <= FORCES_THAT_CANCEL * total:
            raise CertificateError(f"{where}.forces do not cancel: {left / total:.1e} of them is left")
        work = float(np.sum(forces * own.drifts[at])) + taken * own.fastest * bool(own.growth_size)
        if not work > 0.0:
            raise CertificateError(f"{where}.forces give way to the drive: their work on it is {work:.1e}")

    def stop(self, proof: DriveProof) -> tuple[int, float, int]:
        """Return the number of leaves, how fast the drive may still go, and the number of freedoms left."""
        if proof.stopped not in get_args(Stopped):
            raise CertificateError(f"drive.stopped is {proof.stopped!r}; it is one of {', '.join(get_args(Stopped))}")
        where = "drive.stop "
        check_choices([choice.contacts for choice in proof.choices], self.places, self.own.problem, where)
        n_leaves, speed, n_free = 0, 0.0, 0
        for number, choice in enumerate(proof.choices):
            told = f"{where}choices[{number}]"
            if proof.stopped == "blocked":
                slow, free = self._blocked(told, choice)
                speed, n_free = max(speed, slow), max(n_free, free)
            else:
                leaves, slow = self._jammed(told, choice)
                n_leaves, speed = n_leaves + leaves, max(speed, slow)
        return n_leaves, speed, n_free

    def _blocked(self, where: str, choice: StopChoice) -> tuple[float, int]:
        problem, at = self.own.problem, self._of(choice.contacts)
        forces, free = choice.normal_forces, choice.free
        if forces is None or free is None or forces.shape != (len(at),) or not np.isfinite(forces).all():
            raise CertificateError(f"{where} has no normal forces for each of {len(at)} contacts")
        normals = problem.scaled(problem.wrenches[at, 0])
        lengths = np.linalg.norm(normals, axis=1)
        if not (forces >= 0.0).all():
            raise CertificateError(f"{where}.normal_forces pull")
        total, work = float(forces @ lengths), float(forces @ self.own.drifts[at, 0])
        left = float(np.linalg.norm(forces @ normals))
        if not (total > 0.0 and left <= FORCES_THAT_CANCEL * total):
            raise CertificateError(f"{where}.normal_forces do not cancel: {left:.1e} of {total:.1e} is left")
        if not left * self.own.speed <= RESIDUAL_OF_LEAF * work:
            raise CertificateError(f"{where}.normal_forces do not stand against the drive: their work is {work:.1e}")
        rows = (normals / lengths[:, None])[forces > 0.0]
        motions = np.array([problem.scaled_twist(twist) for twist in free]).reshape(-1, 6)
        motions = motions / np.linalg.norm(motions, axis=1)[:, None]
        held = int(np.sum(np.linalg.svd(rows, compute_uv=False) > SAME_FREEDOM))
        if not np.isfinite(motions).all() or np.abs(rows @ motions.T).max(initial=0.0) > SAME_FREEDOM:
            raise CertificateError(f"{where}.free has a motion that closes or opens a contact which carries")
        own_rank = int(np.sum(np.linalg.svd(motions, compute_uv=False) > SAME_FREEDOM)) if len(motions) else 0
        if own_rank != len(free) or own_rank + held != 6:
            raise CertificateError(f"{where}.free has {own_rank} freedoms, and {6 - held} are left")
        return left * self.own.speed / work, own_rank

    def _jammed(self, where: str, choice: StopChoice) -> tuple[int, float]:
        at = self._of(choice.contacts)
        if choice.tree is None or choice.motion is None:
            raise CertificateError(f"{where} has no tree, or no motion without friction")
        self._gives_way(where, at, choice.motion, np.zeros(len(at)), np.zeros(6))
        problem, beside = driven_problem(self.own)
        driven, left = CheckedChoice(problem, at, where, beside).limits(choice.tree)
        return len(choice.tree.leaves()), driven + left

"""Is a certificate of rest right? `check_certificate`, in NumPy, with nothing of the search that made it.

Contacts, load and metric are those of the scene at the pose, found anew; the certificate is believed in nothing but
where to look. Where shapes touch that are not boxes and points, the kernels say, as `contact_problem` tells.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from math import pi
from typing import NamedTuple, get_args

import numpy as np

from cagepose.errors import CertificateError
from cagepose.model.checks import FloatArray, expect
from cagepose.runs.proof import Uniqueness
from cagepose.runs.run import Run
from cagepose.studies.certificate import Certificate, ChosenFaces, Decision, ModeTree, OtherOnset
from cagepose.studies.contact_problem import ContactProblem, contact_problem
from cagepose.studies.tolerances import (
    FORCE_OUTSIDE_CONE,
    GAP_OF_SECTORS_RAD,
    LEAST_MOTION,
    POWER_OF_NONE,
    RESIDUAL_OF_BALANCE,
    RESIDUAL_OF_LEAF,
    ROUNDING_OF_FORCES,
    SAME_PLACE_OF_SIZE,
    VIOLATION_OF_COULOMB,
)

OTHER_PHASE = "is it the certificate of another phase, or another scene?"


@dataclass(frozen=True)
class CertificateCheck:
    """What a certificate that is right shows.

    Attributes
    ----------
    uniqueness
        As in `Certificate`.
    residual
        What its forces leave of the load, at most; zero is a balance.
    n_leaves
        How many cases its trees tell apart.
    speed
        In loads, scaled as in (5.3). "strong": no motion is faster with contact forces that add up to one load, and
        with f loads none faster than the root of f times as much. "weak": that of the other onset. Else zero.
    """

    uniqueness: Uniqueness
    residual: float
    n_leaves: int
    speed: float


def check_certificate(certificate: Certificate | None, run: Run, phase: int = -1) -> CertificateCheck:
    """Check a certificate against a run's scene and the pose at the end of a phase.

    Checked are: contacts, friction and choices of faces are those of the scene; forces inside their cones balance the
    load; the nodes of each tree cover all cases of those that they divide; and the twist of each leaf proves, by
    (5.20), that no motion begins there. Or, of another onset, Coulomb's law (5.7).

    Parameters
    ----------
    certificate
        From `certificate` or `load_certificates`; None proves nothing.
    run
        Of which the scene, the method's friction, and the phase's pose count.
    phase
        Its number, from 0; the last one.

    Raises
    ------
    CertificateError
        It proves nothing: says where, what was found, and what was to be there.
    IndexError
        The run has no such phase.
    """
    if certificate is None:
        raise CertificateError("there is none: cagepose.certificate says why, such as an object that moves")
    expect(certificate, Certificate, "certificate")
    expect(run, Run, "run")
    if certificate.uniqueness not in get_args(Uniqueness):
        raise CertificateError(
            f"uniqueness is {certificate.uniqueness!r}; it is one of {', '.join(get_args(Uniqueness))}"
        )
    number = range(len(run.phases))[phase]
    problem = contact_problem(run, number)
    places = _places(certificate, problem)
    _check_geometry(certificate, problem, places, run.scene.size_m)
    _check_choices(certificate, places, problem)
    residual, n_leaves, speed = 0.0, 0, 0.0
    for number, choice in enumerate(certificate.choices):
        checked = _Choice(problem, [places[contact] for contact in choice.contacts], f"choices[{number}]")
        residual = max(residual, checked.balance(choice))
        if certificate.uniqueness == "strong":
            if choice.tree is None:
                raise CertificateError(f"choices[{number}] has no tree, so another onset is not ruled out")
            speed = max(speed, checked.speed_limit(choice.tree))
            n_leaves += len(choice.tree.leaves())
    if certificate.uniqueness == "weak":
        onset = certificate.onset
        if onset is None:
            raise CertificateError("onset is missing, and rest is said to be one of several")
        speed = _Choice(problem, _taken(onset, places), "onset").speed(onset)
    return CertificateCheck(certificate.uniqueness, residual, n_leaves, speed)


def _places(certificate: Certificate, problem: ContactProblem) -> list[int]:
    """Return where each contact of the certificate is among those of the problem."""
    places = {face: place for place, face in enumerate(problem.faces)}
    told = set(certificate.contacts)
    for face in certificate.contacts:
        if face not in places:
            raise CertificateError(f"contacts name {face}, which does not touch at this pose; {OTHER_PHASE}")
    for face in problem.faces:
        if face not in told:
            raise CertificateError(f"contacts leave out {face}, which touches at this pose; {OTHER_PHASE}")
    if len(certificate.contacts) != len(places):
        raise CertificateError("contacts name one of them twice")
    found = [places[face] for face in certificate.contacts]
    if len(certificate.friction) != len(found):
        raise CertificateError(f"friction has {len(certificate.friction)} coefficients for {len(found)} contacts")
    for face, told, own in zip(certificate.contacts, certificate.friction, problem.friction[found], strict=True):
        if told != own:
            raise CertificateError(f"friction of {face} is {float(told)!r}, and the scene's is {float(own)!r}")
    return found


def _check_geometry(certificate: Certificate, problem: ContactProblem, found: list[int], size_m: float) -> None:
    """Contacts must be where the certificate says, with its normals and tangents, for whoever checks it by hand."""
    for told, own, unit, name, what in (
        (certificate.places_world, problem.places[found], size_m, "m", "places_world"),
        (certificate.directions_world, problem.directions[found], 1.0, "rad", "directions_world"),
    ):
        if told.shape != own.shape:
            raise CertificateError(f"{what} has {len(told)} entries for {len(own)} contacts")
        apart = np.abs(told - own).reshape(len(own), -1).max(axis=1, initial=0.0)
        for number in np.nonzero(~(apart <= SAME_PLACE_OF_SIZE * unit))[0][:1]:
            face = certificate.contacts[number]
            raise CertificateError(
                f"{what} of {face} is {apart[number]:.1e} {name} off from the scene's at this pose, and at most"
                f" {SAME_PLACE_OF_SIZE * unit:.1e} counts as the same; {OTHER_PHASE}"
            )


def _taken(onset: OtherOnset, places: list[int]) -> list[int]:
    return [places[contact] for contact in _known(onset.contacts, len(places), "onset.contacts")]


def _known(contacts: tuple[int, ...], n: int, where: str) -> tuple[int, ...]:
    for contact in contacts:
        if not 0 <= contact < n:
            raise CertificateError(f"{where} name contact {contact}, and there are {n}, counted from 0")
    return contacts


def _check_choices(certificate: Certificate, places: list[int], problem: ContactProblem) -> None:
    """Each choice of one face of each group must be there."""
    given = [frozenset(places[k] for k in _known(choice.contacts, len(places), f"choices[{number}].contacts"))
             for number, choice in enumerate(certificate.choices)]  # fmt: skip
    if certificate.onset is not None:
        given.append(frozenset(_taken(certificate.onset, places)))
    wanted = {frozenset(choice) for choice in product(*problem.groups)}
    for choice in given:
        if choice not in wanted:
            raise CertificateError("choices hold one that takes not just one face of each point and box")
    missing = wanted - set(given[: len(certificate.choices)])
    if missing:
        first = ", ".join(str(problem.faces[place]) for place in sorted(missing.pop()))
        raise CertificateError(f"choices leave out the one with {first or 'no contact'}")


class _Modes(NamedTuple):
    """What a node says of one contact: whether it opens, whether it slips, and the sector, radians."""

    opening: Decision = "none"
    slipping: Decision = "none"
    start: float = 0.0
    width: float = 2.0 * pi


class _Choice:
    """The contacts of one choice of faces, in loads."""

    def __init__(self, problem: ContactProblem, places: list[int], where: str) -> None:
        self.problem, self.places, self.where = problem, places, where
        self.wrenches, self.friction = problem.wrenches[places], problem.friction[places]
        self.sizes = np.linalg.norm(problem.scaled(self.wrenches[:, 0]), axis=1)

    def _refuse(self, where: str, what: str) -> CertificateError:
        return CertificateError(f"{self.where}{where} {what}")

    def _check_forces(self, forces: FloatArray) -> None:
        if forces.shape != (len(self.places), 3) or not np.isfinite(forces).all():
            raise self._refuse(".forces", f"are not three numbers for each of {len(self.places)} contacts")

    def balance(self, choice: ChosenFaces) -> float:
        """Return what forces inside the cones leave of the load."""
        self._check_forces(choice.forces)
        friction = np.linalg.norm(choice.forces[:, 1:], axis=1)
        beyond = np.maximum(-choice.forces[:, 0], friction - self.friction * choice.forces[:, 0])
        wrench = np.einsum("ij,ijk->k", choice.forces, self.wrenches)
        left = float(np.linalg.norm(self.problem.scaled(self.problem.load - wrench)))
        outside = float((beyond * self.sizes).max(initial=0.0))
        if outside > FORCE_OUTSIDE_CONE * (1.0 + float(np.abs(choice.forces).max(initial=0.0))):
            raise self._refuse(".forces", f"leave their friction cones by {outside:.1e} loads")
        most = RESIDUAL_OF_BALANCE + ROUNDING_OF_FORCES * float(np.abs(choice.forces).sum())
        if left > most:
            raise self._refuse(".forces", f"leave {left:.1e} of the load, and at most {most:.1e} is a balance")
        return left

    def speed_limit(self, tree: ModeTree) -> float:
        """Return a speed that no motion exceeds which the leaves do not rule out, for forces of one load."""
        self._check_form(tree)
        children: dict[int, list[int]] = {}
        for node, parent in enumerate(tree.parents[1:], start=1):
            children.setdefault(parent, []).append(node)
        for node, parts in children.items():
            self._check_cover(tree, node, parts)
        driven = left = 0.0
        for number, leaf in enumerate(tree.leaves()):
            modes = [self._modes(tree, leaf, contact) for contact in range(len(self.places))]
            where = f".tree, leaf {number} (node {leaf}):"
            power = self._driven(tree.twists[number], modes)
            if not power <= POWER_OF_NONE:
                raise self._refuse(where, f"the load or a contact force drives its twist by {power:.1e}")
            rest = self._left(tree.twists[number], tree.pressures[number], modes)
            if not rest <= RESIDUAL_OF_LEAF:
                raise self._refuse(where, f"its twist leaves motions that begin, as {rest:.1e} of the load drives them")
            driven, left = max(driven, power), max(left, rest)
        return 0.5 * left + float(np.sqrt(0.25 * left * left + 2.0 * driven))  # v^2 <= left v + driven (1 + 1)

    def _check_form(self, tree: ModeTree) -> None:
        n, n_leaves = len(tree.parents), len(tree.leaves())
        rows = {len(tree.contacts), len(tree.decisions), len(tree.starts_rad), len(tree.widths_rad)}
        if rows != {n} or n == 0 or tree.parents[0] != -1:
            raise self._refuse(".tree", "has lists of nodes of different lengths, or no root")
        if not all(np.isfinite(a).all() for a in (tree.starts_rad, tree.widths_rad, tree.twists, tree.pressures)):
            raise self._refuse(".tree", "has a number that is not finite")
        if tree.twists.shape != (n_leaves, 6) or tree.pressures.shape != (n_leaves, len(self.places), 3):
            raise self._refuse(".tree", f"has {n_leaves} leaves, and not one twist and one set of pressures for each")
        for node, parent in enumerate(tree.parents[1:], start=1):
            if not 0 <= parent < node:
                raise self._refuse(f".tree, node {node}:", f"its parent {parent} does not come before it")
        _known(tree.contacts[1:], len(self.places), f"{self.where}.tree.contacts")

    def _modes(self, tree: ModeTree, node: int, contact: int) -> _Modes:
        """Return what a node and those above it say of a contact: the nearest word counts."""
        found = _Modes()
        for one in tree.above(node):
            decision = tree.decisions[one]
            if tree.contacts[one] != contact:
                continue
            if decision in ("opens", "closed") and found.opening == "none":
                found = found._replace(opening=decision)
            if decision in ("sticks", "slips") and found.slipping == "none":
                start, width = float(tree.starts_rad[one]), float(tree.widths_rad[one])
                found = found._replace(slipping=decision, start=start, width=width)
        return found

    def _check_cover(self, tree: ModeTree, node: int, parts: list[int]) -> None:
        """The cases that a node is divided into must be all that it leaves open of one contact."""
        where = f".tree, node {node}:"
        contacts = {tree.contacts[part] for part in parts}
        if len(contacts) > 1:
            raise self._refuse(where, "its parts decide different contacts")
        above = self._modes(tree, node, contacts.pop())
        decisions = sorted(tree.decisions[part] for part in parts)
        if decisions == ["closed", "opens"] and above.opening == "none":
            return
        slips = [part for part in parts if tree.decisions[part] == "slips"]
        others = [decision for decision in decisions if decision != "slips"]
        if others != ([] if above.slipping == "slips" else ["sticks"]) or above.slipping == "sticks":
            raise self._refuse(where, f"its parts ({', '.join(decisions)}) are not all that a contact may do")
        origin = above.start if above.slipping == "slips" or not slips else float(tree.starts_rad[slips[0]])
        sectors = [
            (float((tree.starts_rad[part] - origin + GAP_OF_SECTORS_RAD) % (2.0 * pi)), float(tree.widths_rad[part]))
            for part in slips
        ]
        reached = 0.0
        for start, width in sorted(sectors):
            if start > reached + 2.0 * GAP_OF_SECTORS_RAD:
                break
            reached = max(reached, start + width)
        if reached < above.width - GAP_OF_SECTORS_RAD:
            raise self._refuse(where, f"its sectors leave out {above.width - reached:.1e} rad of the slips in it")

    def _driven(self, twist: FloatArray, modes: list[_Modes]) -> float:
        """Return the most power of the load along a twist, or of a unit force against it (5.20)."""
        along = self.wrenches @ twist
        power = float(self.problem.load @ twist)
        for (normal, one, two), coefficient, size, mode in zip(along, self.friction, self.sizes, modes, strict=True):
            if mode.opening == "opens":
                continue  # it gives no force
            steepest = float(np.arctan2(-two, -one))
            is_inside = (steepest - mode.start) % (2.0 * pi) <= mode.width
            angles = [steepest] if mode.slipping != "slips" or is_inside else [mode.start, mode.start + mode.width]
            friction = max(float(-one * np.cos(angle) - two * np.sin(angle)) for angle in angles)
            power = max(power, float(-normal + coefficient * friction) / float(size))
        return power

    def _left(self, twist: FloatArray, pressures: FloatArray, modes: list[_Modes]) -> float:
        """Return how much of b - D z drives motions that the contacts allow (5.20): zero proves that there are none."""
        wrench = np.einsum("ij,ijk->k", pressures, self.wrenches)
        rest = self.problem.scaled(self.problem.load - wrench) - self.problem.scaled_twist(twist)
        left = float(np.linalg.norm(rest))
        for (normal, *across), size, mode in zip(pressures, self.sizes, modes, strict=True):
            wrong = 0.0 if mode.opening == "closed" else max(0.0, -float(normal))
            if mode.slipping == "slips":
                if mode.width >= pi:
                    return np.inf  # its edges do not say what lies between them
                ends = np.array([mode.start, mode.start + mode.width])
                wrong += max(0.0, float((across[0] * np.cos(ends) + across[1] * np.sin(ends)).max()))
            elif mode.slipping == "none":
                wrong += float(np.hypot(*across))
            left += wrong * float(size)
        return left

    def speed(self, onset: OtherOnset) -> float:
        """Return the speed of the motion that forces leave, if both obey Coulomb's law (5.7)."""
        self._check_forces(onset.forces)
        load, wrenches = self.problem.scaled(self.problem.load), self.problem.scaled(self.wrenches)
        motion = load - np.einsum("ij,ijk->k", onset.forces, wrenches)
        speed, power = float(np.linalg.norm(motion)), float(load @ motion)
        if speed < LEAST_MOTION or power <= 0.0:
            raise self._refuse("", f"is no motion that the load drives: {speed:.1e} loads fast")
        rates = (wrenches @ motion) / self.sizes[:, None]
        forces = onset.forces * self.sizes[:, None]
        slips, friction = np.linalg.norm(rates[:, 1:], axis=1), np.linalg.norm(forces[:, 1:], axis=1)
        missing = self.friction * forces[:, 0] * slips - np.einsum("ij,ij->i", forces[:, 1:], rates[:, 1:])
        violated = [
            rates[:, 0],  # goes in
            -forces[:, 0],  # pulls
            np.minimum(-rates[:, 0], forces[:, 0]),  # carries, and opens
            friction - self.friction * forces[:, 0],  # is outside its cone
            np.minimum(
                slips, missing / np.maximum(slips, VIOLATION_OF_COULOMB)
            ),  # slips, friction not full or not against it
        ]
        worst = float(np.max(violated, initial=0.0))
        if not worst <= VIOLATION_OF_COULOMB * (1.0 + float(np.abs(forces).max(initial=0.0))):
            raise self._refuse("", f"violates Coulomb's law by {worst:.1e} loads")
        return speed

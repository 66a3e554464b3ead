"""Is what a certificate says of one choice of faces right? `CheckedChoice`: balance, tree, another onset; by (5.33)."""

from __future__ import annotations

from math import pi
from typing import NamedTuple

import numpy as np

from cagepose.errors import CertificateError
from cagepose.model.checks import FloatArray
from cagepose.model.wording import number_of
from cagepose.studies.certificate import ChosenFaces, OtherOnset
from cagepose.studies.contact_problem import ContactProblem
from cagepose.studies.contacts_check import known_contacts
from cagepose.studies.mode_tree import Decision, ModeTree
from cagepose.studies.tolerances import (
    FORCE_OUTSIDE_CONE,
    GAP_OF_SECTORS_RAD,
    LEAST_MOTION,
    POWER_OF_NONE,
    RESIDUAL_OF_BALANCE,
    RESIDUAL_OF_LEAF,
    ROUNDING_OF_FORCES,
    VIOLATION_OF_COULOMB,
)


class _Modes(NamedTuple):
    """What a node says of one contact: whether it opens, whether it slips, and the sector, radians."""

    opening: Decision = "none"
    slipping: Decision = "none"
    start: float = 0.0
    width: float = 2.0 * pi


class CheckedChoice:
    """The contacts of one choice of faces, in loads.

    ``beside``: a wrench that may act to any extent beside the load, if there is one.
    """

    def __init__(
        self, problem: ContactProblem, places: list[int], where: str, beside: FloatArray | None = None
    ) -> None:
        self.problem, self.places, self.where, self.beside = problem, places, where, beside
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
        driven, left = self.limits(tree)
        return 0.5 * left + float(np.sqrt(0.25 * left * left + 2.0 * driven))  # v^2 <= left v + driven (1 + 1)

    def limits(self, tree: ModeTree) -> tuple[float, float]:
        """Return the two bounds of (5.33) that all leaves of a tree keep, epsilon and delta."""
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
        return driven, left

    def _check_form(self, tree: ModeTree) -> None:
        n, n_leaves = len(tree.parents), len(tree.leaves())
        rows = {len(tree.contacts), len(tree.decisions), len(tree.starts_rad), len(tree.widths_rad)}
        if rows != {n} or n == 0 or tree.parents[0] != -1:
            raise self._refuse(".tree", "has lists of nodes of different lengths, or no root")
        if not all(np.isfinite(a).all() for a in (tree.starts_rad, tree.widths_rad, tree.twists, tree.pressures)):
            raise self._refuse(".tree", "has a number that is not finite")
        if tree.twists.shape != (n_leaves, len(self.problem.load)) or tree.pressures.shape != (
            n_leaves,
            len(self.places),
            3,
        ):
            raise self._refuse(
                ".tree",
                f"has {number_of(n_leaves, 'leaf', 'leaves')}, and not one twist and one set of pressures for each",
            )
        for node, parent in enumerate(tree.parents[1:], start=1):
            if not 0 <= parent < node:
                raise self._refuse(f".tree, node {node}:", f"its parent {parent} does not come before it")
        known_contacts(tree.contacts[1:], len(self.places), f"{self.where}.tree.contacts")

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
        if self.beside is not None:
            power = max(power, float(self.beside @ twist))
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

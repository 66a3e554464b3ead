"""What the contacts of a rest can balance, whichever faces count at edges: `Balances`, for margins and questions."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from itertools import islice, product

import numpy as np
from numpy.typing import NDArray

from cagepose.kernels.algebra.linear_program import OPTIMAL
from cagepose.kernels.contact.edges import CHOICES_LIMIT
from cagepose.model.checks import FloatArray
from cagepose.model.planar import held_freedoms
from cagepose.runs.actions import wrench_at
from cagepose.runs.cases import contact_friction
from cagepose.runs.driven_cage import cage_at_end
from cagepose.runs.drives import displaced_after
from cagepose.runs.judge import judge_pose
from cagepose.runs.methods import chosen_method
from cagepose.runs.run import AT_REST, STOPPED, Contact, Run
from cagepose.studies.arcs import places_on_arcs
from cagepose.studies.contact_cones import (
    ConeProgram,
    ContactCones,
    contact_cones,
    greatest_normal_force,
    least_normal_force,
)
from cagepose.studies.equal_stiffness import equally_stiff_forces
from cagepose.studies.extra_load import ExtraLoad, least_extra_load
from cagepose.studies.tolerances import (
    GREATEST_FORCE,
    LEAST_EXTRA_LOAD,
    RESIDUAL_OF_NONE,
    VIOLATION_FOR_BOUNDS,
    VIOLATION_FOR_RANGES,
)

NEVER_COUNTS = -1
"""The group of a contact that does not count."""


def balances_of(run: Run, phase: int) -> Balances | None:
    """Return what the contacts at the end of a phase, counted from 0, can balance.

    None where it did not end in a balance to first order, or in one without contacts or without a load on them, where
    bodies press, and where points on edges have more than 729 choices of faces.
    """
    ended = run.phases[phase]
    if run.scene.loads[phase].press:
        return None
    if ended.verdict not in AT_REST | STOPPED or ended.proof.verdict == "moves" or not ended.contacts:
        return None
    contacts, choices = choices_of(_told_contacts(run, phase))
    if choices is None:
        return None
    cones = _cones(run, phase, [*contacts, *places_on_arcs(run, phase)])
    load, size_n = _load(run, phase, cones)
    if size_n == 0.0:
        return None
    counts = [_counting(len(contacts), choice) for choice in choices]
    found = Balances(contacts, cones, load, size_n, counts, held_freedoms(run.scene.planar) == 0.0)
    return found if found.are_balanced else None


class Balances:
    """The answers over all choices of faces at edges: the object is held only if it is with every one of them.

    Attributes
    ----------
    contacts
        Those that are listed. The first cones are theirs; others, along arcs, count where a load is to be balanced.
    load, size_n
        The wrench that contacts have to give, (6,), as the cones have it, of length 1, and what it was divided by.
    is_free
        Which of the six numbers of a wrench contacts have to give: not those that a plane carries, (6,).
    shares
        Forces of equally stiff contacts, along normal and tangents, (n, 3), in parts of the load.
    """

    def __init__(
        self,
        contacts: list[Contact],
        cones: ContactCones,
        load: FloatArray,
        size_n: float,
        counts: list[FloatArray],
        is_free: NDArray[np.bool_],
    ) -> None:
        self.all_cones, self.cones = cones, cones.some(np.arange(len(cones.columns)) < len(contacts))
        self.contacts, self.load, self.size_n, self._counts = contacts, load, size_n, counts
        self.is_free = is_free
        forces = [self._forces(of_choice, load) for of_choice in counts]
        self.balanced = [self.cones.wrench(of_choice) for of_choice in forces]
        self.are_balanced = all(float(np.linalg.norm(load - given)) <= RESIDUAL_OF_NONE for given in self.balanced)
        self.shares = np.mean(forces, axis=0)

    def _forces(self, counts: FloatArray, load: FloatArray) -> FloatArray:
        """Return the forces of equally stiff contacts with one choice of faces, (n, 3)."""
        forces = np.zeros((len(counts), 3))
        chosen = np.isfinite(counts)
        forces[chosen] = equally_stiff_forces(self.cones.some(chosen), load)
        return forces

    def tangential(self) -> FloatArray:
        """Return the shares across the normals, in the world, (n, 3)."""
        return np.asarray(np.einsum("ij,ijk->ik", self.shares[:, 1:], self.cones.columns[:, 1:, :3]))

    def least_extra_load(self, axes: slice) -> ExtraLoad:
        program = ConeProgram(self.all_cones, VIOLATION_FOR_BOUNDS)
        least = ExtraLoad(math.inf, math.inf, np.zeros(3))
        for counts, load in zip(self._counts, self.balanced, strict=True):
            found = least_extra_load(program, load / np.linalg.norm(load), self._of_all(counts), axes, least.certain)
            least = min(least, found, key=lambda extra: extra.certain)
        return least

    def _of_all(self, counts: FloatArray) -> FloatArray:
        return np.append(counts, np.zeros(len(self.all_cones.columns) - len(counts)))

    def greatest_extra(self, extra: FloatArray) -> float:
        """Return how many times an extra load, (6,), as the cones have it, forces balance beside the load; certain, and
        as close as rays follow the cones. Infinite: however often.
        """
        program, least = ConeProgram(self.all_cones, VIOLATION_FOR_RANGES), math.inf
        for counts, load in zip(self._counts, self.balanced, strict=True):
            outcome, motion = program.greatest(extra, self._of_all(counts), load)
            if outcome != OPTIMAL:
                return 0.0
            part = float(extra @ motion)
            least = min(least, 1.0 / part if part * GREATEST_FORCE > 1.0 else math.inf)
        return least if least > LEAST_EXTRA_LOAD else 0.0

    def shares_beside(self, extra: FloatArray) -> FloatArray:
        """Return the normal forces of equally stiff contacts beside an extra load, (6,), that they balance, (n,)."""
        load = self.load - self.is_free * extra
        found: FloatArray = np.mean([self._forces(counts, load)[:, 0] for counts in self._counts], axis=0)
        return found

    def ranges(self) -> Iterator[tuple[float, float]]:
        """Yield the least and greatest normal force of each contact, over the choices in which it counts."""
        program = ConeProgram(self.cones, VIOLATION_FOR_RANGES)
        for contact in range(len(self.cones.columns)):
            asked = [
                (load, counts)
                for load, counts in zip(self.balanced, self._counts, strict=True)
                if np.isfinite(counts[contact])
            ]
            least = min(least_normal_force(program, *given, contact) for given in asked)
            greatest = max(greatest_normal_force(program, *given, contact) for given in asked)
            yield least if least > LEAST_EXTRA_LOAD else 0.0, greatest if greatest < GREATEST_FORCE else math.inf


def choices_of(contacts: Iterable[Contact]) -> tuple[list[Contact], list[tuple[int, ...]] | None]:
    """Return the contacts that count, and all choices of one of each group, by their numbers; None: more than 729."""
    counting = [contact for contact in contacts if contact.group != NEVER_COUNTS]
    groups = dict[int | None, list[int]]()
    for number, contact in enumerate(counting):
        groups.setdefault(contact.group, []).append(number)
    choices = list(islice(product(*groups.values()), CHOICES_LIMIT + 1))
    return counting, None if len(choices) > CHOICES_LIMIT else choices


def _told_contacts(run: Run, phase: int) -> tuple[Contact, ...]:
    """Return the contacts at the end of a phase. A run that was saved before contacts told their groups is asked anew
    at its pose.
    """
    contacts = run.phases[phase].contacts
    if any(contact.group is None for contact in contacts):
        friction = chosen_method(run.scene, run.method).friction(run.scene)
        contacts = judge_pose(run.scene, run.phases[phase].pose, phase, friction, displaced_after(run, phase))[1]
    return contacts


def _cones(run: Run, phase: int, contacts: list[Contact]) -> ContactCones:
    center = run.phases[phase].pose.transform(run.scene.object.center_of_gravity_m)
    places = dict(zip(run.scene.cage.names, cage_at_end(run, phase).points_world, strict=True))
    normals = np.array([-contact.normal_world for contact in contacts]).reshape(-1, 3)
    at = [places.get(contact.point, contact.place_world) for contact in contacts]
    arms = np.array(at).reshape(-1, 3) - center
    of_scene = chosen_method(run.scene, run.method).friction(run.scene)
    friction = [contact_friction(run.scene, of_scene, contact.point, contact.box) for contact in contacts]
    cones = contact_cones(normals, arms, np.array(friction))
    return cones if run.scene.planar is None else _between_guides(cones, held_freedoms(run.scene.planar))


def _between_guides(cones: ContactCones, held: FloatArray) -> ContactCones:
    """Return the cones of contacts in a plane, and behind them those of what holds it, both ways, without friction."""
    ways = np.eye(len(held))[held == 1.0]
    guides = np.zeros((2 * len(ways), 3, len(held)))
    guides[:, 0] = np.concatenate([ways, -ways])
    columns = np.concatenate([(1.0 - held) * cones.columns, guides])
    return cones._replace(columns=columns, friction=np.append(cones.friction, np.zeros(len(guides))))


def _load(run: Run, phase: int, cones: ContactCones) -> tuple[FloatArray, float]:
    """Return the wrench that contacts have to give, (6,), and the length that it was divided by."""
    load = wrench_at(run.scene, phase, run.phases[phase].pose, displaced_after(run, phase))
    wrench = -np.append(load.force, load.moment / cones.length_m) * (1.0 - held_freedoms(run.scene.planar))
    size = float(np.linalg.norm(wrench))
    return wrench / (size or 1.0), size


def _counting(n_contacts: int, choice: tuple[int, ...]) -> FloatArray:
    """Return 0 for faces that count, and -inf for the others of their groups, (n,)."""
    counts = np.full(n_contacts, -np.inf)
    counts[list(choice)] = 0.0
    return counts

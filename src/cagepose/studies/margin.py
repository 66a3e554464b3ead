"""How far a rest is from giving way: `margin`, what its contacts balance beside the load and how they may share it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice, product

import numpy as np

from cagepose.kernels.contact.edges import CHOICES_LIMIT
from cagepose.model.checks import FloatArray, expect
from cagepose.model.wording import counted
from cagepose.runs.actions import wrench_at
from cagepose.runs.cases import contact_friction
from cagepose.runs.driven_cage import cage_at_end
from cagepose.runs.drives import displaced_after
from cagepose.runs.judge import judge_pose
from cagepose.runs.load_scaling import scaled_load
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
FORCES, MOMENTS = slice(0, 3), slice(3, 6)
"""Places of the forces and of the moments of a wrench."""


@dataclass(frozen=True, eq=False)
class ContactMargin:
    """What one contact may carry; newtons, or parts of the load, as in `Contact`.

    Attributes
    ----------
    point, box, place_world
        Names, and where they touch, as in `Contact`.
    least_n, greatest_n
        Of its normal force, over all forces that balance the load; the greatest is infinite where contacts can press
        against each other without end, as in a wedge.
    equally_stiff_n
        Its normal force if all contacts are equally stiff, along the normal and across.
    equally_stiff_tangential_n
        Force across the normal on the object then, (3,), in the world.
    """

    point: str
    box: str
    place_world: FloatArray | None
    least_n: float
    greatest_n: float
    equally_stiff_n: float
    equally_stiff_tangential_n: FloatArray

    def __repr__(self) -> str:
        normal = f"{self.equally_stiff_n:.4g} ({self.least_n:.4g} to {self.greatest_n:.4g})"
        return f"<ContactMargin of {self.point!r} with {self.box!r}: {normal}>"


@dataclass(frozen=True, eq=False)
class Margin:
    """What the contacts of a rest can balance beside the load. That they can does not say that they must: see `Proof`.

    Attributes
    ----------
    in_newtons
        Whether forces are newtons and moments newton metres; else they are parts of the load, and moments times metres.
    force_n, moment_nm
        Whichever way an extra force at the centre of gravity (an extra moment) of less than this points, forces inside
        the friction cones balance it beside the load: certain. Infinite: however large it is.
    force_below_n, moment_below_nm
        One of this much is not balanced (to 1e-5 of it). At most a thousandth above the certain value (5.23).
    force_direction_world, moment_direction_world
        Which one, unit vectors (3,); zero where there is none.
    contacts
        In the order of the phase's contacts, without flush faces that say the same.
    """

    in_newtons: bool
    force_n: float
    force_below_n: float
    force_direction_world: FloatArray
    moment_nm: float
    moment_below_nm: float
    moment_direction_world: FloatArray
    contacts: tuple[ContactMargin, ...]

    def __repr__(self) -> str:
        units = ("N", "N m") if self.in_newtons else ("of the load", "m times the load")
        extra = f"force {self.force_n:.4g} {units[0]}, moment {self.moment_nm:.4g} {units[1]}"
        return f"<Margin: {extra}, {counted((len(self.contacts), 'contact', 'contacts'))}>"


def margin(run: Run, phase: int = -1) -> Margin | None:
    """Say how large an extra force and moment a phase's end still balances, and what each contact may carry.

    Bodies of the cage stand where they were driven to. Returns None where the phase did not end in a balance, or in one
    without contacts or without a load on them, as on springs; where contacts without play carry its load to second
    order, by forces without bound; where bodies press, of which `press_limits` tells; and where points on edges have
    more than 729 choices of faces.

    Parameters
    ----------
    run
        Of either method.
    phase
        Its number, from 0; the last one.

    Raises
    ------
    IndexError
        The run has no such phase.
    """
    expect(run, Run, "run")
    number = range(len(run.phases))[phase]
    ended = run.phases[number]
    if run.scene.loads[number].press:
        return None
    if ended.verdict not in AT_REST | STOPPED or ended.proof.verdict == "moves" or not ended.contacts:
        return None
    contacts, groups = _counting_contacts(run, number)
    choices = list(islice(product(*groups), CHOICES_LIMIT + 1))
    if len(choices) > CHOICES_LIMIT:
        return None
    cones = _cones(run, number, [*contacts, *places_on_arcs(run, number)])
    load, size_n = _load(run, number, cones)
    if size_n == 0.0:
        return None
    found = _Choices(cones, len(contacts), load, [_counting(len(contacts), choice) for choice in choices])
    if not found.are_balanced:
        return None
    force, moment = found.least_extra_load(FORCES), found.least_extra_load(MOMENTS)
    arm = size_n * cones.length_m
    return Margin(
        scaled_load(run.scene, run.scene.loads[number]).in_newtons,
        size_n * force.certain,
        size_n * force.found,
        force.direction,
        arm * moment.certain,
        arm * moment.found,
        moment.direction,
        tuple(
            ContactMargin(
                contact.point,
                contact.box,
                contact.place_world,
                size_n * least,
                size_n * greatest,
                float(size_n * share[0]),
                tangential,
            )
            for contact, (least, greatest), share, tangential in zip(
                contacts, found.ranges(), found.shares, size_n * found.tangential(), strict=True
            )
        ),
    )


def _counting_contacts(run: Run, phase: int) -> tuple[list[Contact], list[list[int]]]:
    """Return the contacts that count, and groups of their numbers, of which one counts at a time.

    A run that was saved before contacts told their groups is asked anew at its pose.
    """
    contacts = run.phases[phase].contacts
    if any(contact.group is None for contact in contacts):
        friction = chosen_method(run.scene, run.method).friction(run.scene)
        contacts = judge_pose(run.scene, run.phases[phase].pose, phase, friction, displaced_after(run, phase))[1]
    counting = [contact for contact in contacts if contact.group != NEVER_COUNTS]
    groups = dict[int | None, list[int]]()
    for number, contact in enumerate(counting):
        groups.setdefault(contact.group, []).append(number)
    return counting, list(groups.values())


def _cones(run: Run, phase: int, contacts: list[Contact]) -> ContactCones:
    center = run.phases[phase].pose.transform(run.scene.object.center_of_gravity_m)
    places = dict(zip(run.scene.cage.names, cage_at_end(run, phase).points_world, strict=True))
    normals = np.array([-contact.normal_world for contact in contacts]).reshape(-1, 3)
    at = [places.get(contact.point, contact.place_world) for contact in contacts]
    arms = np.array(at).reshape(-1, 3) - center
    of_scene = chosen_method(run.scene, run.method).friction(run.scene)
    friction = [contact_friction(run.scene, of_scene, contact.point, contact.box) for contact in contacts]
    return contact_cones(normals, arms, np.array(friction))


def _load(run: Run, phase: int, cones: ContactCones) -> tuple[FloatArray, float]:
    """Return the wrench that contacts have to give, (6,), and the length that it was divided by."""
    load = wrench_at(run.scene, phase, run.phases[phase].pose, displaced_after(run, phase))
    wrench = -np.append(load.force, load.moment / cones.length_m)
    size = float(np.linalg.norm(wrench))
    return wrench / (size or 1.0), size


def _counting(n_contacts: int, choice: tuple[int, ...]) -> FloatArray:
    """Return 0 for faces that count, and -inf for the others of their groups, (n,)."""
    counts = np.full(n_contacts, -np.inf)
    counts[list(choice)] = 0.0
    return counts


class _Choices:
    """The answers over all choices of faces at edges: the object is held only if it is with every one of them.

    The first cones are those of contacts that are listed. Others, along arcs, count where a load is to be balanced.
    """

    def __init__(self, cones: ContactCones, n_listed: int, load: FloatArray, counts: list[FloatArray]) -> None:
        self.all_cones, self.cones = cones, cones.some(np.arange(len(cones.columns)) < n_listed)
        self.load, self.counts = load, counts
        forces = [self._forces(of_choice) for of_choice in counts]
        self.balanced = [self.cones.wrench(of_choice) for of_choice in forces]
        self.are_balanced = all(float(np.linalg.norm(load - given)) <= RESIDUAL_OF_NONE for given in self.balanced)
        self.shares = np.mean(forces, axis=0)

    def _forces(self, counts: FloatArray) -> FloatArray:
        """Return the forces of equally stiff contacts with one choice of faces, (n, 3)."""
        forces = np.zeros((len(counts), 3))
        chosen = np.isfinite(counts)
        forces[chosen] = equally_stiff_forces(self.cones.some(chosen), self.load)
        return forces

    def tangential(self) -> FloatArray:
        """Return the shares across the normals, in the world, (n, 3)."""
        return np.asarray(np.einsum("ij,ijk->ik", self.shares[:, 1:], self.cones.columns[:, 1:, :3]))

    def least_extra_load(self, axes: slice) -> ExtraLoad:
        program = ConeProgram(self.all_cones, VIOLATION_FOR_BOUNDS)
        least = ExtraLoad(math.inf, math.inf, np.zeros(3))
        for counts, load in zip(self.counts, self.balanced, strict=True):
            all_counts = np.append(counts, np.zeros(len(self.all_cones.columns) - len(counts)))
            found = least_extra_load(program, load / np.linalg.norm(load), all_counts, axes, least.certain)
            least = min(least, found, key=lambda extra: extra.certain)
        return least

    def ranges(self) -> Iterator[tuple[float, float]]:
        """Yield the least and greatest normal force of each contact, over the choices in which it counts."""
        program = ConeProgram(self.cones, VIOLATION_FOR_RANGES)
        for contact in range(len(self.cones.columns)):
            asked = [
                (load, counts)
                for load, counts in zip(self.balanced, self.counts, strict=True)
                if np.isfinite(counts[contact])
            ]
            least = min(least_normal_force(program, *given, contact) for given in asked)
            greatest = max(greatest_normal_force(program, *given, contact) for given in asked)
            yield least if least > LEAST_EXTRA_LOAD else 0.0, greatest if greatest < GREATEST_FORCE else math.inf

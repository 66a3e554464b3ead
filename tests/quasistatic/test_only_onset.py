"""The short proof of uniqueness, (5.18) to (5.20), against the search through all contact modes and by its own terms.

Contact sets are random: level feet, feet under and over plates, grooves, faces of boxes, any normals; parallel and
nearly dependent ones among them, and a load that some forces inside the cones balance.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest
from scipy.optimize import nnls

from cagepose.kernels.algebra.least_squares import empty_system
from cagepose.kernels.algebra.record import empty_record
from cagepose.kernels.contact.contact_set import ContactSet, empty_contact_set
from cagepose.kernels.contact.coulomb_newton import NewtonWorkspace
from cagepose.kernels.stability.second_order import StabilityWorkspace
from cagepose.kernels.stability.uniqueness import N_COLUMNS, OTHER_FOUND, UNIQUE, ModesWorkspace, other_onset
from cagepose.kernels.stability.uniqueness_bound import BoundWorkspace, find_carrying, rest_is_unique, write_normals
from inner_kernels import as_machine_code


class Held(NamedTuple):
    """Contacts with the columns (n, 3, 6) of (5.3), a coefficient of friction, and a load of length 1 (7,)."""

    columns: np.ndarray
    friction: float
    load: np.ndarray


def columns_of(normals: np.ndarray, arms: np.ndarray, radii: np.ndarray) -> np.ndarray:
    columns = np.zeros((len(normals), 3, 6))
    for i, normal in enumerate(normals / np.linalg.norm(normals, axis=1)[:, None]):
        first = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
        first /= np.linalg.norm(first)
        for j, direction in enumerate((normal, first, np.cross(normal, first))):
            columns[i, j] = np.concatenate([direction, np.cross(arms[i], direction) / radii])
    return columns


def random_normals(random: np.random.Generator, n: int) -> np.ndarray:
    sides = np.where(random.random(n) < 0.6, -1.0, 1.0)[:, None]
    normals = [
        random.normal(size=(n, 3)),
        np.tile([0.0, 0.0, -1.0], (n, 1)),
        sides * [0.0, 0.0, 1.0],
        sides * [1.0, 0.0, 0.0] - [0.0, 0.0, 1.0],
        sides * np.eye(3)[random.integers(0, 3, n)],
    ][random.integers(0, 5)]
    if random.random() < 0.3:
        normals = normals + 10.0 ** random.uniform(-10, -1) * random.normal(size=(n, 3))
    return normals


def random_held(random: np.random.Generator) -> Held:
    n = int(random.integers(2, 5))
    arms = random.uniform(-1, 1, (n, 3))
    if random.random() < 0.5:
        arms[:, 2] = random.uniform(-0.3, 0.0)
    if random.random() < 0.15:
        arms[1] = arms[0] + 1e-6 * random.normal(size=3)
    columns = columns_of(random_normals(random, n), arms, random.uniform(0.2, 1.0, 3))
    friction = float(random.choice([0.02, 0.1, 0.1, 0.3, 0.6, 1.0]))
    forces = random.uniform(0, 1, n) * (random.random(n) < 0.85)
    angles, parts = random.uniform(0, 2 * np.pi, n), random.choice([0.05, 0.3, 1.0]) * np.sqrt(random.random(n))
    tangents = columns[:, 1] * np.cos(angles)[:, None] + columns[:, 2] * np.sin(angles)[:, None]
    load = np.concatenate([forces @ columns[:, 0] + (friction * forces * parts) @ tangents, [0.0]])
    size = np.linalg.norm(load)
    return Held(columns, friction, load / size) if size > 1e-6 else random_held(random)


def contacts_of(held: Held) -> ContactSet:
    contacts = empty_contact_set(len(held.columns))
    contacts.used[0] = len(held.columns)
    for i, columns in enumerate(held.columns):
        contacts.rows[i].columns[:] = columns
        contacts.rows[i].group = i
        contacts.states[i].chosen = True
    return contacts


class Prover:
    """Both proofs of uniqueness, and the least forces behind the short one."""

    def __init__(self) -> None:
        self._search = as_machine_code(other_onset)
        self._sure, self._rest = empty_record(BoundWorkspace), empty_record(StabilityWorkspace)
        self._modes, self._newton = empty_record(ModesWorkspace), empty_record(NewtonWorkspace)
        self._system = empty_system(N_COLUMNS)

    def is_sure(self, held: Held) -> bool:
        at = contacts_of(held)
        return bool(rest_is_unique(at, held.friction, held.load, 1.0, self._sure, self._rest, self._system))

    def search(self, held: Held) -> int:
        at = contacts_of(held)
        return int(self._search(at, held.friction, held.load, self._modes, self._newton, self._system))

    def least_forces(self, held: Held) -> dict[int, float]:
        """What each contact that surely carries carries at least; asked without a balance."""
        at = contacts_of(held)
        _, sizes, axes = np.linalg.svd(held.columns[:, 0])
        rank = int((sizes > 1e-10 * sizes[0]).sum())
        self._rest.held.basis[:rank, :6] = axes[:rank]
        self._rest.held.used = rank
        write_normals(at, held.friction, self._rest.held, self._system)
        n = find_carrying(at, held.friction, held.load, self._sure, self._system)
        return {int(self._sure.contacts[k]): self._sure.limits[k] / held.friction for k in range(n)}


@pytest.fixture(scope="module")
def prover() -> Prover:
    return Prover()


def test_the_search_finds_no_other_onset_where_rest_is_sure(prover, cases):
    random, n = np.random.default_rng(20), cases(100, 800)
    answers = [prover.search(held) for held in (random_held(random) for _ in range(n)) if prover.is_sure(held)]
    assert answers.count(UNIQUE) == len(answers) > n // 4


def test_rest_is_never_sure_where_the_search_finds_another_onset(prover, cases):
    random, n = np.random.default_rng(21), cases(100, 800)
    others = [held for held in (random_held(random) for _ in range(n)) if prover.search(held) == OTHER_FOUND]
    assert len(others) > n // 100
    assert not any(prover.is_sure(held) for held in others)


def forces_under_friction(random: np.random.Generator, held: Held) -> np.ndarray | None:
    """Normal forces of a motion from rest under friction inside the cones, found by iteration; None: not found.

    Whatever the motion, they are those that leave the least of the load and of the friction (5.4). Friction is random,
    or full and along what loads or unloads one contact the most.
    """
    n = len(held.columns)
    angles, parts = random.uniform(0, 2 * np.pi, n), random.choice([1.0, 1.0, 0.5], n)
    if random.random() < 0.5:
        unloading = np.einsum(
            "k,jtk->jt", np.linalg.pinv(held.columns[:, 0].T)[random.integers(n)], held.columns[:, 1:]
        )
        angles, parts = np.arctan2(unloading[:, 1], unloading[:, 0]), random.choice([1.0, -1.0], n)
    rubbing = held.columns[:, 1] * np.cos(angles)[:, None] + held.columns[:, 2] * np.sin(angles)[:, None]
    rubbing *= held.friction * parts[:, None]
    forces = np.zeros(n)
    for _ in range(200):
        before = forces
        forces, _ = nnls(held.columns[:, 0].T, held.load[:6] - before @ rubbing)
        if np.abs(forces - before).max() < 1e-12:
            return forces
    return None


def test_contacts_carry_no_less_than_is_said_whatever_the_friction(prover, cases):
    random, n = np.random.default_rng(22), cases(50, 400)
    spare = []
    for held in (random_held(random) for _ in range(n)):
        least = prover.least_forces(held)
        for forces in (forces_under_friction(random, held) for _ in range(40 if least else 0)):
            if forces is not None:
                spare += [forces[i] - force for i, force in least.items()]
    assert len(spare) > 20 * n
    assert min(spare) > -1e-9


def slab(friction: float, tilt: float, height: float) -> Held:
    """A slab of radius of gyration 1 on four feet at (+-1, +-1), its centre ``height`` above; the load leans by
    ``tilt``.
    """
    feet = np.array([(x, y, -height) for x in (-1.0, 1.0) for y in (-1.0, 1.0)])
    columns = columns_of(np.tile([0.0, 0.0, -1.0], (4, 1)), feet, np.ones(3))
    return Held(columns, friction, np.array([np.sin(tilt), 0, -np.cos(tilt), 0, 0, 0, 0]))


def test_on_four_feet_no_single_one_surely_carries(prover):
    """Diagonal feet can carry it all, so each foot may carry nothing, though together they must."""
    assert prover.least_forces(slab(0.1, 0.0, 0.0)) == {}


@pytest.mark.parametrize(("lean", "sure"), [(0.99, True), (1.01, False)])
def test_on_three_low_feet_the_friction_of_all_that_they_carry_counts(prover, lean, sure):
    """With the centre at the height of the feet friction presses nowhere: each carries a third, and can be asked for mu
    times as much. Off by 1e-6 at either end of the proof, it succeeds up to the very limit of friction.
    """
    feet = np.array([(np.cos(t), np.sin(t), 0.0) for t in np.arange(3) * 2 * np.pi / 3])
    columns = columns_of(np.tile([0.0, 0.0, -1.0], (3, 1)), feet, np.ones(3))
    tilt = np.arctan(0.3 * lean)
    assert prover.is_sure(Held(columns, 0.3, np.array([np.sin(tilt), 0, -np.cos(tilt), 0, 0, 0, 0]))) is sure

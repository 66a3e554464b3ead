"""The search for another onset, (5.13) and (5.18) to (5.20): its proofs checked anew, and other ways to look for one.

Contact sets are random: level feet, feet under and over plates, grooves, faces of boxes, any normals; parallel and
nearly dependent ones among them, and a load that some forces inside the cones balance.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import pytest
from scipy.optimize import linprog, nnls, root

from audit.caged_families import pushed_block
from audit.uniqueness import violation
from cagepose import run
from cagepose.kernels.algebra.least_squares import empty_system
from cagepose.kernels.algebra.record import empty_record
from cagepose.kernels.boundary.geometry import empty_cage
from cagepose.kernels.contact.contact_set import ContactSet, empty_contact_set
from cagepose.kernels.contact.coulomb_newton import OPENS, SLIPS, STICKS, NewtonWorkspace
from cagepose.kernels.outcome.cases import start_of
from cagepose.kernels.stability.proof import empty_proof_workspace, stand_at
from cagepose.kernels.stability.relaxation import CLOSED, N_COLUMNS, UNDECIDED
from cagepose.kernels.stability.strong import FIRST_SECTORS, NOT_SHOWN, OTHER_FOUND, UNIQUE, ModeTree, other_onset
from cagepose.runs.cases import cases_of, part_of
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
        contacts.rows[i].columns[:, :6] = columns
        contacts.rows[i].group = i
        contacts.states[i].counts = True
    return contacts


class Leaf(NamedTuple):
    """What a leaf decides of each contact (n,), (n,), (n,), (n,), and its twist z (6,)."""

    openings: np.ndarray
    slips: np.ndarray
    starts: np.ndarray
    widths: np.ndarray
    twist: np.ndarray


class Search:
    """One search after the other, and its tree."""

    def __init__(self) -> None:
        self._search = as_machine_code(other_onset)
        self.tree, self._newton = empty_record(ModeTree), empty_record(NewtonWorkspace)
        self._system = empty_system(N_COLUMNS)

    def __call__(self, held: Held) -> int:
        at = contacts_of(held)
        answer = int(self._search(at, held.friction, held.load, self.tree, self._newton, self._system))
        self.forces = np.array([at.states[i].forces for i in range(at.used[0])])
        return answer

    def leaves(self, n: int) -> Iterator[Leaf]:
        """Yield the leaves; the nodes' parts must cover what they divide."""
        tree, n_nodes = self.tree, int(self.tree.n_nodes)
        children: list[list[int]] = [[] for _ in range(n_nodes)]
        for node in range(1, n_nodes):
            children[tree.parents[node]].append(node)
        undecided = np.full(n, UNDECIDED)
        waiting = [(0, Leaf(undecided, undecided, np.zeros(n), np.zeros(n), np.zeros(6)))]
        while waiting:
            node, above = waiting.pop()
            assert bool(tree.is_closed[node]) == (not children[node])
            if tree.is_closed[node]:
                yield above._replace(twist=tree.twists[node, :6].copy())
                continue
            parts = [(int(tree.modes[c]), float(tree.starts[c]), float(tree.widths[c])) for c in children[node]]
            (place,) = {int(tree.places[c]) for c in children[node]}
            assert covers(parts, above, place)
            for child, (mode, start, width) in zip(children[node], parts, strict=True):
                here = Leaf(*(array.copy() for array in above))
                if mode in (OPENS, CLOSED):
                    here.openings[place] = mode
                else:
                    here.slips[place], here.starts[place], here.widths[place] = mode, start, width
                waiting.append((child, here))


def covers(parts: list[tuple[int, float, float]], above: Leaf, place: int) -> bool:
    """Whether modes of one contact are all that there are: it opens or not; it sticks or slips in all directions, or in
    those of the sector above.
    """
    modes = sorted(mode for mode, _, _ in parts)
    if modes == [OPENS, CLOSED]:
        return bool(above.openings[place] == UNDECIDED)
    sectors = sorted((start, width) for mode, start, width in parts if mode == SLIPS)
    gapless = all(
        abs(one[0] + one[1] - other[0]) < 1e-12 for one, other in itertools.pairwise(sectors)
    )  # a motion so near to an edge is in neither, but for rounding
    if above.slips[place] == UNDECIDED:
        wide = abs(sum(width for _, width in sectors) - 2 * np.pi) < 1e-12
        return gapless and wide and modes == sorted([STICKS] + FIRST_SECTORS * [SLIPS])
    whole = (above.starts[place], above.starts[place] + above.widths[place])
    ends = (sectors[0][0], sectors[-1][0] + sectors[-1][1])
    return gapless and modes == [SLIPS, SLIPS] and bool(np.allclose(ends, whole, rtol=0, atol=1e-12))


def flaw(held: Held, leaf: Leaf) -> float:
    """By how much a leaf's twist z is no proof (5.20): power of the load or against forces along z, and what velocities
    that are not allowed leave of b - z.
    """
    z, load, worst, columns = leaf.twist, held.load[:6] / np.linalg.norm(held.load[:6]), 0.0, []
    worst = max(worst, float(z @ load) * 1e6)
    for i, wrenches in enumerate(held.columns / np.linalg.norm(held.columns[:, 0], axis=1)[:, None, None]):
        if leaf.openings[i] != OPENS:
            angles = np.linspace(0, 2 * np.pi, 1000)
            steepest = np.arctan2(-(wrenches[2] @ z), -(wrenches[1] @ z))
            angles = np.append(angles, steepest)
            if leaf.slips[i] == SLIPS:
                beyond = (angles - leaf.starts[i]) % (2 * np.pi)
                angles = np.append(angles[beyond <= leaf.widths[i]], leaf.starts[i] + np.array([0, leaf.widths[i]]))
            rays = wrenches[0] + held.friction * (
                np.outer(np.cos(angles), wrenches[1]) + np.outer(np.sin(angles), wrenches[2])
            )
            worst = max(worst, float((-rays @ z).max()) * 1e6)
        columns.append(wrenches[0])
        if leaf.openings[i] == CLOSED:
            columns.append(-wrenches[0])
        if leaf.slips[i] == STICKS:
            columns += [wrenches[1], -wrenches[1], wrenches[2], -wrenches[2]]
        elif leaf.slips[i] == SLIPS:
            for angle, sign in ((leaf.starts[i], 1.0), (leaf.starts[i] + leaf.widths[i], -1.0)):
                columns.append(sign * (np.sin(angle) * wrenches[1] - np.cos(angle) * wrenches[2]))
    _, left = nnls(np.array(columns).T, load - z, maxiter=1000)
    return max(worst, left)


def is_onset(held: Held, forces: np.ndarray, least: float = 1e-6, error: float = 1e-9) -> bool:
    """Whether forces (n, 3) leave a motion of at least so many loads, and obey Coulomb's law but for an error."""
    b = held.load[:6]
    y = b - np.einsum("ij,ijk->k", forces, held.columns)
    frictions = np.full(len(forces), held.friction)
    return bool(np.linalg.norm(y) > least and violation(held.columns, b, frictions, forces) <= error)


@pytest.fixture(scope="module")
def search() -> Search:
    return Search()


def test_every_leaf_of_a_search_that_finds_nothing_is_a_proof(search, cases, say):
    """1e-6 for what the velocities leave, 1e-12 of power along z: no motion above 1e-6 loads."""
    random, n, n_leaves, flaws, answers = np.random.default_rng(20), cases(100, 800), 0, [0.0], []
    for held in (random_held(random) for _ in range(n)):
        answers.append(search(held))
        if answers[-1] == UNIQUE:
            found = [flaw(held, leaf) for leaf in search.leaves(len(held.columns))]
            n_leaves += len(found)
            flaws.append(max(found))
    say(f"{n} contact sets, {answers.count(UNIQUE)} where rest is the only onset, {n_leaves} leaves: {max(flaws):.1e}")
    assert max(flaws) < 1e-6
    assert answers.count(UNIQUE) > n // 2
    assert answers.count(NOT_SHOWN) <= max(2, n // 50)


def test_the_proof_of_another_load_is_no_proof(search):
    random, fails, n = np.random.default_rng(21), 0, 0
    for held in (random_held(random) for _ in range(40)):
        if search(held) == UNIQUE and search.tree.n_nodes > 1:
            load = held.load + np.append(0.1 * random.normal(size=6), 0.0)
            n += 1
            fails += any(flaw(held._replace(load=load), leaf) > 1e-3 for leaf in search.leaves(len(held.columns)))
    assert fails == n > 10


def test_every_other_onset_obeys_coulombs_law(search, cases):
    random, n = np.random.default_rng(22), cases(150, 2000)
    n_others = 0
    for held in (random_held(random) for _ in range(n)):
        if search(held) == OTHER_FOUND:
            n_others += 1
            assert is_onset(held, search.forces)
    assert n_others > n // 100


def modes_by_programs(held: Held, n_sectors: int) -> list[tuple[int, ...]]:
    """Contact modes (-2: opens, -1: sticks, else a sector) in which a motion is not ruled out, by linear programs."""
    edges = 2 * np.pi * np.arange(n_sectors) / n_sectors
    wide = held.friction / np.cos(np.pi / n_sectors)
    n, b, possible = len(held.columns), held.load[:6], []
    for modes in itertools.product(range(-2, n_sectors), repeat=n):
        rays, equal, below = [], [], []
        for (normal, one, two), mode in zip(held.columns, modes, strict=True):
            (below if mode == -2 else equal).append(normal)
            if mode == -1:
                equal += [one, two]
                rays += [normal + wide * (np.cos(a) * one + np.sin(a) * two) for a in edges + np.pi / n_sectors]
            elif mode >= 0:
                first, last = edges[mode], edges[mode] + edges[1]
                below += [np.sin(first) * one - np.cos(first) * two, np.cos(last) * two - np.sin(last) * one]
                middle = edges[mode] + np.pi / n_sectors
                for angle, size in ((first, held.friction), (last, held.friction), (middle, wide)):
                    rays.append(normal + size * (np.cos(angle) * one + np.sin(angle) * two))
        motion = np.array([b, *(-ray for ray in rays)]).T  # y = motion @ (scale of the load, forces)
        left = np.array([b, *equal]) @ motion
        right = np.concatenate([[1.0], np.zeros(len(equal))])
        found = linprog(
            np.zeros(motion.shape[1]),
            A_ub=np.array(below) @ motion if below else None,
            b_ub=np.zeros(len(below)) if below else None,
            A_eq=left,
            b_eq=right,
            bounds=(0, 1e4),
            method="highs",
        )
        if found.status == 0:
            possible.append(modes)
    return possible


def test_the_search_agrees_with_linear_programs_for_all_modes(search, cases):
    """One to three contacts, sectors up to 1/20 of a turn: what these rule out has no other onset, and the mode of an
    onset that was found is one that they leave.
    """
    random, n, ruled_out, others = np.random.default_rng(23), cases(15, 300), 0, 0
    for _ in range(n):
        held = random_held(random)
        n_contacts = int(random.integers(1, 3)) if random.random() < 0.9 else 3
        held = held_by(held.columns[:n_contacts], held.friction, random)
        answer = search(held)
        n_sectors = {1: 20, 2: 12, 3: 4}[n_contacts]
        possible = modes_by_programs(held, n_sectors)
        if not possible:
            ruled_out += answer == UNIQUE
            assert answer != OTHER_FOUND
        if answer == OTHER_FOUND:
            others += 1
            y = held.load[:6] - np.einsum("ij,ijk->k", search.forces, held.columns)
            v = held.columns @ y
            angles = np.arctan2(v[:, 2], v[:, 1]) % (2 * np.pi) * n_sectors / (2 * np.pi)
            slow = np.linalg.norm(v[:, 1:], axis=1) < 1e-9 * np.linalg.norm(y)
            modes = np.where(search.forces[:, 0] <= 0.0, -2, np.where(slow, -1, angles.astype(int)))
            assert tuple(modes) in possible
    assert ruled_out > n // 3


def held_by(columns: np.ndarray, friction: float, random: np.random.Generator) -> Held:
    """Contacts and a load that some forces inside their cones balance."""
    forces, angles = random.uniform(0.1, 1, len(columns)), random.uniform(0, 2 * np.pi, len(columns))
    parts = friction * forces * np.sqrt(random.random(len(columns)))
    load = forces @ columns[:, 0] + (parts * np.cos(angles)) @ columns[:, 1] + (parts * np.sin(angles)) @ columns[:, 2]
    return Held(columns, friction, np.append(load / np.linalg.norm(load), 0.0))


def held_blocks(random: np.random.Generator, friction: float) -> Iterator[Held]:
    """Where friction can hold blocks: where they come to rest, and at one place of each motion that goes on there."""
    while True:
        scene = pushed_block(random, friction)
        phase = run(scene).phases[0]
        going = [event.path for event in phase.events if event.note == "could stay" and len(event.path) > 1]
        poses = [path[len(path) // 2 - 1] for path in going]
        if phase.proof.verdict != "moves" and phase.proof.needs_friction:
            poses.append(phase.pose)
        part, at = part_of(scene), empty_proof_workspace(scene.geometry)
        for pose in poses:
            case = start_of(0, part, cases_of(scene, friction, pose), empty_cage(scene.geometry))
            stand_at(
                case.geometry,
                part.body,
                case.position,
                case.quaternion,
                case.actions[0],
                case.friction,
                at,
            )
            rows = [at.contacts.rows[i] for i in range(at.contacts.used[0]) if at.contacts.states[i].chosen]
            columns, load = np.array([row.columns[:, :6] for row in rows]), at.scratch[0].solver.load
            held = Held(columns, friction, load / np.linalg.norm(load))
            if pose is phase.pose or can_hold(held):
                yield held


def can_hold(held: Held) -> bool:
    """Whether forces within pyramids of 64 sides, inside the cones, balance the load."""
    angles = 2 * np.pi * np.arange(64) / 64
    sides = np.column_stack([np.ones(64), held.friction * np.cos(angles), held.friction * np.sin(angles)])
    return bool(nnls(np.einsum("ka,iab->bik", sides, held.columns).reshape(6, -1), held.load[:6])[1] < 1e-12)


def onset_from_anywhere(held: Held, random: np.random.Generator) -> bool:
    """Whether De Saxce's law, a system of equations in the forces, is solved by those of a motion: from random forces,
    after some sweeps in which contacts give way one after the other, by MINPACK.
    """
    n, mu = len(held.columns), held.friction
    steps = 1.0 / np.linalg.eigvalsh(np.einsum("ijk,ilk->ijl", held.columns, held.columns))[:, -1]

    def given_way(i: int, force: np.ndarray, y: np.ndarray) -> np.ndarray:
        v = held.columns[i] @ y
        trial = force + steps[i] * (v - [mu * np.hypot(v[1], v[2]), 0, 0])
        along = np.hypot(trial[1], trial[2])
        if along <= mu * trial[0]:
            return trial
        if trial[0] <= -mu * along:
            return np.zeros(3)
        normal = (trial[0] + mu * along) / (1 + mu * mu)
        return np.array([normal, *(mu * normal * trial[1:] / along)])

    def motion(forces: np.ndarray) -> np.ndarray:
        return held.load[:6] - np.einsum("ij,ijk->k", forces, held.columns)

    def missed(x: np.ndarray) -> np.ndarray:
        forces = x.reshape(n, 3)
        y = motion(forces)
        return (forces - [given_way(i, forces[i], y) for i in range(n)]).ravel()

    for _ in range(12):
        forces = np.zeros((n, 3))
        forces[:, 0] = random.exponential(1.0, n) * (random.random(n) < 0.5)
        for _ in range(30):
            for i in range(n):
                forces[i] = given_way(i, forces[i], motion(forces))
        found = root(missed, forces.ravel(), tol=1e-12).x.reshape(n, 3)
        if is_onset(held, found, 1e-4, 1e-6):
            return True
    return False


@pytest.mark.parametrize("friction", [0.1, 0.2, 0.4])
def test_where_rest_is_the_only_onset_no_other_search_finds_one(search, cases, say, friction):
    random, other, n = np.random.default_rng(24), np.random.default_rng(25), cases(15, 300)
    found = {UNIQUE: 0, OTHER_FOUND: 0}
    answers = []
    for held in itertools.islice(held_blocks(random, friction), n):
        answers.append(search(held))
        if answers[-1] != NOT_SHOWN:
            found[answers[-1]] += onset_from_anywhere(held, other)  # of its own, lest a last digit changes the blocks
    say(
        f"friction {friction}: {answers.count(UNIQUE)} only rest, {answers.count(OTHER_FOUND)} another onset, of which "
        f"{found[OTHER_FOUND]} found from random forces too, {answers.count(NOT_SHOWN)} not shown"
    )
    assert found[UNIQUE] == 0
    assert answers.count(NOT_SHOWN) <= 1 + n // 100  # brought to rest at the very limit of friction
    assert found[OTHER_FOUND] > 0


def slab(friction: float, lean: float, n: int, height: float) -> Held:
    """A slab of radius of gyration 1 on ``n`` feet in a circle, its centre ``height`` above; the load leans by a part
    of what friction allows.
    """
    turns = np.arange(n) * 2 * np.pi / n
    columns = columns_of(
        np.tile([0.0, 0.0, -1.0], (n, 1)), np.array([(np.cos(t), np.sin(t), -height) for t in turns]), np.ones(3)
    )
    tilt = np.arctan(friction * lean)
    return Held(columns, friction, np.array([np.sin(tilt), 0, -np.cos(tilt), 0, 0, 0, 0]))


@pytest.mark.parametrize("n", [3, 4, 6])
@pytest.mark.parametrize(("lean", "answer"), [(0.5, UNIQUE), (0.999, UNIQUE), (1.001, OTHER_FOUND)])
def test_a_slab_stays_up_to_the_very_limit_of_friction(search, n, lean, answer):
    """Low, so that friction presses nowhere: the power of friction in any slip is more than the load's up to lean 1."""
    held = slab(0.3, lean, n, 0.0)
    assert search(held) == answer
    if answer == OTHER_FOUND:
        size = np.sin(np.arctan(0.3 * lean)) - 0.3 * np.cos(np.arctan(0.3 * lean))
        assert np.allclose(search.tree.y[:6], [size, 0, 0, 0, 0, 0], atol=1e-9)


def test_a_rest_without_friction_is_shown_at_the_root(search):
    held = slab(0.3, 0.0, 24, 0.5)
    assert search(held) == UNIQUE
    assert search.tree.n_nodes == 1
    assert not search.tree.twists[0].any()


@pytest.mark.parametrize("friction", [0.1, 0.2, 0.4])
def test_whether_an_ordinary_block_can_begin_to_move_is_nearly_always_said(cases, say, friction):
    random, n = np.random.default_rng(25), cases(40, 1000)
    proofs = [run(pushed_block(random, friction)).phases[0].proof for _ in range(n)]
    verdicts = [proof.verdict for proof in proofs]
    say(f"blocks, friction {friction}: " + ", ".join(f"{verdicts.count(v)} {v}" for v in ("rests", "may rest")))
    assert sum("was not shown" in proof.reason for proof in proofs) <= n // 100
    assert verdicts.count("rests") > n // 2
    assert verdicts.count("may rest") <= n // 10  # a quarter, if motions ended where they could

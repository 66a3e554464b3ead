"""Why rest is the only onset, or which other there is, as data that others can check: `certificate`, (5.13) to (5.20).

The search of a run keeps nothing but its answer. It is made again here, from the pose at the end of a phase, and every
leaf of its tree is given the numbers that prove it; `check_certificate` then needs products and sums alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import islice, product
from typing import Any

import numpy as np

from cagepose.kernels.algebra.least_squares import PassiveSet, clear, empty_system, nonnegative_least_squares
from cagepose.kernels.algebra.record import empty_record
from cagepose.kernels.contact import coulomb_newton, equilibrium
from cagepose.kernels.contact.edges import CHOICES_LIMIT
from cagepose.kernels.contact.friction import friction_of
from cagepose.kernels.contact.metric import WRENCH
from cagepose.kernels.stability import relaxation, strong
from cagepose.kernels.stability.proof_search import balance_with_faces, search_with_faces
from cagepose.model.checks import FloatArray
from cagepose.runs.cases import body_of, cases_of
from cagepose.runs.judge import judged_workspace
from cagepose.runs.methods import chosen_method
from cagepose.runs.proof import Uniqueness
from cagepose.runs.run import Run
from cagepose.studies.certificate import Certificate, ChosenFaces, Decision, ModeTree, OtherOnset
from cagepose.studies.contact_problem import ContactProblem, contact_problem

DECISIONS: dict[int, Decision] = {
    relaxation.UNDECIDED: "none",
    coulomb_newton.OPENS: "opens",
    relaxation.CLOSED: "closed",
    coulomb_newton.STICKS: "sticks",
    coulomb_newton.SLIPS: "slips",
}
SAME = 1e-9
"""Of the load, and of a unit wrench: contacts and load of the kernel are those of the scene but for rounding."""


def certificate(run: Run, phase: int = -1) -> Certificate | None:
    """Return the proof that the end of a phase is at rest, and that rest is the only onset or one of several.

    The search is made again. Returns None where the object moves; where nothing touches it; where contacts without play
    carry the load to second order, which these proofs of first order do not show; and where points on edges have more
    than 729 choices of faces.

    Parameters
    ----------
    run
        Of either method, made or loaded.
    phase
        Its number, from 0; the last one.

    Raises
    ------
    IndexError
        The run has no such phase.
    """
    number = range(len(run.phases))[phase]
    ended = run.phases[number]
    if ended.proof.verdict == "moves":
        return None
    problem = contact_problem(run, number)
    choices = list(islice(product(*reversed(problem.groups)), CHOICES_LIMIT + 1))
    search = _Search(run, problem, number)
    if not problem.faces or len(choices) > CHOICES_LIMIT or not search.is_of_first_order():
        return None
    found = list[ChosenFaces]()
    uniqueness: Uniqueness = "strong"
    onset = None
    for choice in choices:
        asked = search.ask(tuple(reversed(choice)), uniqueness == "strong")
        if asked is None:
            return None
        answer, faces, moving = asked
        found.append(faces)
        if uniqueness == "strong":
            uniqueness, onset = answer, moving
    if uniqueness != "strong":
        found = [ChosenFaces(faces.contacts, faces.forces, None) for faces in found]
    return Certificate(uniqueness, problem.faces, problem.friction, tuple(found), onset)


class _Search:
    """The kernels' search on the contacts of a problem, one choice of faces after the other."""

    def __init__(self, run: Run, problem: ContactProblem, phase: int) -> None:
        scene, pose = run.scene, run.phases[phase].pose
        of_scene, body = chosen_method(scene, run.method).friction(scene), body_of(scene)
        cases = cases_of(scene, of_scene, pose)
        self.friction = friction_of(of_scene, cases.point_frictions, cases.box_frictions).greatest
        # The kernel knows one coefficient, and shortens the tangents of contacts with less.
        self.problem, self.lengths = problem, np.ones((len(problem.faces), 3))
        if self.friction > 0.0:
            self.lengths[:, 1:] = (problem.friction / self.friction)[:, None]
        # D^-1/2 of (5.3), from wrenches in the world; its transpose takes scaled twists back there.
        self.to_scaled = np.eye(WRENCH)
        self.to_scaled[3:, 3:] = body.axes_object @ pose.rotation.T / body.radii[:, None]
        self.at, _ = judged_workspace(scene, pose, phase, of_scene)
        contacts: Any = self.at.contacts
        work: Any = self.at.scratch[0]
        self.states, self.tree = contacts.states, work.tree
        self.used = np.nonzero(contacts.rows["group"][: contacts.used[0]] >= 0)[0]
        self.columns = contacts.rows["columns"][self.used]
        self.load = np.array(work.solver.load[:WRENCH])
        self.size = float(np.linalg.norm(self.load)) or 1.0

    def is_of_first_order(self) -> bool:
        """Whether the kernel has balanced the load itself, with all contacts: nothing is locked, (5.21)."""
        if self.columns.shape != self.problem.wrenches.shape:
            return False
        expected = self.problem.wrenches @ self.to_scaled.T
        apart = np.linalg.norm(self.columns - self.lengths[..., None] * expected, axis=2)
        apart /= np.linalg.norm(expected, axis=2)
        return bool(
            (apart <= SAME).all() and np.linalg.norm(self.load / self.size - self.to_scaled @ self.problem.load) <= SAME
        )

    def ask(self, chosen: tuple[int, ...], with_tree: bool) -> tuple[Uniqueness, ChosenFaces, OtherOnset | None] | None:
        """Return what one choice of faces says of rest, its balance with a tree if asked for, and another onset.

        None: no forces balance the load to first order.
        """
        places, states = list(chosen), self.states
        for flag in ("chosen", "counts"):
            states[flag] = False
            states[flag][self.used[places]] = True
        code = balance_with_faces(self.friction, self.at)
        forces = self._forces(places)
        if code == equilibrium.MOVES:
            return None
        if not with_tree:
            return "not shown", ChosenFaces(chosen, forces, None), None
        if code == equilibrium.HELD_WITHOUT_FRICTION:
            return "strong", ChosenFaces(chosen, forces, _root_alone(forces)), None
        answer = search_with_faces(self.friction, self.at)
        if answer == strong.UNIQUE:
            return "strong", ChosenFaces(chosen, forces, self._tree(places)), None
        onset = OtherOnset(chosen, self._forces(places)) if answer == strong.OTHER_FOUND else None
        return ("weak" if onset else "not shown"), ChosenFaces(chosen, forces, None), onset

    def _forces(self, places: list[int]) -> FloatArray:
        return np.asarray(self.lengths[places] * self.states["forces"][self.used[places]] / self.size)

    def _tree(self, places: list[int]) -> ModeTree:
        tree, n = self.tree, int(self.tree.n_nodes)
        found = ModeTree(
            tuple(tree.parents[:n].tolist()),
            tuple(tree.places[:n].tolist()),
            tuple(DECISIONS[mode] for mode in tree.modes[:n].tolist()),
            tree.starts[:n].copy(),
            tree.widths[:n].copy(),
            np.zeros((0, WRENCH)),
            np.zeros((0, len(places), 3)),
        )
        leaves = found.leaves()
        scaled = tree.twists[leaves]
        columns = self.problem.wrenches[places] @ self.to_scaled.T
        pressures = [
            _pressures(columns, found, leaf, self.load / self.size - twist)
            for leaf, twist in zip(leaves, scaled, strict=True)
        ]
        return ModeTree(
            found.parents, found.contacts, found.decisions, found.starts_rad, found.widths_rad,
            scaled @ self.to_scaled, np.array(pressures),
        )  # fmt: skip


def _root_alone(forces: FloatArray) -> ModeTree:
    """A balance without friction: the load drives no motion that the contacts allow, and the proof is z = 0."""
    nothing = np.zeros(1)
    return ModeTree((-1,), (-1,), ("none",), nothing, nothing, np.zeros((1, WRENCH)), forces[None])


def _pressures(columns: FloatArray, tree: ModeTree, leaf: int, wrench: FloatArray) -> FloatArray:
    """Return how velocities that a leaf does not allow make a scaled wrench, (n_contacts, 3), by least squares."""
    contacts, ways = _not_allowed(len(columns), tree, leaf)
    system, passive = empty_system(len(contacts)), empty_record(PassiveSet)
    system.columns[:, :WRENCH] = np.einsum("nj,njk->nk", ways, columns[contacts])
    system.right_side[:WRENCH] = wrench
    clear(passive, WRENCH, 1.0)
    nonnegative_least_squares(system, len(contacts), passive)
    found = np.zeros((len(columns), 3))
    for label, share in zip(passive.labels[: passive.used], passive.x[: passive.used], strict=True):
        found[contacts[label]] += share * ways[label]
    return found


def _not_allowed(n_contacts: int, tree: ModeTree, leaf: int) -> tuple[list[int], FloatArray]:
    """Return velocities at contacts, normal and tangents, against which all that a leaf allows goes or stands still."""
    contacts, ways = list(range(n_contacts)), [(1.0, 0.0, 0.0)] * n_contacts
    slips_told = set[int]()
    for node in tree.above(leaf):
        contact, decision = tree.contacts[node], tree.decisions[node]
        more: Sequence[tuple[float, float, float]] = ()
        if decision == "closed":
            more = [(-1.0, 0.0, 0.0)]
        elif decision in ("sticks", "slips") and contact not in slips_told:
            slips_told.add(contact)
            more = [(0.0, 1.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, -1.0)]
            if decision == "slips":
                first, last = tree.starts_rad[node], tree.starts_rad[node] + tree.widths_rad[node]
                more = [(0.0, np.sin(first), -np.cos(first)), (0.0, -np.sin(last), np.cos(last))]
        contacts += [contact] * len(more)
        ways += more
    return contacts, np.array(ways)

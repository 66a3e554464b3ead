"""Why rest is the only onset, or which other there is, as data that others can check: `certificate`, (5.13) to (5.20).

The search of a run keeps nothing but its answer. It is made again here, from the pose at the end of a phase, and every
leaf of its tree is read with the numbers that prove it; `check_certificate` then needs products and sums alone.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import islice, product
from typing import Any

import numpy as np

from cagepose.kernels.contact import equilibrium
from cagepose.kernels.contact.edges import CHOICES_LIMIT
from cagepose.kernels.contact.friction import friction_of
from cagepose.kernels.stability import strong
from cagepose.kernels.stability.proof_search import balance_with_faces, search_with_faces
from cagepose.model.checks import FloatArray, expect
from cagepose.runs.cases import cases_of
from cagepose.runs.drives import displaced_after
from cagepose.runs.judge import judged_workspace
from cagepose.runs.methods import chosen_method
from cagepose.runs.proof import Uniqueness
from cagepose.runs.run import Run
from cagepose.studies.certificate import Certificate, ChosenFaces, OtherOnset
from cagepose.studies.certify_drive import drive_proof
from cagepose.studies.contact_problem import ContactProblem, contact_problem
from cagepose.studies.kernel_rows import rows_in_order
from cagepose.studies.mode_tree import ModeTree
from cagepose.studies.read_tree import read_tree
from cagepose.studies.tolerances import SAME_LOAD


def certificate(run: Run, phase: int = -1) -> Certificate | None:
    """Return the proof that the end of a phase is at rest, and that rest is the only onset or one of several; and, of a
    phase that drives bodies of the cage, where along the drive the object could jam, and why it stopped.

    The search is made again. There is no proof of rest where the object moves; where nothing touches it; where contacts
    without play carry the load to second order, which these proofs of first order do not show; and where edges have
    more than 729 choices of faces. Returns None where nothing is proven.

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
    expect(run, Run, "run")
    number = range(len(run.phases))[phase]
    rest, drive = _of_rest(run, number), drive_proof(run, number)
    if rest is None and drive is not None:
        nothing = np.zeros(0)
        return Certificate(None, (), nothing.reshape(0, 3), nothing.reshape(0, 3, 3), nothing, (), None, drive)
    return rest if rest is None or drive is None else replace(rest, drive=drive)


def _of_rest(run: Run, number: int) -> Certificate | None:
    """Return the proof of rest at the end of a phase, counted from 0; None: there is none."""
    if run.phases[number].proof.verdict == "moves":
        return None
    problem = contact_problem(run, number)
    choices = list(islice(product(*reversed(problem.groups)), CHOICES_LIMIT + 1))
    if not problem.faces or len(choices) > CHOICES_LIMIT:
        return None
    search = _Search(run, problem, number)
    if not search.is_of_first_order:
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
    where = problem.faces, problem.places, problem.directions
    return Certificate(uniqueness, *where, problem.friction, tuple(found), onset)


class _Search:
    """The kernels' search on the contacts of a problem, one choice of faces after the other."""

    def __init__(self, run: Run, problem: ContactProblem, phase: int) -> None:
        scene, pose = run.scene, run.phases[phase].pose
        of_scene = chosen_method(scene, run.method).friction(scene)
        cases = cases_of(scene, of_scene, pose)
        self.friction = friction_of(of_scene, cases.point_frictions, cases.box_frictions).greatest
        # The kernel knows one coefficient, and shortens the tangents of contacts with less.
        self.problem, self.lengths = problem, np.ones((len(problem.faces), 3))
        if self.friction > 0.0:
            self.lengths[:, 1:] = (problem.friction / self.friction)[:, None]
        self.columns = problem.scaled(problem.wrenches)
        self.at, _ = judged_workspace(scene, pose, phase, of_scene, displaced_after(run, phase))
        contacts: Any = self.at.contacts
        work: Any = self.at.scratch[0]
        self.states, self.tree = contacts.states, work.tree
        contacts.used[0] = work.n_asked
        in_kernels = contacts.rows["columns"][..., : contacts.n_freedoms]
        self.used = rows_in_order(in_kernels[: work.n_asked], self.lengths[..., None] * self.columns)
        load = work.solver.load[: contacts.n_freedoms]
        self.size = float(np.linalg.norm(load)) or 1.0
        self.is_of_first_order = self._take(in_kernels, load, run.phases[phase].proof.uniqueness == "strong")

    def _take(self, in_kernels: FloatArray, load: FloatArray, is_strong: bool) -> bool:
        """Let the search be of the very numbers that are checked; False: it was of others, as contacts without play
        lock some of what the load does (5.21).

        Another onset is one to rounding, and where the run found it with its own numbers it is found again with them.
        """
        columns, whole = self.lengths[..., None] * self.columns, self.problem.scaled(self.problem.load)
        if len(self.used) != len(columns):
            return False
        apart = np.linalg.norm(in_kernels[self.used] - columns, axis=2)
        if (apart > SAME_LOAD * np.linalg.norm(self.columns, axis=2)).any() or np.linalg.norm(
            load / self.size - whole
        ) > SAME_LOAD:
            return False
        if is_strong:
            in_kernels[self.used] = columns
            load[:] = self.size * whole
        return True

    def ask(self, chosen: tuple[int, ...], with_tree: bool) -> tuple[Uniqueness, ChosenFaces, OtherOnset | None] | None:
        """Return what one choice of faces says of rest, its balance with a tree if asked for, and another onset.

        None: no forces balance the load to first order.
        """
        places, states = list(chosen), self.states
        for flag in ("chosen", "counts"):
            states[flag] = False
            states[flag][self.used[places]] = True
        code = self._balance()
        forces = self._forces(places)
        if code == equilibrium.MOVES:
            return None
        if not with_tree:
            return "not shown", ChosenFaces(chosen, forces, None), None
        if code == equilibrium.HELD_WITHOUT_FRICTION:
            return "strong", ChosenFaces(chosen, forces, _root_alone(forces, len(self.problem.load))), None
        answer = search_with_faces(self.friction, self.at)
        if answer == strong.UNIQUE:
            return (
                "strong",
                ChosenFaces(
                    chosen, forces, read_tree(self.tree, self.columns[places], self.lengths[places], self.problem.scale)
                ),
                None,
            )
        onset = OtherOnset(chosen, self._forces(places)) if answer == strong.OTHER_FOUND else None
        return ("weak" if onset else "not shown"), ChosenFaces(chosen, forces, None), onset

    def _balance(self) -> int:
        """Balance the load to a small part of itself, if that can be; else, as a run does, to one of its terms.

        Springs that pull against each other leave a load that is a small part of them, and forces that spare friction
        would leave more of it than a certificate may.
        """
        solver: Any = self.at.scratch[0].solver
        terms = float(solver.load_terms)
        solver.load_terms = self.size
        code = balance_with_faces(self.friction, self.at)
        solver.load_terms = terms
        return balance_with_faces(self.friction, self.at) if code == equilibrium.MOVES else code

    def _forces(self, places: list[int]) -> FloatArray:
        return np.asarray(self.lengths[places] * self.states["forces"][self.used[places]] / self.size)


def _root_alone(forces: FloatArray, n_freedoms: int) -> ModeTree:
    """A balance without friction: the load drives no motion that the contacts allow, and the proof is z = 0."""
    nothing = np.zeros(1)
    return ModeTree((-1,), (-1,), ("none",), nothing, nothing, np.zeros((1, n_freedoms)), forces[None])

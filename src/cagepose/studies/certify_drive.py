"""Whether an object could jam at the places of a drive, and why it stopped, as data: `drive_proof`, (8.6), (8.7).

All is asked once more, from the poses of the curve and on contacts that were found anew; `check_drive` then needs
products and sums alone.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from cagepose.errors import CertificateError
from cagepose.kernels.algebra.least_squares import WRENCH
from cagepose.kernels.contact.friction import friction_of
from cagepose.kernels.driven.jam_proof import search_jam
from cagepose.kernels.stability.strong import UNIQUE
from cagepose.model.checks import FloatArray
from cagepose.runs.cases import cases_of
from cagepose.runs.run import Run
from cagepose.studies.could_jam import GivesWay, Stands, could_stand, jam_question
from cagepose.studies.drive_check import driven_problem
from cagepose.studies.drive_proof import DrivenPlace, DriveProof, JamChoice, StopChoice, Stopped
from cagepose.studies.driven_contacts import DriveContacts, DrivenContacts
from cagepose.studies.kernel_rows import rows_in_order
from cagepose.studies.read_tree import read_tree
from cagepose.studies.tolerances import SAME_FREEDOM


def drive_proof(run: Run, phase: int) -> DriveProof | None:
    """Return what is proven of the drive of a phase, counted from 0; None: nothing was driven, or bodies press beside,
    whose freedoms are not asked along a drive, or at some place there are more than 729 choices of faces, or more
    contacts than there is memory for, or rounding leaves it open whether the object could jam.
    """
    if run.phases[phase].drive is None or run.scene.loads[phase].press:
        return None
    known = DriveContacts(run, phase)
    places, last = list[DrivenPlace](), None
    for row in known.rows():
        try:
            last = known.at_row(row)
        except CertificateError:
            return None
        choices = last.choices()
        found = None if choices is None else [_jam_choice(last, choice) for choice in choices]
        if found is None or None in found:
            return None
        problem = last.problem
        places.append(
            DrivenPlace(
                row, known.share_of(row), problem.faces, problem.places, problem.directions, problem.friction,
                last.drifts, last.growth, tuple(choice for choice in found if choice is not None),
            )
        )  # fmt: skip
    stopped, choices_of_stop = None, tuple[StopChoice, ...]()
    if last is not None and (verdict := run.phases[phase].verdict) in ("blocked", "jams"):
        asked = _stop_choices(verdict, last, known)
        if asked is not None:
            stopped, choices_of_stop = verdict, asked
    return DriveProof(tuple(places), stopped, choices_of_stop)


def _jam_choice(contacts: DrivenContacts, choice: tuple[int, ...]) -> JamChoice | None:
    found = could_stand(jam_question(contacts, choice))
    if isinstance(found, GivesWay):
        return JamChoice(choice, contacts.speed * (contacts.problem.scale.T @ found.twist), None, 0.0)
    return JamChoice(choice, None, found.forces, found.taken) if isinstance(found, Stands) else None


def _stop_choices(verdict: Stopped, last: DrivenContacts, known: DriveContacts) -> tuple[StopChoice, ...] | None:
    """Return the proof that a drive does not go on from its last place, for each choice of faces; None: there is none
    for one of them.
    """
    found = list[StopChoice]()
    for choice in last.choices() or ():
        question = jam_question(last, choice)
        without = could_stand(question._replace(friction=np.zeros(len(choice)), growth=np.zeros(WRENCH)))
        if verdict == "blocked" and isinstance(without, Stands):
            forces = without.forces[:, 0].copy()  # in a row, as when it is loaded: sums are the same
            found.append(StopChoice(choice, forces, _free(last, choice, forces), None, None))
        elif verdict == "jams" and isinstance(without, GivesWay):
            tree = _search(last, choice, known)
            if tree is None:
                return None
            motion = last.speed * (last.problem.scale.T @ without.twist)
            found.append(StopChoice(choice, None, None, tree, motion))
        else:
            return None
    return tuple(found)


def _free(contacts: DrivenContacts, choice: tuple[int, ...], forces: FloatArray) -> FloatArray:
    """Return the motions that leave all contacts closed which carry, (k, 6), in the world."""
    problem = contacts.problem
    normals = problem.scaled(problem.wrenches[list(choice), 0])
    rows = (normals / np.linalg.norm(normals, axis=1)[:, None])[forces > 0.0]
    _, sizes, turned = np.linalg.svd(rows)
    return np.asarray(turned[int(np.sum(sizes > SAME_FREEDOM)) :] @ problem.scale)


def _search(last: DrivenContacts, choice: tuple[int, ...], known: DriveContacts) -> Any:
    """Return the tree of a search for a motion in which the drive goes on; None: it did not end."""
    scene, at = known.scene, known.at
    known.stand(known.rows()[-1])
    cases = cases_of(scene, known.friction)
    greatest = friction_of(known.friction, cases.point_frictions, cases.box_frictions).greatest
    problem, beside = driven_problem(last)
    lengths = np.ones((len(problem.faces), 3))
    if greatest > 0.0:  # the kernel knows one coefficient, and shortens the tangents of contacts with less
        lengths[:, 1:] = (problem.friction / greatest)[:, None]
    columns = problem.scaled(problem.wrenches)
    contacts: Any = at.contacts
    used = rows_in_order(contacts.rows["columns"][: contacts.used[0], :, :WRENCH], columns[..., :WRENCH])
    if len(used) != len(columns):
        return None
    contacts.rows["columns"][used, :, : WRENCH + 1] = lengths[..., None] * columns
    contacts.rows["drift"][used] = 0.0
    for flag in ("chosen", "counts"):
        contacts.states[flag] = False
        contacts.states[flag][used[list(choice)]] = True
    load = np.zeros(WRENCH + 1) if beside is None else problem.scaled(beside)
    load /= np.linalg.norm(load) or 1.0
    if search_jam(greatest, problem.load, load, at) != UNIQUE:
        return None
    scratch: Any = at.scratch[0]
    return read_tree(scratch.tree, columns[list(choice)], lengths[list(choice)], problem.scale)

"""Coulomb's law where bodies of the cage are driven: contacts drift, and a motion begins though no load is left."""

from itertools import combinations

import numpy as np
import pytest

from cagepose.kernels.algebra.record import empty_record
from cagepose.kernels.contact.cone import ConeWorkspace, clear_cone, cone_residual
from cagepose.kernels.contact.contact_set import empty_contact_set
from cagepose.kernels.contact.coulomb import coulomb_onset
from cagepose.kernels.contact.coulomb_newton import NewtonWorkspace
from cagepose.kernels.contact.coulomb_pivots import PivotWorkspace
from inner_kernels import as_machine_code


def contacts_of(columns, drift):
    """Contacts that count, with columns (n, 3, 6) and drifts (n, 3)."""
    contacts = empty_contact_set(len(columns))
    contacts.used[0] = len(columns)
    for i in range(len(columns)):
        row = contacts.rows[i]
        row.columns[:, :6], row.drift[:], contacts.states[i].counts = columns[i], drift[i], True
    return contacts


class Onset:
    """Contacts with columns (n, 3, 6) and drifts (n, 3), asked for the motion y that a load begins, and the forces."""

    def __init__(self):
        self.memory = [empty_record(kind) for kind in (ConeWorkspace, NewtonWorkspace, PivotWorkspace)]

    def ask(self, columns, drift, load, friction):
        contacts = contacts_of(columns, drift)
        b, y = np.append(load, 0.0), np.zeros(7)
        cone, newton, pivots = self.memory
        terms = np.linalg.norm(load) + np.abs(drift).max() / np.linalg.norm(columns[:, 0], axis=1).min()
        clear_cone(cone, b, 6, terms)
        as_machine_code(cone_residual)(contacts, friction, cone)
        found = as_machine_code(coulomb_onset)(contacts, friction, b, cone, y, newton, pivots)
        return found, y[:6], np.array(contacts.states["forces"])


def law_violated(columns, drift, load, friction, y, forces):
    """By how much forces and motion violate Coulomb's law and balance, written once more."""
    worst = np.linalg.norm(load - np.einsum("ij,ijk->k", forces, columns) - y)
    closing, *slip = (columns @ y + drift).T
    normal, tangential = forces[:, 0], forces[:, 1:]
    slip = np.array(slip).T
    speed, friction_of = np.linalg.norm(slip, axis=1), np.linalg.norm(tangential, axis=1)
    worst = max(
        worst, closing.max(), -normal.min(), np.abs(normal * closing).max(), (friction_of - friction * normal).max()
    )
    return max(worst, np.abs(friction * normal * speed - (tangential * slip).sum(axis=1)).max())


def random_problem(rng, n):
    """Normals and two tangents at random places, drifts of size one, and a load."""
    normals, arms = rng.normal(size=(n, 3)), rng.normal(size=(n, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    first = np.cross(normals, rng.normal(size=(n, 3)))
    first /= np.linalg.norm(first, axis=1)[:, None]
    directions = np.stack([normals, first, np.cross(normals, first)], axis=1)
    columns = np.concatenate([directions, np.cross(arms[:, None], directions)], axis=2)
    return columns, rng.normal(size=(n, 3)), rng.normal(size=6)


def by_active_sets(columns, drift, load):
    """Without friction: the motion nearest to the load that closes no contact, from all sets of those that carry."""
    normals, w = columns[:, 0], drift[:, 0]
    for n_carrying in range(len(normals) + 1):
        for carrying in map(list, combinations(range(len(normals)), n_carrying)):
            a = normals[carrying]
            forces = np.linalg.lstsq(a @ a.T, a @ load + w[carrying], rcond=None)[0] if carrying else np.zeros(0)
            y = load - a.T @ forces if carrying else load
            if (forces >= -1e-12).all() and (normals @ y + w <= 1e-9).all():
                return y
    return None


def test_without_friction_it_is_the_nearest_motion_that_closes_no_contact():
    rng, onset, n_none = np.random.default_rng(1), Onset(), 0
    for _ in range(300):
        columns, drift, load = random_problem(rng, int(rng.integers(1, 7)))
        found, y, forces = onset.ask(columns, drift, load, 0.0)
        expected = by_active_sets(columns, drift, load)
        assert found == (expected is not None)
        if found:
            np.testing.assert_allclose(y, expected, atol=1e-9 * max(1.0, np.linalg.norm(expected)))
            assert law_violated(columns, drift, load, 0.0, y, forces) < 1e-7
        else:
            n_none += 1
    assert n_none < 20


@pytest.mark.parametrize("friction", [0.1, 0.4, 0.8])
def test_forces_and_motion_obey_coulombs_law(friction, say, cases):
    rng, onset, n, n_found, worst = np.random.default_rng(2), Onset(), cases(200, 2000), 0, 0.0
    for _ in range(n):
        columns, drift, load = random_problem(rng, int(rng.integers(1, 6)))
        found, y, forces = onset.ask(columns, drift, load, friction)
        if found:
            n_found += 1
            size = np.linalg.norm(y) + np.linalg.norm(forces) + 1.0
            worst = max(worst, law_violated(columns, drift, load, friction, y, forces) / size)
    say(f"driven onsets, friction {friction}: {n_found} of {n} found, the law violated by at most {worst:.1e}")
    assert worst < 1e-6
    assert n_found > 0.9 * n

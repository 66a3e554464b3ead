"""Whether a drive can jam, against closed forms: drawers and pegs; and on random contacts against a linear program."""

import math

import numpy as np
import pytest
from scipy.optimize import linprog

from cagepose.kernels.algebra.record import empty_record
from cagepose.kernels.contact.workspace import ContactWorkspace
from cagepose.kernels.stability.jam import cannot_jam
from quasistatic.test_driven_onset import contacts_of, random_problem


def planar(contacts):
    """Columns and drifts of contacts in the xy plane: (place, outward normal, velocity of the cage's body there, share
    of the friction).
    """
    columns, drift = np.zeros((len(contacts), 3, 6)), np.zeros((len(contacts), 3))
    for i, ((x, y), normal, velocity, share) in enumerate(contacts):
        directions = np.array([(*normal, 0.0), (-share * normal[1], share * normal[0], 0.0), (0.0, 0.0, 0.0)])
        columns[i] = np.concatenate([directions, np.cross((x, y, 0.0), directions)], axis=1)
        drift[i] = -directions @ (*velocity, 0.0)
    return columns, drift


def is_safe(contacts, friction, work=None):
    return cannot_jam(contacts_of(*contacts), friction, empty_record(ContactWorkspace) if work is None else work)


def drawer(apart, wide, off):
    """A drawer between two pins, ``apart`` along its way, one on each side, and a smooth pusher ``off`` aside."""
    still, side = (0.0, 0.0), 0.5 * wide
    pins = [((-side, 0.5 * apart), (-1.0, 0.0), still, 1.0), ((side, -0.5 * apart), (1.0, 0.0), still, 1.0)]
    return planar([*pins, ((off, -4.0), (0.0, -1.0), (0.0, 1.0), 0.0)])


@pytest.mark.parametrize(("apart", "wide", "off"), [(2.0, 0.5, 1.5), (2.0, 1.0, 4.0), (0.3, 3.0, 2.0), (2.0, 6.0, 1.5)])
def test_a_drawer_jams_from_half_its_guides_length_over_the_offset_on(apart, wide, off):
    """Or from where its pins wedge it, whichever is less: one across a diagonal that leans by atan(apart / wide)."""
    limit = apart / max(2.0 * off, wide)
    assert is_safe(drawer(apart, wide, off), limit - 1e-6)
    assert not is_safe(drawer(apart, wide, off), limit + 1e-6)


def test_a_drawer_that_is_pushed_on_the_side_its_pins_leave_free_jams_by_wedging_alone():
    assert is_safe(drawer(2.0, 0.5, -1.5), 3.999)
    assert not is_safe(drawer(2.0, 0.5, -1.5), 4.001)


def test_two_wedges_squeeze_a_block_up_unless_friction_holds_it():
    """Smooth slopes of 30 deg on either side that come nearer lift a block between them. With friction its cones reach
    each other from tan 30 deg on, and then it could jam. Where one slope stands still it is the same.
    """
    sine, cosine = 0.5, math.sqrt(0.75)
    for velocities in (((1.0, 0.0), (-1.0, 0.0)), ((1.0, 0.0), (0.0, 0.0))):
        left = ((-1.0, 0.0), (-cosine, -sine), velocities[0], 1.0)
        right = ((1.0, 0.0), (cosine, -sine), velocities[1], 1.0)
        assert is_safe(planar([left, right]), math.tan(math.pi / 6) - 1e-6)
        assert not is_safe(planar([left, right]), math.tan(math.pi / 6) + 1e-6)


def could_jam(columns, drift, friction, n_rays=64):
    """The greatest work against the drive of forces that cancel and add up to one, in cones of so many rays; -inf: none
    do.
    """
    angles = 2.0 * math.pi * np.arange(n_rays) / n_rays
    tangents = friction * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    rays = columns[:, :1] + np.einsum("rj,ijk->irk", tangents, columns[:, 1:])
    gains = drift[:, :1] + drift[:, 1:] @ tangents.T
    a = np.vstack([rays.reshape(-1, 6).T, np.ones(rays.shape[0] * n_rays)])
    found = linprog(-gains.ravel(), A_eq=a, b_eq=[0.0] * 6 + [1.0], bounds=(0.0, None), method="highs")
    return -found.fun if found.status == 0 else -math.inf


@pytest.mark.parametrize("friction", [0.0, 0.2, 0.6])
def test_random_drives_agree_with_a_linear_program_over_many_rays(friction, say, cases):
    """Cones of 64 rays are at most 0.13 % narrower; where the work is as near to zero as that, nothing is said."""
    rng, n_jams, n_safe, n = np.random.default_rng(4), 0, 0, cases(150, 1500)
    for _ in range(n):
        columns, drift, _ = random_problem(rng, int(rng.integers(8, 14) if friction == 0.0 else rng.integers(5, 10)))
        work = empty_record(ContactWorkspace)
        least, most = could_jam(columns, drift, 0.997 * friction), could_jam(columns, drift, 1.003 * friction)
        if (least > 1e-6) != (most > -1e-6):
            continue
        safe = is_safe((columns, drift), friction, work)
        n_jams, n_safe = n_jams + (not safe), n_safe + safe
        assert safe == (most <= 0.0)
        if safe:  # an outsider's check of the proof: every force of every cone does at least the work of the drive
            closing, *slips = (columns @ work.y[:6] + drift).T
            assert (closing + friction * np.hypot(*slips)).max() < 1e-7 * max(1.0, np.linalg.norm(work.y[:6]))
    say(f"drives, friction {friction}: {n_jams} could jam, {n_safe} cannot, of {n}")
    assert min(n_jams, n_safe) > 0.05 * n

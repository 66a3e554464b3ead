"""Two free bodies, with contacts between them and with the ground: statics and onset of twelve freedoms, by hand."""

import math
from itertools import product

import numpy as np
import pytest

from cagepose.kernels.algebra.least_squares import empty_system
from cagepose.kernels.algebra.record import empty_record
from cagepose.kernels.contact.contact_set import empty_contact_set
from cagepose.kernels.contact.equilibrium import (
    AT_REST,
    HELD_BY_FRICTION,
    HELD_WITHOUT_FRICTION,
    MOVES,
    equilibrium,
)
from cagepose.kernels.contact.metric import Frame
from cagepose.kernels.contact.onset import onset
from cagepose.kernels.contact.workspace import ContactWorkspace
from cagepose.kernels.stability.relaxation import N_COLUMNS
from cagepose.kernels.stability.strong import UNIQUE, ModeTree, other_onset
from inner_kernels import as_machine_code

FRAME = Frame(((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), (1.0, 1.0, 1.0), (1.0, 1.0, 1.0), 1.0)
NOTHING = -1
"""Instead of a body: the ground."""
DOWN = (0.0, 0.0, -1.0)


class Bodies:
    """Free bodies with centres, masses and radii of gyration, and their contacts."""

    def __init__(self, centers, masses, radii):
        self.centers, self.rows = np.asarray(centers, float), []
        self.scale = [
            np.concatenate([np.full(3, m**-0.5), m**-0.5 / np.asarray(r)]) for m, r in zip(masses, radii, strict=True)
        ]
        self.masses = masses

    def touch(self, above, below, place, normal, friction=1.0):
        """Add a contact: ``normal`` points out of the body above, into the one below; ``friction`` is a share."""
        axes = np.linalg.svd(np.reshape(normal, (1, 3)))[2]
        directions = np.array([normal, friction * axes[1], friction * axes[2]])
        columns = np.zeros((3, 12))
        for body, sign in ((above, 1.0), (below, -1.0)):
            if body != NOTHING:
                moments = np.cross(np.subtract(place, self.centers[body]), directions)
                columns[:, 6 * body : 6 * body + 6] = sign * self.scale[body] * np.hstack([directions, moments])
        self.rows.append((directions, columns))

    def asked(self, gravity):
        """Return the contacts and the work of the kernels, with the load."""
        contacts, work = empty_contact_set(len(self.rows), 12), empty_record(ContactWorkspace)
        contacts.used[0] = len(self.rows)
        for i, (directions, columns) in enumerate(self.rows):
            row = contacts.rows[i]
            row.group, row.directions[:], row.wrenches[:], row.columns[:] = i, directions, columns, columns
        for body, mass in enumerate(self.masses):
            work.load[6 * body : 6 * body + 3] = math.sqrt(mass) * np.asarray(gravity)
        work.load_terms = float(np.linalg.norm(work.load[:12]))
        return contacts, work

    def accelerations(self, work):
        """Return how the centres begin to move."""
        return [work.y[6 * b : 6 * b + 3] * self.scale[b][:3] for b in range(len(self.masses))]


def two_blocks(between, masses=(1.0, 1.0), overhangs=(0.0, 0.0), feet=(1.0, 1.0)):
    """Block 0 lies on block 1, and that on the ground up to x = 0: each is 1 long, 0.6 wide and 0.2 high. Each hangs
    over what is below it; ``between`` is the share of friction between them.
    """
    first, second = overhangs[1] - 0.5, overhangs[0] + overhangs[1] - 0.5
    radii = np.sqrt(np.array([0.6**2 + 0.2**2, 1.0 + 0.2**2, 1.0 + 0.6**2]) / 12.0)
    bodies = Bodies([(second, 0.0, 0.3), (first, 0.0, 0.1)], masses, (radii, radii))
    for x, y in product((second - 0.5, min(first, second) + 0.5), (-0.3, 0.3)):
        bodies.touch(0, 1, (max(x, first - 0.5), y, 0.2), DOWN, between)
    for x, y in product((first - 0.5, min(first + 0.5, 0.0)), (-0.3, 0.3)):
        bodies.touch(1, NOTHING, (x, y, 0.0), DOWN, feet[0])
    return bodies


def test_the_ground_carries_both_blocks_and_the_lower_block_one():
    contacts, work = two_blocks(1.0, masses=(2.0, 3.0)).asked(DOWN)
    assert equilibrium(contacts, FRAME, 0.0, AT_REST, work) == HELD_WITHOUT_FRICTION
    forces = contacts.states["forces"][:, 0]
    assert forces[:4].sum() == pytest.approx(2.0, rel=1e-13)
    assert forces[4:].sum() == pytest.approx(5.0, rel=1e-13)


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("beyond", [-1e-6, 1e-6])
def test_two_books_overhang_by_three_quarters_of_their_length(beyond, friction):
    """The harmonic stack: the upper one hangs over by a half, the lower one by a quarter."""
    upper = two_blocks(1.0, overhangs=(0.5 + beyond, 0.1))
    both = two_blocks(1.0, overhangs=(0.5 - 1e-6, 0.25 + 0.5e-6 + beyond))
    for bodies in (upper, both):
        contacts, work = bodies.asked(DOWN)
        assert (equilibrium(contacts, FRAME, friction, AT_REST, work) != MOVES) == (beyond < 0.0)


@pytest.mark.parametrize(
    ("ground", "between"), [(0.3, 0.1), (0.1, 0.3), (0.2, 0.0), (0.0, 0.2), (0.7, 0.2), (0.3, 0.7)]
)
def test_blocks_slide_down_a_slope_as_by_hand(ground, between):
    """Their accelerations along 30 deg: the upper one slips on the lower one, or both go as one."""
    gravity = np.array([math.sin(math.pi / 6), 0.0, -math.cos(math.pi / 6)])
    down, press = gravity[0], -gravity[2]
    most = max(ground, between)
    bodies = two_blocks(between / most, feet=(ground / most, 0.0))
    contacts, work = bodies.asked(gravity)
    assert onset(contacts, FRAME, most, work) == MOVES
    upper, lower = (a[0] for a in bodies.accelerations(work))
    together = max(down - ground * press, 0.0)
    slips = down - between * press > together
    below = max(down + between * press - 2.0 * ground * press, 0.0) if slips else together
    assert upper == pytest.approx(down - between * press if slips else together, abs=1e-9)
    assert lower == pytest.approx(below, abs=1e-9)


def test_that_rest_is_the_only_onset_of_a_stack_is_proven_over_all_its_freedoms():
    """On a slope of 30 deg, whose tangent is 0.577, both hold with 0.9, and the upper one slips with 0.57."""
    gravity, system = np.array([0.5, 0.0, -math.sqrt(0.75)]), empty_system(N_COLUMNS, 13)
    contacts, work = two_blocks(0.57 / 0.9).asked(gravity)
    assert equilibrium(contacts, FRAME, 0.9, AT_REST, work) == MOVES
    bodies, tree = two_blocks(1.0), empty_record(ModeTree)
    contacts, work = bodies.asked(gravity)
    assert equilibrium(contacts, FRAME, 0.9, AT_REST, work) == HELD_BY_FRICTION
    assert as_machine_code(other_onset)(contacts, 0.9, work.load, tree, work.newton, system) == UNIQUE
    # the root alone says nothing, and the twists of the proof move both blocks
    proofs = tree.twists[: tree.n_nodes][tree.is_closed[: tree.n_nodes] == 1, :12]
    assert len(proofs) > 1
    assert np.abs(proofs[:, :6]).max() > 0.1
    assert np.abs(proofs[:, 6:]).max() > 0.1

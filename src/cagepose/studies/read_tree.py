"""From the tree of a search of the kernels to `ModeTree`."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from cagepose.kernels.contact import coulomb_newton
from cagepose.kernels.stability import relaxation
from cagepose.kernels.stability.relaxation import ANY_WAY, AWAY, BEFORE, BEHIND, INTO, N_VELOCITIES, QUARTER_TURNS
from cagepose.model.checks import FloatArray
from cagepose.studies.mode_tree import Decision, ModeTree

DECISIONS: dict[int, Decision] = {
    relaxation.UNDECIDED: "none",
    coulomb_newton.OPENS: "opens",
    relaxation.CLOSED: "closed",
    coulomb_newton.STICKS: "sticks",
    coulomb_newton.SLIPS: "slips",
}


def read_tree(tree: Any, columns: FloatArray, lengths: FloatArray, scale: FloatArray) -> ModeTree:
    """Return the tree that a search has left, with twists and pressures in the world, in loads.

    Parameters
    ----------
    tree
        A record of `strong.ModeTree`.
    columns
        Scaled wrenches along normal and tangents of the contacts that were asked, (n, 3, n_freedoms).
    lengths
        By what the kernel has multiplied them, (n, 3).
    scale
        (n_freedoms, n_freedoms), as `ContactProblem.scale`.
    """
    n, n_freedoms = int(tree.n_nodes), len(scale)
    found = ModeTree(
        tuple(tree.parents[:n].tolist()),
        tuple(tree.places[:n].tolist()),
        tuple(DECISIONS[mode] for mode in tree.modes[:n].tolist()),
        tree.starts[:n].copy(),
        tree.widths[:n].copy(),
        np.zeros((0, n_freedoms)),
        np.zeros((0, len(columns), 3)),
    )
    leaves = found.leaves()
    sizes = np.linalg.norm(columns[:, 0], axis=1)
    pressures = np.zeros((len(leaves), len(columns), 3))
    for number, leaf in enumerate(leaves):
        ways, shares = tree.ways[leaf, :n_freedoms].tolist(), tree.shares[leaf, :n_freedoms].tolist()
        for way, share in zip(ways, shares, strict=True):
            if way >= 0:
                contact, which = divmod(way, N_VELOCITIES)
                size = share / sizes[contact] * lengths[contact]
                pressures[number, contact] += size * _not_allowed(found, leaf, contact, which)
    return replace(found, twists=tree.twists[leaves, :n_freedoms] @ scale, pressures=pressures)


def _not_allowed(tree: ModeTree, leaf: int, contact: int, which: int) -> FloatArray:
    """Return a velocity at a contact that a leaf does not allow, normal and tangents, by its number."""
    if which in (INTO, AWAY):
        return np.array((1.0 if which == INTO else -1.0, 0.0, 0.0))
    if which in (BEFORE, BEHIND):
        slips = (
            node for node in tree.above(leaf) if tree.contacts[node] == contact and tree.decisions[node] == "slips"
        )
        slip = next(slips)
        first, last = tree.starts_rad[slip], tree.starts_rad[slip] + tree.widths_rad[slip]
        return np.array((0.0, *((np.sin(first), -np.cos(first)) if which == BEFORE else (-np.sin(last), np.cos(last)))))
    return np.array((0.0, *QUARTER_TURNS[which - ANY_WAY : which - ANY_WAY + 2]))

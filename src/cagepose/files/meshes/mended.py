"""What is wrong with a surface put right, as far as it is within a distance that is told: `mended`."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cagepose.files.meshes.cracks import without_cracks
from cagepose.files.meshes.joined import joined
from cagepose.files.meshes.manifolds import Triangles
from cagepose.files.meshes.odd_facets import is_closed, turned_alike, without_doubled, without_strays
from cagepose.files.meshes.tolerances import ROUNDING_OF_MESH, WIDEST_CRACK
from cagepose.model.checks import FloatArray
from cagepose.model.sides import open_sides, starts_and_ends
from cagepose.model.wording import counted

WIDTHS = tuple(np.geomspace(ROUNDING_OF_MESH, WIDEST_CRACK, 7).tolist())
"""Fractions of the size: cracks that are looked for, each some four times as wide as the one before."""


class Mended(NamedTuple):
    """A surface, and what was done to it.

    Attributes
    ----------
    mesh
        Closed; or as it was, where it cannot be closed.
    moved
        How far cracks were open at most, in the unit of its lengths; zero: there were none.
    done
        What else was done, in words.
    nearest
        The surface with the fewest open sides that was found.
    """

    mesh: Triangles
    moved: float
    done: tuple[str, ...]
    nearest: Triangles


def mended(mesh: Triangles) -> Mended:
    """Return a surface that is closed, if it can be: without doubled triangles, its cracks closed the narrowest way
    that closes all, its triangles facing one way, and without a few that belong to nothing.

    Cracks are no wider than `WIDEST_CRACK` of the size; missing triangles stay missing.
    """
    if len(mesh.faces) == 0 or mesh.size == 0.0:
        return Mended(mesh, 0.0, (), mesh)
    single, doubled = without_doubled(mesh)
    done = told(mesh, doubled, "left out as doubled")
    if is_closed(single):
        return Mended(single, 0.0, done, single)
    nearest = single
    for may_stray in (False, True):
        for width in (0.0, *WIDTHS):
            found, moved = without_cracks(single, width * mesh.size) if width > 0.0 else (single, 0.0)
            found, _ = without_doubled(found)  # cracks that are closed bring triangles together
            found, turned = turned_alike(found)
            stray = np.zeros((0, 3))
            if may_stray:
                found, stray = without_strays(found)
            if is_closed(found):
                done += told(mesh, turned, "turned to face as those around")
                done += told(mesh, stray, "left out as part of no body")
                return Mended(_of_corners(found), moved, done, found)
            if len(found.faces) > 0 and len(open_sides(found.faces)) < len(open_sides(nearest.faces)):
                nearest = found
    return Mended(mesh, 0.0, (), nearest)


def where_open(mesh: Triangles, unit: str) -> str:
    """Return where a surface is open, in words: the middle of its longest border, and how wide it is."""
    starts, ends = starts_and_ends(mesh.faces)
    sides = open_sides(mesh.faces)
    starts, ends = starts[sides], ends[sides]
    border = joined(len(mesh.vertices), np.stack([starts, ends], axis=1))[starts]
    lengths = np.linalg.norm(mesh.vertices[ends] - mesh.vertices[starts], axis=1)
    borders, which = np.unique(border, return_inverse=True)
    longest = which == np.bincount(which, lengths).argmax()
    corners = mesh.vertices[np.unique(np.concatenate([starts[longest], ends[longest]]))]
    middle = (corners.max(axis=0) + corners.min(axis=0)) / 2.0
    spread = (corners - middle) @ np.linalg.svd(corners - middle, full_matrices=False)[2].T
    gap = float(np.sort(np.ptp(spread, axis=0))[-2]) if len(corners) > 2 else 0.0
    n_sides = counted((int(longest.sum()), "side has no neighbour", "sides have no neighbour"))
    wide = f", a gap of {gap:.2g} {unit}" if gap > 0.0 else ""
    beside = f", and {counted((len(borders) - 1, 'more place', 'more places'))} like it" if len(borders) > 1 else ""
    return f"is open at {place(middle, mesh.size)} {unit}: {n_sides}{wide}{beside}"


def place(at: FloatArray, size: float) -> str:
    """Return a place in words, to a ten-thousandth of a size."""
    decimals = 4 - int(np.floor(np.log10(size)))
    return f"({', '.join(f'{round(float(value), decimals) + 0.0:.12g}' for value in at)})"


def told(mesh: Triangles, places: FloatArray, what: str) -> tuple[str, ...]:
    """Return what was done with triangles at some places of a surface, in words; nothing where there are none."""
    if len(places) == 0:
        return ()
    like = "" if len(places) == 1 else "as "
    return (f"{counted((len(places), 'triangle', 'triangles'))} {what}, {like}at {place(places[0], mesh.size)}",)


def _of_corners(mesh: Triangles) -> Triangles:
    """Return a surface without corners that no triangle has."""
    used, faces = np.unique(mesh.faces, return_inverse=True)
    return Triangles(mesh.vertices[used], faces.reshape(-1, 3))

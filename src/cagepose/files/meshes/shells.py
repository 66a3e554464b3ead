"""Closed surfaces of one file that overlap, lie in each other, or are inside out: `as_bodies`."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from cagepose.files.meshes.cuts import together
from cagepose.files.meshes.joined import joined
from cagepose.files.meshes.manifolds import Triangles
from cagepose.files.meshes.tolerances import ROUNDING_OF_MESH, VOLUME_NOT_CONVEX
from cagepose.model.near_pairs import near_pairs
from cagepose.model.sides import IntArray

MOST_PAIRS = 5000
"""Pairs of surfaces whose boxes overlap; each takes a millisecond or more."""
SAME_VOLUME = 1e-6
"""Fraction of the volume. What shares all but so much of its volume with another body lies in it."""


class Bodies(NamedTuple):
    """A closed surface that faces outwards, and what was done to make it so, in words."""

    mesh: Triangles
    done: tuple[str, ...]


def as_bodies(mesh: Triangles, shells: list[Any]) -> Bodies:
    """Return the surface of what closed surfaces, none of which crosses itself, enclose together.

    A surface that faces inwards, and is in no other one, is turned; those within it are then cavities. One that faces
    outwards within another one is left out. Of those that overlap and are not all convex, the union is taken: convex
    ones are shapes of ours, which may overlap.

    Parameters
    ----------
    mesh
        The surface.
    shells
        Its parts that hang together, as bodies of manifold3d.
    """
    volumes = np.array([shell.volume() for shell in shells])
    is_inward = volumes < 0.0
    if len(shells) == 1:
        return Bodies(_turned(mesh), (INSIDE_OUT,)) if is_inward[0] else Bodies(mesh, ())
    solids = [
        _turned(Triangles.of(shell)).body() if back else shell for shell, back in zip(shells, is_inward, strict=True)
    ]
    pairs, is_within = _overlaps(solids, np.abs(volumes), mesh.size)
    depth = is_within.sum(axis=1)
    of_turned = (is_within & (is_inward & (depth == 0))).any(axis=1)
    is_hollow = (depth % 2 == 1) & (is_inward | of_turned)
    is_left_out = (depth % 2 == 1) & ~is_hollow
    n_turned, n_left_out = int((is_hollow ^ is_inward)[~is_left_out].sum()), int(is_left_out.sum())
    done = list[str]()
    if n_turned:
        done.append(f"{n_turned} of {len(shells)} closed surfaces turned, which {_are(n_turned)} inside out")
    if n_left_out:
        done.append(
            f"{n_left_out} of {len(shells)} closed surfaces left out, which {_are(n_left_out)} within another one"
        )
    pairs = pairs[~is_left_out[pairs].any(axis=1) & ~is_hollow[pairs].any(axis=1)]
    group = joined(len(solids), pairs)
    allowed = ROUNDING_OF_MESH * mesh.size
    parts, n_joined = [], 0
    for first in np.unique(group[~is_left_out]).tolist():
        members = [solids[k] for k in np.flatnonzero(group == first).tolist()]
        if len(members) > 1 and not all(map(_is_convex, members)):
            n_joined += len(members)
            parts.append(Triangles.of(together(members).as_original().simplify(allowed)))
        else:
            found = [Triangles.of(member) for member in members]
            parts += [_turned(one) for one in found] if is_hollow[first] else found
    if n_joined:
        done.append(f"{n_joined} closed surfaces overlap; here, their union")
    if not (n_turned or n_left_out or n_joined):
        return Bodies(mesh, ())
    firsts = np.cumsum([0, *(len(part.vertices) for part in parts)])
    faces = [part.faces + first for part, first in zip(parts, firsts, strict=False)]
    return Bodies(Triangles(np.concatenate([part.vertices for part in parts]), np.concatenate(faces)), tuple(done))


INSIDE_OUT = "inside out in the file; turned here"


def _overlaps(
    solids: list[Any], volumes: Any, size: float
) -> tuple[IntArray, np.ndarray[tuple[int, int], np.dtype[np.bool_]]]:
    """Return the pairs of bodies that share some of their volumes; and of each body, in which other ones it lies.

    Raises
    ------
    ValueError
        There are too many to ask.
    """
    boxes = np.array([solid.bounding_box() for solid in solids])
    near = near_pairs(boxes[:, :3], boxes[:, 3:], MOST_PAIRS)
    if len(near) > MOST_PAIRS:
        raise ValueError(
            f"has {len(solids):,} closed surfaces, many within each other's boxes; export them as one body"
        )
    is_within = np.zeros((len(solids), len(solids)), bool)
    pairs = []
    for one, other in near.tolist():
        shared = solids[one] ^ solids[other]
        if shared.volume() <= ROUNDING_OF_MESH * size * shared.surface_area():
            continue  # they touch
        inner, outer = (one, other) if volumes[one] < volumes[other] else (other, one)
        if shared.volume() >= (1.0 - SAME_VOLUME) * volumes[inner]:
            is_within[inner, outer] = True
        else:
            pairs.append((one, other))
    return np.array(pairs, np.int64).reshape(-1, 2), is_within


def _is_convex(body: Any) -> bool:
    hull = body.hull().volume()
    return bool(hull - body.volume() <= VOLUME_NOT_CONVEX * hull)


def _turned(mesh: Triangles) -> Triangles:
    return Triangles(mesh.vertices, mesh.faces[:, ::-1])


def _are(number: int) -> str:
    return "is" if number == 1 else "are"

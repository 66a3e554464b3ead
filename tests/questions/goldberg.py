"""Goldberg's estimate of how often a part ends on each face of its hull: an oracle of rests on a plane."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from cagepose.model.checks import FloatArray
from cagepose.model.hull import Hull


def goldberg_shares(hull: Hull, center: FloatArray) -> FloatArray:
    """Return the share of each face by Goldberg's estimate: the solid angle of its own, and of those that topple over
    to it, each over the edge that is nearest to the foot of the centre of gravity.
    """
    corners, faces = hull.vertices_m - center, hull.faces
    beside = {side: face for face, loop in enumerate(faces) for side in zip(loop, loop[1:] + loop[:1], strict=True)}
    shares, following = np.zeros(len(faces)), list(range(len(faces)))
    for face, loop in enumerate(faces):
        at = corners[list(loop)]
        for one, other in pairwise(at[1:]):
            shares[face] += _solid_angle(at[0], one, other) / (4.0 * np.pi)
        normal, sides = hull.normals[face], np.roll(at, -1, axis=0) - at
        inside = np.einsum("ij,ij->i", np.cross(normal, sides), -at) / np.linalg.norm(sides, axis=1)
        if inside.min() < 0.0:
            along = np.clip(-np.einsum("ij,ij->i", at, sides) / np.einsum("ij,ij->i", sides, sides), 0.0, 1.0)
            near = at + along[:, None] * sides
            near = np.linalg.norm(near - np.outer(near @ normal, normal), axis=1)
            edge = int(np.argmin(near))
            following[face] = beside[loop[(edge + 1) % len(loop)], loop[edge]]
    for face in range(len(faces)):
        end = face
        for _ in faces:
            end = following[end]
        if end != face:
            shares[end], shares[face] = shares[end] + shares[face], 0.0
    return shares


def _solid_angle(a: FloatArray, b: FloatArray, c: FloatArray) -> float:
    a, b, c = (corner / np.linalg.norm(corner) for corner in (a, b, c))
    return 2.0 * float(np.arctan2(a @ np.cross(b, c), 1.0 + a @ b + b @ c + c @ a))

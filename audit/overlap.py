"""How deep are two bodies in each other? By places on both surfaces and signed distances of the bodies.

A depth that is told is that of one place, which lies in both bodies: none of it comes from the sampling, which may only
miss some. From the deepest places of a coarse sampling a pattern search goes on to the deepest near them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from audit.case import FloatArray
from audit.patches import IntArray, Patches, Samples
from audit.solids import Distance, body_distance, rotation_of
from audit.stations import farthest_way
from cagepose import Pose, Scene

SPACING = 1 / 40
"""Of the size: how far the places of the coarse sampling are from each other, if their number allows it."""
MOST_PLACES = 5000
"""Of a body; where there were more, they are farther from each other."""
FINEST = 1e-6
"""Of the size: the spacing at which the search ends; depths are not known better."""
WITHIN = 1e-12
"""Of the size: a place so far out of its own body is still in it, by rounding."""
MOST_PATCHES = 4
"""From so many of them, of each body, the search begins at each pose."""
MOST_ROUNDS = 40
AROUND = np.array([(j, k) for j in (-1.0, 0.0, 1.0) for k in (-1.0, 0.0, 1.0) if (j, k) != (0.0, 0.0)])
"""Where the search looks from a place, in steps."""


@dataclass(frozen=True)
class Overlap:
    """The deepest place at the ``index``-th pose; below zero: a gap."""

    index: int
    depth_m: float
    place_world: FloatArray


@dataclass(frozen=True)
class _Surface:
    """Places on one body, in its frame; distances from it in that frame, and from the other body in the other's."""

    samples: Samples
    own: Distance
    other: Distance


class Bodies:
    """Object and cage of a scene; the cage in its own frame, in which all places are reckoned."""

    def __init__(self, scene: Scene) -> None:
        """
        Raises
        ------
        NotImplementedError
            A part is a flat polygon with a radius.
        """
        held, cage = scene.object, scene.cage
        self.scene, self.size_m = scene, scene.size_m
        self.cage_rotation, self.cage_position = rotation_of(cage.pose_world_cage), cage.pose_world_cage.position_m
        of_held, of_cage = body_distance(held.parts, held.holes), body_distance(cage.shapes, cage.holes)
        cage_patches = Patches(cage.shapes, cage.holes, cage.points_cage)
        self.cage = _Surface(self._sampled(cage_patches, of_cage), of_cage, of_held)
        self.held = None
        if cage.shapes or cage.holes:
            held_patches = Patches(held.parts, held.holes, np.zeros((0, 3)))
            self.held = _Surface(self._sampled(held_patches, of_held), of_held, of_cage)

    def overlaps(self, poses: Sequence[Pose]) -> Iterator[Overlap]:
        """Yield the deepest place of each pose at which the bodies are near each other."""
        rotations = np.array([self.cage_rotation.T @ rotation_of(pose) for pose in poses])
        positions = np.array([self.cage_rotation.T @ (pose.position_m - self.cage_position) for pose in poses])
        surfaces = [self._near(rotations, positions), *([self.held] if self.held else [])]
        surfaces = [surface for surface in surfaces if len(surface.samples.patch)]
        places, gaps, indices = [np.zeros((0, 3))], [np.zeros(0)], [np.zeros(0, dtype=np.int64)]
        chosen = self._starts(surfaces, poses, rotations, positions)
        for surface, (starts, at) in zip(surfaces, chosen, strict=True):
            place, gap = self._search(surface, starts, rotations[at], positions[at])
            places.append(place)
            gaps.append(gap)
            indices.append(at)
        place, gap, index = np.concatenate(places), np.concatenate(gaps), np.concatenate(indices)
        order = np.lexsort((gap, index))
        for row in order[np.unique(index[order], return_index=True)[1]].tolist():
            yield Overlap(int(index[row]), -float(gap[row]), self.cage_rotation @ place[row] + self.cage_position)

    def _sampled(self, patches: Patches, own: Distance) -> Samples:
        """Return places all over the surface of a body; points, which have no inside, are all of it."""
        spacing = SPACING * self.size_m
        samples = patches.samples(spacing)
        if len(samples.patch) > MOST_PLACES:
            samples = patches.samples(spacing * math.sqrt(len(samples.patch) / MOST_PLACES))
        return samples.chosen((samples.spacing_m == 0.0) | (own(samples.places) <= WITHIN * self.size_m))

    def _near(self, rotations: FloatArray, positions: FloatArray) -> _Surface:
        """Return the places of the cage that the object may reach at one of its poses."""
        held, samples = self.scene.object, self.cage.samples
        middles = rotations @ held.center_of_gravity_m + positions
        low, high = middles.min(axis=0) - held.reach_m, middles.max(axis=0) + held.reach_m
        margin = samples.spacing_m[:, None]
        is_near = ((samples.places >= low - margin) & (samples.places <= high + margin)).all(axis=1)
        return _Surface(samples.chosen(is_near), self.cage.own, self.cage.other)

    def _gaps(self, surface: _Surface, places: FloatArray, rotation: FloatArray, position: FloatArray) -> FloatArray:
        """How far places of one body are from the other; one pose, or one for each place."""
        if surface is self.held:
            return surface.other(np.einsum("...ij,...j->...i", rotation, places) + position)
        return surface.other(np.einsum("...ji,...j->...i", rotation, places - position))

    def _starts(
        self, surfaces: Sequence[_Surface], poses: Sequence[Pose], rotations: FloatArray, positions: FloatArray
    ) -> list[tuple[IntArray, IntArray]]:
        """Return for each surface at which places the search begins, and at which pose each.

        After a pose with a gap, those are left out that the object reaches by moving less than that.
        """
        nothing = np.zeros(0, dtype=np.int64)
        found: list[list[tuple[IntArray, IntArray]]] = [[(nothing, nothing)] for _ in surfaces]
        clear_m, before = 0.0, poses[0]
        for index, pose in enumerate(poses):
            if farthest_way(self.scene, before, pose) * self.size_m < clear_m:
                continue
            before, clear_m = pose, math.inf
            for surface, rows in zip(surfaces, found, strict=True):
                gaps = self._gaps(surface, surface.samples.places, rotations[index], positions[index])
                clear_m = min(clear_m, float((gaps - surface.samples.spacing_m).min()))
                chosen = _lowest(surface.samples, gaps)
                rows.append((chosen, np.full(len(chosen), index, dtype=np.int64)))
        return [(np.concatenate([row[0] for row in rows]), np.concatenate([row[1] for row in rows])) for rows in found]

    def _search(
        self, surface: _Surface, chosen: IntArray, rotations: FloatArray, positions: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the deepest places (n, 3) near those chosen, in the cage's frame, and their gaps to the other body."""
        samples, patches = surface.samples, surface.samples.patches
        patch, at = samples.patch[chosen], np.stack([samples.u[chosen], samples.v[chosen]], axis=1)
        steps = np.stack([samples.step_u[chosen], samples.step_v[chosen]], axis=1) / 2.0
        spacing = samples.spacing_m[chosen] / 2.0
        highest = np.where((patch < len(patches.flat))[:, None], 1.0, (np.inf, 1.0))  # around an axis there is no end

        def looked(rows: IntArray, where: FloatArray) -> tuple[FloatArray, FloatArray]:
            places = patches.places(patch[rows], where[:, 0], where[:, 1])
            gaps, beyond = self._gaps(surface, places, rotations[rows], positions[rows]), surface.own(places)
            is_out = (beyond > WITHIN * self.size_m) & (spacing[rows] > 0.0)  # in a hole, or beyond its end
            return places, np.where(is_out, np.maximum(gaps, beyond), gaps)

        places, lowest = looked(np.arange(len(patch)), at)
        for _ in range(MOST_ROUNDS):
            rows = np.flatnonzero(spacing > FINEST * self.size_m)
            if not len(rows):
                break
            around = np.repeat(rows, len(AROUND))
            where = at[around] + steps[around] * np.tile(AROUND, (len(rows), 1))
            where = np.clip(where, np.where(highest[around] == 1.0, 0.0, -np.inf), highest[around])
            found, gaps = looked(around, where)
            best = np.arange(len(rows)) * len(AROUND) + gaps.reshape(len(rows), -1).argmin(axis=1)
            is_better = gaps[best] < lowest[rows]
            better, best = rows[is_better], best[is_better]
            lowest[better], places[better], at[better] = gaps[best], found[best], where[best]
            steps[rows[~is_better]] /= 2.0
            spacing[rows[~is_better]] /= 2.0
        if surface is self.held:
            places = np.einsum("nij,nj->ni", rotations, places) + positions
        return places, lowest


def _lowest(samples: Samples, gaps: FloatArray) -> IntArray:
    """Return which places have the least gap on their patch, of the `MOST_PATCHES` patches with the least, where the
    other body may be nearer than the places are to each other.
    """
    firsts = np.flatnonzero(np.diff(samples.patch, prepend=-1))
    ends = np.append(firsts[1:], len(gaps))
    nearest = np.argsort(np.minimum.reduceat(gaps, firsts), kind="stable")[:MOST_PATCHES]
    chosen = [first + int(gaps[first:end].argmin()) for first, end in zip(firsts[nearest], ends[nearest], strict=True)]
    found = np.array(chosen, dtype=np.int64)
    return found[gaps[found] <= samples.spacing_m[found]]

"""Blocks that points touch, to be seen in the plane, and whether one can begin to move: all ways of its contacts are
enumerated, or a motion in space is checked. Shares nothing with the kernels.
"""

from __future__ import annotations

import itertools
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog

from cagepose import Box, Cage, Force, FreeMotion, Load, Object, Scene

WIDTH, DEPTH, HEIGHT = 0.04, 0.2, 0.03
BESIDE = 0.09
"""Metres from the plane to each of the two points that stand for one contact."""
FRICTION = 0.6
SIZE = 0.02
"""Metres. Moments and turns are divided by it."""


TOUCHING = 1e-7
"""A contact that opens or slips more slowly does neither; speeds are those of a motion of length 1."""


class Block(NamedTuple):
    """A block in the plane of x and z, metres: where it is touched, along which normal it is pushed there, and a force
    of one beside them.
    """

    places: NDArray[np.float64]
    normals: NDArray[np.float64]
    force: NDArray[np.float64]
    at: NDArray[np.float64]

    def scene(self) -> Scene:
        """Return the block, two points standing for each contact, one on each side of the plane."""
        points = {f"P{i}{side}": (x, y, z) for i, (x, z) in enumerate(self.places) for side, y in _SIDES}
        push = Force((self.force[0], 0.0, self.force[1]), (self.at[0], 0.0, self.at[1]))
        block = Object([Box((WIDTH, DEPTH, HEIGHT))])
        cage = Cage(list(points.values()), list(points))
        return Scene(block, cage, [Load("push", force=push)], friction_coefficient=FRICTION)


_SIDES = (("near", -BESIDE), ("far", BESIDE))


def drawn_block(rng: np.random.Generator) -> Block:
    """Return a block on one or two feet that leans against a wall; maybe something is above it, or behind it."""
    x, z = 0.5 * WIDTH, 0.5 * HEIGHT
    contacts = [(rng.uniform(-0.9, -0.2) * x, -z, 0.0, 1.0), (x, rng.uniform(-0.9, 0.9) * z, -1.0, 0.0)]
    if rng.random() < 0.7:
        contacts.append((rng.uniform(0.2, 0.9) * x, -z, 0.0, 1.0))
    if rng.random() < 0.5:
        contacts.append((rng.uniform(-0.9, 0.9) * x, z, 0.0, -1.0))
    table, angle = np.array(contacts), rng.uniform(-0.5, 1.2)
    force = np.array([np.sin(angle), -np.cos(angle)])
    return Block(table[:, :2], table[:, 2:], force, np.array([rng.uniform(-0.7, 0.7) * x, rng.uniform(-0.7, 0.7) * z]))


def can_begin_to_move(block: Block, friction: float) -> bool:
    """Whether Coulomb's law allows any motion of the block in its plane: each contact opens, sticks, or slips one way
    or the other; each such mode is a linear program for the greatest power of the load.
    """
    n = len(block.places)
    load = _row(block.force, block.at)
    mass = np.array([1.0, 1.0, _square(0, 2)])
    tangents = np.stack([-block.normals[:, 1], block.normals[:, 0]], axis=1)
    along, across = (
        np.array([_row(one, place) for one, place in zip(directions, block.places, strict=True)])
        for directions in (block.normals, tangents)
    )
    motion = np.hstack([np.diag(mass), -along.T, -across.T])
    for mode in itertools.product(("opens", "sticks", "slips ahead", "slips back"), repeat=n):
        equal, at_most = [], []
        for i, way in enumerate(mode):
            opening, slip, normal, tangential = np.zeros((4, 3 + 2 * n))
            opening[:3], slip[:3], normal[3 + i], tangential[3 + n + i] = along[i], across[i], 1.0, 1.0
            if way == "opens":
                at_most.append(-opening)
                equal += [normal, tangential]
                continue
            equal.append(opening)
            at_most.append(-normal)
            if way == "sticks":
                equal.append(slip)
                at_most += [tangential - friction * normal, -tangential - friction * normal]
            else:
                sign = 1.0 if way == "slips ahead" else -1.0
                at_most.append(-sign * slip)
                equal.append(tangential + sign * friction * normal)
        found = linprog(
            -np.concatenate([load, np.zeros(2 * n)]),
            A_ub=np.array(at_most),
            b_ub=np.zeros(len(at_most)),
            A_eq=np.vstack([motion, *equal]),
            b_eq=np.concatenate([load, np.zeros(len(equal))]),
            bounds=(None, None),
        )
        if found.status == 0 and -found.fun > 1e-9:
            return True
    return False


def obeys_coulomb(block: Block, motion: FreeMotion, friction: float) -> bool:
    """Whether a motion of the block in space, at some speed, is what the load and forces of Coulomb's law make of it:
    none where a contact opens, full friction against a slip, any within a cone of 256 sides where it sticks.
    """
    twist = _twist(motion)
    mass = np.array([1.0, 1.0, 1.0, _square(1, 2), _square(0, 2), _square(0, 1)])
    push = np.array([block.force[0], 0.0, block.force[1]])
    load = np.concatenate([push, np.cross([block.at[0], 0.0, block.at[1]], push) / SIZE])
    columns = [-mass * twist]
    for (x, z), (nx, nz) in zip(block.places, block.normals, strict=True):
        normal, tangents = np.array([nx, 0.0, nz]), np.array([[-nz, 0.0, nx], [0.0, 1.0, 0.0]])
        for _, y in _SIDES:
            place = np.array([x, y, z])
            speed = twist[:3] + np.cross(twist[3:] / SIZE, place)
            opening, slip = float(normal @ speed), tangents @ speed
            if opening < -TOUCHING:
                return False
            if opening > TOUCHING:
                continue
            size = float(np.hypot(*slip))
            angles = 2.0 * np.pi * np.arange(256) / 256
            ways = np.stack([np.cos(angles), np.sin(angles)], axis=1) if size < TOUCHING else -slip[None] / size
            for force in normal + friction * ways @ tangents:
                columns.append(np.concatenate([force, np.cross(place, force) / SIZE]))
    faster = -np.eye(len(columns))[0]
    found = linprog(faster, A_eq=np.array(columns).T, b_eq=-load, bounds=(0.0, None))
    return bool(found.status == 3 or (found.status == 0 and -found.fun > 1e-6))


def _twist(motion: FreeMotion) -> NDArray[np.float64]:
    """Return how the middle of the block travels, and how it turns, in lengths of `SIZE`, (6,), of length 1."""
    if motion.direction_world is not None:
        return np.array([*motion.direction_world, 0.0, 0.0, 0.0])
    assert motion.axis_world is not None
    assert motion.through_world is not None
    travel = motion.pitch_m * motion.axis_world - np.cross(motion.axis_world, motion.through_world)
    twist = np.concatenate([travel, SIZE * motion.axis_world])
    return np.asarray(twist / np.linalg.norm(twist))


def _square(one: int, other: int) -> float:
    """Return the square of the block's radius of gyration about the axis across two others, in lengths of `SIZE`."""
    sides = (WIDTH, DEPTH, HEIGHT)
    return (sides[one] ** 2 + sides[other] ** 2) / 12.0 / SIZE**2


def _row(direction: NDArray[np.float64], place: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a force and its moment about the middle, in lengths of `SIZE`."""
    return np.array([*direction, (place[0] * direction[1] - place[1] * direction[0]) / SIZE])

"""Symmetric scenes as they come from a drawing, at 401 coefficients of friction from 0 to 1: none may end stalled."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np

from cagepose import Box, Cage, Force, Load, Object, Pose, Scene, load_scene

N_FRICTIONS = 401
SCENES = Path(__file__).parents[1] / "scenes"
MM = 1e-3


def friction_at(index: int) -> float:
    """From 0 to 1; scattered, so that a few cases show the whole range. All 401 come once in 401 indices."""
    return (index * 150 % N_FRICTIONS) / (N_FRICTIONS - 1)


def rail(index: int) -> Scene:
    """The paper's rail between rollers."""
    return _rail().changed(friction_coefficient=friction_at(index))


def drawer(index: int) -> Scene:
    """A drawer on rollers, under stops and between side rollers; closed at its middle, then beside it."""
    return _drawer().changed(friction_coefficient=friction_at(index))


def table(index: int) -> Scene:
    """A flat part over six points, two of them lower, its centre of gravity aside: it reaches two points at once."""
    return _table().changed(friction_coefficient=friction_at(index))


def dock(index: int) -> Scene:
    """A telephone leans back in a dock, is pressed onto its plug, and pushed at its upper edge."""
    return _dock().changed(friction_coefficient=friction_at(index))


@cache
def _rail() -> Scene:
    return load_scene(SCENES / "rail-pitch.yaml")


@cache
def _drawer() -> Scene:
    points: list[tuple[float, float, float]] = [(x, y, -0.5) for x in (-150, 150) for y in (-190, 190)]
    points += [(x, y, 101) for x in (-180, -60) for y in (-190, 190)]
    points += [(x, y, 50) for x in (-150, 150) for y in (-200.5, 200.5)]
    points += [(-251, y, 50) for y in (-100, 100)]
    return Scene(
        Object(
            [
                Box((0.5, 0.4, 0.1), Pose((0, 0, 0.05)), "drawer"),
                Box((0.01, 0.42, 0.12), Pose((0.255, 0, 0.05)), "front"),
            ]
        ),
        Cage(np.array(points) * MM),
        [
            Load("weight", gravity=(0, 0, -1)),
            Load("close", force=Force((-1, 0, 0), (0.26, 0, 0.05))),
            Load("close aside", force=Force((-1, 0, 0), (0.26, 0.15, 0.05))),
        ],
        name="drawer",
    )


@cache
def _table() -> Scene:
    points = [(180, 190, 0), (-20, 190, 0), (180, -190, 0), (-20, -190, 0), (-180, 190, -5), (-180, -190, -5)]
    held = Object([Box((0.4, 0.4, 0.02), name="table")], (-0.06, 0.08, -0.02), pose=Pose((0, 0, 0.01025)))
    return Scene(held, Cage(np.array(points) * MM), [Load("weight", gravity=(0, 0, -1))], name="table")


@cache
def _dock() -> Scene:
    lean = Pose(euler_zyx=(0.0, 0.35, 0.0))
    points: list[tuple[float, float, float]] = [(-4.4, y, z) for y in (-30, 30) for z in (10, 60)]
    points += [(4.4, y, z) for y in (-30, 30) for z in (5, 15)]
    points += [(0, y, -0.3) for y in (-20, 20)]
    points += [(0, y, 8) for y in (-38, 38)]
    placed = lean.transform(np.array(points) * MM)
    return Scene(
        Object([Box((0.008, 0.075, 0.15), Pose((0, 0, 0.075)), "telephone")], pose=lean),
        Cage(placed),
        [
            Load("weight", gravity=(0, 0, -1)),
            Load("press", force=Force(lean.rotation @ (0, 0, -1), (0, 0, 0.15))),
            Load("push", force=Force((-1, 0, 0), (0.004, 0, 0.14))),
        ],
        name="dock",
    )

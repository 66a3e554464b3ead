"""The rails that every engine runs, and the one check of accuracy that all of them face."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cagepose import Scene, load_scene
from cagepose.paper.planar import play_angle_rad
from cagepose.paper.rail import PAPER_RAIL

FloatArray = NDArray[np.float64]

SCENES = Path(__file__).resolve().parent.parent / "scenes"
PLAY_M = PAPER_RAIL.roller_gap_m - PAPER_RAIL.guide_thickness_m
PLAY_ANGLE_RAD = play_angle_rad(PAPER_RAIL.roller_gap_m, PAPER_RAIL.guide_thickness_m, PAPER_RAIL.roller_spacing_m)
"""Tilt between rail and rollers at both ends of the play, 0.313084 deg: up under gravity, down under the push."""
EXACT_TILTS_RAD = (PLAY_ANGLE_RAD, -PLAY_ANGLE_RAD)


@dataclass(frozen=True)
class Answer:
    """What an engine says of a scene.

    Attributes
    ----------
    rotations
        Of the object in the world at the end of each phase, (3, 3) each.
    """

    rotations: tuple[FloatArray, ...]


def rail_scenes() -> list[Scene]:
    """Return the three rails of ``scenes/``."""
    return [load_scene(path) for path in sorted(SCENES.glob("rail-*.yaml"))]


def tilt_rad(scene: Scene, rotation_world_object: FloatArray) -> float:
    """Return the angle of the rail's z axis in the rollers' xz plane, radians."""
    n = scene.cage.pose_world_cage.rotation.T @ rotation_world_object[:, 2]
    return math.atan2(n[0], n[2])


def tilt_error(scene: Scene, rotations: Sequence[FloatArray]) -> float:
    """Return the greatest error of the tilt over the phases, as a part of the play angle (exact: `EXACT_TILTS_RAD`).

    An engine that loses the rail, or that reports fewer phases, has an infinite error.
    """
    if len(rotations) != len(EXACT_TILTS_RAD) or not all(np.isfinite(rotation).all() for rotation in rotations):
        return math.inf
    return max(
        abs(tilt_rad(scene, rotation) - exact) / PLAY_ANGLE_RAD
        for rotation, exact in zip(rotations, EXACT_TILTS_RAD, strict=True)
    )

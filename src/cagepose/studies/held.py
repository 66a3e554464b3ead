"""Which freedoms of a scene are held while its play is asked: `held_for_play`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cagepose.errors import Problem, SceneError
from cagepose.model.checks import FloatArray
from cagepose.model.planar import LEAST_TILT, held_freedoms
from cagepose.model.scene import Scene
from cagepose.model.wording import few
from cagepose.studies.play_frame import FREEDOMS, N_LENGTHS


def held_for_play(scene: Scene, hold: Sequence[str]) -> FloatArray:
    """Return 1 for each freedom that a scene or the question holds, else 0, (6,), in the order of `FREEDOMS`.

    Raises
    ------
    SceneError
        A name that is none, or turns of which some are held and more than one is left; a cage that is turned, as its
        axes are then not the world's.
    """
    held = held_freedoms(scene.planar)
    if not hold:
        return held
    unknown = [name for name in hold if name not in FREEDOMS]
    problems = []
    if unknown:
        named = few(name or "an empty name" for name in unknown)
        problems.append(f"has {named}; the freedoms are {few(FREEDOMS, len(FREEDOMS))}")
    else:
        held[[FREEDOMS.index(name) for name in hold]] = 1.0
        if held.all():
            problems.append("leaves nothing that could move; leave out one of them")
        elif held[N_LENGTHS:].sum() == 1.0:  # to hold one of three turns in a row depends on their order
            problems.append("leaves two turns of three, which no pose can be told by; hold two of them, or all three")
    rotation = scene.cage.pose_world_cage.rotation
    if np.abs(rotation - np.eye(N_LENGTHS)).max() > LEAST_TILT:
        problems.append("is asked in a cage that is turned; turn the object instead, and leave the cage's pose out")
    if problems:
        raise SceneError([Problem(("hold",), problem) for problem in problems])
    return held

"""The gaps that a page tells, and dimensions in its picture: exact ones, of the moments where motions end."""

from __future__ import annotations

from base64 import b64encode
from typing import Any

import numpy as np

from cagepose.files.units import from_metres
from cagepose.studies.gaps import GapFinder
from cagepose.views.viewer.playback import Playback
from cagepose.views.viewer.stage import Stage

MOST_MOMENTS = 40
"""Of a run with more events, gaps are told at the start and where phases end."""
MOST_TOLD = 60
"""Of each moment, the narrowest."""


def gap_data(shown: Playback, stage: Stage) -> list[dict[str, Any]]:
    """Return, for each moment, its shot and columns of gaps, the narrowest first: which element of the cage and which
    part of the object, how far apart in the scene's unit, 0 where they touch, and where: the place on the object in its
    frame, that on the cage in the world, and the unit normal from the one to the other. These are nine 32-bit numbers
    for each gap, in drawing units, in base 64: as words they would take longer than the run.
    """
    finder = GapFinder(shown.run.scene)
    ends = [row.last_shot for row in shown.rows if len(shown.rows) <= MOST_MOMENTS or row.verdict is not None]
    return [_moment(finder, shown, stage, shot) for shot in dict.fromkeys([0, *ends])]


def _moment(finder: GapFinder, shown: Playback, stage: Stage, shot: int) -> dict[str, Any]:
    pose, cage = shown.shots[shot].pose_world_object, shown.shots[shot].cage
    found = finder.at(pose, cage)
    told = found.chosen(np.arange(len(found.parts))[:MOST_TOLD])
    ways = told.others_world - told.places_world
    normals = ways / np.where(told.gaps_m > 0.0, told.gaps_m, 1.0)[:, None]
    on_object = pose.inverse_transform(told.places_world) / stage.size_m
    where = np.concatenate([on_object, stage.place(told.others_world), normals], axis=1)
    return {
        "shot": shot,
        "elements": told.elements.tolist(),
        "parts": told.parts.tolist(),
        "gaps": from_metres(told.gaps_m, shown.length_unit).tolist(),
        "where": b64encode(where.astype("<f4").tobytes()).decode(),
    }

"""Runs of a scene with other values of one of its numbers: how each ends, for a page that asks for them bit by bit."""

from __future__ import annotations

from typing import Any

import numpy as np

from cagepose.errors import SceneError, printable
from cagepose.files.key_path import parse_key_path, resolved, value_at
from cagepose.files.scene_file import SceneFile, SceneText
from cagepose.files.units import from_metres, unit_at
from cagepose.files.words import LengthWords
from cagepose.model.checks import is_finite
from cagepose.runs.many import Runs, run_many

MOST_NUMBERS = 64
"""Of one question: a page asks again and again, so that it can stop, and a hand meanwhile gets its turn."""


def runs_with(scene_text: SceneText, key: object, numbers: object) -> dict[str, Any]:
    """Return the unit of the number at ``key``, below which length there is only rounding, and of the run with each of
    ``numbers`` in its place: verdict, verdicts of all phases, what touches at the end, and where the centre of gravity
    is then, in the file's unit of length; of one that cannot be, the reason.

    Raises
    ------
    SceneFileError
        The scene cannot be used as it is.
    ValueError
        No number stands there, or too many or other things than numbers are given.
    """
    path = resolved(scene_text.yaml.data, parse_key_path(str(key)))
    if not is_finite(value_at(scene_text.yaml.data, path)):
        raise ValueError(f"{key} is no number of this scene")
    if not isinstance(numbers, list) or len(numbers) > MOST_NUMBERS or not all(is_finite(one) for one in numbers):
        raise ValueError(f"{key} can be varied by lists of at most {MOST_NUMBERS} numbers")
    nominal = scene_text.scene_file()
    made: list[SceneFile | str] = []
    for number in numbers:
        try:
            made.append(scene_text.scene_with({path: float(number)}))
        except SceneError as error:
            made.append(printable(str(error).partition("\n")[0]))
    scenes = [one.scene for one in made if isinstance(one, SceneFile)]
    runs = run_many(scenes, threads=1) if scenes else None
    ends = iter(range(len(scenes)))
    told = [{"problem": one} if isinstance(one, str) or runs is None else _end(runs, next(ends), one) for one in made]
    length_unit, noise = nominal.length_unit, LengthWords(nominal.length_unit, nominal.scene.size_m).noise
    return {"unit": unit_at(path, length_unit), "lengthUnit": length_unit, "noise": noise, "runs": told}


def _end(runs: Runs, row: int, made: SceneFile) -> dict[str, Any]:
    verdicts = [str(verdict) for verdict in runs.phase_verdicts[row] if verdict]
    if verdicts == ["invalid"]:
        return {"problem": "no run can begin: something is in the part at the start, or too far from it"}
    names, last = made.scene.cage.element_names, len(verdicts) - 1
    center_m = runs.points_world([made.scene.object.center_of_gravity_m])[row, last, 0]
    return {
        "verdict": verdicts[-1],
        "verdicts": verdicts,
        "touching": [names[index] for index in np.flatnonzero(runs.touching[row, last]).tolist()],
        "center": from_metres(center_m, made.length_unit).tolist() if np.isfinite(center_m).all() else None,
    }

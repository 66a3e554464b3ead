"""A scene file that a viewer changes and runs again, and again. Between two questions it keeps its last runs, from
which pulls go on, and nothing else: what it answers hangs on the question alone.
"""

from __future__ import annotations

import copy
import json
import math
from functools import lru_cache
from pathlib import PurePath
from typing import Any, NamedTuple

import numpy as np

from cagepose.errors import CageposeError, Problem, SceneFileError
from cagepose.files.key_path import parse_key_path, set_value, value_at
from cagepose.files.parameters import evaluated
from cagepose.files.scene_edit import ANGLE_DECIMALS, edited, edited_text, setting, with_cage_angles
from cagepose.files.scene_file import SceneFile, SceneText
from cagepose.files.units import from_metres, to_metres
from cagepose.model.pose import Pose
from cagepose.runs.solve import run
from cagepose.views.viewer.controls import Control, controls
from cagepose.views.viewer.hand import grip_of, grips, pulled
from cagepose.views.viewer.page_data import page_data
from cagepose.views.viewer.playback import Playback, playback
from cagepose.views.viewer.stage import Stage

START = "start"
"""What a page calls the way, (3,) in the scene's unit, by which somebody dragged the start."""
LENGTH_DECIMALS = 12
"""Lengths of a start pose are written with so many decimals in the scene's unit."""
SHOTS_PER_MOTION = 4
"""Fewer than in an exported page, whose maker need not wait for them; the page fills in what is between."""
RUNS_KEPT = 8


class _Ran(NamedTuple):
    shown: Playback
    stage: Stage


class WhatIf:
    """Runs one scene file with values that somebody asks for. The start pose goes with the cage.

    Attributes
    ----------
    controls
        What may be asked for.
    file_name
        What the file with changed values may be called.
    """

    def __init__(self, scene_text: SceneText, set_values: tuple[str, ...] = (), method: str | None = None) -> None:
        """``set_values`` and ``method`` change the file before anybody else does; a cage's quaternion becomes angles.

        Raises
        ------
        SceneFileError
            The scene cannot be used, see `load_scene`.
        """
        changes = set_values if method is None else (*set_values, f"method={method}")
        self._text = with_cage_angles(edited(scene_text, changes))
        of = value_at(self._text.yaml.data, ("friction", "of"))
        self._friction_of = {"of": of} if of else {}
        self._scene_file = self._text.scene_file()
        self.controls: list[Control] = controls(self._text)
        self.file_name = f"{PurePath(scene_text.yaml.source).stem}-changed.yaml"
        self._ran = lru_cache(RUNS_KEPT)(self._run)

    def answer(self, values: object) -> dict[str, Any]:
        """Return the data of a page for the scene with ``values``, a mapping from keys of controls.

        Raises
        ------
        SceneFileError
            The scene with these values cannot be used; the message says why.
        ValueError
            A key that no control has, or a value that is neither a number, a word nor a list of numbers.
        """
        shown, stage = self._ran(json.dumps(values, sort_keys=True))
        return {**page_data(shown, stage), "grips": grips(shown.run)}

    def pulled(self, values: object, pull: object) -> dict[str, Any]:
        """Return the data of a page for the scene with ``values`` on which somebody pulls, see `grip_of`.

        Raises
        ------
        SceneFileError, ValueError
            As `answer`; or nobody can pull so.
        TimeoutError
            See `pulled`.
        """
        shown, stage = self._ran(json.dumps(values, sort_keys=True))
        return pulled(shown, stage, grip_of(pull, shown.run, shown.length_unit))

    def _run(self, values: str) -> _Ran:
        scene_file = self.scene(json.loads(values))
        shown = playback(run(scene_file.scene), scene_file.length_unit, SHOTS_PER_MOTION)
        stage = Stage(shown)
        for phase in stage.phases:
            stage.gaps_world(phase.last)  # from there a pull goes on
        return _Ran(shown, stage)

    def scene(self, values: object) -> SceneFile:
        """Return the scene with ``values``.

        Raises
        ------
        SceneFileError, ValueError
            As `answer`.
        """
        return self._text.scene_file(self._settings(values))

    def saved(self, values: object) -> str:
        """Return the text of the scene file with ``values``.

        Raises
        ------
        SceneFileError, ValueError
            As `answer`.
        """
        return edited_text(self._text, self._settings(values))

    def problems(self, error: CageposeError | ValueError | TimeoutError) -> list[str]:
        """Return what is wrong, in words for people who look at sliders and not at the file."""
        if isinstance(error, SceneFileError):
            return [str(Problem(problem.path, problem.message)) for problem in error.problems]
        return [str(error)]

    def _settings(self, values: object) -> tuple[str, ...]:
        if not isinstance(values, dict):
            raise ValueError("the values are no mapping")
        keys = {START, *(control.key for control in self.controls)}
        settings = []
        for key, value in values.items():
            if key not in keys:
                raise ValueError(f"{key} cannot be changed here")
            if not _is_plain(value):
                raise ValueError(f"{key} is no number, no word and no list of numbers")
            if key == START:
                continue
            given = {"coefficient": value, **self._friction_of} if key == "friction" else value
            settings.append(setting(key, given))
        moves = any(key == START or key.startswith("cage.pose") for key in values)
        start = self._start(values) if moves else None
        return tuple(settings) if start is None else (*settings, setting("object.pose", start))

    def _start(self, values: dict[str, Any]) -> dict[str, list[float]] | None:
        """Return the start pose that is to the changed cage as the file's start is to the file's cage: moved alone, the
        cage would go into the object. Where it was dragged, it is as far from there. None: the cage cannot be there, as
        will be told.
        """
        data = copy.deepcopy(self._text.yaml.data)
        for key, value in values.items():
            if key.startswith("cage.pose"):
                set_value(data, parse_key_path(key), value)
        pose: dict[str, Any] = value_at(evaluated(data)[0], ("cage", "pose")) or {}
        place, angles = (pose.get(key) or [0.0, 0.0, 0.0] for key in ("position", "euler_zyx_deg"))
        dragged = values.get(START, [0.0, 0.0, 0.0])
        if any(np.shape(numbers) != (3,) or not np.isfinite(numbers).all() for numbers in (place, angles, dragged)):
            return None
        unit = self._scene_file.length_unit
        changed = Pose(to_metres(place, unit), euler_zyx=[math.radians(angle) for angle in angles])
        scene = self._scene_file.scene
        start = changed @ scene.cage.pose_world_cage.inverse() @ scene.object.pose_world_object
        return {
            "position": np.round(from_metres(start.position_m, unit) + dragged, LENGTH_DECIMALS).tolist(),
            "euler_zyx_deg": np.round(np.degrees(start.euler_zyx), ANGLE_DECIMALS).tolist(),
        }


def _is_plain(value: object) -> bool:
    if isinstance(value, list):
        return len(value) < 10 and all(_is_number(item) for item in value)
    return _is_number(value) or (isinstance(value, str) and value.isalnum())


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)

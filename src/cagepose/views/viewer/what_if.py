"""The text of a scene that a viewer changes and runs again, and again. Between two questions it keeps its last runs,
from which pulls go on, and nothing else: what it answers hangs on the question alone.
"""

from __future__ import annotations

import copy
import json
import math
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from cagepose.errors import SceneError
from cagepose.files.key_path import parse_key_path, resolved, set_value, value_at
from cagepose.files.parameters import evaluated
from cagepose.files.scene_edit import ANGLE_DECIMALS, changed_text, setting, with_cage_angles
from cagepose.files.scene_file import SceneFile, SceneText
from cagepose.files.units import from_metres, to_metres
from cagepose.model.checks import is_number
from cagepose.model.pose import Pose
from cagepose.runs.solve import run
from cagepose.views.viewer.controls import Control, controls
from cagepose.views.viewer.hand import grip_of, grips, pulled
from cagepose.views.viewer.page_data import page_data
from cagepose.views.viewer.playback import Playback, playback
from cagepose.views.viewer.questions import answered
from cagepose.views.viewer.stage import Stage

START = "start"
"""What a page calls the way, (3,) in the scene's unit, by which somebody dragged the start."""
CAGE_POSE, OBJECT_POSE = "cage.pose", "object.pose"
LENGTH_DECIMALS = 12
"""Lengths of a start pose are written with so many decimals in the scene's unit."""
SHOTS_PER_MOTION = 4
"""Fewer than in an exported page, whose maker need not wait for them; the page fills in what is between."""
RUNS_KEPT = 8


class _Ran(NamedTuple):
    shown: Playback
    stage: Stage
    text: str


class WhatIf:
    """Runs one scene with values that somebody asks for. The start pose goes with the cage.

    Attributes
    ----------
    scene_text
        As it was given.
    controls
        What may be asked for, besides all numbers of the text by their keys.
    """

    def __init__(self, scene_text: SceneText) -> None:
        """A cage's quaternion becomes angles.

        Raises
        ------
        SceneFileError
            The scene cannot be used, see `load_scene`.
        """
        self.scene_text = scene_text
        self._text = with_cage_angles(scene_text)
        of = value_at(self._text.yaml.data, ("friction", "of"))
        self._friction_of = {"of": of} if of else {}
        self._scene_file = self._text.scene_file()
        self._evaluated = evaluated(self._text.yaml.data)[0]
        self.controls: list[Control] = controls(self._text)
        self._ran = lru_cache(RUNS_KEPT)(self._run)

    def answer(self, values: object) -> dict[str, Any]:
        """Return the data of a page for the scene with ``values``, a mapping from keys, and its text with them.

        Raises
        ------
        SceneFileError
            The scene with these values cannot be used; the message says why.
        ValueError
            A key that no control and no number of the text has, or a value that is neither a number, a word nor a list
            of numbers.
        """
        shown, stage, text = self._ran(json.dumps(values, sort_keys=True))
        return {**page_data(shown, stage), "grips": grips(shown.run), "text": text}

    def pulled(self, values: object, pull: object) -> dict[str, Any]:
        """Return the data of a page for the scene with ``values`` on which somebody pulls, see `grip_of`.

        Raises
        ------
        SceneFileError, ValueError
            As `answer`; or nobody can pull so.
        TimeoutError
            See `pulled`.
        """
        shown, stage, _ = self._ran(json.dumps(values, sort_keys=True))
        return pulled(shown, stage, grip_of(pull, shown.run, shown.length_unit))

    def told(self, values: object, question: object, phase: object) -> dict[str, Any]:
        """Return the answer to a question about a phase of the scene with ``values``, see `answered`.

        Raises
        ------
        SceneFileError, ValueError
            As `answer`; or that cannot be asked.
        """
        shown, _, _ = self._ran(json.dumps(values, sort_keys=True))
        return answered(shown.run, question, phase, shown.length_unit)

    def _run(self, values: str) -> _Ran:
        changes = self._changes(json.loads(values))
        scene_file = self._scene_file_with(changes)
        shown = playback(run(scene_file.scene), scene_file.length_unit, SHOTS_PER_MOTION)
        stage = Stage(shown)
        for phase in stage.phases:
            stage.gaps_world(phase.last)  # from there a pull goes on
        return _Ran(shown, stage, self._text_with(changes))

    def scene(self, values: object) -> SceneFile:
        """Return the scene with ``values``.

        Raises
        ------
        SceneFileError, ValueError
            As `answer`.
        """
        return self._scene_file_with(self._changes(values))

    def _scene_file_with(self, changes: dict[str, object]) -> SceneFile:
        try:
            return self._text.scene_with({parse_key_path(key): value for key, value in changes.items()})
        except (SceneError, ValueError):
            return self._text.scene_file([setting(key, value) for key, value in changes.items()])  # says what and where

    def _text_with(self, changes: dict[str, object]) -> str:
        if not changes:
            return self.scene_text.text
        return changed_text(self._text, {parse_key_path(key): value for key, value in changes.items()})

    def _changes(self, values: object) -> dict[str, object]:
        """Return what changes in the file, by its key."""
        if not isinstance(values, dict):
            raise ValueError("the values are no mapping")
        keys = {START, *(control.key for control in self.controls)}
        changes = dict[str, object]()
        for key, value in values.items():
            if key not in keys and not (is_number(value) and is_number(self._at(key))):
                raise ValueError(f"{key} cannot be changed here")
            if not _is_plain(value):
                raise ValueError(f"{key} is no number, no word and no list of numbers")
            if key == START:
                continue
            changes |= self._differing(key, {"coefficient": value, **self._friction_of} if key == "friction" else value)
        moves = any(key == START or key.startswith(CAGE_POSE) for key in values)
        start = self._start(values) if moves else None
        return changes if start is None else {**changes, OBJECT_POSE: start}

    def _differing(self, key: str, value: object) -> dict[str, object]:
        """Return what makes a value of it, by its key; of a list that is there, what differs: an expression of another
        component stays.
        """
        there = value_at(self._evaluated, resolved(self._evaluated, parse_key_path(key)))
        if not (isinstance(value, list) and isinstance(there, list) and len(value) == len(there)):
            return {key: value}
        pairs = enumerate(zip(value, there, strict=True))
        return {f"{key}[{index}]": new for index, (new, old) in pairs if new != old}

    def _at(self, key: object) -> object:
        """Return what stands at a key of the text; None: nothing does."""
        try:
            return value_at(self._text.yaml.data, resolved(self._text.yaml.data, parse_key_path(str(key))))
        except ValueError:
            return None

    def _start(self, values: dict[str, Any]) -> dict[str, list[float]] | None:
        """Return the start pose that is to the changed cage as the file's start is to the file's cage: moved alone, the
        cage would go into the object. Where it was dragged, it is as far from there. None: the cage cannot be there, as
        will be told.
        """
        data = copy.deepcopy(self._text.yaml.data)
        for key, value in values.items():
            if key.startswith((CAGE_POSE, OBJECT_POSE)):
                set_value(data, parse_key_path(key), value)
        poses = [self._pose(value_at(evaluated(data)[0], (body, "pose")) or {}) for body in ("cage", "object")]
        dragged, unit = values.get(START, [0.0, 0.0, 0.0]), self._scene_file.length_unit
        if poses[0] is None or poses[1] is None or not _is_vector(dragged, 3):
            return None
        start = poses[0] @ self._scene_file.scene.cage.pose_world_cage.inverse() @ poses[1]
        angles = np.round(np.degrees(start.euler_zyx), ANGLE_DECIMALS)
        has_angles = angles.any() or value_at(data, ("object", "pose", "euler_zyx_deg")) is not None
        return {
            "position": np.round(from_metres(start.position_m, unit) + dragged, LENGTH_DECIMALS).tolist(),
            **({"euler_zyx_deg": angles.tolist()} if has_angles else {}),
        }

    def _pose(self, pose: dict[str, Any]) -> Pose | None:
        """Return the pose that a mapping of a scene file stands for; None: it is none."""
        place, angles = (pose.get(key) or [0.0, 0.0, 0.0] for key in ("position", "euler_zyx_deg"))
        turn = pose.get("quat_wxyz") or [1.0, 0.0, 0.0, 0.0]
        if not (_is_vector(place, 3) and _is_vector(angles, 3) and _is_vector(turn, 4) and np.any(turn)):
            return None
        turned = Pose(quaternion_wxyz=turn) @ Pose(euler_zyx=[math.radians(angle) for angle in angles])
        return Pose(to_metres(place, self._scene_file.length_unit)) @ turned  # one of both turns at most is given


def _is_vector(numbers: Any, length: int) -> bool:
    return np.shape(numbers) == (length,) and bool(np.isfinite(numbers).all())


def _is_plain(value: object) -> bool:
    if isinstance(value, list):
        return len(value) < 10 and all(is_number(item) for item in value)
    return is_number(value) or (isinstance(value, str) and value.isalnum())

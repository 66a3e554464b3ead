"""What a viewer may change of a scene: sliders and choices, each for a value of the scene file."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from cagepose.files.key_path import parse_key_path, resolved, value_at
from cagepose.files.parameters import evaluated
from cagepose.files.scene_file import SceneFile, SceneText
from cagepose.files.units import from_metres
from cagepose.model.methods import METHODS
from cagepose.runs.driven_cage import cage_at_start
from cagepose.runs.methods import chosen_method
from cagepose.views.viewer.surface import nearest_on_object

PLAYS_OF_SLIDER = 2.0
"""The cage can be moved by this many times the play: the median gap at the start."""
LEAST_PLAY = 1e-3
"""In sizes of the scene: what counts as play where most points touch at the start."""
TURNS_PER_PLAY = 4.0
"""The cage can be turned so far that its ends, half a size from its middle, move twice as far as it can be moved."""
MOST_TURN_DEG = 10.0
REACH_OF_FORCE = 0.5
"""In sizes of the scene: where on the object a force can act."""
AXES = ("x", "y", "z")
LEAST_FACTOR, MOST_FACTOR = 0.1, 3.0
"""Times what is given: the ends of a slider of a moment, a stiffness or a preload."""
MOST_FRICTION = 1.0
STEPS_OF_SLIDER = 400
"""A slider has so many steps from end to end."""


@dataclass(frozen=True)
class Control:
    """One slider, or a choice.

    Attributes
    ----------
    group, label, unit
        Words.
    key
        Where the value stands in the scene file.
    index
        Which component of a vector this is; None: the value is a single one.
    value
        As the file has it, or what it stands for where the file leaves it out: a number, or a word for a choice.
    low, high, step
        Of a slider, in the file's unit.
    choices
        Words to choose from; empty for a slider.
    """

    group: str
    label: str
    unit: str
    key: str
    index: int | None
    value: float | str
    low: float = 0.0
    high: float = 0.0
    step: float = 0.0
    choices: tuple[str, ...] = ()

    def document(self) -> dict[str, Any]:
        """Return it as plain data."""
        return asdict(self)


def controls(scene_text: SceneText) -> list[Control]:
    """Return the controls of a scene: what it names as adjustable, its cage, its loads, friction and method.

    Raises
    ------
    SceneFileError
        The scene cannot be used, see `load_scene`.
    """
    return _Maker(evaluated(scene_text.yaml.data)[0], scene_text.scene_file()).controls()


class _Maker:
    def __init__(self, data: object, scene_file: SceneFile) -> None:
        self.data = data
        self.scene = scene_file.scene
        self.unit = scene_file.length_unit
        self.size = float(from_metres(self.scene.size_m, self.unit))
        held = self.scene.object
        nearest = nearest_on_object(held, held.pose_world_object, cage_at_start(self.scene.cage))
        gaps = np.linalg.norm(nearest.places_world - nearest.feet_world, axis=1)
        play_m = float(np.median(gaps)) if len(gaps) else 0.0
        self.play = float(from_metres(max(play_m, LEAST_PLAY * self.scene.size_m), self.unit))

    def controls(self) -> list[Control]:
        return [*self._adjustables(), *self._cage(), *self._loads(), *self._options()]

    def _adjustables(self) -> list[Control]:
        made = []
        for entry in self.scene.adjustable:
            path = resolved(self.data, parse_key_path(entry.key))
            value = float(value_at(self.data, path))
            made.append(self._slider("adjustable", entry.name, "", entry.key, None, value, entry.low, entry.high))
        return made

    def _cage(self) -> list[Control]:
        pose = self.scene.cage.pose_world_cage
        angles = value_at(self.data, ("cage", "pose", "euler_zyx_deg"))
        angles = angles or [math.degrees(angle) for angle in pose.euler_zyx]
        place = value_at(self.data, ("cage", "pose", "position")) or [0.0, 0.0, 0.0]
        most = min(_rounded_up(math.degrees(TURNS_PER_PLAY * PLAYS_OF_SLIDER * self.play / self.size)), MOST_TURN_DEG)
        reach = _rounded_up(PLAYS_OF_SLIDER * self.play)
        return [
            *self._vector("cage", ("yaw", "pitch", "roll"), "deg", "cage.pose.euler_zyx_deg", angles, most),
            *self._vector("cage", ("x", "y", "z"), self.unit, "cage.pose.position", place, reach),
        ]

    def _loads(self) -> list[Control]:
        made = []
        for index, load in enumerate(self.scene.loads):
            here = f"loads[{index}]"
            given = value_at(self.data, ("loads", index))
            if load.is_weight_alone:
                made += self._directions(load.name, "gravity", f"{here}.gravity", given["gravity"])
            elif load.force is not None:
                made += self._force(load.name, "", f"{here}.force", given["force"])
            for number, force in enumerate(given.get("forces") or []):
                made += self._force(load.name, f"force {number + 1} ", f"{here}.forces[{number}]", force)
            for number, moment in enumerate(given.get("moments") or []):
                key, value = f"{here}.moments[{number}].magnitude", float(moment["magnitude"])
                name, unit = f"moment {number + 1}", f"N {self.unit}"
                made.append(
                    self._slider(load.name, name, unit, key, None, value, LEAST_FACTOR * value, MOST_FACTOR * value)
                )
            for number, spring in enumerate(given.get("springs") or []):
                made += self._spring(load.name, f"spring {number + 1}", f"{here}.springs[{number}]", spring)
        return made

    def _force(self, group: str, name: str, key: str, given: dict[str, Any]) -> list[Control]:
        labels = tuple(f"{name}acts at {axis}" for axis in AXES)
        at = "at" if given.get("at") is not None else "at_world"
        return [
            *self._directions(group, f"{name}direction", f"{key}.direction", given["direction"]),
            *self._vector(group, labels, self.unit, f"{key}.{at}", given[at], REACH_OF_FORCE * self.size),
        ]

    def _directions(self, group: str, name: str, key: str, given: list[float]) -> list[Control]:
        labels = tuple(f"{name} {axis}" for axis in AXES)
        return self._vector(group, labels, "", key, given, max(abs(value) for value in given), about_zero=True)

    def _spring(self, group: str, name: str, key: str, given: dict[str, Any]) -> list[Control]:
        """Its stiffness; of one without, its preload."""
        stiffness, preload = float(given["stiffness"]), float(given.get("preload") or 0.0)
        if stiffness > 0.0:
            unit, most = f"N/{self.unit}", MOST_FACTOR * stiffness
            return [self._slider(group, f"{name} stiffness", unit, f"{key}.stiffness", None, stiffness, 0.0, most)]
        ends = sorted((LEAST_FACTOR * preload, MOST_FACTOR * preload))
        return [self._slider(group, f"{name} preload", "N", f"{key}.preload", None, preload, *ends)]

    def _options(self) -> list[Control]:
        chosen, friction = chosen_method(self.scene), self.scene.friction_coefficient
        if friction is None:
            friction = round(chosen.friction(self.scene), 6)
        most = max(MOST_FRICTION, 2.0 * friction)
        return [
            self._slider("contacts", "friction", "", "friction", None, friction, 0.0, most),
            Control("contacts", "method", "", "method", None, chosen.name, choices=METHODS),
        ]

    def _vector(
        self,
        group: str,
        labels: tuple[str, ...],
        unit: str,
        key: str,
        values: list[float],
        reach: float,
        *,
        about_zero: bool = False,
    ) -> list[Control]:
        middles = [0.0] * len(values) if about_zero else values
        return [
            self._slider(group, label, unit, key, index, value, middle - reach, middle + reach)
            for index, (label, value, middle) in enumerate(zip(labels, values, middles, strict=True))
        ]

    def _slider(
        self, group: str, label: str, unit: str, key: str, index: int | None, value: float, low: float, high: float
    ) -> Control:
        step = 10.0 ** math.floor(math.log10((high - low) / STEPS_OF_SLIDER))  # a round number of decimals
        return Control(group, label, unit, key, index, float(value), low, high, step)


def _rounded_up(value: float) -> float:
    """Return the next number above that is 1, 2 or 5 times a power of ten."""
    power = 10.0 ** math.floor(math.log10(value))
    return next((step * power for step in (1.0, 2.0, 5.0) if step * power >= value), 10.0 * power)

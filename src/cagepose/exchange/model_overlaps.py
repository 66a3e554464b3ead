"""What of a model's cage the object starts in: `freed`. Sources have such overlaps; no scene may."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from cagepose.errors import FileProblem, Problem, SceneError, SceneFileError
from cagepose.files.scene_data import scene_of
from cagepose.model.scene import StartsInside, millimetres

Data = dict[str, Any]

SHALLOW_OF_REACH = 0.02
"""Fraction of how far the object reaches from its origin: out of what it is in by less, it is lifted."""
MOST_LEFT_OUT = 20
"""A scene from whose cage more would have to be taken away is none. Each takes a check of the whole scene."""
REMEDY = "choose another pose with --keyframe or --qpos"
LIFTS = (1.001, 1.5, 2.0, 4.0)
"""By how many depths."""


class Freed(NamedTuple):
    """The data of a scene whose object starts beside its cage.

    Attributes
    ----------
    data
        Those of the scene.
    left_out
        The names of what was taken away.
    notes
        What is to be said of it.
    problem
        Why the scene is none all the same; None: it is one.
    """

    data: Data
    left_out: list[str]
    notes: list[str]
    problem: str | None


def freed(data: Data, reach_m: float, source: str) -> Freed:
    """Return a scene with the object lifted out of what it is hardly in, and without the elements that it is deep in.

    Parameters
    ----------
    data
        Of a scene file in metres, whose cage has names for all elements.
    reach_m
        How far the object reaches from its origin.

    Raises
    ------
    SceneFileError
        It starts in all of the cage, or in more than `MOST_LEFT_OUT` of its elements.
    """
    left_out, notes = list[str](), list[str]()
    while isinstance(inside := _problem(data), StartsInside):
        name = _name(data, inside)
        if len(left_out) >= MOST_LEFT_OUT:
            message = (
                f"has the object inside more than {MOST_LEFT_OUT} shapes of its cage, {name!r} among them; {REMEDY}"
            )
            raise SceneFileError([FileProblem((), message, source)])
        if inside.depth_m <= SHALLOW_OF_REACH * reach_m and (lifted := _lifted(data, inside.depth_m)):
            by_m, data = lifted
            notes.append(f"the object starts {millimetres(by_m)} higher, as it is in {name!r} there")
            continue
        notes.append(f"left out: {name!r}, as the object starts {millimetres(inside.depth_m)} inside it; {REMEDY}")
        left_out.append(name)
        data = _without(data, inside)
        if not any(data.get("cage", {}).get(key) for key in ("points", "shapes", "bodies")):
            message = f"has the object inside all of its cage ({name!r}); {REMEDY}"
            raise SceneFileError([FileProblem((), message, source)])
    return Freed(data, left_out, notes, None if inside is None else inside.message)


def _problem(data: Data) -> Problem | None:
    """Return what is wrong with a scene, that it starts inside first; None: nothing."""
    try:
        scene_of(data)
    except SceneError as error:
        return max(error.problems, key=lambda problem: isinstance(problem, StartsInside))
    return None


def _lifted(data: Data, depth_m: float) -> tuple[float, Data] | None:
    """Return by how much the object has to start higher to be free, and the scene that is then; None: it is not."""
    gravity = next((load["gravity"] for load in data["loads"] if "gravity" in load), None)
    if gravity is None:
        return None
    up = -np.array(gravity, dtype=np.float64) / np.linalg.norm(gravity)
    pose = data["object"]["pose"]
    for times in LIFTS:
        place = (np.array(pose["position"]) + times * depth_m * up).tolist()
        higher = {**data, "object": {**data["object"], "pose": {**pose, "position": place}}}
        if _problem(higher) is None:
            return times * depth_m, higher
    return None


def _name(data: Data, inside: StartsInside) -> str:
    found: Any = data
    for key in inside.path:
        found = found[key]
    return str(found["name"] if isinstance(found, dict) else inside.path[-1])


def _without(data: Data, inside: StartsInside) -> Data:
    """Return a scene without the element of a path."""

    def taken(of: Any, path: tuple[Any, ...]) -> Any:
        first, rest = path[0], path[1:]
        below = taken(of[first], rest) if rest else None
        if isinstance(of, list):
            return [one if index != first else below for index, one in enumerate(of) if index != first or below]
        return {key: value if key != first else below for key, value in of.items() if key != first or _holds(below)}

    found: Data = taken(data, inside.path)
    return found


def _holds(below: Any) -> bool:
    """Whether a list, a body or a cage is more than a pose."""
    return bool(below) and (not isinstance(below, dict) or any(key != "pose" for key in below))

"""What else is wrong in a scene file beside what was found first: `problems_beside`.

A scene is checked in stages: its form, each of its parts, then the parts together. So that one mistake hides no other,
what is wrong is left out with the least around it, and what is left is checked again.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path as FilePath
from typing import Any

from pydantic import ValidationError

from cagepose.errors import Problem, SceneError
from cagepose.files.build import build_scene
from cagepose.files.key_path import Path, value_at
from cagepose.files.messages import file_path
from cagepose.files.points_file import PointsTable
from cagepose.files.schema import SceneModel

STAND_INS: dict[str, Any] = {
    "name": "scene",
    "object": {},
    "cage": {},
    "loads": [{"name": "weight", "gravity": [0.0, 0.0, -1.0]}],
}
"""What a scene must have, in the place of what is wrong with it as a whole."""
APART = ("name", "loads", "friction", "method", "metric", "planar", "adjustable", "left_out")
"""Where one of these is wrong, what object and cage are together is known all the same."""
PARTS_OF_LOADS = ("forces", "moments", "springs", "drive", "press")
"""What there may be several of in a load, each by itself."""
MOST_LEFT_OUT = 20
"""So many mistakes are looked beside; who made more has enough to mend."""


def problems_beside(
    data: object, told: Iterable[Problem], table: PointsTable | None, folder: FilePath
) -> list[Problem]:
    """Return what is wrong with plain scene data beside the problems that were told, which it does not follow from."""
    seen, new = set(told), list(told)
    found: list[Problem] = []
    if not isinstance(data, Mapping):
        return found
    sound = _SoundParts(data)
    while new and len(seen) <= MOST_LEFT_OUT:
        for path in sorted({problem.path for problem in new}, key=len):
            sound.leave_out(path)
        new = [problem for problem in sound.problems(table, folder) if problem not in seen]
        found += [problem for problem in new if not sound.hides(problem.path)]
        seen |= set(new)
    return found


class _SoundParts:
    """Plain scene data without some of its parts."""

    def __init__(self, data: Mapping[str, Any]) -> None:
        self._data = data
        self._left_out: set[Path] = set()

    def leave_out(self, path: Path) -> None:
        """Leave out the part in which a path leads, or the least around it without which the rest has the form of a
        scene.
        """
        part = path[: _depth_of_part(path)]
        if any(part[: len(gone)] == gone for gone in self._left_out):
            return
        for depth in range(len(part), 0, -1):
            around = path[:depth]
            self._left_out.add(around)
            if not any(place == around[: len(place)] for place in self._wrong()):
                return
            self._left_out.remove(around)

    def problems(self, table: PointsTable | None, folder: FilePath) -> list[Problem]:
        """Return what is wrong with what is left, also what follows from what is not."""
        data, kept = self._rest()
        try:
            model = SceneModel.model_validate(data)
        except ValidationError:
            return []
        is_whole = all(path[0] in APART for path in self._left_out)
        try:
            build_scene(model, table, folder, is_whole=is_whole)
        except SceneError as error:
            return [Problem(_original(problem.path, kept), problem.message) for problem in error.problems]
        return []

    def _wrong(self) -> list[Path]:
        """Return where the form of what is left is wrong."""
        data, kept = self._rest()
        try:
            SceneModel.model_validate(data)
        except ValidationError as error:
            return [_original(file_path(details["loc"]), kept) for details in error.errors(include_url=False)]
        return []

    def hides(self, path: Path) -> bool:
        """Whether a place is within what was left out, around it, or names a part that was; or is of a load that lacks
        a part, and not of another of its parts.
        """
        if any(path[: len(gone)] == gone or gone[: len(path)] == path for gone in self._left_out):
            return True
        of_load = path[:2] if path[:1] == ("loads",) and not _is_within_part_of_load(path) else None
        if of_load is not None and any(gone[:2] == of_load for gone in self._left_out):
            return True
        names = [value_at(self._data, (*gone, "name")) for gone in self._left_out]
        names += [gone[-1] for gone in self._left_out]
        return any(isinstance(name, str) and name in names for name in (path[-1], value_at(self._data, path)))

    def _rest(self) -> tuple[dict[str, Any], dict[Path, list[int]]]:
        """Return what is left, and which items are of each list that is shorter."""
        kept: dict[Path, list[int]] = {}
        rest = _without(self._data, (), self._left_out, kept)
        return {**{key: value for key, value in STAND_INS.items() if (key,) in self._left_out}, **rest}, kept


def _depth_of_part(path: Path) -> int:
    """Return how deep the part stands that a path leads into: a box, a shape, a point, what acts in a load."""
    for depth, key in enumerate(path[:-1], start=1):
        if key in ("boxes", "shapes", "points"):
            return depth + 1
    return 4 if _is_within_part_of_load(path) else min(len(path), 3)


def _is_within_part_of_load(path: Path) -> bool:
    return path[:1] == ("loads",) and len(path) > 3 and path[2] in PARTS_OF_LOADS


def _without(node: Any, path: Path, left_out: set[Path], kept: dict[Path, list[int]]) -> Any:
    if not any(gone[: len(path)] == path for gone in left_out):
        return node
    if isinstance(node, Mapping):
        return {
            key: _without(value, (*path, key), left_out, kept)
            for key, value in node.items()
            if (*path, key) not in left_out
        }
    if isinstance(node, list):
        kept[path] = [index for index in range(len(node)) if (*path, index) not in left_out]
        return [_without(node[index], (*path, index), left_out, kept) for index in kept[path]]
    return node


def _original(path: Path, kept: Mapping[Path, Sequence[int]]) -> Path:
    """Return where a place of what is left stands in the whole."""
    found: Path = ()
    for key in path:
        of_list = kept.get(found)
        found = (*found, of_list[key] if of_list is not None and isinstance(key, int) and key < len(of_list) else key)
    return found

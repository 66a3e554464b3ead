"""Scene files: text in, a `Scene` or every problem found out."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

from pydantic import ValidationError

from cagepose.errors import FileProblem, Key, Problem, SceneError, SceneFileError
from cagepose.files.build import build_scene
from cagepose.files.file_kind import expect_kind
from cagepose.files.key_path import Path as KeyPath
from cagepose.files.key_path import parse_key_path, resolved, set_value, value_at
from cagepose.files.messages import Finding, schema_findings, shown
from cagepose.files.parameters import Expressions, evaluated, expression_at
from cagepose.files.points_file import POINTS_KEY, PointsTable, read_points
from cagepose.files.read import read_text, starts_as_run
from cagepose.files.scene_parts import OtherScene, SceneParts, is_parameter
from cagepose.files.schema import SceneModel
from cagepose.files.schema_cage import PointsFileModel
from cagepose.files.sound_parts import problems_beside
from cagepose.files.units import LengthUnit
from cagepose.files.yaml_source import MAX_DEPTH, YamlSource, parse_yaml
from cagepose.model.checks import is_number
from cagepose.model.scene import Scene


@dataclass(frozen=True)
class SceneFile:
    """A scene, the unit that its file gives lengths in, and what of its meshes is not in it as in their files."""

    scene: Scene
    length_unit: LengthUnit
    notes: tuple[str, ...] = ()


def load_scene(path: str | os.PathLike[str], set_values: Sequence[str] = ()) -> Scene:
    """Read a scene file; ``set_values`` are changes such as ``"object.boxes[0].size[2]=12"``.

    Raises
    ------
    SceneFileError
        The file cannot be used; lists every problem with its line and column.
    """
    return read_scene_file(path, set_values).scene


def read_scene_file(path: str | os.PathLike[str], set_values: Sequence[str] = ()) -> SceneFile:
    """As `load_scene`, and keep the file's length unit.

    Raises
    ------
    SceneFileError
        As `load_scene`.
    """
    return read_scene_text(path).scene_file(set_values)


def read_scene_text(path: str | os.PathLike[str]) -> SceneText:
    """Read a scene file once, to make scenes from it with many different values.

    Raises
    ------
    SceneFileError
        The file cannot be read, is not YAML, or is a saved run.
    """
    source = os.fspath(path)
    return scene_text_of(read_text(Path(source), source), source)


def scene_text_of(text: str, source: str) -> SceneText:
    """As `read_scene_text`, of text that has been read; ``source`` stands for the file in messages, and its folder is
    where points files are.

    Raises
    ------
    SceneFileError
        The text is not YAML, or is a saved run, a study or a design.
    """
    if starts_as_run(text):
        message = "is a saved run, not a scene; name its scene file (saved runs are for `cagepose plot` and `view`)"
        raise SceneFileError([FileProblem((), message, source)])
    yaml = parse_yaml(text, source)
    expect_kind(yaml, "scene")
    return SceneText(text, yaml, Path(source).parent)


def parse_scene(text: str, name: str = "scene.yaml", set_values: Sequence[str] = ()) -> Scene:
    """As `load_scene`, from text; ``name`` stands for the file in messages, and its folder is where points files are.

    Raises
    ------
    SceneFileError
        As `load_scene`.
    """
    return SceneText(text, parse_yaml(text, name), Path(name).parent).scene_file(set_values).scene


class _Begun(NamedTuple):
    """A scene that others are built of, its parts, and the paths at which it has other values than its file."""

    file: SceneFile
    parts: SceneParts
    paths: frozenset[KeyPath]


@dataclass(frozen=True)
class SceneText:
    """The text of a scene file, read but not checked.

    Attributes
    ----------
    text, yaml
        As it stands in the file, and as plain data.
    folder
        Where points files are.
    """

    text: str
    yaml: YamlSource
    folder: Path

    def __repr__(self) -> str:
        return f"<SceneText {self.yaml.source!r}>"

    def scene_file(self, set_values: Sequence[str] = ()) -> SceneFile:
        """Return the scene with some values changed; see `load_scene`.

        Raises
        ------
        SceneFileError
            As `load_scene`.
        """
        yaml = self.yaml
        data = deepcopy(yaml.data) if set_values else yaml.data
        settings = _apply_settings(data, set_values)
        attempt = _Attempt(data, self.folder)
        if attempt.scene_file is not None and not yaml.problems:
            return attempt.scene_file
        unset = _Attempt(yaml.data, self.folder) if settings else attempt
        unclear = [problem.path for problem in yaml.problems]
        places = _Places(yaml, attempt, unset, settings)
        problems: list[FileProblem] = [*yaml.problems, *attempt.table_problems]
        for finding in attempt.findings:
            path = finding.problem.path
            if not any(path[: len(place)] == place for place in unclear):  # else it only echoes the tag or alias there
                problems.append(places.place(finding))
        problems.sort(key=_reading_order)
        raise SceneFileError(problems)

    def scene_with(self, values: Mapping[KeyPath, object]) -> SceneFile:
        """Return the scene with other values at some paths, for thousands of times: without places of what is wrong.

        Raises
        ------
        SceneError
            Such a scene cannot be used.
        """
        if (found := self._with_numbers(values)) is not None:
            return found
        data = deepcopy(self.yaml.data)
        changed = [set_value(data, path, value) for path, value in values.items()]
        # An expression that gives way to a number is none any more.
        known = self._expressions
        is_kept = not any(where[: len(path)] == path for where in known.by_path for path in changed)
        attempt = _Attempt(data, self.folder, known if is_kept else None)
        if attempt.scene_file is None:
            raise SceneError([*attempt.table_problems, *(finding.problem for finding in attempt.findings)])
        if is_kept:
            parts = SceneParts(attempt.scene_file.scene, attempt.data, attempt.scene_file.length_unit)
            self._begun[:] = [_Begun(attempt.scene_file, parts, frozenset(values))]
        return attempt.scene_file

    def _with_numbers(self, values: Mapping[KeyPath, object]) -> SceneFile | None:
        """Return the scene with other values, of the parts of one that was built before; None: build it as a whole."""
        held = tuple(self._begun)  # once: another window may put another one there
        if not held or not held[0].paths <= values.keys():
            return None
        begun, known = held[0], self._expressions
        numbers = {path: float(value) for path, value in values.items() if is_number(value)}
        if len(numbers) < len(values) or any(path in known.by_path for path in numbers):
            return None
        try:
            of_expressions = known.values(
                {str(path[1]): number for path, number in numbers.items() if is_parameter(path)}
            )
            return replace(begun.file, scene=begun.parts.scene_with(numbers | of_expressions))
        except (SceneError, OtherScene):
            return None

    @cached_property
    def _begun(self) -> list[_Begun]:
        """The scene that others are built of, and what it is made of; empty: there is none yet."""
        return []

    @cached_property
    def _expressions(self) -> Expressions:
        return Expressions(self.yaml.data)


def _reading_order(problem: FileProblem) -> tuple[int, int]:
    return problem.line or 0, problem.column or 0


@dataclass(frozen=True)
class _Setting:
    """One ``--set`` argument, applied."""

    source: str
    path: KeyPath


def _apply_settings(data: object, set_values: Sequence[str]) -> list[_Setting]:
    settings: list[_Setting] = []
    problems: list[FileProblem] = []
    for argument in set_values:
        source = f"--set {argument}"
        key, equals, text = argument.partition("=")
        try:
            if not equals:
                raise ValueError("has no =; write key.path=value, such as object.mass=0.5")
            path = parse_key_path(key.strip())
            if len(path) > MAX_DEPTH:
                raise ValueError(f"names a place {len(path)} levels deep; a scene has at most {MAX_DEPTH}")
            value = parse_yaml(text, source) if text.strip() else YamlSource(None, source)
            problems += [replace(problem, line=None, column=None) for problem in value.problems]
            settings.append(_Setting(source, set_value(data, path, value.data)))
        except SceneFileError as error:
            problems += [replace(problem, line=None, column=None) for problem in _file_problems(error)]
        except ValueError as error:
            problems.append(FileProblem((), str(error), source))
    if problems:
        raise SceneFileError(problems)
    return settings


class _Attempt:
    """Plain data turned into a scene as far as that goes.

    Attributes
    ----------
    scene_file
        None if anything is wrong.
    data
        With every expression as its number.
    findings
        Problems with paths into the data.
    table, table_problems
        The points file, where the scene names one, and its bad rows.
    """

    def __init__(self, data: object, folder: Path, parsed: Expressions | None = None) -> None:
        self.scene_file: SceneFile | None = None
        self.findings: list[Finding] = []
        self.table_problems: list[FileProblem] = []
        written = data
        data, of_expressions = evaluated(data, parsed)
        self.data = data
        self.findings += [Finding(problem, False) for problem in of_expressions]
        self.table = self._read_table(value_at(data, POINTS_KEY), folder)
        try:
            model = SceneModel.model_validate(data)
        except ValidationError as error:
            for finding in schema_findings(error, data):
                text = expression_at(written, finding.problem.path)
                if text is None or finding.about_key:
                    self.findings.append(finding)
                elif not isinstance(value_at(data, finding.problem.path), str):  # else it came to nothing
                    problem = Problem(finding.problem.path, f"{text!r} {finding.problem.message}")
                    self.findings.append(Finding(problem, False))
            self._look_beside([finding.problem for finding in self.findings], data, folder)
            return
        self.findings += [Finding(problem, False) for problem in _adjustable_problems(model, data)]
        if self.table is None and isinstance(model.cage.points, PointsFileModel):
            self._look_beside([Problem(POINTS_KEY, "")], data, folder)
            return
        try:
            scene, notes = build_scene(model, self.table, folder)
        except SceneError as error:
            self.findings += [Finding(problem, False) for problem in error.problems]
            self._look_beside(error.problems, data, folder)
            return
        if not self.findings:
            self.scene_file = SceneFile(scene, model.units.length if model.units else "mm", notes)

    def _look_beside(self, told: Sequence[Problem], data: object, folder: Path) -> None:
        self.findings += [Finding(problem, False) for problem in problems_beside(data, told, self.table, folder)]

    def _read_table(self, name: object, folder: Path) -> PointsTable | None:
        if not isinstance(name, str) or not name:
            return None
        path = folder / name
        try:
            return read_points(path, str(path))
        except SceneFileError as error:
            for problem in _file_problems(error):
                if problem.line is None:  # the file as a whole: its name in the scene is the place to look
                    self.findings.append(Finding(Problem(POINTS_KEY, f"{path} {problem.message}"), False))
                else:
                    self.table_problems.append(problem)
            return None


def _adjustable_problems(model: SceneModel, data: object) -> list[Problem]:
    problems = []
    for name, entry in (model.adjustable or {}).items():
        try:
            value = value_at(data, resolved(data, parse_key_path(entry.key)))
        except ValueError as error:
            message = str(error)
        else:
            if isinstance(value, (int, float)) and not isinstance(value, bool):
                continue
            found = "where nothing stands" if value is None else f"where {shown(value)} stands"
            message = f"points to {entry.key}, {found}; point to a number of this scene, or write one there"
        problems.append(Problem(("adjustable", name, "key"), message))
    return problems


@dataclass(frozen=True)
class _Places:
    """Tells where a problem comes from: a line of the scene file or of the points file, or a ``--set`` argument."""

    yaml: YamlSource
    attempt: _Attempt
    unset: _Attempt
    settings: list[_Setting]

    def place(self, finding: Finding) -> FileProblem:
        path, message = finding.problem.path, finding.problem.message
        place = self._in_data(path)
        if finding not in self._found_unset:
            source = self._setting(place)
            if source is not None:
                return FileProblem(path, message, source)
        table = self.attempt.table
        if table is not None and path[:2] == POINTS_KEY[:2] and len(path) > 2 and isinstance(place[2], int):
            return FileProblem(path, message, table.source, table.lines[place[2]], 1)
        mark = self.yaml.mark(place, of_key=finding.about_key)
        return FileProblem(path, message, self.yaml.source, *(mark or (None, None)))

    def _in_data(self, path: KeyPath) -> KeyPath:
        """Point names as indices, where the points stand in rows."""
        if path[:2] == ("cage", "bodies") and path[3:4] == ("points",) and len(path) > 4:
            rows = value_at(self.yaml.data, path[:4])
            own = {f"{path[2]}/C{index + 1}": index for index in range(len(rows) if isinstance(rows, list) else 0)}
            return (*path[:4], own.get(str(path[4]), path[4]), *path[5:])
        if path[:2] != POINTS_KEY[:2] or len(path) < 3 or path == POINTS_KEY or path[2] not in self._rows:
            return path
        return (*path[:2], self._rows[path[2]], *path[3:])

    @cached_property
    def _rows(self) -> dict[Key, int]:
        """The row of each point, by its name; of one name the last counts."""
        table, points = self.attempt.table, value_at(self.yaml.data, POINTS_KEY[:2])
        if table is not None and table.names is not None:
            names = table.names
        else:
            rows = points if table is None else table.points
            names = tuple(f"C{index + 1}" for index in range(len(rows) if isinstance(rows, list) else 0))
        return {name: row for row, name in enumerate(names)}

    @cached_property
    def _found_unset(self) -> frozenset[Finding]:
        """What is wrong without any ``--set``; a set, as thousands may be asked for."""
        return frozenset(self.unset.findings)

    def _setting(self, place: KeyPath) -> str | None:
        """The ``--set`` argument to blame for a problem that is not there without any; None: it is the file's."""
        for setting in reversed(self.settings):
            shared = min(len(setting.path), len(place))
            if shared and setting.path[:shared] == place[:shared]:
                return setting.source
        if self.unset.scene_file is not None:
            return " ".join(setting.source for setting in self.settings)
        return None


def _file_problems(error: SceneFileError) -> list[FileProblem]:
    return [problem for problem in error.problems if isinstance(problem, FileProblem)]

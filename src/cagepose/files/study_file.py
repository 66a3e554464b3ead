"""Study files: text in, a `StudyFile` or every problem found out."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np
from pydantic import ValidationError

from cagepose.errors import FileProblem, Problem, SceneError, SceneFileError, key_path
from cagepose.files.expression import Formula
from cagepose.files.file_kind import expect_kind
from cagepose.files.files_named import files_named
from cagepose.files.key_path import Path as KeyPath
from cagepose.files.key_path import parse_key_path, resolved, set_value, value_at
from cagepose.files.messages import Finding, schema_findings, shown
from cagepose.files.parameters import expression_at
from cagepose.files.points_file import POINTS_KEY
from cagepose.files.read import read_text
from cagepose.files.scene_edit import with_values
from cagepose.files.scene_file import SceneFile, SceneText, read_scene_text
from cagepose.files.schema_study import DistributionModel, RunsModel, SampleModel, StudyModel
from cagepose.files.units import unit_at
from cagepose.files.watched import measures_of
from cagepose.files.yaml_source import YamlSource, parse_yaml
from cagepose.model.wording import few

Model = TypeVar("Model", bound=RunsModel)

ALL = "*"
STUDY_NAME, SCENE_NAME = "study.yaml", "scene.yaml"
"""Names of the copies in a study's folder."""


@dataclass(frozen=True)
class VariedKey:
    """One number of the scene that varies.

    Attributes
    ----------
    key, path
        Where it stands, as people write it and as a path: what ``*`` stood for is filled in.
    distribution
        How it varies.
    nominal
        What stands in the scene, or the distribution's middle.
    """

    key: str
    path: KeyPath
    distribution: DistributionModel
    nominal: float

    def __repr__(self) -> str:
        return f"<VariedKey {self.key}: {self.distribution.kind}, nominal {self.nominal:.6g}>"


@dataclass(frozen=True)
class StudyFile:
    """A study that can be run.

    Attributes
    ----------
    text, model
        As it was written, and checked.
    scene_text, nominal
        The scene's file, and the scene with each varied number at its nominal value.
    varied
        In the order of the file.
    compute
        By the name of its column, in the order of the file.
    accept
        None: left out.
    """

    text: str
    model: StudyModel
    scene_text: SceneText
    nominal: SceneFile
    varied: tuple[VariedKey, ...]
    compute: dict[str, Formula]
    accept: Formula | None

    def __repr__(self) -> str:
        return f"<StudyFile of {self.nominal.scene.name!r}: {few(one.key for one in self.varied)} vary>"

    @property
    def units(self) -> dict[str, str]:
        """The unit of each varied number, by its key; empty where there is none or it is not known."""
        return {one.key: unit_at(one.path, self.nominal.length_unit) for one in self.varied}


def read_study_file(path: str | os.PathLike[str]) -> StudyFile:
    """Read a study file and the scene that it names.

    Raises
    ------
    SceneFileError
        Either cannot be used; lists every problem with its line and column.
    """
    source = os.fspath(path)
    return parse_study(read_text(Path(source), source), source)


def parse_study(text: str, source: str = "study.yaml") -> StudyFile:
    """As `read_study_file`, from text; ``source`` stands for the file in messages, and its folder is where scenes are.

    Raises
    ------
    SceneFileError
        As `read_study_file`.
    """
    yaml, model = checked_model(text, source, StudyModel)
    return study_of(yaml, model, text)


def checked_model(text: str, source: str, kind: type[Model]) -> tuple[YamlSource, Model]:
    """Return a file's YAML, and its model with all types and limits checked.

    Raises
    ------
    SceneFileError
        Lists every problem with its line and column.
    """
    yaml = parse_yaml(text, source)
    expect_kind(yaml, "study" if kind is StudyModel else "design")
    if yaml.problems:
        raise SceneFileError(yaml.problems)
    try:
        return yaml, kind.model_validate(yaml.data)
    except ValidationError as error:
        raise placed(yaml, schema_findings(error, yaml.data, kind)) from None


def study_of(yaml: YamlSource, model: StudyModel, text: str, changed: str | None = None) -> StudyFile:
    """Return the study that a model asks for; ``changed`` is the key of ``vary`` that stands under ``change`` in the
    file.

    Raises
    ------
    SceneFileError
        Lists every problem with its line and column.
    """
    scene_text = read_scene_text(Path(yaml.source).parent / model.scene)
    scene = scene_text.scene_file().scene  # its own problems first
    problems: list[Problem] = []
    places = {key: ("change" if key == changed else "vary", key) for key in model.vary}
    varied = _varied_keys(model, places, scene_text.yaml.data, problems)
    _check_sample(model.sample, {key: one for key, one in model.vary.items() if key != changed}, problems)
    _check_map(model, varied, problems)
    measures_of(scene, model.watch or {}, "m", problems)
    compute = {name: _formula(text, ("compute", name), problems) for name, text in (model.compute or {}).items()}
    accept = None if model.accept is None else _formula(model.accept, ("accept",), problems)
    if problems:
        raise placed(yaml, [Finding(problem, problem.path[0] in ("vary", "change")) for problem in problems])
    try:
        nominal = scene_text.scene_with({one.path: one.nominal for one in varied})
    except SceneError as error:
        raise placed(yaml, [_of_nominal(problem, varied, places) for problem in error.problems]) from None
    computed = {name: formula for name, formula in compute.items() if formula is not None}
    return StudyFile(text, model, scene_text, nominal, varied, computed, accept)


def placed(yaml: YamlSource, findings: list[Finding]) -> SceneFileError:
    """Return the error for findings, each with its line and column, in the order of the file."""
    problems = list[FileProblem]()
    for problem, about_key in findings:
        mark = yaml.mark(problem.path, of_key=about_key)
        problems.append(FileProblem(problem.path, problem.message, yaml.source, *(mark or (None, None))))
    problems.sort(key=lambda problem: (problem.line or 0, problem.column or 0))
    return SceneFileError(problems)


def _of_nominal(problem: Problem, varied: tuple[VariedKey, ...], places: Mapping[str, KeyPath]) -> Finding:
    """Place what is wrong with the nominal scene at the varied number that it is about, if there is one."""
    for one in varied:
        if problem.path[: len(one.path)] == one.path:
            at = places.get(one.key, ("vary", one.key))
            return Finding(Problem(at, f"at its nominal value {one.nominal!r}: {problem.message}"), True)
    return Finding(Problem(("vary",), f"with all numbers at their nominal values, {problem}"), True)


def _varied_keys(
    model: StudyModel, places: Mapping[str, KeyPath], data: object, problems: list[Problem]
) -> tuple[VariedKey, ...]:
    found: dict[KeyPath, VariedKey] = {}
    for key, distribution in model.vary.items():
        try:
            paths = _filled_in(data, parse_key_path(key))
            for path in paths:
                if path in found:
                    raise ValueError(f"stands for {key_path(path)}, which another key varies; keep one of the two")
                nominal = _nominal(data, path, distribution)
                found[path] = VariedKey(key_path(path), path, distribution, nominal)
        except ValueError as error:
            problems.append(Problem(places[key], str(error)))
    return tuple(found.values())


def _filled_in(data: object, path: KeyPath) -> list[KeyPath]:
    """Return the paths that one with ``*`` stands for."""
    if ALL not in path:
        return [resolved(data, path)]
    place = path.index(ALL)
    before = resolved(data, path[:place])
    here = value_at(data, before)
    if not isinstance(here, (dict, list)) or not here:
        raise ValueError(f"has a * at {key_path(before) or 'the scene'}, which holds no list; name what varies")
    keys = list(here) if isinstance(here, dict) else range(len(here))
    return [filled for key in keys for filled in _filled_in(data, (*before, key, *path[place + 1 :]))]


def _nominal(data: object, path: KeyPath, distribution: DistributionModel) -> float:
    if value_at(data, POINTS_KEY) is not None and path[:2] == ("cage", "points"):
        raise ValueError("is a point of a file; write the points that vary into the scene")
    given = value_at(data, path)
    if expression_at(data, path) is not None:
        raise ValueError(f"holds the expression {given!r}; vary the parameters that it is made of")
    if given is None:
        if path[0] == "parameters":
            known = ", ".join(value_at(data, ("parameters",)) or ()) or "none"
            raise ValueError(f"is no parameter of the scene; use one of: {known}, or write it into the scene")
        set_value(deepcopy(data), path, 0.0)  # says where there is no such place
        if distribution.middle is None:
            raise ValueError("is not in the scene, so the normal distribution needs its mean; give mean")
        return distribution.middle
    if isinstance(given, bool) or not isinstance(given, (int, float)):
        raise ValueError(f"is {shown(given)}; vary a number of the scene")
    return float(given)


def _check_sample(sample: SampleModel, vary: Mapping[str, DistributionModel], problems: list[Problem]) -> None:
    if sample.method != "grid":
        if sample.runs is None:
            problems.append(Problem(("sample",), "has no runs; add how many, for example runs: 10000"))
        return
    if sample.runs is not None:
        problems.append(Problem(("sample", "runs"), "stands beside a grid, which is run as a whole; leave it out"))
    for key, distribution in vary.items():
        if distribution.kind not in ("grid", "steps"):
            message = f"is {distribution.kind}, and the sample a grid; give grid or steps, or another sample.method"
            problems.append(Problem(("vary", key), message))


def _check_map(model: StudyModel, varied: tuple[VariedKey, ...], problems: list[Problem]) -> None:
    known = [one.key for one in varied if one.distribution.grid is None or len(one.distribution.grid) > 1]
    over = model.map.over if model.map else []
    for index, key in enumerate(over):
        if key in over[:index]:
            problems.append(Problem(("map", "over", index), "stands here before; name another"))
        elif key not in known:
            message = f"is {key!r}, which does not vary; use some of: {few(known, 10) or 'none'}"
            problems.append(Problem(("map", "over", index), message))


def _formula(text: str, place: KeyPath, problems: list[Problem]) -> Formula | None:
    """Return an expression of columns; None: it is none, and why is among the problems."""
    try:
        return Formula(text)
    except ValueError as error:
        problems.append(Problem(place, str(error)))
        return None


def refused_at(path: KeyPath, study: StudyFile, source: str, message: str) -> SceneFileError:
    """Return the error for a value that is found wrong only where its study is made ready to run."""
    return placed(parse_yaml(study.text, source), [Finding(Problem(path, message), False)])


def copies(study: StudyFile) -> dict[str, bytes]:
    """Return the study, its scene and the files that this names, by their names in a folder of their own."""
    text, found, names = study.scene_text.text, dict[str, bytes](), dict[KeyPath, object]()
    for path, name in files_named(study.scene_text.yaml.data).items():
        found[copy := "-".join(map(str, path[:-1])) + Path(name).suffix] = (study.scene_text.folder / name).read_bytes()
        names[path] = copy
    found[SCENE_NAME] = (with_values(text, names) if names else text).encode()
    return {**found, STUDY_NAME: with_values(study.text, {("scene",): SCENE_NAME}).encode()}


def study_text(content: Mapping[str, object]) -> str:
    """Return the text of a study that is given as plain data; what is None is left out.

    Raises
    ------
    SceneFileError
        It is no plain data.
    """
    try:
        given = {key: value for key, value in content.items() if value is not None}
        return json.dumps(given, indent=1, default=_plain)
    except (TypeError, ValueError) as error:
        raise SceneFileError([FileProblem((), f"is no plain data ({error}); give numbers and text", "study")]) from None


def _plain(value: object) -> object:
    """Return an array as lists, and a number of NumPy's as Python's."""
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    raise TypeError(f"type {type(value).__name__}")

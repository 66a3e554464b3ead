"""Scenes, studies and designs, told from each other where one stands in the place of another."""

from __future__ import annotations

from typing import Literal

from cagepose.errors import FileProblem, SceneFileError
from cagepose.files.yaml_source import YamlSource

Kind = Literal["scene", "study", "design"]

USES: dict[Kind, str] = {
    "scene": "run it with `cagepose run FILE`, or name it as the scene of a study",
    "study": "run it with `cagepose study FILE --out FOLDER`",
    "design": "run it with `cagepose design FILE`",
}


def expect_kind(yaml: YamlSource, expected: Kind) -> None:
    """Do nothing if a file's keys are not those of another kind.

    Raises
    ------
    SceneFileError
        They are.
    """
    keys = set(yaml.data) if isinstance(yaml.data, dict) else set()
    found: Kind | None = None
    if keys & {"change", "wish"}:
        found = "design"
    elif keys >= {"scene", "vary"}:
        found = "study"
    elif keys >= {"object", "cage"}:
        found = "scene"
    if found is not None and found != expected:
        raise SceneFileError([FileProblem((), f"is a {found}, not a {expected}; {USES[found]}", yaml.source)])

"""Parameters of a scene file, and the numbers that are written as expressions of them: ``"=10 + play/2"``."""

from __future__ import annotations

import keyword
from collections.abc import Iterator, Mapping
from copy import deepcopy
from typing import TYPE_CHECKING, Any

from cagepose.errors import Problem, SceneError
from cagepose.files.key_path import Path, set_value, value_at
from cagepose.model.checks import is_number

if TYPE_CHECKING:
    from cagepose.files.expression import Expression

TEXT_KEYS = {"name", "file", "key", "method", "metric", "planar"}
"""What stands at these is text, and no expression, whatever it begins with; but a parameter may have such a name."""
LENGTH_UNIT, NAMES_OF_PARTS, NAME_OF_BODY = ("units", "length"), ("hole", "in"), ("springs", "of")
"""Text, too, of keys that elsewhere hold numbers; the second with an index behind it, or without, the third with one
between its two."""
RESERVED = {"abs", "min", "max"}


class Expressions:
    """The expressions of plain scene data.

    Attributes
    ----------
    by_path
        Where they stand, in the order of the file, those of parameters first.
    problems
        Of those that are no expressions.
    """

    def __init__(self, data: object) -> None:
        self.by_path: dict[Path, Expression] = {}
        self.problems: list[Problem] = []
        found = sorted(_texts(data, ()), key=lambda item: item[0][0] != "parameters")  # a stable order
        for path, text in found:
            from cagepose.files.expression import Expression  # what no scene without expressions waits for

            try:
                self.by_path[path] = Expression(text[1:])
            except ValueError as error:
                self.problems.append(Problem(path, str(error)))
        given = data.get("parameters") if isinstance(data, dict) else None
        self._parameters: dict[str, Any] = given if isinstance(given, dict) else {}

    def values(self, varied: Mapping[str, Any] | None = None) -> dict[Path, Any]:
        """Return what each comes to; ``varied`` are parameters with other values, arrays among them.

        Raises
        ------
        SceneError
            Some come to no number. If one of them is a parameter, it is the only one that is named: others use it.
        """
        names: dict[str, Any] = {}
        found: dict[Path, Any] = {}
        for name, given in self._parameters.items():
            path: Path = ("parameters", name)
            if varied is not None and name in varied:
                names[name] = varied[name]
            elif path in self.by_path:
                try:
                    found[path] = names[name] = _number(self.by_path[path], names)
                except ValueError as error:
                    raise SceneError([Problem(path, str(error))]) from None
            elif is_number(given):
                names[name] = float(given)
            else:
                raise SceneError([])  # no number: the schema says so
        problems = []
        for path, expression in self.by_path.items():
            if path[0] != "parameters":
                try:
                    found[path] = _number(expression, names)
                except ValueError as error:
                    problems.append(Problem(path, str(error)))
        if problems:
            raise SceneError(problems)
        return found


def _number(expression: Expression, names: Mapping[str, Any]) -> Any:
    """Return a float, or an array of them."""
    found = expression.value(names)
    if isinstance(found, float) or (_is_array(found) and found.dtype.kind == "f"):
        return found
    raise ValueError(f"comes to {_kind(found)}; write an expression of a number")


def _is_array(value: object) -> bool:
    return getattr(value, "ndim", 0) > 0


def evaluated(data: Any, parsed: Expressions | None = None) -> tuple[object, list[Problem]]:
    """Return plain scene data with all expressions as numbers, and what is wrong with them; the data stay as they are.

    An expression that is wrong stands as it was written, so that its place is known. ``parsed`` are the expressions of
    data that differ from these in numbers alone.
    """
    expressions = Expressions(data) if parsed is None else parsed
    if not expressions.by_path:
        return data, expressions.problems
    try:
        values = expressions.values(None if parsed is None else _numbers(data.get("parameters")))
    except SceneError as error:
        return data, [*expressions.problems, *error.problems]
    changed = deepcopy(data)
    for path, value in values.items():
        set_value(changed, path, value)
    return changed, expressions.problems


def _numbers(parameters: Any) -> dict[str, float]:
    given = parameters.items() if isinstance(parameters, dict) else ()
    return {name: float(value) for name, value in given if is_number(value)}


def expression_at(data: object, path: Path) -> str | None:
    """Return the text of the expression at a path of plain scene data; None: there is none."""
    found = value_at(data, path)
    return found if isinstance(found, str) and _is_expression(found, path) else None


def parameter_name_message(name: str) -> str | None:
    """Say what is wrong with the name of a parameter; None: nothing."""
    if not name.isidentifier() or keyword.iskeyword(name):
        return "is no name that an expression can use; use letters, digits and _, a letter first"
    return "is the name of a function; choose another" if name in RESERVED else None


def _texts(here: object, path: Path) -> Iterator[tuple[Path, str]]:
    if isinstance(here, str):
        if _is_expression(here, path):
            yield path, here
    elif isinstance(here, dict):
        for key, value in here.items():
            yield from _texts(value, (*path, key))
    elif isinstance(here, list):
        for index, value in enumerate(here):
            yield from _texts(value, (*path, index))


def _is_expression(text: str, path: Path) -> bool:
    if not text.startswith("=") or not path:
        return False
    is_text = path[-1] in TEXT_KEYS or path == LENGTH_UNIT or NAMES_OF_PARTS in (path[-2:], path[-3:-1])
    is_text = is_text or path[-3:][::2] == NAME_OF_BODY
    return path[0] == "parameters" or not is_text


def _kind(value: object) -> str:
    if isinstance(value, complex):
        return "a number that is not real"
    if isinstance(value, str):
        return "text"
    return "a function" if callable(value) else "true or false"

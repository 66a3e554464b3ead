"""Shapes of a body by their names: one for each, none twice."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, TypeVar

from cagepose.errors import Key, key_path
from cagepose.model.checks import ProblemList, duplicates
from cagepose.model.shapes import Shape

AnyShape = TypeVar("AnyShape", bound=Shape)


def placed(
    given: Mapping[str, Sequence[Any]], rank: Callable[[Shape], int], prefix: str = ""
) -> tuple[tuple[tuple[Key, ...], ...], tuple[Any, ...]]:
    """Return the paths of the numbers of shapes, and the shapes themselves with names, those of the lowest rank first.

    ``given`` has the lists that they stand in, by their keys; a list of any shapes has the kind of each in its paths.
    """
    found: list[tuple[tuple[Key, ...], Any]] = [
        ((key, index, shape.kind) if key == "shapes" else (key, index), shape)
        for key, shapes in given.items()
        for index, shape in enumerate(shapes)
    ]
    found.sort(key=lambda path_and_shape: rank(path_and_shape[1]))
    return tuple(path for path, _ in found), named((shape for _, shape in found), prefix)


def named(shapes: Iterable[AnyShape], prefix: str = "") -> tuple[AnyShape, ...]:
    """Return shapes that all have names: the others get their kind and their number among those of that kind, behind
    ``prefix``.
    """
    numbers: Counter[str] = Counter()
    found = []
    for shape in shapes:
        numbers[shape.kind] += 1
        found.append(shape if shape.name is not None else shape.renamed(f"{prefix}{shape.kind}{numbers[shape.kind]}"))
    return tuple(found)


def names_of(shapes: Iterable[Shape]) -> tuple[str, ...]:
    """Return the names of named shapes."""
    return tuple(str(shape.name) for shape in shapes)


def place_of(path: tuple[Key, ...]) -> tuple[Key, ...]:
    """Return where a shape stands, from the path of its numbers: without the key of its kind.

    >>> place_of(("shapes", 2, "cylinder")), place_of(("boxes", 0))
    (('shapes', 2), ('boxes', 0))
    """
    return path[:-1] if isinstance(path[-1], str) else path


def check_names(names: Sequence[str], places: Sequence[tuple[Key, ...]], problems: ProblemList) -> None:
    """Note each name that stands for two things, at the place of the second, ``places`` having the path of each."""
    for name, (first, second, *_) in duplicates(names).items():
        found = f"{name!r} is already the name of {key_path(places[first])}; rename one"
        is_listed = isinstance(places[second][-1], int)  # else its name is its key
        problems.add((*places[second], "name") if is_listed else places[second], found)

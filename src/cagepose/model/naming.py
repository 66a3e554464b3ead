"""Shapes of a body by their names: one for each, none twice."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from typing import TypeVar

from cagepose.errors import Key, key_path
from cagepose.model.checks import ProblemList, duplicates
from cagepose.model.shapes import Shape

AnyShape = TypeVar("AnyShape", bound=Shape)


def named(shapes: Iterable[AnyShape]) -> tuple[AnyShape, ...]:
    """Return shapes that all have names: the others get their kind and their number among those of that kind."""
    numbers: Counter[str] = Counter()
    found = []
    for shape in shapes:
        numbers[shape.kind] += 1
        found.append(shape if shape.name is not None else shape.renamed(f"{shape.kind}{numbers[shape.kind]}"))
    return tuple(found)


def names_of(shapes: Iterable[Shape]) -> tuple[str, ...]:
    """Return the names of named shapes."""
    return tuple(str(shape.name) for shape in shapes)


def check_names(names: Sequence[str], places: Sequence[tuple[Key, ...]], problems: ProblemList) -> None:
    """Note each name that stands for two things, at the place of the second, ``places`` having the path of each."""
    for name, (first, second, *_) in duplicates(names).items():
        found = f"{name!r} is already the name of {key_path(places[first])}; rename one"
        problems.add((*places[second], "name"), found)

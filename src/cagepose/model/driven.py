"""Whether what loads drive, what presses, and what springs ride on, is in the cage."""

from __future__ import annotations

import difflib
from collections.abc import Sequence

from cagepose.model.cage import Cage
from cagepose.model.checks import ProblemList
from cagepose.model.load import Load
from cagepose.model.wording import few


def check_driven(cage: Cage, loads: Sequence[Load], problems: ProblemList) -> None:
    """Note each drive, press and spring of a body that the cage does not have."""
    names = [body.name for body in cage.bodies]
    for index, load in enumerate(loads):
        for key, bodies in (("drive", load.drive), ("press", load.press)):
            for name in bodies:
                if name not in names:
                    problems.add(("loads", index, key, name), f"is no body of the cage; {_meant(name, cage)}")
        for number, spring in enumerate(load.springs):
            if spring.of is not None and spring.of not in names:
                found = f"is {spring.of!r}, no body of the cage; {_meant(spring.of, cage)}"
                problems.add(("loads", index, "springs", number, "of"), found)


def _meant(name: str, cage: Cage) -> str:
    """Return which body may have been meant, and which there are."""
    names = [body.name for body in cage.bodies]
    if name in cage.element_names:
        return f"{name} is a point, a shape or a hole; put it into one of cage.bodies, and give the name of that body"
    if not names:
        return "it has none; give it in cage.bodies"
    close = difflib.get_close_matches(name, names, n=1)
    return f"{f'did you mean {close[0]}? ' if close else ''}bodies: {few(names)}"

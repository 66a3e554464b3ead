"""All oracles by name, and what they say of one case."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from audit import balance, certified, goes_on, groups, inside, order, robustness, stability, uniqueness, way
from audit.case import Answer, Case, Failure
from audit.families import make_case
from cagepose import Run, run

ORACLES: dict[str, Callable[[Run], Answer]] = {
    "balance": balance.balance,
    "moves": balance.unbalance,
    "onward": goes_on.goes_on,
    "forces": balance.forces,
    "contacts": balance.contacts,
    "groups": groups.groups,
    "robust": robustness.robustness,
    "valley": stability.stability,
    "unique": uniqueness.uniqueness,
    "certified": certified.certified,
    "falls": way.potential_falls,
    "depth": way.depth,
    "passes": way.passes,
    "escape": way.escape,
    "order": order.order_of_verdicts,
    "poses": order.order_of_poses,
    "batch": order.batch,
    "inside": inside.inside,
}
OF_ALL_SHAPES = ("certified", "falls", "inside")
"""What can be asked where there is more than boxes in the object and points in the cage."""
ENDING, TIME, CRASH = "ending", "time", "crash"
"""Questions to every run: has it the right end? Did it take longer than `SLOW_S`? Was there an exception?"""
SLOW_S = 1.0
NOT_SHOWN = "not shown"
"""A `may rest` for which no motion is named."""


@dataclass(frozen=True)
class Finding:
    """What came of one case: its verdict, how long its run took, which oracles could ask, and the failures."""

    family: str
    index: int
    friction: float
    verdict: str
    solve_s: float
    asked: tuple[str, ...]
    failures: tuple[Failure, ...]


def examine_drawn(family: str, index: int, seed: int) -> Finding:
    """Draw a case, and examine it; for processes, which are given names."""
    return examine(make_case(family, index, seed))


def examine(case: Case) -> Finding:
    """Run a case and ask all oracles; a slow run is asked nothing else, as most of them run it again."""
    answers: dict[str, Answer] = {}
    verdict, solve_s = "", math.nan
    try:
        found = run(case.scene)
        solve_s = found.solve_s if found.solve_s <= SLOW_S else min(found.solve_s, run(case.scene).solve_s)
        verdict = _verdict(found)
        answers[ENDING] = _ending(found, case.ending)
        answers[TIME] = [f"took {solve_s:.1f} s"] if solve_s > SLOW_S else []
        if solve_s <= SLOW_S:
            for name in OF_ALL_SHAPES if case.scene.has_other_shapes else ORACLES:
                answers[name] = ORACLES[name](found)
    except Exception as error:  # whatever it is, it must not end the audit, and is a failure
        answers[CRASH] = [f"{type(error).__name__}: {error}"]
    failures = [
        Failure(case.family, case.index, name, text) for name, answer in answers.items() for text in answer or ()
    ]
    asked = tuple(name for name, answer in answers.items() if answer is not None)
    return Finding(case.family, case.index, case.friction, verdict, solve_s, asked, tuple(failures))


def _verdict(found: Run) -> str:
    """The last verdict; `NOT_SHOWN` where the run has an end and one of its rests is that."""
    if not found.failed and any(p.verdict == "may rest" and p.proof.motion is None for p in found.phases):
        return NOT_SHOWN
    return found.verdict


def _ending(found: Run, expected: str | None) -> list[str]:
    if found.failed:
        return [f"{found.phases[-1].name}: {found.verdict}"]
    return [f"{found.verdict} instead of {expected}"] if expected not in (None, found.verdict) else []

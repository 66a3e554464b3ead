"""Random pegs on a compliance against exact statics in the plane, without a step that anybody has set."""

from __future__ import annotations

from collections import Counter

import numpy as np

from cagepose import run
from driven.insertions import LG, RADIUS, Insertion, Statics
from driven.test_whitney import forces_of, lean_of

LEAST_N = 1e-3
"""A state whose contacts carry less than this, or are nearer to opening, may be that or the next one."""
MOST_WITHOUT_REST = 0.05
"""Of the pegs that statics has one state for: so many may end otherwise than at rest."""


def drawn(seed: int) -> tuple[Insertion, float, float, str]:
    """A peg, how deep its tip begins, how high its support ends, mm, and its shape."""
    rng = np.random.default_rng(seed)
    play = float(10.0 ** rng.uniform(-3.0, -1.0))  # of the radius
    insertion = Insertion(
        RADIUS * (1.0 + play),
        float(rng.uniform(0.0, 0.6)),
        float(rng.uniform(0.0, 0.012)),
        0.0 if seed % 5 == 0 else float(rng.uniform(0.0, 0.5)),
    )
    begins = float(rng.uniform(1.0, 3.0))
    return insertion, begins, LG - begins - float(rng.uniform(2.0, 36.0)), ("round", "square")[seed % 2]


def states(insertion: Insertion, high: float) -> list[Statics]:
    """The states of contact that can be: forces push, and of one point the tip is off the other wall."""
    found = []
    for n_points in (1, 2):
        try:
            exact = insertion.exact(n_points, high)
        except (ValueError, np.linalg.LinAlgError):
            continue
        edge = exact.tip_mm[0] - RADIUS * np.cos(exact.lean)
        is_off = n_points == 2 or edge > -insertion.hole_radius + 1e-6
        is_in = exact.tip_mm[1] < -1e-3 and abs(exact.lean) < 0.1
        if (exact.forces_n > LEAST_N).all() and is_off and is_in:
            found.append(exact)
    return found


def test_forces_and_lean_of_random_pegs_are_those_of_exact_statics(cases, say) -> None:
    """Of one point at the mouth, or of two; where statics has no such state, or two, a peg is left out."""
    ended, worst_force, worst_lean = Counter[str](), 0.0, 0.0
    for seed in range(cases(24, 300)):
        insertion, begins, high, shape = drawn(seed)
        exact = states(insertion, high)
        if len(exact) != 1:
            ended["left out"] += 1
            continue
        (phase,) = run(insertion.scene(begins, [high], shape)).phases
        assert phase.drive is not None
        if phase.verdict not in ("rests", "may rest"):
            ended[phase.verdict] += 1
            continue
        (one,) = exact
        forces = np.array(forces_of(phase, len(one.forces_n)))
        off = float(np.abs(forces - one.forces_n).max() / one.forces_n.max())
        lean = abs(lean_of(phase) - one.lean)
        ended[f"{len(one.forces_n)} points"] += 1
        worst_force, worst_lean = max(worst_force, off), max(worst_lean, lean)
        assert off <= 1e-8, (seed, insertion, forces, one.forces_n)
        assert lean <= 1e-9, seed
    n_pegs, n_rested = ended.total() - ended["left out"], ended["1 points"] + ended["2 points"]
    say(f"pegs: {dict(ended)}; forces within {worst_force:.1e} of the greatest, lean within {worst_lean:.1e} rad")
    assert ended["1 points"] > 0
    assert ended["2 points"] > 0
    assert n_pegs - n_rested <= MOST_WITHOUT_REST * n_pegs, ended

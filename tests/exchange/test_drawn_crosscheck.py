"""Ordinary parts in MuJoCo: what is proven to rest stays there, or on springs under Coulomb's law.

Of 578 ends of phases, MuJoCo leaves 16 that are stable rests. Its friction lets parts creep on, at last over an edge,
and boxes sink into cylinders under them.
"""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from cagepose import SceneError, run
from cagepose.exchange.crosscheck import PhaseCheck, crosscheck
from shapes.drawn_parts import can_on_step, gripper, on_rollers, pocket, v_block
from shapes.sprung_contacts import STAYS, on_springs

pytest.importorskip("mujoco")

WITHOUT_HOLES = (can_on_step, v_block, on_rollers, pocket, gripper)
"""MuJoCo has no holes."""


def end_of(check: PhaseCheck, size_m: float) -> str:
    verdict, left_m = check.phase.verdict, check.leaves_ours_m
    rest = f"{verdict} ({check.phase.proof.stability})"
    if check.agrees:
        return "both escape" if verdict == "escapes" else f"{rest}: the same end"
    if left_m is None:
        return f"{verdict}: MuJoCo is not out"
    stays = left_m <= max(check.allowed_m, STAYS * size_m)
    return f"{rest}: MuJoCo {'stays, and comes elsewhere by itself' if stays else 'leaves'}"


def test_what_is_proven_to_rest_stays_in_mujoco(cases, say):
    rng, ends, left = np.random.default_rng(71), Counter(), list[str]()
    for number in range(cases(12, 100)):
        draw = WITHOUT_HOLES[number % len(WITHOUT_HOLES)]
        try:
            scene = draw(rng)
        except SceneError:  # it begins inside another part
            continue
        done = run(scene)
        for index, check in enumerate(crosscheck(done).phases):
            end = end_of(check, scene.size_m)
            if end == "rests (stable): MuJoCo leaves":
                sprung = on_springs(done, index, scene.friction_coefficient)
                end += ", springs hold" if sprung.holds else ", springs do not hold"
                if not sprung.holds:
                    left.append(f"{draw.__name__}, draw {number}, {check.phase.name}: {sprung}")
            ends[end] += 1
    say(f"ordinary parts in MuJoCo: {dict(sorted(ends.items()))}")
    assert not left, "\n".join(left)
    assert sum(count for end, count in ends.items() if end.startswith("rests (stable)")) > 5

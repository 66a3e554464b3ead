"""What each point and shape of the cage carries at the end of many runs of one scene: `end_forces`."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from cagepose.kernels.native.slots import Slots
from cagepose.kernels.outcome.cases import Cases
from cagepose.kernels.outcome.records import empty_outcome
from cagepose.model.checks import FloatArray
from cagepose.model.scene import Scene
from cagepose.runs.batch import varied_cases
from cagepose.runs.cases import part_of
from cagepose.runs.methods import chosen_method
from cagepose.runs.read_proof import HELD_BY_NO_FORCES
from cagepose.runs.variation import Variation

OF_EACH_CASE = (
    *("cage_positions", "cage_quaternions", "points_cage", "object_positions", "object_quaternions"),
    *("sizes_m", "frictions", "actions"),
)
"""Those arrays of `Cases` that have a row for each case, or one for all."""


def end_forces(scene: Scene, variation: Variation, rows: Iterable[int]) -> FloatArray:
    """Run some rows of a variation once more, and return the sums of the normal forces at their ends, (n_rows of the
    variation, n_elements): those of `cagepose.run`, to the last bit.

    NaN where no forces balance the load, and in all rows that are not asked for. Each row must have a valid start.

    Raises
    ------
    KeyboardInterrupt
        Ctrl-C was pressed.
    """
    method = chosen_method(scene)
    n_runs, columns = variation.columns(scene)
    cases, rules = varied_cases(scene, method.friction(scene), columns), method.rules(scene)
    n_phases, n_elements = len(scene.loads), len(scene.cage.element_names)
    n_ordered = 0 if method.joins_steps else len(scene.cage.names)
    outcome = empty_outcome(scene.geometry, n_phases, rules.step_limit, n_ordered)
    work, filled = Slots(method.workspace(scene, rules.step_limit)), Slots(outcome)
    part, found = Slots(part_of(scene)), np.full((n_runs, n_elements), np.nan)
    phases: Any = outcome.phases
    contacts: Any = outcome.contacts
    for row in rows:
        method.run(part, _case(cases, row), rules, work, filled)
        last = int(outcome.counts[0]) - 1
        of_last = slice(int(phases["n_contacts"][last - 1]) if last else 0, int(phases["n_contacts"][last]))
        elements = contacts["cage_part"][of_last]
        if phases["proof"][last] in HELD_BY_NO_FORCES and len(elements):
            continue
        found[row] = 0.0
        np.add.at(found[row], elements, contacts["force_normal"][of_last])
    return found


def _case(cases: Cases, row: int) -> Cases:
    arrays: Any = {name: getattr(cases, name) for name in OF_EACH_CASE}
    return cases._replace(**{name: array[row : row + 1] for name, array in arrays.items() if len(array) > 1})

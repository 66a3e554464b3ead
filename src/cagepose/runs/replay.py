"""Any event of a run made again, from the state that it began with: `replay_event`."""

from __future__ import annotations

from typing import Any

from cagepose.errors import CageposeError
from cagepose.kernels.outcome.records import empty_outcome
from cagepose.runs.cases import cases_of, part_of
from cagepose.runs.run import Event, Run
from cagepose.runs.solved import Solution, read_events, written


def replay_event(run: Run, phase: int, event: int, *, in_python: bool = False) -> Event:
    """Make one event of a run again.

    A step of a method depends on nothing but the state before it, so this is the same event to the last digit. Where a
    phase drives bodies of the cage, or lets them press, it depends on all that came before: from there on the whole
    scene is run again.

    Parameters
    ----------
    run
        What `cagepose.run` has returned.
    phase, event
        Which, counted from 0.
    in_python
        Run the kernels as plain Python, to step through them in a debugger.

    Raises
    ------
    CageposeError
        The run keeps no states: it was loaded from a file, or changed.
    IndexError
        There is no such phase or event.
    """
    solution = vars(run).get("solution")
    if not isinstance(solution, Solution):
        raise CageposeError("this run keeps no states: it was loaded from a file, or changed; run its scene again")
    scene, outcome = run.scene, solution.outcome
    first_step, n_steps = solution.steps_of(phase, event)
    steps: Any = outcome.steps
    if any(load.drive or load.press for load in scene.loads[: phase + 1]):
        return _in_a_whole_run(solution, phase, event, in_python=in_python)
    method, repeated = solution.method, empty_outcome(scene.geometry, 1, n_steps, outcome.order.shape[1])
    kernel = method.repeat.python if in_python else method.repeat
    kernel(
        phase,
        steps[first_step : first_step + 1],
        outcome.order[first_step],
        n_steps,
        part_of(scene),
        cases_of(scene, solution.friction),
        solution.rules,
        method.workspace(scene, n_steps),
        repeated,
    )
    (found,) = read_events(scene, method, written(repeated))
    return found


def _in_a_whole_run(solution: Solution, phase: int, event: int, *, in_python: bool) -> Event:
    scene, method, rules = solution.scene, solution.method, solution.rules
    outcome = empty_outcome(scene.geometry, len(scene.loads), rules.step_limit, solution.outcome.order.shape[1])
    kernel = method.run.python if in_python else method.run
    kernel(
        part_of(scene), cases_of(scene, solution.friction), rules, method.workspace(scene, rules.step_limit), outcome
    )
    again = Solution(scene, method, rules, solution.friction, written(outcome))
    return again.phases()[phase].events[event]

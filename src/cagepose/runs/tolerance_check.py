"""Does the verdict hang on the touch tolerance? Run again with a ten times larger and a ten times smaller one."""

from __future__ import annotations

from dataclasses import replace

from cagepose.errors import SceneError
from cagepose.model.tolerances import TOUCH_GREATEST, TOUCH_LEAST
from cagepose.runs import solve
from cagepose.runs.run import Run

FACTORS = (10.0, 0.1)


def verdict_changes(checked: Run) -> tuple[str, ...]:
    """Return a warning for each of the two tolerances that gives another verdict than ``checked`` has; none is good."""
    touch = checked.scene.tolerances.touch
    warnings = []
    for factor in FACTORS:
        other = min(max(touch * factor, TOUCH_LEAST), TOUCH_GREATEST)
        try:
            verdict = solve.run(
                checked.scene.changed(tolerances=replace(checked.scene.tolerances, touch=other)), checked.method
            ).verdict
        except SceneError as error:
            found = f"the scene cannot be run ({error.problems[0]})"
        else:
            if verdict == checked.verdict:
                continue
            found = f"the verdict is {verdict}"
        warnings.append(
            f"with a touch tolerance of {other:g} instead of {touch:g} {found}, not {checked.verdict};"
            " do not rely on it: look for a point that only just touches"
        )
    return tuple(warnings)

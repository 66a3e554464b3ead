"""The one registry of methods: what runs a scene once, and what runs it many times."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from cagepose.errors import Problem, SceneError
from cagepose.model.methods import DEFAULT_METHOD, METHODS
from cagepose.model.scene import Scene
from cagepose.runs.batches import Batch, QuasistaticBatch, StepwiseBatch
from cagepose.runs.quasistatic import run_quasistatic
from cagepose.runs.run import Run
from cagepose.runs.stepwise import run_stepwise
from cagepose.runs.variation import Variation


@dataclass(frozen=True)
class Method:
    """What a method brings.

    Attributes
    ----------
    run
        Runs a scene once.
    batch
        Prepares many runs of a scene with values that vary.
    """

    run: Callable[[Scene], Run]
    batch: Callable[[Scene, Variation], Batch]


REGISTRY: dict[str, Method] = {
    "stepwise": Method(run_stepwise, StepwiseBatch),
    "quasistatic": Method(run_quasistatic, QuasistaticBatch),
}
"""By name; the names themselves, and their defaults, are in `cagepose.model.methods`."""


def chosen_method(scene: Scene, method: str | None = None) -> str:
    """Return the name of the method that `cagepose.run` uses.

    Raises
    ------
    SceneError
        An unknown method.
    """
    chosen = method or scene.method or DEFAULT_METHOD
    if chosen not in REGISTRY:
        raise SceneError([Problem(("method",), f"is {chosen!r}; known methods: {', '.join(METHODS)}")])
    return chosen

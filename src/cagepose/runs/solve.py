"""The friendly call: `run`."""

from __future__ import annotations

from collections.abc import Callable

from cagepose.errors import Problem, SceneError
from cagepose.model.scene import Scene
from cagepose.runs.quasistatic import run_quasistatic
from cagepose.runs.run import Run
from cagepose.runs.stepwise import run_stepwise

_SOLVERS: dict[str, Callable[[Scene], Run]] = {"stepwise": run_stepwise, "quasistatic": run_quasistatic}

METHODS = tuple(_SOLVERS)
DEFAULT_METHOD = "quasistatic"


def run(scene: Scene, method: str | None = None) -> Run:
    """Say where the object comes to rest, or how it gets away.

    Parameters
    ----------
    scene
        What to run.
    method
        One of `METHODS`; None: the scene's own choice, else "quasistatic".

    Raises
    ------
    SceneError
        An unknown method.
    """
    return _SOLVERS[chosen_method(scene, method)](scene)


def chosen_method(scene: Scene, method: str | None = None) -> str:
    """Return the name of the method that `run` uses.

    Raises
    ------
    SceneError
        An unknown method.
    """
    chosen = method or scene.method or DEFAULT_METHOD
    if chosen not in _SOLVERS:
        raise SceneError([Problem(("method",), f"is {chosen!r}; known methods: {', '.join(METHODS)}")])
    return chosen

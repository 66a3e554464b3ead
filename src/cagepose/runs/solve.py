"""The friendly call: `run`."""

from __future__ import annotations

from cagepose.model.scene import Scene
from cagepose.runs.methods import REGISTRY, chosen_method
from cagepose.runs.run import Run


def run(scene: Scene, method: str | None = None) -> Run:
    """Say where the object comes to rest, or how it gets away.

    Parameters
    ----------
    scene
        What to run.
    method
        "stepwise" or "quasistatic"; None: the scene's own choice, else "quasistatic".

    Raises
    ------
    SceneError
        An unknown method.
    """
    return REGISTRY[chosen_method(scene, method)].run(scene)

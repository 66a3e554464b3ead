"""Where a load seats the object, and pushes from there: `seated`."""

from __future__ import annotations

from cagepose.errors import Problem, SceneError
from cagepose.model.scene import Scene
from cagepose.model.wording import few
from cagepose.runs.actions import actions_of, load_size
from cagepose.runs.drives import displaced_after
from cagepose.runs.run import AT_REST
from cagepose.runs.solve import run
from cagepose.studies.pushes import Pushes

SHARE_OF_LOAD = 1e-4
"""Size of a push beside the load that seats the object. On a flat seat it goes as far as by any smaller push."""


def seated(scene: Scene, phase: str) -> Pushes:
    """Return pushes, small beside the load of a phase, from where that leaves the object without friction.

    Raises
    ------
    SceneError
        There is no such phase, the scene's run does not come to rest in it, or no stable rest without friction is near.
    """
    names = [load.name for load in scene.loads]
    if phase not in names:
        raise SceneError([Problem(("phase",), f"is {phase!r}, and the scene has {few(names)}; give one of them")])
    whole = run(scene)
    number, ended = names.index(phase), whole.phases
    if number >= len(ended) or ended[number].verdict not in AT_REST:
        how = ended[number].verdict if number < len(ended) else "is not reached"
        raise SceneError([Problem(("phase",), f"is {phase!r}, which does not come to rest ({how}); see cagepose run")])
    pose, displaced = ended[number].pose, displaced_after(whole, number)
    unit_n = SHARE_OF_LOAD * load_size(scene, number, pose, displaced)
    acting = actions_of(scene)[number]  # springs are held where they are at the start: kernels move them with bodies
    pushes = Pushes(scene, pose, acting, unit_n, unit_n * scene.object.reach_m, displaced)
    settled = pushes.settle()
    if not settled.rests or settled.is_saddle:
        why = "no stable rest without friction is near"
        if settled.verdict == "escapes":
            why = "friction alone keeps it there"
        others = [name for name in names if name != phase]
        which = f", such as {few(others)}" if others else ""
        raise SceneError([Problem(("phase",), f"is {phase!r}, and {why}; choose another phase{which}")])
    pushes.start = settled.pose
    return pushes

"""``cagepose ask friction``: how much friction the end of a phase needs."""

from __future__ import annotations

from cagepose.cli.asked import JsonOption, PhaseOption, run_asked
from cagepose.cli.options import SceneArgument, SetOption


def ask_friction(
    scene: SceneArgument, /, *, phase: PhaseOption = None, set_values: SetOption = (), json: JsonOption = False
) -> int:
    """Print from which coefficient on the contacts can balance the load, and from which no motion can begin."""
    asked = run_asked(scene, set_values)
    if asked is None:
        return 2
    from cagepose.files.answers import friction
    from cagepose.questions.friction import friction_limits

    return asked.tell(lambda run: friction_limits(run, phase), friction, json)

"""``cagepose ask jam``: from which friction on a part jams, however hard it is driven or pushed."""

from __future__ import annotations

from cagepose.cli.asked import JsonOption, PhaseOption, run_asked
from cagepose.cli.options import SceneArgument, SetOption


def ask_jam(
    scene: SceneArgument, /, *, phase: PhaseOption = None, set_values: SetOption = (), json: JsonOption = False
) -> int:
    """Print from which coefficient of friction on the part can jam along its way, and where first."""
    asked = run_asked(scene, set_values)
    if asked is None:
        return 2
    from cagepose.files.answers import jam as answers
    from cagepose.questions.jam import jam

    return asked.tell(lambda run: jam(run, phase), answers, json)

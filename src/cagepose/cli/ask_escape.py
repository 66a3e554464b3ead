"""``cagepose ask escape``: how much work gets a part out of its cage."""

from __future__ import annotations

from typing import Annotated

from cyclopts import Parameter
from cyclopts.validators import Number

from cagepose.cli.asked import JsonOption, PhaseOption, run_asked
from cagepose.cli.options import SceneArgument, SetOption


def ask_escape(
    scene: SceneArgument,
    /,
    *,
    phase: PhaseOption = None,
    motions: Annotated[
        int | None,
        Parameter(
            validator=Number(gte=1),
            help="How many motions the search for a way out that takes less work tries; left out: 20,000. In a plane,"
            " at how many poses it asks; left out: 60,000.",
        ),
    ] = None,
    set_values: SetOption = (),
    json: JsonOption = False,
) -> int:
    """Print how much work against the load gets the part out from where it rests, and the way."""
    asked = run_asked(scene, set_values)
    if asked is None:
        return 2
    from cagepose.files.answers import escape as answers
    from cagepose.files.progress import tell
    from cagepose.questions.escape import escape_energy

    tell("searching for ways out that take little work (some seconds)")
    return asked.tell(lambda run: escape_energy(run, phase, n_motions=motions), answers, json)

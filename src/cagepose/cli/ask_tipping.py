"""``cagepose ask tipping``: how large a force may become before a part gives way, and how it does."""

from __future__ import annotations

from typing import Annotated

from cyclopts import Parameter

from cagepose.cli.asked import JsonOption, PhaseOption, run_asked
from cagepose.cli.options import SceneArgument, SetOption


def ask_tipping(
    scene: SceneArgument,
    /,
    *,
    at: Annotated[
        str,
        Parameter(
            help="Where the force acts: x,y,z in the object's frame and the scene's unit.", allow_leading_hyphen=True
        ),
    ],
    direction: Annotated[
        str, Parameter(help="Where it points: x,y,z in the world, of any length.", allow_leading_hyphen=True)
    ],
    phase: PhaseOption = None,
    set_values: SetOption = (),
    json: JsonOption = False,
) -> int:
    """Print up to which force beside the load the contacts hold the part, and how it gives way."""
    from cagepose.cli.triples import read_triple

    problems: list[str] = []
    place, along = read_triple("--at", at, problems), read_triple("--direction", direction, problems)
    if along == (0.0, 0.0, 0.0):
        problems.append(f"--direction {direction}: is the zero vector; give any other one")
    asked = run_asked(scene, set_values, problems)
    if asked is None:
        return 2
    from cagepose.files.answers import tipping as answers
    from cagepose.files.units import to_metres
    from cagepose.model.load import Force
    from cagepose.questions.tipping import tipping

    force = Force(along, to_metres(place, asked.unit))
    return asked.tell(lambda run: tipping(run, force, phase), answers, json)

"""``cagepose ask resting``: in which ways a part comes to rest, on a plane or in its cage."""

from __future__ import annotations

import sys
from typing import Annotated

from cyclopts import Parameter

from cagepose.cli.asked import JsonOption, print_answer, read_asked
from cagepose.cli.options import SceneArgument, SetOption, Switch


def ask_resting(
    scene: SceneArgument,
    /,
    *,
    plane: Annotated[
        bool, Switch, Parameter(help="Ask of the part alone, on a level plane without friction, whatever its cage is.")
    ] = False,
    phase: Annotated[
        str | None, Parameter(help="In a cage: the phase whose load acts. Left out: the first.", show_default=False)
    ] = None,
    starts: Annotated[int, Parameter(help="In a cage: from how many poses it is let go.")] = 200,
    set_values: SetOption = (),
    json: JsonOption = False,
) -> int:
    """Print all poses in which the part comes to rest, how firmly, and how often it ends in each.

    In a cage it is let go from many poses. Where the cage is a level floor alone, it is asked as on a plane.
    """
    source = read_asked(scene, set_values)
    if source is None:
        return 2

    from cagepose.errors import SceneError
    from cagepose.files.answers import cage_rests as in_cage
    from cagepose.files.answers import resting
    from cagepose.files.progress import tell
    from cagepose.questions.cage_rests import cage_rests
    from cagepose.questions.resting import is_on_floor_alone, resting_poses

    name, unit, size_m = source.scene.name, source.length_unit, source.scene.size_m
    try:
        if plane or is_on_floor_alone(source.scene):
            print_answer(name, resting_poses(source.scene.object), resting, unit, size_m, json=json)
        else:
            tell(f"letting the part go from {starts} poses in its cage (seconds; round shapes take longest)")
            print_answer(name, cage_rests(source.scene, phase, n_starts=starts), in_cage, unit, size_m, json=json)
    except SceneError as error:
        sys.stderr.write(f"{error}\n")
        return 2
    return 0

"""``cagepose ask resting``: in which ways a part comes to rest."""

from __future__ import annotations

from cagepose.cli.asked import JsonOption, print_answer, read_asked
from cagepose.cli.options import SceneArgument, SetOption


def ask_resting(scene: SceneArgument, /, *, set_values: SetOption = (), json: JsonOption = False) -> int:
    """Print all poses in which the part comes to rest, how firmly, and how often it ends in each."""
    source = read_asked(scene, set_values)
    if source is None:
        return 2
    import sys

    from cagepose.errors import SceneError
    from cagepose.files.answers import resting
    from cagepose.questions.resting import resting_poses

    try:
        found = resting_poses(source.scene.object)
    except SceneError as error:
        sys.stderr.write(f"{error}\n")
        return 2
    print_answer(source.scene.name, found, resting, source.length_unit, source.scene.size_m, json=json)
    return 0

"""``cagepose ask gap``: how far a cage may open before its part gets out."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from cagepose.cli.asked import JsonOption, print_answer, read_asked
from cagepose.cli.options import SceneArgument, SetOption

if TYPE_CHECKING:
    from cagepose.model.scene import Scene


def ask_gap(
    scene: SceneArgument,
    /,
    *,
    vary: Annotated[str, Parameter(help="The number of the scene that opens the cage, as for --set.")],
    range: Annotated[
        str,
        Parameter(
            help="From which value to which, in the file's unit: tight,wide. The cage opens towards the second.",
            allow_leading_hyphen=True,
        ),
    ],
    set_values: SetOption = (),
    json: JsonOption = False,
) -> int:
    """Print up to which value of a number the part is proven to be caged, and from which it gets out."""
    from cagepose.errors import SceneError, SceneFileError

    try:
        tight, wide = (float(text) for text in range.split(","))
    except ValueError:
        sys.stderr.write(f"--range {range}: is not two numbers with a comma between them, such as 10,12.5\n")
        return 2
    source = read_asked(scene, set_values)
    if source is None:
        return 2
    from cagepose.files.answers import gap as answers
    from cagepose.files.progress import tell
    from cagepose.files.scene_file import read_scene_file
    from cagepose.questions.gap import critical_gap

    def scene_at(value: float) -> Scene:
        return read_scene_file(scene, (*set_values, f"{vary}={value!r}")).scene

    tell("searching for ways out at some thirty values (seconds)")
    try:
        found = critical_gap(scene_at, tight, wide)
    except (SceneFileError, SceneError) as error:
        sys.stderr.write(f"{error}\n")
        return 2
    print_answer(source.scene.name, found, answers, source.length_unit, source.scene.size_m, json=json)
    return 0

"""``cagepose play``: how far the object can move in its cage, and whether it can get out."""

from __future__ import annotations

import sys
from typing import Annotated

from cyclopts import Parameter

from cagepose.cli.options import AtOption, SceneArgument, SetOption, Switch

ERASE_LINE = "\r\x1b[K"


def play_command(
    scene: SceneArgument,
    /,
    *,
    at: AtOption = (),
    direction: Annotated[
        tuple[str, ...],
        Parameter(
            help="A direction x,y,z in the cage's frame along which to find the play of the points; may be given"
            " several times. Left out: x, y and z.",
            negative=(),
            show_default=False,
            allow_leading_hyphen=True,
        ),
    ] = (),
    hold: Annotated[
        str | None,
        Parameter(
            help="Freedoms to hold, such as x,roll,yaw: any of x, y and z; of roll, pitch and yaw two or all three.",
            show_default=False,
        ),
    ] = None,
    seated: Annotated[
        bool,
        Switch,
        Parameter(help="Start where the loads bring it to rest: how far can small pushes move it from there?"),
    ] = False,
    phase: Annotated[
        str | None,
        Parameter(help="With --seated: the phase at whose end it rests. Left out: the last.", show_default=False),
    ] = None,
    set_values: SetOption = (),
    json: Annotated[bool, Switch, Parameter(help="Print one JSON document instead of the tables.")] = False,
) -> int:
    """Print the play of each freedom and point, what limits it, whether the object is caged, where loads press it."""
    from cagepose.cli.triples import read_triple
    from cagepose.errors import SceneError, SceneFileError
    from cagepose.files.scene_file import read_scene_file
    from cagepose.files.units import to_metres

    problems: list[str] = []
    points = [read_triple("--at", text, problems) for text in at]
    along = [read_triple("--direction", text, problems) for text in direction]
    problems += [
        f"--direction {text}: is the zero vector; give any other one"
        for text, found in zip(direction, along, strict=True)
        if found == (0.0, 0.0, 0.0)
    ]
    if direction and not at:
        problems.append("--direction: is for points, and there are none; give one with --at")
    if phase is not None and not seated:
        problems.append("--phase: works only together with --seated; add --seated")
    try:
        scene_file = read_scene_file(scene, set_values)
    except SceneFileError as error:
        problems.append(str(error))
    if problems:
        sys.stderr.write("\n".join(problems) + "\n")
        return 2

    from cagepose.files.progress import tell
    from cagepose.studies.play import play
    from cagepose.studies.play_rest import play_rests

    held = [] if hold is None else [name.strip() for name in hold.split(",")]
    is_pushed = seated or bool(held) or scene_file.scene.has_other_shapes or scene_file.scene.planar is not None
    if is_pushed:
        tell("pushing the part each way until it stops (seconds; round shapes take longest)")
    try:
        found = play(
            scene_file.scene,
            [to_metres(point, scene_file.length_unit) for point in points],
            along,
            hold=held,
            seated=(phase or scene_file.scene.loads[-1].name) if seated else None,
            progress=_show_search if sys.stderr.isatty() else None,
        )
    except SceneError as error:
        sys.stderr.write(f"--{error}\n")
        return 2
    if (is_pushed or found.verdict in ("not certified", "escapes")) and sys.stderr.isatty():
        sys.stderr.write(ERASE_LINE)
    rests = () if is_pushed else play_rests(scene_file.scene)
    if json:
        from cagepose.files.play_document import play_document
        from cagepose.files.write import json_text

        sys.stdout.write(json_text(play_document(found, rests, scene_file.length_unit)))
        return 0
    from cagepose.cli.play_report import print_play

    print_play(found, rests, scene_file.length_unit)
    return 0


def _show_search(share: float) -> None:
    """Tell on the terminal how much of the search's time has passed."""
    sys.stderr.write(f"\rsearching for a way out: {share:4.0%}")
    sys.stderr.flush()

"""``cagepose play``: how far the object can move in its cage, and whether it can get out."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from cagepose.cli.options import AtOption, SceneArgument, SetOption, Switch

if TYPE_CHECKING:
    from cagepose.files.scene_file import SceneFile

ERASE_LINE = "\r\x1b[K"
Numbers = tuple[float, ...]


def play_command(
    scene: SceneArgument,
    /,
    *,
    at: AtOption = (),
    direction: Annotated[
        tuple[str, ...],
        Parameter(
            help="A direction x,y,z in the cage's frame to ask the points about; may be given several times. Left out:"
            " x, y and z.",
            negative=(),
            show_default=False,
            allow_leading_hyphen=True,
        ),
    ] = (),
    set_values: SetOption = (),
    seated: Annotated[
        bool, Switch, Parameter(help="Run the scene first, and measure from where its loads have seated the object.")
    ] = False,
    phase: Annotated[
        str | None, Parameter(help="With --seated: the phase at whose end; left out: the last.", show_default=False)
    ] = None,
    json: Annotated[bool, Switch, Parameter(help="Print one JSON document instead of the tables.")] = False,
) -> int:
    """Print the range of each freedom and point, what limits it, whether the object is caged, where loads leave it."""
    from cagepose.cli.triples import read_triple
    from cagepose.errors import SceneError, SceneFileError
    from cagepose.files.scene_file import read_scene_file
    from cagepose.files.units import to_metres

    problems: list[str] = []
    points = [read_triple("--at", text, problems) for text in at]
    along = [read_triple("--direction", text, problems) for text in direction]
    problems += [
        f"--direction {text}: has no direction; give a vector of any other length"
        for text, found in zip(direction, along, strict=True)
        if found == (0.0, 0.0, 0.0)
    ]
    if direction and not at:
        problems.append("--direction: says where points go, and there are none; give one with --at")
    if phase is not None and not seated:
        problems.append(f"--phase {phase}: says where the object is seated; give --seated, too")
    try:
        scene_file = read_scene_file(scene, set_values)
    except SceneFileError as error:
        problems.append(str(error))
    if problems:
        sys.stderr.write("\n".join(problems) + "\n")
        return 2

    from cagepose.model.scope import check_boxes_and_points
    from cagepose.studies.play import play
    from cagepose.studies.play_rest import play_rests

    check_boxes_and_points(scene_file.scene, "play")
    if seated:
        return _play_seated(scene_file, phase, points, along, json)
    try:
        found = play(
            scene_file.scene,
            [to_metres(point, scene_file.length_unit) for point in points],
            along,
            progress=_show_search if sys.stderr.isatty() else None,
        )
    except SceneError as error:
        sys.stderr.write(f"--{error}\n")
        return 2
    if found.cage.verdict != "caged" and sys.stderr.isatty():
        sys.stderr.write(ERASE_LINE)
    rests = play_rests(scene_file.scene)
    if json:
        from cagepose.files.play_document import play_document
        from cagepose.files.write import json_text

        sys.stdout.write(json_text(play_document(found, rests, scene_file.length_unit)))
        return 0
    from cagepose.cli.play_report import print_play

    print_play(found, rests, scene_file.length_unit)
    return 0


def _play_seated(
    scene_file: SceneFile,
    phase: str | None,
    points: list[Numbers],
    along: list[Numbers],
    json: bool,
) -> int:
    """Run the scene and print its play about where it ends; 1 where it has not been seated."""
    from cagepose.errors import SceneError, printable
    from cagepose.files.units import to_metres
    from cagepose.runs.solve import run
    from cagepose.studies.seated_play import seated_play

    unit = scene_file.length_unit
    names = {load.name for load in scene_file.scene.loads}
    if phase is not None and phase not in names:
        sys.stderr.write(printable(f"--phase {phase}: no such phase; use one of: {', '.join(sorted(names))}") + "\n")
        return 2
    try:
        found = seated_play(run(scene_file.scene), phase, [to_metres(point, unit) for point in points], along)
    except SceneError as error:
        sys.stderr.write(printable(str(error)) + "\n")
        return 1
    if json:
        from cagepose.files.play_document import seated_document
        from cagepose.files.write import json_text

        sys.stdout.write(json_text(seated_document(found, unit)))
        return 0
    from cagepose.cli.seated_report import print_seated_play

    ways = along or [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)]
    axes: dict[Numbers, str] = {(1.0, 0.0, 0.0): "x", (0.0, 1.0, 0.0): "y", (0.0, 0.0, 1.0): "z"}
    asked = (f"point {n} along {axes.get(way, way)}" for n, _ in enumerate(points, start=1) for way in ways)
    print_seated_play(found, tuple(asked), unit)
    return 0


def _show_search(share: float) -> None:
    """Tell on the terminal how much of the search's time has passed."""
    sys.stderr.write(f"\rsearching for a way out: {share:4.0%}")
    sys.stderr.flush()

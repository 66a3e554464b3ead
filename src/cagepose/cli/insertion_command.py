"""``cagepose insertion``: how far a drive gets, with which force, where it could jam, from which misalignments."""

from __future__ import annotations

import sys
from typing import Annotated

from cyclopts import Parameter

from cagepose.cli.options import FILE, FileName, SceneArgument, SetOption, Switch, refusal

ERASE_LINE = "\r\x1b[K"


def insertion_command(
    scene: SceneArgument,
    /,
    *,
    phase: Annotated[
        str | None,
        Parameter(help="The phase whose drive is meant. Left out: the only one that has a drive.", show_default=False),
    ] = None,
    along: Annotated[
        str | None,
        Parameter(
            help="Freedoms in which the drive may be out of place, such as y,yaw: x, y, z (shifts), roll, pitch, yaw"
            " (turns about them), in the cage's frame. Left out: those across the way.",
            show_default=False,
        ),
    ] = None,
    set_values: SetOption = (),
    json: Annotated[bool, Switch, Parameter(help="Print one JSON document instead of the page.")] = False,
    picture: Annotated[
        FileName | None, FILE, Parameter(help="Picture file to write as well: .png, .svg or .pdf.", show_default=False)
    ] = None,
) -> int:
    """Print how far a drive gets, its force, where it could jam, and how far it may be out of place."""
    from cagepose.errors import SceneError, SceneFileError
    from cagepose.files.scene_file import read_scene_file

    problems = _picture_problems(picture)
    try:
        scene_file = read_scene_file(scene, set_values)
    except SceneFileError as error:
        problems.append(str(error))
    if problems:
        sys.stderr.write("\n".join(problems) + "\n")
        return 2

    from cagepose.studies.insertion import insertion

    names = None if along is None else [name.strip() for name in along.split(",")]
    try:
        found = insertion(scene_file.scene, phase, names, progress=_show_search if sys.stderr.isatty() else None)
    except SceneError as error:
        asked = all(problem.path[:1] in (("along",), ("phase",)) for problem in error.problems)
        sys.stderr.write(f"{'--' if asked else f'{scene}: '}{error}\n")
        return 2
    if sys.stderr.isatty():
        sys.stderr.write(ERASE_LINE)
    code = 1 if found.run.failed else 0
    if picture is not None:
        from cagepose.files.write import write_whole
        from cagepose.views.insertion_figure import insertion_figure
        from cagepose.views.output_files import FIGURES, output_suffix
        from cagepose.views.style import figure_bytes

        figure = insertion_figure(found, scene_file.length_unit)
        try:
            write_whole(picture, figure_bytes(figure, output_suffix(picture, FIGURES)))
        except OSError as error:
            sys.stderr.write(refusal(f"--picture {picture}", error) + "\n")
            code = 2
    if json:
        from cagepose.files.insertion_document import insertion_document
        from cagepose.files.write import json_text

        sys.stdout.write(json_text(insertion_document(found, scene_file.length_unit)))
        return code
    from cagepose.cli.insertion_report import print_insertion

    print_insertion(found, scene_file.length_unit)
    return code


def _picture_problems(picture: str | None) -> list[str]:
    """Return why the picture cannot be written, before anything runs."""
    if picture is None:
        return []
    from cagepose.views.extra import require_matplotlib
    from cagepose.views.output_files import FIGURES, check_output

    require_matplotlib()
    try:
        check_output(picture, FIGURES)
    except (OSError, ValueError) as error:
        return [refusal(f"--picture {picture}", error)]
    return []


def _show_search(share: float) -> None:
    """Tell on the terminal how much of the search is done."""
    sys.stderr.write(f"\rsearching how far it may be out of place: {share:4.0%}")
    sys.stderr.flush()

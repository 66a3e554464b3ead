"""``cagepose insertion``: how far a drive gets, with which force, where it could jam, from which misalignments."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from cagepose.cli.options import FILE, FileName, SceneArgument, SetOption, Switch, refusal

if TYPE_CHECKING:
    from cagepose.files.units import LengthUnit
    from cagepose.studies.insertion_result import Insertion

ERASE_LINE = "\r\x1b[K"


def insertion_command(
    scene: SceneArgument,
    /,
    *,
    phase: Annotated[
        str | None,
        Parameter(
            help="The phase whose drive to look at. May be left out if only one has a drive.", show_default=False
        ),
    ] = None,
    along: Annotated[
        str | None,
        Parameter(
            help="Freedoms in which to find the permitted misalignment, such as y,yaw: x, y, z (shifts), roll, pitch,"
            " yaw (turns about these axes), in the cage's frame. Left out: all that are not along the drive.",
            show_default=False,
        ),
    ] = None,
    set_values: SetOption = (),
    json: Annotated[bool, Switch, Parameter(help="Print one JSON document instead of the page.")] = False,
    picture: Annotated[
        FileName | None, FILE, Parameter(help="Picture file to write as well: .png, .svg or .pdf.", show_default=False)
    ] = None,
    report: Annotated[
        FileName | None,
        FILE,
        Parameter(
            help="Page to write as well, such as report.html: all of this with a picture of the mechanism, and the runs"
            " just outside the permitted misalignment, to be played.",
            show_default=False,
        ),
    ] = None,
) -> int:
    """Print how far a drive gets, its force, where it could jam, and the misalignment it permits."""
    from cagepose.errors import SceneError, SceneFileError
    from cagepose.files.scene_file import read_scene_file

    problems = _output_problems(picture, report)
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
    for option, name, content in (("picture", picture, _picture), ("report", report, _report)):
        if name is None:
            continue
        from cagepose.files.write import write_whole

        try:
            write_whole(name, content(found, scene_file.length_unit, name))
        except OSError as error:
            sys.stderr.write(refusal(f"--{option} {name}", error) + "\n")
            code = 2
    if json:
        from cagepose.files.insertion_document import insertion_document
        from cagepose.files.write import json_text

        sys.stdout.write(json_text(insertion_document(found, scene_file.length_unit)))
        return code
    from cagepose.cli.insertion_report import print_insertion

    print_insertion(found, scene_file.length_unit)
    return code


def _picture(found: Insertion, unit: LengthUnit, name: str) -> bytes:
    from cagepose.views.insertion_figure import insertion_figure
    from cagepose.views.output_files import FIGURES, output_suffix
    from cagepose.views.style import figure_bytes

    return figure_bytes(insertion_figure(found, unit), output_suffix(name, FIGURES))


def _report(found: Insertion, unit: LengthUnit, _name: str) -> bytes:
    from cagepose.cli.insertion_report import insertion_lines, meaning, permitted
    from cagepose.files.words import LengthWords
    from cagepose.views.insertion_page import insertion_page

    lines = insertion_lines(found, LengthWords(unit, found.run.scene.size_m))
    table = permitted(found, unit)
    headings = [str(column.header) for column in table.columns]
    rows = [[str(cell) for cell in row] for row in zip(*(column.cells for column in table.columns), strict=True)]
    return insertion_page(found, unit, lines, meaning(found), headings, rows).encode()


def _output_problems(picture: str | None, report: str | None) -> list[str]:
    """Return why a picture or a page cannot be written, before anything runs."""
    from cagepose.views.extra import require_insertion_page, require_matplotlib
    from cagepose.views.output_files import FIGURES, check_output

    problems = []
    for option, name, suffixes, require in (
        ("picture", picture, FIGURES, require_matplotlib),
        ("report", report, (".html",), require_insertion_page),
    ):
        if name is None:
            continue
        require()
        try:
            check_output(name, suffixes)
        except (OSError, ValueError) as error:
            problems.append(refusal(f"--{option} {name}", error))
    return problems


def _show_search(share: float) -> None:
    """Tell on the terminal how much of the search is done."""
    sys.stderr.write(f"\rsearching the permitted misalignment: {share:4.0%}")
    sys.stderr.flush()

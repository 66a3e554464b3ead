"""``cagepose run``: run a scene and print what happened."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from cagepose.cli.options import MethodOption, SceneArgument, SetOption, Switch

if TYPE_CHECKING:
    from cagepose.files.scene_file import SceneFile


def run_command(
    scene: SceneArgument,
    /,
    *,
    method: MethodOption = None,
    set_values: SetOption = (),
    json: Annotated[bool, Switch, Parameter(help="Print one JSON document instead of the table.")] = False,
    out: Annotated[str | None, Parameter(help="Save the run to this file, every number exactly.")] = None,
    critical_friction: Annotated[
        bool, Switch, Parameter(help="Find the least coefficient of friction that each rest needs.")
    ] = False,
    margin: Annotated[
        bool, Switch, Parameter(help="Find what each rest balances beside its load, and what each contact may carry.")
    ] = False,
    verbose: Annotated[
        bool, Switch, Parameter(help="Print what touches after each event, and pose and proof of every phase.")
    ] = False,
    check_tolerance: Annotated[
        bool, Switch, Parameter(help="Run again with other touch tolerances and warn if the verdict changes.")
    ] = False,
) -> int:
    """Print the events, the final pose and the verdict; return the exit code."""
    scene_file = _read(scene, set_values, method, out)
    if scene_file is None:
        return 2

    from dataclasses import replace

    from cagepose.runs.critical import with_critical_friction
    from cagepose.runs.solve import run
    from cagepose.runs.tolerance_check import verdict_changes

    result = run(scene_file.scene, method)
    if critical_friction:
        result = with_critical_friction(result)
    notes = []
    if check_tolerance:
        changes = verdict_changes(result)
        result = replace(result, warnings=(*result.warnings, *changes))
        if not changes:
            notes.append("same verdict with a ten times larger and a ten times smaller touch tolerance")
    margins = None
    if margin:
        from cagepose.studies.margin import margin as margin_of

        margins = [margin_of(result, phase) for phase in range(len(result.phases))]
    code = 1 if result.failed else 0
    if out is not None:
        from cagepose.files.run_file import save_run

        try:
            save_run(result, out, scene_file.length_unit, margins)
        except OSError as error:
            sys.stderr.write(_cannot_write(out, error))
            code = 2
    if json:
        from cagepose.files.document import run_document
        from cagepose.files.write import json_text

        sys.stdout.write(json_text(run_document(result, scene_file.length_unit, margins)))
    else:
        from cagepose.cli.report import print_report

        print_report(result, scene_file.length_unit, notes, margins, is_verbose=verbose)
    return code


def _read(scene: str, set_values: tuple[str, ...], method: str | None, out: str | None) -> SceneFile | None:
    """Check all that the user gave before anything runs; problems of every argument are printed at once."""
    from os.path import realpath

    from cagepose.errors import SceneFileError, printable
    from cagepose.files.scene_file import read_scene_file
    from cagepose.model.methods import METHODS

    problems = []
    scene_file = None
    try:
        scene_file = read_scene_file(scene, set_values)
    except SceneFileError as error:
        problems.append(f"{error}\n")
    if method is not None and method not in METHODS:
        problems.append(printable(f"--method {method}: is no known method; use one of: {', '.join(METHODS)}") + "\n")
    if out is not None:
        from cagepose.files.run_file import check_can_save

        try:
            if scene_file is not None and realpath(out) == realpath(scene):
                raise OSError("is the scene file itself; name another")
            check_can_save(out)
        except OSError as error:
            problems.append(_cannot_write(out, error))
    sys.stderr.write("".join(problems))
    return None if problems else scene_file


def _cannot_write(out: str, error: OSError) -> str:
    from cagepose.errors import printable

    return printable(f"--out {out}: {error.strerror or error}") + "\n"

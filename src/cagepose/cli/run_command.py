"""``cagepose run``: run scenes and print what happened."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from os.path import exists
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from cagepose.cli.app import STANDARD_INPUT
from cagepose.cli.options import FILE, FileName, MethodOption, SetOption, Switch, refusal, unknown_method

if TYPE_CHECKING:
    from cagepose.files.scene_file import SceneFile


def run_command(
    scene: Annotated[FileName, Parameter(help="Scene file (YAML or JSON), or - for standard input.")],
    /,
    *more: Annotated[FileName, Parameter(help="More of them, run one after the other.")],
    method: MethodOption = None,
    set_values: SetOption = (),
    json: Annotated[
        bool,
        Switch,
        Parameter(help="Print one JSON document instead of the table; of several scenes one on a line."),
    ] = False,
    out: Annotated[FileName | None, FILE, Parameter(help="Save the run to this file, every number exactly.")] = None,
    critical_friction: Annotated[
        bool, Switch, Parameter(help="Find the least coefficient of friction that each rest needs.")
    ] = False,
    margin: Annotated[
        bool,
        Switch,
        Parameter(help="Find how much extra force and moment each rest can bear, and the range of each contact force."),
    ] = False,
    verbose: Annotated[
        bool,
        Switch,
        Parameter(help="Print all contacts after each event and where they are; pose and proof of every phase."),
    ] = False,
    check_tolerance: Annotated[
        bool, Switch, Parameter(help="Run again with other touch tolerances and warn if the verdict changes.")
    ] = False,
) -> int:
    """Print the events, the final pose and the verdict of each scene; return the worst exit code."""
    scene_files = _read((scene, *more), set_values, method, out)
    if scene_files is None:
        return 2
    asked = _Asked(method, json, out, critical_friction, margin, verbose, check_tolerance, len(scene_files) > 1)
    codes = []
    for number, scene_file in enumerate(scene_files):
        if number and not json:
            sys.stdout.write("\n")
        codes.append(_run(scene_file, asked))
    return max(codes)


@dataclass(frozen=True)
class _Asked:
    """The options of `run_command`, and whether there are several scenes."""

    method: str | None
    json: bool
    out: str | None
    critical_friction: bool
    margin: bool
    verbose: bool
    check_tolerance: bool
    is_list: bool


def _run(scene_file: SceneFile, asked: _Asked) -> int:
    from dataclasses import replace

    from cagepose.runs.critical import with_critical_friction
    from cagepose.runs.solve import run
    from cagepose.runs.tolerance_check import verdict_changes

    result = run(scene_file.scene, asked.method)
    if asked.critical_friction:
        result = with_critical_friction(result)
    notes = []
    if asked.check_tolerance:
        changes = verdict_changes(result)
        result = replace(result, warnings=(*result.warnings, *changes))
        if not changes:
            notes.append("same verdict with a ten times larger and a ten times smaller touch tolerance")
    margins = None
    if asked.margin:
        from cagepose.studies.margin import margin as margin_of

        margins = [margin_of(result, phase) for phase in range(len(result.phases))]
    code = 1 if result.failed else 0
    if asked.out is not None:
        from cagepose.files.run_file import save_run

        try:
            save_run(result, asked.out, scene_file.length_unit, margins)
        except OSError as error:
            sys.stderr.write(refusal(f"--out {asked.out}", error) + "\n")
            code = 2
    if asked.json:
        from cagepose.files.document import run_document
        from cagepose.files.write import json_line, json_text

        document = run_document(result, scene_file.length_unit, margins)
        sys.stdout.write(json_line(document) if asked.is_list else json_text(document))
    else:
        from cagepose.cli.report import print_report

        print_report(result, scene_file.length_unit, notes, margins, is_verbose=asked.verbose)
    return code


def _read(
    scenes: Sequence[str], set_values: tuple[str, ...], method: str | None, out: str | None
) -> list[SceneFile] | None:
    """Check all that the user gave before anything runs; problems of every argument are printed at once."""
    from os.path import realpath

    from cagepose.errors import SceneFileError

    problems = _misplaced(scenes, out)
    found: list[SceneFile] = []
    for scene in [] if problems else scenes:
        try:
            found.append(_scene_file(scene, set_values))
        except SceneFileError as error:
            problems.append(str(error))
    problems += unknown_method(method)
    if out is not None and len(scenes) == 1:
        from cagepose.files.run_file import check_can_save

        try:
            if found and realpath(out) == realpath(scenes[0]):
                raise OSError("is the scene file itself; name another")
            check_can_save(out)
        except OSError as error:
            problems.append(refusal(f"--out {out}", error))
    sys.stderr.write("".join(f"{problem}\n" for problem in problems))
    return None if problems else found


def _misplaced(scenes: Sequence[str], out: str | None) -> list[str]:
    """Return what is wrong with the list of scenes itself."""
    from cagepose.errors import printable

    def told(message: str) -> list[str]:
        return [printable(f"cagepose: {message} See: cagepose run --help")]

    changes = [name for name in scenes[1:] if "=" in name and not exists(name)]
    if changes:
        return told(f"too many arguments: {' '.join(changes)}; each change needs its own --set.")
    if out is not None and len(scenes) > 1:
        return told("--out saves one run; name one scene.")
    if scenes.count(STANDARD_INPUT) > 1:
        return told("standard input is read once; name it once.")
    return []


def _scene_file(scene: str, set_values: tuple[str, ...]) -> SceneFile:
    from cagepose.files.scene_file import read_scene_file, scene_text_of

    if scene != STANDARD_INPUT:
        return read_scene_file(scene, set_values)
    from cagepose.files.read import MAX_FILE_BYTES, decoded

    content = sys.stdin.buffer.read(MAX_FILE_BYTES + 1)
    return scene_text_of(decoded(content, STANDARD_INPUT), STANDARD_INPUT).scene_file(set_values)

"""Commands that take a scene, which they run first, or a run that was saved."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from cagepose.cli.options import FileName, refusal, unknown_method

if TYPE_CHECKING:
    from cagepose.files.run_file import RunFile
    from cagepose.files.scene_file import SceneFile

RunOrSceneArgument = Annotated[FileName, Parameter(help="Saved run (run --out), or scene file (YAML or JSON).")]


def read_run_or_scene(
    run_or_scene: str,
    set_values: tuple[str, ...],
    method: str | None,
    check_out: Callable[[], None],
    option: str,
    problems_of_others: Sequence[str] = (),
) -> RunFile | SceneFile | None:
    """Check all that the user gave; problems of every argument are printed at once, and None is returned.

    ``check_out`` raises OSError or ValueError if the file to write, named by ``option``, cannot be written;
    ``problems_of_others`` are those of further arguments.
    """
    from cagepose.errors import CageposeError, printable
    from cagepose.files.read import looks_like_run
    from cagepose.files.run_file import read_run_file
    from cagepose.files.scene_file import read_scene_file

    problems = list(problems_of_others)
    source: RunFile | SceneFile | None = None
    is_run = looks_like_run(run_or_scene)
    try:
        source = read_run_file(run_or_scene) if is_run else read_scene_file(run_or_scene, set_values)
    except CageposeError as error:
        problems.append(str(error))
    if is_run and (set_values or method is not None):
        flag = "--set" if set_values else "--method"
        problems.append(printable(f"{flag}: changes a scene, but {run_or_scene} is a saved run; name the scene file"))
    else:
        problems += unknown_method(method)
    try:
        check_out()
    except (OSError, ValueError) as error:
        problems.append(refusal(option, error))
    sys.stderr.write("".join(f"{problem}\n" for problem in problems))
    return None if problems else source


def run_of(source: RunFile | SceneFile, method: str | None) -> RunFile:
    """Return the run of a source: the saved one, or the scene's, which is run now."""
    from cagepose.files.run_file import RunFile
    from cagepose.runs.solve import run

    if isinstance(source, RunFile):
        return source
    return RunFile(run(source.scene, method), source.length_unit)

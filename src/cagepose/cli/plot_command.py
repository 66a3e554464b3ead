"""``cagepose plot``: a run as a picture."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from cagepose.cli.first_run import announce_compilation
from cagepose.cli.options import SetOption

if TYPE_CHECKING:
    from cagepose.files.scene_file import SceneFile
    from cagepose.files.units import LengthUnit
    from cagepose.runs.run import Run


def plot_command(
    run_or_scene: Annotated[str, Parameter(help="Saved run (run --out), or scene file (YAML or JSON).")],
    /,
    *,
    out: Annotated[str, Parameter(help="Picture file to write: .png, .svg or .pdf.")],
    kind: Annotated[
        Literal["pose", "events"],
        Parameter(help="pose: angles, way and contacts against the step. events: the scene after each event."),
    ] = "pose",
    method: Annotated[str | None, Parameter(help="How to run a scene; left out: as the scene says.")] = None,
    set_values: SetOption = (),
) -> int:
    """Draw a run into a picture file; a scene is run first."""
    from cagepose.errors import printable
    from cagepose.faces.extra import require_matplotlib

    require_matplotlib()
    found = _read(run_or_scene, set_values, method, out)
    if found is None:
        return 2
    run, unit = found

    from cagepose.faces.event_figure import event_figure
    from cagepose.faces.figure_files import figure_suffix
    from cagepose.faces.pose_figure import pose_figure
    from cagepose.faces.style import figure_bytes
    from cagepose.files.write import write_whole

    figure = (pose_figure if kind == "pose" else event_figure)(run, unit)
    try:
        write_whole(out, figure_bytes(figure, figure_suffix(out)))
    except OSError as error:
        sys.stderr.write(printable(f"--out {out}: {error.strerror or error}") + "\n")
        return 2
    sys.stdout.write(printable(f"wrote {out}: {run.scene.name}, {run.verdict} ({run.method})") + "\n")
    return 0


def _read(
    run_or_scene: str, set_values: tuple[str, ...], method: str | None, out: str
) -> tuple[Run, LengthUnit] | None:
    """Check all that the user gave, then run; problems of every argument are printed at once."""
    from cagepose.errors import CageposeError, printable
    from cagepose.faces.figure_files import check_can_draw
    from cagepose.files.run_file import RunFile, looks_like_run, read_run_file
    from cagepose.files.scene_file import read_scene_file
    from cagepose.runs.solve import METHODS, chosen_method, run

    problems = []
    source: RunFile | SceneFile | None = None
    is_run = looks_like_run(run_or_scene)
    try:
        source = read_run_file(run_or_scene) if is_run else read_scene_file(run_or_scene, set_values)
    except CageposeError as error:
        problems.append(str(error))
    if is_run and (set_values or method is not None):
        flag = "--set" if set_values else "--method"
        problems.append(printable(f"{flag}: changes a scene, but {run_or_scene} is a saved run; name the scene file"))
    elif method is not None and method not in METHODS:
        problems.append(printable(f"--method {method}: is no known method; use one of: {', '.join(METHODS)}"))
    try:
        check_can_draw(out)
    except (OSError, ValueError) as error:
        problems.append(printable(f"--out {out}: {getattr(error, 'strerror', None) or error}"))
    sys.stderr.write("".join(f"{problem}\n" for problem in problems))
    if problems or source is None:
        return None
    if isinstance(source, RunFile):
        return source.run, source.length_unit
    announce_compilation([chosen_method(source.scene, method)])
    return run(source.scene, method), source.length_unit

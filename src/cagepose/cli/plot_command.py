"""``cagepose plot``: a run as a picture."""

from __future__ import annotations

import sys
from typing import Annotated, Literal

from cyclopts import Parameter

from cagepose.cli.options import SetOption
from cagepose.cli.run_source import MethodOption, RunOrSceneArgument, read_run_or_scene, run_of


def plot_command(
    run_or_scene: RunOrSceneArgument,
    /,
    *,
    out: Annotated[str, Parameter(help="Picture file to write: .png, .svg or .pdf.")],
    kind: Annotated[
        Literal["pose", "events"],
        Parameter(help="pose: angles, way and contacts against the step. events: the scene after each event."),
    ] = "pose",
    method: MethodOption = None,
    set_values: SetOption = (),
) -> int:
    """Draw a run into a picture file; a scene is run first."""
    from cagepose.errors import printable
    from cagepose.faces.extra import require_matplotlib
    from cagepose.faces.figure_files import check_can_draw, figure_suffix

    require_matplotlib()
    source = read_run_or_scene(run_or_scene, set_values, method, lambda: check_can_draw(out), f"--out {out}")
    if source is None:
        return 2
    run_file = run_of(source, method)
    run, unit = run_file.run, run_file.length_unit

    from cagepose.faces.event_figure import event_figure
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

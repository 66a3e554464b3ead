"""``cagepose plot``: a run, or the play of a scene, as a picture."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from cagepose.cli.options import FILE, AtOption, FileName, MethodOption, SetOption, refusal
from cagepose.cli.run_source import RunOrSceneArgument, read_run_or_scene, run_of

if TYPE_CHECKING:
    from cagepose.files.run_file import RunFile
    from cagepose.files.scene_file import SceneFile


def plot_command(
    run_or_scene: RunOrSceneArgument,
    /,
    *,
    out: Annotated[FileName, FILE, Parameter(help="Picture file to write: .png, .svg or .pdf.")],
    kind: Annotated[
        Literal["pose", "events", "drive", "play", "extremes"],
        Parameter(
            help="pose: angles, way and contacts against the step. events: the scene after each event. drive: the force"
            " that drives bodies of the cage, contacts and pose over the way. play: how far each freedom goes, and the"
            " points named with --at. extremes: the scene at each end of its play."
        ),
    ] = "pose",
    at: AtOption = (),
    method: MethodOption = None,
    set_values: SetOption = (),
) -> int:
    """Draw a run into a picture file; a scene is run first."""
    from cagepose.cli.triples import read_triple
    from cagepose.errors import printable
    from cagepose.views.extra import require_matplotlib
    from cagepose.views.output_files import FIGURES, check_output, output_suffix

    require_matplotlib()
    problems = list[str]()
    if at and kind != "play":
        problems.append("--at: says whose play is drawn; give --kind play with it")
    points = [read_triple("--at", text, problems) for text in at]
    source = read_run_or_scene(
        run_or_scene, set_values, method, lambda: check_output(out, FIGURES), f"--out {out}", problems
    )
    if source is None:
        return 2

    from cagepose.files.write import write_whole

    suffix = output_suffix(out, FIGURES)
    if kind in ("play", "extremes"):
        picture, said = _play_picture(kind, source, points, suffix)
    else:
        found = run_of(source, method)
        if kind == "drive" and all(phase.drive is None for phase in found.run.phases):
            sys.stderr.write("--kind drive: no phase of the run drives a body of the cage; give another kind\n")
            return 2
        picture, said = _run_picture(kind, found, suffix)
    try:
        write_whole(out, picture)
    except OSError as error:
        sys.stderr.write(refusal(f"--out {out}", error) + "\n")
        return 2
    sys.stdout.write(printable(f"wrote {out}: {said}") + "\n")
    return 0


def _run_picture(kind: str, source: RunFile, suffix: str) -> tuple[bytes, str]:
    """Return the picture of a run, and what it shows."""
    from cagepose.views.drive_figure import drive_figure
    from cagepose.views.event_figure import event_figure
    from cagepose.views.pose_figure import pose_figure
    from cagepose.views.style import figure_bytes

    run = source.run
    figure = {"pose": pose_figure, "events": event_figure, "drive": drive_figure}[kind](run, source.length_unit)
    return figure_bytes(figure, suffix), f"{run.scene.name}, {run.verdict} ({run.method})"


def _play_picture(
    kind: str, source: RunFile | SceneFile, points: list[tuple[float, ...]], suffix: str
) -> tuple[bytes, str]:
    """Return the picture of a scene's play, and what it shows."""
    from cagepose.files.run_file import RunFile
    from cagepose.files.units import to_metres
    from cagepose.studies.play import play
    from cagepose.views.extreme_figure import extreme_figure
    from cagepose.views.play_figure import play_figure
    from cagepose.views.style import figure_bytes

    found = play(source.run.scene if isinstance(source, RunFile) else source.scene)
    said = f"{found.scene.name}, {found.verdict}"
    if kind == "extremes":
        return figure_bytes(extreme_figure(found, source.length_unit), suffix), said
    points_m = [to_metres(point, source.length_unit) for point in points]
    return figure_bytes(play_figure(found, points_m, source.length_unit), suffix), said

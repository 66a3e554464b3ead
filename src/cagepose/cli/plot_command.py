"""``cagepose plot``: a run, or the play of a scene, as a picture."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from cagepose.cli.first_run import announce_compilation, announce_kernels
from cagepose.cli.options import AtOption, SetOption

if TYPE_CHECKING:
    from cagepose.files.run_file import RunFile
    from cagepose.files.scene_file import SceneFile


def plot_command(
    run_or_scene: Annotated[str, Parameter(help="Saved run (run --out), or scene file (YAML or JSON).")],
    /,
    *,
    out: Annotated[str, Parameter(help="Picture file to write: .png, .svg or .pdf.")],
    kind: Annotated[
        Literal["pose", "events", "play", "extremes"],
        Parameter(
            help="pose: angles, way and contacts against the step. events: the scene after each event. play: how far"
            " each freedom goes, and the points named with --at. extremes: the scene at each end of its play."
        ),
    ] = "pose",
    at: AtOption = (),
    method: Annotated[str | None, Parameter(help="How to run a scene; left out: as the scene says.")] = None,
    set_values: SetOption = (),
) -> int:
    """Draw a run into a picture file; a scene is run first."""
    from cagepose.errors import printable
    from cagepose.faces.extra import require_matplotlib

    require_matplotlib()
    source = _read(run_or_scene, kind, at, set_values, method, out)
    if source is None:
        return 2

    from cagepose.faces.figure_files import figure_suffix
    from cagepose.files.write import write_whole

    suffix = figure_suffix(out)
    if kind in ("play", "extremes"):
        picture, said = _play_picture(kind, source, at, suffix)
    else:
        picture, said = _run_picture(kind, source, method, suffix)
    try:
        write_whole(out, picture)
    except OSError as error:
        sys.stderr.write(printable(f"--out {out}: {error.strerror or error}") + "\n")
        return 2
    sys.stdout.write(printable(f"wrote {out}: {said}") + "\n")
    return 0


def _run_picture(kind: str, source: RunFile | SceneFile, method: str | None, suffix: str) -> tuple[bytes, str]:
    """Return the picture of a run, and what it shows."""
    from cagepose.faces.event_figure import event_figure
    from cagepose.faces.pose_figure import pose_figure
    from cagepose.faces.style import figure_bytes
    from cagepose.files.run_file import RunFile
    from cagepose.runs.solve import chosen_method, run

    if isinstance(source, RunFile):
        found = source.run
    else:
        announce_compilation([chosen_method(source.scene, method)])
        found = run(source.scene, method)
    figure = (pose_figure if kind == "pose" else event_figure)(found, source.length_unit)
    return figure_bytes(figure, suffix), f"{found.scene.name}, {found.verdict} ({found.method})"


def _play_picture(kind: str, source: RunFile | SceneFile, at: tuple[str, ...], suffix: str) -> tuple[bytes, str]:
    """Return the picture of a scene's play, and what it shows."""
    from cagepose.cli.triples import read_triple
    from cagepose.faces.extreme_figure import extreme_figure
    from cagepose.faces.play_figure import play_figure
    from cagepose.faces.style import figure_bytes
    from cagepose.files.run_file import RunFile
    from cagepose.files.units import to_metres
    from cagepose.studies.play import play, play_is_compiled

    announce_kernels(play_is_compiled())
    found = play(source.run.scene if isinstance(source, RunFile) else source.scene)
    said = f"{found.scene.name}, {found.cage.verdict}"
    if kind == "extremes":
        return figure_bytes(extreme_figure(found, source.length_unit), suffix), said
    points = [to_metres(read_triple("--at", text, []), source.length_unit) for text in at]
    return figure_bytes(play_figure(found, points, source.length_unit), suffix), said


def _read(
    run_or_scene: str, kind: str, at: tuple[str, ...], set_values: tuple[str, ...], method: str | None, out: str
) -> RunFile | SceneFile | None:
    """Check all that the user gave; problems of every argument are printed at once."""
    from cagepose.cli.triples import read_triple
    from cagepose.errors import CageposeError, printable
    from cagepose.faces.figure_files import check_can_draw
    from cagepose.files.run_file import looks_like_run, read_run_file
    from cagepose.files.scene_file import read_scene_file
    from cagepose.runs.solve import METHODS

    problems = list[str]()
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
    if at and kind != "play":
        problems.append("--at: says whose play is drawn; give --kind play with it")
    for text in at:
        read_triple("--at", text, problems)
    try:
        check_can_draw(out)
    except (OSError, ValueError) as error:
        problems.append(printable(f"--out {out}: {getattr(error, 'strerror', None) or error}"))
    sys.stderr.write("".join(f"{problem}\n" for problem in problems))
    return None if problems else source

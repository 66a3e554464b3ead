"""``cagepose view``: a run in three dimensions, in one page that plays without a network."""

from __future__ import annotations

import sys
from typing import Annotated

from cyclopts import Parameter

from cagepose.cli.options import SetOption
from cagepose.cli.run_source import MethodOption, RunOrSceneArgument, read_run_or_scene, run_of


def view_command(
    run_or_scene: RunOrSceneArgument,
    /,
    *,
    export: Annotated[str, Parameter(help="File to write: .html, a page that plays in any browser, with no network.")],
    method: MethodOption = None,
    set_values: SetOption = (),
) -> int:
    """Write a page with the object in its cage, the timeline, the events and the forces; a scene is run first."""
    from cagepose.errors import printable
    from cagepose.faces.view.export_files import check_can_export

    option = f"--export {export}"
    source = read_run_or_scene(run_or_scene, set_values, method, lambda: check_can_export(export), option)
    if source is None:
        return 2
    run_file = run_of(source, method)

    from cagepose.faces.view.page import page
    from cagepose.faces.view.playback import playback
    from cagepose.files.write import write_whole

    run = run_file.run
    try:
        write_whole(export, page(playback(run, run_file.length_unit)).encode())
    except OSError as error:
        sys.stderr.write(printable(f"{option}: {error.strerror or error}") + "\n")
        return 2
    sys.stdout.write(printable(f"wrote {export}: {run.scene.name}, {run.verdict} ({run.method})") + "\n")
    return 0

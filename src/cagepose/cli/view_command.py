"""``cagepose view``: a run in three dimensions, live in a browser or as one page that plays without a network."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from cagepose.cli.options import FILE, FileName, MethodOption, SetOption, refusal
from cagepose.cli.run_source import RunOrSceneArgument, read_run_or_scene, run_of

if TYPE_CHECKING:
    from cagepose.views.viewer.editing import Desk
    from cagepose.views.viewer.playback import Playback

PORT_USUAL = 8737


def view_command(
    run_or_scene: RunOrSceneArgument,
    /,
    *,
    export: Annotated[
        FileName | None,
        FILE,
        Parameter(
            help="Write a file instead: .html, a page that plays in any browser with no network; .gif or .mp4, a film;"
            " .png, a picture of the end."
        ),
    ] = None,
    method: MethodOption = None,
    set_values: SetOption = (),
    host: Annotated[
        str,
        Parameter(help="Address to serve on. The default is for this machine only; any other lets the network look."),
    ] = "127.0.0.1",
    port: Annotated[int, Parameter(help="Port to serve on; if it is in use, the next free one.")] = PORT_USUAL,
) -> int:
    """Show the object in its cage, the timeline, the events and the forces; a scene is run first."""
    from cagepose.errors import printable
    from cagepose.views.extra import require_film, require_pillow
    from cagepose.views.output_files import EXPORTS, check_output, output_suffix

    required = {".png": require_pillow, ".gif": require_pillow, ".mp4": require_film}

    def check_out() -> None:
        if export is not None:
            check_output(export, EXPORTS)
            required.get(output_suffix(export, EXPORTS), lambda: None)()

    if not 0 < port < 2**16:
        sys.stderr.write(f"--port {port}: is no port; give a number from 1 to 65535\n")
        return 2
    option = f"--export {export}"
    source = read_run_or_scene(run_or_scene, set_values, method, check_out, option)
    if source is None:
        return 2
    run_file = run_of(source, method)

    from cagepose.files.run_file import RunFile
    from cagepose.files.write import write_whole
    from cagepose.views.viewer.playback import playback

    run, shown = run_file.run, playback(run_file.run, run_file.length_unit)
    if export is None:
        desk = None if isinstance(source, RunFile) else _desk(run_or_scene, set_values, method, host)
        return _serve(shown, desk, host, port)
    try:
        write_whole(export, _content(shown, output_suffix(export, EXPORTS)))
    except OSError as error:
        sys.stderr.write(refusal(option, error) + "\n")
        return 2
    sys.stdout.write(printable(f"wrote {export}: {run.scene.name}, {run.verdict} ({run.method})") + "\n")
    return 0


def _content(shown: Playback, suffix: str) -> bytes:
    """Return a file of the kind ``suffix``."""
    if suffix == ".html":
        from cagepose.views.viewer.page import page

        return page(shown).encode()
    from cagepose.views.viewer.film import gif_bytes, mp4_bytes, png_bytes

    if suffix == ".png":
        return png_bytes(shown)
    return (mp4_bytes if suffix == ".mp4" else gif_bytes)(shown.run, shown.length_unit)


def _desk(scene: str, set_values: tuple[str, ...], method: str | None, host: str) -> Desk:
    from cagepose.views.viewer.editing import Desk
    from cagepose.views.viewer.server import LOOPBACK

    return Desk(scene, set_values, method, can_edit=host in LOOPBACK)


def _serve(shown: Playback, desk: Desk | None, host: str, port: int) -> int:
    """Serve the page until somebody presses Ctrl-C."""
    from cagepose.errors import printable
    from cagepose.views.viewer.page import page
    from cagepose.views.viewer.server import open_server

    try:
        server = open_server(page(shown, desk), desk, host, port)
    except OSError as error:
        sys.stderr.write(refusal(f"--host {host} --port {port}", error) + "\n")
        return 2
    with server:
        if server.server_port != port:
            sys.stdout.write(f"port {port} is in use; using {server.server_port}\n")
        sys.stdout.write(printable(f"{shown.run.scene.name}: open {server.address} (Ctrl-C stops it)") + "\n")
        sys.stdout.flush()
        try:
            server.serve_forever()
        except KeyboardInterrupt:
            sys.stdout.write("\nended\n")
    return 0

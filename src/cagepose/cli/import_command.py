"""``cagepose import``: a model of another program as a scene file."""

from __future__ import annotations

import sys
from typing import Annotated

from cyclopts import Parameter

from cagepose.cli.options import FILE, FileName, refusal

NO_FILE = "cagepose: import needs a FILE, or --object FILE and --cage FILE, to join files. See: cagepose import --help"


def import_command(
    file: Annotated[
        FileName | None,
        Parameter(
            help="MJCF, URDF, STEP, STL, OBJ, PLY or GLB file; left out: --object and --cage are files themselves."
        ),
    ] = None,
    /,
    *,
    out: Annotated[FileName, FILE, Parameter(name=("--out", "-o"), help="Scene file to write, such as scene.yaml.")],
    object: Annotated[
        str | None,
        Parameter(
            help="The body that is held, with everything fixed to it; left out: the one that moves freely. Of solids:"
            " the name of one, or what the names of several begin with before a /; left out: object. Without a FILE: a"
            " STEP, STL, OBJ, PLY or GLB file, or one of its solids as FILE#NAME, placed by its own coordinates, or"
            " moved by @x,y,z or @x,y,z,yaw,pitch,roll behind the name (turned by degrees, then moved by millimetres)."
        ),
    ] = None,
    cage: Annotated[
        tuple[str, ...],
        Parameter(
            negative=(),
            show_default=False,
            help="A body of the cage, with everything fixed to it; may be given several times. Left out: all others."
            " Without a FILE: a file, as for --object; the same one may be given again at another place.",
        ),
    ] = (),
    root: Annotated[
        FileName | None,
        Parameter(
            help="The folder under which a robot model's meshes and includes lie, packages too; left out: the model's."
        ),
    ] = None,
    keyframe: Annotated[
        str | None, Parameter(help="The keyframe of a robot model at which its bodies are taken.")
    ] = None,
    qpos: Annotated[
        str | None,
        Parameter(
            help="Where its joints are: all coordinates, or JOINT=NUMBER for some, such as 'left=0.02 right=0.02'."
        ),
    ] = None,
    fillets: Annotated[
        bool,
        Parameter(
            help="Keep concave fillets of STEP files; with --no-fillets the walls beside them go on to a sharp corner."
        ),
    ] = True,
    report: Annotated[
        FileName | None,
        FILE,
        Parameter(
            help="Report to write as well, such as report.html: what each solid or body became, with pictures of both."
        ),
    ] = None,
) -> int:
    """Read a model, or join files of solids, write it as a scene, and list what could not be kept."""
    from cagepose.cli.import_summary import print_summary
    from cagepose.errors import printable
    from cagepose.exchange.imported import imported
    from cagepose.exchange.joined import PlacedFile, joined
    from cagepose.files.saved_scene import check_can_save_scene, save_scene

    if file is None and (object is None or not cage):
        sys.stderr.write(NO_FILE + "\n")
        return 2
    if report is not None and (refused := _cannot_report(report)):
        sys.stderr.write(refused + "\n")
        return 2
    try:
        check_can_save_scene(out)
        if file is None:
            found = joined(PlacedFile.of(str(object)), [PlacedFile.of(one) for one in cage], fillets=fillets)
        else:
            found = imported(file, object, cage, fillets=fillets, root=root, keyframe=keyframe, qpos=qpos)
        save_scene(found.scene, out)
    except OSError as error:
        sys.stderr.write(refusal(f"--out {out}", error) + "\n")
        return 2
    contents = f"{found.scene.object!r} {found.scene.cage!r}".replace("<", "").replace(">", ";").rstrip(";")
    sys.stdout.write(printable(f"wrote {out}: {contents}") + "\n")
    print_summary(found.parts, found.weight)
    sys.stdout.write("".join(printable(f"note: {note}") + "\n" for note in found.notes))
    if report is not None:
        from cagepose.views.import_page import write_import_page

        write_import_page(found, report)
        sys.stdout.write(printable(f"wrote {report}") + "\n")
    return 0


def _cannot_report(report: str) -> str | None:
    """Return why a page cannot be written there; None: it can."""
    from cagepose.views.extra import require_import_page
    from cagepose.views.output_files import check_output

    require_import_page()
    try:
        check_output(report, (".html",))
    except (OSError, ValueError) as error:
        return refusal(f"--report {report}", error)
    return None

"""``cagepose import``: a model of another program as a scene file."""

from __future__ import annotations

import sys
from typing import Annotated

from cyclopts import Parameter

from cagepose.cli.options import FILE, FileName, refusal


def import_command(
    file: Annotated[FileName, Parameter(help="MJCF, URDF, STEP, STL, OBJ, PLY or GLB file.")],
    /,
    *,
    out: Annotated[FileName, FILE, Parameter(name=("--out", "-o"), help="Scene file to write, such as scene.yaml.")],
    object: Annotated[
        str | None,
        Parameter(
            help="The body that is held, with all that hangs on it; left out: the one that moves freely. Of solids, one"
            " by its name, or all by what their names begin with before a /; left out: object."
        ),
    ] = None,
    cage: Annotated[
        tuple[str, ...],
        Parameter(
            negative=(),
            show_default=False,
            help="A body that holds it, with all that hangs on it; may be given several times. Left out: all others.",
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
) -> int:
    """Read a model, write it as a scene, and say what is not in it as it was."""
    from cagepose.errors import printable
    from cagepose.exchange.imported import imported
    from cagepose.files.saved_scene import check_can_save_scene, save_scene

    try:
        check_can_save_scene(out)
        found = imported(file, object, cage, root=root, keyframe=keyframe, qpos=qpos)
        save_scene(found.scene, out)
    except OSError as error:
        sys.stderr.write(refusal(f"--out {out}", error) + "\n")
        return 2
    contents = f"{found.scene.object!r} {found.scene.cage!r}".replace("<", "").replace(">", ";").rstrip(";")
    sys.stdout.write(printable(f"wrote {out}: {contents}") + "\n")
    sys.stdout.write("".join(printable(f"note: {note}") + "\n" for note in found.notes))
    return 0
